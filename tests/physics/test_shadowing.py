"""Shadowing: what lies in a groove counts with a part, and a convex sole shadows nothing."""

import numpy as np
import pytest
from feet_in_sand import HEIGHT, PITCH, RATE, SOLES, SPEED, feel, force, pose_of
from hypothesis import assume, given
from hypothesis import strategies as st

import footopt as fo
from footopt.effects.shadowing import filled
from footopt.errors import SettingError
from footopt.foot import Plates, as_plates, lower_hull
from footopt.studies.validation.rig import blades
from footopt.walk.prepare import NEWTON
from footopt.walk.reference import contact_forces

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

    @pytest.mark.parametrize("name", ["rectangle", "circle", "ellipse"])
    def test_a_convex_sole_stays_as_it_is_to_the_last_bit(self, name):
        points = fo.Foot.shape(name).points(300)[None]
        assert np.array_equal(filled(points, 0.0), points)

    @given(st.lists(SOLES, min_size=2, max_size=5))
    def test_a_sole_does_not_depend_on_its_batch(self, feet):
        batch = np.stack([foot.points(80) for foot in feet])
        for points, found in zip(batch, filled(batch, 0.3), strict=True):
            assert np.array_equal(filled(points[None], 0.3)[0], found)

    @pytest.mark.parametrize("turn", [1, -1])
    def test_blades_are_shortened_whichever_way_they_are_drawn(self, turn):
        comb = blades(0.1, 4, 0.012, 0.003)[::turn]
        found = filled(comb[None], 1.0 / 3.0)[0]
        assert found[:, 1].min() == -0.012
        assert np.ptp(found[:, 1]) == pytest.approx(0.004)


MOTION = fo.Shadowing(hull="motion")


class TestTheDirectionOfMotion:
    """`hull="motion"`: what the sole itself hides from the sand, in the direction in which it moves."""

    @pytest.mark.parametrize("name", ["ellipse", "rectangle", "circle", "reversed_l", "reversed_triangle"])
    def test_a_convex_sole_hides_nothing(self, name):
        horizon = fo.Foot.shape(name).plates(60, directed=True, fill=MOTION).horizon[0]
        assert (horizon[[0, 2]] == 1.0).all()
        assert (horizon[[1, 3]] == 0.0).all()

    @pytest.mark.parametrize("way", [1.0, -1.0])
    def test_a_comb_that_is_dragged_along_is_a_block(self, way):
        """Deep in the sand, where a blade's height makes no difference, but a shadow's edge has a width."""
        comb, depth = blades(0.1, 5, 0.012, 0.003), 20.0
        block = np.array([[-0.05, 0.0], [-0.05, -0.012], [0.05, -0.012], [0.05, 0.0]])
        found, filled_up, open_ = (
            force(fo.Foot(c).plates(800, "chord", True, fill), pose_of(-depth, 0.0, 0.0), way, 0.0, *on)
            for c, fill, on in ((comb, MOTION, (MOTION,)), (block, None, ()), (comb, None, ()))
        )
        np.testing.assert_allclose(found, filled_up, rtol=5e-2)
        assert abs(open_[0]) > 1.5 * abs(found[0])

    @given(SOLES, HEIGHT)
    def test_a_sole_that_goes_straight_down_hides_nothing(self, foot, height):
        slopes = np.diff(foot.points(200), axis=0)
        assume(np.abs(slopes[:, 1] / slopes[:, 0]).max() < 2.0)  # a shadow's edge is not sharp
        pose = pose_of(height - 0.05, 0.0, 0.0)
        plates = foot.plates(80, directed=True, fill=MOTION)
        np.testing.assert_allclose(
            force(plates, pose, 0.0, -1.0, MOTION), force(plates, pose, 0.0, -1.0), rtol=1e-9, atol=1e-9
        )

    @given(SOLES, PITCH, RATE, SPEED, SPEED)
    def test_a_foot_and_its_mirror_image_are_hidden_alike(self, foot, pitch, rate, vx, vz):
        found = []
        for way, points in ((1.0, foot.points(60)), (-1.0, foot.points(60)[::-1] * [-1.0, 1.0])):
            plates = Plates.from_points(
                points[None], np.zeros((1, 2)), np.ones(1), "chord", True, fill=MOTION
            )
            there = pose_of(-0.05, way * pitch, way * rate)
            found.append(force(plates, there, way * vx, vz, MOTION) * [way, 1.0])
        np.testing.assert_allclose(*found, rtol=0, atol=1e-9 * np.abs(found).max())

    @given(SOLES, HEIGHT, PITCH, SPEED, SPEED)
    def test_the_sand_takes_work_from_a_foot_that_does_not_turn(self, foot, height, pitch, vx, vz):
        plates = foot.plates(60, directed=True, fill=MOTION)
        creep = 1e-9  # up to which the force does not oppose the motion yet
        found = force(plates, pose_of(height, pitch, 0.0), vx, vz, MOTION, creep=creep)
        assert found @ [vx, vz] <= creep * np.abs(found).sum()

    @pytest.mark.parametrize(
        "on",
        [
            (fo.Shadowing(0.2, "motion"),),
            pytest.param((MOTION, fo.LeadingEdge(), fo.Inertia()), marks=pytest.mark.slow),
        ],
    )
    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED)
    def test_has_an_exact_jacobian(self, on, foot, height, pitch, rate, vx, vz):
        plates, pose, stage, d = (
            foot.plates(40, directed=True, fill=on[0]),
            pose_of(height, pitch, rate),
            1e-2,
            1e-6,
        )

        def moved(dx, dz):
            return force(
                plates, pose, vx + dx, vz + dz, *on, creep=0.1, stage=stage, x=stage * dx, z=stage * dz
            )

        slopes = [(moved(d, 0) - moved(-d, 0)) / (2 * d), (moved(0, d) - moved(0, -d)) / (2 * d)]
        jacobian = feel(plates, pose, vx, vz, *on, creep=0.1, stage=stage)[0][3:].reshape(2, 2)
        tolerance = 1e-4 * np.abs(jacobian).max() + 1e-3
        np.testing.assert_allclose(jacobian, np.stack(slopes, axis=1), rtol=0, atol=tolerance)

    @given(SOLES, RATE, SPEED, SPEED)
    def test_readable_and_compiled_form_are_one_law(self, foot, rate, vx, vz):
        compiled, readable, size = contact_forces(
            foot, fo.Scene(effects=(fo.Shadowing(0.2, "motion"),)), 64, (vx, vz, rate), 1e-3, False
        )
        np.testing.assert_allclose(compiled, readable, rtol=0, atol=1e-9 * size)


K = [5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4]


class TestTheWalk:
    def test_a_hollow_foot_walks_as_one_whose_hollow_was_filled(self):
        foot = fo.Foot.from_waypoints(K)
        body = fo.Foot(filled(foot.contour[None], 0.4)[0], foot.width)
        shaded = fo.simulate(foot, fo.Scene(effects=(fo.Shadowing(0.4),))).objectives
        for name, value in fo.simulate(body).objectives.items():
            assert shaded[name] == pytest.approx(value, rel=5e-3)

    @pytest.mark.parametrize("hull", ["sole", "motion"])
    def test_many_feet_walk_as_one_does_and_plates_add_up_to_the_force(self, hull):
        """The latter to the last step of Newton's method."""
        scene = fo.Scene(effects=(fo.Shadowing(hull=hull),))
        one, many = fo.simulate(fo.Foot.from_waypoints(K), scene), fo.evaluate([K, K[::-1]], scene)
        assert many.values[0].tolist() == [one.objectives[name] for name in many.names]
        found = one.plates(np.arange(len(one.t))).total
        error = np.abs(found - one.force).max(axis=(1, 2)) / np.abs(found).max()
        assert np.median(error) < 1e-5
        assert np.quantile(error, 0.9) < NEWTON

    def test_all_of_the_depth_is_the_plain_law(self):
        assert fo.Scene(effects=(fo.Shadowing(1.0),)).effects == ()

    def test_plates_that_are_cut_already_are_refused(self):
        plates = as_plates([K], 32, "arc", None)
        with pytest.raises(SettingError, match="shadowing"):
            fo.evaluate(plates, fo.Scene(effects=(fo.Shadowing(),)))

    @pytest.mark.parametrize("part", [-0.1, 1.1, float("nan")])
    def test_a_part_is_from_0_to_1(self, part):
        with pytest.raises(SettingError, match=r"effects\.shadowing\.effective"):
            fo.Shadowing(part)
        with pytest.raises(SettingError, match=r"effects\.shadowing\.hull.*motion"):
            fo.Shadowing(hull="foot")

    def test_is_estimated_by_what_a_groove_loses(self):
        scale = fo.Scene().scale
        assert fo.Shadowing(0.5).estimate(scale) == pytest.approx(0.005 / scale.depth)
