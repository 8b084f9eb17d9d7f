"""study=doctor holds a walk to the published numbers."""

import json

import numpy as np
import pytest

import footopt as fo
from footopt.errors import FootoptError
from footopt.studies import Doctor, doctor
from footopt.studies.runs import run_study
from footopt.studies.settings import Config
from footopt.walk.reference import PUBLISHED, RAMP


def examine(folder):
    run_study(Config(study=Doctor()), folder, {})


def test_a_sound_installation_passes_with_the_measured_differences(tmp_path):
    examine(tmp_path)
    found = json.loads((tmp_path / "result.json").read_text())["findings"]
    for published in PUBLISHED:
        values = fo.evaluate([RAMP], fo.Scene(sand=fo.Sand.named(published.sand))).values[0]
        worst = 100 * np.abs(values / published.objectives - 1).max()
        assert f"differs by up to {worst:.2g} %" in found[f"{published.sand} sand"]


def test_a_walk_that_is_wrong_fails_and_names_the_objective(tmp_path, monkeypatch):
    distance, *others = PUBLISHED[2].objectives
    wrong = PUBLISHED[2]._replace(objectives=(1.01 * distance, *others))
    monkeypatch.setattr(doctor, "PUBLISHED", (wrong,))
    with pytest.raises(FootoptError, match=r"hard sand differs by up to 0\.99 % \(distance\)"):
        examine(tmp_path)
    assert (tmp_path / "report.html").exists()
