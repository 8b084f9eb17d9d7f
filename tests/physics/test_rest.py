"""Bristles: who stands on sand stays where he is, and who walks walks as before."""

import math
import os
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numba import njit

import footopt as fo
from footopt.walk.bristles import transition_speed_of
from footopt.walk.contact import contact
from footopt.walk.discretize import sole_of
from footopt.walk.state import COUNTS, Motion

STILL = fo.Gait.human(start=math.inf)
DRIFT = 1e-6  # m, in a minute of standing
PLACE = 1e-4  # m, by which numerics may move where he comes to rest


def standing(zeta, *effects, t_f=60.0):
    """A walker who stands on sand that remembers."""
    return fo.Scene(sand=fo.Sand(zeta), gait=STILL, t_f=t_f, effects=(fo.Rest(), *effects))


def drift(walk):
    """How far the hip moves in the second half, m."""
    late = walk.com[walk.t > 0.5 * walk.t[-1]]
    return float(np.hypot(*np.ptp(late, axis=0)))


@pytest.mark.slow  # of compiling
@pytest.mark.parametrize("zeta", [0.2, 5.0, 500.0])
def test_who_stands_for_a_minute_stays(zeta, ramp_foot):
    walk = fo.simulate(ramp_foot, standing(zeta))
    weight = walk.scene.walker.weight
    assert walk.feasible
    assert drift(walk) < DRIFT
    np.testing.assert_allclose(walk.force[-1].sum(axis=0), [0.0, weight], rtol=0, atol=1e-6 * weight)


@pytest.mark.slow  # of compiling
@pytest.mark.parametrize(("zeta", "slope"), [(0.2, 0.0), (5.0, 15.0)])
def test_accuracies_time_steps_and_delta_put_the_walker_in_one_place(zeta, slope, ramp_foot):
    tilt, by_hand = fo.Slope(slope), fo.Accuracy(dt=1e-2, plates=56)
    numerics = [("draft", 1e-6), ("standard", 1e-6), ("fine", 1e-6), (by_hand, 1e-6), (by_hand, 1e-7),
                (fo.Accuracy("implicit_euler", dt=1e-3, plates=56), 1e-6)]  # fmt: skip
    places, scene = [], standing(zeta, t_f=20.0)
    for accuracy, delta in numerics:
        walk = fo.simulate(ramp_foot, replace(scene, effects=(fo.Rest(delta), tilt)), accuracy)
        assert walk.feasible
        assert drift(walk) < DRIFT
        carries = walk.scene.walker.mass * walk.scene.gravity[1]
        assert walk.force[-1, :, 1].sum() == pytest.approx(carries, rel=1e-6)
        places.append(walk.com[-1])
    assert np.hypot(*np.ptp(places, axis=0)) < PLACE


def test_without_bristles_he_sinks_by_more_than_a_millimetre(ramp_foot):
    plain = replace(standing(5.0), effects=())
    assert drift(fo.simulate(ramp_foot, plain, fo.Accuracy(creep=1e-4))) > 1e-3


@pytest.mark.slow  # of compiling
def test_the_first_instant_carries_the_weight(flat_foot):
    walk = fo.simulate(flat_foot, standing(1.0, t_f=0.1))
    assert walk.force[0, :, 1].sum() == pytest.approx(walk.scene.walker.weight, rel=1e-3)
    assert np.abs(walk.com - walk.start).max() < DRIFT


@pytest.mark.parametrize("accuracy", ["standard", fo.Accuracy("implicit_euler", 5e-3, 56)], ids=["", "euler"])
def test_bristles_stay_in_the_unit_disc_and_sand_forgets_a_foot_that_has_left(ramp_foot, accuracy):
    walk = fo.simulate(ramp_foot, fo.Scene(effects=(fo.Rest(),)), accuracy)
    states = walk.plates(np.arange(len(walk.t)))
    assert 1.0 + 1e-6 > np.linalg.norm(walk.bristles, axis=-1).max() > 0.9
    assert (walk.bristles[states.position[..., 1] > 0.0] == 0.0).all()


@njit(error_model="numpy")
def felt(world, soles, poses, hip, transition_speed, stage, before, counts):
    return contact(world, soles, poses, hip, transition_speed, stage, before, counts)


@pytest.mark.slow  # of compiling
def test_the_force_has_its_analytic_derivative_where_plates_stick_and_where_they_slide(ramp_foot):
    """dF/dv of an implicit stage, against differences; the stage is 1 ms, so that 1 mm/s bends by delta."""
    plates = ramp_foot.plates(40)
    constants = fo.Scene(effects=(fo.Rest(), fo.LeadingEdge())).constants(fo.Accuracy())
    poses = np.zeros((2, 7))
    poses[:, 4], poses[0, 1], poses[1, 1], poses[0, 6] = 1.0, -0.02, 1.0, 1e-3
    before = np.random.default_rng(2).uniform(-0.6, 0.6, (2, 2, sole_of(plates).plates.shape[1]))
    stage, counts = 1e-3, np.zeros(1, COUNTS)[0]

    def left(vx, vz):
        hip = Motion(stage * vx, stage * vz, vx, vz)
        transition_speed = transition_speed_of(constants.bristle_length, constants, stage)
        return felt(constants, sole_of(plates), poses, hip, transition_speed, stage, before, counts).left

    for vx, vz in ((2e-4, -1e-4), (5e-3, -0.02)):
        here, d = left(vx, vz), 1e-9
        slopes = [
            (np.array(left(vx + d * i, vz + d * j)[:2]) - left(vx - d * i, vz - d * j)[:2]) / (2 * d)
            for i, j in ((1, 0), (0, 1))
        ]
        expected = [here.xx, here.zx, here.xz, here.zz]
        size = np.abs(expected).max()
        np.testing.assert_allclose(np.concatenate(slopes), expected, rtol=0, atol=2e-4 * size)


@pytest.mark.slow
@pytest.mark.parametrize("scene", range(int(os.environ.get("FOOTOPT_SCENES", 6))))
def test_any_walker_rests_on_any_sand(scene):
    """Soles, sands, walkers, slopes and time steps at random; FOOTOPT_SCENES=300 tries more."""
    rng = np.random.default_rng([2026, scene])
    zeta, mass = np.exp(rng.uniform(np.log([0.05, 2.0]), np.log([500.0, 200.0])))
    walker = fo.Walker(mass=mass, g=rng.choice([1.62, 3.71, 9.81]))
    foot = fo.Foot.from_waypoints(fo.Waypoints().random(1, scene, inside=True)[0])
    tilt, dt = fo.Slope(rng.uniform(-18.0, 18.0)), rng.choice([1e-2, 5e-3, 1e-3])
    coarse, fine = (
        fo.simulate(
            foot,
            replace(standing(zeta), walker=walker, effects=(fo.Rest(length), tilt)),
            fo.Accuracy(dt=step, plates=56),
        )
        for step, length in ((dt, 1e-6), (dt / 3.0, 1e-7))
    )
    assert coarse.reason == fine.reason
    if coarse.feasible:  # the softest sands carry nobody
        assert drift(coarse) < DRIFT
        assert np.hypot(*(coarse.com[-1] - fine.com[-1])) < PLACE


@pytest.mark.slow
def test_walks_converge_whether_or_not_steps_resolve_the_bristles():
    """A level foot that sticks to hard sand. Undamped bristles vibrated: 0.8 % off in steps above 1e-5 s."""
    human = fo.Gait.human()
    gait = replace(human, foot=type(human.thigh)(0.0, (0.0,), (0.0,)), pitch="measured", period=0.8)
    walker = fo.Walker(mass=68.0, l1=0.16, l2=0.16)
    scene = fo.Scene(fo.Sand(340.0), gait, walker, t_f=2.0, effects=(fo.Rest(),))
    feet = fo.Waypoints(L=0.04).random(2, seed=3)
    found = [fo.evaluate(feet, scene, fo.Accuracy(dt=dt, plates=96)).values for dt in (5e-4, 1e-4, 1e-5)]
    off = [np.abs(values / found[-1] - 1.0).max() for values in found]
    assert off[0] < 2e-3
    assert off[1] < 2e-4


@pytest.mark.slow
def test_a_slope_holds_up_to_the_laws_own_limit(flat_foot):
    """A level sole slides for ever beyond the slope whose tangent is its drag over its lift."""
    limit = math.degrees(math.atan(0.136 / 0.375))  # of the generic map
    speeds = {}
    for angle in (limit - 0.1, limit + 0.1):
        walk = fo.simulate(flat_foot, standing(5.0, fo.Slope(angle), t_f=120.0), fo.Accuracy(dt=1e-2))
        speeds[angle] = np.hypot(*walk.velocity[-1])
    assert speeds[limit - 0.1] < 1e-9
    assert speeds[limit + 0.1] > 1.0


@dataclass(frozen=True)
class Pausing(fo.Gait):
    """A gait that stands still for ten seconds in the middle of a stride, from `at` on."""

    at: float = 1.5
    ease: float = 0.2  # s, of slowing down and of speeding up

    def pose(self, t, l1, l2):
        """The poses of a clock that slows down, stops and goes on."""
        t = np.asarray(t, float)
        knots = self.at + np.array([0.0, self.ease, 10.0 + self.ease, 10.0 + 2.0 * self.ease])
        rate = np.interp(t, knots, [1.0, 0.0, 0.0, 1.0])
        s = np.clip((t[:, None] - knots[[0, 2]]) / self.ease, 0.0, 1.0)
        passed = np.minimum(t, self.at) + self.ease * (s[:, 0] - 0.5 * s[:, 0] ** 2 + 0.5 * s[:, 1] ** 2)
        passed += np.maximum(t - knots[3], 0.0)
        pose = super().pose(passed, l1, l2)
        turned = {name: getattr(pose, name) * rate[:, None] for name in ("vx", "vz", "rate")}
        return pose._replace(**turned)


@pytest.mark.slow
@pytest.mark.parametrize("sand", ["soft", "regular", "hard"])
def test_who_stops_for_ten_seconds_stays_and_walks_on(sand, ramp_foot):
    human = fo.Gait.human()
    fields = {name: getattr(human, name) for name in human.__dataclass_fields__}
    scene = fo.Scene(sand=fo.Sand.named(sand), gait=Pausing(**fields), t_f=14.0, effects=(fo.Rest(),))
    walk = fo.simulate(ramp_foot, scene)
    assert walk.feasible
    still = (walk.t > 4.0) & (walk.t < 11.6)
    assert np.ptp(walk.com[still], axis=0).max() < DRIFT
    assert np.abs(np.diff(walk.force[still], axis=0)).max() < 1e-6 * walk.scene.walker.weight
    assert walk.com[-1, 0] > walk.com[still][-1, 0] + 0.5


@pytest.mark.slow
@pytest.mark.parametrize("sand", ["soft", "regular", "hard"])
def test_walks_change_by_less_than_standard_promises(sand):
    """delta is a numerical length: 95 % of the feet's objectives stay within 0.5 %."""
    plain, feet = fo.Scene(sand=fo.Sand.named(sand)), fo.Waypoints().random(20, 11, inside=True)
    remembering = replace(plain, effects=(fo.Rest(),))
    with_, without = (fo.evaluate(feet, scene, "fine").values for scene in (remembering, plain))
    assert np.percentile(np.abs(with_ / without - 1.0), 95.0, axis=0).max() < 5e-3


@pytest.mark.slow  # of compiling
def test_plates_add_up_to_the_force(ramp_foot):
    scene = fo.Scene(effects=(fo.Rest(),))
    whole = fo.simulate(ramp_foot, scene)
    added = whole.plates(np.arange(len(whole.t))).force.sum(axis=2) - whole.force
    assert np.abs(added).max() < 1e-3 * scene.walker.weight
