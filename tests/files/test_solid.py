"""The printed body, read back by other programs: closed, of the right area and volume."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

import footopt as fo
from footopt.files.feet import body_outline

BLOCKS = st.sampled_from([None, (0.06, 0.02), (0.26, 0.01)])
HOLLOW = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4], width=0.08)


def expected(foot, block=None):
    """Volume (mm^3) and surface (mm^2) of a foot's prism."""
    outline, width = Polygon(1e3 * body_outline(foot, block)), 1e3 * foot.width
    return outline.area * width, 2 * outline.area + outline.length * width


@settings(max_examples=15)
@given(k=st.lists(st.integers(1, 10), min_size=4, max_size=9), block=BLOCKS)
def test_any_waypoint_sole_makes_a_closed_body_of_its_volume(tmp_path_factory, k, block):
    foot = fo.Foot.from_waypoints(k)
    body = trimesh.load_mesh(fo.write_foot(foot, tmp_path_factory.getbasetemp() / "any.stl", block))
    volume, surface = expected(foot, block)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.volume == pytest.approx(volume, rel=1e-5)  # not negative: normals point outwards
    assert body.area == pytest.approx(surface, rel=1e-5)


@pytest.mark.parametrize("apart", [2e-9, 1e-8, 3e-8, 1e-6])
def test_no_triangle_is_without_area(tmp_path, apart):
    """Points of a drawing may be nearer to each other than the single precision of STL can tell."""
    x = np.array([-0.13, -0.05, -0.02, -0.02 + apart, 0.04, 0.1287, 0.13])
    foot = fo.Foot(np.stack([x, -0.03 + x**2], axis=1))
    body = trimesh.load_mesh(fo.write_foot(foot, tmp_path / "foot.stl"), process=False)
    assert body.area_faces.min() > 0
    assert trimesh.load_mesh(tmp_path / "foot.stl").is_watertight


@pytest.mark.parametrize("foot", [HOLLOW, fo.Foot.shape("reversed_l")], ids=lambda f: f.name)
def test_a_cad_kernel_reads_one_valid_solid(tmp_path, capfd, foot):
    pytest.importorskip("OCP", reason='pip install "footopt[cad]"')
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum

    block = (0.05, 0.02)
    path = fo.write_foot(foot, tmp_path / "Müller's foot.step", block)
    assert capfd.readouterr() == ("", "")
    reader = STEPControl_Reader()
    assert reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
    assert reader.TransferRoots() == 1
    shape = reader.OneShape()
    assert shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
    assert BRepCheck_Analyzer(shape).IsValid()
    volume, surface = expected(foot, block)
    measured, box = GProp_GProps(), Bnd_Box()
    BRepGProp.VolumeProperties_s(shape, measured)
    assert measured.Mass() == pytest.approx(volume, rel=1e-9)
    BRepGProp.SurfaceProperties_s(shape, measured)
    assert measured.Mass() == pytest.approx(surface, rel=1e-9)
    BRepBndLib.AddOptimal_s(shape, box, True, False)
    (left, low), (right, high) = (f(1e3 * body_outline(foot, block), axis=0) for f in (np.min, np.max))
    half = 500.0 * foot.width
    corners = [[at.X(), at.Y(), at.Z()] for at in (box.CornerMin(), box.CornerMax())]
    np.testing.assert_allclose(corners, [[left, -half, low], [right, half, high]], atol=1e-5)
