"""Where a line meets itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAME = 1e-9  # points closer than this are one, m


def crossing(points: Array, closed: bool) -> Array | None:
    """Where a line first meets itself.

    Parameters
    ----------
    points : (m, 2), m
        No two neighbours in one place.
    closed : bool
        Whether the last point is joined to the first.

    Returns
    -------
    place : (2,), m, or None
        None where it does not.
    """
    from shapely import LinearRing, LineString, Point, get_coordinates, node

    line = LinearRing(points) if closed else LineString(points)
    if line.is_simple:
        return None
    # split where it meets itself, the pieces end there, and at the ends of the line
    ends = np.concatenate([get_coordinates(piece)[[0, -1]] for piece in node(line).geoms])
    along = np.array([line.project(Point(end)) for end in ends])
    inner = (along > SAME) & (along < line.length - SAME)
    place: Array = ends[inner][np.argmin(along[inner])] if inner.any() else points[0]
    return place
