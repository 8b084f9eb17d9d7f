"""Shadowing: what lies in a groove counts with a part, and a convex sole shadows nothing."""

import numpy as np
import pytest
from feet_in_sand import SOLES
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.effects.shadowing import filled
from footopt.errors import SettingError
from footopt.foot import lower_hull

PART = st.floats(0.0, 1.0)


def floor(contour, x):
    """Height of a contour's lower hull, by the code that reports how hollow a sole is."""
    corners = lower_hull(contour)[0]
    return np.interp(x, *corners.T)


class TestTheSole:
    @given(SOLES, PART)
    def test_every_gap_to_the_hull_is_the_given_part_of_what_it_was(self, foot, part):
        points = foot.points(200)
        below = floor(points, points[:, 0])
        found = filled(points[None], part)[0]
        assert np.array_equal(found[:, 0], points[:, 0])
        np.testing.assert_allclose(found[:, 1] - below, part * (points[:, 1] - below), atol=1e-11)

    @pytest.mark.parametrize("name", ["rectangle", "circle", "ellipse", "reversed_l", "reversed_triangle"])
    def test_a_convex_sole_stays_as_it_is_to_the_last_bit(self, name):
        points = fo.Foot.shape(name).points(300)[None]
        assert np.array_equal(filled(points, 0.0), points)

    @pytest.mark.parametrize("turn", [1, -1])
    def test_blades_are_shortened_whichever_way_they_are_drawn(self, turn):
        x = np.repeat(np.linspace(-0.05, 0.05, 8), 2)  # four blades
        comb = np.stack([x, np.tile([0.0, -0.012, -0.012, 0.0], 4)], axis=-1)[::turn]
        found = filled(comb[None], 1.0 / 3.0)[0]
        assert np.array_equal(found[[0, -1]], comb[[0, -1]])  # before the first and behind the last is sand
        assert found[:, 1].min() == -0.012
        assert np.ptp(found[1:-1, 1]) == pytest.approx(0.004)


K = [5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4]


class TestTheWalk:
    def test_a_hollow_foot_walks_as_one_whose_hollow_was_filled(self):
        foot = fo.Foot.from_waypoints(K)
        body = fo.Foot(filled(foot.contour[None], 0.4)[0], foot.width)
        accuracy = fo.Accuracy(plates=100, control=1e-3)
        shaded = fo.simulate(foot, fo.Scene(effects=(fo.Shadowing(0.4),)), accuracy).objectives
        for name, value in fo.simulate(body, accuracy=accuracy).objectives.items():
            assert shaded[name] == pytest.approx(value, rel=5e-3)

    def test_many_feet_walk_as_one_does(self):
        scene = fo.Scene(effects=(fo.Shadowing(),))
        one, many = fo.simulate(fo.Foot.from_waypoints(K), scene), fo.evaluate([K, K[::-1]], scene)
        assert many.values[0].tolist() == [one.objectives[name] for name in many.names]

    @pytest.mark.parametrize("part", [-0.1, 1.1, float("nan")])
    def test_a_part_is_from_0_to_1(self, part):
        with pytest.raises(SettingError, match=r"effects\.shadowing\.effective"):
            fo.Shadowing(part)
