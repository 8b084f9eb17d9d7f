"""Presets are for the paper's walk; another scene, walker or sole gets the numbers that it needs."""

from dataclasses import replace

import numpy as np
import pytest

import footopt as fo
from footopt.errors import SettingError
from footopt.foot.plates import CORNER, arc_and_turns, corners
from footopt.walk.accuracy import PRESETS
from footopt.walk.adapt import EACH, MOST, adapted

STANDARD = PRESETS["standard"]
PAPER = fo.Waypoints()


def comb(teeth, closed=False):
    """A sole of straight sides: two for each tooth."""
    x, z = np.linspace(-0.13, 0.13, 2 * teeth + 1), np.zeros(2 * teeth + 1)
    z[1::2] = -0.02
    return fo.Foot(np.stack([x, z], axis=1), name="comb", closed=closed)


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("sand", ["soft", "regular", "hard"])
def test_the_papers_walk_has_the_presets_own_numbers(name, sand):
    scene = fo.Scene(sand=fo.Sand.named(sand))
    for sole in (PAPER, fo.Foot.flat(), fo.Foot.shape("ellipse"), fo.Foot.shape("reversed_l")):
        assert adapted(PRESETS[name], scene, sole) == replace(PRESETS[name], adapt=False)


def test_numbers_by_hand_are_taken_as_they_are(ramp_foot):
    light = fo.Scene(sand=fo.Sand(500.0), walker=fo.Walker(mass=2.0, l1=0.1, l2=0.1))
    by_hand = fo.Accuracy(plates=24, dt=0.01)
    assert adapted(by_hand, light, PAPER) == by_hand
    walk = fo.simulate(ramp_foot, light)
    assert walk.accuracy != STANDARD
    assert adapted(walk.accuracy, fo.Scene(), PAPER) == walk.accuracy  # so that a walk can be repeated


def test_plates_are_whole_numbers_of_any_kind():
    assert fo.Accuracy(plates=np.int64(24)) == fo.Accuracy(plates=24)
    for plates in (24.0, True, "24"):
        with pytest.raises(SettingError, match=r"accuracy\.plates = .*: must be a whole number"):
            fo.Accuracy(plates=plates)


def test_plates_follow_hardness_and_mass():
    """At least as many for harder sand, and for a lighter walker; a layer counts where feet get to it."""
    zetas, masses = (5.0, 20.0, 100.0, 500.0), (60.0, 10.0, 2.0, 0.5)
    by_zeta = [adapted(STANDARD, fo.Scene(sand=fo.Sand(zeta)), PAPER).plates for zeta in zetas]
    by_mass = [adapted(STANDARD, fo.Scene(walker=fo.Walker(mass=mass)), PAPER).plates for mass in masses]
    for plates in (by_zeta, by_mass):
        assert plates[0] == STANDARD.plates
        assert plates == sorted(set(plates))
    pan, deep = (fo.Scene(effects=(fo.Layers((depth,), (1e6,)),)) for depth in (0.002, 1.0))
    assert adapted(STANDARD, pan, PAPER).plates > 4 * STANDARD.plates
    assert adapted(STANDARD, deep, PAPER).plates == STANDARD.plates
    hard = fo.Scene(sand=fo.Sand(1.0), effects=(fo.Patches((0.5,), (0.6,), (500.0,)),))
    assert adapted(STANDARD, hard, PAPER).plates > STANDARD.plates
    narrow = fo.Patches((0.5, 0.6), (0.501, 0.9), (3.0, 3.0), blur=1e-4)
    assert adapted(STANDARD, fo.Scene(effects=(narrow,)), PAPER).plates >= 260
    absurd = fo.Scene(sand=fo.Sand(1e4), walker=fo.Walker(mass=1e-6))
    assert 16 * STANDARD.plates < adapted(STANDARD, absurd, PAPER).plates <= MOST * STANDARD.plates


@pytest.mark.parametrize("n", [5, 21, 50, 200])
def test_plates_follow_waypoints(n):
    assert adapted(STANDARD, fo.Scene(), fo.Waypoints(n=n)).plates >= EACH * (n - 1)
    foot = fo.Foot.from_waypoints([1, 10] * (n // 2) + [1] * (n % 2))
    assert adapted(STANDARD, fo.Scene(), foot) == adapted(STANDARD, fo.Scene(), fo.Waypoints(n=n))
    drawn = fo.Foot(foot.contour)  # the same sole out of a file
    assert adapted(STANDARD, fo.Scene(), drawn).plates >= min(EACH * (n - 1), 4 * n)


def test_every_tooth_of_a_comb_has_plates_in_the_sand():
    """A level comb under a light walker stands on all of its tips: four plates on each, not eight in all."""
    light, teeth = fo.Scene(sand=fo.Sand(10.0), walker=fo.Walker(mass=3.0)), 10
    plates = comb(teeth).plates(adapted(STANDARD, light, comb(teeth)).plates)
    height, area = plates.z[0] - plates.z[0].min(), plates.area[0]
    depths = np.linspace(0.0, 0.02, 2001)[:, None]
    lift = 1e7 * (np.maximum(depths - height, 0.0) * area).sum(axis=1)  # zeta alpha_z by depth and area
    assert (height < depths[np.argmax(lift >= 3.0 * 9.81)]).sum() >= 4 * teeth


def test_a_smaller_walker_takes_shorter_steps_at_smaller_speeds():
    human, small = fo.Scene(), fo.Scene(gait=fo.Gait.human(period=0.6), walker=fo.Walker(60.0, 0.1, 0.13))
    found = adapted(STANDARD, small, PAPER)
    assert found.dt == pytest.approx(STANDARD.dt / 2)
    assert found.control == pytest.approx(STANDARD.control / 2)  # legs a quarter as long, in half the time
    assert found.creep == pytest.approx(STANDARD.creep / 2)
    slow = replace(human, gait=fo.Gait.human(period=3.0))
    assert adapted(STANDARD, slow, PAPER).dt == STANDARD.dt


@pytest.mark.parametrize(
    ("effects", "times"),
    [((fo.Rest(),), 2), ((fo.Inertia(),), 2), ((fo.LeadingEdge(),), 4), ((fo.LeadingEdge(), fo.Rest()), 4)],
)
def test_effects_of_the_plates_normals_multiply_what_the_sole_needs(effects, times):
    for sole in (PAPER, fo.Waypoints(n=33)):
        plain, finer = (adapted(STANDARD, fo.Scene(effects=some), sole) for some in ((), effects))
        assert finer.plates == pytest.approx(times * plain.plates, abs=8)


def test_a_foot_that_is_kept_level_has_more_plates_and_creeps_less():
    """It strikes with its whole sole at once; standing, it is as level as in walking."""
    human = fo.Gait.human(pitch="measured")
    level = replace(human, foot=type(human.thigh)(0.0, (0.0,), (0.0,)))
    for gait in (level, replace(level, start=np.inf)):
        found = adapted(STANDARD, fo.Scene(sand=fo.Sand(1.0), gait=gait, t_f=2.0), PAPER)
        assert found.plates == 88  # 1.5 times 56, in blocks of eight
        assert (found.creep, found.dt) == (STANDARD.creep / 2, STANDARD.dt / 2)
    resting = fo.Scene(sand=fo.Sand(1.0), gait=level, effects=(fo.Rest(),))
    assert adapted(STANDARD, resting, PAPER).control == STANDARD.control / 32
    assert adapted(STANDARD, fo.Scene(gait=human), PAPER) == replace(STANDARD, adapt=False)


def test_who_hardly_sinks_creeps_little():
    """In a stride by 3 % of the depth to which he sinks, on soft sand by the preset's own speed."""
    for zeta in (1.0, 5.0, 20.0, 100.0, 500.0):
        scene = fo.Scene(sand=fo.Sand(zeta))
        depth, found = scene.scale.depth, adapted(STANDARD, scene, PAPER).creep
        expected = min(STANDARD.creep, 0.03 * depth / scene.gait.period)
        assert found == pytest.approx(max(expected, 0.05 * STANDARD.creep))


def test_feet_with_other_numbers_of_plates_walk_in_one_batch_as_alone(ramp_foot, flat_foot, regular):
    feet = [comb(20), ramp_foot, flat_foot, comb(3)]
    together = fo.evaluate(feet, regular, objectives=("distance", "work", "hollow"))
    alone = [fo.evaluate(foot, regular, objectives=("distance", "work", "hollow")) for foot in feet]
    np.testing.assert_array_equal(together.values, [one.values[0] for one in alone])
    np.testing.assert_array_equal(together.plates, [one.plates[0] for one in alone])


class TestCorners:
    def test_no_plate_lies_around_a_corner(self):
        """Each has one direction: the means of cos and sin of twice the angle are those of one angle."""
        plates = comb(10).plates(100)
        np.testing.assert_allclose(np.hypot(plates.c2, plates.s2), 1.0, atol=1e-12)
        assert plates.area.sum() == pytest.approx(0.1 * np.hypot(*np.diff(comb(10).contour, axis=0).T).sum())

    @pytest.mark.parametrize("plates", [1, 2, 3, 5, 7, 19, 20, 64])
    def test_there_are_as_many_points_as_asked_for(self, plates):
        contour = np.repeat(comb(5).contour, 2, axis=0)  # each point twice
        points = fo.Foot(contour).points(plates, 4)
        assert points.shape == (4 * plates + 1, 2)
        np.testing.assert_allclose(points[[0, -1]], contour[[0, -1]], atol=1e-15)
        if plates >= 20:
            found = {tuple(np.round(p, 9)) for p in points[::4]}
            assert {tuple(np.round(p, 9)) for p in contour[corners(arc_and_turns(contour)[1], 99)]} <= found

    def test_what_turns_less_is_a_curve(self):
        bent = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, np.tan(0.9 * CORNER)]])
        assert len(corners(arc_and_turns(bent)[1], 9)) == 0
        assert len(corners(arc_and_turns(bent * [1.0, 2.0])[1], 9)) == 1
