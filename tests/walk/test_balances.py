"""Hard walks keep their balances: standing still, energy, the sand's power, and feet that stick."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import footopt as fo
from footopt.sand.law import GENERIC
from footopt.studies.stability_cases import MARCH
from footopt.walk import STEPPERS
from footopt.walk.checks import NOISE, energy_gap, power_from_sand, sinking_speed, smoothing_power
from footopt.walk.contact import Direction, resistance
from footopt.walk.newton import MAX_NEWTON

SANDS = (0.05, 0.2, 1.0, 5.0, 50.0, 500.0)


def still(zeta, t_f=10.0):
    return fo.Scene(sand=fo.Sand(zeta), gait=fo.Gait.human(start=math.inf), t_f=t_f)


def vertical(walk):
    """Vertical force of the second half over the weight."""
    return walk.force[walk.t > 0.5 * walk.t[-1]].sum(axis=1)[:, 1] / walk.scene.walker.weight


class TestStandingStill:
    @pytest.mark.parametrize("zeta", SANDS)
    def test_the_force_does_not_chatter_and_what_creeps_is_what_smoothing_lets_yield(
        self, zeta, flat_foot, ramp_foot
    ):
        for foot in (ramp_foot, flat_foot):
            walk = fo.simulate(foot, still(zeta))
            assert walk.feasible
            assert vertical(walk).std() < 1e-3
            assert vertical(walk).mean() == pytest.approx(1.0, abs=1e-3)
        expected = sinking_speed(walk, walk.t[-1])
        assert -walk.velocity[-1, 1] <= 1.05 * expected
        if expected > 1.1 * walk.accuracy.creep:
            assert -walk.velocity[-1, 1] == pytest.approx(expected, rel=0.2)
        assert abs(walk.com[-1, 0]) < 1e-9

    @pytest.mark.parametrize(("zeta", "dt"), [(0.2, 1e-3), (5.0, 1e-4), (50.0, 1e-3)])
    def test_explicit_euler_chatters_as_creep_goes_to_zero(self, zeta, dt, flat_foot):
        walk = fo.simulate(flat_foot, still(zeta, 2.0), fo.Accuracy("explicit_euler", dt, 64, 1e-9))
        assert vertical(walk).std() > 0.1


@st.composite
def hard_scenes(draw):
    """Feet and scenes across five decades of the sand's stiffness and of mass."""
    zeta = 10.0 ** draw(st.floats(-2.0, 3.0))
    mass = 10.0 ** draw(st.floats(-1.0, 4.0))
    period = draw(st.floats(0.4, 3.0))
    heights = draw(st.lists(st.integers(1, 10), min_size=11, max_size=11))
    scene = fo.Scene(fo.Sand(zeta), fo.Gait.human(period), fo.Walker(mass=mass))
    return fo.Foot.from_waypoints(heights), scene


def finite_or_infeasible_with_a_reason(foot, scene, accuracy):
    table = fo.evaluate([foot], scene, accuracy)
    if table.feasible[0]:
        assert np.isfinite(table.values).all()
        assert (table.column("work") >= 0).all()
    else:
        assert table.reasons[0] in ("sunk", "backward", "diverged")
        assert np.isnan(table.values).all()
    walk = fo.simulate(foot, scene, accuracy)
    assert walk.reason == table.reasons[0]
    assert np.isfinite(walk.force).all()
    assert np.isfinite(walk.com).all()
    assert walk.evaluations <= 2 * MAX_NEWTON * 85 * walk.accuracy.steps(scene.duration)


class TestRandomScenes:
    @given(hard_scenes(), st.sampled_from([0.02, 0.005]), st.sampled_from([24, 200]))
    def test_no_nan_in_any(self, scene, dt, plates):
        finite_or_infeasible_with_a_reason(*scene, fo.Accuracy(dt=dt, plates=plates, control=2e-3))

    @pytest.mark.slow
    @settings(max_examples=50)
    @given(hard_scenes())
    def test_no_nan_where_the_numbers_are_found(self, scene):
        finite_or_infeasible_with_a_reason(*scene, "standard")


class TestEnergy:
    @pytest.mark.parametrize("zeta", [0.2, 1.0, 5.0, 50.0])
    def test_what_the_sand_takes_and_the_joints_give_is_what_the_walker_has(self, zeta, ramp_foot, flat_foot):
        for foot in (ramp_foot, flat_foot):
            walk = fo.simulate(foot, fo.Scene(sand=fo.Sand(zeta)))
            assert energy_gap(walk) < (1e-3 if zeta <= 5.0 else 5e-3)

    @given(st.floats(-math.pi / 2, math.pi / 2), st.floats(-math.pi, math.pi), st.floats(-4.0, 4.0))
    def test_the_smoothed_law_lends_no_more_than_its_bound(self, beta, direction, decade):
        eps = 1e-4
        velocity = eps * 10.0**decade * np.array([math.cos(direction), math.sin(direction)])
        h = Direction(*(velocity / math.hypot(*velocity, eps)), 0.0, 1.0)
        force = resistance(GENERIC.law, math.cos(2 * beta), math.sin(2 * beta), h, 1.0, None)
        assert force @ velocity <= smoothing_power(GENERIC) * eps * np.hypot(*force)
        if math.hypot(*velocity) > smoothing_power(GENERIC) * eps:
            assert force @ velocity < 0

    @pytest.mark.parametrize("stepper", STEPPERS)
    def test_the_sand_gives_no_power_beyond_that(self, stepper, ramp_foot):
        walk = fo.simulate(ramp_foot, fo.Scene(), fo.Accuracy(stepper, 1e-3, 64, 1e-4))
        assert power_from_sand(walk) <= smoothing_power(GENERIC)
        walk = fo.simulate(ramp_foot, fo.Scene(), fo.Accuracy(stepper, 1e-3, 64, creep=0.3))  # gives some
        plates, given = walk.plates(np.arange(len(walk.t))), walk.power > NOISE * np.abs(walk.power).max()
        share = walk.power / np.maximum(
            np.hypot(*plates.force.T).T.sum(axis=-1) * plates.transition_speed, 1e-300
        )
        assert power_from_sand(walk, len(walk.t)) == pytest.approx(share[given].max())

    @pytest.mark.slow
    def test_the_sand_gives_none_in_random_marches(self):
        for seed in range(20):
            rng = np.random.default_rng(seed)
            foot = fo.Foot.from_waypoints(rng.integers(1, 11, 11))
            walker = fo.Walker(mass=float(rng.uniform(25.0, 120.0)))
            scene = fo.Scene(sand=fo.Sand(float(10.0 ** rng.uniform(-0.7, 1.7))), walker=walker)
            faster = replace(MARCH, period=MARCH.period * float(rng.uniform(0.7, 1.5)))
            walk = fo.simulate(foot, replace(scene, gait=faster), "standard")
            assert walk.feasible, seed
            assert power_from_sand(walk) <= smoothing_power(GENERIC), seed
            assert energy_gap(walk) < 0.01, seed


def level(gait):
    """The same strides with feet that do not turn."""
    return replace(gait, foot=type(gait.thigh)(0.0, (0.0,), (0.0,)), pitch="measured")


class TestNewton:
    @pytest.mark.parametrize(
        "effects", [(), (fo.Rest(),), (fo.LeadingEdge(),)], ids=["creep", "rest", "edge"]
    )
    @pytest.mark.parametrize("zeta", [5.0, 50.0, 500.0])
    def test_a_foot_that_is_kept_level_takes_little_more_than_one_that_turns(self, zeta, effects):
        """All of its plates turn their direction over at one velocity, hundreds of times while it stands."""
        accuracy = fo.Accuracy("sdirk2", 5e-3, 64, 5e-6, control=5e-4)
        feet, turning = fo.Waypoints().random(4, seed=1), fo.Gait.human()
        scenes = [fo.Scene(fo.Sand(zeta), gait, effects=effects) for gait in (turning, level(turning))]
        walks = [fo.evaluate(feet, scene, accuracy) for scene in scenes]
        most = 3.0 if fo.LeadingEdge() in effects else 2.0  # there one that turns takes few
        assert (walks[1].evaluations <= most * walks[0].evaluations).all()
        assert not walks[1].counts["repeats"].any()
        assert not walks[1].counts["unsolved"].any()

    @pytest.mark.parametrize(("effects", "share"), [((), 1e-3), ((fo.LeadingEdge(),), 1e-8)])
    def test_the_power_of_a_foot_that_does_not_turn_is_force_times_velocity(self, flat_foot, effects, share):
        """At the end of each step, however far the last step of Newton's method changes the force."""
        scene = fo.Scene(fo.Sand(7.0), level(fo.Gait.human()), effects=effects)
        walk = fo.simulate(flat_foot, scene)
        feet = scene.gait.pose(walk.t, scene.walker.l1, scene.walker.l2).table()[:, :, 2:4]
        power = (walk.force * (walk.velocity[:, None] + feet)).sum(axis=-1)
        np.testing.assert_allclose(walk.power, power, rtol=0, atol=share * walk.objectives["peak_power"])

    def test_a_march_is_right(self, flat_foot):
        """Level feet set down at 3 m/s."""
        stamp = fo.simulate(flat_foot, fo.Scene(gait=MARCH))
        finer = fo.simulate(stamp.foot, stamp.scene, replace(stamp.accuracy, dt=stamp.accuracy.dt / 25))
        for name in ("distance", "mean_height", "work", "peak_power", "speed_loss"):
            assert stamp.objectives[name] == pytest.approx(finer.objectives[name], rel=0.01)
        assert energy_gap(stamp) < 2e-3

    def test_repeats_are_counted_and_the_walk_is_right(self, ramp_foot):
        """Hard sand with little smoothing, in long steps."""
        scene = fo.Scene(sand=fo.Sand(50.0))
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy("sdirk2", 1.25e-2, 64, 1e-6))
        assert walk.feasible
        finer = fo.simulate(ramp_foot, scene, fo.Accuracy("sdirk2", 1e-3, 64, 1e-5))
        for name in ("distance", "mean_height", "work", "speed_loss"):
            assert walk.objectives[name] == pytest.approx(finer.objectives[name], rel=0.05)
        step = walk.accuracy.dt / 4 ** walk.counts["repeats"]
        assert np.median(np.diff(walk.t)) == pytest.approx(step, rel=0.02)

    @pytest.mark.parametrize("stepper", ["sdirk2", "implicit_euler"])
    def test_a_step_that_begins_in_the_air_sees_the_sand_it_ends_in(self, stepper, flat_foot):
        walk = fo.simulate(flat_foot, fo.Scene(), fo.Accuracy(stepper, 6.25e-2, 64, 1e-4, rule="chord"))
        law = walk.plates(np.arange(len(walk.t))).force.sum(axis=2)
        # Newton's last step leaves 2 % of the weight in so long a step; an unseen landing more than all
        assert np.abs(walk.force - law).max() < 0.1 * walk.scene.walker.weight
