"""Sensitivities: variance goes to the parameter that makes it, in sign and size."""

import csv
import json
import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest
from running import composed, footopt
from searching import QUICK as COARSE
from study_pages import check_page

import footopt as fo
from footopt import studies
from footopt.errors import FootoptError, SettingError
from footopt.studies import sensitivity as study
from footopt.studies.sensitivity import NAMES, Setting, analyse

NOTHING = fo.Spread(**dict.fromkeys(vars(fo.Spread()), 0.0))
ZETA_MASS = replace(NOTHING, zeta=0.2, mass=0.2)


def setting(foot=None, spread=ZETA_MASS, waypoint=0.0, width=0.0, creep=0.0, kind=Setting):
    foot = foot or fo.Foot.from_waypoints([3, 5, 4, 2, 3])
    return kind(foot, fo.Scene(), COARSE, spread, waypoint, width, creep)


@dataclass(frozen=True)
class Linear(Setting):
    """A walk whose every objective is 10 + 3 zeta - 4 mass + 0 creep, in standard deviations."""

    def walk(self, normals):
        row = dict(zip(self.columns, normals, strict=True))
        return np.full(len(NAMES), 10.0 + 3.0 * row["zeta"] - 4.0 * row["mass"]), ""


@pytest.fixture(scope="module")
def linear():
    s = setting(creep=0.5, kind=Linear)
    return analyse(s, s.blocks["parameters"], 1024, seed=1, threads=1)


class TestIndices:
    def test_a_linear_model_has_the_indices_of_its_coefficients(self, linear):
        assert linear.parameters == ("zeta", "mass", "creep")
        for found, error in ((linear.total, linear.total_error), (linear.first, linear.first_error)):
            expected = np.array([[9 / 25], [16 / 25], [0.0]])
            assert (np.abs(found - expected) <= 1.5 * error + 1e-9).all()
            assert error.max() < 0.15

    def test_a_linear_model_changes_by_its_coefficients(self, linear):
        np.testing.assert_allclose(linear.change, np.tile([[0.3], [-0.4], [0.0]], len(NAMES)), atol=1e-12)

    def test_a_parameter_of_several_variables_has_an_index_and_no_sign(self):
        s = setting(spread=replace(NOTHING, zeta=0.1, angles=1.0))
        found = analyse(s, s.blocks["parameters"], 8, seed=1)
        assert found.parameters == ("zeta", "thigh", "knee")
        assert np.isfinite(found.total).all()
        assert np.isnan(found.change[1:]).all()
        assert found.walks == 1 + 2 * 3 + 8 * (3 + 2)

    def test_the_same_seed_gives_the_same_on_any_number_of_threads(self):
        s = setting()
        one, two = (analyse(s, s.blocks["parameters"], 4, seed=3, threads=n) for n in (1, 2))
        np.testing.assert_array_equal(one.total, two.total)
        np.testing.assert_array_equal(one.total_error, two.total_error)


class TestSetting:
    def test_the_middle_is_the_foot_itself(self):
        s = setting(waypoint=1e-3, width=0.1, creep=0.5, spread=fo.Spread())
        values, reason = s.walk(np.zeros(len(s.columns)))
        table = fo.evaluate([s.foot], s.scene, COARSE, NAMES)
        np.testing.assert_allclose(values, table.values[0], rtol=1e-9)
        assert reason == ""

    def test_a_waypoint_moves_up_by_its_deviation(self):
        s = setting(waypoint=2e-3)
        moved = s._moved(np.array([0, 1.0, 0, 0, 0]))
        rise = moved.contour[32, 1] - s.foot.contour[32, 1]
        assert rise == pytest.approx(2e-3, abs=2e-6)
        np.testing.assert_allclose(
            moved.contour[[0, 64, 96, 128]], s.foot.contour[[0, 64, 96, 128]], atol=1e-12
        )

    def test_only_what_is_spread_is_walked_with(self):
        assert setting().blocks == {"parameters": ("zeta", "mass")}
        assert setting(waypoint=1e-3).blocks["waypoints"] == tuple(f"waypoint {i}" for i in range(1, 6))
        ellipse = setting(foot=fo.Foot.shape("ellipse"), waypoint=1e-3, width=0.1)
        assert ellipse.blocks == {"parameters": ("zeta", "mass", "width")}

    def test_labels_say_how_far_each_is_spread(self):
        s = setting(waypoint=1e-3, width=0.05, spread=fo.Spread())
        labels = [s.label(name) for name in ("zeta", "thigh", "ankle_x", "width", "waypoint 3")]
        assert labels == ["zeta, 30 %", "thigh, 2°", "ankle x, 5 mm", "width, 5 %", "k3, 1 mm"]


class TestErrors:
    def test_samples_are_a_power_of_two(self):
        with pytest.raises(SettingError, match=r"study\.samples = 100: must be a power of two"):
            analyse(setting(), ("zeta", "mass"), 100, seed=1)

    def test_walks_that_fail_are_counted(self):
        s = replace(setting(spread=replace(NOTHING, zeta=0.5)), scene=fo.Scene(sand=fo.Sand(1e-3)))
        with pytest.raises(FootoptError, match=r"of 15 walks failed \(\d+ sunk\)"):
            analyse(s, ("zeta",), 4, seed=1)

    def test_a_missing_salib_is_explained(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "SALib.sample", None)
        with pytest.raises(FootoptError, match=r'pip install "footopt\[sensitivity\]"'):
            analyse(setting(), ("zeta", "mass"), 4, seed=1)

    def test_settings_are_checked(self, tmp_path):
        still = [f"study.spread.{name}=0" for name in vars(fo.Spread())]
        still += ["study.foot_spread.width=0", "study.foot_spread.creep=0", "foot=ellipse"]
        for settings, message in (
            (["study.foot_spread.width=-1"], r"study\.foot_spread\.width = -1"),
            (["study.spread.zeta=-1"], r"study\.spread\.zeta = -1"),
            (["scene.t_f=0.5"], r"scene\.t_f = 0\.5"),
            (still, r"study\.spread = "),
        ):
            with pytest.raises(SettingError, match=message):
                studies.run(composed("study=sensitivity", *settings), tmp_path, {})


@pytest.mark.slow
def test_from_the_command_line(tmp_path):
    done = footopt("study=sensitivity", "study.quick=true", "foot.n=4", "foot.k=[3,5,4,2]", "accuracy=draft",
                   "hydra.run.dir=run", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 0, done.stderr
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert list(result["blocks"]) == ["parameters", "waypoints"]
    assert result["samples"] == study.QUICK_SAMPLES
    with open(tmp_path / "run" / "sensitivity.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == (10 + 4) * len(NAMES)
    by_zeta = {r["objective"]: float(r["change"]) for r in rows if r["parameter"] == "zeta"}
    assert by_zeta["mean_height"] > 0 > by_zeta["work"]  # harder sand: less sinkage, less work
    check_page(tmp_path / "run")
    assert f"{14 * 16 + 2 * 16 * 2 + 2 * 14 + 2} walks" in done.stdout
