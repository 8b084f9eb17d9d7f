"""Soles from drawings and tables (DXF, SVG, CSV), as points.

A drawing's polylines, lines, arcs and splines are flattened, and joined where their ends meet. One line
must remain: an open one is the sole as it is; of a closed one the sole is the lower edge, between its
leftmost and its rightmost points. x is to the toe and z up, and the file's origin is the foot frame's.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, SettingError, Unusable, check, naming
from footopt.files.drawings import MM, SOLE
from footopt.files.soles import dxf, svg, table
from footopt.files.soles.lines import JOIN, PIECES, TOO_MANY, UNITS, Line, crossing, join
from footopt.foot import Foot

Array = NDArray[np.float64]

READERS = {".dxf": dxf.read, ".svg": svg.read, ".csv": table.read}
LENGTHS = (5e-3, 0.6)  # of a sole, m; anything else is a mistake in the units, as cm for inches
STEEPEST = 2.0  # a sole's height over its length; the paper's steepest shape has 1/2
SPIKE = 20.0  # deg; a sharper angle inside a sole is a wrong point
HOLE = 0.5  # of an outline's length; a larger line inside it may be the sole itself
LISTED = 4  # of a drawing's lines, in a message
WORLD = 1e9  # m; no drawing has a point farther from its origin


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
        Its notes tell what of the file was left out.

    Raises
    ------
    FileError
        The file cannot be read, or does not hold one line that can be a sole.
    SettingError
        One of the settings above cannot be used.
    """
    check(units is None or units in UNITS, "foot.units", units, f"one of {', '.join(UNITS)}, or null")
    check(0 < scale < np.inf, "foot.scale", scale, "a number > 0")
    check(toe in ("right", "left"), "foot.toe", toe, "right or left: where the toe is in the drawing")
    check(origin in ("file", "centre"), "foot.origin", origin, "file or centre")
    path = Path(path)
    check(path.suffix.lower() in READERS, "foot.path", str(path), f"a file that ends in {', '.join(READERS)}")
    with naming(path, "foot.path"):
        line, notes = the_line(lines_of(path, units, scale), path.name, layer)
        points = line.points * ([-1.0, 1.0] if toe == "left" else 1.0)
        check_size(points, origin)
        place = crossing(points, line.closed)
        if place is not None:
            raise Unusable(f"the line crosses itself at {_where(place)}.")
        if origin == "centre":
            points = points - 0.5 * (points.min(axis=0) + points.max(axis=0))
        sole = lower_edge(points) if line.closed else _from_heel(points)
        check_spikes(sole)
    return Foot(sole, name=path.stem, notes=notes, **parameters)


def lines_of(path: Path, units: str | None = None, scale: float = 1.0) -> list[Line]:
    """All lines of a file, by its ending, scaled; raises `Unusable` where it cannot be read."""
    lines, points = [], 0
    try:
        for line in READERS[path.suffix.lower()](path, units, scale):
            lines.append(line)
            points += len(line.points)
            if len(lines) > PIECES or points > 10 * PIECES:
                raise Unusable(TOO_MANY)
    except (Unusable, FileError):
        raise
    except Exception as error:  # libraries raise all kinds; their words help nobody
        raise Unusable(
            f"cannot be read as {path.suffix[1:].upper()}: it is damaged, or something else. Open it in the "
            "program that made it, and save it again."
        ) from error
    if not all((abs(line.points) < WORLD).all() for line in lines):
        raise Unusable("a line has a point that is not a finite number, or far away.")
    return [line for line in lines if len(line.points) > 1]


def the_line(lines: Sequence[Line], name: str, layer: str | None = None) -> tuple[Line, tuple[str, ...]]:
    """The one line of a drawing, its pieces joined, or the outline that has all others for holes; and notes.

    Raises `Unusable` if there is no such line.
    """
    layers = sorted({line.layer for line in lines})
    if layer is not None and layer not in layers:
        held = ", ".join(map(repr, layers)) or "none"
        raise SettingError("foot.layer", layer, "a layer with lines", f"{name} has {held}.")
    if layer is None and SOLE in layers:
        layer = SOLE
    lines = [line for line in lines if layer in (None, line.layer)]
    found = join([line for line in lines if not line.inner])
    if not found:
        raise Unusable("holds no line, arc, spline or polyline.")
    found += [line for line in lines if line.inner]
    if len(found) > 1 and _has_holes(*found):
        told = ", ".join(_described(line) for line in found[1:6]) + (", ..." if len(found) > 6 else "")
        return found[0], (f"{name}: the outer line is read, {_described(found[0])}; not its holes: {told}",)
    if len(found) > 1:
        choose = (
            f"Choose one with foot.layer (there: {', '.join(filter(None, layers))}), d"
            if len(layers) > 1
            else "D"
        )
        told = "; ".join([*map(_described, found[:LISTED]), *(["..."] if len(found) > LISTED else [])])
        raise Unusable(
            "must hold one line that is the sole, or one closed outline; it holds "
            f"{len(found)}: {told}. {choose}elete what is "
            f"not the sole, or close gaps wider than {MM * JOIN:g} mm."
        )
    return found[0], ()


def _has_holes(outer: Line, *others: Line) -> bool:
    """Whether a closed line holds all others, closed and much smaller: a frame round a sole is no outline.

    The inner lines of its own shape, which is filled between them, may be of any size.
    """
    from shapely import Polygon

    if not (outer.closed and (body := Polygon(outer.points)).is_valid):
        return False
    length = HOLE * np.ptp(outer.points[:, 0])
    return all(
        o.closed and (o.inner or np.ptp(o.points, axis=0).max() < length) and body.contains(Polygon(o.points))
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
    same = JOIN + 1e-9 * np.ptp(x)
    ends = [int(np.argmin(np.where(side <= same, z, np.inf))) for side in (x - x.min(), x.max() - x)]
    rolled = np.roll(outline, -ends[0], axis=0)
    return rolled[: (ends[1] - ends[0]) % len(outline) + 1]


def check_size(points: Array, origin: str) -> None:
    """Raise unless a line (m, 2) has a sole's size and place."""
    (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
    length, height, far = right - left, high - low, max(-low, high)
    if not LENGTHS[0] <= length <= LENGTHS[1]:
        raise Unusable(
            f"the sole would be {length:.4g} m long. Set foot.units to the unit of the file "
            f"({', '.join(UNITS)}), or foot.scale."
        )
    if height > STEEPEST * length:
        raise Unusable(
            f"the line is {length:.4g} m long and {height:.4g} m high, and a sole is drawn from the side, "
            "heel and toe left and right: is it a view from above, turned, or is a point wrong?"
        )
    if origin == "file" and far > 10.0 * length:
        raise Unusable(
            f"the line is {length:.4g} m long and reaches {far:.4g} m from the origin's height, which no "
            "sole does. Is a point wrong, or the place of the origin?"
        )
    if len(points) > PIECES:
        raise Unusable(f"the line has {len(points)} points, and must have at most {PIECES}. Thin it out.")
    if origin == "file" and not left < 0.0 < right:
        raise Unusable(
            f"its origin is not above the foot, which lies between x {MM * left:.4g} and {MM * right:.4g} "
            "mm. The ankle is measured from there: move the drawing, or set foot.origin=centre for the "
            "middle of the line's box."
        )


def check_spikes(sole: Array) -> None:
    """Raise if a corner of a sole (m, 2) is sharper than `SPIKE`."""
    steps = np.diff(sole, axis=0)
    along = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    turn = -np.sum(along[1:] * along[:-1], axis=1)  # the cosine of the angle inside
    if turn.max(initial=-1.0) > np.cos(np.radians(SPIKE)):
        tip = _where(sole[1 + int(np.argmax(turn))])
        raise Unusable(f"the sole has a spike at {tip}, sharper than {SPIKE:g} deg: is a point wrong?")


def _from_heel(line: Array) -> Array:
    """An open line from left to right."""
    heel, toe = line[0], line[-1]
    if abs(toe[0] - heel[0]) <= JOIN:
        raise Unusable(
            f"the line begins at {_where(heel)} and ends at {_where(toe)}: "
            "which end is the heel? Close the outline, or leave only the sole."
        )
    return line if toe[0] > heel[0] else line[::-1]


def _where(place: Array) -> str:
    x, z = np.round(MM * place, 2) + 0.0  # + 0.0 turns -0 into 0
    return f"({x:.2f}, {z:.2f}) mm"


def _described(line: Line) -> str:
    wide, high = MM * np.ptp(line.points, axis=0)
    kind = "a closed outline" if line.closed else "an open line"
    return f"{kind} of {wide:.4g} x {high:.4g} mm{f' on {line.layer!r}' if line.layer else ''}"
