"""Polygons: the area inside one, and where one crosses itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAME = 1e-9  # points closer than this are one, m


def enclosed_area(outline: Array) -> float:
    """Area inside a closed polygon (shoelace), positive when it runs counter-clockwise.

    Parameters
    ----------
    outline : (m, 2), the first point not repeated
    """
    x, z = (outline - outline[0]).T  # near the origin the products cancel less
    return float(0.5 * np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z))


def without_twins(points: Array, closed: bool, same: float = SAME) -> Array:
    """The points without those that repeat the one before them, within `same`."""
    steps = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)
    keep = steps > same
    if not closed:
        keep[0] = True
    kept: Array = points[keep]
    return kept


def crossing(points: Array, closed: bool) -> Array | None:
    """Where a line first meets itself, (2,), or None.

    Two sides meet when the ends of each lie on different sides of the other, or on it.

    Parameters
    ----------
    points : (m, 2), no twins among neighbours
    closed : whether the last point is joined to the first
    """
    begin = points if closed else points[:-1]
    step = (np.roll(points, -1, axis=0) if closed else points[1:]) - begin
    sides = len(begin)
    for i in range(sides - 2):
        # neighbours share a point; so do the first and the last side of a closed line
        last = sides - 1 if closed and i == 0 else sides
        others = slice(i + 2, last)
        from_i = begin[others] - begin[i]
        turn = _cross(step[i], step[others])
        with np.errstate(divide="ignore", invalid="ignore"):
            along_i = _cross(from_i, step[others]) / turn
            along_other = _cross(from_i, step[i]) / turn
        meet = (along_i >= 0) & (along_i <= 1) & (along_other >= 0) & (along_other <= 1)
        if meet.any():
            place: Array = begin[i] + along_i[meet][0] * step[i]
            return place
    return None


def _cross(a: Array, b: Array) -> Array:
    product: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product
