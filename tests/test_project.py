"""A project of one's own: settings, gait and plugin beside each other, with footopt's settings below them."""

import json
import shutil
from pathlib import Path

import pytest
from running import footopt

import footopt as fo

ROBOT = Path(__file__).parents[1] / "examples" / "moon_robot"


@pytest.mark.usefixtures("clean")
@pytest.mark.slow
def test_the_example_finds_its_files_and_a_foot_that_shakes_little(tmp_path):
    """In a copy, which is not that of the checkout: footopt's settings are found as pkg://footopt.conf."""
    robot = shutil.copytree(ROBOT, tmp_path / "robot")
    small = ["constraint.shaking=0.22", "solver.pop_size=12", "solver.n_gen=8", "accuracy=draft"]
    small += ["study.confirm=null", "report=none", "hydra.run.dir=run"]
    done = footopt("-cp", str(robot / "conf"), "-cn", "robot", *small, cwd=robot)
    assert done.returncode == 0, done.stderr
    found = json.loads((robot / "run" / "result.json").read_text())
    assert found["objectives"]["shaking"] <= 0.22 == found["constraints"]["shaking"]
    run = fo.load(robot / "run", trust=True)
    assert (run.scene.gait.source, run.scene.gait.name) == (str(robot / "gait.csv"), "robot")
    assert run.scene.walker == fo.Walker(mass=35.0, l1=0.3, l2=0.32, g=1.62)
    assert run.foot.width == 0.07
    assert 1e3 * (run.foot.contour[-1, 0] - run.foot.contour[0, 0]) == pytest.approx(180)
