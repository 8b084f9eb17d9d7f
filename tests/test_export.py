"""Files to make a foot from hold the foot, in millimetres, or say why they cannot be written."""

import csv

import ezdxf
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.foot import SHAPES, export
from footopt.foot.export import closed_contour, enclosed_area, read_dxf, write_csv, write_dxf

heights = st.lists(st.integers(1, 10), min_size=4, max_size=15)


@given(k=heights)
def test_the_outline_of_any_waypoint_sole_survives_the_file(tmp_path_factory, k):
    foot = fo.Foot.from_waypoints(k)
    path = write_dxf(foot, tmp_path_factory.getbasetemp() / "any.dxf")
    outline = 1e3 * closed_contour(foot)
    np.testing.assert_allclose(read_dxf(path), outline, rtol=0, atol=1e-9)
    np.testing.assert_allclose(read_dxf(path, "SOLE"), 1e3 * foot.contour, rtol=0, atol=1e-9)


@given(k=heights)
def test_an_outline_is_the_sole_with_vertical_sides_and_a_flat_top(k):
    foot = fo.Foot.from_waypoints(k)
    outline = closed_contour(foot)
    sole = foot.contour
    np.testing.assert_array_equal(outline[: len(sole)], sole)
    level = max(0.0, sole[:, 1].max())
    assert set(outline[len(sole) :, 1]) <= {level}
    assert set(outline[len(sole) :, 0]) <= {sole[0, 0], sole[-1, 0]}
    # under the flat top, over the sole: the area by the trapezoid rule
    x, z = sole.T
    expected = np.sum(np.diff(x) * (level - 0.5 * (z[1:] + z[:-1])))
    assert enclosed_area(outline) == pytest.approx(expected, rel=1e-12)


def test_a_flat_sole_makes_a_rectangle():
    outline = closed_contour(fo.Foot.flat())
    assert enclosed_area(outline) == pytest.approx(0.26 * 0.03)
    np.testing.assert_allclose(outline[-2:], [[0.13, 0.0], [-0.13, 0.0]])


def test_a_higher_top_adds_its_height_times_the_length():
    foot = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4])
    added = enclosed_area(closed_contour(foot, 0.02)) - enclosed_area(closed_contour(foot))
    assert added == pytest.approx(0.26 * 0.02)


def test_a_sole_that_reaches_above_the_top_raises_it():
    reversed_l = fo.Foot.shape("reversed_l")
    outline = closed_contour(reversed_l, 0.0)
    assert outline[:, 1].max() == reversed_l.contour[:, 1].max() > 0.04
    assert enclosed_area(outline) == pytest.approx((0.26 * 2 / 3) * (0.26 / 3))


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_no_shape_has_two_corners_in_one_place(name, tmp_path):
    foot = fo.Foot.shape(name)
    outline = closed_contour(foot)
    sides = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    assert sides.min() > 1e-6
    write_dxf(foot, tmp_path / f"{name}.dxf")


def test_the_file_has_millimetres_layers_and_a_closed_and_an_open_line(tmp_path):
    document = ezdxf.readfile(write_dxf(fo.Foot.flat(), tmp_path / "flat.dxf"))
    assert document.header["$INSUNITS"] == 4
    lines = {line.dxf.layer: line for line in document.modelspace()}
    assert set(lines) == {"OUTLINE", "SOLE"}
    assert lines["OUTLINE"].closed
    assert not lines["SOLE"].closed
    assert not document.audit().has_errors


def test_a_file_that_does_not_hold_the_outline_is_refused(tmp_path, monkeypatch):
    shrunk = 0.999 * 1e3 * closed_contour(fo.Foot.flat())
    monkeypatch.setattr(export, "read_dxf", lambda path: shrunk)
    with pytest.raises(FileError, match=r"encloses 7784\.4\d* mm\^2 instead of 7800 mm\^2"):
        write_dxf(fo.Foot.flat(), tmp_path / "flat.dxf")


def test_a_line_of_no_area_is_refused(tmp_path):
    with pytest.raises(SettingError, match=r"foot\.top"):
        closed_contour(fo.Foot(np.array([[-0.1, 0.0], [0.1, 0.0]])))
    with pytest.raises(SettingError, match="finite"):
        write_dxf(fo.Foot.flat(), tmp_path / "flat.dxf", top=float("nan"))


def test_the_sole_as_csv_runs_from_heel_to_toe_in_millimetres(tmp_path):
    foot = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
    path = write_csv(foot, tmp_path / "sole.csv")
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["x_mm", "z_mm"]
    assert rows[1] == ["-130.000000", "-15.000000"]
    assert rows[-1] == ["130.000000", "-12.000000"]
    np.testing.assert_allclose(np.array(rows[1:], float), 1e3 * foot.contour, rtol=0, atol=5.1e-7)


def test_a_zero_has_no_sign(tmp_path):
    path = write_csv(fo.Foot(np.array([[-0.1, -0.0], [0.0, -0.02], [0.1, -1e-14]])), tmp_path / "sole.csv")
    assert "-0.000000" not in path.read_text()


@pytest.mark.parametrize("write", [write_csv, write_dxf])
def test_a_path_that_cannot_be_written_is_named(write, tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "nowhere" / "sole", tmp_path / "file" / "sole", tmp_path):
        with pytest.raises(FileError, match="cannot be written") as caught:
            write(fo.Foot.flat(), path)
        assert str(path) in str(caught.value)


def test_a_file_that_is_no_dxf_is_named(tmp_path):
    path = tmp_path / "sole.dxf"
    path.write_text("x_mm,z_mm\n0,0\n")
    with pytest.raises(FileError, match=r"sole\.dxf"):
        read_dxf(path)
    with pytest.raises(FileError, match=r"none\.dxf"):
        read_dxf(tmp_path / "none.dxf")
    with pytest.raises(FileError, match="holds 0"):
        read_dxf(write_dxf(fo.Foot.flat(), tmp_path / "flat.dxf"), layer="HEEL")
