"""A foot as files to make it from: its sole (CSV), its outline (DXF, SVG), its body (STL, STEP), in mm.

The outline has the sole, vertical sides, a flat top, and perhaps a mounting block.

x is forward and z up; across the foot's width y runs from -width/2 to width/2. A contour is a dense polyline
here as it is in a walk: no spline is fitted to it, which would change the body's volume.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from footopt.arrays import Array
from footopt.errors import MissingError, check, check_kind, needed
from footopt.files.io import write_bytes, write_csv, write_text, write_whole
from footopt.foot import Foot

MM = 1e3  # millimetres in a metre
SAME_POINT = 1e-9  # m; points nearer than this are one: twins upset a CAD program
MIN_WALL = 2e-3  # least material above a sole's hump, m: a body must not fall in two
SOLE, OUTLINE = "SOLE", "OUTLINE"  # layers of the DXF file, groups of the SVG file
FORMATS = ("csv", "dxf", "svg", "stl", "step")


def write_foot(foot: Foot, path: str | Path, block: Sequence[float] | None = None) -> Path:
    """Write a foot in millimetres, in the format of the file's ending.

    Parameters
    ----------
    foot : Foot
        The foot to write.
    path : str or Path
        Ends in .csv (the sole alone), .dxf or .svg (its outline, too), .stl or .step (the body).
    block : (2,), m, optional
        Length and height of a mounting block (see `body_outline`).

    Returns
    -------
    path : Path
        The file.

    Raises
    ------
    FileError
        The file cannot be written.
    SettingError
        The ending is another, or see `body_outline`.
    MissingError
        STEP needs OpenCASCADE: ``pip install "footopt[cad]"``.
    """
    check_kind("foot", foot, Foot, "fo.Foot.from_waypoints(k) makes one of heights.")
    path = Path(path)
    ending, sole, width = path.suffix.lower()[1:], MM * foot.contour, MM * foot.width
    check(ending in FORMATS, "path", str(path), f"a file that ends in one of .{', .'.join(FORMATS)}")
    if ending == "csv":
        x, z = np.round(sole.T, 6) + 0.0  # + 0.0 turns -0 into 0
        write_csv(path, {"x_mm": x, "z_mm": z})
        return path
    outline = MM * body_outline(foot, block)
    if ending in ("dxf", "svg"):
        (_write_dxf if ending == "dxf" else _write_svg)(path, sole, outline)
    else:
        (_write_stl if ending == "stl" else _write_step)(path, outline, width)
    return path


def write_all(
    foot: Foot, folder: Path, block: Sequence[float] | None = None, name: str = "contour"
) -> tuple[list[Path], list[str]]:
    """Write contour.csv, .dxf, .svg, .stl and .step, or with another name, to a folder (see `write_foot`).

    Returns the files, and notes on those that are left out because a library is missing.
    """
    written, notes = [], []
    for ending in FORMATS:
        path = folder / f"{name}.{ending}"
        try:
            written.append(write_foot(foot, path, block))
        except MissingError as error:
            path.unlink(missing_ok=True)  # of the same run, before
            notes.append(f"There is no {path.name}: {error}")
    return written, notes


def closed_contour(sole: Array, top: float) -> Array:
    """Close a sole (m, 2), m, with vertical sides and a flat top at z_p = `top`, m.

    The outline runs counter-clockwise from the heel and does not repeat its first point. A sole that reaches
    higher than the top raises it. Raises `SettingError` if sole and top enclose nothing.
    """
    from shapely import LinearRing, Polygon

    level = max(top, float(sole[:, 1].max()))
    outline: Array = np.array([*sole, (sole[-1, 0], level), (sole[0, 0], level)])
    outline = outline[np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1) > SAME_POINT]
    encloses = len(outline) > 2 and Polygon(outline).area > SAME_POINT and LinearRing(outline).is_ccw
    hint = f"The sole's highest point is at {sole[:, 1].max():g} m."
    check(encloses, "foot.top", top, "above the sole, so that the outline encloses an area", hint)
    return outline


def body_outline(foot: Foot, block: Sequence[float] | None = None) -> Array:
    """The closed outline that a workshop makes, in one piece.

    Where a hump of the sole comes nearer to the top than `MIN_WALL`, the top is raised to that distance,
    because the body would fall in two there.

    A block of some length and height, m, may stand on the top, its middle above the ankle. The outline
    (p, 2), m, runs counter-clockwise and does not repeat its first point. Raises `SettingError` if the block
    does not fit on the top, or if the outline crosses itself or encloses nothing.
    """
    from shapely import Polygon, box, get_coordinates, is_valid_reason, orient_polygons

    sole, top = foot.contour, foot.top
    heel, toe, z = sole[0], sole[-1], sole[:, 1]
    humps = (z[1:-1] >= z[:-2] - SAME_POINT) & (z[1:-1] >= z[2:] - SAME_POINT)
    top = max(top, z[1:-1][humps].max(initial=-np.inf) + MIN_WALL)
    outline = closed_contour(sole, top)
    body = Polygon(outline)
    allowed = "such that the sole, two vertical sides and the top do not cross"
    where = f"The sole overhangs, or crosses itself: {is_valid_reason(body)}, in m."
    check(body.is_valid, "foot.top", foot.top, allowed, where)
    if block is None:
        return outline
    sizes = len(block) == 2 and all(0 < size < np.inf for size in block)
    check(sizes, "foot.block", list(block), "a length and a height > 0, in m, or null")
    (length, height), middle, level = block, foot.ankle[0], outline[:, 1].max()
    on_top = f"on the top, which reaches from {MM * heel[0]:g} to {MM * toe[0]:g} mm"
    fits = heel[0] - SAME_POINT <= middle - length / 2 and middle + length / 2 <= toe[0] + SAME_POINT
    hint = f"Its middle is above the ankle, at {MM * middle:g} mm; length and height are in m."
    check(fits, "foot.block", list(block), on_top, hint)
    body = body.union(box(middle - length / 2, level, middle + length / 2, level + height))
    return get_coordinates(orient_polygons(body).exterior)[:-1]


def _write_dxf(path: Path, sole: Array, outline: Array) -> None:
    """Write an outline (p, 2), mm, on layer OUTLINE and the sole (m, 2), mm, on layer SOLE, as polylines."""
    import ezdxf

    document = ezdxf.new("R2010")
    document.units = ezdxf.units.MM  # $INSUNITS 4
    document.header["$MEASUREMENT"] = 1  # metric
    space = document.modelspace()
    for layer, colour, points, closed in ((OUTLINE, 7, outline, True), (SOLE, 1, sole, False)):
        document.layers.add(layer, color=colour)
        space.add_lwpolyline(points.tolist(), "xy", close=closed, dxfattribs={"layer": layer})
    low, high = ((*corner.tolist(), 0.0) for corner in (outline.min(axis=0), outline.max(axis=0)))
    space.reset_extents(low, high)  # that a viewer shows at first
    with write_whole(path) as new:
        document.saveas(new)


def _write_svg(path: Path, sole: Array, outline: Array) -> None:
    """Write an outline (p, 2), mm, and the sole (m, 2), mm, as paths at full size, one unit a millimetre."""
    (left, low), (right, high) = outline.min(axis=0) - 1.0, outline.max(axis=0) + 1.0
    wide, tall = right - left, high - low

    def group(name: str, points: Array, end: str, colour: str) -> str:
        line = " L ".join(f"{x:.6f} {-z:.6f}" for x, z in points)  # the y-axis of an SVG points down
        style = f'fill="none" stroke="{colour}" stroke-width="0.1"'
        return f'<g id="{name}"><path d="M {line}{end}" {style}/></g>\n'

    write_text(
        path,
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.6f}mm" height="{tall:.6f}mm" '
        f'viewBox="{left:.6f} {-high:.6f} {wide:.6f} {tall:.6f}">\n'
        f"{group(OUTLINE, outline, ' Z', 'black')}{group(SOLE, sole, '', 'red')}</svg>\n",
    )


def _write_stl(path: Path, outline: Array, width: float) -> None:
    """Write the body of an outline (p, 2), mm, that runs counter-clockwise, as binary STL."""
    import shapely

    # of points that single precision makes one, a triangle would have no area
    face = shapely.remove_repeated_points(shapely.Polygon(outline.astype(np.float32)))
    clockwise = shapely.orient_polygons(shapely.constrained_delaunay_triangles(face), exterior_cw=True)
    cap, rim = shapely.get_coordinates(clockwise).reshape(-1, 4, 2)[:, :3], shapely.get_coordinates(face)
    left, right = (np.insert(rim, 1, y, axis=1) for y in (width / 2, -width / 2))
    a, b, c, d = left[:-1], left[1:], right[1:], right[:-1]  # corners of the sides
    ends = np.insert(cap, 1, width / 2, axis=2), np.insert(cap[:, ::-1], 1, -width / 2, axis=2)
    triangles = np.concatenate([*ends, np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    body = np.zeros(len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    body["normal"], body["corners"] = normal / np.linalg.norm(normal, axis=1, keepdims=True), triangles
    write_bytes(path, bytes(80) + len(body).to_bytes(4, "little") + body.tobytes())


def _write_step(path: Path, outline: Array, width: float) -> None:
    """Write the body of an outline (p, 2), mm, as STEP (ISO 10303-21, AP214), a solid of plane faces."""
    needed("OCP", "STEP", "cad")
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.Message import Message, Message_Gravity
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    for printer in Message.DefaultMessenger_s().Printers():  # it tells its progress on the terminal
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    wire = BRepBuilderAPI_MakePolygon()
    for x, z in outline:
        wire.Add(gp_Pnt(x, -width / 2, z))
    wire.Close()
    face = BRepBuilderAPI_MakeFace(wire.Wire(), OnlyPlane=True).Face()
    body = BRepPrimAPI_MakePrism(face, gp_Vec(0.0, width, 0.0)).Shape()
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.product.name", "foot")
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)  # edges in space alone: a third of the size
    writer.Transfer(body, STEPControl_StepModelType.STEPControl_AsIs)
    with write_whole(path) as new:
        if writer.Write(str(new)) != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise OSError(0, "OpenCASCADE failed")
