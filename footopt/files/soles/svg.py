"""The lines of an SVG drawing: every shape and path that is filled or stroked, with its transforms."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from footopt.errors import Unusable
from footopt.files.io import read_text
from footopt.files.soles.lines import FLATTEN, PIECES, TOO_MANY, UNITS, Line, unit_of

Array = NDArray[np.float64]

#: Numbers, paths and transforms: the library silently leaves out anything else.
NUMBER = r"[+-]?(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?"
FORMS = {
    "d": re.compile(rf"\s*(?:[Mm](?:[MmZzLlHhVvCcSsQqTtAa\s,]|{NUMBER})*+)?"),
    "transform": re.compile(
        r"(?:\s*(?:matrix|translate|scale|rotate|skewX|skewY)\s*"
        rf"\((?:[\s,]|{NUMBER}(?:mm|cm|in|pt|px|deg|rad)?)*+\)[\s,]*+)*+"
    ),
}
#: Shapes, and their lengths that may be parts of the viewBox's; of a radius in percent the library makes two.
SIZED = ("rect", "circle", "ellipse", "line")
SIZES = ("x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "x1", "y1", "x2", "y2")


def read(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield each line, scaled and flattened; `units` names its unit, or None for the file's own."""
    from svgelements import SVG, Group, Shape, Use
    from svgelements import Path as Curve

    try:
        root = ElementTree.fromstring(read_text(path, "foot.path"))
    except ElementTree.ParseError as error:
        line, column = error.position
        raise Unusable(
            f"cannot be read as SVG (its XML breaks off or is damaged in line {line}, column {column + 1})."
        ) from None
    if root.tag.rpartition("}")[2] != "svg":
        raise Unusable(f"cannot be read as SVG (its root is {root.tag[:60]!r}, not svg).")
    _check(root)
    _hide(root)
    unit = scale * (UNITS[units] if units else _own_unit(root))
    box = re.findall(NUMBER, root.attrib.get("viewBox", ""))[2:]
    for name in ("width", "height", "viewBox"):  # what is left are the drawing's own units ...
        root.attrib.pop(name, None)
    if len(box) == 2:  # ... of which lengths in percent are parts
        root.attrib |= {"width": box[0], "height": box[1], "viewBox": f"0 0 {box[0]} {box[1]}"}

    def lines(group: Any, layer: str) -> Iterator[Line]:
        for element in group:
            if isinstance(element, Group | Use):
                yield from lines(element, element.id or layer)
            elif isinstance(element, Shape) and (element.fill.value, element.stroke.value) != (None, None):
                # the library cannot turn or skew every shape: its points are
                by = element.transform
                turn = np.array([[by.a, by.c, by.e], [by.b, by.d, by.f]], float)
                found = []
                for piece in Curve(*element.segments(transformed=False)).as_subpaths():
                    line = _line(Curve(piece), unit * float(np.linalg.norm(turn[:, :2], 2)), layer)
                    turned = line.points @ turn[:, :2].T + turn[:, 2]
                    found.append(line._replace(points=unit * turned * [1.0, -1.0]))
                sizes = [np.ptp(line.points, axis=0).max() for line in found if len(line.points)]
                filled = element.fill.value is not None and all(line.closed for line in found)
                for line in found:
                    inner = filled and len(line.points) and np.ptp(line.points, axis=0).max() < max(sizes)
                    yield line._replace(inner=bool(inner))

    yield from lines(SVG.parse(io.BytesIO(ElementTree.tostring(root)), reify=False), "")


def _hide(root: ElementTree.Element) -> None:
    """Remove masks, markers and symbols, which the library would draw where they are defined."""
    for parent in list(root.iter()):
        space, brace, _ = parent.tag.rpartition("}")
        for child in list(parent):
            kind = str(child.tag).rpartition("}")[2]
            if kind in ("mask", "marker", "symbol"):
                parent.remove(child)
            if kind == "symbol":  # drawn where it is used
                if "viewBox" in child.attrib:
                    raise Unusable("has a symbol with a viewBox of its own. Draw the sole without symbols.")
                child.tag = f"{space}{brace}g"
                ElementTree.SubElement(root, f"{space}{brace}defs").append(child)


def _check(root: ElementTree.Element) -> None:
    """Raise if a path or a transform is malformed, or there are more points than in any sole."""
    numbers = 0
    for element in root.iter():
        parts = {name for name, value in element.items() if name in SIZES and value.strip().endswith("%")}
        if element.tag.rpartition("}")[2] in SIZED and (
            "r" in parts or (parts and "viewBox" not in root.attrib)
        ):
            raise Unusable(
                f"has a shape with a length in percent ({', '.join(sorted(parts))}). Give it in units."
            )
        numbers += len(re.findall(r"\d+", element.get("d", "") + element.get("points", "")))
        for name, form in FORMS.items():
            given = element.get(name, "")
            if not form.fullmatch(given):
                begin = form.match(given)
                at = begin.end() if begin else 0
                raise Unusable(f"cannot be read as SVG ({name} has {given[at : at + 30]!r}).")
    if numbers > 20 * PIECES:
        raise Unusable(TOO_MANY)


def _line(piece: Any, unit: float, layer: str) -> Line:
    """One piece of a path, flattened, in the file's units, of which one becomes at most `unit` m."""
    from svgelements import Close, Move
    from svgelements import Line as Straight

    points: list[Array] = []
    for segment in piece:
        if isinstance(segment, Move | Straight):
            points.append(np.array([segment.end], float))
        elif not isinstance(segment, Close):
            points.append(_flattened(segment.npoint, FLATTEN / unit)[1:])
    line = np.concatenate([*points, np.empty((0, 2))])
    return Line(line, any(isinstance(segment, Close) for segment in piece), layer)


def _flattened(at: Callable[[Array], Array], tolerance: float) -> Array:
    """Points on a curve at(t), t in [0, 1], so many that no chord's middle is off by the tolerance."""
    pieces = 8
    while True:
        points = np.asarray(at(np.linspace(0.0, 1.0, 2 * pieces + 1)), float)
        off = points[1::2] - 0.5 * (points[:-1:2] + points[2::2])
        if np.linalg.norm(off, axis=1).max() <= tolerance or pieces >= 4096:
            return points
        pieces *= 2


def _own_unit(root: ElementTree.Element) -> float:
    """Metres in one unit of a drawing: its width in units of length over its viewBox's."""
    sizes = [re.fullmatch(rf"\s*({NUMBER})\s*([a-z]*)\s*", root.get(n, "")) for n in ("width", "height")]
    # a size in px is one on a screen: programs print 72, 90 or 96 of them to an inch
    own = [float(size[1]) * unit_of(None, size[2]) for size in sizes if size and size[2] != "px"]
    if not own:
        return unit_of(None, None)
    if "viewBox" not in root.attrib:
        return UNITS["px"]
    given = root.attrib["viewBox"]
    box = re.fullmatch(rf"\s*{NUMBER}[\s,]+{NUMBER}[\s,]+({NUMBER})[\s,]+({NUMBER})\s*", given)
    sides = [float(side) for side in box.groups()] if box else []
    if not sides or not all(0 < value < np.inf for value in (*own, *sides)):
        raise Unusable(
            f"its size is no size: width {root.get('width')!r}, height {root.get('height')!r}, "
            f"viewBox {given[:60]!r}. Set foot.units to the drawing's unit."
        )
    return min(length / side for length, side in zip(own, sides, strict=False))
