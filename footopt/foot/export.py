"""A foot as a file to make it from: the sole as CSV, the closed outline as DXF, both in millimetres."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, check
from footopt.foot.foot import Foot
from footopt.foot.waypoints import check_top

Array = NDArray[np.float64]

MM = 1e3  # millimetres in a metre
SAME = 1e-9  # points closer than this are one, m
AREA_TOLERANCE = 1e-6  # relative, of an outline read back

SOLE, OUTLINE = "SOLE", "OUTLINE"  # layers of the DXF file


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


def enclosed_area(outline: Array) -> float:
    """Area inside a closed polygon (shoelace), positive when it runs counter-clockwise.

    Parameters
    ----------
    outline : (m, 2), the first point not repeated
    """
    x, z = (outline - outline[0]).T  # near the origin the products cancel less
    return float(0.5 * np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z))


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
        raise _unwritable(path, error) from error
    return path


def write_dxf(foot: Foot, path: str | Path, top: float | None = None) -> Path:
    """Write the closed outline (layer OUTLINE) and the sole alone (layer SOLE) as polylines, in mm.

    The file is read back, and its outline's area compared with the contour's own.

    Parameters
    ----------
    top : z_p of the flat top, m (see `closed_contour`).

    Returns
    -------
    path : of the file.

    Raises
    ------
    FileError : the file cannot be written, or does not hold the outline when read back.
    SettingError : see `closed_contour`.
    """
    import ezdxf

    path = Path(path)
    outline = MM * closed_contour(foot, top)
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
        raise _unwritable(path, error) from error
    _compare(read_dxf(path), outline, path)
    return path


def read_dxf(path: str | Path, layer: str = OUTLINE) -> Array:
    """The one polyline on a layer of a file that `write_dxf` made, (m, 2), mm.

    Raises
    ------
    FileError : the file cannot be read, or does not hold exactly one such polyline.
    """
    import ezdxf

    try:
        document = ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError) as error:
        raise FileError(f"{path}: cannot be read as DXF ({error}).") from error
    lines = document.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
    if len(lines) != 1:
        raise FileError(f"{path}: must hold one LWPOLYLINE on layer {layer}; it holds {len(lines)}.")
    return np.array(lines[0].get_points("xy"), float)


def _compare(found: Array, outline: Array, path: Path) -> None:
    """Raise unless an outline read back encloses what was written."""
    area, expected = enclosed_area(found), enclosed_area(outline)
    if not abs(area - expected) <= AREA_TOLERANCE * abs(expected):
        raise FileError(
            f"{path}: the outline read back encloses {area:.6g} mm^2 instead of {expected:.6g} mm^2. "
            "The file is damaged: write it again, to another disk if it stays so."
        )


def _unwritable(path: Path, error: OSError) -> FileError:
    return FileError(
        f"{path}: cannot be written ({error.strerror or error}). "
        "Choose a folder that exists and may be written to."
    )
