"""A walk that its numerics do not resolve is said to be one."""

import math
from dataclasses import replace

import numpy as np
import pytest

import footopt as fo
from footopt.walk import FIVE, discretize
from footopt.walk.accuracy import PRESETS
from footopt.walk.ladder import numerics
from footopt.walk.resolution import BEYOND, resolution


def judged(foot, scene, accuracy="standard"):
    """What is said of a walk's resolution."""
    return resolution(fo.simulate(foot, scene, accuracy), fo.estimate_error(foot, scene, accuracy))


@pytest.mark.parametrize("sand", ["soft", "regular", "hard"])
def test_of_a_resolved_walk_nothing_is_said(sand, ramp_foot):
    assert judged(ramp_foot, fo.Scene(sand=fo.Sand.named(sand))) == []


@pytest.mark.parametrize(
    ("setting", "value"), [("dt", 0.02), ("plates", 5), ("creep", 0.3)], ids=["time step", "plates", "creep"]
)
def test_a_large_error_is_told(setting, value, ramp_foot):
    accuracy = replace(fo.Accuracy("sdirk2", 1e-3, 400, 1e-5, tolerance=0.0005), **{setting: value})
    (found,) = judged(ramp_foot, fo.Scene(), accuracy)
    assert found.outside
    assert found.limit == pytest.approx(100.0 * BEYOND * 0.0005)  # of `fine`, %


def test_an_error_of_another_measure_than_the_papers_is_told(flat_foot):
    walk = fo.simulate(flat_foot, fo.Scene(), "draft")
    (found,) = resolution(
        walk, dict.fromkeys(FIVE, 0.0) | {"maximum_sinkage": walk.totals["maximum_sinkage"]}
    )
    assert found.value == pytest.approx(100.0)


def test_an_estimate_is_twice_what_two_refinements_change(ramp_foot):
    """The distance to the walk refined twice, and what is left from there."""
    accuracy = fo.Accuracy(dt=8e-3, plates=40, creep=1e-4, control=8e-4)
    once = fo.Accuracy(dt=4e-3, plates=80, creep=5e-5, control=1e-4)
    twice = fo.Accuracy(dt=2e-3, plates=160, creep=2.5e-5, control=1.25e-5)
    values, finer, finest = (
        fo.evaluate(ramp_foot, accuracy=one).values[0] for one in (accuracy, once, twice)
    )
    expected = 2.0 * (abs(values - finest) + abs(finer - finest))
    found = fo.estimate_error(ramp_foot, accuracy=accuracy)
    np.testing.assert_allclose([found[name] for name in FIVE], expected, rtol=1e-9)


def test_the_smallest_numbers_that_are_allowed_can_be_refined(ramp_foot):
    """The estimate halves them, and stays inside what is allowed."""
    scene = fo.Scene(t_f=1.5)
    least = fo.Accuracy(dt=5e-3, plates=20, creep=1e-12, control=1e-12)
    assert fo.estimate_error(ramp_foot, scene, least)["distance"] >= 0.0


def test_a_walk_too_long_to_be_refined_has_no_error_estimate(ramp_foot, monkeypatch):
    rows = discretize.pose_rows(fo.Scene().path, numerics(PRESETS["draft"], fo.Scene(), ramp_foot))
    monkeypatch.setattr(discretize, "ROWS", 1.5 * rows)
    assert fo.simulate(ramp_foot, accuracy="draft").feasible
    assert all(map(math.isnan, fo.estimate_error(ramp_foot, accuracy="draft").values()))
