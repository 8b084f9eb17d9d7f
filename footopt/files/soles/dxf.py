"""The lines of a DXF drawing's model space, those in blocks too."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from footopt.errors import Unusable
from footopt.files.io import read_bytes
from footopt.files.soles.lines import FLATTEN, PIECES, Line, from_points, unit_of

UNITS = {1: "in", 4: "mm", 5: "cm", 6: "m"}  # of $INSUNITS
CURVES = ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")
KINDS = ("LINE", "LWPOLYLINE", "POLYLINE", *CURVES)


def read(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield each line, scaled and flattened; `units` names its unit, or None for the file's own."""
    from ezdxf import path as curves

    document, stated = _document(path)
    unit = scale * unit_of(units, UNITS.get(document.units) if stated else None)
    for insert in document.query("INSERT"):  # some programs flatten blocks so, which no matrix undoes
        insert.dxf.zscale = insert.dxf.zscale or 1.0
    for entity in _drawn(document.modelspace()):
        if entity.dxftype() == "POLYLINE" and (entity.is_poly_face_mesh or entity.is_polygon_mesh):
            continue  # a body
        bulged = "POLYLINE" in entity.dxftype() and entity.has_arc
        for piece in entity.virtual_entities() if bulged else (entity,):
            # a path's arcs are cubics, 0.03 % off
            curve = piece if piece.dxftype() in CURVES else curves.make_path(piece)
            vertices = islice(curve.flattening(FLATTEN / unit), 10 * PIECES + 1)
            points = unit * np.array([(v.x, v.y) for v in vertices]).reshape(-1, 2)
            yield from_points(points, entity.dxf.layer)


def _drawn(entities: Iterable[Any]) -> Iterator[Any]:
    """The lines among entities and in their blocks: those of dimensions and leaders are none."""
    for entity in entities:
        if entity.dxftype() == "INSERT":
            for one in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _drawn(one.virtual_entities())
        elif entity.dxftype() in KINDS:
            yield entity


def _document(path: Path) -> tuple[Any, bool]:
    """A drawing that is whole, and whether it says its unit: the library has one for those that do not."""
    import ezdxf
    from ezdxf import recover

    content = read_bytes(path, "foot.path")
    if content.startswith(b"AutoCAD Binary DXF"):
        raise Unusable("is a binary DXF file. Save it as text (ASCII) DXF.")
    if content.rstrip()[-3:] != b"EOF":
        raise Unusable("cannot be read as DXF (it does not end with EOF: is it cut off?).")
    logging.getLogger("ezdxf").setLevel(logging.ERROR)  # what it mends is not the user's concern
    stated = b"$INSUNITS" in content
    try:
        return ezdxf.readfile(path), stated
    except (ezdxf.DXFError, ValueError):  # a line's x before its y, an empty handle, a style without a name
        document, auditor = recover.readfile(path)
        if auditor.has_errors or auditor.has_fixes:
            raise
        return document, stated
