"""study=accuracy: what every stepper and preset costs in time, and how wrong it is."""

import csv
import json

import pytest
from running import footopt
from study_pages import check_page

from footopt.walk import STEPPERS
from footopt.walk.accuracy import TOLERANCES


@pytest.mark.slow
def test_errors_of_every_stepper_and_preset_are_measured(tmp_path):
    words = ["study=accuracy", "study.feet=3", "sand=soft", "scene.t_f=2", "hydra.run.dir=run"]
    done = footopt(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "run" / "accuracy.csv", newline="") as file:
        assert {row["stepper"] for row in csv.DictReader(file)} == set(STEPPERS)
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    errors = {row["method"]: row["error"] for row in result["presets"]}
    assert all(errors[name] < tolerance for name, tolerance in TOLERANCES.items())
    assert errors["standard"] > errors["fine"]
    check_page(tmp_path / "run")
