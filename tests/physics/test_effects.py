"""Effects: limits of each law, of one contact and of walks; what is not named is not there."""

import importlib.util
import math
import os
import re
import runpy
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numba import njit
from scipy.integrate import quad
from test_walker import PITCH, RATE, SOLES, SPEED, pose_of

import footopt as fo
from footopt.effects import EFFECTS, Inertia, Layers, LeadingEdge, Patches, Slope, laws
from footopt.effects import base as effects
from footopt.effects.inertia import SKIN
from footopt.errors import SettingError
from footopt.foot import Plates
from footopt.walk import contact as kernels
from footopt.walk import loop
from footopt.walk.contact import CONTACT, EVALUATIONS, FX, FZ, JXX, JZZ, LANES, PLATES, POWER, TALLY
from footopt.walk.prepare import NEWTON, sole, world

#: One of each; interfaces and patches are two each everywhere here: another number is compiled again.
LAYERS, PATCHES = Layers((0.02, 0.05), (0.6, 1.5)), Patches((0.35, 1.2), (0.95, 1.6), (0.7, 1.5))
ONE = {"layers": LAYERS, "patches": PATCHES, "leading_edge": LeadingEdge(), "inertia": Inertia()}
ALL = (*ONE.values(), Slope(3.0))
SETS = {**{name: (effect,) for name, effect in ONE.items()}, "all": ALL}

DOWN = pose_of(0.0, 0.0, 0.0)  # the ankle at the hip, level
PLACE, HEIGHT = st.floats(0.0, 1.8), st.floats(-0.1, 0.05)


def test_every_effect_is_tested_here():
    assert {type(effect) for effect in ALL} == set(EFFECTS.values())


def feel(plates, pose, vx, vz, *on, zeta=1.0, creep=1e-2, stage=1e-2, x=0.0, z=0.0):
    """Contact of one foot with effects, from the compiled kernel, and its tally; the other is in the sky."""
    scene = fo.Scene(sand=fo.Sand(zeta), effects=on)
    if not laws(scene.effects).directed:
        plates = plates._replace(tx=None, tz=None)
    out, tally = np.full((2, CONTACT), np.nan), np.zeros(TALLY, np.int64)
    poses = np.array([pose, pose_of(10.0, 0.0, 0.0)])
    constants = world(scene, fo.Accuracy(creep=creep))
    kernels.contact(out, tally, sole(plates), constants, poses, x, z, vx, vz, creep, stage)
    assert (out[1] == 0.0).all()
    return out[0], tally


def force(*arguments, **options):
    return feel(*arguments, **options)[0][[FX, FZ]]


def blade(beta, length=0.016, width=0.016, parts=8):
    """A straight plate, its middle at the ankle, in the direction beta (rad): normal (sin, -cos)."""
    s = length * ((np.arange(parts) + 0.5) / parts - 0.5)
    columns = (s * math.cos(beta), s * math.sin(beta), math.cos(2 * beta), math.sin(2 * beta))
    columns = (*columns, length * width / parts, math.cos(beta), math.sin(beta))
    return Plates(*(np.full((1, parts), column) for column in columns))


# --- the laws, as functions ---------------------------------------------------------------------


def difference(function, d=1e-7):
    return (function(d) - function(-d)) / (2.0 * d)


class TestHooks:
    @given(st.floats(1e-4, 0.1), PLACE, st.floats(0.1, 2.0), st.floats(0.1, 2.0), st.floats(-5.0, 5.0))
    @pytest.mark.parametrize("on", [(LAYERS,), (PATCHES,), (LAYERS, PATCHES)])
    def test_strength_has_its_derivatives(self, on, depth, x, load, grow, slide):
        """Also after other effects: the state before it changes with depth and x, too."""
        assume(min(abs(depth - interface) for interface in LAYERS.depths) > 1e-5)
        found = laws(on).loads

        def strength(dd, dx):
            before = (load + grow * dd + slide * dx, grow, slide)
            return effects.load(found, before, depth + dd, x + dx)[0]

        _, by_depth, by_x = effects.load(found, (load, grow, slide), depth, x)
        assert by_depth == pytest.approx(difference(lambda d: strength(d, 0.0)), abs=1e-5)
        assert by_x == pytest.approx(difference(lambda d: strength(0.0, d)), abs=1e-3)

    @given(st.floats(-3.0, 3.0), st.floats(1e-4, 1e-1))
    def test_gate_has_its_derivative(self, s, creep):
        found = laws([LeadingEdge()]).gates
        _, bend = effects.gate(found, (1.0, 0.0), s * creep, creep)
        slope = difference(lambda d: effects.gate(found, (1.0, 0.0), (s + d) * creep, creep)[0])
        assert bend * creep == pytest.approx(slope, abs=1e-6)

    @given(st.floats(-2.0, 2.0), st.floats(0.0, 3e-3))
    def test_push_has_its_derivatives(self, into, depth):
        assume(abs(depth - SKIN) > 1e-6)
        found = laws([Inertia()]).pushes

        def push(du, dd):
            return effects.push(found, (0.0, 0.0, 0.0), into + du, depth + dd)[0]

        _, stiff, sink = effects.push(found, (0.0, 0.0, 0.0), into, depth)
        assert stiff == pytest.approx(difference(lambda d: push(d, 0.0)), abs=1e-3)
        assert sink == pytest.approx(difference(lambda d: push(0.0, d)), rel=1e-6, abs=1e-2)


class TestContact:
    @pytest.mark.parametrize("name", SETS)
    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, PLACE, st.sampled_from([1e-3, 1e-2]))
    def test_has_an_exact_jacobian(self, name, foot, height, pitch, rate, vx, vz, x, stage):
        """In an implicit stage the place follows the velocity: d/dV of F(r0 + c V, V)."""
        plates, pose, creep, d = foot.plates(40, directed=True), pose_of(height, pitch, rate), 1e-1, 1e-5

        def moved(dx, dz):
            follow = {"creep": creep, "stage": stage, "x": x + stage * dx, "z": stage * dz}
            return force(plates, pose, vx + dx, vz + dz, *SETS[name], **follow)

        found = feel(plates, pose, vx, vz, *SETS[name], creep=creep, stage=stage, x=x)[0]
        slopes = [(moved(d, 0) - moved(-d, 0)) / (2 * d), (moved(0, d) - moved(0, -d)) / (2 * d)]
        jacobian = found[JXX : JZZ + 1].reshape(2, 2)
        tolerance = 1e-5 * np.abs(jacobian).max() + 1e-4
        np.testing.assert_allclose(jacobian, np.stack(slopes, axis=1), rtol=0, atol=tolerance)

    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, PLACE)
    def test_jacobian_or_not_the_force_is_the_same(self, foot, height, pitch, rate, vx, vz, x):
        state = foot.plates(40, directed=True), pose_of(height, pitch, rate), vx, vz, *ALL
        with_, without = feel(*state, x=x)[0], feel(*state, x=x, stage=None)[0]
        first = [FX, FZ, POWER]
        np.testing.assert_allclose(with_[first], without[first], rtol=1e-10, atol=1e-8)

    @given(st.floats(0.5, 2.9), PLACE, st.floats(0.75, 0.95), SPEED, SPEED)
    def test_readable_and_compiled_form_are_one_law(self, regular_walk, t, x, z, vx, vz):
        """`Walk.plates` of one instant against the kernel, both feet, each added up."""
        scene = replace(regular_walk.scene, effects=ALL)
        instant = {"t": np.array([t]), "com": np.array([[x, z]]), "velocity": np.array([[vx, vz]])}
        states = replace(regular_walk, scene=scene, **instant).plates([0])
        accuracy = regular_walk.accuracy
        plates = regular_walk.foot.plates(accuracy.plates, accuracy.rule, directed=True)
        pose = scene.gait.pose([t], scene.walker.l1, scene.walker.l2).table()[0]
        out, tally = np.empty((2, CONTACT)), np.zeros(TALLY, np.int64)
        constants = world(scene, accuracy)
        kernels.contact(out, tally, sole(plates), constants, pose, x, z, vx, vz, accuracy.creep, None)
        tolerance = 1e-10 * (1.0 + np.abs(states.force).sum())
        np.testing.assert_allclose(states.force[0].sum(axis=1), out[:, [FX, FZ]], rtol=0, atol=tolerance)
        power = np.sum(states.force * states.velocity, axis=-1)[0].sum(axis=1)
        np.testing.assert_allclose(power, out[:, POWER], rtol=0, atol=10.0 * tolerance)


@pytest.fixture(scope="module")
def regular_walk(regular, ramp_foot):
    return fo.simulate(ramp_foot, regular)


# --- each law's limits --------------------------------------------------------------------------


class TestLeadingEdge:
    @given(st.floats(-3.1, 3.1), st.floats(-math.pi, math.pi), st.floats(0.05, 2.0))
    def test_a_face_that_leads_feels_the_whole_law_and_one_that_trails_nothing(self, beta, angle, speed):
        creep = 1e-2
        plate, vx, vz = blade(beta), speed * math.cos(angle), speed * math.sin(angle)
        into = vx * math.sin(beta) - vz * math.cos(beta)
        pose = pose_of(-0.1, 0.0, 0.0)
        found = force(plate, pose, vx, vz, LeadingEdge(), creep=creep)
        if into > creep:
            np.testing.assert_allclose(found, force(plate, pose, vx, vz, creep=creep), rtol=1e-12, atol=1e-12)
        elif into < -creep:
            assert (found == 0.0).all()

    @given(SOLES, st.floats(-0.2, -0.05), st.floats(-0.5, 0.5), st.floats(0.2, 1.5))
    def test_a_foot_pulled_straight_up_is_not_held(self, foot, height, pitch, speed):
        plates = foot.plates(40, directed=True)
        upright = math.cos(pitch) * plates.tx - math.sin(pitch) * plates.tz
        assume(upright.min() * speed > 1e-2)
        pose = pose_of(height, pitch, 0.0)
        assert (force(plates, pose, 0.0, speed, LeadingEdge()) == 0.0).all()
        assert force(plates, pose, 0.0, speed)[1] < 0.0

    @given(st.floats(-1.2, 1.2), st.floats(0.05, 1.5))
    def test_an_upward_face_does_not_suck(self, tilt, speed):
        """The top of a closed contour that sinks: nothing; that rises: pressed down, never up."""
        top, pose = blade(math.pi + tilt), pose_of(-0.1, 0.0, 0.0)
        assert (force(top, pose, 0.0, -speed, LeadingEdge()) == 0.0).all()
        assert force(top, pose, 0.0, speed, LeadingEdge())[1] < 0.0

    def test_the_share_rises_smoothly_over_the_creep_speed(self):
        creep = 1e-3
        into = creep * np.linspace(-1.5, 1.5, 301)
        share, bend = effects.gate(laws([LeadingEdge()]).gates, (1.0, 0.0), into, creep)
        assert (np.diff(share) >= 0.0).all()
        assert (share[0], share[150], share[-1]) == (0.0, pytest.approx(0.5), 1.0)
        assert np.abs(np.diff(bend)).max() < 0.05 * bend.max()  # no jump in the derivative either


class TestInertia:
    SPEEDS = np.array([0.04, 0.08, 0.16, 0.32, 0.64])

    @pytest.mark.parametrize("depth", [0.02, 0.03, 0.04])
    def test_drag_is_k_depth_and_lambda_rho_area_v2(self, depth):
        """The drag test of dynamic RFT, for a plate of .016 m: F = K |z| + lambda rho A v^2."""
        area, creep = 0.016 * 0.016, 1e-9
        drag = [
            -force(blade(math.pi / 2), DOWN, v, 0.0, Inertia(1.1, 900.0), creep=creep, z=-depth)[0]
            for v in self.SPEEDS
        ]
        slope, at_rest = np.polyfit(self.SPEEDS**2, drag, 1)
        assert slope == pytest.approx(1.1 * 900.0 * area, rel=1e-9)
        ax, _ = fo.stress.alpha(math.pi / 2, 0.0)
        assert at_rest == pytest.approx(float(ax) * depth * area, rel=1e-9)

    def test_a_face_that_trails_throws_nothing_aside(self):
        for speed in self.SPEEDS:
            state = blade(-math.pi / 2), DOWN, speed, 0.0
            np.testing.assert_allclose(force(*state, Inertia(), z=-0.03), force(*state, z=-0.03), rtol=1e-12)

    @given(st.floats(0.0, 2.0))
    def test_a_plate_gets_wet_in_proportion_to_its_depth(self, skins):
        """A level plate moving down: beyond the law's own force, lambda rho A v^2 times the share."""
        speed, area, z = 0.5, 0.016 * 0.016, -skins * SKIN
        state = blade(0.0), DOWN, 0.0, -speed
        thrown = force(*state, Inertia(1.1, 900.0), z=z) - force(*state, z=z)
        expected = [0.0, 990.0 * area * speed**2 * min(skins, 1.0)]
        np.testing.assert_allclose(thrown, expected, rtol=0, atol=1e-9)


class TestLayers:
    @pytest.mark.parametrize("interface", LAYERS.depths)
    def test_stress_is_continuous_at_an_interface(self, interface):
        above, at, below = effects.load(
            laws([LAYERS]).loads, *self.state(interface + np.array([-1, 0, 1e-12]))
        )[0]
        assert below - at == pytest.approx(0.0, abs=1e-11)
        assert above < at

    @staticmethod
    def state(depth):
        return (depth, np.ones_like(depth), np.zeros_like(depth)), depth, 0.0

    @given(st.floats(0.0, 0.12), st.floats(-1.5, 1.5), st.floats(0.0, math.pi), st.floats(0.2, 5.0))
    def test_stress_is_the_integral_of_zeta_over_depth(self, depth, beta, gamma, zeta):
        """A plate's force by quadrature of the plain law's growth with depth, as published."""
        along = np.searchsorted(LAYERS.depths, [0.0, 0.03, 0.06])
        assert list(along) == [0, 1, 2]
        factors = (1.0, *LAYERS.factors)
        integral, _ = quad(
            lambda d: zeta * factors[np.searchsorted(LAYERS.depths, d)], 0.0, depth, points=LAYERS.depths
        )
        ax, az = fo.stress.alpha(beta, gamma)
        vx, vz, area = math.cos(gamma), -math.sin(gamma), 0.016 * 0.016
        plate = blade(beta, parts=8)._replace(x=np.zeros((1, 8)), z=np.zeros((1, 8)))
        found = force(plate, DOWN, vx, vz, LAYERS, zeta=zeta, creep=1e-7, z=-depth)
        np.testing.assert_allclose(found, integral * area * np.array([-ax, az]), rtol=1e-9, atol=1e-8)

    @given(SOLES, PITCH, RATE, SPEED, SPEED)
    def test_above_the_first_interface_nothing_changes(self, foot, pitch, rate, vx, vz):
        plates = foot.plates(40, directed=True)
        lowest = (math.sin(pitch) * plates.x + math.cos(pitch) * plates.z).min()
        state = plates, pose_of(-lowest - 0.99 * LAYERS.depths[0], pitch, rate), vx, vz
        plain = feel(*state)[0]
        np.testing.assert_allclose(
            feel(*state, LAYERS)[0], plain, rtol=1e-12, atol=1e-12 * np.abs(plain).max()
        )


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


# --- parameters that go to zero -----------------------------------------------------------------

NOTHING = {
    "slope": Slope(0.0),
    "inertia": Inertia(rho=0.0),
    "inertia's factor": Inertia(factor=0.0),
    "layers": Layers((0.02, 0.05), (1.0, 1.0)),
    "patches": Patches((0.35, 1.2), (0.95, 1.6), (1.0, 1.0)),
}

#: Effects of a small parameter.
SMALL = {
    "inertia": lambda e: Inertia(1.1, 900.0 * e),
    "layers": lambda e: Layers((0.02, 0.05), (1.0 + e, 1.0 - e)),
    "patches": lambda e: Patches((0.35, 1.2), (0.95, 1.6), (1.0 + e, 1.0 + e)),
    "slope": lambda e: Slope(e),
}


class TestNothing:
    @pytest.mark.parametrize("name", NOTHING)
    def test_an_effect_of_nothing_is_dropped(self, name, regular):
        assert replace(regular, effects=(NOTHING[name],)) == regular

    def test_effects_of_nothing_leave_the_walk_as_it_was_bit_for_bit(self, regular, ramp_foot):
        kinds = {type(effect): effect for effect in NOTHING.values()}
        scene = replace(regular, effects=tuple(kinds.values()))
        found = fo.evaluate([ramp_foot], scene).raw
        np.testing.assert_array_equal(found, fo.evaluate([ramp_foot], regular).raw)

    @pytest.mark.parametrize("name", ["inertia", "layers", "patches"])
    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, PLACE)
    def test_the_force_approaches_the_bare_one_in_proportion(
        self, name, foot, height, pitch, rate, vx, vz, x
    ):
        state = foot.plates(40, directed=True), pose_of(height, pitch, rate), vx, vz
        bare = feel(*state, x=x)[0]
        one, two = (feel(*state, SMALL[name](e), x=x)[0] - bare for e in (1e-3, 2e-3))
        np.testing.assert_allclose(two, 2.0 * one, rtol=0, atol=1e-12 * np.abs(bare).max())
        assert np.abs(one).max() <= 2e-2 * np.abs(bare).max() + 2.0

    @pytest.mark.slow
    @pytest.mark.parametrize("name", SMALL)
    def test_the_walk_approaches_the_bare_one_in_proportion(self, name, regular, ramp_foot):
        def distance(*on):
            scene = replace(regular, effects=on)
            accuracy = fo.Accuracy(dt=1e-3, control=1.0)
            return fo.simulate(ramp_foot, scene, accuracy).objectives["distance"]

        bare = distance()
        one, two = (distance(SMALL[name](e)) - bare for e in (0.05, 0.1))
        assert one != 0.0
        assert two == pytest.approx(2.0 * one, rel=0.1)


# --- whole walks --------------------------------------------------------------------------------


def balances(walk, angle):
    """Momentum (N s) gained less what sand and gravity gave; energy (J) likewise, over |work|."""
    walker, v, totals = walk.scene.walker, walk.velocity[-1], walk.totals
    gravity = walker.weight * np.array([-math.sin(math.radians(angle)), -math.cos(math.radians(angle))])
    impulse = np.array([totals["impulse_x"], totals["impulse_z"]]) + gravity * walk.t[-1]
    work = walk.work[-1].sum()
    gained = 0.5 * walker.mass * v @ v - gravity @ (walk.com[-1] - walk.start)
    return walker.mass * v - impulse, (gained - work - totals["net_joint_work"]) / abs(work)


@pytest.fixture(scope="module")
def all_walk(scene, ramp_foot):
    """With all effects; a control of 1 m/s leaves all steps as they are."""
    return fo.simulate(ramp_foot, replace(scene, effects=ALL), fo.Accuracy(dt=1e-3, control=1.0))


class TestWalks:
    def test_momentum_is_the_impulse_of_sand_and_gravity(self, all_walk):
        assert all_walk.feasible
        np.testing.assert_allclose(balances(all_walk, 3.0)[0], 0.0, rtol=0, atol=1e-9)

    def test_energy_closes(self, all_walk):
        assert balances(all_walk, 3.0)[1] == pytest.approx(0.0, abs=5e-4)

    def test_plates_add_up_to_the_feet(self, all_walk):
        """To the last step of Newton's method; where a plate turns to lead inside it, to its force."""
        found = all_walk.plates(np.arange(len(all_walk.t))).force.sum(axis=2)
        error = np.abs(found - all_walk.force).max(axis=(1, 2)) / np.abs(found).max()
        assert np.quantile(error, 0.99) < NEWTON
        assert error.max() < 1.5 / all_walk.accuracy.plates

    @pytest.mark.slow
    def test_a_design_does_not_depend_on_batch_place_or_threads(self, regular):
        scene, k = replace(regular, effects=ALL), fo.Waypoints().random(40, seed=2, inside=True)
        one = fo.evaluate(k, scene, threads=1)
        assert one.feasible.sum() > 20
        np.testing.assert_array_equal(fo.evaluate(k, scene, threads=3).raw, one.raw)
        order = np.random.default_rng(0).permutation(len(k))
        np.testing.assert_array_equal(fo.evaluate(k[order], scene).raw, one.raw[order])
        np.testing.assert_array_equal(fo.evaluate(k[17], scene).raw[0], one.raw[17])


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
        momentum, energy = balances(walk, angle)
        np.testing.assert_allclose(momentum, 0.0, rtol=0, atol=1e-9)
        assert energy == pytest.approx(0.0, abs=5e-4)

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


# --- nothing for nothing ------------------------------------------------------------------------

DELETED = runpy.run_path(str(Path(fo.__file__).parents[1] / "benchmarks" / "deleted.py"))

#: Floating-point instructions of LLVM, and calls of its mathematical functions.
OPERATION = re.compile(r"= (?:tail )?(fadd|fsub|fmul|fdiv|fneg|fcmp|select|call[^@]*@llvm\.\w+)\b")


def operations(compiled):
    """How often each floating-point operation is in a function's optimised intermediate form."""
    (text,) = compiled.inspect_llvm().values()
    assert "fmul" in text
    return Counter(OPERATION.findall(text))


def step(loop, *on):
    """Operations of what effects change of a step, compiled here for a scene: plates and acceleration."""
    plate_sums, acceleration, scene = (
        loop.kernels.plate_sums,
        loop.steppers.acceleration,
        fo.Scene(effects=on),
    )

    @njit(error_model="numpy")
    def both(sole, world, at):
        sums = plate_sums(
            sole, world, world.loads, world.gates, world.pushes, sole.tx, sole.tz, 0, len(sole.x),
            0.1, -0.1, 0.3, -0.2, 0.9, 0.1, 0.5, world.creep, 1e-3,
        )  # fmt: skip
        return sums, acceleration(at, world)

    plates = fo.Foot.flat().plates(64, directed=laws(scene.effects).directed)
    both(sole(plates), world(scene, fo.Accuracy()), np.zeros((2, CONTACT)))
    return operations(both)


@pytest.fixture(scope="module")
def deleted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("deleted")
    DELETED["write"](folder)
    return DELETED["load"](folder)


@pytest.fixture(scope="module")
def bare(deleted):
    return step(deleted)


class TestNothingForNothing:
    def test_the_deleted_source_knows_no_effect(self, deleted):
        """What is compared with is really without: no hook, no normal, no tilt is computed."""
        text = Path(deleted.kernels.__file__).read_text()
        for trace in ("effects.load(", "effects.gate(", "effects.push(", "* tilt", "nx", "into"):
            assert trace in Path(kernels.__file__).read_text()
            assert trace not in text.split("def plate_sums")[1]

    def test_a_bare_step_has_the_operations_of_the_deleted_source(self, bare):
        assert step(loop) == bare

    @pytest.mark.parametrize("effect", ALL, ids=lambda effect: type(effect).__name__)
    def test_each_effect_has_more_and_only_where_it_is_named(self, effect, bare):
        found = step(loop, effect)
        assert found.total() > bare.total()
        assert not bare - found

    @pytest.mark.slow
    def test_a_whole_bare_walk_has_the_operations_of_the_deleted_source(self, deleted, tmp_path, regular):
        DELETED["write"](tmp_path, "footopt_copy", delete=False)
        copy = DELETED["load"](tmp_path, "footopt_copy")
        found = []
        for package in (copy, deleted):
            with DELETED["walking"](package):
                table = fo.evaluate([[5] * 11], regular)
            found.append((operations(package.compiled(package.steppers.SDIRK2())), table.raw.tobytes()))
        assert found[0] == found[1]

    @pytest.mark.parametrize("on", [(), ALL], ids=["bare", "all effects"])
    @given(foot=SOLES, height=st.floats(-0.1, 0.25), pitch=PITCH, rate=RATE, vx=SPEED, vz=SPEED)
    def test_plates_are_evaluated_in_whole_blocks_that_reach_the_sand(
        self, on, foot, height, pitch, rate, vx, vz
    ):
        """Blocks from the first to the last whose circle reaches below the surface; a foot above, none."""
        plates = foot.plates(100, directed=True)
        low = height + math.sin(pitch) * plates.x[0] + math.cos(pitch) * plates.z[0]
        in_sand = np.flatnonzero(low < 0.0) // LANES
        found, tally = feel(plates, pose_of(height, pitch, rate), vx, vz, *on)
        assert tally[EVALUATIONS] == 1
        assert tally[PLATES] % LANES == 0
        if len(in_sand) == 0:
            assert (found == 0.0).all()
        else:
            assert tally[PLATES] >= LANES * (in_sand[-1] - in_sand[0] + 1)
        reach = 0.03  # m, more than a block's diameter: 8 of 100 plates of a sole that is < .36 m long
        near = np.flatnonzero(low < reach) // LANES
        assert tally[PLATES] <= (LANES * (near[-1] - near[0] + 1) if len(near) else 0)

    def test_effects_evaluate_no_plate_more(self):
        """Of one state: what is counted is where the foot is, whatever the sand."""
        for height in (-0.1, 0.0, 0.02, 0.1):
            for pitch in (-0.6, 0.0, 0.6):
                state = fo.Foot.flat().plates(64, directed=True), pose_of(height, pitch, 1.0), 0.3, -0.2
                counts = {feel(*state, *on)[1][PLATES] for on in ((), *SETS.values())}
                assert len(counts) == 1


# --- an effect of one's own ---------------------------------------------------------------------

OWN = """
from dataclasses import dataclass
from typing import NamedTuple

import footopt as fo
from footopt.effects import base as effects

class DampLaw(NamedTuple):
    rate: float

@dataclass(frozen=True)
class Damp:
    rate: float = 2000.0  # N s/m^3, a pressure per speed into the sand
    nothing = False

    @property
    def law(self):
        return DampLaw(self.rate)

def damp(law, state, into, depth):
    push, stiff, sink = state
    return push + 1.0 * law.rate * into * (depth > 0.0), stiff + law.rate * (depth > 0.0), sink

effects.register(DampLaw, push=damp)
"""


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    path = tmp_path_factory.mktemp("own") / "own_effect.py"
    path.write_text(OWN)
    spec = importlib.util.spec_from_file_location("own_effect", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["own_effect"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["own_effect"]


class TestAnEffectOfOnesOwn:
    def test_takes_fewer_than_30_lines(self):
        assert len(OWN.strip().splitlines()) < 30

    def test_acts_in_the_kernel_on_top_of_the_others(self, own):
        speed, state = 0.5, (blade(0.0), DOWN, 0.0, -0.5)
        added = force(*state, *ALL, own.Damp(), z=-0.03) - force(*state, *ALL, z=-0.03)
        np.testing.assert_allclose(added, [0.0, 2000.0 * speed * 0.016**2], rtol=1e-9, atol=1e-12)

    @pytest.mark.slow
    def test_walks_through_a_scene_and_shows_in_its_plates(self, own, regular, ramp_foot):
        bare, walk = (
            fo.simulate(ramp_foot, replace(regular, effects=on), "fine") for on in ((), (own.Damp(),))
        )
        assert walk.objectives["distance"] != pytest.approx(bare.objectives["distance"], rel=1e-4)
        found = walk.plates(np.arange(len(walk.t))).force.sum(axis=2)
        np.testing.assert_allclose(found, walk.force, rtol=0, atol=NEWTON * np.abs(found).max())
        assert balances(walk, 0.0)[1] == pytest.approx(0.0, abs=5e-3)

    @pytest.mark.slow
    def test_that_was_edited_is_compiled_again(self, tmp_path):
        """Compiled code on disk never outlives the hook that it was compiled from."""
        environment = os.environ | {"PYTHONPATH": str(tmp_path)}
        code = "import own_effect as o, footopt as fo; s = fo.Scene(effects=(o.Damp(),), t_f=1.2)\n"
        code += "print(fo.simulate(fo.Foot.flat(), s, 'draft').totals['work'])"
        found = []
        for factor in ("1.0", "3.0"):
            (tmp_path / "own_effect.py").write_text(OWN.replace("1.0", factor))
            run = [sys.executable, "-B", "-c", code]
            done = subprocess.run(run, env=environment, capture_output=True, check=True, text=True)
            found.append(float(done.stdout))
        assert found[0] != found[1]
        # ... and is no trap for a process that does not know the effect
        code = "import footopt as fo; print(fo.simulate(fo.Foot.flat(), fo.Scene(t_f=1.2), 'draft').reason)"
        run, alone = [sys.executable, "-c", code], environment | {"PYTHONPATH": ""}
        assert subprocess.run(run, env=alone, capture_output=True, check=True).stdout.strip() == b""

    def test_a_law_without_hooks_is_refused(self, own):
        class Loose(own.Damp):
            law = (1.0,)

        with pytest.raises(SettingError, match=r"effects = 'tuple'.*effects\.register"):
            laws((Loose(),))


# --- settings -----------------------------------------------------------------------------------


class TestSettings:
    @pytest.mark.parametrize(
        ("setting", "build"),
        [
            ("inertia.factor", lambda: Inertia(factor=-1.0)),
            ("inertia.factor", lambda: Inertia(factor=math.inf)),
            ("inertia.rho", lambda: Inertia(rho=math.nan)),
            ("inertia.rho", lambda: Inertia(rho=-1.0)),
            ("slope.angle", lambda: Slope(30.0)),
            ("slope.angle", lambda: Slope(-25.1)),
            ("slope.angle", lambda: Slope(math.nan)),
            ("layers.depths", lambda: Layers((), ())),
            ("layers.depths", lambda: Layers((0.0,), (1.0,))),
            ("layers.depths", lambda: Layers((0.05, 0.02), (1.0, 2.0))),
            ("layers.depths", lambda: Layers((0.02, math.inf), (1.0, 2.0))),
            ("layers.depths", lambda: Layers((math.nan,), (1.0,))),
            ("layers.factors", lambda: Layers((0.02,), (1.0, 2.0))),
            ("layers.factors", lambda: Layers((0.02,), (0.0,))),
            ("layers.factors", lambda: Layers((0.02,), (math.nan,))),
            ("patches.ends", lambda: Patches((), (), ())),
            ("patches.ends", lambda: Patches((0.1,), (0.2, 0.3), (2.0,))),
            ("patches.ends", lambda: Patches((0.2,), (0.1,), (2.0,))),
            ("patches.ends", lambda: Patches((0.2,), (math.inf,), (2.0,))),
            ("patches.factors", lambda: Patches((0.1,), (0.2,), ())),
            ("patches.factors", lambda: Patches((0.1,), (0.2,), (-1.0,))),
            ("patches.blur", lambda: Patches(blur=0.0)),
            ("patches.blur", lambda: Patches(blur=math.nan)),
        ],
    )
    def test_impossible_parameters_are_refused_by_name(self, setting, build):
        with pytest.raises(SettingError, match="must be") as error:
            build()
        assert error.value.setting == f"effects.{setting}"

    def test_two_of_a_kind_are_refused(self):
        with pytest.raises(SettingError, match=r"effects = 'Slope'.*at most one"):
            fo.Scene(effects=(Slope(1.0), Slope(2.0)))

    def test_the_order_in_which_effects_are_named_does_not_matter(self):
        assert fo.Scene(effects=ALL[::-1]) == fo.Scene(effects=ALL)

    def test_plates_without_directions_are_refused_where_they_are_needed(self):
        plates = fo.Waypoints().plates(np.full((1, 11), 5), 32)
        with pytest.raises(SettingError, match="directed=True"):
            fo.evaluate(plates, fo.Scene(effects=(LeadingEdge(),)))
