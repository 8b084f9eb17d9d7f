"""study=validate: the rig is the walk's law, the comparison is ASME's, and the pages say what comes out."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from running import composed, unrender
from study_pages import check_page

from footopt.studies.runs import run_study
from footopt.studies.validate import AGREES, DIFFERS, MET, OPEN, Comparison, cells, counts, experiments

ALL = experiments()
DOCS = Path(__file__).parents[2] / "docs" / "evidence" / "validation.md"


def wheel(name, law, zeta):
    """Mean absolute errors of the sinkage, mm, and of the drawbar pull, N."""
    inputs = ALL[name].content["inputs"] | {"zeta": dict.fromkeys(("value", "low", "high"), zeta)}
    found = replace(ALL[name], content=ALL[name].content | {"inputs": inputs}).compare(law)
    return [np.abs(c.error).mean() for c in found[:2]]


@pytest.mark.parametrize(("law", "errors"), [(["leading_edge"], [1.1, 1.6]), ([], [4.2, 5.3])])
def test_the_leading_edge_has_the_course_of_driven_wheels_at_the_zeta_of_plates(law, errors):
    """As the page says; the table of its evidence is of these numbers."""
    assert wheel("wheel_driven", law, 0.95) == pytest.approx(errors, abs=0.05)


@pytest.mark.parametrize("law", [[], ["leading_edge"]])
def test_no_zeta_predicts_braked_wheels(law):
    best = np.min([wheel("wheel_braked", law, zeta) for zeta in np.geomspace(0.2, 5.0, 6)], axis=0)
    assert (best > [8.0, 9.0]).all()


def made(error, numerical=0.0, inputs=0.0, experimental=0.0):
    """A comparison of one number, which is about 1."""
    parts = np.array([[1.0 + error], [1.0], [numerical], [inputs], [experimental]])
    return Comparison("e", "q", "1", (), [""], *parts, 1.0)


class TestComparison:
    def test_the_verdict_is_that_of_the_error_against_twice_u_whose_parts_add_as_squares(self):
        assert made(0.0, 0.02, 0.03, 0.06).uncertainty[0] == pytest.approx(0.07)
        assert [made(error, 0.0, 0.0, 0.06).verdict for error in (0.1, -0.1, 0.13)] == [
            AGREES,
            AGREES,
            DIFFERS,
        ]
        assert [made(error, 0.0, 0.0, 0.3).verdict for error in (0.1, 0.7)] == [OPEN, DIFFERS]

    def test_what_lies_outside_the_law_s_range_is_not_judged_and_assumed_data_give_no_verdict(self):
        one = made(0.1, experimental=0.06)
        outside = {"simulated": np.array([1.1, 5.0]), "inside": np.array([True, False])}
        two = replace(one, measured=np.ones(2), **outside)
        assert (two.verdict, two.size) == (AGREES, pytest.approx(0.1))
        assert replace(one, apart="data assumed").verdict == "data assumed"

    def test_experiments_are_counted_by_the_law_that_meets_most_of_them(self):
        good, bad = made(0.0, experimental=0.1), made(1.0, experimental=0.1)
        edge = [replace(c, law=("leading_edge",)) for c in (good, bad)]
        others = [replace(good, experiment="f"), replace(bad, experiment="g", apart="data assumed")]
        assert counts([bad, bad, *edge, *others]) == dict(zip(MET, (1, 1, 0), strict=True))


@pytest.mark.parametrize(
    "e", [pytest.param(ALL[n], id=n, marks=[pytest.mark.slow] * (n in ("people", "grousers"))) for n in ALL]
)
def test_numbers_are_good_enough_to_judge_and_docs_have_them(e):
    found = [c for law in e.content["laws"] for c in e.compare(law)]
    assert all(np.isfinite(c.simulated).all() and c.numerical.max() < 0.05 * c.scale for c in found)
    rows = {f"| {' | '.join(row)} |" for row in map(cells, found)}
    assert rows <= set(DOCS.read_text(encoding="utf-8").split("\n"))


def test_the_study_leaves_a_page_a_table_and_a_figure_for_each_experiment(tmp_path, monkeypatch):
    unrender(monkeypatch)
    run_study(composed("study=validate", "study.cases=[growth,friction]"), tmp_path, {})
    check_page(tmp_path)
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["counts"] == {"in all quantities": 1, "in some": 0, "in none": 1}
    assert [len(c["simulated"]) for c in result["comparisons"]] == [6, 4]
    figures = {path.stem for path in (tmp_path / "figures").glob("*.png")}
    assert figures == {"overview", "growth", "friction"}
