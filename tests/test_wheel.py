"""The wheel works where no checkout is: it carries its settings and its gait data."""

import json
import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent


@pytest.mark.slow
def test_a_wheel_in_a_new_environment_runs_a_small_job(tmp_path):
    build = [sys.executable, "-m", "build", "--wheel", "--outdir", str(tmp_path / "dist"), str(ROOT)]
    subprocess.run(build, check=True, capture_output=True)
    (wheel,) = (tmp_path / "dist").glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    assert "footopt/conf/config.yaml" in names
    assert "footopt/gait/data/human_walk.json" in names
    assert "footopt/report/page/template.html" in names
    assert "footopt/py.typed" in names
    assert not [n for n in names if n.startswith(("tests/", "conf/", "outputs/"))]

    venv.create(tmp_path / "env", with_pip=True)
    bin_folder = tmp_path / "env" / ("Scripts" if os.name == "nt" else "bin")
    subprocess.run([bin_folder / "python", "-m", "pip", "install", "-q", wheel], check=True)
    job = [bin_folder / "footopt", "solver.n_gen=2", "solver.pop_size=8", "accuracy=draft"]
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    done = subprocess.run(job, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (result,) = (tmp_path / "outputs").rglob("result.json")
    assert json.loads(result.read_text())["objectives"]["distance"] > 1.0
