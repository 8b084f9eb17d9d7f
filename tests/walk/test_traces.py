"""How walks fail, what their traces hold, and whether they are inside what the law is tested for."""

import math
import sys
from dataclasses import replace

import numpy as np
import pytest

import footopt as fo
from footopt.walk import discretize
from footopt.walk.checks import diagnose
from footopt.walk.discretize import TRACED, time_grid
from footopt.walk.newton import NEWTON


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
        monkeypatch.setattr(sys.modules["footopt.walk.loop"], "MAX_REPEATS", 0)
        walk = fo.simulate(flat_foot, self.LIGHT, self.LONG)
        assert walk.reason == "diverged"
        assert all(math.isnan(value) for value in walk.objectives.values())
        table = fo.evaluate([flat_foot], self.LIGHT, self.LONG)
        assert (table.reasons[0], table.feasible[0]) == ("diverged", False)
        assert np.isnan(table.values).all()

    def test_a_walk_that_diverges_is_repeated_with_shorter_steps_and_that_is_counted(self, flat_foot):
        walk = fo.simulate(flat_foot, self.LIGHT, self.LONG)
        table = fo.evaluate([flat_foot], self.LIGHT, self.LONG)
        assert walk.counts["repeats"] == table.counts["repeats"][0] > 0
        assert len(walk.t) == 290 * 4 ** walk.counts["repeats"]
        np.testing.assert_allclose(
            table.values[0], [walk.objectives[name] for name in table.names], rtol=1e-12
        )

    def test_a_failed_walk_does_not_disturb_its_batch(self, flat_foot, ramp_foot):
        scene = fo.Scene(sand=fo.Sand.named("soft"))
        feet = [flat_foot, replace(flat_foot, width=0.003), ramp_foot, replace(ramp_foot, width=0.01)]
        table, alone = (fo.evaluate(each, scene, fo.Accuracy()) for each in (feet, feet[::2]))
        assert list(table.reasons) == ["", "sunk", "", "sunk"]
        assert list(table.feasible) == [True, False, True, False]
        assert np.isfinite(table.values[[0, 2]]).all()
        assert np.isnan(table.values[[1, 3]]).all()
        np.testing.assert_array_equal(table.values[[0, 2]], alone.values)


class TestTraces:
    def test_steps_divide_the_walk_and_are_not_longer_than_dt(self):
        assert fo.Accuracy(dt=1e-3).steps(2.9) == 2900
        assert fo.Accuracy(dt=2e-3).steps(0.3 + 2.6) == 1450
        assert fo.Accuracy(dt=1.0).steps(0.1) == 1
        assert fo.Accuracy(dt=0.3).steps(1.0) == 4

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
        parts = 2**TRACED
        grid = time_grid(walk.scene.path, accuracy)
        fine = np.concatenate([grid[:-1, None] + np.diff(grid)[:, None] * np.arange(parts) / parts]).ravel()
        place = np.searchsorted(fine, walk.t[:-1] - 1e-9)
        np.testing.assert_allclose(fine[place], walk.t[:-1], rtol=0, atol=1e-12)
        assert walk.t[-1] == 2.9
        steps = np.diff(walk.t)[walk.t[1:] > 0.6]
        halvings = np.log2(steps.max() / steps)
        np.testing.assert_allclose(halvings, np.round(halvings), atol=1e-6)
        assert set(np.round(halvings)) == {*range(TRACED + 1)}
        assert 0 < walk.counts["shortened"] < 0.2 * len(walk.t)
        table = fo.evaluate([ramp_foot], walk.scene, accuracy)
        assert table.counts["shortened"][0] == walk.counts["shortened"]
        assert table.evaluations[0] == walk.evaluations

    @pytest.mark.slow
    def test_poses_between_those_of_the_tables_are_those_of_the_gait(self, monkeypatch):
        """Compared with tables for every halving."""
        scene, values = fo.Scene(sand=fo.Sand.named("hard"), effects=[fo.LeadingEdge()]), []
        for tabled in (discretize.TABLED, discretize.HALVINGS):
            monkeypatch.setattr(discretize, "TABLED", tabled)
            discretize.pose_tables.cache_clear()
            feet = fo.Waypoints().random(20, seed=1)
            table = fo.evaluate(feet, scene, fo.Accuracy(dt=0.0125, control=1e-5), space=fo.Waypoints())
            assert table.feasible.all()
            values.append(table.values)
        discretize.pose_tables.cache_clear()
        assert (values[0] != values[1]).any()
        np.testing.assert_allclose(values[0], values[1], rtol=5e-6)

    def test_long_steps_while_standing_change_nothing(self, ramp_foot, monkeypatch):
        scene = fo.Scene(t_f=2.8)  # a scene of its own: pose tables are cached
        long = fo.simulate(ramp_foot, scene)
        monkeypatch.setattr(sys.modules["footopt.walk.discretize"], "REST", 1)
        short = fo.simulate(ramp_foot, replace(scene, t_f=2.8 + 1e-12), long.accuracy)
        for name in ("distance", "mean_height", "work", "peak_power", "speed_loss"):
            assert long.objectives[name] == pytest.approx(short.objectives[name], rel=5e-5)

    def test_velocity_is_the_rate_of_the_position(self, fine_walk):
        rate = np.gradient(fine_walk.com, fine_walk.t, axis=0)[1:-1]
        np.testing.assert_allclose(rate, fine_walk.velocity[1:-1], rtol=0, atol=2e-3)

    @pytest.mark.parametrize(("stepper", "rule"), [("heun", "chord"), ("sdirk2", "arc")])
    def test_plates_add_up_to_the_feet(self, rule, stepper, scene, ramp_foot):
        """To rounding; behind an implicit step, to the last step of Newton's method (NEWTON)."""
        tolerance = NEWTON if stepper == "sdirk2" else 1e-9
        walk = fo.simulate(ramp_foot, scene, fo.Accuracy(stepper, 5e-3, 64, 1e-3, rule=rule))
        states = walk.plates(np.arange(len(walk.t)))
        force, power = states.force.sum(axis=2), np.sum(states.force * states.velocity, axis=(2, 3))
        np.testing.assert_allclose(force, walk.force, rtol=0, atol=tolerance * np.abs(force).max())
        np.testing.assert_allclose(power, walk.power, rtol=0, atol=tolerance * np.abs(power).max())


class TestValidity:
    def test_softer_sand_is_further_outside(self, ramp_foot):
        def found(name):
            walk = fo.simulate(ramp_foot, fo.Scene(sand=fo.Sand.named(name)), fo.Accuracy(control=2e-3))
            return {d.name: d for d in diagnose(walk)}

        soft, regular, hard = map(found, ("soft", "regular", "hard"))
        for name in soft:
            assert soft[name].value > regular[name].value > hard[name].value
        shares = [d["share of |W| on trailing faces"].value for d in (soft, regular, hard)]
        np.testing.assert_allclose(shares, [0.45, 0.30, 0.18], atol=0.03)
        regular, hard = ([d.name.split()[-1] for d in of.values() if d.outside] for of in (regular, hard))
        assert (regular, hard) == (["ankle", "faces"], ["ankle"])
        assert soft["depth of the sole"].outside

    def test_lengths_in_another_unit_stand_out(self):
        """A thigh of 9 m, and a half length of 1.3 m that was meant as 13 cm."""
        long_leg, long_sole = fo.Scene(walker=fo.Walker(l1=9.0)), fo.Waypoints(L=1.3)
        cases = (long_leg, fo.Waypoints(), 9.45 / 0.26), (fo.Scene(), long_sole, 2.6 / 0.92)
        for scene, space, ratio in cases:
            told = diagnose(fo.simulate(fo.Foot.flat(space), scene, "draft"))
            (found,) = (d for d in told if "length" in d.name)
            assert (found.outside, found.value) == (True, pytest.approx(ratio, rel=0.05))

    def test_a_walk_that_ends_too_soon_for_a_factor_of_its_efficiency_stands_out(self, flat_foot):
        for t_f, below in ((1.1003, True), (2.9, False)):
            names = {d.name for d in diagnose(fo.simulate(flat_foot, fo.Scene(t_f=t_f)))}
            assert any("floor" in name for name in names) == below
            assert not any("length" in name for name in names)

    def test_a_walker_that_stands_is_told_nothing_of_its_work(self, flat_foot):
        """On a slope it creeps by more than a millimetre in a minute."""
        still = replace(fo.Gait.human(), start=math.inf)
        scene = fo.Scene(sand=fo.Sand(20.0), gait=still, t_f=60.0, effects=[fo.Slope(-10.0)])
        walk = fo.simulate(flat_foot, scene, "draft")
        assert np.ptp(walk.com[:, 0]) > 1e-3
        assert not {d.name for d in diagnose(walk) if d.outside and ("floor" in d.name or "faces" in d.name)}
