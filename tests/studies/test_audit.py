"""The effect audit: what an effect changes in a scene, and whether that matters."""

import numpy as np
import pytest

import footopt as fo
from footopt.effects import EFFECTS
from footopt.studies.effects import audit, every_effect, switched

FEET = fo.Waypoints().random(12, seed=3, inside=True)


def test_an_effect_that_acts_is_kept_and_says_what_it_changes():
    found = audit(fo.Slope(10.0), fo.Scene(), FEET, "draft", 0.01)
    assert found.matters
    assert "keep it" in found.verdict
    assert "leave it out" in found._replace(tolerance=10.0).verdict
    assert 0.0 < found.kendall_tau < 1.0
    assert found.walks_lost == 0
    with_ = fo.evaluate(FEET, fo.Scene(effects=(fo.Slope(10.0),)), "draft").values
    without = fo.evaluate(FEET, fo.Scene(), "draft").values
    expected = np.percentile(np.abs(with_ / without - 1.0), 95.0, axis=0)
    np.testing.assert_allclose(found.changes, expected)
    distance, height, *costs = (with_ / without).T
    assert found.gain == pytest.approx(np.median(distance * height / np.prod(costs, axis=0)))


def test_the_effect_takes_the_place_of_one_of_its_kind():
    one, other, slope = fo.Inertia(rho=100.0), fo.Inertia(rho=8000.0), fo.Slope(3.0)
    without, with_ = switched(other, fo.Scene(effects=(one, slope)))
    assert without.effects == (slope,)
    assert set(with_.effects) == {other, slope}


def test_every_effect_is_audited_once_as_the_scene_has_it():
    audited = every_effect(fo.Scene(effects=(fo.Slope(-3.0),)))
    assert [type(effect) for effect in audited] == list(EFFECTS.values())
    assert fo.Slope(-3.0) in audited
