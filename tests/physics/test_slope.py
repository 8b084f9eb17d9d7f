"""An inclined plane: gravity tilts."""

import math
from dataclasses import replace

import numpy as np
import pytest
from feet_in_sand import momentum_gap

import footopt as fo
from footopt.effects import Slope
from footopt.walk.checks import energy_gap


class TestSlope:
    @pytest.mark.parametrize("angle", [-8.0, 8.0])
    def test_momentum_and_energy_close_in_tilted_gravity(self, angle, regular, ramp_foot):
        walk = fo.simulate(ramp_foot, replace(regular, effects=(Slope(angle),)))
        np.testing.assert_allclose(momentum_gap(walk), 0.0, rtol=0, atol=1e-9)
        assert energy_gap(walk) < 1e-3

    def test_uphill_shortens_downhill_lengthens_alike_to_first_order(self, regular, ramp_foot):
        """What differs is of second order: its share doubles with the angle."""

        def distance(angle):
            scene = replace(regular, effects=(Slope(angle),))
            accuracy = fo.Accuracy(dt=2e-3, plates=200, creep=2e-5, control=1e-4)
            return fo.simulate(ramp_foot, scene, accuracy).objectives["distance"]

        level, shares = distance(0.0), []
        for angle in (1.0, 2.0):
            up, down = distance(angle), distance(-angle)
            assert up < level < down
            shares.append((up + down - 2.0 * level) / (down - up))
        assert abs(shares[0]) < 0.05
        assert shares[1] == pytest.approx(2.0 * shares[0], rel=0.2)

    def test_who_stands_on_10_deg_only_creeps(self, ramp_foot):
        """The sand carries the tilted weight; what motion is left is the smoothing's, and goes with it."""
        gait, slope = fo.Gait.human(start=math.inf), Slope(10.0)
        scene = fo.Scene(gait=gait, t_f=4.0, effects=(slope,))
        weight = scene.walker.weight * np.array([math.sin(math.radians(10)), math.cos(math.radians(10))])
        speeds = []
        for creep in (1e-4, 2e-4):
            walk = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=5e-3, creep=creep, control=1e-3))
            assert walk.feasible
            np.testing.assert_allclose(walk.force[-1].sum(axis=0), weight, rtol=0, atol=0.05)
            speeds.append(np.hypot(*walk.velocity[-1]))
            assert speeds[-1] < 1.5 * creep
        assert speeds[1] == pytest.approx(2.0 * speeds[0], rel=0.1)
