"""Scenes that once were walked wrongly without a word: now right, and their estimates say how right."""

from dataclasses import replace

import numpy as np
import pytest
from random_scenes import draw, judge

import footopt as fo
from footopt.walk.checks import diagnose
from footopt.walk.resolution import estimate_error


def soles(n=11, count=1):
    """Flat, and at random."""
    heights = np.random.default_rng(n).integers(1, 11, (count, n))
    return [fo.Foot.from_waypoints([10] * n), *map(fo.Foot.from_waypoints, heights)]


def walk_on(zeta, *effects, **scene):
    """A walk on a sand."""
    return fo.Scene(sand=fo.Sand(zeta), effects=effects, **scene)


def measured(zeta, mass, g, *effects):
    """A walk on a sand and planet, the foot's pitch as measured, by the strides of similar walks."""
    gait = replace(fo.Gait.human(), pitch="measured", period=1.2 * (9.81 / g) ** 0.5)
    return walk_on(zeta, *effects, gait=gait, walker=fo.Walker(mass, g=g))


def waves(n=40):
    """Soles of half a sine wave to three halves."""
    phase = np.linspace(0.0, np.pi, n)
    heights = (np.rint(5.5 + 4.5 * np.sin(halves * phase)).astype(int) for halves in (1, 2, 3))
    return [fo.Foot.from_waypoints(k, fo.Waypoints(n=n)) for k in heights]


def scan(points=6296):
    """A sole with noise that is finer than any plate."""
    x = np.linspace(-0.13, 0.13, points)
    z = -0.02 + 0.01 * np.cos(2 * np.pi * x / 0.13) + 1e-4 * np.random.default_rng(1).standard_normal(points)
    return [fo.Foot(np.stack([x, z], axis=1))]


def drawn(number, foot):
    """A foot of a random scene."""
    found = draw(number)
    return [found.foot(foot)], found.scene


STEP = fo.Patches((0.5,), (9.0,), (10.0,), blur=1e-4)

#: Feet and scene.
CASES = {
    "a level slab on zeta 200": (soles(), walk_on(200.0)),
    "20 us behind the heel strike": (soles(), walk_on(5.0, t_f=1.10002)),
    "leading edge on hard sand": (soles(), walk_on(5.0, fo.LeadingEdge())),
    "smooth soles of 40 on the Moon": (
        waves(),
        measured(161.0, 50.0, 1.62, fo.LeadingEdge(), fo.Shadowing()),
    ),
    "a comb of 49 under 8 kg": (
        [fo.Foot.from_waypoints([1, 6] * 24 + [1], fo.Waypoints(n=49))],
        measured(353.0, 8.0, 9.81, fo.LeadingEdge()),
    ),
    "a cliff on Mars": (soles(), measured(233.0, 60.0, 3.71, STEP, fo.LeadingEdge(), fo.Inertia())),
    "a scan on soft sand": (scan(), walk_on(0.43)),
    "a layer under 5 waypoints": drawn(17009, 1),
    "a patch on zeta 151": drawn(17081, 1),
    "grooves that trail": drawn(17040, 1),
    "a level shape with all effects": drawn(18007, 1),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_estimate_holds_the_error(name):
    feet, scene = CASES[name]
    for one in judge(feet, scene):
        assert one.reason == one.truth == ""
        assert one.error.max() <= max(one.estimate.max(), 2e-4)  # a 25th of the tolerance
        assert one.error.max() <= 0.005


@pytest.mark.parametrize("foot", [0, 1])
def test_a_power_that_jumps_is_not_overshot(foot):
    """By a step of Newton's method that ends in a jump, or by a parabola through one, wherever steps end."""
    (sole,), scene = drawn(17017, foot)
    peaks = [
        fo.simulate(sole, scene, fo.Accuracy(dt=dt, plates=96, creep=1.8206e-4, control=5.6895e-5)).objectives
        for dt in (3e-4, *np.linspace(2.585e-3, 3.16e-3, 13))
    ]
    for one in peaks[1:]:
        assert one["peak_power"] == pytest.approx(peaks[0]["peak_power"], rel=1.5e-3)


def test_a_sand_that_gives_energy_is_warned_of_and_its_walks_have_no_estimate():
    """Some feet walk backwards by some numbers and forwards by others."""
    rough = fo.Accuracy(dt=0.01, plates=56, control=2e-3)
    good = fo.Accuracy(dt=0.01, plates=192, creep=2e-5, control=1e-4)
    giving = replace(fo.StressMap(), C01=-0.256)
    assert giving.dissipation() < -0.4
    scene, feet = fo.Scene(sand=fo.Sand(5.0, giving)), soles(11, 3)
    coarse, fine = (fo.evaluate(feet, scene, one) for one in (rough, good))
    other = np.flatnonzero(coarse.reasons != fine.reasons)
    assert len(other) > 0
    assert {*coarse.reasons[other], *fine.reasons[other]} == {"backward", ""}
    for i in other:
        assert np.isnan(list(estimate_error(feet[i], scene, rough).values())).all()
    (warning,) = (one for one in diagnose(fo.simulate(feet[other[0]], scene, rough)) if "gives" in one.name)
    assert warning.outside
    assert "sand.coefficients" in warning.why
    assert not [one for one in diagnose(fo.simulate(feet[0], walk_on(5.0))) if "gives" in one.name]
