"""The paper's study: its open choices, its readings and claims, the verdicts, and what it leaves behind."""

import json
import math
import runpy
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from paper_cases import HOLLOW, ROCKER, config
from running import unrender
from study_pages import check_page

import footopt as fo
from footopt.design import Solver, search
from footopt.foot import SHAPES
from footopt.studies import Paper
from footopt.studies.paper import CLAIMS, MEASURES, VERDICTS, judge, measure, numbers, run, walks
from footopt.studies.paper.walks import SANDS, changes, evidence, objective, read, switch_losses
from footopt.studies.runs import Study
from footopt.walk.objectives import SLOW

DOCS = Path(__file__).parents[2] / "docs"
REFERENCE = Path(__file__).parents[2] / "outputs/reference/paper"
STORED = json.loads((REFERENCE / "claims.json").read_text(encoding="utf-8"))
SMALL = {"study__confirm": "draft", "accuracy__name": "draft", "solver__pop_size": 6, "solver__n_gen": 1}


def walked(settings, feet):
    """The study's evidence with feet that are given, not searched."""

    def search(problem, solver):
        return SimpleNamespace(foot=SimpleNamespace(k=feet[problem.scene.sand.name]))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(walks, "search", search)
        return evidence(settings, {})


@pytest.mark.slow
def test_every_choice_moves_the_walks():
    """Shapes or best feet, as they are read, differ from those at the settings."""
    done, names = {}, ("distance", "peak_power", "speed_loss")

    def numbers(settings):
        return [walk.objectives[name] for walk in evidence(settings, done).values() for name in names]

    own = numbers(config(**SMALL))
    for name, other in changes(config(**SMALL)):
        assert numbers(other) != own, name


@pytest.fixture(scope="module")
def walk():
    return fo.simulate(fo.Foot.from_waypoints(HOLLOW), fo.Scene(), "fine")


class TestReadings:
    def test_the_library_s_own_change_nothing_and_narrower_ones_find_less(self, walk):
        assert read(walk, Paper()).objectives == walk.objectives
        losses = [read(walk, Paper(speed_loss=name)).objectives["speed_loss"] for name in walks.SPEED_LOSS]
        assert losses == sorted(losses, reverse=True)
        assert losses[-1] > 0.0
        single = read(walk, Paper(peak_power="single")).objectives["peak_power"]
        assert 0.0 < single <= walk.objectives["peak_power"]

    @pytest.mark.parametrize("name", walks.SPEED_LOSS)
    def test_a_fall_at_a_switch_is_found_there_and_nowhere_else(self, walk, name):
        velocity = np.ones_like(walk.velocity)
        velocity[walk.t > 1.7] = 0.7
        losses = switch_losses(replace(walk, velocity=velocity), name)
        np.testing.assert_allclose(losses, [0.0, 0.3, 0.0], atol=1e-12)

    def test_a_search_ranks_by_what_is_read(self):
        chosen = Paper(peak_power="single", speed_loss="narrow")
        with objective(chosen) as name:
            problem = fo.FootProblem(fo.Scene(), name, accuracy="draft")
            result = search(problem, Solver("ga", pop_size=8, n_gen=1, seed=1))
        assert name not in SLOW  # nothing is left behind
        for k, j in zip(result.k, result.column(name), strict=True):
            walk = fo.simulate(fo.Foot.from_waypoints(k), fo.Scene(), "draft")
            assert j == pytest.approx(read(walk, chosen).objectives["efficiency"], rel=1e-12)


@pytest.fixture(scope="module")
def found():
    """The numbers of the study's walks, of two feet that are given."""
    walks = walked(config(study__confirm="draft"), {"hard": HOLLOW, "regular": ROCKER, "soft": ROCKER})
    return {name: numbers(walk, "walk") for name, walk in walks.items()}


def cast(found, name, subject, others):
    """The numbers with one walk for what a claim is about, and another for what it is compared with."""
    figure, whose = CLAIMS[name]["place"][:6], name.split("_")[0]
    if figure == "Fig. 7":
        return found | {"crossed": subject, "filled": subject, "hard": others}
    mine = {"triangle": ["reversed_triangle"], "flat": ["rectangle"], "ellipse": ["ellipse", "rectangle"]}
    group = SHAPES if figure == "Fig. 4" else SANDS
    return found | {n: subject if n in mine.get(whose, [whose]) else others for n in group}


#: Claims with a limit, which compare nothing.
ALONE = {"circle_loses", "same_vertical_velocity", "push_off_carries"}
ALONE |= {"hard_hollow", "regular_convex", "soft_convex"}


class TestClaims:
    @pytest.mark.parametrize("name", [name for name in CLAIMS if name not in ALONE])
    def test_a_claim_turns_when_what_it_compares_is_exchanged(self, found, name):
        one, other = found["hard"], found["soft"]
        there, back, same = (
            MEASURES[name](cast(found, name, *pair)) for pair in ((one, other), (other, one), (one, one))
        )
        assert min(there, back) < 0.0, "a claim and its opposite both hold"
        assert max(there, back) > 0.0, "neither a claim nor its opposite holds"
        assert same == 0.0, "a claim holds of walks that are the same"

    @pytest.mark.slow
    def test_the_stored_margins_are_what_is_measured(self):
        margins = measure(walked(config(), {sand: STORED["walks"][sand]["k"] for sand in SANDS}), "walk")
        stored = {claim["id"]: claim["margin"] for claim in STORED["claims"]}
        assert margins == pytest.approx(stored, rel=1e-6)

    @pytest.mark.parametrize(
        ("margin", "changed", "verdict", "turned"),
        [
            (1.0, {"a": 2.0, "b": math.nan}, "holds", []),
            (-1.0, {"a": -2.0}, "does not hold", []),
            (1.0, {"a": 2.0, "b": -1.0, "c": 0.0}, "depends on a choice", ["b", "c"]),
            (-1.0, {"a": 2.0, "b": -1.0}, "depends on a choice", ["a"]),
            (1.0, {}, "holds", []),
            (math.nan, {"a": 2.0}, "undecided", []),
        ],
    )
    def test_a_claim_hangs_on_what_turns_it(self, margin, changed, verdict, turned):
        found = judge(margin, changed)
        assert (found["verdict"], found["hangs_on"]) == (verdict, turned)

    def test_the_stored_page_is_written_from_the_stored_data(self):
        page = runpy.run_path(str(DOCS / "claims.py"))["page"]()
        assert page == (REFERENCE / "claims.md").read_text(encoding="utf-8"), "run python docs/claims.py"
        for entry in STORED["claims"]:
            assert {name: entry[name] for name in CLAIMS[entry["id"]]} == CLAIMS[entry["id"]]
            again = judge(entry["margin"], entry["changed"])
            assert (again["verdict"], again["hangs_on"]) == (entry["verdict"], entry["hangs_on"])


@pytest.mark.slow
def test_the_study_leaves_figures_claims_and_a_page_and_searches_nothing_twice(tmp_path, monkeypatch):
    unrender(monkeypatch)
    searched = []
    search = walks.search
    monkeypatch.setattr(walks, "search", lambda *given: searched.append(given) or search(*given))
    settings = config(study__name="paper", study__cases=["foot.apex", "foot.box_tolerance"], **SMALL)
    run(Study(settings, tmp_path, {}))
    assert len(list((tmp_path / "figures").glob("fig*.png"))) == 11
    found = json.loads((tmp_path / "result.json").read_text())
    assert [entry["id"] for entry in found["claims"]] == list(CLAIMS)
    for entry in found["claims"]:
        assert entry["verdict"] in VERDICTS
        assert set(entry["changed"]) == {"foot.apex=toe", "foot.box_tolerance=.inf"}
    hard = found["walks"]["hard"]
    walked = fo.simulate(fo.Foot.from_waypoints(hard["k"]), fo.Scene(), "draft").objectives
    assert hard["objectives"] == {name: walked[name] for name in hard["objectives"]}
    check_page(tmp_path)
    assert len(searched) == 6  # how the triangle stands does not move the best feet
