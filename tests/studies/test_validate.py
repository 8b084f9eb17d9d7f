"""study=validate: the rig is the walk's law, the comparison is ASME's, and the pages say what comes out."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from feet_in_sand import force, pose_of
from hypothesis import given
from hypothesis import strategies as st
from running import composed, unrender
from study_pages import check_page

import footopt as fo
from footopt.effects import EFFECTS
from footopt.studies.runs import run_study
from footopt.studies.validate import AGREES, DIFFERS, MET, OPEN, Comparison, cells, counts, experiments, rig

ALL = experiments()
DOCS = Path(__file__).parents[2] / "docs" / "evidence" / "validation.md"


class TestRig:
    @pytest.mark.parametrize("law", [(), ("leading_edge",)], ids=str)
    def test_a_wheel_feels_what_the_compiled_contact_says(self, law):
        foot, effects = fo.Foot.shape("circle", length=0.2, width=0.06), [EFFECTS[name]() for name in law]
        for height, vx, vz, rate in ((0.05, 0.4, 0.0, -16.0), (0.03, 1.0, -0.2, 0.0), (0.01, 0.1, 0.3, -2.0)):
            place, velocity = np.array([height]), np.array([[vx, vz]])
            mine = rig.body(foot, fo.Scene(fo.Sand(0.6), effects=effects), 64)(
                place, velocity, np.array([rate])
            )[0]
            plates, pose = foot.plates(64, "chord"), pose_of(height, 0.0, rate)
            walked = force(plates, pose, vx, vz, *effects, zeta=0.6, creep=rig.CREEP)
            np.testing.assert_allclose(mine, walked, rtol=1e-9, atol=1e-9)

    @given(st.floats(0.2, 5.0), st.floats(5.0, 200.0))
    def test_a_level_plate_sinks_until_it_carries_the_load(self, zeta, load):
        foot, down = fo.Foot(np.array([[-0.05, 0.0], [0.05, 0.0]]), 0.1), np.array([[0.0, -1.0]])
        sinkage, found = rig.balanced(
            foot, fo.Scene(fo.Sand(zeta)), 8, np.array([load]), down, np.zeros(1), 1.0
        )
        assert sinkage[0] == pytest.approx(load / (zeta * 1e6 * 0.01), rel=1e-6)
        assert found[0, 1] == pytest.approx(load, rel=1e-6)


def wheel(name, law, zeta):
    """Mean absolute errors of the sinkage, mm, and of the drawbar pull, N."""
    inputs = ALL[name].content["inputs"] | {"zeta": dict.fromkeys(("value", "low", "high"), zeta)}
    found = replace(ALL[name], content=ALL[name].content | {"inputs": inputs}).compare(law)
    return [np.abs(c.error).mean() for c in found[:2]]


class TestWheel:
    """What the page says of wheels; the table of its evidence is of these numbers."""

    def test_the_leading_edge_has_the_course_of_driven_wheels_at_the_zeta_of_plates(self):
        assert wheel("wheel_driven", ["leading_edge"], 0.95) == pytest.approx([1.1, 1.6], abs=0.05)
        assert wheel("wheel_driven", [], 0.95) == pytest.approx([4.2, 5.3], abs=0.05)

    @pytest.mark.parametrize("law", [[], ["leading_edge"]])
    def test_no_zeta_predicts_braked_wheels(self, law):
        best = np.min([wheel("wheel_braked", law, zeta) for zeta in np.geomspace(0.2, 5.0, 6)], axis=0)
        assert (best > [8.0, 9.0]).all()


class TestComparison:
    def made(self, error, numerical=0.0, inputs=0.0, experimental=0.0, scale=1.0):
        one = np.ones(1)
        parts = (scale + error, scale, numerical, inputs, experimental)
        return Comparison("e", "q", "1", (), [""], *(part * one for part in parts), scale)

    def test_the_three_uncertainties_add_as_squares(self):
        assert self.made(0.0, 0.02, 0.03, 0.06).uncertainty[0] == pytest.approx(0.07)

    def test_the_verdict_is_that_of_the_error_against_twice_u(self):
        for error, u, verdict in (
            (0.1, 0.06, AGREES),
            (-0.1, 0.06, AGREES),
            (0.13, 0.06, DIFFERS),
            (0.1, 0.3, OPEN),
            (0.7, 0.3, DIFFERS),
        ):
            assert self.made(error, experimental=u).verdict == verdict

    def test_what_lies_outside_the_law_s_range_is_not_judged_and_assumed_data_give_no_verdict(self):
        one = self.made(0.1, experimental=0.06)
        two = replace(
            one, simulated=np.array([1.1, 5.0]), measured=np.ones(2), inside=np.array([True, False])
        )
        assert (two.verdict, two.size) == (AGREES, pytest.approx(0.1))
        assert replace(one, apart="data assumed").verdict == "data assumed"

    def test_experiments_are_counted_by_the_law_that_meets_most_of_them(self):
        good, bad = self.made(0.0, experimental=0.1), self.made(1.0, experimental=0.1)
        edge = [replace(c, law=("leading_edge",)) for c in (good, bad)]
        found = [
            bad,
            bad,
            *edge,
            replace(good, experiment="f"),
            replace(bad, experiment="g", apart="data assumed"),
        ]
        assert counts(found) == dict(zip(MET, (1, 1, 0), strict=True))


@pytest.mark.parametrize(
    "e", [pytest.param(ALL[n], id=n, marks=[pytest.mark.slow] * (n in ("people", "grousers"))) for n in ALL]
)
def test_numbers_are_good_enough_to_judge_and_docs_have_them(e):
    found = [c for law in e.content["laws"] for c in e.compare(law)]
    assert all(np.isfinite(c.simulated).all() and c.numerical.max() < 0.05 * c.scale for c in found)
    rows = {f"| {' | '.join(row)} |" for row in map(cells, found)}
    assert rows <= set(DOCS.read_text(encoding="utf-8").split("\n"))


class TestStudy:
    def test_it_leaves_a_page_a_table_and_a_figure_for_each_experiment(self, tmp_path, capsys, monkeypatch):
        unrender(monkeypatch)
        settings = composed("study=validate", "study.cases=[growth,friction]")
        run_study(settings, tmp_path, {})
        check_page(tmp_path)
        result = json.loads((tmp_path / "result.json").read_text())
        assert result["counts"] == {"in all quantities": 1, "in some": 0, "in none": 1}
        assert [len(c["simulated"]) for c in result["comparisons"]] == [6, 4]
        assert {path.stem for path in (tmp_path / "figures").glob("*.png")} == {
            "overview",
            "growth",
            "friction",
        }
        said = capsys.readouterr().out
        assert "Of 2 experiments with measured data the best of the laws predicts 1 in all quantities" in said
