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

import footopt as fo
from footopt.effects import Scale, laws
from footopt.effects.footprints import prints_of
from footopt.errors import SettingError
from footopt.walk.balances import momentum_gap
from footopt.walk.ground import level_ground, settle
from footopt.walk.loop import compiled_contact
from footopt.walk.plates import plate_states
from footopt.walk.prepare import NEWTON, sole, world
from footopt.walk.prints import moved_sand
from footopt.walk.state import COUNTS

ON, SAME = fo.Footprints(), fo.Accuracy(dt=5e-3)  # steps that do not follow the scene
PRINTS = prints_of((ON,))
RAMP = PRINTS.fall  # m from cell to cell at the angle of repose, on level ground
HEIGHTS = arrays(np.float64, 40, elements=st.floats(-0.1, 0.1))


def ground_with(height, under):
    """A field with these heights, and a sole where `under` is finite."""
    ground = level_ground(PRINTS.cell, 0, len(height), 8, 0.1, 1.0)
    ground.height[:] = height
    ground.under[0] = np.maximum(under, height)
    return ground


def slid(ground, rise=RAMP, fall=RAMP):
    settle(ground, 0, len(ground.height), 1, fall)
    settle(ground, 0, len(ground.height), -1, rise)
    return ground.height


def stamps(foot, heights, x=0.0):
    """The sand after the ankle of one foot has stood at some heights (m), one after the other."""
    poses = np.array([[pose_of(z, 0.0, 0.0), SKY] for z in (1.0, *heights)])
    motions = np.zeros((len(poses), 4))
    motions[:, 0], motions[:, 3] = x, -1.0
    plates = sole(foot.plates(64))
    return moved_sand(PRINTS, plates, poses, motions, np.arange(len(heights)))


class TestSlides:
    @given(HEIGHTS, st.floats(0.2, 3.0), st.floats(0.2, 3.0))
    def test_sand_slides_to_the_angle_of_repose_and_none_is_lost(self, height, rise, fall):
        found = slid(ground_with(height, np.full(40, np.inf)), rise * RAMP, fall * RAMP)
        assert np.sum(found) == pytest.approx(np.sum(height), abs=1e-13)
        steps = np.diff(found)
        assert steps.max() <= rise * RAMP + 1e-12
        assert steps.min() >= -fall * RAMP - 1e-12

    @given(arrays(np.float64, 39, elements=st.floats(-1.0, 1.0)))
    def test_sand_that_is_at_rest_stays_to_the_last_bit(self, steps):
        height = np.concatenate([[0.0], np.cumsum(0.999 * RAMP * steps)])
        assert np.array_equal(slid(ground_with(height, np.full(40, np.inf))), height)

    @given(HEIGHTS, arrays(np.bool_, 40))
    def test_sand_under_a_sole_stays_and_holds_up_what_lies_beside_it(self, height, covered):
        found = slid(ground_with(height, np.where(covered, height, np.inf)))
        np.testing.assert_array_equal(found[covered], height[covered])
        free = ~(covered[1:] | covered[:-1])
        assert np.abs(np.diff(found))[free].max(initial=0.0) <= RAMP + 1e-12
        assert np.sum(found) == pytest.approx(np.sum(height), abs=1e-13)


@pytest.mark.slow  # of compiling
class TestPrints:
    @given(SOLES, st.lists(st.floats(-0.05, 0.08), min_size=1, max_size=6), st.floats(-3.0, 3.0))
    def test_area_is_conserved_and_no_free_slope_is_beyond_repose(self, foot, heights, x):
        sand = stamps(foot, [*heights, 1.0, 1.0], x)
        moved = PRINTS.cell * sand.height.sum(axis=1) + sand.beside
        np.testing.assert_allclose(moved, 0.0, rtol=0, atol=1e-15)
        assert np.abs(np.diff(sand.height[-1])).max() <= RAMP + 1e-12
        np.testing.assert_array_equal(sand.height[-1], sand.height[-2])  # at rest it stays as it is

    def test_a_print_is_as_deep_as_the_sole_went_and_has_a_rim_at_both_ends(self):
        sand = stamps(fo.Foot.flat(), [0.04, 0.01, 0.04])
        inside = np.abs(sand.x) < 0.1
        bottom = fo.Foot.flat().contour[0, 1] + 0.01
        np.testing.assert_allclose(sand.height[1][inside], bottom, atol=1e-12)
        left, right = (sand.height[-1][side].max() for side in (sand.x < -0.1, sand.x > 0.1))
        assert left > 0.002
        assert right > 0.002

    def test_the_second_step_on_the_same_place_meets_less_force(self):
        """The foot feels nothing of its print while it makes it, and all of it when it comes back."""
        foot = fo.Foot.flat()
        once = [0.02, 0.015, 0.01]
        sand = stamps(foot, [*once, 1.0, *once])
        plates, none = foot.plates(64, directed=True), np.zeros((1, 2))

        def lift(sample, z):
            pose = fo.gait.Pose(none, np.array([[z, 10.0]]), none, none, none, none)
            down = np.array([[0.0, -1.0]])
            level = sand.level[sample : sample + 1]
            return plate_states(plates, pose, none, down, fo.Scene(), 1e-4, level=level).total[0, 0, 1]

        np.testing.assert_array_equal(sand.level[:3, 0], 0.0)
        first, second = (np.array([lift(n + i, z) for i, z in enumerate(once)]) for n in (0, 4))
        assert (second < 0.2 * first).all()

    def test_a_foot_that_leaves_its_heap_for_a_moment_does_not_come_down_on_it(self):
        """Else the length of a step would decide whether it ploughs its own heap or rides on it."""
        foot, plates = fo.Foot.flat(), sole(fo.Foot.flat().plates(64))
        bottom = -float(foot.contour[0, 1])
        heights = [*[bottom - 0.02] * 20, bottom + 0.001, bottom - 0.02]
        poses = np.array([[pose_of(z, 0.0, 0.0), SKY] for z in (bottom + 0.05, *heights)])
        motions = np.zeros((len(poses), 4))
        motions[:, 0], motions[:, 2] = 0.005 * np.arange(len(poses)), 1.0
        sand = moved_sand(PRINTS, plates, poses, motions, np.arange(len(heights)))
        assert sand.height[-2].max() > 0.02
        assert np.abs(sand.level[-1, 0]).max() < 0.3 * sand.height[-2].max()


@pytest.fixture(scope="module")
def printing(scene, ramp_foot):
    return fo.simulate(ramp_foot, replace(scene, effects=(ON,)), SAME)


@pytest.mark.slow  # of compiling
class TestWalks:
    def test_area_is_conserved_over_a_walk(self, printing):
        sand = printing.sand(np.arange(len(printing.t)))
        moved = ON.cell * sand.height.sum(axis=1) + sand.beside
        assert np.abs(sand.height).sum() > 1.0
        np.testing.assert_allclose(moved, 0.0, rtol=0, atol=1e-10)

    @pytest.mark.parametrize("name", ["soft", "regular", "hard"])
    def test_area_is_conserved_over_the_walks_of_a_hundred_random_feet(self, name):
        scene = fo.Scene(sand=fo.Sand.named(name), effects=(ON,))
        for k in fo.Waypoints().random(100, seed=5, inside=True):
            walk = fo.simulate(fo.Foot.from_waypoints(k), scene)
            sand = walk.sand([len(walk.t) // 2, len(walk.t) - 1])
            moved = ON.cell * sand.height.sum(axis=1) + sand.beside
            np.testing.assert_allclose(moved, 0.0, rtol=0, atol=1e-10)

    def test_plates_below_the_sand_that_was_moved_add_up_to_the_feet(self, printing):
        """What is made again from the trace is what the walk was compiled with."""
        error = np.abs(printing.plates(np.arange(len(printing.t))).total - printing.force)
        assert np.quantile(error, 0.999) < NEWTON * np.abs(printing.force).max()
        assert error.max() < 3.0 * NEWTON * np.abs(printing.force).max()

    def test_momentum_is_the_impulse_of_sand_and_gravity(self, printing):
        np.testing.assert_allclose(momentum_gap(printing), 0.0, rtol=0, atol=1e-9)

    def test_a_walk_is_the_same_as_without_until_a_foot_meets_moved_sand(self, printing):
        walk = fo.simulate(printing.foot, replace(printing.scene, effects=()), SAME)
        index = np.arange(len(printing.t))
        states = printing.plates(index)
        level = printing.sand(index).level
        meets = ((level != 0.0) & (states.position[..., 1] < np.maximum(level, 0.0))).any(axis=(1, 2))
        first = int(np.argmax(meets))
        assert first > 20
        np.testing.assert_allclose(printing.com[:first], walk.com[:first], rtol=0, atol=1e-6)
        assert printing.objectives["work"] != pytest.approx(walk.objectives["work"], rel=1e-6)

    def test_a_design_does_not_depend_on_batch_place_or_threads(self, regular):
        scene, k = replace(regular, effects=(ON,)), fo.Waypoints().random(40, seed=2, inside=True)
        one = fo.evaluate(k, scene, "draft", threads=1)
        assert one.feasible.all()
        np.testing.assert_array_equal(fo.evaluate(k, scene, "draft", threads=3).raw, one.raw)
        np.testing.assert_array_equal(fo.evaluate(k[::-1], scene, "draft").raw, one.raw[::-1])
        np.testing.assert_array_equal(fo.evaluate(k[17], scene, "draft").raw[0], one.raw[17])

    def test_the_field_grows_with_the_way(self, ramp_foot):
        walk = fo.simulate(ramp_foot, fo.Scene(t_f=12.0, effects=(ON,)), "draft")
        sand = walk.sand([len(walk.t) - 1])
        assert walk.objectives["distance"] > 8.0
        prints = sand.x[sand.height[0] < -0.005]
        assert prints.min() < 0.2
        assert prints.max() > 7.0
        assert ON.cell * sand.height.sum() + sand.beside[0] == pytest.approx(0.0, abs=1e-10)

    def test_shorter_steps_and_narrower_cells_change_less_and_less(self, ramp_foot):
        def at(dt, cell):
            scene = fo.Scene(sand=fo.Sand.named("regular"), effects=(fo.Footprints(cell=cell),))
            found = fo.simulate(ramp_foot, scene, fo.Accuracy(dt=dt, plates=256)).objectives
            return np.array([found[name] for name in ("distance", "mean_height", "work")])

        converged = at(2.5e-4, 1.25e-3)
        errors = [np.abs(at(dt, cell) / converged - 1.0).max() for dt, cell in ((4e-3, 1e-2), (1e-3, 2.5e-3))]
        assert errors[1] < 0.5 * errors[0]
        assert errors[1] < 0.02

    def test_with_every_other_effect_plates_add_up_and_area_is_conserved(self, ramp_foot):
        scene = fo.Scene(sand=fo.Sand.named("regular"), effects=(*ALL, ON))
        walk = fo.simulate(replace(ramp_foot, closed=True), scene, fo.Accuracy(dt=1e-3, control=1.0))
        assert walk.feasible
        index = np.arange(len(walk.t))
        error = np.abs(walk.plates(index).total - walk.force).max(axis=(1, 2)) / np.abs(walk.force).max()
        assert np.quantile(error, 0.99) < NEWTON
        sand = walk.sand(index)
        np.testing.assert_allclose(ON.cell * sand.height.sum(axis=1) + sand.beside, 0.0, rtol=0, atol=1e-10)

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
        ground = level_ground(0.05, -20, 60, 40, 0.1, 1.0)
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
        ("name", "value"), [("repose", 0.0), ("repose", math.nan), ("cell", 0.0), ("cell", 0.1)]
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
        uphill = prints_of((fo.Slope(10.0), ON))
        assert math.degrees(math.atan(uphill.rise / ON.cell)) == pytest.approx(20.0)
        assert math.degrees(math.atan(uphill.fall / ON.cell)) == pytest.approx(40.0)

    def test_steps_far_apart_have_no_part_in_each_other_and_those_on_one_spot_all(self):
        scale = Scale(stress=1.0, pull=0.0, depth=0.02, speed=1.0, distance=2.0, length=0.26)
        assert ON.estimate(scale._replace(step=1.0)) == 0.0
        assert 0.0 < ON.estimate(scale._replace(step=0.3)) < ON.estimate(scale._replace(step=0.26))
        assert ON.estimate(scale._replace(step=0.0)) == 1.0
