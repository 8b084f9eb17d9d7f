"""Soles from drawings and tables (DXF, SVG, CSV), as points.

A drawing's polylines, lines, arcs and splines are flattened, and joined where their ends meet. One line
must remain: an open one is the sole as it is; of a closed one the sole is the lower edge, between its
leftmost and its rightmost points. x is to the toe and z up, and the file's origin is the foot frame's.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from footopt.arrays import Array
from footopt.errors import TINY, FileError, Unusable, check, check_number, naming
from footopt.files.drawings import JOIN_DISTANCE, UNITS, Line, crossing, join, read_dxf, read_svg, read_table
from footopt.files.feet import MM, SOLE
from footopt.foot import Foot

READERS = {".dxf": read_dxf, ".svg": read_svg, ".csv": read_table}
MAX_COORDINATE = 1e6  # m; no drawing has a point farther from its origin
LENGTH_RANGE = (1e-3, 0.6)  # of a sole, m; anything else is a mistake in the units, as m for mm
MAX_HOLE = 0.5  # of an outline's length: a larger line inside it may be the sole itself
LISTED = 5  # lines of a drawing that a message lists


def read_foot(
    path: str | Path,
    *,
    units: str | None = None,
    scale: float = 1.0,
    layer: str | None = None,
    toe: str = "right",
    origin: str = "file",
    **parameters: Any,
) -> Foot:
    """Read the foot whose sole is in a DXF, SVG or CSV file.

    Parameters
    ----------
    path : str or Path
        Ends in .dxf, .svg or .csv.
    units : str, optional
        Unit of the file's numbers, a name in `UNITS`; by default the file's own.
    scale : float
        Multiplies all lengths.
    layer : str, optional
        Of the line, if the drawing holds others; by default SOLE if there is such a layer.
    toe : {"right", "left"}
        Where the toe is in the drawing; left mirrors it.
    origin : {"file", "centre"}
        The foot frame's origin: the file's, or the middle of the line's bounding box.
    **parameters
        ``width``, ``ankle``, ``closed`` and ``top``, as of every `Foot`.

    Returns
    -------
    foot : Foot
        Its notes list the lines of the file that were left out.

    Raises
    ------
    FileError
        The file cannot be read, or does not hold one line that can be a sole.
    SettingError
        One of the settings above cannot be used.
    """
    check(units is None or units in UNITS, "foot.units", units, f"one of {', '.join(UNITS)}, or null")
    check_number("foot.scale", scale, TINY, 1e300, "a number > 0")
    check(toe in ("right", "left"), "foot.toe", toe, "right or left: where the toe is in the drawing")
    check(origin in ("file", "centre"), "foot.origin", origin, "file or centre")
    path = Path(path)
    check(path.suffix.lower() in READERS, "foot.path", str(path), f"a file that ends in {', '.join(READERS)}")
    with naming(path, "foot.path"):
        line, notes = the_line(lines_of(path, units, scale), layer)
        points = line.points * ([-1.0, 1.0] if toe == "left" else 1.0)
        check_size(points, origin)
        if (place := crossing(points, line.closed)) is not None:
            raise Unusable(f"the line crosses itself at {_where(place)}.")
        if origin == "centre":
            points = points - 0.5 * (points.min(axis=0) + points.max(axis=0))
        sole = lower_edge(points) if line.closed else _from_heel(points)
    return Foot(sole, name=path.stem, notes=tuple(f"{path.name}: {note}" for note in notes), **parameters)


def lines_of(path: Path, units: str | None = None, scale: float = 1.0) -> list[Line]:
    """All lines of a file, by its ending, scaled; raises `Unusable` where it cannot be read."""
    try:
        lines = [line for line in READERS[path.suffix.lower()](path, units, scale) if len(line.points) > 1]
    except (Unusable, FileError):
        raise
    except Exception as error:  # libraries raise all kinds; their messages help nobody
        raise Unusable(f"cannot be read as {path.suffix}. Save it again by what made it.") from error
    if not all((abs(line.points) < MAX_COORDINATE).all() for line in lines):
        raise Unusable("a line has a point that is not a finite number, or far away.")
    return lines


def the_line(lines: Sequence[Line], layer: str | None = None) -> tuple[Line, tuple[str, ...]]:
    """The one line of a drawing, its pieces joined, or the outline if all others are its holes; and notes."""
    layers = sorted({line.layer for line in lines})
    if layer is None and SOLE in layers:
        layer = SOLE
    held = ", ".join(map(repr, layers))
    check(layer is None or layer in layers, "foot.layer", layer, f"a layer with lines; there are {held}")
    found = join([line for line in lines if layer in (None, line.layer)])
    if not found:
        raise Unusable("holds no line, arc, spline or polyline.")
    told = [*map(_described, found[:LISTED]), *["..."][: len(found) > LISTED]]
    if len(found) == 1:
        return found[0], ()
    if _has_holes(*found):
        return found[0], (f"the outer line is read, {told[0]}; not its holes: {'; '.join(told[1:])}",)
    choose = f"Choose one with foot.layer (there are {held}), or delete" if len(layers) > 1 else "Delete"
    raise Unusable(
        f"must hold one line that is the sole, or one closed outline; it holds {len(found)}: "
        f"{'; '.join(told)}. {choose} the others, or close gaps above {MM * JOIN_DISTANCE:g} mm."
    )


def _has_holes(outer: Line, *others: Line) -> bool:
    """Whether a closed line holds all others, closed and much smaller: a frame round a sole is no outline."""
    from shapely import Polygon

    body, length = Polygon(outer.points) if outer.closed else Polygon(), MAX_HOLE * np.ptp(outer.points[:, 0])
    return body.is_valid and all(
        o.closed and np.ptp(o.points, axis=0).max() < length and body.contains(Polygon(o.points))
        for o in others
    )


def lower_edge(outline: Array) -> Array:
    """The lower edge of a closed outline (m, 2), from its leftmost to its rightmost point.

    Of several leftmost (or rightmost) points, as of a vertical side, it is the lowest.
    """
    from shapely import LinearRing

    if not LinearRing(outline).is_ccw:
        outline = outline[::-1]  # counter-clockwise, the lower edge runs to the right
    x, z = outline.T
    ends = [int(np.argmin(np.where(side <= JOIN_DISTANCE, z, np.inf))) for side in (x - x.min(), x.max() - x)]
    return np.roll(outline, -ends[0], axis=0)[: (ends[1] - ends[0]) % len(outline) + 1]


def check_size(points: Array, origin: str) -> None:
    """Raise unless a line (m, 2) has a sole's size and place."""
    left, right = points[:, 0].min(), points[:, 0].max()
    if not LENGTH_RANGE[0] <= right - left <= LENGTH_RANGE[1]:
        raise Unusable(f"the sole would be {right - left:.4g} m long. Set foot.units or foot.scale.")
    if origin == "file" and not left < 0.0 < right:
        raise Unusable(
            f"its origin is not above the foot, which lies between x {MM * left:.4g} and {MM * right:.4g} "
            "mm. The ankle is measured from there: move the drawing, or set foot.origin=centre."
        )


def _from_heel(line: Array) -> Array:
    """An open line from left to right."""
    heel, toe = line[0], line[-1]
    if abs(toe[0] - heel[0]) <= JOIN_DISTANCE:
        raise Unusable(f"the line begins and ends above {_where(heel)}: which end is the heel? Close it.")
    return line if toe[0] > heel[0] else line[::-1]


def _where(place: Array) -> str:
    x, z = np.round(MM * place, 2) + 0.0  # + 0.0 turns -0 into 0
    return f"({x:.2f}, {z:.2f}) mm"


def _described(line: Line) -> str:
    wide, high = MM * np.ptp(line.points, axis=0)
    kind = "a closed outline" if line.closed else "an open line"
    return f"{kind} of {wide:.4g} x {high:.4g} mm{f' on {line.layer!r}' if line.layer else ''}"
