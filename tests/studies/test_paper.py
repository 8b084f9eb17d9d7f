"""The paper's study: the sweep, the verdicts, the errata, and what it leaves in its folder."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from paper_cases import HOLLOW, ROCKER, config
from running import unrender
from study_pages import check_page

import footopt as fo
from footopt.errors import SettingError
from footopt.foot import SHAPES
from footopt.report.figures.paper import CAPTIONS
from footopt.studies.base import Study
from footopt.studies.build import make_space
from footopt.studies.paper import page, run, setup
from footopt.studies.paper import sweep as sweeping
from footopt.studies.paper.claims import CLAIMS, SANDS
from footopt.studies.paper.judge import VERDICTS, chance, judge, sensitivity, verdict
from footopt.studies.paper.readings import read
from footopt.studies.paper.setup import Setup, changed
from footopt.studies.paper.shapes import make_shapes
from footopt.studies.paper.sweep import FACTORS, Plan, combinations, sweep
from footopt.studies.settings import Config

REFERENCE = Path(__file__).parents[2] / "outputs/reference/paper"
#: Not those that move only the search.
MOVES_WALKS = [f for f in FACTORS if f.setting not in ("solver.seed", "foot.box_tolerance")]


class TestSweep:
    def test_a_factor_that_decides_explains_all_and_another_nothing(self):
        rng = np.random.default_rng(0)
        level, other = rng.permutation(np.arange(120) % 3), rng.permutation(np.arange(120) % 5)
        held = (level > 0).astype(float)
        assert sensitivity(held, other) < 0.05
        held[:10] = np.nan
        assert sensitivity(held, level) == pytest.approx(1.0)

    def test_chance_is_what_random_outcomes_reach(self):
        rng = np.random.default_rng(0)
        level = np.arange(48) % 3
        found = [sensitivity(rng.integers(0, 2, 48).astype(float), level) for _ in range(2000)]
        assert np.mean(np.array(found) > chance(48, 3)) == pytest.approx(0.05, abs=0.015)
        assert chance(2, 3) == 1.0

    @given(samples=st.integers(1, 40), seed=st.integers(0, 100))
    def test_combinations_give_every_level_its_turn(self, samples, seed):
        drawn = combinations(FACTORS, samples, seed)
        assert drawn.shape == (samples, len(FACTORS))
        for column, factor in zip(drawn.T, FACTORS, strict=True):
            assert np.ptp(np.bincount(column, minlength=len(factor.levels))) <= 1
        np.testing.assert_array_equal(drawn, combinations(FACTORS, samples, seed))

    def test_the_first_level_is_the_setting_itself(self):
        own = config(foot__width=0.08, scene__t_f=3.0)
        levels = {factor.setting: factor.levels for factor in sweeping.factors(own)}
        assert levels["foot.width"] == (0.08, 0.10, 0.05, 0.15)
        assert levels["scene.t_f"][0] == 3.0
        assert sweeping.factors(Config()) == FACTORS, "the table's first level is not the default"

    @pytest.mark.parametrize("factor", MOVES_WALKS, ids=lambda f: f.setting)
    def test_every_level_moves_the_walks_that_it_says(self, factor):
        """Shapes or one foot's walk, as it is read, differ from the first level's."""
        seen = []
        for level in factor.levels:
            here = Setup(changed(config(study__confirm="draft"), {factor.setting: level}))
            walks = here.shapes() if "shapes" in factor.moves else {}
            if "optima" in factor.moves:
                foot = fo.Foot.from_waypoints(HOLLOW, make_space(here.config.foot))
                walks["foot"] = here.walk(foot, "hard")
            read_as = [read(w, here.readings).objectives for w in walks.values()]
            seen.append([o[n] for o in read_as for n in ("distance", "peak_power", "speed_loss")])
        assert all(other != seen[0] for other in seen[1:])

    def test_verdicts(self):
        combine = "holds only if several settings combine"
        for holds, share, rates, says in (
            (True, math.nan, {}, "holds"),
            (False, 0.03, {"a": 0.1}, "does not hold"),
            (False, 0.96, {"a": 1.0, "b": 0.9}, "holds only if x.y = a or b (95 %)"),
            (True, 0.5, {"a": 1.0, "b": 0.0}, "holds only if x.y = a (100 %, else 0 %)"),
            (False, 0.3, {"a": 0.1, "c": 0.6}, f"{combine}, above all x.y = c (60 %, else 10 %)"),
            (True, 0.5, {}, combine),
            (True, 0.02, {}, combine),
        ):
            assert " ".join(verdict(holds, share, rates, "x.y" if rates else "")).rstrip() == says

    def test_a_judgement_names_what_turns_and_what_decides(self):
        chosen = (
            sweeping.Factor("foot.width", (0.1, 0.05), "", ("shapes", "optima")),
            sweeping.Factor("foot.apex", ("middle", "toe"), "", ("shapes",)),
        )
        levels = np.array([[i % 2, i // 2 % 2] for i in range(40)])
        plan = Plan(Config(), chosen, [{"foot.width": 0.05}, {"foot.apex": "toe"}], levels)
        margins = np.where(levels[:, 1] == 1, 1.0, -1.0)
        margins[0] = np.nan
        swept = np.array([-2.0, 1.0, *margins])
        about_shapes = judge(-1.0, swept, plan, "shapes")
        assert about_shapes.decides == "foot.apex"
        assert about_shapes.share_by_level == {"middle": 0.0, "toe": 1.0}
        assert about_shapes.turned_by == ["foot.apex=toe"]
        assert (about_shapes.undecided, about_shapes.verdict) == (1, "holds only if")
        assert set(judge(-1.0, swept, plan, "optima").sensitivity) == {"foot.width"}

    def test_the_threads_do_not_change_the_sweep(self, monkeypatch):
        few = tuple(f for f in FACTORS if f.setting in ("foot.apex", "study.speed_loss"))
        monkeypatch.setattr(sweeping, "FACTORS", few)
        plan = Plan.of(config(study__confirm="draft", study__samples=2, solver__pop_size=6, solver__n_gen=1))
        feet = dict.fromkeys(SANDS, fo.Foot.from_waypoints(ROCKER))
        one, two = (sweep(plan, feet, threads) for threads in (1, 2))
        np.testing.assert_array_equal(one, two)
        assert plan.names[0] == "foot.apex=toe"
        assert np.isfinite(one[: len(plan.names)]).all()

    def test_a_search_without_a_feasible_foot_leaves_its_claims_undecided(self, monkeypatch):
        monkeypatch.setattr(sweeping, "FACTORS", tuple(f for f in FACTORS if f.setting == "foot.width"))
        sinking = config(study__confirm="draft", study__samples=1, solver__pop_size=6, solver__n_gen=1)
        plan = Plan.of(changed(sinking, {"walker.mass": 2000.0}))
        assert np.isnan(sweep(plan, dict.fromkeys(SANDS, fo.Foot.from_waypoints(ROCKER)), 1)).all()


def test_settings_name_effects_beside_those_of_the_scene():
    both = config(study__leading_edge=True, study__shadowing="sole")
    assert set(Setup(both).scene("soft").effects) == {fo.LeadingEdge(), fo.Shadowing()}
    prints = config(study__footprints=True)
    assert Setup(prints).scene("soft").effects == (fo.Footprints(),)
    assert Setup(config()).scene("hard").effects == ()


class TestPage:
    def test_the_stored_page_is_written_from_the_stored_data(self):
        found = json.loads((REFERENCE / "claims.json").read_text(encoding="utf-8"))
        assert page.markdown(found) == (REFERENCE / "claims.md").read_text(encoding="utf-8")
        for entry in found["claims"]:
            for name in ("place", "says", "decided", "unit"):
                assert entry[name] == getattr(CLAIMS[entry["id"]], name)


@pytest.fixture
def small(monkeypatch):
    """A study of a second: two factors and a tiny search."""
    few = tuple(f for f in FACTORS if f.setting in ("foot.apex", "foot.width"))
    monkeypatch.setattr(sweeping, "FACTORS", few)
    monkeypatch.setattr(setup, "QUICK_SEARCH", (6, 2))
    unrender(monkeypatch)


@pytest.mark.slow
def test_the_study_leaves_figures_claims_and_a_page(small, tmp_path, capsys):
    settings = config(study__name="paper", study__quick=True, study__confirm="draft")
    run(Study(settings, tmp_path, {"study": {"quick": True}}))
    assert {f"{name}.png" for name in CAPTIONS} <= {p.name for p in (tmp_path / "figures").iterdir()}
    found = json.loads((tmp_path / "result.json").read_text())
    assert [entry["id"] for entry in found["claims"]] == list(CLAIMS)
    for entry in found["claims"]:
        assert entry["verdict"] in VERDICTS
        assert 0.0 <= entry["share_of_sweep"] <= 1.0
        assert entry["holds_at_the_settings"] == (entry["margin"] > 0.0)
        assert set(entry["single_changes"]) == {"foot.width=0.05", "foot.width=0.15", "foot.apex=toe"}
    hard = found["optima"]["hard"]
    walked = fo.simulate(fo.Foot.from_waypoints(hard["k"]), fo.Scene(), "draft").objectives
    assert hard["objectives"] == {name: walked[name] for name in hard["objectives"]}
    assert hard["all_seeds_best_first"][0]["efficiency"] == walked["efficiency"]
    text = (tmp_path / "claims.md").read_text()
    assert text == page.markdown(found)
    assert "- soft sand: depth of the sole" in text, "no warning where RFT is stretched"
    assert f"{len(CLAIMS)} claims" in capsys.readouterr().out
    check_page(tmp_path)


def test_without_a_sweep_claims_are_judged_at_the_settings(small, tmp_path):
    settings = replace(config(study__quick=True, study__confirm="draft", study__samples=0), report="none")
    run(Study(settings, tmp_path, {}))
    entries = json.loads((tmp_path / "result.json").read_text())["claims"]
    assert all(e["verdict"] == ("holds" if e["margin"] > 0.0 else "does not hold") for e in entries)
    assert all(e["share_of_sweep"] is None for e in entries)
    assert "Nothing was swept" in (tmp_path / "claims.md").read_text()


@pytest.mark.slow
def test_a_study_that_is_killed_loses_only_what_it_was_at(small, tmp_path, monkeypatch):
    chosen = config(study__quick=True, study__confirm="draft", engine__threads=1)
    settings = replace(chosen, report="none")
    best, left, searched = setup.Setup.best, 1000, []

    def dying(self, sand, seed):
        if len(searched) == left:
            raise KeyboardInterrupt
        searched.append(sand)
        return best(self, sand, seed)

    monkeypatch.setattr(setup.Setup, "best", dying)
    (whole := tmp_path / "whole").mkdir()
    run(Study(settings, whole, {}))
    all_of_them, left = len(searched), len(searched) + 5
    with pytest.raises(KeyboardInterrupt):
        run(Study(settings, tmp_path, {}))
    with open(tmp_path / "tasks.jsonl", "a") as file:
        file.write("\n[[")  # torn by the kill
    before, left = len(searched), 1000
    run(Study(settings, tmp_path, {}))
    again, found = (json.loads((place / "result.json").read_text()) for place in (tmp_path, whole))
    assert again["claims"] == found["claims"]
    assert len(searched) - before == all_of_them - 3  # the feet are kept, not half of a change


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"study__seeds": 0}, "study.seeds = 0: must be a whole number >= 1"),
        ({"study__shape_sand": "mud"}, "study.shape_sand = 'mud': must be one of soft, regular, hard"),
        ({"foot__shape": "circle"}, "foot.shape = 'circle': must be waypoints"),
        ({"scene__t_f": 1.0}, "scene.t_f = 1.0: must be later than the first heel strike"),
        ({"solver__pop_size": 2}, "solver.pop_size = 2: must be null, or a whole number >= 4"),
        ({"study__confirm": "best"}, "accuracy = 'best': must be one of"),
    ],
)
def test_bad_settings_are_refused_before_anything_is_searched(settings, message, tmp_path):
    with pytest.raises(SettingError) as error:
        run(Study(config(**settings), tmp_path, {}))
    assert message in str(error.value)
    assert not (tmp_path / "result.json").exists()


class TestShapes:
    def test_they_hang_from_their_centre_or_their_top(self):
        centre = make_shapes(config())
        top = make_shapes(config(study__mount="top", foot__ankle=[-0.03, 0.01]))
        assert list(centre) == list(SHAPES)
        for name, foot in centre.items():
            low = foot.contour[:, 1].min()
            assert foot.ankle == (0.0, 0.0)
            assert top[name].ankle == pytest.approx((-0.03, 0.01 - low))
        with pytest.raises(SettingError, match=r"study\.mount = 'side': must be one of centre, top"):
            make_shapes(config(study__mount="side"))
