"""study=transfer: feet of the walker and of a robot, each walked on both."""

import json

import numpy as np
import pytest
from running import composed
from study_pages import check_page

import footopt as fo
from footopt.studies.runs import run_study

BRIEF = ["study=transfer", "study.sands=[hard,2.5]", "study.walks=60", "solver.walks=20", "study.soles=8",
         "foot.n=5", "foot.K=4", "accuracy=custom", "accuracy.dt=2e-3", "accuracy.plates=16",
         "study.confirm=null", "robot.duration=1.4"]  # fmt: skip


@pytest.mark.slow
def test_each_foot_walks_on_both_and_losses_are_against_the_better_design(tmp_path):
    pytest.importorskip("mujoco")
    run_study(composed(*BRIEF), tmp_path, {}, BRIEF)
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
