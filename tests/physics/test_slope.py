"""An inclined plane: gravity tilts."""

import math
from dataclasses import replace

import numpy as np
import pytest

import footopt as fo
from footopt.effects import Slope
from footopt.walk.balances import energy_gap, momentum_gap


class TestSlope:
    @pytest.mark.slow
    def test_uphill_shortens_downhill_lengthens_alike_to_first_order(self, regular, ramp_foot):
        """What differs is of second order: its share doubles with the angle."""

        def distance(angle):
            scene = replace(regular, effects=(Slope(angle),))
            return fo.simulate(ramp_foot, scene, "fine").objectives["distance"]

        level, shares = distance(0.0), []
        for angle in (1.0, 2.0):
            up, down = distance(angle), distance(-angle)
            assert up < level < down
            shares.append((up + down - 2.0 * level) / (down - up))
        assert abs(shares[0]) < 0.05
        assert shares[1] == pytest.approx(2.0 * shares[0], rel=0.2)

    @pytest.mark.slow
    @pytest.mark.parametrize("angle", [-5.0, 15.0])
    def test_momentum_and_energy_close(self, angle, scene, ramp_foot):
        accuracy = fo.Accuracy(dt=1e-3, control=1.0)
        walk = fo.simulate(ramp_foot, replace(scene, effects=(Slope(angle),)), accuracy)
        np.testing.assert_allclose(momentum_gap(walk), 0.0, rtol=0, atol=1e-9)
        assert energy_gap(walk) < 5e-4

    @pytest.mark.slow
    @pytest.mark.parametrize("sand", ["soft", "regular", "hard"])
    def test_who_stands_on_10_deg_only_creeps(self, sand, ramp_foot):
        """The sand carries the tilted weight; what motion is left is the smoothing's, and goes with it."""
        gait, slope = fo.Gait.human(start=math.inf), Slope(10.0)
        scene = fo.Scene(sand=fo.Sand.named(sand), gait=gait, t_f=4.0, effects=(slope,))
        weight = scene.walker.weight * np.array([math.sin(math.radians(10)), math.cos(math.radians(10))])
        speeds = []
        for creep in (1e-4, 2e-4):
            walk = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=5e-3, creep=creep, control=1e-3))
            assert walk.feasible
            np.testing.assert_allclose(walk.force[-1].sum(axis=0), weight, rtol=0, atol=0.05)
            speeds.append(np.hypot(*walk.velocity[-1]))
            assert speeds[-1] < 1.5 * creep
        assert speeds[1] == pytest.approx(2.0 * speeds[0], rel=0.1)

    def test_is_estimated_by_the_share_of_the_weight_along_the_plane(self):
        assert Slope(-10.0).estimate(fo.Scene().scale) == pytest.approx(math.sin(math.radians(10.0)))
