"""The printed body: closed, of the right area and volume, and the same to a CAD program."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import footopt as fo
from footopt.errors import FileError
from footopt.files import bodies as solid
from footopt.files.bodies import measure, read_step, read_stl, write_all, write_step, write_stl
from footopt.files.contours import body_outline, enclosed_area
from footopt.foot import SHAPES

WRITERS = {"stl": (write_stl, read_stl), "step": (write_step, read_step)}
BLOCKS = st.sampled_from([None, (0.06, 0.02), (0.26, 0.01)])
HOLLOW = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4], width=0.08)


def edges(faces):
    """How often each directed edge of some faces is there."""
    found = {}
    for face in faces:
        for a, b in zip(face, np.roll(face, -1, axis=0), strict=True):
            found[*a, *b] = found.get((*a, *b), 0) + 1
    return found


def volume(faces):
    """Of a closed body of planar faces, by the divergence theorem: a third of the sum of area n . p."""
    total = 0.0
    for face in faces:
        fan = np.cross(face[1:-1] - face[0], face[2:] - face[0]).sum(axis=0) / 2
        total += fan @ face[0] / 3
    return total


@pytest.mark.parametrize("ending", WRITERS)
@settings(max_examples=15)
@given(k=st.lists(st.integers(1, 10), min_size=4, max_size=9), block=BLOCKS)
def test_any_waypoint_sole_makes_a_closed_body_of_its_volume(tmp_path_factory, ending, k, block):
    write, read = WRITERS[ending]
    foot = fo.Foot.from_waypoints(k)
    faces = read(write(foot, tmp_path_factory.getbasetemp() / f"any.{ending}", block))
    found = edges(faces)
    assert set(found.values()) == {1}
    assert all((*edge[3:], *edge[:3]) in found for edge in found)
    expected = 1e9 * enclosed_area(body_outline(foot, block)) * foot.width
    assert volume(faces) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("ending", WRITERS)
@pytest.mark.parametrize("name", sorted(SHAPES))
def test_every_shape_makes_a_body(name, ending, tmp_path):
    write, read = WRITERS[ending]
    foot = fo.Foot.shape(name, width=0.06)
    corners = np.concatenate(read(write(foot, tmp_path / f"foot.{ending}")))
    low, high = 1e3 * foot.contour.min(axis=0), 1e3 * foot.contour.max(axis=0)
    np.testing.assert_allclose(corners.min(axis=0), [low[0], -30.0, low[1]], atol=1e-4)
    np.testing.assert_allclose(corners.max(axis=0)[:2], [high[0], 30.0], atol=1e-4)


def test_normals_of_an_stl_point_outwards(tmp_path):
    content = write_stl(fo.Foot.shape("circle"), tmp_path / "foot.stl").read_bytes()
    records = np.frombuffer(content[84:], solid._TRIANGLE)
    middle = records["corners"].mean(axis=1)
    below = middle[:, 2] < -1.0
    sides = below & (abs(records["normal"][:, 1]) < 0.5)
    assert np.all((records["normal"] * middle)[sides][:, [0, 2]].sum(axis=1) > 0)
    assert np.all((records["normal"] * middle)[~sides & below][:, 1] > 0)


@pytest.mark.parametrize(
    ("ending", "spoil", "message"),
    [
        ("stl", lambda faces: faces[1:], "not closed"),
        ("step", lambda faces: faces[1:], "not closed"),
        ("stl", lambda faces: [1.001 * face for face in faces], "area is"),
        ("step", lambda faces: [face * [1, 1.001, 1] for face in faces], "volume is"),
    ],
)
def test_a_file_that_does_not_hold_the_body_is_refused(tmp_path, monkeypatch, ending, spoil, message):
    read = getattr(solid, f"read_{ending}")
    monkeypatch.setattr(solid, f"read_{ending}", lambda path: spoil(read(path)))
    with pytest.raises(FileError, match=message):
        WRITERS[ending][0](HOLLOW, tmp_path / f"foot.{ending}")


@pytest.mark.parametrize("ending", WRITERS)
def test_what_is_no_such_file_is_named(tmp_path, ending):
    write, read = WRITERS[ending]
    path = tmp_path / f"foot.{ending}"
    with pytest.raises(FileError, match=rf"foot\.{ending}: cannot be read"):
        read(path)
    content = write(HOLLOW, path).read_bytes()
    path.write_bytes(content[: len(content) // 2].rpartition(b"\n")[0])
    with pytest.raises(FileError, match=rf"foot\.{ending}: cannot be read"):
        read(path)


def test_a_step_file_names_only_what_it_holds(tmp_path):
    text = write_step(HOLLOW, tmp_path / "Müller's foot.step").read_text()
    defined = re.findall(r"^#(\d+)=", text, flags=re.MULTILINE)
    used = re.findall(r"#(\d+)[,)]", text)
    assert defined == [str(i + 1) for i in range(len(defined))]
    assert set(used) <= set(defined)
    assert text.startswith("ISO-10303-21;\nHEADER;")
    assert text.endswith("ENDSEC;\nEND-ISO-10303-21;\n")


def test_every_format_is_written_under_one_name(tmp_path):
    written = write_all(HOLLOW, tmp_path, (0.06, 0.02))
    assert [path.name for path in written] == [
        f"contour.{end}" for end in ("csv", "dxf", "svg", "stl", "step")
    ]
    assert all(path.stat().st_size > 1000 for path in written)


def test_what_a_file_holds_is_measured_from_the_file(tmp_path):
    """Of a rectangle of 260 x 30 mm, 100 mm wide, whose file another one replaces."""
    for path in write_all(fo.Foot.flat(), tmp_path)[1:]:
        area, volume = measure(path)
        assert area == pytest.approx(7800.0, rel=1e-7)
        assert np.isnan(volume) if path.suffix in (".dxf", ".svg") else volume == pytest.approx(7.8e5)
    write_stl(fo.Foot.flat(), tmp_path / "contour.stl", (0.26, 0.01))
    assert measure(tmp_path / "contour.stl") == pytest.approx((10400.0, 1.04e6))


@pytest.mark.slow
@pytest.mark.parametrize("foot", [HOLLOW, fo.Foot.shape("reversed_l")], ids=lambda f: f.name)
def test_a_cad_kernel_reads_the_same_body(tmp_path, foot):
    """Open CASCADE: one valid solid of the outline's volume and the prism's surface."""
    pytest.importorskip("OCP", reason="pip install footopt[cad]")
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum

    block = (0.05, 0.02)
    reader = STEPControl_Reader()
    assert (
        reader.ReadFile(str(write_step(foot, tmp_path / "foot.step", block)))
        == IFSelect_ReturnStatus.IFSelect_RetDone
    )
    assert reader.TransferRoots() == 1
    shape = reader.OneShape()
    assert shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
    assert BRepCheck_Analyzer(shape).IsValid()
    outline = 1e3 * body_outline(foot, block)
    around = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1).sum()
    area, width = enclosed_area(outline), 1e3 * foot.width
    measured = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, measured)
    assert measured.Mass() == pytest.approx(area * width, rel=1e-9)
    BRepGProp.SurfaceProperties_s(shape, measured)
    assert measured.Mass() == pytest.approx(2 * area + around * width, rel=1e-9)
