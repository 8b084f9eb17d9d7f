"""A sole from a drawing or a table: DXF, SVG or CSV.

A drawing's polylines, lines, arcs and splines are flattened, and joined where their ends meet. One line
must remain: an open one is the sole as it is; of a closed one the sole is the lower edge, between its
leftmost and its rightmost points. x is to the toe and z up, and the file's origin is the foot frame's.
"""

from __future__ import annotations

import io
import logging
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, SettingError, check
from footopt.files.drawings import MM, SOLE
from footopt.files.polygon import SAME, crossing
from footopt.files.reading import DEPTH, named, number, read_bytes, read_table, read_text

Array = NDArray[np.float64]

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "pt": 0.0254 / 72, "px": 0.0254 / 96}  # m
FLATTEN = 2e-5  # largest distance of a flattened curve from itself, m
JOIN = 1e-5  # ends of lines nearer than this are one point, m
LENGTHS = (5e-3, 1.5)  # of a sole, m; anything else is a mistake in the units
STEEPEST = 2.0  # a sole's height over its length; the paper's steepest shape has 1/2
PIECES = 5_000  # lines of a drawing, and points of a sole: more would take longer than anyone waits
SPIKE = 20.0  # deg; a sharper angle inside a sole is a wrong point
WORLD = 1e9  # m; no drawing has a point farther from its origin
FAR = 1e4  # m; a circle of a larger radius has more points than any sole
DXF_UNITS = {1: "in", 4: "mm", 5: "cm", 6: "m"}  # of $INSUNITS

#: SVG's numbers, paths and transforms: a drawing program leaves out silently what is none of them.
NUMBER = r"[+-]?(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?"
PATH_DATA = re.compile(rf"\s*(?:[Mm](?:[MmZzLlHhVvCcSsQqTtAa\s,]|{NUMBER})*+)?")
TRANSFORM = re.compile(
    r"(?:\s*(?:matrix|translate|scale|rotate|skewX|skewY)\s*"
    rf"\((?:[\s,]|{NUMBER}(?:mm|cm|in|pt|px|deg|rad)?)*+\)[\s,]*+)*+"
)

DXF_LINES = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE")


class Line(NamedTuple):
    """A line of a drawing: (m, 2), m; `layer` is its layer (DXF) or the id of its group (SVG)."""

    points: Array
    closed: bool
    layer: str


def read(
    path: str | Path,
    units: str | None = None,
    scale: float = 1.0,
    layer: str | None = None,
    toe: str = "right",
    origin: str = "file",
) -> Array:
    """The sole in a file, from heel to toe, (m, 2), m.

    Parameters
    ----------
    path : ends in .dxf, .svg or .csv.
    units : what one unit of the file is, a name in `UNITS`; None: as the file says.
    scale : multiplies all lengths.
    layer : of the line, if the drawing holds others; by default SOLE if there is such a layer.
    toe : "right", or "left" for a drawing that is to be mirrored.
    origin : "file", or "centre" for the middle of the line's bounding box.

    Raises
    ------
    FileError : the file cannot be read, or does not hold one line that can be a sole.
    SettingError : one of the settings above cannot be used.
    """
    check(units is None or units in UNITS, "foot.units", units, f"one of {', '.join(UNITS)}, or null")
    check(0 < scale < np.inf, "foot.scale", scale, "a number > 0")
    check(toe in ("right", "left"), "foot.toe", toe, "right or left: where the toe is in the drawing")
    check(origin in ("file", "centre"), "foot.origin", origin, "file or centre")
    chain = the_line(lines_of(path, units), path, layer)
    points = scale * chain.points * ([-1.0, 1.0] if toe == "left" else 1.0)
    length = np.ptp(points[:, 0])
    if not LENGTHS[0] <= length <= LENGTHS[1]:
        raise FileError(
            f"{_named(path)}: the sole would be {length:.4g} m long. Set foot.units to the unit of the file "
            f"({', '.join(UNITS)}), or foot.scale."
        )
    height, far = np.ptp(points[:, 1]), float(np.abs(points[:, 1]).max())
    if height > STEEPEST * length or (origin == "file" and far > 10.0 * length):
        raise FileError(
            f"{_named(path)}: the line is {length:.4g} m long, {height:.4g} m high and reaches {far:.4g} m "
            "from the origin's height, which no sole does. Is a point wrong, or the place of the origin?"
        )
    if len(points) > PIECES:
        raise FileError(
            f"{_named(path)}: the line has {len(points)} points, and must have at most {PIECES}. Thin it out."
        )
    place = crossing(points, chain.closed)
    if place is not None:
        raise FileError(f"{_named(path)}: the line crosses itself at {_where(place)}.")
    if origin == "centre":
        points = points - 0.5 * (points.min(axis=0) + points.max(axis=0))
    elif not points[:, 0].min() < 0.0 < points[:, 0].max():
        low, high = MM * points[:, 0].min(), MM * points[:, 0].max()
        raise FileError(
            f"{_named(path)}: its origin is not above the foot, which lies between x {low:.4g} and "
            f"{high:.4g} mm. The ankle is measured from there: move the drawing, or set "
            "foot.origin=centre for the middle of the line's box."
        )
    sole = lower_edge(points) if chain.closed else _from_heel(points, path)
    steps = np.diff(sole, axis=0)
    along = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    turn = -np.sum(along[1:] * along[:-1], axis=1)  # the cosine of the angle inside
    if turn.max(initial=-1.0) > np.cos(np.radians(SPIKE)):
        tip = sole[1 + int(np.argmax(turn))]
        raise FileError(
            f"{_named(path)}: the sole has a spike at {_where(tip)}, sharper than {SPIKE:g} deg: is a "
            "point wrong?"
        )
    return sole


def lower_edge(outline: Array) -> Array:
    """The lower edge of a closed outline, from its leftmost to its rightmost point, (m, 2).

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


def the_line(lines: Sequence[Line], path: str | Path, layer: str | None = None) -> Line:
    """The one line of a drawing, its pieces joined.

    Raises
    ------
    FileError : there is none, or more than one. SettingError : there is no such layer.
    """
    layers = sorted({line.layer for line in lines})
    if layer is not None and layer not in layers:
        held = ", ".join(map(repr, layers)) or "none"
        raise SettingError("foot.layer", layer, "a layer with lines", f"{Path(path).name} has {held}.")
    if layer is None and SOLE in layers:
        layer = SOLE
    found = join([line for line in lines if layer in (None, line.layer)])
    if len(found) == 1:
        return found[0]
    if not found:
        raise FileError(f"{_named(path)}: holds no line, arc, spline or polyline.")
    told = "; ".join(_told(line) for line in found[:6]) + ("; ..." if len(found) > 6 else "")
    raise FileError(
        f"{_named(path)}: must hold one line that is the sole, or one closed outline; it holds "
        f"{len(found)}: {told}. Choose one with foot.layer (there: {', '.join(layers)}), delete what is "
        f"not the sole, or close gaps wider than {MM * JOIN:g} mm."
    )


def join(lines: Sequence[Line]) -> list[Line]:
    """Lines joined where their ends, and no third line's, meet within `JOIN`."""
    ends = np.array([line.points[[0, -1]] for line in lines]).reshape(-1, 2, 2)
    left = np.ones(len(lines), bool)
    left[[i for i, line in enumerate(lines) if line.closed]] = False  # to be joined with
    done: list[Line] = []
    for i, line in enumerate(lines):
        if not (line.closed or left[i]):
            continue
        left[i] = False
        while not line.closed:
            first, last = line.points[0], line.points[-1]
            if np.linalg.norm(first - last) <= JOIN and len(line.points) > 3:
                line = Line(line.points[:-1], True, line.layer)
                break
            gaps = np.min([np.linalg.norm(ends - end, axis=2).min(axis=1) for end in (first, last)], axis=0)
            near = np.flatnonzero(left & (gaps <= JOIN))
            if len(near) == 0:
                break
            left[near[0]] = False
            line = Line(_chained(line.points, lines[near[0]].points), False, line.layer)
        before = np.roll(line.points, 1, axis=0)
        keep = np.linalg.norm(line.points - before, axis=1) > 0.1 * JOIN
        keep[0] |= not line.closed
        points = line.points[keep]
        if len(points) > (2 if line.closed else 1):
            done.append(line._replace(points=points))
    return done


def _chained(a: Array, b: Array) -> Array:
    """Two lines with an end in common as one."""
    if np.linalg.norm(a[[0, 0]] - b[[0, -1]], axis=1).min() <= JOIN:
        a = a[::-1]
    if np.linalg.norm(a[-1] - b[0]) > JOIN:
        b = b[::-1]
    return np.concatenate([a, b[1:]])


def lines_of(path: str | Path, units: str | None = None) -> list[Line]:
    """All lines of a file, by its ending."""
    readers: dict[str, Callable[[Path, str | None], Iterator[Line]]]
    readers = {".dxf": _dxf, ".svg": _svg, ".csv": _csv}
    suffix = Path(path).suffix.lower()
    if suffix not in readers:
        raise SettingError("foot.path", str(path), f"a file that ends in {', '.join(readers)}")
    lines, points = [], 0
    for line in readers[suffix](Path(path), units):
        if not (abs(line.points) < WORLD).all():
            raise FileError(f"{_named(path)}: a line has a point that is not a finite number, or far away.")
        lines.append(line)
        points += len(line.points)
        if len(lines) > PIECES or points > 10 * PIECES:
            raise _too_many(path)
    return lines


def _dxf(path: Path, units: str | None) -> Iterator[Line]:
    """Lines of a drawing's model space, those in blocks too."""
    from ezdxf import path as curves
    from ezdxf.disassemble import recursive_decompose

    document = _dxf_document(path)
    unit = _unit(path, units, DXF_UNITS.get(document.units))
    drawn = [e for e in document.modelspace() if e.dxftype() in ("INSERT", *DXF_LINES)]
    if _weight(document, drawn, {}) > PIECES:
        raise _too_many(path)
    try:
        for entity in recursive_decompose(drawn):
            bulged = "POLYLINE" in entity.dxftype() and entity.has_arc
            for piece in entity.virtual_entities() if bulged else (entity,):
                if piece.dxftype() not in DXF_LINES:
                    continue
                curved = piece.dxftype() in ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")
                if curved and not _reach(piece) * unit <= FAR:
                    raise ValueError(f"a {piece.dxftype().lower()} is larger than {FAR:g} m")
                # a path's arcs are cubics, .03 % off
                flattened = (piece if curved else curves.make_path(piece)).flattening(FLATTEN / unit)
                few = islice(flattened, 10 * PIECES + 1)
                points = unit * np.array([(v.x, v.y) for v in few]).reshape(-1, 2)
                closed = len(points) > 3 and bool(np.linalg.norm(points[0] - points[-1]) <= SAME)
                if len(points) > 1:
                    yield Line(points[:-1] if closed else points, closed, entity.dxf.layer)
    except Exception as error:  # of a spline without knots, a line without an end, ...
        raise _unreadable(path, error) from error


def _dxf_document(path: Path) -> Any:
    """A drawing that is whole."""
    import ezdxf

    content = read_bytes(path, "sole", "foot.path")
    if content.startswith(b"AutoCAD Binary DXF"):
        raise FileError(f"{_named(path)}: is a binary DXF file. Save it as text (ASCII) DXF.")
    if content.rstrip()[-3:] != b"EOF":
        raise FileError(f"{_named(path)}: cannot be read as DXF (it does not end with EOF: is it cut off?).")
    logging.getLogger("ezdxf").setLevel(logging.ERROR)  # it tells what it mends: not the user's concern
    try:
        return ezdxf.readfile(path)
    except Exception as error:  # of damage, the library raises what it meets
        raise _unreadable(path, error) from error


def _weight(document: Any, entities: Iterable[Any], known: dict[str, float]) -> float:
    """Entities that a drawing has once its blocks are inserted; those in themselves have no end."""
    total = 0.0
    for entity in entities:
        if entity.dxftype() != "INSERT":
            total += 1
            continue
        name = str(entity.dxf.name)
        if name not in known:
            known[name] = np.inf
            block = document.blocks.get(name)
            known[name] = 1 + (0 if block is None else _weight(document, block, known))
        total += abs(entity.mcount) * known[name]
    return total


def _reach(curve: Any) -> float:
    """The size of a curve's numbers, in the drawing's unit."""
    if curve.dxftype() == "SPLINE":
        points = [*curve.control_points, *curve.fit_points]
        return float(np.abs(np.array(points, float)).max(initial=0.0))
    if curve.dxftype() == "ELLIPSE":
        return float(curve.dxf.major_axis.magnitude)
    return abs(float(curve.dxf.radius))


def _svg(path: Path, units: str | None) -> Iterator[Line]:
    """Shapes of a drawing; the y-axis of the file points down."""
    from svgelements import SVG, Group, Shape
    from svgelements import Path as Curve

    try:
        root = ElementTree.fromstring(read_text(path, "sole", "foot.path"))
    except (ElementTree.ParseError, ValueError) as error:  # an encoding that it names and does not have
        raise _unreadable(path, error) from error
    if root.tag.rpartition("}")[2] != "svg":
        raise FileError(f"{_named(path)}: cannot be read as SVG (its root is {root.tag[:60]!r}, not svg).")
    _check_svg(path, root)
    unit = _svg_unit(path, root, units)
    for name in ("width", "height", "viewBox"):  # what is left are the drawing's own units
        root.attrib.pop(name, None)

    def lines(group: Any, layer: str) -> Iterator[Line]:
        for element in group:
            if isinstance(element, Group):
                yield from lines(element, element.id or layer)
            elif isinstance(element, Shape):
                for piece in Curve(element).as_subpaths():
                    yield from _svg_line(Curve(piece), unit, layer)

    try:
        yield from lines(SVG.parse(io.BytesIO(ElementTree.tostring(root)), reify=True), "")
    except Exception as error:  # of a path that is no path, the library raises what it meets
        raise _unreadable(path, error) from error


def _check_svg(path: Path, root: ElementTree.Element) -> None:
    """Raise if a drawing is too large once its uses are followed, or nests too deeply."""
    for element in root.iter():
        for name, form in (("d", PATH_DATA), ("transform", TRANSFORM)):
            given = element.get(name, "")
            if not form.fullmatch(given):
                begin = form.match(given)
                at = begin.end() if begin else 0
                raise FileError(
                    f"{_named(path)}: cannot be read as SVG ({name} has {given[at : at + 30]!r})."
                )
    by_id = {element.get("id", ""): element for element in root.iter()}
    known: dict[ElementTree.Element, float] = {}

    def weight(element: ElementTree.Element, depth: int) -> float:
        if depth > DEPTH:
            raise FileError(f"{_named(path)}: cannot be read as SVG (it nests deeper than {DEPTH} levels).")
        if element not in known:
            known[element] = np.inf  # what uses itself has no end
            numbers = len(re.findall(r"\d+", element.get("d", "") + element.get("points", "")))
            link = next((v for k, v in element.items() if k.rpartition("}")[2] == "href"), "")
            used = by_id.get(link.lstrip("#")) if element.tag.rpartition("}")[2] == "use" else None
            parts = [*element] if used is None else [*element, used]
            known[element] = 1 + numbers / 20 + sum(weight(part, depth + 1) for part in parts)
        return known[element]

    if weight(root, 0) > PIECES:
        raise _too_many(path)


def _svg_line(piece: Any, unit: float, layer: str) -> Iterator[Line]:
    """One piece of an SVG path, flattened."""
    from svgelements import Close, Move
    from svgelements import Line as Straight

    points: list[Array] = []
    for segment in piece:
        if isinstance(segment, Move | Straight):
            points.append(np.array([segment.end], float))
        elif not isinstance(segment, Close):
            points.append(_flattened(segment.npoint, FLATTEN / unit)[1:])
    line = unit * np.concatenate(points) * [1.0, -1.0] if points else np.empty((0, 2))
    if len(line) > 1:
        yield Line(line, any(isinstance(segment, Close) for segment in piece), layer)


def _flattened(at: Callable[[Array], Array], tolerance: float) -> Array:
    """Points on a curve at(t), t in [0, 1], so many that no chord's middle is off by the tolerance."""
    pieces = 8
    while True:
        points = np.asarray(at(np.linspace(0.0, 1.0, 2 * pieces + 1)), float)
        off = points[1::2] - 0.5 * (points[:-1:2] + points[2::2])
        if np.linalg.norm(off, axis=1).max() <= tolerance or pieces >= 4096:
            return points
        pieces *= 2


def _svg_unit(path: Path, root: ElementTree.Element, units: str | None) -> float:
    """Metres in one user unit of a drawing: its width in units of length over its viewBox's."""
    if units is not None:
        return UNITS[units]
    sizes = [re.fullmatch(rf"\s*({NUMBER})\s*([a-z]*)\s*", root.get(n, "")) for n in ("width", "height")]
    # a size in px is one on a screen: programs print 72, 90 or 96 of them to an inch
    own = [float(size[1]) * _unit(path, None, size[2]) for size in sizes if size and size[2] != "px"]
    if not own:
        return _unit(path, None, None)
    if "viewBox" not in root.attrib:
        return UNITS["px"]
    given = root.attrib["viewBox"]
    box = re.fullmatch(rf"\s*{NUMBER}[\s,]+{NUMBER}[\s,]+({NUMBER})[\s,]+({NUMBER})\s*", given)
    sides = [float(side) for side in box.groups()] if box else []
    if not sides or not all(0 < value < np.inf for value in (*own, *sides)):
        raise FileError(
            f"{_named(path)}: its size is no size: width {root.get('width')!r}, height "
            f"{root.get('height')!r}, viewBox {given[:60]!r}. Set foot.units to the drawing's unit."
        )
    return min(length / side for length, side in zip(own, sides, strict=False))


def _csv(path: Path, units: str | None) -> Iterator[Line]:
    """One line: columns x and z (or y), or the first two; a closed one ends where it began."""
    rows = [
        line
        for line in read_table(path, "sole", "foot.path").splitlines()
        if line.strip() and not line.startswith("#")
    ]
    names = [] if not rows or _numbers(rows[0]) else [w.strip().lower() for w in re.split(r"[,;\t]", rows[0])]
    found = [re.fullmatch(r"([xzy])(?:[_ ]*[(\[]?([a-z]+)[)\]]?)?", name) for name in names]
    column = {match[1]: i for i, match in enumerate(found) if match}
    if names and not ("x" in column and column.keys() & {"z", "y"}):
        raise FileError(
            f"{_named(path)}: the header lacks x or z; it holds {', '.join(names)}. "
            "Name the columns x_mm and z_mm (or _cm, _m, _in), from heel to toe."
        )
    own = {match[2] for match in found if match and match[2]}
    unit = _unit(path, units, own.pop() if len(own) == 1 else None)
    places = [column["x"], column.get("z", column.get("y", 1))] if names else [0, 1]
    points, wide = [], len(names)
    for i, row in enumerate(rows[1:] if names else rows, start=1):
        numbers = _numbers(row)
        wide = len(numbers) if i == 1 and not names else wide
        if len(numbers) <= max(places) or len(numbers) != wide or not np.isfinite(numbers).all():
            raise FileError(f"{_named(path)}: row {i} of the table is not numbers: {row.strip()[:60]!r}.")
        points.append([numbers[place] for place in places])
    line = unit * np.array(points, float).reshape(-1, 2)
    closed = len(line) > 3 and bool(np.linalg.norm(line[0] - line[-1]) <= JOIN)
    if len(line) > 1:
        yield Line(line[:-1] if closed else line, closed, "")


def _numbers(row: str) -> list[float]:
    """The numbers of a row, or none; a semicolon between them allows a decimal comma."""
    cells = row.replace(",", ".").split(";") if ";" in row else re.split(r"[,\s]+", row.strip().strip(","))
    try:
        return [number(cell) for cell in cells]
    except ValueError:
        return []


def _from_heel(line: Array, path: str | Path) -> Array:
    """An open line from left to right."""
    heel, toe = line[0], line[-1]
    if abs(toe[0] - heel[0]) <= JOIN:
        raise FileError(
            f"{_named(path)}: the line begins at {_where(heel)} and ends at {_where(toe)}: "
            "which end is the heel? Close the outline, or leave only the sole."
        )
    return line if toe[0] > heel[0] else line[::-1]


def _unit(path: Path, units: str | None, own: str | None) -> float:
    """Metres in a unit: the setting's, or else the file's own."""
    unit = units or own
    if unit not in UNITS:
        said = f", or says {unit!r}" if unit else ""
        raise FileError(
            f"{_named(path)}: does not say in which unit it is{said}. "
            f"Set foot.units to one of {', '.join(UNITS)}."
        )
    return UNITS[unit]


def _too_many(path: str | Path) -> FileError:
    return FileError(
        f"{_named(path)}: holds more than {PIECES} lines or {10 * PIECES} points. Leave only the sole."
    )


def _unreadable(path: Path, error: Exception) -> FileError:
    if isinstance(error, FileError):
        return error
    return FileError(f"{_named(path)}: cannot be read as {path.suffix[1:].upper()} ({error}).")


def _named(path: str | Path) -> str:
    return named(path, "foot.path")


def _where(place: Array) -> str:
    return f"({MM * place[0]:.2f}, {MM * place[1]:.2f}) mm"


def _told(line: Line) -> str:
    wide, high = MM * np.ptp(line.points, axis=0)
    kind = "a closed outline" if line.closed else "an open line"
    return f"{kind} of {wide:.4g} x {high:.4g} mm{f' on {line.layer!r}' if line.layer else ''}"
