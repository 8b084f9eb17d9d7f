"""The force of a foot: the compiled contact against the published law, its symmetries and derivatives."""

import math
from dataclasses import replace

import numpy as np
import pytest
from feet_in_sand import PITCH, RATE, SOLES, SPEED, feel, pose_of
from hypothesis import given, settings
from hypothesis import strategies as st

import footopt as fo
from footopt.gait import LEFT, RIGHT

DEEP = st.floats(-0.5, -0.25)  # heights of the ankle at which every plate is in the sand
ANY_HEIGHT = st.floats(-0.2, 0.2)
F, P, J = slice(0, 2), 2, slice(3, 7)  # force, power, and derivatives of a `Force`


def contact(*arguments, **options):
    return feel(*arguments, **options)[0]


def contact_by_angles(foot, plates, pose, vx, vz, zeta=1.0):
    """The same force from the map as published, one plate at a time, without smoothing; and its scale."""
    _, z, ankle_vx, ankle_vz, cos, sin, rate = pose
    points = foot.points(plates) - np.array(foot.ankle)
    turned = points @ np.array([[cos, sin], [-sin, cos]])
    middle, chord = (turned[1:] + turned[:-1]) / 2, np.diff(turned, axis=0)
    velocity = np.array([vx + ankle_vx, vz + ankle_vz]) + rate * middle[:, ::-1] * [-1, 1]
    beta = np.arctan2(chord[:, 1], chord[:, 0])
    gamma = np.arctan2(-velocity[:, 1], velocity[:, 0])
    ax, az = fo.stress.alpha(beta, gamma)
    pull = zeta * np.maximum(-(z + middle[:, 1]), 0.0) * foot.width * np.hypot(*chord.T)
    force = np.stack([-ax * pull, az * pull], axis=1)
    return force.sum(axis=0), np.sum(force * velocity), 1e6 * pull.sum(), np.hypot(*velocity.T)


class TestForceOfAFoot:
    @given(SOLES, ANY_HEIGHT, PITCH, RATE, SPEED, SPEED, st.sampled_from([0.2, 1.0, 5.0]))
    def test_is_the_sum_of_the_published_stresses(self, foot, height, pitch, rate, vx, vz, zeta):
        """Smoothing by the creep speed changes a force by creep^2 / 2 v^2, rounding by 1e-12."""
        creep = 1e-6
        pose = pose_of(height, pitch, rate)
        force, power, scale, speed = contact_by_angles(foot, 50, pose, vx, vz, zeta)
        found = contact(foot.plates(50, "chord"), pose, vx, vz, zeta=zeta, creep=creep)
        if speed.min() > 1e-2:
            tolerance = (1e-11 + creep**2 / speed.min() ** 2) * scale + 1e-12
            np.testing.assert_allclose(found[F], force, rtol=0, atol=tolerance)
            assert found[P] == pytest.approx(power, abs=tolerance * max(speed.max(), 1.0))

    @given(SOLES, DEEP, PITCH, RATE, SPEED, SPEED, st.sampled_from([1e-3, 1e-2]))
    def test_has_an_exact_jacobian(self, foot, height, pitch, rate, vx, vz, stage):
        """In an implicit stage the height follows the velocity: d/dV of F(z0 + c V_z, V)."""
        plates, pose, creep, d = foot.plates(40), pose_of(height, pitch, rate), 1e-1, 1e-4

        def force(dx, dz):
            return contact(plates, pose, vx + dx, vz + dz, creep=creep, z=stage * dz)[F]

        found = contact(plates, pose, vx, vz, creep=creep, stage=stage)[J].reshape(2, 2)
        difference = np.stack(
            [(force(d, 0) - force(-d, 0)) / (2 * d), (force(0, d) - force(0, -d)) / (2 * d)], axis=1
        )
        np.testing.assert_allclose(found, difference, rtol=0, atol=3e-6 * np.abs(found).max() + 1e-4)

    @given(SOLES, ANY_HEIGHT, PITCH, RATE, SPEED, SPEED)
    def test_mirrored_foot_and_motion_mirror_the_force(self, foot, height, pitch, rate, vx, vz):
        mirrored = replace(foot, contour=foot.contour[::-1] * [-1, 1], k=None, space=None)
        foot = replace(foot, k=None, space=None)
        here = contact(foot.plates(48), pose_of(height, pitch, rate), vx, vz)
        there = contact(mirrored.plates(48), pose_of(height, -pitch, -rate), -vx, vz)
        scale = 1e-9 * (np.abs(here).max() + 1.0)
        np.testing.assert_allclose(there[: P + 1], here[: P + 1] * [-1, 1, 1], rtol=0, atol=scale)

    @given(SOLES, st.floats(0.0, 0.5), PITCH, RATE, SPEED, SPEED)
    def test_is_zero_above_the_sand(self, foot, clearance, pitch, rate, vx, vz):
        plates = foot.plates(40)
        lowest = (math.sin(pitch) * plates.x + math.cos(pitch) * plates.z).min()
        pose = pose_of(clearance + 1e-9 - lowest, pitch, rate)
        assert (contact(plates, pose, vx, vz, stage=1e-3) == 0.0).all()

    @given(SOLES, ANY_HEIGHT, PITCH, RATE, SPEED, SPEED)
    def test_is_proportional_to_zeta(self, foot, height, pitch, rate, vx, vz):
        state = foot.plates(40), pose_of(height, pitch, rate), vx, vz
        one, four = contact(*state, zeta=1.0, stage=1e-3), contact(*state, zeta=4.0, stage=1e-3)
        np.testing.assert_allclose(four, 4.0 * one, rtol=1e-13)

    @given(SOLES, DEEP, PITCH)
    def test_at_rest_is_the_bias_only(self, foot, height, pitch):
        """h = 0: a level plate is pushed up by 3/8 of what resists its downward motion."""
        plates, pose = foot.plates(40), pose_of(height, pitch, 0.0)
        depth = -(height + math.sin(pitch) * plates.x + math.cos(pitch) * plates.z)
        level = np.cos(2 * pitch) * plates.c2 - np.sin(2 * pitch) * plates.s2
        lift = np.sum(1e6 * (0.206 + 0.169 * level) * depth * plates.area)
        assert contact(plates, pose, 0.0, 0.0)[1] == pytest.approx(lift, rel=1e-10)

    def test_of_a_level_foot_pressed_down_is_alpha_times_depth_times_area(self, flat_foot):
        """alpha_z(0, 90 deg) = 1 N/cm^3: 2 cm below the sand, .026 m^2 carry 520 N."""
        pose = pose_of(0.03 - 0.02, 0.0, 0.0)
        force = contact(flat_foot.plates(40), pose, 0.0, -1.0, creep=1e-6)
        np.testing.assert_allclose(force[: P + 1], [0.0, 520.0, -520.0], atol=1e-6)

    @pytest.mark.parametrize("plates", [2, 7, 8, 9, 63, 64, 65])
    def test_padding_to_whole_blocks_carries_no_force(self, plates, ramp_foot):
        pose = pose_of(-0.01, 0.2, 1.0)
        force, *_ = contact_by_angles(ramp_foot, plates, pose, 0.3, -0.4)
        found = contact(ramp_foot.plates(plates, "chord"), pose, 0.3, -0.4, creep=1e-8)
        np.testing.assert_allclose(found[F], force, rtol=1e-11)


class TestStaticHeight:
    @settings(max_examples=15)
    @given(SOLES, st.floats(0.1, 20.0))
    def test_the_limit_force_of_downward_motion_carries_the_weight(self, foot, zeta):
        accuracy = fo.Accuracy(plates=50, rule="chord", dt=1e-2)
        scene = fo.Scene(sand=fo.Sand(zeta), t_f=0.01)
        start = fo.simulate(foot, scene, accuracy).start
        pose = scene.gait.pose([0.0], scene.walker.l1, scene.walker.l2)
        lift = 0.0
        for side in (LEFT, RIGHT):
            still = pose_of(start[1] + pose.z[0, side], pose.pitch[0, side], 0.0)
            lift += contact_by_angles(foot, 50, still, 0.0, -1.0, zeta)[0][1]
        assert lift == pytest.approx(scene.walker.weight, rel=1e-9)

    def test_a_flat_foot_on_hard_sand_stands_on_its_left_leg(self, flat_foot):
        """Depth = M g / (zeta alpha_z(0, 90 deg) area): the right foot, 2.8 cm higher, is in the air."""
        walk = fo.simulate(flat_foot, fo.Scene(sand=fo.Sand.named("hard")))
        depth = 60 * 9.81 / (5 * 1e6 * 1.0 * 0.1 * 0.26)
        assert walk.start[1] == pytest.approx(0.92 + 0.03 - depth, abs=1e-9)
