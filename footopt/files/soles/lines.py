"""Lines of a drawing: their units, how pieces become one, and where a line meets itself."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from footopt.arrays import Array
from footopt.errors import Unusable

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "pt": 0.0254 / 72, "px": 0.0254 / 96}  # m
CHORD_TOLERANCE = 2e-5  # largest distance of a flattened curve from itself, m
JOIN_DISTANCE = 1e-5  # ends of lines nearer than this are one point, m
SAME_POINT = 1e-9  # points nearer than this are one, m


class Line(NamedTuple):
    """A line of a drawing."""

    points: Array  # (m, 2), m; a closed one does not repeat its first
    closed: bool
    layer: str  # its layer (DXF) or the id of its group (SVG)


def unit_of(units: str | None, own: str | None) -> float:
    """Metres in a unit: the setting's, or else the file's own."""
    unit = units or own
    if unit not in UNITS:
        raise Unusable(
            f"does not say in which unit it is{f', or says {unit!r}' if unit else ''}. "
            f"Set foot.units to one of {', '.join(UNITS)}."
        )
    return UNITS[unit]


def from_points(points: Array, layer: str, same: float = SAME_POINT) -> Line:
    """A line that is closed if it ends where it began, within `same` (m)."""
    closed = len(points) > 3 and bool(np.linalg.norm(points[0] - points[-1]) <= same)
    return Line(points[:-1] if closed else points, closed, layer)


def join(lines: Sequence[Line]) -> list[Line]:
    """Join lines where the ends of two of them, and of no third one, meet within `JOIN_DISTANCE`."""
    from shapely import MultiLineString, get_coordinates, get_parts, line_merge, remove_repeated_points

    pieces = [(np.concatenate([line.points, line.points[: line.closed]]), line.layer) for line in lines]
    pieces = [(points, layer) for points, layer in pieces if np.ptp(points, axis=0).max() > JOIN_DISTANCE]
    ends = np.array([points[[0, -1]] for points, _ in pieces]).reshape(-1, 2)
    for i in range(len(ends)):  # shapely merges equal ends only: each moves to the first one near it
        ends[i] = ends[np.argmax(np.linalg.norm(ends[: i + 1] - ends[i], axis=1) <= JOIN_DISTANCE)]
    layers: dict[tuple[float, ...], str] = {}
    for (points, layer), meeting in zip(pieces, ends.reshape(-1, 2, 2), strict=True):
        points[[0, -1]] = meeting
        for end in meeting:
            layers.setdefault(tuple(end), layer)
    merged = line_merge(MultiLineString([points for points, _ in pieces]))
    found = [get_coordinates(remove_repeated_points(part, 0.1 * JOIN_DISTANCE)) for part in get_parts(merged)]
    found.sort(key=lambda points: -np.ptp(points, axis=0).max())
    return [from_points(points, layers[tuple(points[0])]) for points in found]


def crossing(points: Array, closed: bool) -> Array | None:
    """Where a line (m, 2) meets itself, (2,), or None."""
    from shapely import LineString, get_coordinates, get_parts, node

    line = LineString(np.concatenate([points, points[:closed]]))
    return None if line.is_simple else get_coordinates(get_parts(node(line))[0])[-1]
