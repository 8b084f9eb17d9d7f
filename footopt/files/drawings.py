"""Lines of drawings and tables (DXF, SVG, CSV): their units, and how pieces are joined."""

import logging
import re
from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from footopt.arrays import Array
from footopt.errors import Unusable
from footopt.files.feet import SAME_POINT
from footopt.files.io import numbers, parse_table, read_bytes, read_text

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048, "pt": 0.0254 / 72, "px": 0.0254 / 96}
CHORD_TOLERANCE = 2e-5  # largest distance of a flattened curve from itself, m
JOIN_DISTANCE = 1e-5  # ends of lines nearer than this are one point, m
WITHOUT_HEADER = re.compile(r"(?:\s*#.*\n)*\s*[-+.]?\d[\d.,eE+-]*([;,\t ])")  # and the mark between cells
COLUMN = re.compile(r"([xzy])(?:[_ ]*[(\[]?([a-z]+)[)\]]?)?", re.IGNORECASE)  # and its unit
INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}  # of $INSUNITS
CURVES = ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")
KINDS = ("LINE", "LWPOLYLINE", "POLYLINE", *CURVES)


class Line(NamedTuple):
    """A line of a drawing."""

    points: Array  # (m, 2), m; a closed one does not repeat its first
    closed: bool
    layer: str  # its layer (DXF) or the id of its group (SVG)


def unit_of(units: str | None, own: str | None) -> float:
    """Metres in a unit: the setting's, or else the file's own."""
    unit = units or own
    if unit not in UNITS:
        raise Unusable(f"does not say in which unit it is, or in none of {', '.join(UNITS)}. Set foot.units.")
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


def read_dxf(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield each line of the model space, those in blocks too, scaled and flattened.

    `units` names the file's unit; None: its own.
    """
    from ezdxf import path as curves
    from ezdxf import recover
    from ezdxf.disassemble import recursive_decompose

    content = read_bytes(path, "foot.path")
    if content.startswith(b"AutoCAD Binary DXF"):
        raise Unusable("is a binary DXF file. Save it as text (ASCII) DXF.")
    if content.rstrip()[-3:] != b"EOF":
        raise Unusable("cannot be read as DXF (it does not end with EOF: is it cut off?).")
    logging.getLogger("ezdxf").setLevel(logging.ERROR)  # it logs each fault that it mends
    document, _ = recover.readfile(path)
    stated = b"$INSUNITS" in content  # the library has a unit for drawings that state none
    unit = scale * unit_of(units, INSUNITS.get(document.units) if stated else None)
    for insert in document.query("INSERT"):  # some programs flatten blocks so, which no matrix undoes
        insert.dxf.zscale = insert.dxf.zscale or 1.0
    space = (entity for entity in document.modelspace() if entity.dxftype() in ("INSERT", *KINDS))
    for entity in recursive_decompose(space):
        kind = entity.dxftype()
        if kind not in KINDS or (kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
            continue  # text, or a body
        bulged = "POLYLINE" in kind and entity.has_arc
        for piece in entity.virtual_entities() if bulged else (entity,):
            # a path's arcs are cubics, 0.03 % off
            curve = piece if piece.dxftype() in CURVES else curves.make_path(piece)
            curve = np.array([(v.x, v.y, v.z) for v in curve.flattening(CHORD_TOLERANCE / unit)])
            points = unit * curve.reshape(-1, 3)
            if len(points) and (rise := np.ptp(points[:, 2])) > CHORD_TOLERANCE:
                where = f"a {kind} of layer {entity.dxf.layer} leaves the xy plane by {1e3 * rise:.3g} mm"
                raise Unusable(f"{where}. Draw the side view in x and y.")
            yield from_points(points[:, :2], entity.dxf.layer)


def read_svg(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield each shape and path that is filled or stroked, with its transforms; as `read_dxf`."""
    from svgelements import SVG, Close, Group, Shape, Use
    from svgelements import Path as Curve

    try:
        root = ElementTree.fromstring(read_text(path, "foot.path"))
    except ElementTree.ParseError as error:
        raise Unusable(f"cannot be read as SVG ({error}).") from None
    unit = scale * (UNITS[units] if units else _own_unit(root))
    for name in ("width", "height", "viewBox"):  # without them the library has the file's own numbers
        root.attrib.pop(name, None)

    def lines(group: Any, layer: str) -> Iterator[Line]:
        for element in group:
            if isinstance(element, Group | Use):
                yield from lines(element, element.id or layer)
            elif isinstance(element, Shape) and (element.fill.value, element.stroke.value) != (None, None):
                by = element.transform  # of points: the library cannot skew every shape
                turn = unit * np.array([[by.a, -by.b], [by.c, -by.d], [by.e, -by.f]], float)  # y is down
                for piece in Curve(*element.segments(transformed=False)).as_subpaths():
                    closed = any(isinstance(segment, Close) for segment in piece)
                    yield Line(_flattened(piece, turn), closed, layer)

    yield from lines(SVG.parse(BytesIO(ElementTree.tostring(root)), reify=False), "")


def _flattened(piece: Any, turn: Array) -> Array:
    """The points of a piece of a path, (m, 2), m, by the affine map `turn` (3, 2); curves are flattened."""
    from shapely import LineString, get_coordinates
    from svgelements import Close, Line, Move

    parts = [np.empty((0, 2))]
    for segment in piece:
        if isinstance(segment, Move | Line):
            parts.append(np.array([segment.end], float) @ turn[:2] + turn[2])
        elif not isinstance(segment, Close):
            curve = np.asarray(segment.npoint(np.linspace(0.0, 1.0, 501)), float) @ turn[:2] + turn[2]
            parts.append(get_coordinates(LineString(curve).simplify(CHORD_TOLERANCE / 2))[1:])
    return np.concatenate(parts)


def _own_unit(root: ElementTree.Element) -> float:
    """Metres in one unit of a drawing: its sides in units of length over its viewBox's; the smaller fits."""
    box, sides = root.get("viewBox", "").replace(",", " ").split(), []
    for place, name in ((2, "width"), (3, "height")):
        size = re.fullmatch(r"\s*([\d.eE+-]+?)\s*([a-z]*)\s*", root.get(name, ""))
        if size and size[2] != "px":  # on a screen: programs print 72, 90 or 96 of them to an inch
            length = float(size[1]) * unit_of(None, size[2])
            sides.append(length / float(box[place]) if box else UNITS["px"])
    ratio = root.get("preserveAspectRatio", "")
    if re.search("none|slice", ratio) and sides and max(sides) > 1.001 * min(sides):
        raise Unusable(
            f"is stretched or cut by its preserveAspectRatio, {ratio!r}. Scale its viewBox instead."
        )
    return min(sides) if sides else unit_of(None, None)


def read_table(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield the line in a CSV table: columns x and z (or y), or two without a header; as `read_dxf`."""
    text = read_text(path, "foot.path")
    if match := WITHOUT_HEADER.match(text):
        text = f"x{match[1]}z\n{text}"
    table = parse_table(text)
    columns = {match[1].lower(): match for name in table if (match := COLUMN.fullmatch(name))}
    x, z = columns.get("x"), columns.get("z", columns.get("y"))
    if x is None or z is None:
        found = f"it holds {', '.join(table)[:200]}"
        raise Unusable(f"the header lacks x or z; {found}. Name the columns x_mm and z_mm (or _cm, _m, _in).")
    own = {match[2].lower() for match in (x, z) if match[2]}
    if len(own) > 1:
        raise Unusable(f"its columns are in two units: {x[0]} and {z[0]}.")
    unit = scale * unit_of(units, own.pop() if len(own) == 1 else None)
    yield from_points(
        unit * np.stack([numbers(table, x[0]), numbers(table, z[0])], axis=1), "", JOIN_DISTANCE
    )
