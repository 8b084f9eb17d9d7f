"""A project of one's own: settings, gait and plugin beside each other, with footopt's settings below them."""

import csv
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
import yaml
from PIL import Image
from running import LIMIT, environment, footopt

import footopt as fo

ROBOT = Path(__file__).parents[2] / "examples" / "moon_robot"
WALK = ("study=simulate", "accuracy=draft", "report=none", "plugins=[]")


@pytest.fixture
def robot(tmp_path):
    """A copy of the example, which is not that of the checkout."""
    return shutil.copytree(ROBOT, tmp_path / "robot")


def walked(conf, *words, cwd):
    return footopt("-cp", str(conf), "-cn", "robot", *WALK, *words, "hydra.run.dir=run", cwd=cwd)


class TestSearchPath:
    """Hydra finds footopt's settings as pkg://footopt.conf, in a checkout as in a wheel (`test_wheel`)."""

    def test_files_are_found_from_the_folder_where_the_command_is_given(self, robot):
        done = walked(robot / "conf", cwd=robot)
        assert done.returncode == 0, done.stderr
        scene = fo.load(robot / "run").scene
        assert scene.gait.source == str(robot / "gait.csv")
        assert scene.gait.name == "robot"
        assert scene.walker == fo.Walker(mass=35.0, l1=0.3, l2=0.32, g=1.62)
        assert fo.load(robot / "run").foot.width == 0.07


@pytest.mark.slow
def test_the_example_goes_from_a_gait_to_a_body_and_a_film(robot):
    small = "accuracy=draft solver.pop_size=12 solver.n_gen=8 study.confirm=null engine.threads=1 report=none"
    words = [
        f"RUN={sys.executable} -m footopt",
        f"BUDGET={small}",
        "FILM=study.video=walk.gif scene.t_f=0.6 report=none",
    ]
    options = {"env": environment(drawn=True), "capture_output": True, "text": True, "timeout": LIMIT}
    done = subprocess.run(["make", "all", "sweep", *words], cwd=robot, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads((robot / "outputs/foot/result.json").read_text())
    assert found["scene"]["walker"]["g"] == 1.62
    assert found["objectives"]["shaking"] <= 0.22 == found["constraints"]["shaking"]
    body = trimesh.load(robot / "outputs/print/contour.stl")
    assert body.is_watertight
    assert body.extents[:2] == pytest.approx([180, 70], abs=0.1)
    soft = json.loads((robot / "outputs/soft/result.json").read_text())
    assert (soft["scene"]["sand"]["name"], soft["design"]["k"]) == ("soft", found["design"]["k"])
    with Image.open(robot / "outputs/soft/walk.gif") as film:
        assert film.n_frames > 10
    with open(robot / "outputs/sands/summary.csv", newline="") as file:
        assert [row["sand.name"] for row in csv.DictReader(file)] == ["soft", "regular", "hard"]
    launcher = yaml.safe_load((robot / "outputs/sands/multirun.yaml").read_text())["hydra"]["launcher"]
    assert launcher["_target_"].endswith("JoblibLauncher")
    assert (launcher["n_jobs"], launcher["batch_size"]) == (2, "1")  # those of the project
    assert (
        "Nothing to be done"
        in subprocess.run(["make", "all", "sweep", *words], cwd=robot, capture_output=True, text=True).stdout
    )
