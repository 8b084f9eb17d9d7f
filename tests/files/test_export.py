"""Files to make a foot from hold the foot, in millimetres."""

import json
from dataclasses import asdict
from importlib.util import find_spec

import ezdxf
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running import unrender
from shapely import Polygon
from study_pages import check_page, data_of

import footopt as fo
from footopt.errors import SettingError
from footopt.files.feet import FORMATS, MIN_WALL, body_outline, closed_contour
from footopt.studies import Export
from footopt.studies.runs import run_study
from footopt.studies.settings import Config, FootConfig

heights = st.lists(st.integers(1, 10), min_size=4, max_size=15)
WRITTEN = [end for end in FORMATS if end != "step" or find_spec("OCP")]


class TestOutline:
    @given(k=heights)
    def test_is_the_sole_with_vertical_sides_and_a_flat_top(self, k):
        foot = fo.Foot.from_waypoints(k)
        outline, sole = closed_contour(foot.contour, 0.0), foot.contour
        np.testing.assert_array_equal(outline[: len(sole)], sole)
        level = max(0.0, sole[:, 1].max())
        assert set(outline[len(sole) :, 1]) <= {level}
        assert set(outline[len(sole) :, 0]) <= {sole[0, 0], sole[-1, 0]}
        # under the flat top, over the sole: the area by the trapezoid rule
        x, z = sole.T
        expected = np.sum(np.diff(x) * (level - 0.5 * (z[1:] + z[:-1])))
        assert Polygon(outline).area == pytest.approx(expected, rel=1e-12)

    @given(k=heights)
    def test_of_a_body_is_in_one_piece(self, k):
        """Its top keeps a distance from the sole's humps, and is otherwise the closed contour's."""
        foot = fo.Foot.from_waypoints(k)
        body, sole = body_outline(foot), foot.contour[:, 1]
        if sole.max() < -MIN_WALL:
            np.testing.assert_array_equal(body, closed_contour(foot.contour, 0.0))
        humps = sole[1:-1][(sole[1:-1] > sole[:-2]) & (sole[1:-1] > sole[2:])]
        assert body[:, 1].max() >= humps.max(initial=-np.inf) + MIN_WALL - 1e-12

    def test_has_a_block_on_its_top_over_the_ankle(self, flat_foot):
        body = body_outline(fo.Foot(flat_foot.contour, ankle=(0.02, 0.05)), (0.06, 0.025))
        assert Polygon(body).area == pytest.approx(0.26 * 0.03 + 0.06 * 0.025)
        top = body[body[:, 1] == body[:, 1].max()]
        np.testing.assert_allclose(sorted(top[:, 0]), [-0.01, 0.05])

    def test_that_crosses_itself_is_refused_with_the_place(self):
        curl = np.array([[-0.1, -0.02], [0.1, -0.02], [0.1, 0.02], [0.05, 0.02], [0.05, -0.01]])
        with pytest.raises(SettingError, match=r"foot\.top = .*Self-intersection\[0\.05 0\.02\]"):
            body_outline(fo.Foot(curl))


class TestFiles:
    def test_as_dxf_are_sound_and_in_millimetres(self, flat_foot, tmp_path):
        document = ezdxf.readfile(fo.write_foot(flat_foot, tmp_path / "foot.dxf"))
        assert (document.audit().has_issues, document.units) == (False, ezdxf.units.MM)
        corners = [[-130.0, -30.0, 0.0], [130.0, 0.0, 0.0]]
        np.testing.assert_allclose([document.header["$EXTMIN"], document.header["$EXTMAX"]], corners)


def test_the_study_leaves_a_page_that_links_every_file_and_says_what_it_holds(tmp_path, monkeypatch):
    unrender(monkeypatch)
    run, exported = tmp_path / "run", tmp_path / "out"
    run.mkdir()
    exported.mkdir()
    best, flat = {"k": [5, 1] * 5 + [5], "name": "best"}, {"k": [4] * 11, "name": "to print"}
    result = {"design": best, "to_print": flat, "settings": {"foot": asdict(FootConfig())}}
    (run / "result.json").write_text(json.dumps(result))
    config = Config(study=Export(run=str(run), foot="to_print"), foot=FootConfig(block=[0.06, 0.02]))
    run_study(config, exported, {})
    check_page(exported)
    (table,) = data_of(exported)["tables"]
    names = [f"contour.{ending}" for ending in WRITTEN]
    assert [row[0] for row in table["rows"]] == names
    assert table["links"] == [[True, False, False]] * len(names)
    record = json.loads((exported / "result.json").read_text())
    assert record["area_mm2"] == pytest.approx(4320.0)  # 260 x 12 and 60 x 20 mm
    assert record["volume_mm3"] == pytest.approx(432000.0)
    assert record["size_mm"] == pytest.approx([260.0, 32.0, 100.0])
    del result["to_print"]
    (run / "result.json").write_text(json.dumps(result))
    with pytest.raises(SettingError, match=r"study\.foot = 'to_print': must be best"):
        run_study(config, tmp_path / "other", {})
