"""Scenes, walkers and accuracies: what is refused, the presets, and how poses are kept."""

import math
import sys

import footopt as fo
from footopt.walk.accuracy import PRESETS
from footopt.walk.discretize import long_pose_tables, pose_rows, pose_tables, poses
from footopt.walk.ladder import numerics

ORDINARY = fo.Accuracy(dt=0.01, control=2e-3)


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


def test_poses_of_long_motions_do_not_pile_up(monkeypatch):
    """A motion of ten minutes takes 290 MB: of such ones two are kept, of short ones many."""
    long = pose_rows(fo.Scene(t_f=1.5), ORDINARY)
    monkeypatch.setattr(sys.modules["footopt.walk.discretize"], "LONG", long)
    gaits = [fo.Gait.human(period=period) for period in (1.0, 1.1, 1.2, 1.3)]
    for duration, kept in ((1.0, pose_tables), (2.0, long_pose_tables)):
        kept.cache_clear()
        for gait in gaits:
            poses(fo.Scene(gait=gait, t_f=duration), ORDINARY)
        assert kept.cache_info().currsize == min(len(gaits), kept.cache_info().maxsize)
    assert long_pose_tables.cache_info().maxsize < len(gaits)
