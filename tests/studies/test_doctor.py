"""study=doctor holds a walk to the published numbers."""

import json

import numpy as np
import pytest

import footopt as fo
from footopt.errors import FootoptError
from footopt.studies import Doctor, doctor
from footopt.studies.doctor import PUBLISHED, RAMP
from footopt.studies.runs import run_study
from footopt.studies.settings import Config


def examine(folder):
    run_study(Config(study=Doctor()), folder, {})


def test_a_sound_installation_passes_with_the_measured_differences(tmp_path):
    examine(tmp_path)
    found = json.loads((tmp_path / "result.json").read_text())["findings"]
    for sand, published in PUBLISHED.items():
        values = fo.evaluate([RAMP], fo.Scene(sand=fo.Sand.named(sand))).values[0]
        worst = 100 * np.abs(values / published - 1).max()
        assert f"differs by up to {worst:.2g} %" in found[f"{sand} sand"]


def test_a_walk_that_is_wrong_fails_and_names_the_objective(tmp_path, monkeypatch):
    distance, *others = PUBLISHED["hard"]
    monkeypatch.setattr(doctor, "PUBLISHED", {"hard": (1.01 * distance, *others)})
    with pytest.raises(FootoptError, match=r"hard sand differs by up to 0\.99 % \(distance\)"):
        examine(tmp_path)
    assert (tmp_path / "report.html").exists()
