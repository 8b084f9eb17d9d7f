"""The examples' commands do what their page says, from files as they are."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import footopt as fo
from footopt.gait.files import read

ROOT = Path(__file__).parent.parent
EXAMPLES = ROOT / "examples"
PAGE = (EXAMPLES / "README.md").read_text()
BLOCKS = [block.splitlines() for block in re.findall(r"```sh\n(.*?)\n```", PAGE, flags=re.S)]


@pytest.mark.slow
@pytest.mark.parametrize("commands", BLOCKS, ids=lambda commands: commands[-1].split()[2])
def test_the_commands_of_the_page_run(tmp_path, commands):
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    for command in commands:
        words = shlex.split(command)
        run = [
            sys.executable,
            "-W",
            "error",
            "-m",
            *words,
            *(["accuracy=draft"] if "study=export" not in words else []),
        ]
        done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    results = [json.loads(path.read_text()) for path in tmp_path.rglob("result.json")]
    assert len(results) == len(commands)
    assert all(result.get("feasible", True) for result in results)


def test_the_three_rockers_are_one_foot():
    path = EXAMPLES / "sole" / "rocker"
    feet = [fo.Foot.from_file(path.with_suffix(f".{end}"), layer=layer)
            for end, layer in (("dxf", "FOOT"), ("svg", "FOOT"), ("csv", None))]  # fmt: skip
    x = np.linspace(-0.119, 0.129, 200)
    heights = [np.interp(x, *foot.contour.T) for foot in feet]
    np.testing.assert_allclose(heights[1:], [heights[0]] * 2, rtol=0, atol=3e-5)
    assert feet[0].contour[:, 1].min() == pytest.approx(-0.028, abs=1e-6)


@pytest.mark.parametrize("name", ["walk.trc", "walk.mot"])
def test_the_gaits_are_the_built_in_one(name):
    gait, human = read(EXAMPLES / "gait" / name), fo.Gait.human()
    assert gait.period == pytest.approx(human.period, rel=0.01)
    for joint in ("thigh", "knee", "foot"):
        for mine, true in zip((gait, human), (human, gait), strict=True):
            angles = [np.degrees(getattr(g, joint).at(np.arange(200) / 200)[0]) for g in (mine, true)]
            assert np.ptp(angles[0]) == pytest.approx(np.ptp(angles[1]), abs=2.5)


def test_the_sand_is_six_tenths_of_the_generic_one():
    sand = fo.Sand.from_table(EXAMPLES / "sand" / "stresses.csv")
    assert sand.stress_map.A00 == pytest.approx(0.6 * fo.StressMap().A00, abs=0.005)
    assert sand.stress_map.B01 == pytest.approx(0.6 * fo.StressMap().B01, abs=0.005)
