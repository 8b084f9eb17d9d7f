"""The paper's study: its open choices, the verdicts, and what it leaves in its folder."""

import json
import math
import runpy
from pathlib import Path

import pytest
from paper_cases import config
from running import unrender
from study_pages import check_page

import footopt as fo
from footopt.studies import Paper
from footopt.studies.build import make_effects
from footopt.studies.paper import VERDICTS, judge, run, walks
from footopt.studies.paper.claims import CLAIMS
from footopt.studies.paper.walks import CHOICES, changes, evidence
from footopt.studies.runs import Study
from footopt.studies.settings import Config

DOCS = Path(__file__).parents[2] / "docs"
REFERENCE = Path(__file__).parents[2] / "outputs/reference/paper"
SMALL = {"study__confirm": "draft", "accuracy__name": "draft", "solver__pop_size": 6, "solver__n_gen": 1}


class TestChoices:
    def test_one_at_a_time_is_made_otherwise_than_the_settings(self):
        default = dict(changes(Config(study=Paper())))
        assert len(default) == sum(len(values) - 1 for values in CHOICES.values())
        own = dict(changes(config(foot__width=0.05, study__cases=["foot.width", "effects"])))
        assert list(own) == ["foot.width=0.1", "foot.width=0.15", "effects=leading_edge", "effects=shadowing"]
        assert own["foot.width=0.15"].foot.width == 0.15
        assert make_effects(own["effects=shadowing"].effects) == (fo.Shadowing(),)
        assert own["effects=shadowing"].foot.width == 0.05
        assert dict(changes(config(study__cases=[]))) == {}

    @pytest.mark.slow
    def test_every_choice_moves_the_walks(self):
        """Shapes or best feet, as they are read, differ from those at the settings."""
        done = {}

        def numbers(settings):
            every = evidence(settings, done).values()
            return [
                walk.objectives[name] for walk in every for name in ("distance", "peak_power", "speed_loss")
            ]

        own = numbers(config(**SMALL))
        for name, other in changes(config(**SMALL)):
            assert numbers(other) != own, name


class TestJudgement:
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
        found = json.loads((REFERENCE / "claims.json").read_text(encoding="utf-8"))
        page = runpy.run_path(str(DOCS / "claims.py"))["page"]()
        assert page == (REFERENCE / "claims.md").read_text(encoding="utf-8"), "run python docs/claims.py"
        for entry in found["claims"]:
            assert {name: entry[name] for name in CLAIMS[entry["id"]]} == CLAIMS[entry["id"]]
            again = judge(entry["margin"], entry["changed"])
            assert (again["verdict"], again["hangs_on"]) == (entry["verdict"], entry["hangs_on"])


@pytest.mark.slow
def test_the_study_leaves_figures_claims_and_a_page_and_searches_nothing_twice(tmp_path, capsys, monkeypatch):
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
    assert f"{len(CLAIMS)} claims" in capsys.readouterr().out
    check_page(tmp_path)
    assert len(searched) == 6  # how the triangle stands does not move the best feet
