"""A foot as files to make it from: the sole as CSV, its closed outline as DXF and SVG, in millimetres.

`footopt.files.bodies` writes the body that the outline spans across the foot's width.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, SettingError, check
from footopt.files.polygon import SAME, crossing, enclosed_area, without_twins
from footopt.foot.foot import Foot
from footopt.foot.waypoints import check_top

Array = NDArray[np.float64]

MM = 1e3  # millimetres in a metre
WALL = 2e-3  # least material above a sole's hump, m: a body must not fall in two
AREA_TOLERANCE = 1e-6  # relative, of an outline read back

SOLE, OUTLINE = "SOLE", "OUTLINE"  # layers of the DXF file, groups of the SVG file


def closed_contour(foot: Foot, top: float | None = None) -> Array:
    """Sole, vertical sides and a flat top, counter-clockwise from the heel.

    Parameters
    ----------
    foot : whose sole is closed.
    top : z_p of the flat top, m; by default the foot's own. A sole that reaches higher raises it to its
        own highest point.

    Returns
    -------
    outline : (m, 2), m; the first point is not repeated at the end.

    Raises
    ------
    SettingError : the top is not finite, or encloses nothing with the sole.
    """
    top = foot.top if top is None else top
    check_top(top)
    sole = foot.contour
    level = max(top, float(sole[:, 1].max()))
    corners = np.array([[sole[-1, 0], level], [sole[0, 0], level]])
    # an end that is already at the top has no side above it; twin points upset a CAD program
    keep = [level - sole[end, 1] > SAME for end in (-1, 0)]
    outline = np.concatenate([sole, corners[keep]])
    check(
        enclosed_area(outline) > SAME,
        "foot.top",
        top,
        "above the sole, so that the outline encloses an area",
        f"The sole's highest point is at {sole[:, 1].max():g} m.",
    )
    return outline


def body_outline(foot: Foot, block: Sequence[float] | None = None) -> Array:
    """The outline that is made: `closed_contour`, in one piece, with a mounting block on its top.

    Where a hump of the sole comes nearer to the top than `WALL`, the top is raised to that distance:
    the body would fall in two there.

    Parameters
    ----------
    foot : whose sole is closed.
    block : length and height (m) of a rectangle on the top, its middle above the ankle; None: no block.

    Returns
    -------
    outline : (m, 2), m, counter-clockwise from the heel, the first point not repeated.

    Raises
    ------
    SettingError : the block does not fit on the top, the outline crosses itself, or see `closed_contour`.
    """
    sole, top = foot.contour, foot.top
    hump = sole[1:-1, 1].max(initial=-np.inf)
    if hump > max(sole[0, 1], sole[-1, 1]) - SAME:
        top = max(top, hump + WALL)
    outline = closed_contour(foot, top)
    if block is not None:
        level = outline[:, 1].max()
        toe, heel = [(sole[-1, 0], level)], [(sole[0, 0], level)]
        outline = np.concatenate([sole, toe, _block(foot, level, block), heel])
        outline = without_twins(outline, closed=True)
    place = crossing(outline, closed=True)
    if place is not None:
        x, z = MM * place
        raise SettingError(
            "foot.top",
            foot.top,
            "such that the sole, two vertical sides and the top do not cross",
            f"They meet at x {x:.2f}, z {z:.2f} mm: the sole overhangs, or crosses itself there.",
        )
    return outline


def _block(foot: Foot, level: float, block: Sequence[float]) -> Array:
    """The corners of a block on a top at `level`, from toe to heel, (4, 2), m."""
    check(
        len(block) == 2 and all(0 < size < np.inf for size in block),
        "foot.block",
        list(block),
        "a length and a height > 0, in m, or null",
    )
    (length, height), middle = block, foot.ankle[0]
    heel, toe = foot.contour[0, 0], foot.contour[-1, 0]
    check(
        heel - SAME <= middle - length / 2 and middle + length / 2 <= toe + SAME,
        "foot.block",
        list(block),
        f"on the top, which reaches from {MM * heel:g} to {MM * toe:g} mm",
        f"Its middle is above the ankle, at {MM * middle:g} mm; length and height are in m.",
    )
    ahead, behind, high = middle + length / 2, middle - length / 2, level + height
    return np.array([(ahead, level), (ahead, high), (behind, high), (behind, level)])


def write_csv(foot: Foot, path: str | Path) -> Path:
    """Write the sole from heel to toe, in the foot frame: columns x_mm, z_mm.

    Returns
    -------
    path : of the file.

    Raises
    ------
    FileError : the file cannot be written.
    """
    path = Path(path)
    rows = np.round(MM * foot.contour, 6) + 0.0  # + 0.0 turns -0 into 0
    try:
        np.savetxt(path, rows, fmt="%.6f", delimiter=",", header="x_mm,z_mm", comments="")
    except OSError as error:
        raise unwritable(path, error) from error
    return path


def write_dxf(foot: Foot, path: str | Path, block: Sequence[float] | None = None) -> Path:
    """Write the outline (layer OUTLINE) and the sole alone (layer SOLE) as polylines, in mm.

    The file is read back, and its outline's area compared with the contour's own.

    Parameters
    ----------
    block : length and height of a mounting block, m (see `body_outline`).

    Returns
    -------
    path : of the file.

    Raises
    ------
    FileError : the file cannot be written, or does not hold the outline when read back.
    SettingError : see `body_outline`.
    """
    import ezdxf

    path = Path(path)
    outline = MM * body_outline(foot, block)
    document = ezdxf.new("R2010")
    document.units = ezdxf.units.MM  # $INSUNITS 4
    document.header["$MEASUREMENT"] = 1  # metric
    document.layers.add(OUTLINE, color=7)
    document.layers.add(SOLE, color=1)
    space = document.modelspace()
    space.add_lwpolyline(outline.tolist(), format="xy", close=True, dxfattribs={"layer": OUTLINE})
    space.add_lwpolyline((MM * foot.contour).tolist(), format="xy", dxfattribs={"layer": SOLE})
    try:
        document.saveas(path)
    except OSError as error:
        raise unwritable(path, error) from error
    _compare(path, outline)
    return path


def write_svg(foot: Foot, path: str | Path, block: Sequence[float] | None = None) -> Path:
    """Write the outline and the sole as paths of a drawing at full size, one unit a millimetre.

    The y-axis of an SVG points down: z_p = -y. The file is read back, and its outline's area compared.

    Parameters, returns and errors are those of `write_dxf`.
    """
    path = Path(path)
    outline = MM * body_outline(foot, block)
    (left, low), (right, high) = outline.min(axis=0) - 1.0, outline.max(axis=0) + 1.0
    wide, tall = right - left, high - low
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.6f}mm" height="{tall:.6f}mm" '
        f'viewBox="{left:.6f} {-high:.6f} {wide:.6f} {tall:.6f}">',
        *(
            f'<g id="{name}"><path d="M {_pairs(points)}{end}" fill="none" stroke="{colour}" '
            'stroke-width="0.1"/></g>'
            for name, points, end, colour in (
                (OUTLINE, outline, " Z", "black"),
                (SOLE, MM * foot.contour, "", "red"),
            )
        ),
        "</svg>",
    ]
    write_file(path, "\n".join(lines) + "\n")
    _compare(path, outline)
    return path


def _pairs(points: Array) -> str:
    return " L ".join(f"{x:.6f} {-z:.6f}" for x, z in points)


def write_file(path: Path, content: str | bytes) -> None:
    """Write a whole file, or raise `FileError`."""
    try:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise unwritable(path, error) from error


def drawn_area(path: Path) -> float:
    """What the outline in a DXF or SVG file encloses, mm^2."""
    from footopt.files.outlines import lines_of

    found = [line for line in lines_of(path) if line.layer == OUTLINE and line.closed]
    return MM * MM * abs(sum(enclosed_area(line.points) for line in found))


def _compare(path: Path, outline: Array) -> None:
    """Raise unless the outline in a file encloses what was written, mm."""
    compare(path, "area", drawn_area(path), enclosed_area(outline), AREA_TOLERANCE, "mm^2")


def compare(path: Path, what: str, found: float, written: float, tolerance: float, unit: str) -> None:
    """Raise `FileError` unless what was read back from a file is what was written."""
    if not abs(found - written) <= tolerance * abs(written):
        raise FileError(
            f"{path}: read back, its {what} is {found:.6g} {unit} instead of {written:.6g} {unit}. "
            "The file is damaged: write it again, to another disk if it stays so."
        )


def unwritable(path: Path, error: OSError) -> FileError:
    """What to say of a file that cannot be written."""
    return FileError(
        f"{path}: cannot be written ({error.strerror or error}). "
        "Choose a folder that exists and may be written to."
    )
