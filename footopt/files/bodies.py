"""Bodies to print or mill: an outline extruded across the foot's width, as STL and STEP, in millimetres.

x is forward, z up, and y runs from -width/2 to width/2. A contour is a dense polyline here as it is in a
walk: no spline is fitted to it, which would change the body's volume. Each function returns
the path, and raises `FileError` if it cannot be written.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, needed
from footopt.files.drawings import MM
from footopt.files.io import write_bytes, write_whole

Array = NDArray[np.float64]


def write_stl(path: Path, outline: Array, width: float) -> Path:
    """Write the body of an outline (p, 2), m, that runs counter-clockwise, as binary STL; `width` in m."""
    from shapely import Polygon, remove_repeated_points
    from trimesh.creation import extrude_polygon

    half = MM * width / 2
    across = np.array([[1, 0, 0, 0], [0, 0, -1, half], [0, 1, 0, 0], [0, 0, 0, 1]], float)
    # of points that single precision makes one, a triangle would have no area
    kept = remove_repeated_points(Polygon((MM * outline).astype(np.float32)))
    body = extrude_polygon(kept, MM * width, transform=across)
    write_bytes(path, body.export(file_type="stl"))
    return path


def write_step(path: Path, outline: Array, width: float) -> Path:
    """Write the body of an outline (p, 2), m, as STEP (ISO 10303-21, AP214); `width` in m.

    It is one solid of plane faces, one for each side of the outline. Raises `MissingError` without
    OpenCASCADE.
    """
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
    for x, z in MM * outline:
        wire.Add(gp_Pnt(x, -MM * width / 2, z))
    wire.Close()
    face = BRepBuilderAPI_MakeFace(wire.Wire(), OnlyPlane=True).Face()
    body = BRepPrimAPI_MakePrism(face, gp_Vec(0.0, MM * width, 0.0)).Shape()
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.product.name", "foot")
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)  # edges in space alone: a third of the size
    writer.Transfer(body, STEPControl_StepModelType.STEPControl_AsIs)
    with write_whole(path) as new:
        if writer.Write(str(new)) != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise FileError(f"cannot write {path}: OpenCASCADE failed. Is the disk full?")
    return path
