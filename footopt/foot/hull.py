"""The lower convex hull of a sole, and where the sole is farthest above it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def lower_hull(contour: Array) -> tuple[Array, float, float, float]:
    """Lower convex hull of a sole (m, 2), m, and where the sole is farthest above it.

    Returns the hull from heel to toe, x where the gap is largest, and the heights of hull and sole there.
    """
    hull: list[Array] = []
    for p in contour[np.lexsort((contour[:, 1], contour[:, 0]))]:  # Andrew's monotone chain
        while len(hull) >= 2:
            (ax, az), (bx, bz) = hull[-1] - hull[-2], p - hull[-2]
            if ax * bz - az * bx > 0.0:
                break
            hull.pop()
        hull.append(p)
    corners = np.array(hull)
    corners = corners[np.append(True, np.diff(corners[:, 0]) > 0.0)]  # not up a vertical side at the toe
    (left, _), (right, _) = corners[0], corners[-1]
    x, z = contour.T
    floor, margin = np.interp(x, *corners.T), 1e-9 * (right - left)
    gap = np.where((x > left + margin) & (x < right - margin), z - floor, 0.0)  # sides have no inside
    i = int(np.argmax(gap))
    return corners, float(x[i]), float(floor[i]), float(floor[i] + gap[i])
