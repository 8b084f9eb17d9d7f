"""Effects together: derivatives, limits that go to nothing, balances and hard cases of walks."""

import operator
from dataclasses import replace

import numpy as np
import pytest
from every_effect import ALL, LAYERS, PATCHES, difference
from feet_in_sand import (
    HEIGHT,
    PITCH,
    PLACE,
    RATE,
    SOLES,
    SPEED,
    both_feet,
    feel,
    momentum_gap,
    pose_of,
)
from hypothesis import assume, given
from hypothesis import strategies as st
from numba import njit

import footopt as fo
from footopt.effects import EFFECTS, Inertia, Layers, Patches, Slope, laws, reshaping
from footopt.effects import base as effects
from footopt.effects.dual import Dual
from footopt.studies.stability import judge_case
from footopt.studies.stability_cases import CASES
from footopt.walk.accuracy import PRESETS
from footopt.walk.checks import energy_gap
from footopt.walk.discretize import sole_of
from footopt.walk.newton import NEWTON
from footopt.walk.own_code import compiled_for
from footopt.walk.state import COUNTS, Motion


def test_every_effect_is_tested_here():
    elsewhere = {fo.Rest}  # test_rest.py
    assert {type(effect) for effect in ALL} == set(EFFECTS.values()) - elsewhere


class TestStrength:
    @given(st.floats(1e-4, 0.1), PLACE)
    @pytest.mark.parametrize("on", [(LAYERS,), (PATCHES,), (LAYERS, PATCHES)])
    def test_strength_has_its_derivatives(self, on, depth, x):
        assume(min(abs(depth - interface) for interface in LAYERS.depths) > 1e-5)
        found = laws(on).loads

        _, by_depth, by_x = effects.load(found, Dual(depth, 1.0, 0.0), Dual(x, 0.0, 1.0))
        assert by_depth == pytest.approx(difference(lambda d: effects.load(found, depth + d, x)), abs=1e-5)
        assert by_x == pytest.approx(difference(lambda d: effects.load(found, depth, x + d)), abs=1e-3)


class TestContact:
    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, PLACE, st.sampled_from([1e-3, 1e-2]))
    def test_has_an_exact_jacobian(self, foot, height, pitch, rate, vx, vz, x, stage):
        """In an implicit stage the place follows the velocity: d/dV of F(r0 + c V, V), and of its power."""
        plates, pose, creep, d = foot.plates(40), pose_of(height, pitch, rate), 1e-1, 1e-6

        def moved(dx, dz):
            follow = {"creep": creep, "stage": stage, "x": x + stage * dx, "z": stage * dz}
            return feel(plates, pose, vx + dx, vz + dz, *ALL, **follow)[0][:3]

        found = feel(plates, pose, vx, vz, *ALL, creep=creep, stage=stage, x=x)[0]
        slopes = [(moved(d, 0) - moved(-d, 0)) / (2 * d), (moved(0, d) - moved(0, -d)) / (2 * d)]
        jacobian = np.vstack([found[3:7].reshape(2, 2), found[7:] + found[:2]])
        tolerance = 1e-5 * np.abs(jacobian).max() + 1e-4
        np.testing.assert_allclose(jacobian, np.stack(slopes, axis=1), rtol=0, atol=tolerance)

    @given(st.floats(0.5, 2.9), PLACE, st.floats(0.75, 0.95), SPEED, SPEED)
    def test_plates_add_up_to_the_contact(self, regular_walk, t, x, z, vx, vz):
        """`Walk.plates` of one instant against the contact of both feet."""
        scene = replace(regular_walk.scene, effects=ALL)
        instant = {"t": np.array([t]), "com": np.array([[x, z]]), "velocity": np.array([[vx, vz]])}
        states = replace(regular_walk, scene=scene, **instant).plates([0])
        accuracy = regular_walk.accuracy
        plates = regular_walk.foot.plates(accuracy.plates, accuracy.rule, fill=reshaping(ALL))
        pose = scene.gait.pose([t], scene.walker.l1, scene.walker.l2).table()[0]
        counts, constants = np.zeros(1, COUNTS)[0], scene.constants(accuracy)
        state = constants, sole_of(plates), pose, Motion(x, z, vx, vz), accuracy.creep, None, counts
        out = np.array(compiled_for(both_feet, laws(scene.effects).all)(*state)[:2])
        tolerance = 1e-10 * (1.0 + np.abs(states.force).sum())
        np.testing.assert_allclose(states.force[0].sum(axis=1), out[:, :2], rtol=0, atol=tolerance)
        power = states.power[0].sum(axis=1)
        np.testing.assert_allclose(power, out[:, 2], rtol=0, atol=10.0 * tolerance)


@pytest.fixture(scope="module")
def regular_walk(regular, ramp_foot):
    return fo.simulate(ramp_foot, regular)


NOTHING = (
    Slope(0.0),
    fo.Shadowing(1.0),
    Inertia(factor=0.0),
    Layers((0.02, 0.05), (1.0, 1.0)),
    Patches((0.35, 1.2), (0.95, 1.6), (1.0, 1.0)),
)


def small(inertia, layers, patches):
    """Effects of small parameters."""
    return (
        Inertia(1.1, 900.0 * inertia),
        Layers((0.02, 0.05), (1.0 + layers, 1.0 - layers)),
        Patches((0.35, 1.2), (0.95, 1.6), (1.0 + patches, 1.0 + patches)),
    )


class TestNothing:
    def test_effects_of_nothing_leave_the_walk_as_it_was(self, regular, ramp_foot):
        found = fo.evaluate([ramp_foot], replace(regular, effects=NOTHING)).values
        np.testing.assert_allclose(found, fo.evaluate([ramp_foot], regular).values, rtol=1e-9)

    @pytest.mark.parametrize("name", ["inertia", "layers", "patches"])
    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, PLACE)
    def test_the_force_approaches_the_bare_one_in_proportion(
        self, name, foot, height, pitch, rate, vx, vz, x
    ):
        state = foot.plates(40), pose_of(height, pitch, rate), vx, vz
        bare, tiny = feel(*state, x=x)[0], dict.fromkeys(("inertia", "layers", "patches"), 1e-13)
        one, two = (feel(*state, *small(**tiny | {name: e}), x=x)[0] - bare for e in (1e-3, 2e-3))
        np.testing.assert_allclose(two, 2.0 * one, rtol=0, atol=2e-12 * np.abs(bare).max())
        assert np.abs(one).max() <= 2e-2 * np.abs(bare).max() + 2.0


@pytest.fixture(scope="module")
def all_walk(scene, ramp_foot):
    """With all effects; a control of 1 m/s leaves all steps as they are."""
    return fo.simulate(ramp_foot, replace(scene, effects=ALL), fo.Accuracy(dt=1e-3, control=1.0))


@pytest.mark.slow  # of compiling all effects
class TestWalks:
    def test_momentum_is_the_impulse_of_sand_and_gravity_and_energy_closes(self, all_walk):
        assert all_walk.feasible
        np.testing.assert_allclose(momentum_gap(all_walk), 0.0, rtol=0, atol=1e-9)
        assert energy_gap(all_walk) < 5e-4

    def test_plates_add_up_to_the_feet(self, all_walk):
        """To the last step of Newton's method; where a plate turns to lead inside it, to its force."""
        found = all_walk.plates(np.arange(len(all_walk.t))).force.sum(axis=2)
        error = np.abs(found - all_walk.force).max(axis=(1, 2)) / np.abs(found).max()
        assert np.quantile(error, 0.99) < NEWTON
        assert error.max() < 1.5 / all_walk.accuracy.plates


HARD = ("standing on zeta 5", "a foot set down at 3 m/s", "spiky soles", "creep 1e-9 on zeta 50",
        "a step ten times larger", "sinking to the hip")  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    "effects", [(fo.Rest(),), (fo.LeadingEdge(),), ALL], ids=["rest", "leading edge", "all"]
)
@pytest.mark.parametrize("case", HARD)
def test_hard_cases_are_stable_with_effects(effects, case):
    """With the two that turn forces off and on, and with all but rest at once. Each is compiled twice."""
    (chosen,) = (c for c in CASES if c.name == case)
    foot = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
    base = (foot, fo.Scene(effects=effects), PRESETS["standard"])
    (verdict,) = judge_case(chosen, base, ["sdirk2_control"])
    assert verdict.stable, verdict.measures


def test_the_order_in_which_effects_are_named_does_not_matter():
    assert fo.Scene(effects=ALL[::-1]) == fo.Scene(effects=ALL)


@given(*[st.floats(0.5, 2.0)] * 4)
def test_dual_numbers_have_the_rules_of_derivatives(a, b, da, db):
    """Of sums, products and quotients, by whichever variable."""
    for rule in (operator.add, operator.sub, operator.mul, operator.truediv):
        expected = difference(lambda d, rule=rule: rule(a + da * d, b + db * d))
        one, other = rule(Dual(a, da, 0.0), Dual(b, db, 0.0)), rule(Dual(a, 0.0, da), Dual(b, 0.0, db))
        assert (one.value, one.dz) == (rule(a, b), 0.0)
        assert one.dx == other.dz == pytest.approx(expected, rel=1e-5, abs=1e-6)
        assert rule(np.array([a]), Dual(b, db, 0.0)).value == rule(a, b)  # an array leaves it to the number
    assert -Dual(a, da, db) == Dual(-a, -da, -db)


def test_laws_may_negate_and_change_dual_numbers_in_place():
    @njit
    def law(x, y):
        x += y
        x *= y
        x -= 2.0
        x /= y
        return -x

    x, y = Dual(3.0, 1.0, 0.0), Dual(2.0, 0.0, 1.0)
    assert law(x, y) == law.py_func(x, y) == -(((x + y) * y - 2.0) / y)
