"""The lines of a DXF drawing's model space, those in blocks too."""

import logging
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from footopt.errors import Unusable
from footopt.files.io import read_bytes
from footopt.files.soles.lines import CHORD_TOLERANCE, Line, from_points, unit_of

UNITS = {1: "in", 4: "mm", 5: "cm", 6: "m"}  # of $INSUNITS
CURVES = ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")
KINDS = ("LINE", "LWPOLYLINE", "POLYLINE", *CURVES)


def read(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield each line, scaled and flattened; `units` names its unit, or None for the file's own."""
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
    unit = scale * unit_of(units, UNITS.get(document.units) if stated else None)
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
            points = unit * np.array([(v.x, v.y) for v in curve.flattening(CHORD_TOLERANCE / unit)])
            yield from_points(points.reshape(-1, 2), entity.dxf.layer)
