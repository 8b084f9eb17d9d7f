"""A sole's lower convex hull, and how far the sole is above it."""

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
    left, right = corners[0, 0], corners[-1, 0]
    margin = 1e-9 * (right - left)
    inner = contour[(contour[:, 0] > left + margin) & (contour[:, 0] < right - margin)]
    # a vertical side at an end is part of the chain, but has no inside
    flat = corners[np.concatenate([[True], np.diff(corners[:, 0]) > 0.0])]
    if len(inner) == 0:  # nothing between the ends but the straight hull itself
        inner = flat.mean(axis=0, keepdims=True)
    floor = np.interp(inner[:, 0], flat[:, 0], flat[:, 1])
    i = int(np.argmax(inner[:, 1] - floor))
    return flat, float(inner[i, 0]), float(floor[i]), float(inner[i, 1])


def hollow(contour: Array) -> float:
    """Largest gap, along z_p, between a sole (m, 2), m, and its lower convex hull, m.

    0 for a convex sole; the depth of the hollow for one that touches ground at heel and toe only. Points on
    the contour's vertical sides do not count.
    """
    _, _, low, high = lower_hull(contour)
    return max(high - low, 0.0)
