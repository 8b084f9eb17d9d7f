"""Files to make a foot from hold the foot, in millimetres, or say why they cannot be written."""

import csv
import json
from dataclasses import asdict
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from study_pages import check_page, data_of

import footopt as fo
from footopt import studies
from footopt.errors import FileError, SettingError
from footopt.files import outlines as outline
from footopt.files.bodies import write_step, write_stl
from footopt.files.contours import (
    WALL,
    body_outline,
    closed_contour,
    enclosed_area,
    write_csv,
    write_dxf,
    write_svg,
)
from footopt.foot import SHAPES
from footopt.report import figures
from footopt.studies import export
from footopt.studies.settings import Config, FootConfig, StudyConfig

heights = st.lists(st.integers(1, 10), min_size=4, max_size=15)
DRAWINGS = {"dxf": write_dxf, "svg": write_svg}


def lines(path):
    """The lines of a drawing by layer, m."""
    return {line.layer: line for line in outline.lines_of(path)}


@pytest.mark.parametrize(("ending", "exact"), [("dxf", 1e-12), ("svg", 1e-9)])
@settings(max_examples=20)
@given(k=heights)
def test_the_outline_of_any_waypoint_sole_survives_the_file(tmp_path_factory, ending, exact, k):
    foot = fo.Foot.from_waypoints(k)
    path = DRAWINGS[ending](foot, tmp_path_factory.getbasetemp() / f"any.{ending}")
    found = lines(path)
    np.testing.assert_allclose(found["OUTLINE"].points, body_outline(foot), rtol=0, atol=exact)
    np.testing.assert_allclose(found["SOLE"].points, foot.contour, rtol=0, atol=exact)
    assert (found["OUTLINE"].closed, found["SOLE"].closed) == (True, False)


@given(k=heights)
def test_a_body_is_in_one_piece(k):
    """Its top keeps a distance from the sole's humps, and is otherwise the closed contour's."""
    foot = fo.Foot.from_waypoints(k)
    body, closed = body_outline(foot), closed_contour(foot)
    sole = foot.contour[:, 1]
    if sole.max() < -WALL:
        np.testing.assert_array_equal(body, closed)
    inside = sole[1:-1].max()
    if inside >= max(sole[0], sole[-1]):
        assert body[:, 1].max() >= inside + WALL - 1e-12


def test_a_block_stands_on_the_top_over_the_ankle():
    foot = fo.Foot(fo.Foot.flat().contour, ankle=(0.02, 0.05))
    body = body_outline(foot, (0.06, 0.025))
    assert enclosed_area(body) == pytest.approx(0.26 * 0.03 + 0.06 * 0.025)
    top = body[body[:, 1] == body[:, 1].max()]
    np.testing.assert_allclose(sorted(top[:, 0]), [-0.01, 0.05])
    whole = body_outline(fo.Foot.flat(), (0.26, 0.01))  # as long as the foot: no twin corners
    assert enclosed_area(whole) == pytest.approx(0.26 * 0.04)
    assert np.linalg.norm(np.roll(whole, -1, axis=0) - whole, axis=1).min() > 1e-6


@pytest.mark.parametrize("block", [(0.3, 0.02), (0.06, 0.0), (-0.1, 0.1), (0.06,), (0.06, float("nan"))])
def test_a_block_that_does_not_fit_is_refused(block):
    with pytest.raises(SettingError, match=r"foot\.block = .*must be"):
        body_outline(fo.Foot.flat(), block)


def test_an_overhanging_sole_that_its_sides_would_cut_is_refused():
    curl = np.array([[-0.1, -0.02], [0.1, -0.02], [0.1, 0.02], [0.05, 0.02], [0.05, -0.01]])
    with pytest.raises(SettingError, match=r"foot\.top = .*They meet at x 50\.00, z 20\.00 mm"):
        body_outline(fo.Foot(curl))


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


def test_an_svg_is_at_full_size(tmp_path):
    root = ElementTree.parse(write_svg(fo.Foot.flat(), tmp_path / "flat.svg")).getroot()
    assert root.get("width") == "262.000000mm"  # a millimetre of margin
    assert root.get("viewBox") == "-131.000000 -1.000000 262.000000 32.000000"


@pytest.mark.parametrize("ending", DRAWINGS)
def test_a_file_that_does_not_hold_the_outline_is_refused(tmp_path, monkeypatch, ending):
    shrunk = outline.Line(0.999 * closed_contour(fo.Foot.flat()), True, "OUTLINE")
    monkeypatch.setattr(outline, "lines_of", lambda path: [shrunk])
    with pytest.raises(FileError, match=r"area is 7784\.4\d* mm\^2 instead of 7800 mm\^2"):
        DRAWINGS[ending](fo.Foot.flat(), tmp_path / f"flat.{ending}")


def test_a_line_of_no_area_is_refused():
    with pytest.raises(SettingError, match=r"foot\.top"):
        closed_contour(fo.Foot(np.array([[-0.1, 0.0], [0.1, 0.0]])))
    with pytest.raises(SettingError, match="finite"):
        closed_contour(fo.Foot.flat(), float("nan"))


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


@pytest.mark.parametrize("write", [write_csv, write_dxf, write_svg, write_stl, write_step])
def test_a_path_that_cannot_be_written_is_named(write, tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "nowhere" / "sole", tmp_path / "file" / "sole", tmp_path):
        with pytest.raises(FileError, match="cannot be written") as caught:
            write(fo.Foot.flat(), path)
        assert str(path) in str(caught.value)


def test_the_page_of_an_export_links_every_file_and_says_what_it_holds(tmp_path, capsys):
    run, exported = tmp_path / "run", tmp_path / "out"
    run.mkdir()
    exported.mkdir()
    result = {"design": {"k": [4] * 11, "name": "flat"}, "settings": {"foot": asdict(FootConfig())}}
    (run / "result.json").write_text(json.dumps(result))
    config = Config(study=StudyConfig(name="export", run=str(run)), foot=FootConfig(block=[0.06, 0.02]))
    studies.run(config, exported, {})
    check_page(exported)
    page = data_of(exported)
    (table,) = page["tables"]
    names = [f"contour.{ending}" for ending in ("csv", "dxf", "svg", "stl", "step")]
    assert [row[0] for row in table["rows"]] == names
    assert table["links"] == [[True, False, False, False, False, False]] * 5
    assert {row[3] for row in table["rows"]} == {"4320.00"}  # 260 x 12 and 60 x 20 mm
    assert [row[4] for row in table["rows"]] == ["", "", "", "432000", "432000"]
    assert all(float(row[5].removesuffix(" %")) < 1e-4 for row in table["rows"])
    sizes = [(exported / name).stat().st_size for name in names]
    np.testing.assert_allclose([float(row[2]) for row in table["rows"]], np.array(sizes) / 1e3, atol=0.05)
    assert "seed" not in page["entry"]
    out = capsys.readouterr().out
    assert "contour.step: each read back; area and volume agree" in out
    assert f"Everything is in {exported}" in out


def test_of_a_multirun_one_job_is_asked_for(tmp_path):
    (tmp_path / "multirun.yaml").touch()
    with pytest.raises(SettingError, match=r"the folder of one job of this multirun\. Such as run=.*/0$"):
        export.foot_of(tmp_path)
    with pytest.raises(FileError, match=r"not the folder of a run with one foot \(it has no result\.json\)"):
        export.foot_of(tmp_path / "nowhere")


def test_a_sole_that_its_csv_file_does_not_hold_is_refused(tmp_path):
    path = write_csv(fo.Foot.flat(), tmp_path / "contour.csv")
    other = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4])
    with pytest.raises(FileError, match=r"contour\.csv: read back, its area is 7800 mm\^2 instead of"):
        export.read_back(path, other, None)


def test_the_drawing_of_an_export_has_its_dimensions_in_mm():
    def dimensions(*arguments):
        return {text.get_text() for text in figures.drawing(*arguments).axes[0].texts} - {""}

    foot = fo.Foot.from_waypoints([4] * 11, width=0.08)
    assert dimensions(foot) == {"260", "12"}
    assert dimensions(foot, (0.06, 0.02)) == {"260", "32", "60", "20"}
    (axes,) = figures.drawing(foot).axes
    assert axes.get_title(loc="left") == "80 mm wide"
    (outline,) = axes.patches
    np.testing.assert_allclose(outline.get_xy()[:-1], 1e3 * body_outline(foot))
