"""What an accuracy decides: pairs that are ranked wrongly, right rankings, orders of convergence."""

import io
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

import footopt as fo
from footopt.report.figures.accuracy import decision as figure
from footopt.studies import decision


def test_a_right_order_turns_no_pair_round_and_its_reverse_all_of_them():
    truth = np.array([-3.0, -1.0, -2.0, 4.0])
    assert decision.wrong(truth, truth) == 0.0
    assert decision.wrong(10.0 + 1e-3 * truth, truth) == 0.0
    assert decision.wrong(-truth, truth) == 1.0
    assert decision.wrong(np.array([-3.0, -2.0, -1.0, 4.0]), truth) == pytest.approx(1 / 6)


def test_a_tie_or_a_failed_walk_where_there_is_an_order_is_a_wrong_pair():
    assert decision.wrong(np.array([1.0, 1.0]), np.array([1.0, 2.0])) == 1.0
    assert decision.wrong(np.array([1.0, np.nan]), np.array([1.0, 2.0])) == 1.0
    assert np.isnan(decision.wrong(np.array([1.0]), np.array([1.0])))


def test_a_right_ranking_is_the_cheapest_that_turns_few_pairs_round():
    settings = [SimpleNamespace(ms=ms, wrong_finalists=w) for ms, w in ((0.1, 0.3), (0.5, 0.01), (2.0, 0.0))]
    best, seconds = decision.right_ranking(settings)
    assert best is settings[1]
    assert seconds == pytest.approx(0.5e-3 * decision.FINALISTS)
    assert decision.right_ranking(settings[:1]) is None


def test_answers_of_searches_lack_nothing_against_themselves():
    worse, better = np.full((1, 11), 5), np.array([[2, 6, 6, 2, 1, 1, 1, 1, 3, 4, 1]])
    scenes = [fo.Scene(sand=fo.Sand.named("hard"))]
    found = [
        decision.Search("draft", "hard", seed, k, 1.0, 0.1) for seed, k in enumerate((better, worse, better))
    ]
    loss = decision.lost(found, scenes, fo.Accuracy.named("draft"))
    assert loss[0] == loss[2] == 0.0
    assert 0.0 < loss[1] < 1.0
    assert decision.finalists_of(found, scenes, "draft")[0] is better


def test_the_figure_says_every_number():
    rows = [
        {"preset": name, "search_s": 2.0 * i, "confirm_s": 0.5, "compile_s": 9.0, "wrong_finalists": 0.1 / i,
         "wrong_random": 0.01 / i, "losses": [0.0, 0.02 / i]}
        for i, name in enumerate(decision.ASKED, 1)
    ]  # fmt: skip
    drawn = figure(rows)
    drawn.draw_without_rendering()
    words = {text.get_text() for axes in drawn.axes for text in axes.texts}
    assert {"2.5 s\n+ 9", "10 %", "1 %"} <= words


def test_no_number_of_the_table_is_cut_at_80_columns():
    row = {"preset": "reference", "evaluations": 11600.0, "ms": 10.23, "wrong_random": 1.1e-3,
           "wrong_finalists": 1.1e-3, "search_s": 0.124, "confirm_s": 0.00017, "loss_mean": 1.2e-6,
           "loss_worst": 3.4e-6}  # fmt: skip
    out = Console(file=io.StringIO(), width=80)
    out.print(decision.table_of_presets([row]))
    assert "0.12  0.00012, 0.00034" in out.file.getvalue()


@pytest.mark.slow
def test_the_time_step_falls_with_the_order_of_the_stepper():
    scenes = [fo.Scene(sand=fo.Sand.named("regular"))]
    feet = fo.Waypoints().random(10, seed=1, inside=True)
    done = []
    found = {o.knob: o for o in decision.orders(scenes, feet, fo.Waypoints(), None, False, done.append)}
    assert [o.knob for o in found.values()] == list(decision.GRIDS)
    assert len(done) == 3
    assert 1.5 < found["time step"].order < 3.0
    assert 0.0 < found["time step"].index < 0.01
