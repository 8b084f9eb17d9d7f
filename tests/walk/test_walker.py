"""The walk: forces of the compiled loop, balances, orders, an independent program, and failures."""

import math
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import footopt as fo
from footopt.errors import SettingError
from footopt.foot import Plates
from footopt.gait import LEFT, RIGHT
from footopt.walk import PRESETS, STEPPERS
from footopt.walk import contact as kernels
from footopt.walk.contact import CONTACT, FX, FZ, JXX, JZZ, POWER
from footopt.walk.independent import LIMITS, RAMP, REFERENCE, SAME_PLATES
from footopt.walk.prepare import (
    HALVINGS,
    NEWTON,
    long_pose_tables,
    pose_rows,
    pose_tables,
    poses,
    sole,
    time_grid,
    world,
)
from footopt.walk.validity import diagnose

#: Order of every stepper where forces are smooth.
ORDERS = {
    "explicit_euler": 1,
    "semi_implicit_euler": 1,
    "heun": 2,
    "rk4": 4,
    "implicit_euler": 1,
    "sdirk2": 2,
}
ALL = sorted(ORDERS)

SKY = (0.0, 10.0, 0.0, 0.0, 1.0, 0.0, 0.0)  # pose of a foot far above the sand


def test_every_stepper_has_an_order_here():
    assert set(STEPPERS) == set(ORDERS)


def balance(walk):
    """Change of kinetic and potential energy, J."""
    walker, v = walk.scene.walker, walk.velocity[-1]
    return 0.5 * walker.mass * v @ v + walker.weight * (walk.com[-1, 1] - walk.start[1])


# --- the force of one foot ----------------------------------------------------------------------


def contact(plates, pose, vx, vz, zeta=1.0, creep=1e-2, stage=None, z=0.0):
    """Force, power and Jacobian of one foot from the compiled kernel; the other foot is in the sky."""
    constants = world(fo.Scene(sand=fo.Sand(zeta)), fo.Accuracy(creep=creep))
    out, tally = np.full((2, CONTACT), np.nan), np.zeros(kernels.TALLY, np.int64)
    kernels.contact(out, tally, sole(plates), constants, np.array([pose, SKY]), 0.0, z, vx, vz, creep, stage)
    assert (out[1] == 0.0).all()
    return out[0]


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


def pose_of(height, pitch, rate):
    """Pose of a foot whose ankle is at a height (m) above the sand when the hip is at 0."""
    return (0.0, height, 0.0, 0.0, math.cos(pitch), math.sin(pitch), rate)


PITCH, RATE, SPEED = st.floats(-1.2, 1.2), st.floats(-6.0, 6.0), st.floats(-1.5, 1.5)
DEEP = st.floats(-0.5, -0.25)  # heights of the ankle at which every plate is in the sand
ANY_HEIGHT = st.floats(-0.2, 0.2)
SOLES = st.lists(st.integers(1, 10), min_size=11, max_size=11).map(fo.Foot.from_waypoints)


class TestForceOfAFoot:
    @given(SOLES, ANY_HEIGHT, PITCH, RATE, SPEED, SPEED, st.sampled_from([0.2, 1.0, 5.0]))
    def test_is_the_sum_of_the_published_stresses(self, foot, height, pitch, rate, vx, vz, zeta):
        """Smoothing by the creep speed changes a force by creep^2 / 2 v^2, rounding by 1e-12."""
        creep = 1e-6
        pose = pose_of(height, pitch, rate)
        force, power, scale, speed = contact_by_angles(foot, 50, pose, vx, vz, zeta)
        found = contact(foot.plates(50, "chord"), pose, vx, vz, zeta, creep)
        if speed.min() > 1e-2:
            tolerance = (1e-11 + creep**2 / speed.min() ** 2) * scale + 1e-12
            np.testing.assert_allclose(found[[FX, FZ]], force, rtol=0, atol=tolerance)
            assert found[POWER] == pytest.approx(power, abs=tolerance * max(speed.max(), 1.0))

    @given(SOLES, DEEP, PITCH, RATE, SPEED, SPEED, st.sampled_from([1e-3, 1e-2]))
    def test_has_an_exact_jacobian(self, foot, height, pitch, rate, vx, vz, stage):
        """In an implicit stage the height follows the velocity: d/dV of F(z0 + c V_z, V)."""
        plates, pose, creep, d = foot.plates(40), pose_of(height, pitch, rate), 1e-1, 1e-4

        def force(dx, dz):
            return contact(plates, pose, vx + dx, vz + dz, creep=creep, z=stage * dz)[[FX, FZ]]

        found = contact(plates, pose, vx, vz, creep=creep, stage=stage)[JXX : JZZ + 1].reshape(2, 2)
        difference = np.stack(
            [(force(d, 0) - force(-d, 0)) / (2 * d), (force(0, d) - force(0, -d)) / (2 * d)], axis=1
        )
        np.testing.assert_allclose(found, difference, rtol=0, atol=3e-6 * np.abs(found).max() + 1e-4)

    @given(SOLES, ANY_HEIGHT, PITCH, RATE, SPEED, SPEED)
    def test_jacobian_or_not_the_force_is_the_same(self, foot, height, pitch, rate, vx, vz):
        state = foot.plates(40), pose_of(height, pitch, rate), vx, vz
        with_, without = contact(*state, stage=1e-3), contact(*state)
        np.testing.assert_allclose(with_[[FX, FZ, POWER]], without[[FX, FZ, POWER]], rtol=1e-10, atol=1e-8)

    @given(SOLES, ANY_HEIGHT, PITCH, RATE, SPEED, SPEED)
    def test_mirrored_foot_and_motion_mirror_the_force(self, foot, height, pitch, rate, vx, vz):
        mirrored = replace(foot, contour=foot.contour[::-1] * [-1, 1], k=None, space=None)
        foot = replace(foot, k=None, space=None)
        here = contact(foot.plates(48), pose_of(height, pitch, rate), vx, vz)
        there = contact(mirrored.plates(48), pose_of(height, -pitch, -rate), -vx, vz)
        scale = 1e-9 * (np.abs(here).max() + 1.0)
        np.testing.assert_allclose(
            there[[FX, FZ, POWER]], here[[FX, FZ, POWER]] * [-1, 1, 1], rtol=0, atol=scale
        )

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
        assert contact(plates, pose, 0.0, 0.0)[FZ] == pytest.approx(lift, rel=1e-10)

    def test_of_a_level_foot_pressed_down_is_alpha_times_depth_times_area(self, flat_foot):
        """alpha_z(0, 90 deg) = 1 N/cm^3: 2 cm below the sand, .026 m^2 carry 520 N."""
        pose = pose_of(0.03 - 0.02, 0.0, 0.0)
        force = contact(flat_foot.plates(40), pose, 0.0, -1.0, creep=1e-6)
        np.testing.assert_allclose(force[[FX, FZ, POWER]], [0.0, 520.0, -520.0], atol=1e-6)

    @given(SOLES, ANY_HEIGHT, PITCH, RATE, SPEED, SPEED)
    def test_with_averaged_plates_converges_faster_than_with_chords(self, foot, height, pitch, rate, vx, vz):
        """In the mean over the sole; where the surface cuts a plate both are of second order."""
        pose, creep = pose_of(height, pitch, rate), 1e-1
        fine = contact(foot.plates(1600, "chord"), pose, vx, vz, creep=creep)[[FX, FZ]]
        scale = np.abs(fine).max() + 1.0
        arc = contact(foot.plates(100, "arc"), pose, vx, vz, creep=creep)[[FX, FZ]]
        np.testing.assert_allclose(arc, fine, rtol=0, atol=2e-2 * scale)

    @pytest.mark.parametrize("plates", [2, 7, 8, 9, 63, 64, 65])
    def test_padding_to_whole_blocks_carries_no_force(self, plates, ramp_foot):
        pose = pose_of(-0.01, 0.2, 1.0)
        force, *_ = contact_by_angles(ramp_foot, plates, pose, 0.3, -0.4)
        found = contact(ramp_foot.plates(plates, "chord"), pose, 0.3, -0.4, creep=1e-8)
        np.testing.assert_allclose(found[[FX, FZ]], force, rtol=1e-11)


# --- the start ----------------------------------------------------------------------------------


class TestStaticHeight:
    @pytest.mark.parametrize("published", REFERENCE)
    def test_of_the_independent_program(self, published, ramp_foot):
        accuracy = fo.Accuracy(plates=100, rule="chord")
        walk = fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand(published.zeta)), accuracy)
        assert walk.start[1] == pytest.approx(published.start, abs=5.1e-6)
        assert walk.start[0] == 0.0

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

    def test_sinks_with_the_weight_and_rises_with_the_sand(self, ramp_foot):
        def height(mass, zeta):
            scene = fo.Scene(sand=fo.Sand(zeta), walker=fo.Walker(mass=mass), t_f=0.01)
            return fo.simulate(ramp_foot, scene).start[1]

        assert height(60, 5) > height(80, 5) > height(80, 2) > height(80, 0.5)
        assert height(60, 1) == pytest.approx(height(120, 2), abs=1e-12)


# --- whole walks --------------------------------------------------------------------------------


class TestIndependentProgram:
    @pytest.mark.parametrize("published", REFERENCE)
    @pytest.mark.parametrize("accuracy", ["standard", "fine", "reference", SAME_PLATES], ids=str)
    def test_walks_agree(self, published, accuracy):
        table = fo.evaluate([RAMP], fo.Scene(sand=fo.Sand(published.zeta)), accuracy)
        limit = LIMITS[accuracy if isinstance(accuracy, str) else accuracy.name]
        np.testing.assert_allclose(table.values[0], published.objectives, rtol=limit)


@pytest.fixture(scope="module")
def sliding(flat_foot):
    """A smooth scene: both feet wholly in soft sand, stepping off at once, a large creep speed."""
    scene = fo.Scene(sand=fo.Sand(0.1), gait=fo.Gait.human(start=0.0), t_f=0.16)

    def run(stepper, steps):
        return fo.simulate(flat_foot, scene, fo.Accuracy(stepper, scene.t_f / steps, 40, creep=0.2))

    return run


def slopes(errors):
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


class TestBalances:
    @pytest.mark.parametrize("stepper", ALL)
    def test_momentum_is_the_impulse_of_sand_and_weight(self, stepper, scene, ramp_foot):
        """M v = integral of force - M g t, to rounding: a step takes from the sand what it gives."""
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(stepper, 1e-3))
        momentum = scene.walker.mass * walk.velocity[-1]
        impulse = [walk.totals["impulse_x"], walk.totals["impulse_z"] - scene.walker.weight * walk.t[-1]]
        np.testing.assert_allclose(momentum, impulse, rtol=0, atol=1e-9)

    @pytest.mark.parametrize("stepper", ALL)
    def test_energy_closes_at_the_steppers_order(self, stepper, sliding):
        """Kinetic + potential energy = work of the sand + work of the joints."""
        errors = []
        for steps in (16, 32, 64):
            walk = sliding(stepper, steps)
            errors.append(abs(balance(walk) - walk.work[-1].sum() - walk.totals["net_joint_work"]))
        assert (slopes(errors) > ORDERS[stepper] - 0.15).all()

    def test_energy_of_a_whole_walk_closes(self, scene, ramp_foot):
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=1e-3))
        joints = walk.totals["net_joint_work"]
        assert balance(walk) == pytest.approx(
            walk.work[-1].sum() + joints, abs=1e-4 * walk.objectives["work"]
        )

    def test_work_is_the_integral_of_power(self, fine_walk):
        for foot in (LEFT, RIGHT):
            integral = np.trapezoid(fine_walk.power[:, foot], fine_walk.t)
            assert fine_walk.work[-1, foot] == pytest.approx(integral, rel=1e-4)


class TestOrders:
    @pytest.mark.parametrize("stepper", ALL)
    def test_error_falls_at_the_steppers_order(self, stepper, sliding):
        def state(walk):
            return np.concatenate([walk.com[-1], walk.velocity[-1]])

        exact = state(sliding("rk4", 1600))
        errors = [np.abs(state(sliding(stepper, n)) - exact).max() for n in (16, 32, 64)]
        np.testing.assert_allclose(slopes(errors), ORDERS[stepper], rtol=0, atol=0.3)

    def test_all_steppers_converge_to_one_walk(self, scene, ramp_foot, fine_walk):
        for stepper in ALL:
            walk = fo.simulate(ramp_foot, scene, fo.Accuracy(stepper, 1e-4, 400, 1e-4))
            np.testing.assert_allclose(walk.com[-1], fine_walk.com[-1], rtol=2e-3)

    @pytest.mark.parametrize(("coarse", "fine"), [("draft", "standard"), ("standard", "fine")])
    def test_each_preset_is_better_than_the_one_before(self, coarse, fine, scene):
        k = fo.Waypoints().random(20, seed=5, inside=True)
        exact = fo.evaluate(k, scene, "reference").values
        error = [
            np.abs(fo.evaluate(k, scene, name).values / exact - 1).max(axis=1) for name in (coarse, fine)
        ]
        assert np.quantile(error[1], 0.95) < 0.7 * np.quantile(error[0], 0.95)
        assert np.quantile(error[1], 0.95) < 0.02


class TestSymmetriesOfTheWalk:
    def test_moving_sole_and_ankle_together_changes_nothing(self, regular, ramp_foot):
        moved = replace(
            ramp_foot,
            contour=ramp_foot.contour + np.array([0.03, -0.01]),
            ankle=(0.03, -0.01),
            k=None,
            space=None,
        )
        still = replace(ramp_foot, k=None, space=None)
        a, b = (fo.simulate(foot, regular) for foot in (still, moved))
        np.testing.assert_allclose(a.com, b.com, rtol=0, atol=1e-9)

    @pytest.mark.parametrize("stepper", ALL)
    def test_similar_walkers_walk_alike(self, stepper, ramp_foot):
        """Lengths x s, times x sqrt(s), masses x s^3 in the same sand and gravity: no other scale.

        With s = 4 all factors are powers of 2, so that not even rounding differs.
        """
        s, accuracy = 4.0, fo.Accuracy(stepper, 2**-9, 50, 1e-4)
        small = fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand(1.0)), accuracy)
        big_scene = fo.Scene(
            sand=fo.Sand(1.0),
            gait=fo.Gait.human(period=1.2 * s**0.5, start=0.5 * s**0.5),
            walker=fo.Walker(mass=60 * s**3, l1=0.47 * s, l2=0.45 * s),
        )
        big_foot = fo.Foot.from_waypoints(RAMP, L=0.13 * s, H=0.03 * s, width=0.1 * s)
        big_accuracy = replace(accuracy, dt=accuracy.dt * s**0.5, creep=accuracy.creep * s**0.5)
        big = fo.simulate(big_foot, big_scene, big_accuracy)
        np.testing.assert_array_equal(big.t, small.t * s**0.5)
        np.testing.assert_allclose(big.com, small.com * s, rtol=1e-10)
        np.testing.assert_allclose(big.force, small.force * s**3, rtol=1e-10)
        assert big.objectives["efficiency"] * s**6 == pytest.approx(small.objectives["efficiency"], rel=1e-10)

    def test_mass_and_stiffness_together_set_only_the_scale_of_forces(self, ramp_foot):
        light = fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand(1.0)))
        heavy = fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand(3.0), walker=fo.Walker(mass=180.0)))
        np.testing.assert_allclose(heavy.com, light.com, rtol=0, atol=1e-9)
        np.testing.assert_allclose(heavy.work, 3.0 * light.work, rtol=1e-6, atol=1e-9)


class TestReproducibility:
    def test_evaluate_and_simulate_are_one_walk(self, scene, ramp_foot, walk):
        table = fo.evaluate([ramp_foot], scene, objectives=tuple(walk.objectives))
        np.testing.assert_allclose(table.values[0], list(walk.objectives.values()), rtol=1e-12)
        assert table.evaluations[0] == walk.evaluations
        np.testing.assert_array_equal(fo.evaluate(ramp_foot, scene).raw, fo.evaluate([ramp_foot], scene).raw)

    @pytest.mark.parametrize("stepper", ["sdirk2", "semi_implicit_euler"])
    def test_a_design_does_not_depend_on_batch_place_or_threads(self, stepper, regular):
        """Bit for bit: stores, engines and resume rest on it."""
        accuracy, k = fo.Accuracy(stepper, 5e-3, 50), fo.Waypoints().random(40, seed=2)
        one = fo.evaluate(k, regular, accuracy, threads=1)
        for threads in (2, 3):
            np.testing.assert_array_equal(fo.evaluate(k, regular, accuracy, threads=threads).raw, one.raw)
        order = np.random.default_rng(0).permutation(len(k))
        np.testing.assert_array_equal(fo.evaluate(k[order], regular, accuracy).raw, one.raw[order])
        for i in (0, 17, 39):
            np.testing.assert_array_equal(fo.evaluate(k[i], regular, accuracy).raw[0], one.raw[i])
        feet = [fo.Foot.from_waypoints(row) for row in k]
        np.testing.assert_array_equal(fo.evaluate(feet, regular, accuracy).raw, one.raw)
        plates = fo.Waypoints().plates(k, 50)
        assert isinstance(plates, Plates)
        np.testing.assert_array_equal(fo.evaluate(plates, regular, accuracy).raw, one.raw)

    def test_repeats_to_the_last_bit(self, regular, ramp_foot):
        a, b = (fo.simulate(ramp_foot, regular) for _ in range(2))
        np.testing.assert_array_equal(a.com, b.com)

    @pytest.mark.slow
    @pytest.mark.parametrize("stepper", ["sdirk2", "semi_implicit_euler"])
    def test_the_process_that_compiles_walks_like_those_that_load_its_code(self, stepper, tmp_path):
        code = (
            "import footopt as fo; f = fo.Foot.from_waypoints([1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8]);"
            f"print(fo.evaluate([f], fo.Scene(), fo.Accuracy({stepper!r}, 1e-3)).raw.tobytes().hex())"
        )
        environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
        compiled, loaded = (
            subprocess.run(
                [sys.executable, "-c", code], env=environment, capture_output=True, check=True
            ).stdout
            for _ in range(2)
        )
        assert compiled == loaded


@pytest.fixture(scope="module")
def vertical(ramp_foot):
    """Vertical force in the second of two seconds of standing on hard sand, over the weight."""
    scene = fo.Scene(sand=fo.Sand.named("hard"), gait=fo.Gait.human(start=math.inf), t_f=2.0)

    def run(stepper, dt, creep):
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(stepper, dt, 100, creep))
        assert walk.feasible
        return walk.force.sum(axis=1)[walk.t > 1.0, 1] / scene.walker.weight

    return run


class TestStandingStill:
    @pytest.mark.parametrize("dt", [1e-2, 2e-3, 5e-4])
    def test_an_implicit_step_comes_to_rest(self, dt, vertical):
        force = vertical("sdirk2", dt, 1e-4)
        assert force.std() < 1e-3
        assert force.mean() == pytest.approx(1.0, abs=1e-3)

    @pytest.mark.parametrize("dt", [1e-3, 1e-4])
    def test_an_explicit_step_chatters_on_the_laws_jump_however_small(self, dt, vertical):
        assert vertical("explicit_euler", dt, 1e-9).std() > 0.1

    def test_an_explicit_step_comes_to_rest_where_smoothing_outlasts_it(self, vertical):
        """dt < 2 eps / g (DESIGN 3)."""
        assert vertical("explicit_euler", 1e-5, 1e-4).std() < 1e-2

    def test_the_walker_stays_where_he_is(self, ramp_foot):
        scene = fo.Scene(sand=fo.Sand.named("hard"), gait=fo.Gait.human(start=math.inf), t_f=2.0)
        walk = fo.simulate(ramp_foot, scene)
        assert walk.feasible
        assert np.abs(walk.com - walk.start).max() < 2e-3
        assert math.isnan(walk.objectives["peak_power"])
        assert math.isnan(walk.objectives["speed_loss"])


class TestFailures:
    def test_sand_that_cannot_carry_the_walker(self, ramp_foot, flat_foot):
        scene = fo.Scene(sand=fo.Sand(1e-3))
        table = fo.evaluate([ramp_foot, flat_foot], scene)
        assert list(table.reasons) == ["sunk", "sunk"]
        assert not table.feasible.any()
        assert np.isnan(table.values).all()
        walk = fo.simulate(ramp_foot, scene)
        assert (walk.reason, walk.feasible, len(walk.t)) == ("sunk", False, 0)
        assert diagnose(walk) == []

    def test_a_walker_who_sinks_on_the_way_leaves_the_trace_so_far(self, ramp_foot):
        walk = fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand(0.02)))
        assert walk.reason == "sunk"
        assert 0 < len(walk.t) < walk.accuracy.steps(2.9)
        assert np.isfinite(walk.force).all()
        assert walk.com[-1, 1] < 0.2
        assert all(math.isnan(value) for value in walk.objectives.values())

    def test_a_gait_run_backwards_in_time_walks_backwards(self, ramp_foot):
        human = fo.Gait.human()
        thigh, knee = (joint._replace(b=tuple(-b for b in joint.b)) for joint in (human.thigh, human.knee))
        scene = fo.Scene(gait=replace(human, thigh=thigh, knee=knee))
        table, walk = fo.evaluate([ramp_foot], scene), fo.simulate(ramp_foot, scene)
        assert table.reasons[0] == walk.reason == "backward"
        assert np.isnan(table.values).all()
        assert np.isnan(table.efficiency).all()
        assert all(math.isnan(value) for value in walk.objectives.values())
        assert walk.com[-1, 0] < 0
        assert walk.t[-1] == 2.9

    LIGHT = fo.Scene(walker=fo.Walker(mass=1e-6))  # thrown into the air by an explicit step
    LONG = fo.Accuracy("explicit_euler", 0.01)

    def test_an_explicit_step_too_long_for_a_light_walker_diverges(self, flat_foot, monkeypatch):
        monkeypatch.setattr(sys.modules["footopt.walk.simulate"], "MAX_REPEATS", 0)
        walk = fo.simulate(flat_foot, self.LIGHT, self.LONG)
        assert walk.reason == "diverged"
        assert all(math.isnan(value) for value in walk.objectives.values())
        table = fo.evaluate([flat_foot], self.LIGHT, self.LONG)
        assert (table.reasons[0], table.feasible[0]) == ("diverged", False)
        assert np.isnan(table.values).all()

    def test_a_walk_that_diverges_is_repeated_with_shorter_steps_and_that_is_counted(self, flat_foot):
        walk = fo.simulate(flat_foot, self.LIGHT, self.LONG)
        table = fo.evaluate([flat_foot], self.LIGHT, self.LONG)
        assert walk.repeats == table.repeats[0] > 0
        assert len(walk.t) == 290 * 4**walk.repeats
        np.testing.assert_allclose(
            table.values[0], [walk.objectives[name] for name in table.names], rtol=1e-12
        )

    def test_an_ordinary_walk_needs_hardly_a_rescue_and_no_repeat(self, walk, ramp_foot):
        assert walk.repeats == 0
        assert walk.rescues <= 0.005 * 2 * len(walk.t)  # of two stages a step
        fine = fo.simulate(ramp_foot, walk.scene, "fine")
        assert fine.repeats == 0
        assert fine.rescues <= 5  # in long steps while he stands, which are shortened

    def test_a_failed_walk_does_not_disturb_its_batch(self, flat_foot, ramp_foot):
        scene = fo.Scene(sand=fo.Sand.named("soft"))
        feet = [flat_foot, replace(flat_foot, width=0.003), ramp_foot, replace(ramp_foot, width=0.01)]
        table = fo.evaluate(feet, scene)
        assert list(table.reasons) == ["", "sunk", "", "sunk"]
        assert list(table.feasible) == [True, False, True, False]
        assert np.isfinite(table.values[[0, 2]]).all()
        assert np.isnan(table.values[[1, 3]]).all()
        np.testing.assert_array_equal(table.values[[0, 2]], fo.evaluate([flat_foot, ramp_foot], scene).values)

    @pytest.mark.parametrize("creep", [1e-6, 1e-9])
    def test_a_nearly_sharp_law_is_still_walked_on(self, creep, scene, ramp_foot, fine_walk):
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=5e-3, creep=creep))
        assert walk.feasible
        assert walk.objectives["distance"] == pytest.approx(fine_walk.objectives["distance"], rel=5e-3)


class TestTraces:
    def test_times_are_equal_steps_that_end_at_t_f_and_long_ones_while_standing(self, ramp_foot):
        walk = fo.simulate(ramp_foot, fo.Scene(), fo.Accuracy(dt=7e-3))
        start, dt = 0.5, walk.accuracy.dt
        steps = walk.accuracy.steps(2.9 - start)
        walking = walk.t[walk.t > start]
        np.testing.assert_array_equal(walking, start + (2.9 - start) * np.arange(1, steps + 1) / steps)
        assert walk.t[-1] == 2.9
        standing = np.diff(np.concatenate([[0.0], walk.t[walk.t <= start]]))
        assert standing == pytest.approx(standing[0])
        assert 2 * dt < standing[0] <= 4 * dt

    def test_steps_under_control_are_halves_of_those_where_the_estimate_asks_for_it(self, ramp_foot):
        """Each time is on the grid of the shortest steps, and steps are short where forces change."""
        accuracy = fo.Accuracy(dt=1e-2, control=1e-4)
        walk = fo.simulate(ramp_foot, fo.Scene(), accuracy)
        parts = 2**HALVINGS
        grid = time_grid(walk.scene, accuracy)
        fine = np.concatenate([grid[:-1, None] + np.diff(grid)[:, None] * np.arange(parts) / parts]).ravel()
        place = np.searchsorted(fine, walk.t[:-1] - 1e-9)
        np.testing.assert_allclose(fine[place], walk.t[:-1], rtol=0, atol=1e-12)
        assert walk.t[-1] == 2.9
        steps = np.diff(walk.t)[walk.t[1:] > 0.6]
        halvings = np.log2(steps.max() / steps)
        np.testing.assert_allclose(halvings, np.round(halvings), atol=1e-6)
        assert set(np.round(halvings)) == {0, 1, 2, 3}
        assert 0 < walk.shortened < 0.2 * len(walk.t)
        table = fo.evaluate([ramp_foot], walk.scene, accuracy)
        assert (table.shortened[0], table.evaluations[0]) == (walk.shortened, walk.evaluations)

    @pytest.mark.parametrize("stepper", ["explicit_euler", "rk4", "sdirk2"])
    def test_a_smaller_control_gives_a_smaller_error(self, stepper, ramp_foot):
        exact = fo.simulate(ramp_foot, fo.Scene(), fo.Accuracy(dt=2e-4)).objectives

        def error(control):
            accuracy = fo.Accuracy(stepper, 1e-2 if stepper == "sdirk2" else 2e-3, control=control)
            found = fo.simulate(ramp_foot, fo.Scene(), accuracy).objectives
            return max(abs(found[name] / exact[name] - 1.0) for name in ("work", "peak_power", "speed_loss"))

        coarse, fine = error(3e-2), error(3e-5)
        assert fine < 0.5 * coarse
        assert fine < 0.01

    def test_explicit_steps_and_a_walker_who_never_starts_have_equal_times(self, ramp_foot):
        explicit = fo.simulate(ramp_foot, fo.Scene(), fo.Accuracy("explicit_euler", 1e-3))
        np.testing.assert_array_equal(explicit.t, 2.9 * np.arange(1, 2901) / 2900)
        scene = fo.Scene(gait=fo.Gait.human(start=math.inf), t_f=1.0)
        standing = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=1e-2))
        np.testing.assert_array_equal(standing.t, np.arange(1, 101) / 100)

    def test_long_steps_while_standing_change_nothing(self, ramp_foot, monkeypatch):
        scene = fo.Scene(t_f=2.8)  # a scene of its own: pose tables are cached
        long = fo.simulate(ramp_foot, scene).objectives
        monkeypatch.setattr(sys.modules["footopt.walk.prepare"], "REST", 1)
        short = fo.simulate(ramp_foot, replace(scene, t_f=2.8 + 1e-12)).objectives
        for name in ("distance", "mean_height", "work", "peak_power", "speed_loss"):
            assert long[name] == pytest.approx(short[name], rel=5e-5)

    def test_shapes(self, walk):
        n = len(walk.t)
        assert walk.com.shape == walk.velocity.shape == (n, 2)
        assert walk.force.shape == (n, 2, 2)
        assert walk.power.shape == walk.work.shape == (n, 2)

    def test_velocity_is_the_rate_of_the_position(self, fine_walk):
        rate = np.gradient(fine_walk.com, fine_walk.t, axis=0)[1:-1]
        np.testing.assert_allclose(rate, fine_walk.velocity[1:-1], rtol=0, atol=2e-3)

    def test_force_is_mass_times_acceleration_and_weight(self, fine_walk):
        walker = fine_walk.scene.walker
        rate = np.gradient(fine_walk.velocity, fine_walk.t, axis=0)
        force = fine_walk.force.sum(axis=1) - np.array([0.0, walker.weight])
        late = fine_walk.t > 0.1  # the first instants settle within the creep speed
        error = np.abs(walker.mass * rate - force)[late]
        assert np.quantile(error, 0.99) < 1e-2 * walker.weight

    @pytest.mark.parametrize("rule", ["arc", "chord"])
    @pytest.mark.parametrize("stepper", ["semi_implicit_euler", "heun", "sdirk2"])
    def test_plates_add_up_to_the_feet(self, rule, stepper, scene, ramp_foot):
        """To rounding; behind an implicit step, to the last step of Newton's method (NEWTON)."""
        tolerance = NEWTON if stepper == "sdirk2" else 1e-9
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(stepper, 5e-3, 64, 1e-3, rule=rule))
        states = walk.plates(np.arange(len(walk.t)))
        force, power = states.force.sum(axis=2), np.sum(states.force * states.velocity, axis=(2, 3))
        np.testing.assert_allclose(force, walk.force, rtol=0, atol=tolerance * np.abs(force).max())
        np.testing.assert_allclose(power, walk.power, rtol=0, atol=tolerance * np.abs(power).max())

    def test_plates_of_the_paper_feel_the_published_stresses(self, scene, ramp_foot):
        """Fast plates, where the creep speed does not matter, by the map in the angles."""
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=5e-3, plates=64, rule="chord"))
        states = walk.plates(np.arange(0, len(walk.t), 20))
        beta = np.arctan2(states.normal[..., 0], -states.normal[..., 1])
        gamma = np.arctan2(-states.velocity[..., 1], states.velocity[..., 0])
        ax, az = fo.stress.alpha(beta, gamma)
        pull = scene.sand.zeta * np.maximum(-states.position[..., 1], 0.0) * states.area
        force = np.stack([-ax, az], axis=-1) * pull[..., None]
        fast = np.hypot(states.velocity[..., 0], states.velocity[..., 1]) > 0.1
        assert fast.any()
        np.testing.assert_allclose(states.force[fast], force[fast], rtol=0, atol=1e-6 * force.max())

    @pytest.mark.parametrize("creep", [1e-4, 1e-2])
    def test_sand_never_gives_energy_beyond_the_creep(self, creep, scene, ramp_foot):
        """P <= zeta * 1 N/cm^3 * depth * area * creep: only the smoothed law near rest gives any."""
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=5e-3, plates=64, creep=creep))
        states = walk.plates(np.arange(len(walk.t)))
        pull = scene.sand.stiffness * np.maximum(-states.position[..., 1], 0.0) * states.area
        power = np.sum(states.force * states.velocity, axis=-1)
        assert (power <= pull * creep).all()
        assert (walk.power <= (pull * creep).sum(axis=-1) + 1e-9).all()

    def test_plates_of_one_instant(self, walk):
        one, many = walk.plates([7]), walk.plates(np.arange(10))
        np.testing.assert_array_equal(one.force[0], many.force[7])


class TestValidity:
    def test_softer_sand_is_further_outside(self, ramp_foot):
        def found(name):
            return {d.name: d for d in diagnose(fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand.named(name))))}

        soft, regular, hard = map(found, ("soft", "regular", "hard"))
        for name in soft:
            assert soft[name].value > regular[name].value > hard[name].value
        shares = [d["share of |W| on trailing faces"].value for d in (soft, regular, hard)]
        np.testing.assert_allclose(shares, [0.45, 0.30, 0.18], atol=0.03)
        assert soft["depth of the sole"].outside
        assert not hard["depth of the sole"].outside

    def test_depth_is_the_maximum_sinkage(self, walk):
        depth = {d.name: d.value for d in diagnose(walk)}["depth of the sole"]
        assert depth == pytest.approx(walk.objectives["maximum_sinkage"], rel=1e-2)


class TestSettings:
    @pytest.mark.parametrize(
        ("setting", "value"),
        [
            ("stepper", "leapfrog"),
            ("rule", "square"),
            ("dt", 0.0),
            ("dt", 1.5),
            ("dt", math.nan),
            ("plates", 1),
            ("plates", 50.0),
            ("creep", 0.0),
            ("creep", -1e-4),
            ("creep", math.inf),
        ],
    )
    def test_impossible_accuracies_are_refused(self, setting, value):
        with pytest.raises(SettingError, match="must be") as error:
            fo.Accuracy(**{setting: value})
        assert error.value.setting == f"accuracy.{setting}"

    def test_an_unknown_accuracy_lists_the_known_ones(self, ramp_foot):
        with pytest.raises(SettingError, match=r"accuracy = 'perfect': must be one of draft, standard"):
            fo.simulate(ramp_foot, accuracy="perfect")

    def test_a_walk_too_long_to_be_refined_has_no_error_estimate(self, ramp_foot, monkeypatch):
        rows = pose_rows(fo.Scene(), fo.Accuracy.named("draft"))
        monkeypatch.setattr(sys.modules["footopt.walk.prepare"], "ROWS", 1.5 * rows)
        assert fo.simulate(ramp_foot, accuracy="draft").feasible
        assert all(map(math.isnan, fo.estimate_error(ramp_foot, accuracy="draft").values()))

    def test_presets_know_their_names(self):
        assert all(fo.Accuracy.named(name).name == name for name in PRESETS)

    @pytest.mark.parametrize("setting", ["mass", "l1", "l2", "g"])
    @pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
    def test_impossible_walkers_are_refused(self, setting, value):
        with pytest.raises(SettingError) as error:
            fo.Walker(**{setting: value})
        assert error.value.setting == f"walker.{setting}"

    @pytest.mark.parametrize("t_f", [0.0, -1.0, math.nan, math.inf])
    def test_impossible_durations_are_refused(self, t_f):
        with pytest.raises(SettingError, match=r"scene\.t_f"):
            fo.Scene(t_f=t_f)

    def test_the_paper_s_walk_lasts_two_strides_after_the_start(self):
        assert fo.Scene().duration == pytest.approx(2.9)
        assert fo.Scene(gait=fo.Gait.human(period=1.0)).duration == pytest.approx(2.5)

    def test_who_stands_still_must_say_how_long(self):
        with pytest.raises(SettingError, match=r"scene\.t_f = None.*scene\.t_f=10"):
            fo.Scene(gait=fo.Gait.human(start=math.inf))

    def test_steps_divide_the_walk_and_are_not_longer_than_dt(self):
        assert fo.Accuracy(dt=1e-3).steps(2.9) == 2900
        assert fo.Accuracy(dt=2e-3).steps(0.3 + 2.6) == 1450
        assert fo.Accuracy(dt=1.0).steps(0.1) == 1
        assert fo.Accuracy(dt=0.3).steps(1.0) == 4

    def test_no_feet_and_no_threads_are_refused(self, flat_foot):
        with pytest.raises(SettingError, match="at least one foot"):
            fo.evaluate([])
        with pytest.raises(SettingError, match=r"engine\.threads = 0"):
            fo.evaluate([flat_foot], threads=0)


def test_poses_of_long_motions_do_not_pile_up():
    """A motion of ten minutes takes 290 MB: of such ones two are kept, of short ones many."""
    gaits = [fo.Gait.human(period=period) for period in (1.0, 1.1, 1.2, 1.3)]
    for duration, kept in ((4.0, pose_tables), (60.0, long_pose_tables)):
        kept.cache_clear()
        for gait in gaits:
            poses(fo.Scene(gait=gait, t_f=duration), fo.Accuracy.named("standard"))
        assert kept.cache_info().currsize == min(len(gaits), kept.cache_info().maxsize)
    assert long_pose_tables.cache_info().maxsize < len(gaits)
