"""The numbers of a tolerance are found by a ladder that a few soles climb in their scene."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.foot import Soles
from footopt.walk import discretize
from footopt.walk.accuracy import PRESETS, TOLERANCES
from footopt.walk.ladder import (
    DEEP,
    SHARE,
    Rung,
    changes_of,
    climb,
    ladder,
    numbers_at,
    numerics,
    plates_at,
    worst,
)
from footopt.walk.ladder import _top as finest

PAPER = fo.Waypoints()
TOP = Rung(12, 13, 11)
HARD = fo.Scene(sand=fo.Sand(500.0))
#: Of draft, standard and fine: a change of these changes what searches find.
RUNGS = {
    "soft": [(0, 0, 0), (2, 0, 0), (6, 3, 2)],
    "regular": [(0, 0, 0), (0, 0, 0), (6, 4, 3)],
    "hard": [(1, 1, 0), (1, 3, 1), (6, 6, 4)],
}


def comb(teeth):
    """A sole of straight sides: two for each tooth."""
    x, z = np.linspace(-0.13, 0.13, 2 * teeth + 1), np.zeros(2 * teeth + 1)
    z[1::2] = -0.02
    return fo.Foot(np.stack([x, z], axis=1), name="comb")


class Halving:
    """Ten probes whose errors halve from rung to rung of each side, at a known cost, and what was walked."""

    def __init__(self, errors, costs=(0.2, 0.4, 0.05)):
        self.errors, self.costs, self.walked = np.array(errors), np.array(costs), []

    def error(self, rung):
        return float((self.errors / 2.0 ** np.array(rung)).sum())

    def __call__(self, rung):
        self.walked.append(rung)
        return np.full((10, 5), 1.0 + self.error(rung)), float(np.prod((1 + self.costs) ** np.array(rung)))


class TestTheClimb:
    @given(
        st.lists(st.floats(1e-4, 0.02), min_size=3, max_size=3), st.sampled_from(sorted(TOLERANCES.values()))
    )
    def test_ends_within_the_tolerance_and_not_far_below(self, errors, tolerance):
        walk = Halving(errors)
        found = climb(walk, TOP, tolerance)
        assert walk.error(found.rung) <= SHARE * tolerance * 1.001
        if any(found.rung):
            assert walk.error(found.rung) > SHARE * tolerance / 8

    def test_refines_the_side_that_errs(self):
        for side in range(3):
            errors = np.full(3, 1e-6)
            errors[side] = 0.02
            found = climb(Halving(errors), TOP, 0.005).rung
            assert found[side] == max(found) > 0
            assert sum(found) == found[side]

    def test_a_walk_further_up_has_to_agree(self):
        """Plates change nothing by the next rung, and much by the one after it."""

        class Lucky(Halving):
            def error(self, rung):
                return super().error((rung[0], rung[1] // 2 * 2, rung[2]))

        walk = Lucky([1e-6, 0.02, 1e-6])
        assert climb(walk, TOP, 0.005).rung == Rung()
        found = climb(walk, TOP, 0.005, deep=DEEP)
        assert found.rung.plates >= 4
        assert walk.error(found.rung) <= SHARE * 0.005 * 4 / 3
        assert climb(walk, TOP, 0.005, 60.0, DEEP).rung == Rung()  # there is no time for it

    def test_sides_that_were_refined_in_vain_go_down_again(self):
        """Plates err as long as the creep speed is large, and not at all with a smaller one."""

        class Late(Halving):
            def error(self, rung):
                plates = self.errors[1] / 2.0 ** rung[1] if rung[2] < 3 else 0.0
                return self.errors[2] / 2.0 ** rung[2] + plates

        walk = Late([0.0, 0.02, 0.03], costs=(0.2, 0.1, 0.4))
        climbed = climb(walk, TOP, 0.005)
        found = climb(walk, TOP, 0.005, deep=DEEP)
        assert climbed.rung.plates > 0
        assert found.rung.plates == 0
        assert found.work < climbed.work
        assert walk.error(found.rung) <= SHARE * 0.005

    def test_counts_what_it_took_and_walks_nothing_twice(self):
        walk = Halving([0.01, 0.02, 0.01])
        found = climb(walk, TOP, 0.005)
        assert len(set(walk.walked)) == len(walk.walked)
        assert found.price == pytest.approx(sum(10 * walk(rung)[1] for rung in set(walk.walked)))
        assert found.work == pytest.approx(walk(found.rung)[1])

    def test_a_lone_sole_looks_two_rungs_up_each_side_and_once_up_all(self):
        class Lone(Halving):
            def __call__(self, rung):
                values, cost = super().__call__(rung)
                return values[:1], cost

        climb(walk := Lone([1e-6] * 3), TOP, 0.005, deep=DEEP)
        sides = {Rung(*(up * (i == side) for i in range(3))) for up in (1, 2) for side in range(3)}
        assert set(walk.walked) == {Rung(), DEEP} | sides

    def test_is_not_endless(self):
        """A scene whose walks differ whatever the numbers: not at the price of the finest rung."""

        class Noise(Halving):
            def __call__(self, rung):
                values, cost = super().__call__(rung)
                return values + np.random.default_rng(list(rung)).normal(0.0, 0.1, values.shape), cost

        walk = Noise([0.01, 0.01, 0.01])
        assert climb(walk, TOP, 0.005).work < 30.0
        short = climb(walk, TOP, 0.005, most=60.0)
        assert short.price <= 60.0 * short.work
        assert short.error > 0.005

    @pytest.mark.parametrize("seed", range(5))
    def test_probes_at_the_brink_do_not_send_the_others_back(self, seed):
        """Where two of ten never agree it ends on a rung that is good for the other eight."""

        class Brink(Halving):
            def __call__(self, rung):
                values, cost = super().__call__(rung)
                values[3:5] += np.random.default_rng([seed, *rung]).normal(0.0, 0.1, (2, 5))
                return values, cost

        walk = Brink([0.05, 0.02, 0.01])
        found = climb(walk, TOP, 0.005, 1000.0, DEEP)
        assert walk.error(found.rung) < walk.error(Rung()) / 3.0

    @pytest.mark.parametrize("tolerance", [0.002, 0.001])
    def test_goes_on_where_errors_only_begin_to_fall(self, tolerance):
        """Two probes hardly change on the first rungs, so that their errors seem small there."""

        class Late(Halving):
            def error(self, rung):
                return 0.02 * 2.0 ** -(rung[1] / 8 if rung[1] < 5 else rung[1] - 4)

            def __call__(self, rung):
                values, cost = Halving([1e-4, 4e-3, 1e-4], costs=(0.2, 0.7, 0.05))(rung)
                values[3:5] += self.error(rung)
                return values, cost

        walk = Late([0.0, 0.0, 0.0])
        found = climb(walk, TOP, tolerance, deep=DEEP)
        assert found.error <= SHARE * tolerance
        assert walk.error(found.rung) <= tolerance

    def test_the_longest_step_is_shorter_on_each_rung(self):
        """Steps under control are halved a few times at most: where all are, the control changes nothing."""
        path = fo.Scene().path
        steps = [numbers_at(PRESETS["fine"], path, Rung(time)).dt for time in range(1, TOP.time)]
        np.testing.assert_allclose(np.divide(steps[1:], steps[:-1]), 2 ** (-1 / 3))

    def test_ends_where_it_costs_too_much_on_the_rung_of_the_smallest_error(self):
        found = climb(Halving([0.008, 0.0, 0.0]), TOP, 0.005, most=110.0)
        assert found.path == (Rung(0), Rung(1))
        assert found.rung == Rung(1)
        assert found.error > SHARE * 0.005

    def test_of_probes_that_all_fail_the_error_is_not_known(self):
        found = climb(lambda rung: (np.full((10, 5), np.nan), 1.0), TOP, 0.005)
        assert math.isnan(found.error)
        assert found.rung == Rung()

    def test_of_one_side_alone_where_others_are_held(self):
        assert climb(Halving([0.1, 0.1, 0.0]), Rung(0, 13, 0), 0.005).rung[0] == 0

    def test_one_probe_of_ten_may_fall(self):
        values = np.ones((10, 5))
        others = values.copy()
        others[3] = np.nan
        assert worst(changes_of(values, others)) == 0.0
        others[4] = np.nan
        assert worst(changes_of(values, others)) == math.inf
        assert worst(changes_of(others, others)) == 0.0
        others[4], others[3] = 1.01, 1.015
        assert worst(changes_of(others, values), 2.0) == pytest.approx(0.015)
        others[3] = 1.1
        assert worst(changes_of(others, values), 2.0) == pytest.approx(0.02)


def test_sides_of_a_drawing_are_resolved_where_an_effect_asks_for_their_direction():
    """Means over noise agree on neighbouring rungs, whatever an effect makes of its sides."""
    x = np.linspace(-0.1, 0.1, 2001)
    noisy = fo.Foot(np.stack([x, 1e-4 * np.random.default_rng(2).standard_normal(2001)], axis=1))
    for foot, effect, resolved in (
        (noisy, fo.Inertia(), True),
        (noisy, fo.LeadingEdge(), True),
        (noisy, fo.Shadowing(), False),
        (fo.Foot.shape("circle"), fo.Inertia(), False),
    ):
        found = ladder(PRESETS["draft"], replace(fo.Scene(), effects=(effect,)), foot)[1]
        assert (found.path[0].plates > 0) is resolved
        if resolved:
            turn = foot.plates(plates_at(found.rung)).turn
            assert np.sqrt(np.mean(turn**2)) < 0.5


class TestNumbers:
    def test_by_hand_are_taken_as_they_are(self, ramp_foot):
        by_hand = fo.Accuracy(plates=24, dt=0.01)
        assert numerics(by_hand, HARD, PAPER) is by_hand
        held = numerics(fo.Tolerance(0.02, plates=40), fo.Scene(), PAPER)
        assert held.plates == 40
        assert held.tolerance == 0.02
        walk = fo.simulate(ramp_foot, HARD)
        assert numerics(walk.accuracy, fo.Scene(), PAPER) == walk.accuracy  # so that a walk can be repeated

    @pytest.mark.parametrize("sand", ["soft", "regular", "hard"])
    def test_are_finer_for_a_smaller_tolerance(self, sand):
        scene = fo.Scene(sand=fo.Sand.named(sand))
        found = [ladder(PRESETS[name], scene, PAPER)[1] for name in ("draft", "standard", "fine")]
        assert [tuple(one.rung) for one in found] == RUNGS[sand]
        work = [one.work for one in found]
        assert work == sorted(work)
        assert work[0] < work[-1]
        fine, reference = (numerics(PRESETS[name], scene, PAPER) for name in ("fine", "reference"))
        assert reference.plates == 4 * fine.plates
        assert reference.dt == pytest.approx(fine.dt / 4)

    def test_of_a_space_are_those_of_its_feet(self):
        """A foot walks as its search did; heights, too, whichever they are."""
        space, scene = fo.Waypoints(n=5, K=4), fo.Scene()
        k = [[1, 2, 3, 4, 1], [4, 4, 4, 4, 4]]
        foot = fo.Foot.from_waypoints(k[0], space)
        soles = (space, foot, Soles(k, space), Soles(k[:1], space))
        assert len({numerics(PRESETS["draft"], scene, of) for of in soles}) == 1

    def test_follow_the_scale_of_the_walker(self):
        """A walker of a quarter of the size in half the time has steps half as long at half the speeds."""
        rung, scenes = (
            Rung(2, 3, 1),
            (fo.Scene(), fo.Scene(gait=fo.Gait.human(period=0.6), walker=fo.Walker(1.0, 0.1, 0.13))),
        )
        large, small = (numbers_at(PRESETS["draft"], scene.path, rung) for scene in scenes)
        assert small.dt == pytest.approx(large.dt / 2)
        assert small.creep == pytest.approx(large.creep / 2)
        assert small.control == pytest.approx(large.control / 2)

    def test_of_harder_walks_cost_more(self):
        plain = ladder(PRESETS["standard"], fo.Scene(), PAPER)[1].work
        assert ladder(PRESETS["standard"], HARD, PAPER)[1].work > plain
        assert ladder(PRESETS["standard"], fo.Scene(), fo.Waypoints(n=33))[1].work > plain

    def test_of_feet_are_what_ten_of_them_need(self, regular):
        feet, of = [comb(teeth) for teeth in (3, 20)], PRESETS["standard"]
        assert numerics(of, regular, feet) == numerics(of, regular, feet * 2)
        for foot, row in zip(feet, fo.evaluate(feet, regular).values, strict=True):
            np.testing.assert_allclose(row, fo.evaluate(foot, regular).values[0], rtol=2 * of.error)

    @pytest.mark.parametrize("time", [6, 9])
    def test_of_long_walks_are_at_most_as_fine_as_their_poses_fit(self, time, monkeypatch):
        of, path = PRESETS["fine"], fo.Scene().path
        monkeypatch.setattr(discretize, "ROWS", discretize.pose_rows(path, numbers_at(of, path, Rung(time))))
        assert finest(of, path).time == time

    @pytest.mark.parametrize("stepper", ["heun", "implicit_euler"])
    def test_are_found_for_any_stepper(self, stepper, regular):
        of = replace(PRESETS["draft"], stepper=stepper)
        k = PAPER.random(10, seed=3, inside=True)
        truth = fo.evaluate(k, regular, fo.Accuracy("sdirk2", 1e-3, 400, 1e-5)).values
        found = fo.evaluate(k, regular, of).values
        assert np.median(np.abs(found / truth - 1.0).max(axis=1)) < of.error
