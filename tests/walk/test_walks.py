"""Whole walks: an independent program, balances, orders, symmetries, and bit for bit the same again."""

import threading
import time
from dataclasses import replace

import every_effect
import numpy as np
import pytest
from feet_in_sand import momentum_gap
from lsoda import lsoda_objectives

import footopt as fo
from footopt import compiled
from footopt.errors import SettingError
from footopt.gait import LEFT, RIGHT
from footopt.walk import STEPPERS, loop, own_code
from footopt.walk.accuracy import PRESETS, TOLERANCES
from footopt.walk.checks import energy_gap
from footopt.walk.ladder import numerics
from footopt.walk.loop import walk_designs
from footopt.walk.results import stance
from footopt.walk.steppers import Stepper
from footopt.walk.steppers.explicit import runge_kutta

ORDERS = {
    "explicit_euler": 1,
    "heun": 2,
    "implicit_euler": 1,
    "rk4": 4,
    "sdirk2": 2,
    "semi_implicit_euler": 1,
}
ALL = sorted(STEPPERS)
#: Heights of a foot's waypoints, and the five objectives that another program, written apart from this one,
#: found for it on each sand: the law in its angles, LSODA, 100 chords for plates, a creep speed of 1e-5 m/s.
RAMP = (1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8)
PUBLISHED = {
    "soft": (1.84941, 0.76065, 684.635, 606.292, 0.17711),
    "regular": (2.08141, 0.88027, 364.225, 364.768, 0.23598),
    "hard": (2.16852, 0.91860, 148.094, 502.316, 0.29326),
}
#: The published program's own plates and creep speed, in steps so short that time adds nothing.
SAME_PLATES = fo.Accuracy("sdirk2", 1e-4, 100, 1e-5, "same plates", rule="chord")
#: Largest relative difference: what presets promise, less for the finest.
LIMITS = {**TOLERANCES, "reference": 2e-4, "same plates": 2e-4}


class TestIndependentProgram:
    @pytest.mark.parametrize("sand", PUBLISHED)
    @pytest.mark.parametrize("accuracy", ["standard", "fine", "reference", SAME_PLATES], ids=str)
    def test_walks_agree(self, sand, accuracy):
        table = fo.evaluate([RAMP], fo.Scene(sand=fo.Sand.named(sand)), accuracy)
        limit = LIMITS[accuracy if isinstance(accuracy, str) else accuracy.name]
        np.testing.assert_allclose(table.values[0], PUBLISHED[sand], rtol=limit)

    @pytest.mark.slow
    def test_a_walk_with_every_effect_is_that_of_the_second_program(self, ramp_foot):
        """SciPy's LSODA with the law in its angles shares only the effects' hooks with the compiled walk."""
        accuracy = fo.Accuracy("sdirk2", 2e-3, 40, 1e-2, rule="chord", control=1.0)
        walk = fo.simulate(ramp_foot, fo.Scene(effects=every_effect.ALL), accuracy)
        for name, value in lsoda_objectives(walk, rtol=1e-5).items():
            assert walk.objectives[name] == pytest.approx(value, rel=5e-4)


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
    def test_momentum_is_the_impulse_of_sand_and_weight(self, stepper, regular, ramp_foot):
        """M v = integral of force - M g t, to rounding: a step takes from the sand what it gives."""
        walk = fo.simulate(ramp_foot, regular, fo.Accuracy(stepper, 1e-3))
        np.testing.assert_allclose(momentum_gap(walk), 0.0, rtol=0, atol=1e-9)

    @pytest.mark.parametrize("stepper", ALL)
    def test_energy_closes_at_the_steppers_order(self, stepper, sliding):
        """Kinetic + potential energy = work of the sand + work of the joints."""
        errors = []
        for steps in (16, 32, 64):
            walk = sliding(stepper, steps)
            errors.append(energy_gap(walk))
        assert (slopes(errors) > ORDERS[stepper] - 0.15).all()

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

    @pytest.mark.slow
    def test_presets_keep_their_promise_for_95_percent_of_random_feet(self, scene):
        """The worst of the five objectives, for feet other than those that the presets were chosen on."""
        k = fo.Waypoints().random(100, seed=5, inside=True)
        exact = fo.evaluate(k, scene, fo.Accuracy("sdirk2", 5e-4, 400, 1e-5)).values
        for preset, tolerance in TOLERANCES.items():
            error = np.abs(fo.evaluate(k, scene, preset).values / exact - 1).max(axis=1)
            assert np.quantile(error, 0.95) <= tolerance, preset


def test_a_tableau_with_a_stage_beyond_the_step_ends_at_the_step_s_end():
    assert runge_kutta(c=(0.0, 1.5), b=(2 / 3, 1 / 3)).nodes == (1.5, 1.0)
    for c, b in (((), ()), ((0.0, 0.5), (1.0,)), ((0.5,), (1.0,))):
        with pytest.raises(SettingError, match="weights"):
            runge_kutta(c, b)
    with pytest.raises(SettingError, match="nodes"):
        Stepper((), nodes=(0.5,))


class TestSymmetriesOfTheWalk:
    @pytest.mark.parametrize("stepper", ["sdirk2", "explicit_euler"])
    def test_similar_walkers_walk_alike(self, stepper, ramp_foot):
        """Lengths x s, times x sqrt(s), masses x s^3 in the same sand and gravity: no other scale.

        With s = 4 all factors are powers of 2, so that not even rounding differs.
        """
        s, accuracy = 4.0, fo.Accuracy(stepper, 2**-9, 50, 1e-4)
        small = fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand(1.0), effects=(fo.Inertia(),)), accuracy)
        big_scene = fo.Scene(
            sand=fo.Sand(1.0),
            gait=fo.Gait.human(period=1.2 * s**0.5, start=0.5 * s**0.5),
            walker=fo.Walker(mass=60 * s**3, l1=0.47 * s, l2=0.45 * s),
            effects=(fo.Inertia(skin=fo.Inertia.skin * s),),
        )
        big_foot = fo.Foot.from_waypoints(RAMP, L=0.13 * s, H=0.03 * s, width=0.1 * s)
        big_accuracy = replace(accuracy, dt=accuracy.dt * s**0.5, creep=accuracy.creep * s**0.5)
        big = fo.simulate(big_foot, big_scene, big_accuracy)
        np.testing.assert_array_equal(big.t, small.t * s**0.5)
        np.testing.assert_allclose(big.com, small.com * s, rtol=1e-10)
        np.testing.assert_allclose(big.force, small.force * s**3, rtol=1e-10)
        assert stance(big) == stance(small)
        assert big.objectives["efficiency"] * s**6 == pytest.approx(small.objectives["efficiency"], rel=1e-10)

    def test_feet_of_a_small_walker_are_judged_as_those_of_a_large_one(self):
        """By the same steps, plates and creep speed, and by floors of J_W that follow its size."""
        s, hard = 2.0**-6, fo.Scene(sand=fo.Sand.named("hard"))
        gait = fo.Gait.human(period=1.2 * s**0.5, start=0.5 * s**0.5)
        small = fo.Scene(hard.sand, gait, fo.Walker(mass=60 * s**3, l1=0.47 * s, l2=0.45 * s))
        spaces = {hard: fo.Waypoints(), small: fo.Waypoints(L=0.13 * s, H=0.03 * s, width=0.1 * s)}
        numbers = {scene: numerics(PRESETS["standard"], scene, space) for scene, space in spaces.items()}
        assert numbers[small].plates == numbers[hard].plates
        assert numbers[small].control == numbers[hard].control * s**0.5
        names = ("efficiency", "work", "speed_loss")
        k = fo.Waypoints().random(8, seed=3)
        big, little = (fo.evaluate(k, scene, numbers[scene], names, spaces[scene]).values for scene in spaces)
        np.testing.assert_allclose(little / [s**-6, s**4, s**0.5], big, rtol=1e-9)

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
        assert {name: count[0] for name, count in table.counts.items()} == walk.counts
        np.testing.assert_array_equal(fo.evaluate(ramp_foot, scene).raw, fo.evaluate([ramp_foot], scene).raw)

    def test_no_thread_goes_on_after_an_interrupt(self, regular, monkeypatch):
        walked, own = [], threading.get_ident()

        def walk(*arguments):
            walked.append(arguments)
            if threading.get_ident() == own:
                raise KeyboardInterrupt
            time.sleep(0.05)

        monkeypatch.setattr(loop, "compiled_for", lambda *_: walk)
        with pytest.raises(KeyboardInterrupt):
            fo.evaluate(fo.Waypoints().random(600, seed=1), regular, fo.Accuracy(), threads=2)
        time.sleep(0.2)
        assert 1 <= len(walked) <= 3  # of 38 blocks

    def test_a_thread_that_is_interrupted_as_it_starts_ends(self, regular, monkeypatch):
        """Python's pool does not know of it then, and would wait for it for ever."""
        start, started = threading.Thread.start, []

        def interrupted(thread):
            start(thread)
            started.append(thread)
            raise KeyboardInterrupt

        loop._pool.cache_clear()
        with monkeypatch.context() as patch:
            patch.setattr(threading.Thread, "start", interrupted)
            with pytest.raises(KeyboardInterrupt):
                fo.evaluate(fo.Waypoints().random(40, seed=1), regular, fo.Accuracy(), threads=2)
        started[0].join(10)
        assert not started[0].is_alive()

    def test_a_design_does_not_depend_on_batch_place_or_threads(self, regular):
        """Bit for bit: stores, engines and resume rest on it."""
        accuracy, k = fo.Accuracy("sdirk2", 5e-3, 50), fo.Waypoints().random(40, seed=2)
        one = fo.evaluate(k, regular, accuracy, threads=1)
        for threads in (2, 3):
            np.testing.assert_array_equal(fo.evaluate(k, regular, accuracy, threads=threads).raw, one.raw)
        order = np.random.default_rng(0).permutation(len(k))
        np.testing.assert_array_equal(fo.evaluate(k[order], regular, accuracy).raw, one.raw[order])
        for i in (0, 17, 39):
            np.testing.assert_array_equal(fo.evaluate(k[i], regular, accuracy).raw[0], one.raw[i])
        feet = [fo.Foot.from_waypoints(row) for row in k]
        np.testing.assert_array_equal(fo.evaluate(feet, regular, accuracy).raw, one.raw)

    @pytest.mark.slow  # of compiling
    def test_walks_are_the_same_by_code_that_was_just_compiled_and_that_was_loaded(
        self, tmp_path, monkeypatch, ramp_foot
    ):
        accuracy, found = fo.Accuracy("explicit_euler", 1e-3), []
        monkeypatch.setattr(compiled, "cache_folder", lambda: str(tmp_path))
        for loads in (0, 1):
            own_code._compiled.cache_clear()
            found.append(fo.evaluate(ramp_foot, accuracy=accuracy).raw)
            walker = own_code.compiled_for(walk_designs, (), STEPPERS["explicit_euler"].parameters)
            assert sum(walker.stats.cache_hits.values()) == loads
        own_code._compiled.cache_clear()
        np.testing.assert_array_equal(*found)
