"""One foot for several sands, for drawn scenarios, or for the walker and a robot: what it loses in each."""

import json

import numpy as np
import pytest
from running import composed, footopt, unrender
from study_pages import check_page

import footopt as fo
from footopt.design.scenarios import sands
from footopt.studies.runs import run_study
from footopt.walk.accuracy import PRESETS
from footopt.walk.ladder import numerics

#: Studies that take seconds.
BRIEF = ["study=robust", "solver.n_gen=5", "foot.n=5", "solver.pop_size=20", "accuracy=draft",
         "study.confirm=standard"]  # fmt: skip
TRANSFER = ["study=transfer", "study.sands=[hard,2.5]", "study.walks=60", "solver.walks=20", "study.soles=8",
            "foot.n=5", "foot.K=4", "accuracy=custom", "accuracy.dt=2e-3", "accuracy.plates=16",
            "study.confirm=null", "robot.duration=1.4"]  # fmt: skip


@pytest.mark.slow
def test_regrets_are_what_the_library_computes(tmp_path):
    done = footopt(*BRIEF, "hydra.run.dir=run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert list(result["feet"]) == ["soft", "regular", "hard", "robust"]
    space = fo.Waypoints(n=5)
    for scenario, saved in zip(sands(fo.Scene()), result["scenarios"], strict=True):
        walked = fo.Accuracy(**saved["accuracy"])
        assert walked == numerics(PRESETS["standard"], scenario.scene, space)
        table = fo.evaluate(list(result["feet"].values()), scenario.scene, walked, space=space)
        expected = 1 - table.efficiency / table.efficiency[:3].min()
        found = [result["regrets"][name][scenario.name] for name in result["feet"]]
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_solver_that_draws_its_own_designs_needs_no_specialists_and_the_exact_one_is_exact(tmp_path):
    words = ["study=robust", "solver=exhaustive", "foot.n=4", "foot.K=3", "accuracy=draft", "report=none"]
    foot = fo.run([*words, "study.confirm=null"], tmp_path).foot.k
    scenes, space = [s.scene for s in sands(fo.Scene())], fo.Waypoints(n=4, K=3)
    soles = np.array(list(np.ndindex(3, 3, 3, 3))) + 1
    soles = soles[space.inside(soles)]
    found = np.stack([fo.evaluate(soles, scene, "draft", space=space).efficiency for scene in scenes])
    worst = (1 - found / found.min(axis=1, keepdims=True)).max(axis=0)
    assert foot == tuple(soles[worst.argmin()])


@pytest.mark.slow
def test_of_drawn_scenarios_each_has_its_specialist(tmp_path, monkeypatch):
    unrender(monkeypatch)
    words = ["study.scenarios=drawn", "study.draws=5", "study.measure=tail", "solver=nsga2"]
    words += ["solver.pop_size=4", "objective.names=[distance,efficiency]"]  # fewer than specialists
    run_study(composed(*BRIEF, *words), tmp_path, {})
    check_page(tmp_path)
    result = json.loads((tmp_path / "result.json").read_text())
    assert list(result["feet"]) == [*(f"draw {i}" for i in range(1, 6)), "robust"]
    zetas = [s["scene"]["sand"]["zeta"] for s in result["scenarios"]]
    assert zetas == [s.scene.sand.zeta for s in fo.draw(fo.Scene(), fo.Spread(), 5, 1)]


@pytest.mark.slow
def test_each_foot_walks_on_both_and_losses_are_against_the_better_design(tmp_path):
    pytest.importorskip("mujoco")
    run_study(composed(*TRANSFER), tmp_path, {}, TRANSFER)
    result = json.loads((tmp_path / "result.json").read_text())
    space = fo.Waypoints(n=5, K=4)
    assert [found["sand"] for found in result["transfer"]] == ["hard", "zeta 2.5"]
    for found, sand in zip(result["transfer"], (fo.Sand.named("hard"), fo.Sand(zeta=2.5)), strict=True):
        feet = found["feet"]
        assert [*feet] == ["flat", "walker", "robot"]
        soles = [fo.Foot.from_waypoints(k, space) for k in feet.values()]
        robot = fo.mujoco.Robot(sand=sand, duration=1.4)
        values = fo.evaluate(soles, robot, fo.Accuracy(dt=2e-3, plates=16), "efficiency").values[:, 0]
        given = [found["values"]["robot"][name]["efficiency"] for name in feet]
        np.testing.assert_allclose(given, values, rtol=1e-12)
        np.testing.assert_allclose([*found["losses"]["robot"].values()], 1 - values / values[1:].min())
        assert found["losses"]["walker"]["walker"] == 0.0
        assert -1.0 <= found["tau"] <= 1.0
        assert found["soles"] <= 8
    check_page(tmp_path)
