"""The lines of an SVG drawing: every shape and path that is filled or stroked, with its transforms."""

import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from footopt.arrays import Array
from footopt.errors import Unusable
from footopt.files.io import read_text
from footopt.files.soles.lines import CHORD_TOLERANCE, UNITS, Line, unit_of


def read(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield each line, scaled and flattened; `units` names its unit, or None for the file's own."""
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
                    yield Line(_points(piece, turn), closed, layer)

    yield from lines(SVG.parse(io.BytesIO(ElementTree.tostring(root)), reify=False), "")


def _points(piece: Any, turn: Array) -> Array:
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
    """Metres in one unit of a drawing: its width in units of length over its viewBox's."""
    size = re.fullmatch(r"\s*([\d.eE+-]+?)\s*([a-z]*)\s*", root.get("width", ""))
    if size is None or size[2] == "px":  # on a screen: programs print 72, 90 or 96 of them to an inch
        return unit_of(None, None)
    width = float(size[1]) * unit_of(None, size[2])
    if "viewBox" not in root.attrib:
        return UNITS["px"]
    return width / float(root.attrib["viewBox"].replace(",", " ").split()[2])
