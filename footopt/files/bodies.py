"""The foot as a body: its closed outline, extruded across the foot's width, as STL and STEP, in mm.

x is forward, z up, and y runs from -width/2 to width/2. Both files describe the same prism: two equal
caps and one flat side for each step of the outline. A contour is a dense polyline here as it is in a
walk, so that nothing is refitted and nothing changes its volume.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError
from footopt.files.contours import (
    MM,
    body_outline,
    compare,
    drawn_area,
    write_csv,
    write_dxf,
    write_file,
    write_svg,
)
from footopt.files.polygon import enclosed_area
from footopt.foot.foot import Foot

Array = NDArray[np.float64]

STL_TOLERANCE = 1e-5  # relative: STL holds single precision
STEP_TOLERANCE = 1e-9

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_stl(foot: Foot, path: str | Path, block: Sequence[float] | None = None) -> Path:
    """Write the body as binary STL, and read it back: closed, and of the right area and volume.

    Parameters
    ----------
    block : length and height of a mounting block, m (see `footopt.files.contours.body_outline`).

    Returns
    -------
    path : of the file.

    Raises
    ------
    FileError : the file cannot be written, or does not hold the body when read back.
    SettingError : see `footopt.files.contours.body_outline`.
    """
    import mapbox_earcut

    path, outline = Path(path), MM * body_outline(foot, block)
    corners = mapbox_earcut.triangulate_float64(outline, np.array([len(outline)], np.uint32)).reshape(-1, 3)
    left, right = _across(outline, foot.width)
    after = np.roll(np.arange(len(outline)), -1)
    # the cap at -y keeps the outline's counter-clockwise turn: seen from there, x runs to the right
    triangles = np.concatenate(
        [
            left[corners],
            right[corners[:, ::-1]],
            np.stack([left, right, left[after]], axis=1),
            np.stack([left[after], right, right[after]], axis=1),
        ]
    )
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    records = np.zeros(len(triangles), _TRIANGLE)
    records["normal"] = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    records["corners"] = triangles
    head = b"footopt: x forward, z up, mm".ljust(80)
    write_file(path, head + len(records).to_bytes(4, "little") + records.tobytes())
    _verify(path, read_stl(path), outline, foot.width, STL_TOLERANCE)
    return path


def write_step(foot: Foot, path: str | Path, block: Sequence[float] | None = None) -> Path:
    """Write the body as STEP (ISO 10303-21, AP214) of plane faces, and read it back.

    Parameters, returns and errors are those of `write_stl`.
    """
    path, outline = Path(path), MM * body_outline(foot, block)
    write_file(path, "\n".join(_step(outline, foot.width)) + "\n")
    _verify(path, read_step(path), outline, foot.width, STEP_TOLERANCE)
    return path


def read_stl(path: str | Path) -> list[Array]:
    """The triangles of a binary STL file, each (3, 3), mm.

    Raises
    ------
    FileError : the file cannot be read as such.
    """
    try:
        content = Path(path).read_bytes()
        records = np.frombuffer(content[84:], _TRIANGLE)
        if len(records) != int.from_bytes(content[80:84], "little"):
            raise ValueError(f"it holds {len(records)} triangles")
    except (OSError, ValueError) as error:
        raise FileError(f"{path}: cannot be read as binary STL ({error}).") from error
    return list(records["corners"].astype(float))


def read_step(path: str | Path) -> list[Array]:
    """The faces of a STEP file of plane faces with straight edges, each (corners, 3), mm.

    They are what the file's topology says: the corners of each face's edges in the loop's direction.

    Raises
    ------
    FileError : the file cannot be read as such.
    """
    try:
        text = Path(path).read_text(encoding="ascii")
        if not text.endswith("END-ISO-10303-21;\n"):
            raise ValueError("it ends too soon")
        entities = dict(re.findall(r"^#(\d+)=(\w+\(.*\));$", text, flags=re.MULTILINE))
        return [_face(entities, name) for name, text in entities.items() if text.startswith("ADVANCED_FACE")]
    except (OSError, ValueError, KeyError, IndexError) as error:
        raise FileError(f"{path}: cannot be read as STEP ({error}).") from error


def _face(entities: dict[str, str], name: str) -> Array:
    """Corners of one face, (m, 3)."""

    def of(number: str) -> list[str]:
        return re.findall(r"#(\d+)", entities[number])

    corners = []
    (loop,) = of(of(name)[0])
    for edge in of(loop):
        (curve,) = of(edge)
        vertex = of(curve)[0 if entities[edge].endswith(".T.)") else 1]
        numbers = re.findall(r"-?\d+\.\d*(?:E[-+]?\d+)?", entities[of(vertex)[0]])
        corners.append([float(number) for number in numbers])
    return np.array(corners)


def measure(path: Path) -> tuple[float, float]:
    """Area of the outline (mm^2) and volume of the body (mm^3; NaN of a drawing) that a file holds.

    Parameters
    ----------
    path : a DXF, SVG, STL or STEP file, as footopt writes them.

    Raises
    ------
    FileError : it cannot be read as such, or its body is not closed.
    """
    readers = {".stl": read_stl, ".step": read_step}
    if path.suffix in readers:
        return _measured(path, readers[path.suffix](path))
    return drawn_area(path), math.nan


def _verify(path: Path, faces: list[Array], outline: Array, width: float, tolerance: float) -> None:
    """Raise unless the faces read back close a body of the outline's area and the right volume."""
    area, volume = _measured(path, faces)
    expected = enclosed_area(outline)
    compare(path, "area", area, expected, tolerance, "mm^2")
    compare(path, "volume", volume, expected * MM * width, tolerance, "mm^3")


def _measured(path: Path, faces: list[Array]) -> tuple[float, float]:
    """Area of the cap (mm^2) and volume (mm^3) of the body that some faces close; raise if they do not.

    Volume by the divergence theorem: a sixth of the sum of p0 . (p_i x p_i+1) over each face's fan.
    """
    _, corner = np.unique(np.concatenate(faces), axis=0, return_inverse=True)
    after = np.concatenate([np.roll(np.arange(len(face)), -1) for face in faces])
    after += np.repeat(np.cumsum([0, *map(len, faces[:-1])]), [len(face) for face in faces])
    begin, end = corner.ravel(), corner.ravel()[after]
    edges, count = np.unique(begin * len(begin) + end, return_counts=True)
    open_edges = np.sum(count != 1) + len(np.setxor1d(edges, end * len(begin) + begin))
    if open_edges:
        raise FileError(
            f"{path}: the body read back is not closed ({open_edges} edges without one partner). "
            "Please report it, with the sole's CSV file."
        )
    caps = [face[:, [0, 2]] for face in faces if np.all(face[:, 1] < 0)]
    volume = sum(float(np.sum(np.cross(face[1:-1], face[2:]) @ face[0])) for face in faces) / 6.0
    return sum(map(enclosed_area, caps)), volume


def _across(outline: Array, width: float) -> tuple[Array, Array]:
    """The outline's corners on both sides of the foot, each (m, 3), mm."""
    x, z = outline.T
    y = np.full_like(x, MM * width / 2)
    return np.stack([x, -y, z], axis=1), np.stack([x, y, z], axis=1)


def _step(outline: Array, width: float) -> Iterator[str]:
    """The lines of a STEP file of the prism; every edge is made once and used by two faces."""
    left, right = _across(outline, width)
    count = len(outline)
    entities: list[str] = []

    def new(text: str) -> str:
        entities.append(f"#{len(entities) + 1}={text};")
        return f"#{len(entities)}"

    def triple(kind: str, values: Array) -> str:
        return new(f"{kind}('',({','.join(_real(v) for v in values)}))")

    def frame(origin: str, axis: Array, along: Array) -> str:
        directions = triple("DIRECTION", axis), triple("DIRECTION", along)
        return new(f"AXIS2_PLACEMENT_3D('',{origin},{','.join(directions)})")

    def edge(a: int, b: int) -> str:
        step = corners[b] - corners[a]
        length = float(np.linalg.norm(step))
        vector = new(f"VECTOR('',{triple('DIRECTION', step / length)},{_real(length)})")
        line = new(f"LINE('',{points[a]},{vector})")
        return new(f"EDGE_CURVE('',{vertices[a]},{vertices[b]},{line},.T.)")

    def face(edges: Sequence[tuple[str, bool]], at: int, normal: Array, along: Array) -> str:
        sides = [new(f"ORIENTED_EDGE('',*,*,{e},.{'T' if ahead else 'F'}.)") for e, ahead in edges]
        loop = new(f"EDGE_LOOP('',({','.join(sides)}))")
        bound = new(f"FACE_OUTER_BOUND('',{loop},.T.)")
        plane = new(f"PLANE('',{frame(points[at], normal, along)})")
        return new(f"ADVANCED_FACE('',({bound}),{plane},.T.)")

    corners = np.concatenate([left, right])
    points = [triple("CARTESIAN_POINT", corner) for corner in corners]
    vertices = [new(f"VERTEX_POINT('',{point})") for point in points]
    after = [(i + 1) % count for i in range(count)]
    on_left = [edge(i, after[i]) for i in range(count)]
    on_right = [edge(count + i, count + after[i]) for i in range(count)]
    cross = [edge(i, count + i) for i in range(count)]
    x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    faces = [
        face([(e, True) for e in on_left], 0, -y, x),
        face([(e, False) for e in reversed(on_right)], count, y, x),
    ]
    for i in range(count):
        along = corners[after[i]] - corners[i]
        along = along / np.linalg.norm(along)
        loop = [(cross[i], True), (on_right[i], True), (cross[after[i]], False), (on_left[i], False)]
        faces.append(face(loop, i, np.cross(y, along), y))
    shell = new(f"CLOSED_SHELL('',({','.join(faces)}))")
    body = new(f"MANIFOLD_SOLID_BREP('foot',{shell})")

    application = new("APPLICATION_CONTEXT('core data for automotive mechanical design processes')")
    new(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})")
    context = new(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    product = new(f"PRODUCT('foot','foot','',({context}))")
    new(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part','',({product}))")
    formation = new(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    stage = new(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = new(f"PRODUCT_DEFINITION('design','',{formation},{stage})")
    shape = new(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    millimetre = new("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    radian = new("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    steradian = new("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    accuracy = new(
        f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),{millimetre},'distance_accuracy_value','')"
    )
    space = new(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
        f"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({millimetre},{radian},{steradian}))"
        "REPRESENTATION_CONTEXT('',''))"
    )
    world = frame(triple("CARTESIAN_POINT", 0.0 * x), np.cross(x, y), x)
    representation = new(f"ADVANCED_BREP_SHAPE_REPRESENTATION('foot',({world},{body}),{space})")
    new(f"SHAPE_DEFINITION_REPRESENTATION({shape},{representation})")

    now = time.strftime("%Y-%m-%dT%H:%M:%S")
    yield from (
        "ISO-10303-21;",
        "HEADER;",
        "FILE_DESCRIPTION(('sole extruded to the width of the foot'),'2;1');",
        f"FILE_NAME('foot.step','{now}',(''),(''),'footopt','footopt','');",
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));",
        "ENDSEC;",
        "DATA;",
        *entities,
        "ENDSEC;",
        "END-ISO-10303-21;",
    )


def _real(value: float) -> str:
    """A number as ISO 10303-21 wants it: with a point, and a capital E."""
    text = repr(float(value) + 0.0).upper()
    mantissa, exponent, power = text.partition("E")
    return (mantissa if "." in mantissa else mantissa + ".") + exponent + power


def write_all(foot: Foot, folder: Path, block: Sequence[float] | None = None) -> list[Path]:
    """The foot in every format, as contour.csv, .dxf, .svg, .stl and .step in a folder.

    Parameters
    ----------
    block : length and height of a mounting block, m (see `footopt.files.contours.body_outline`).
    """
    written = [write_csv(foot, folder / "contour.csv")]
    for ending, write in {"dxf": write_dxf, "svg": write_svg, "stl": write_stl, "step": write_step}.items():
        written.append(write(foot, folder / f"contour.{ending}", block))
    return written
