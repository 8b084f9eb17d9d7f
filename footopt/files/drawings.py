"""Drawings of a foot: the sole as CSV, its outline and sole as DXF and SVG, in millimetres.

Each function returns the path, and raises `FileError` if it cannot be written.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.files.io import write_text, write_whole

Array = NDArray[np.float64]

MM = 1e3  # millimetres in a metre
SOLE, OUTLINE = "SOLE", "OUTLINE"  # layers of the DXF file, groups of the SVG file


def write_csv(path: Path, sole: Array) -> Path:
    """Write a sole (m, 2), m, from heel to toe, as a table of x_mm and z_mm."""
    rows = np.round(MM * sole, 6) + 0.0  # + 0.0 turns -0 into 0
    with write_whole(path) as new:
        np.savetxt(new, rows, fmt="%.6f", delimiter=",", header="x_mm,z_mm", comments="")
    return path


def write_dxf(path: Path, sole: Array, outline: Array) -> Path:
    """Write an outline (p, 2), m, on layer OUTLINE and the sole (m, 2), m, on layer SOLE, as polylines."""
    import ezdxf

    document = ezdxf.new("R2010")
    document.units = ezdxf.units.MM  # $INSUNITS 4
    document.header["$MEASUREMENT"] = 1  # metric
    space = document.modelspace()
    for layer, colour, points, closed in ((OUTLINE, 7, outline, True), (SOLE, 1, sole, False)):
        document.layers.add(layer, color=colour)
        space.add_lwpolyline((MM * points).tolist(), "xy", close=closed, dxfattribs={"layer": layer})
    low, high = ((*(MM * corner).tolist(), 0.0) for corner in (outline.min(axis=0), outline.max(axis=0)))
    space.reset_extents(low, high)  # what a viewer shows at first
    with write_whole(path) as new:
        document.saveas(new)
    return path


def write_svg(path: Path, sole: Array, outline: Array) -> Path:
    """Write an outline (p, 2), m, and the sole (m, 2), m, as paths at full size, one unit a millimetre."""
    (left, low), (right, high) = MM * outline.min(axis=0) - 1.0, MM * outline.max(axis=0) + 1.0
    wide, tall = right - left, high - low

    def group(name: str, points: Array, end: str, colour: str) -> str:
        # the y-axis of an SVG points down
        line = " L ".join(f"{x:.6f} {-z:.6f}" for x, z in MM * points)
        style = f'fill="none" stroke="{colour}" stroke-width="0.1"'
        return f'<g id="{name}"><path d="M {line}{end}" {style}/></g>'

    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.6f}mm" height="{tall:.6f}mm" '
        f'viewBox="{left:.6f} {-high:.6f} {wide:.6f} {tall:.6f}">',
        group(OUTLINE, outline, " Z", "black"),
        group(SOLE, sole, "", "red"),
        "</svg>",
    ]
    write_text(path, "\n".join(lines) + "\n")
    return path
