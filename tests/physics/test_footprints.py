"""Footprints: sand that is moved is not lost, lies no steeper than it can, and is met by the next foot."""

import math
from dataclasses import replace

import numpy as np
import pytest
from every_effect import ALL
from feet_in_sand import SKY, SOLES, pose_of
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numba import njit
from random_scenes import draw, scale_of, shuffle, shuffling

import footopt as fo
from footopt.effects import Scale, laws
from footopt.effects.footprints import finer_cells, prints_of
from footopt.errors import SettingError
from footopt.walk.adapt import adapted
from footopt.walk.balances import momentum_gap
from footopt.walk.ground import level_ground
from footopt.walk.loop import compiled_contact
from footopt.walk.plates import plate_states
from footopt.walk.prepare import NEWTON, sole, world
from footopt.walk.prints import moved_sand
from footopt.walk.slides import settle
from footopt.walk.state import COUNTS

ON, SAME = fo.Footprints(), fo.Accuracy(dt=5e-3)  # steps that do not follow the scene
STEP = 0.5  # s, of `stamps`
PRINTS = prints_of((ON,), 0.0, 4.0 * STEP)
HEIGHTS = arrays(np.float64, 40, elements=st.floats(-0.1, 0.1))
RISES = st.floats(0.002, 0.03)


def slid(height, rise, fall):
    """A surface after it has slid."""
    return slides(np.array(height), rise, fall)


@njit
def slides(height, rise, fall):
    settle(height, 0, len(height), rise, fall)
    return height


def stamps(foot, places):
    """The sand after the left ankle has been at some places (x, z), m. At each fourth it takes it in."""
    poses = np.array([[pose_of(z, 0.0, 0.0), SKY] for _, z in places])
    motions = np.zeros((len(poses), 4))
    motions[:, 0], motions[:, 3] = [x for x, _ in places], -1.0
    times = STEP * np.arange(len(poses))
    return moved_sand(PRINTS, sole(foot.plates(64)), poses, times, motions, np.arange(len(poses) - 1))


def area(sand):
    """Of what lies above the undisturbed sand and beside the feet, less what is missing, m^2."""
    return (sand.x[1] - sand.x[0]) * sand.height.sum(axis=1) + sand.beside


class TestSlides:
    @given(HEIGHTS, RISES, RISES)
    def test_sand_slides_to_the_angle_of_repose_and_none_is_lost(self, height, rise, fall):
        found = slid(height, rise, fall)
        assert np.sum(found) == pytest.approx(np.sum(height), abs=1e-13)
        steps = np.diff(found)
        assert steps.max() <= rise + 1e-12
        assert steps.min() >= -fall - 1e-12

    @given(arrays(np.float64, 39, elements=st.floats(-1.0, 1.0)), RISES)
    def test_sand_that_is_at_rest_stays_to_the_last_bit(self, steps, rise):
        height = np.concatenate([[0.0], np.cumsum(0.999 * rise * steps)])
        assert np.array_equal(slid(height, rise, rise), height)

    @given(HEIGHTS, RISES, RISES, arrays(np.float64, 39, elements=st.floats(-1.0, 1.0)), st.floats(-0.1, 0.1))
    def test_no_surface_at_rest_is_nearer(self, height, rise, fall, steps, level):
        """Of a projection on a convex set: what it moves by makes no acute angle with any way into it."""
        other = level + np.concatenate([[0.0], np.cumsum(np.where(steps > 0.0, rise, fall) * steps)])
        found = slid(height, rise, fall)
        assert (height - found) @ (other - found) <= 1e-13

    @given(HEIGHTS, HEIGHTS, RISES, RISES)
    def test_two_surfaces_come_no_further_apart(self, height, other, rise, fall):
        """So an error of a print does not grow by sliding, however the sand lies."""
        apart = slid(height, rise, fall) - slid(other, rise, fall)
        assert np.linalg.norm(apart) <= np.linalg.norm(height - other) + 1e-13

    def test_a_cliff_becomes_the_slope_through_half_its_height_and_a_heap_a_triangle(self):
        cliff = slid(np.repeat([0.0, 0.1], 50), 0.01, 0.01)
        np.testing.assert_allclose(
            cliff, np.clip(0.05 + 0.01 * (np.arange(100) - 49.5), 0.0, 0.1), atol=1e-12
        )
        heap = np.zeros(101)
        heap[50] = 1.0
        np.testing.assert_allclose(
            slid(heap, 0.01, 0.01), np.maximum(0.1 - 0.01 * abs(np.arange(101) - 50), 0.0), atol=1e-12
        )


@pytest.mark.slow  # of compiling
class TestPrints:
    @given(
        SOLES,
        st.lists(st.tuples(st.floats(-0.3, 0.3), st.floats(-0.05, 0.2)), min_size=2, max_size=12),
        st.floats(-3.0, 3.0),
    )
    def test_area_is_conserved_and_no_slope_is_beyond_repose(self, foot, places, x):
        sand = stamps(foot, [(0.0, 1.0), *((x + dx, z) for dx, z in places), (0.0, 1.0), (0.0, 1.0)])
        np.testing.assert_allclose(area(sand), 0.0, rtol=0, atol=1e-12)
        assert np.abs(np.diff(sand.height)).max() <= (sand.x[1] - sand.x[0]) * PRINTS.rise + 1e-12
        np.testing.assert_allclose(sand.height[-1], sand.height[-2], rtol=0, atol=1e-12)

    def test_a_print_is_as_deep_as_the_sole_went_and_has_a_rim_at_both_ends(self):
        sand = stamps(fo.Foot.flat(), [(0.0, 1.0), (0.0, 0.04), (0.0, 0.01), (0.0, 0.04)])
        inside = np.abs(sand.x) < 0.08
        bottom = fo.Foot.flat().contour[0, 1] + 0.01
        np.testing.assert_allclose(sand.height[-1][inside], bottom, atol=1e-12)
        left, right = (sand.height[-1][side].max() for side in (sand.x < -0.1, sand.x > 0.1))
        assert left > 0.002
        assert right > 0.002

    def test_a_print_depends_on_the_way_and_not_on_the_steps_in_which_it_is_walked(self):
        """A comb of five teeth ploughs along: between two steps each tooth leaves a furrow."""
        x = np.linspace(-0.1, 0.1, 11)
        comb = fo.Foot(
            np.stack([x, np.where(np.arange(11) % 2, 0.0, 0.02)], axis=1), 0.1, (0.0, 0.05), "comb"
        )
        ways = [np.linspace(0.0, 0.3, n) for n in (4, 301)]
        few, many = (stamps(comb, [(0.0, 1.0), *((x, 0.02) for x in way)]).height[-1] for way in ways)
        assert few.min() < -0.01
        np.testing.assert_allclose(few, many, rtol=0, atol=1e-4)

    def test_the_second_step_on_the_same_place_meets_less_force(self):
        """The foot feels nothing of its print while it makes it, and all of it when it comes back."""
        foot = fo.Foot.flat()
        once = [(0.0, 0.02), (0.0, 0.015), (0.0, 0.01)]
        sand = stamps(foot, [(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), *once, (0.0, 1.0), *once])
        plates, none = foot.plates(64, directed=True), np.zeros((1, 2))

        def lift(sample, z):
            pose = fo.gait.Pose(none, np.array([[z, 10.0]]), none, none, none, none)
            down = np.array([[0.0, -1.0]])
            level = sand.level[sample : sample + 1]
            return plate_states(plates, pose, none, down, fo.Scene(), 1e-4, level=level).total[0, 0, 1]

        np.testing.assert_array_equal(sand.level[:5, 0], 0.0)
        first, second = (np.array([lift(n + i, z) for i, (_, z) in enumerate(once)]) for n in (2, 6))
        assert (second < 0.2 * first).all()

    @pytest.mark.parametrize(("z", "feels"), [(0.02, False), (0.2, True)])
    def test_a_foot_that_takes_the_sand_in_while_it_ploughs_does_not_feel_its_own_heap(self, z, feels):
        way = [(0.02 * n, 0.02) for n in range(1, 6)]
        sand = stamps(fo.Foot.flat(), [(0.0, 1.0), *way, (0.12, z), (0.14, 0.02)])
        assert sand.height[-1].max() > 0.005
        assert (np.abs(sand.level[-1, 0]).max() > 0.005) == feels


@pytest.fixture(scope="module")
def printing(scene, ramp_foot):
    """A walk of short steps: a foot comes down on the other's print."""
    return fo.simulate(ramp_foot, replace(scene, gait=shuffle(scene.gait, 0.3), effects=(ON,)), SAME)


@pytest.mark.slow  # of compiling
class TestWalks:
    def test_area_is_conserved_over_a_walk(self, printing):
        sand = printing.sand(np.arange(len(printing.t)))
        assert np.abs(sand.height).sum() > 1.0
        np.testing.assert_allclose(area(sand), 0.0, rtol=0, atol=1e-10)

    @pytest.mark.parametrize("name", ["soft", "regular", "hard"])
    def test_area_is_conserved_over_the_walks_of_a_hundred_random_feet(self, name):
        scene = fo.Scene(sand=fo.Sand.named(name), effects=(ON,))
        for k in fo.Waypoints().random(100, seed=5, inside=True):
            walk = fo.simulate(fo.Foot.from_waypoints(k), scene)
            sand = walk.sand([len(walk.t) // 2, len(walk.t) - 1])
            np.testing.assert_allclose(area(sand), 0.0, rtol=0, atol=1e-10)

    def test_plates_below_the_sand_that_was_moved_add_up_to_the_feet(self, printing):
        """What is made again from the trace is what the walk was compiled with."""
        error = np.abs(printing.plates(np.arange(len(printing.t))).total - printing.force)
        assert np.quantile(error, 0.999) < NEWTON * np.abs(printing.force).max()
        assert error.max() < 3.0 * NEWTON * np.abs(printing.force).max()

    def test_momentum_is_the_impulse_of_sand_and_gravity(self, printing):
        np.testing.assert_allclose(momentum_gap(printing), 0.0, rtol=0, atol=1e-9)

    def test_a_walk_is_the_same_as_without_until_a_foot_meets_moved_sand(self, printing):
        fine = fo.Accuracy(dt=5e-4)  # its steps end elsewhere
        walk, without = (
            fo.simulate(printing.foot, replace(printing.scene, effects=on), fine) for on in ((ON,), ())
        )
        index = np.arange(len(walk.t))
        level, place = walk.sand(index).level, walk.plates(index).position
        meets = ((level != 0.0) & (place[..., 1] < np.maximum(level, 0.0))).any(axis=(1, 2))
        first = int(np.argmax(meets))
        assert walk.t[first] > printing.scene.gait.start
        apart = np.abs(walk.com[:, 1] - np.interp(walk.t, without.t, without.com[:, 1]))
        assert apart[:first].max() < 2e-5
        assert apart.max() > 1e-3

    def test_a_design_does_not_depend_on_batch_place_or_threads(self, regular):
        scene, k = replace(regular, effects=(ON,)), fo.Waypoints().random(40, seed=2, inside=True)
        one = fo.evaluate(k, scene, "draft", threads=1)
        assert one.feasible.all()
        np.testing.assert_array_equal(fo.evaluate(k, scene, "draft", threads=3).raw, one.raw)
        np.testing.assert_array_equal(fo.evaluate(k[::-1], scene, "draft").raw, one.raw[::-1])
        np.testing.assert_array_equal(fo.evaluate(k[17], scene, "draft").raw[0], one.raw[17])

    def test_the_field_grows_with_the_way(self, ramp_foot):
        """What is made again from the trace begins with a field that is long enough."""
        gait = shuffle(fo.Gait.human(), 0.3)
        walk = fo.simulate(ramp_foot, fo.Scene(gait=gait, t_f=30.0, effects=(ON,)), "draft")
        index = np.arange(len(walk.t))
        sand = walk.sand(index)
        assert np.ptp(sand.x[sand.height[-1] < -0.005]) > 3.0
        np.testing.assert_allclose(area(sand), 0.0, rtol=0, atol=1e-10)
        error = np.abs(walk.plates(index).total - walk.force)
        assert error.max() < 3.0 * NEWTON * np.abs(walk.force).max()

    @pytest.mark.parametrize("number", [5, 11, 35])
    def test_shorter_steps_and_narrower_cells_change_less_and_less(self, number):
        """Scenes of short steps, whose feet come down on prints; no preset knows of them."""
        drawn = shuffling(draw(number), number)
        own = adapted(fo.Accuracy.named("standard"), drawn.scene, drawn.space or drawn.foot(0))

        def walk(times):
            on = finer_cells(drawn.scene.effects, times)
            accuracy = replace(own.refined(times), plates=own.plates << times)
            return fo.evaluate(drawn.feet[:1], replace(drawn.scene, effects=on), accuracy, space=drawn.space)

        level = fo.evaluate(drawn.feet[:1], replace(drawn.scene, effects=()), space=drawn.space).values
        coarse, fine, truth = (walk(times).values for times in (0, 1, 3))
        errors = [np.max(np.abs(values - truth) / scale_of(truth)) for values in (level, coarse, fine)]
        assert errors[0] > 0.01
        assert errors[2] < errors[1] < 0.01

    def test_with_every_other_effect_plates_add_up_and_area_is_conserved(self, ramp_foot):
        scene = fo.Scene(sand=fo.Sand.named("regular"), effects=(*ALL, ON))
        walk = fo.simulate(replace(ramp_foot, closed=True), scene, fo.Accuracy(dt=1e-3, control=1.0))
        assert walk.feasible
        index = np.arange(len(walk.t))
        error = np.abs(walk.plates(index).total - walk.force).max(axis=(1, 2)) / np.abs(walk.force).max()
        assert np.quantile(error, 0.99) < NEWTON
        sand = walk.sand(index)
        np.testing.assert_allclose(area(sand), 0.0, rtol=0, atol=1e-10)

    def test_who_stands_with_rest_still_stays(self, flat_foot):
        gait = fo.Gait.human(start=math.inf)
        scene = fo.Scene(gait=gait, t_f=5.0, effects=(fo.Rest(), ON))
        walk = fo.simulate(flat_foot, scene)
        assert np.abs(walk.com[-1] - walk.com[len(walk.t) // 2]).max() < 1e-6


@pytest.mark.parametrize("on", [(), (fo.Inertia(),)])
def test_the_contact_with_a_surface_has_an_exact_jacobian(on):
    """In an implicit stage the place follows the velocity, and the surface below it with the place."""
    scene, rng, counts = fo.Scene(effects=on), np.random.default_rng(3), np.zeros(1, COUNTS)[0]
    both, constants, d, c = compiled_contact(laws(scene.effects)), world(scene, fo.Accuracy()), 1e-6, 1e-2
    directed = laws(scene.effects).directed
    for foot in (fo.Foot.from_waypoints(k) for k in fo.Waypoints().random(8, seed=1)):
        ground = level_ground(0.05, -20, 60, 40, 41, 0.1, 1.0, 1.0)
        ground.found[:] = np.cumsum(rng.uniform(-0.02, 0.02, 60))
        ground.top[:] = ground.found.max()
        plates = sole(foot.plates(40, directed=directed))._replace(ground=ground)
        poses = np.array([pose_of(-0.02, rng.uniform(-0.5, 0.5), 1.0), SKY])
        vx, vz = rng.uniform(-1.0, 1.0, 2)

        def force(dx, dz):
            at = both(constants, plates, poses, 0.3 + c * dx, c * dz, vx + dx, vz + dz, 1e-2, c, counts).left  # noqa: B023
            return np.array(at)

        found, jacobian = force(0.0, 0.0), force(0.0, 0.0)[3:].reshape(2, 2)
        slopes = [(force(*s)[:2] - force(*-s)[:2]) / (2.0 * d) for s in d * np.eye(2)]
        assert np.abs(found[:2]).max() > 1.0
        np.testing.assert_allclose(
            jacobian, np.stack(slopes, axis=1), rtol=0, atol=1e-5 * np.abs(jacobian).max()
        )


class TestSettings:
    @pytest.mark.parametrize(
        ("name", "value"), [("repose", 0.0), ("repose", math.nan), ("cells", 0), ("cells", 10_000)]
    )
    def test_impossible_parameters_are_refused_by_name(self, name, value):
        with pytest.raises(SettingError, match="must be") as error:
            fo.Footprints(**{name: value})
        assert error.value.setting == f"effects.footprints.{name}"

    def test_a_slope_as_steep_as_the_angle_of_repose_is_refused(self, flat_foot):
        scene = fo.Scene(effects=(fo.Slope(20.0), fo.Footprints(repose=20.0)))
        with pytest.raises(SettingError, match="more than the slope's 20 deg"):
            fo.evaluate([flat_foot], scene)

    def test_on_a_slope_sand_lies_steeper_against_it_than_down_it(self):
        uphill = prints_of((fo.Slope(10.0), ON), 0.0, 1.0)
        assert math.degrees(math.atan(uphill.rise)) == pytest.approx(20.0)
        assert math.degrees(math.atan(uphill.fall)) == pytest.approx(40.0)

    def test_steps_far_apart_have_no_part_in_each_other_and_those_on_one_spot_all(self):
        scale = Scale(stress=1.0, pull=0.0, depth=0.02, speed=1.0, distance=2.0, length=0.26)
        assert ON.estimate(scale._replace(step=1.0)) == 0.0
        assert 0.0 < ON.estimate(scale._replace(step=0.3)) < ON.estimate(scale._replace(step=0.26))
        assert ON.estimate(scale._replace(step=0.0)) == 1.0
