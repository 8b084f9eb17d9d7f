"""study=robust: one foot for several sands or for drawn scenarios, and what it loses in each."""

import json

import numpy as np
import pytest
from motion_files import degrees
from running import composed, footopt, unrender
from study_pages import check_page

import footopt as fo
from footopt.design.scenarios import sands
from footopt.errors import SettingError
from footopt.files.gaits import read_strides
from footopt.studies.robust import make_spread
from footopt.studies.runs import run_study
from footopt.walk.accuracy import PRESETS
from footopt.walk.ladder import numerics

SANDS = sands(fo.Scene())
#: A study that takes a second.
BRIEF = ["study=robust", "solver.n_gen=5", "foot.n=5", "solver.pop_size=20", "accuracy=draft",
         "study.confirm=standard"]  # fmt: skip


@pytest.fixture(scope="module")
def run_sands(tmp_path_factory):
    cwd = tmp_path_factory.mktemp("sands")
    done = footopt(*BRIEF, "hydra.run.dir=run", cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done, cwd / "run"


class TestStudy:
    @pytest.mark.slow
    def test_regrets_are_what_the_library_computes(self, run_sands):
        result = json.loads((run_sands[1] / "result.json").read_text())
        assert list(result["feet"]) == ["soft", "regular", "hard", "robust"]
        space = fo.Waypoints(n=5)
        for scenario, saved in zip(SANDS, result["scenarios"], strict=True):
            walked = fo.Accuracy(**saved["accuracy"])
            assert walked == numerics(PRESETS["standard"], scenario.scene, space)
            table = fo.evaluate(list(result["feet"].values()), scenario.scene, walked, space=space)
            best = table.efficiency[:3].min()
            expected = 1 - table.efficiency / best
            found = [result["regrets"][name][scenario.name] for name in result["feet"]]
            np.testing.assert_allclose(found, expected, atol=1e-12)
            assert min(found[:3]) == 0.0

    @pytest.mark.slow
    def test_of_drawn_scenarios_each_has_its_specialist(self, tmp_path, monkeypatch):
        unrender(monkeypatch)
        config = composed(*BRIEF, "study.scenarios=drawn", "study.draws=3", "study.measure=tail",
                          "solver=nsga2",
                          "objective.names=[distance,efficiency]")  # fmt: skip
        run_study(config, tmp_path, {})
        check_page(tmp_path)
        result = json.loads((tmp_path / "result.json").read_text())
        assert list(result["feet"]) == ["draw 1", "draw 2", "draw 3", "robust"]
        drawn = fo.draw(fo.Scene(), fo.Spread(), 3, 1)
        zetas = [s["scene"]["sand"]["zeta"] for s in result["scenarios"]]
        assert zetas == [s.scene.sand.zeta for s in drawn]

    def test_what_is_null_is_measured_from_the_strides_of_the_gait(self, tmp_path):
        path, t = tmp_path / "walk.csv", np.arange(0.0, 6.1, 0.01)
        rng, angles = np.random.default_rng(1), degrees(fo.Gait.human(), t / 1.2)
        rows = np.stack([t, angles["thigh"], angles["knee"] + rng.normal(0.0, 0.5, len(t))], axis=1)
        np.savetxt(path, rows, delimiter=",", header="time,thigh,knee", comments="")
        null = ("study.spread.angles=null", "study.spread.period=null")
        spread = make_spread(composed(*BRIEF, "gait=file", f"gait.path={path}", *null))
        period, angles = read_strides(path).variation()
        assert spread == fo.Spread(period=period, angles=angles)
        assert 0.1 < angles < 1.0
        for gait in ((), ("gait=file", f"gait.path={path}", "gait.window=[0,1.2]")):
            with pytest.raises(SettingError, match=r"study\.spread\.period = None: must be a number, unless"):
                make_spread(composed(*BRIEF, *gait, *null))
