"""study=trust: solvers against the true optimum of a space that can be enumerated."""

import csv
import json
import re

import pytest
from running import composed, unrender
from study_pages import check_page

import footopt as fo
from footopt.design import search
from footopt.errors import SettingError
from footopt.studies import run, trust
from footopt.walk.scenarios import anything

SPACE = fo.Waypoints(n=4, K=3)
TRUST = ("study=trust", "foot.n=4", "foot.K=3")


@pytest.mark.slow
def test_the_exhaustive_solver_as_the_command_line_composes_it(tmp_path, capsys, monkeypatch):
    unrender(monkeypatch)
    words = ("solver=exhaustive", "foot.n=4", "foot.K=3", "accuracy=draft", "solver.pop_size=100")
    run(composed(*words), tmp_path, {})
    result = json.loads((tmp_path / "result.json").read_text())
    exact = search(fo.FootProblem(fo.Scene(), space=SPACE, accuracy="draft"), "exhaustive")
    assert result["designs"] == 81
    assert result["infeasible"] == exact.infeasible
    assert result["confirmed"]["k"][0] in exact.k[:20].tolist()
    assert (tmp_path / "figures" / "contours.png").exists()
    assert not (tmp_path / "figures" / "convergence.png").exists()
    assert re.search(r"exhaustive, seed 1: \d\d evaluations of 81 designs", capsys.readouterr().out)


class TestStudy:
    @pytest.mark.slow
    def test_leaves_a_table_a_figure_and_the_exact_answer(self, tmp_path, capsys, monkeypatch):
        unrender(monkeypatch)
        words = (
            "study.quick=true",
            "accuracy=draft",
            "study.budget=300",
            "study.solvers=[memetic,nsga2,random]",
        )
        run(composed(*TRUST, *words), tmp_path, {})
        result = json.loads((tmp_path / "result.json").read_text())
        assert result["designs"] == 81
        assert {s["where"] for s in result["scores"]} == {"soft", "regular", "hard", "random scenes"}
        memetic = [s for s in result["scores"] if s["solver"] == "memetic"]
        assert all(s["found"] == 1.0 and s["regret"] == 0.0 for s in memetic)
        drawn = anything(1).scene
        for name, scene in {"hard": fo.Scene(sand=fo.Sand.named("hard")), "random 1": drawn}.items():
            found = result["exact"][name]
            walked = fo.Accuracy(**found["accuracy"])  # the scene's own numbers
            assert not walked.adapt
            exact = fo.evaluate([found["k"]], scene, walked, ("efficiency",), SPACE)
            assert exact.values[0, 0] == found["efficiency"]
        with open(tmp_path / "trust.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == 3 * 4 * 2
        assert all(int(r["walks"]) <= 81 for r in rows)
        assert {r["hypervolume"] == "" for r in rows if r["solver"] == "memetic"} == {True}
        check_page(tmp_path)
        assert "hypervolume" in capsys.readouterr().out

    @pytest.mark.slow
    def test_a_study_that_was_stopped_reads_what_it_had_walked(self, tmp_path, monkeypatch):
        unrender(monkeypatch)
        words = ("study.quick=true", "accuracy=draft", "study.budget=100", "study.scenes=0", "report=none",
                 "study.solvers=[random]")  # fmt: skip
        run(composed(*TRUST, *words), tmp_path, {})
        whole, walked = json.loads((tmp_path / "result.json").read_text()), []
        tables = sorted((tmp_path / "exact").iterdir())
        assert [path.stat().st_size for path in tables] == [81 * 8 * 8] * 3
        kept = tables[0].read_bytes()
        tables[0].write_bytes(kept[: 64 * 40] + bytes(64 * 41))  # as a kill may leave it
        made = tmp_path / "attempts.jsonl"
        made.write_text(made.read_text()[:-40])
        plain = fo.FootProblem.walk
        monkeypatch.setattr(
            fo.FootProblem, "walk", lambda self, k: (walked.append(len(k)), plain(self, k))[1]
        )
        searched, plainly = [], trust.attempt
        monkeypatch.setattr(trust, "attempt", lambda *what: (searched.append(what), plainly(*what))[1])
        run(composed(*TRUST, *words), tmp_path, {}, resumed=True)
        again = json.loads((tmp_path / "result.json").read_text())
        assert (again["exact"], again["scores"]) == (whole["exact"], whole["scores"])
        assert len(searched) == 1
        assert walked[1:] == [81]  # the first are walked to see whether the library of a peer is there
        assert tables[0].read_bytes() == kept

    @pytest.mark.parametrize(
        ("override", "message"),
        [
            ("study.seeds=0", r"study\.seeds = 0"),
            ("study.budget=50", r"study\.budget = 50: must be at least one generation, 100"),
            ("study.solvers=[ga,sa]", r"study\.solvers = 'sa': must be one of memetic"),
            ("foot.n=11", r"foot\.n = 11: must be small enough"),
        ],
    )
    def test_what_cannot_be_is_refused(self, tmp_path, override, message):
        with pytest.raises(SettingError, match=message):
            run(composed(*TRUST, "foot.K=10", override), tmp_path, {})
