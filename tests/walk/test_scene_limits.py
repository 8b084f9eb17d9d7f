"""Scenes, walkers and accuracies: what is refused, the presets, and how poses are kept."""

import math
import sys

import footopt as fo
from footopt.walk.accuracy import PRESETS
from footopt.walk.discretize import pose_rows
from footopt.walk.ladder import numerics


class TestSettings:
    def test_a_walk_too_long_to_be_refined_has_no_error_estimate(self, ramp_foot, monkeypatch):
        rows = pose_rows(fo.Scene(), numerics(PRESETS["draft"], fo.Scene(), ramp_foot))
        monkeypatch.setattr(sys.modules["footopt.walk.discretize"], "ROWS", 1.5 * rows)
        assert fo.simulate(ramp_foot, accuracy="draft").feasible
        assert all(map(math.isnan, fo.estimate_error(ramp_foot, accuracy="draft").values()))

    def test_steps_divide_the_walk_and_are_not_longer_than_dt(self):
        assert fo.Accuracy(dt=1e-3).steps(2.9) == 2900
        assert fo.Accuracy(dt=2e-3).steps(0.3 + 2.6) == 1450
        assert fo.Accuracy(dt=1.0).steps(0.1) == 1
        assert fo.Accuracy(dt=0.3).steps(1.0) == 4
