"""Patches: the strength changes along the way."""

from dataclasses import replace

import numpy as np
import pytest
from every_effect import PATCHES
from feet_in_sand import HEIGHT, PITCH, RATE, SOLES, SPEED, feel, pose_of
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.effects import Patches, Scale, laws
from footopt.effects import base as effects


class TestPatches:
    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, st.sampled_from([-1.0, 10.0]))
    def test_far_from_a_patch_nothing_changes(self, foot, height, pitch, rate, vx, vz, x):
        state = foot.plates(40, directed=True), pose_of(height, pitch, rate), vx, vz
        plain = feel(*state)[0]
        scale = 1e-12 * np.abs(plain).max()
        np.testing.assert_allclose(feel(*state, PATCHES, x=x)[0], plain, rtol=1e-12, atol=scale)

    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, st.sampled_from([(0.65, 0.7), (1.4, 1.5)]))
    def test_inside_a_patch_the_sand_is_its_own(self, foot, height, pitch, rate, vx, vz, inside):
        x, factor = inside
        state = foot.plates(40, directed=True), pose_of(height, pitch, rate), vx, vz
        plain = feel(*state, zeta=factor)[0]
        scale = 1e-12 * np.abs(plain).max()
        np.testing.assert_allclose(feel(*state, PATCHES, x=x)[0], plain, rtol=1e-12, atol=scale)

    def test_strength_changes_smoothly_at_the_sides_and_keeps_between(self):
        x = np.linspace(0.0, 1.8, 3601)
        strength, _, slide = effects.load(laws([PATCHES]).loads, (1.0, 1.0, 0.0), 0.03, x)
        for begin, end, factor in zip(PATCHES.begins, PATCHES.ends, PATCHES.factors, strict=True):
            for side, sign in ((begin, 1), (end, -1)):
                near = np.abs(x - side) <= 0.5 * PATCHES.blur
                assert (sign * (factor - 1.0) * np.diff(strength[near]) > -1e-12).all()
                assert np.interp(side, x, strength) == pytest.approx(0.5 * (1.0 + factor), rel=1e-6)
        assert strength.min() == pytest.approx(min(PATCHES.factors))
        assert strength.max() == pytest.approx(max(PATCHES.factors))
        np.testing.assert_allclose(np.gradient(strength, x), slide, rtol=0, atol=0.02 * np.abs(slide).max())

    def test_are_estimated_by_the_largest_change_on_the_way(self):
        scale = Scale(stress=1e6, pull=0.0, depth=0.04, speed=0.5, distance=1.0)
        assert PATCHES.estimate(scale) == pytest.approx(0.3)
        assert PATCHES.estimate(scale._replace(distance=2.0)) == pytest.approx(0.5)


@pytest.mark.slow
class TestPatchesOnTheWay:
    def test_a_walk_inside_one_patch_is_a_walk_on_its_sand(self, regular, ramp_foot):
        wide = Patches((-10.0, 30.0), (20.0, 40.0), (0.6, 1.5))
        inside = fo.simulate(ramp_foot, replace(regular, effects=(wide,)))
        there = fo.simulate(ramp_foot, replace(regular, sand=fo.Sand(0.6)))
        assert inside.start[1] == pytest.approx(there.start[1], abs=1e-12)
        np.testing.assert_allclose(inside.com, there.com, rtol=0, atol=1e-8)

    def test_a_walk_before_the_patch_is_the_plain_one(self, regular, ramp_foot):
        ahead = Patches((1.0, 30.0), (20.0, 40.0), (0.6, 1.5))
        walk, plain = (fo.simulate(ramp_foot, replace(regular, effects=on)) for on in ((ahead,), ()))
        reached = max(
            walk.plates(np.arange(len(walk.t))).position[..., 0].max(axis=(1, 2)).searchsorted(0.97), 1
        )
        assert reached > 50
        np.testing.assert_allclose(walk.com[:reached], plain.com[:reached], rtol=0, atol=1e-9)
        assert walk.objectives["distance"] < plain.objectives["distance"]
