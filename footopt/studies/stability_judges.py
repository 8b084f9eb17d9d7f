"""How study=stability judges: trials, measures, their limits, and one judge for each kind of case.

The judge is physics, not looks: energy is accounted for, the sand gives none beyond what smoothing
allows, who stands still stays, and a converged walk says what the right answer is.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.effects import Rest
from footopt.effects.rest import rest_length
from footopt.foot import Foot
from footopt.walk import FIVE, Accuracy, Scene, Walk, simulate
from footopt.walk.balances import energy_gap, power_from_sand, set_down_speed, sinking_speed, smoothing_power
from footopt.walk.objectives import FLOORS

# Limits, each with its reason; none depends on the stepper.
CHATTER = 1e-3  # of the weight: what a force plate resolves; the trapped state has none at all
YIELDING = 3.0  # in units of what the smoothed law itself yields, good to a factor for any sole
ENERGY = 0.05  # of |W|: half of the error that is allowed to results
ERROR = 0.1  # relative, of a result against the converged walk: beyond it the walk is another one
REST = 1e-6  # m, by which who stands may move in half a minute: a thousandth of a grain
PLACE = 1e-4  # m, by which the time step and delta, or the creep speed, may choose where he stands
DRIFT = 1e-3  # relative: a periodic gait forgets its start in a few strides, then nothing changes
LIMITS = {
    "chatter": CHATTER, "yielding": YIELDING, "energy": ENERGY, "error": ERROR, "drift": DRIFT, "rest": REST,
    "place": PLACE,
}  # fmt: skip
UNJUDGED = math.inf


@dataclass(frozen=True)
class Setup:
    """What is walked: a foot through a scene at an accuracy."""

    foot: Foot
    scene: Scene
    accuracy: Accuracy


class Measure(NamedTuple):
    """One number about a trial, stable within its limit; an infinite limit: recorded and not judged."""

    name: str
    value: float
    limit: float

    @property
    def ratio(self) -> float:
        """Value over limit; infinite for a value that is not a number."""
        if self.limit == UNJUDGED:
            return 0.0
        if not math.isfinite(self.value):
            return math.inf
        if self.limit == 0.0:
            return 0.0 if self.value == 0.0 else math.inf
        return self.value / self.limit


@dataclass(frozen=True)
class Trial:
    """One case with one stepper; walks are simulated when a judge asks for them."""

    setup: Setup
    converged: Callable[[], Walk]

    @cached_property
    def walk(self) -> Walk:
        """The walk by the trial's stepper."""
        return simulate(self.setup.foot, self.setup.scene, self.setup.accuracy)


def judge_walk(trial: Trial) -> list[Measure]:
    """A walk: right against the converged one, energy accounted for, none from the sand."""
    walk, truth = trial.walk, trial.converged()
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    errors = {}
    for name in FIVE:
        exact = truth.objectives[name]
        errors[name] = abs(walk.objectives[name] - exact) / max(abs(exact), FLOORS.get(name, 1e-3))
    peak = errors.pop("peak_power")  # on its own: an impact may be shorter than a step
    return [*_sound(walk), Measure("error", max(errors.values()), ERROR), Measure("peak", peak, ERROR)]


def judge_set_down(trial: Trial) -> list[Measure]:
    """As `judge_walk`, with the speed at which feet are set down, m/s, as the case finds it."""
    return [*judge_walk(trial), Measure("set down", set_down_speed(trial.converged()), UNJUDGED)]


def judge_standing(trial: Trial) -> list[Measure]:
    """Standing still: in the second half nothing moves, and the sand carries exactly the weight.

    Where the converged walker sinks, the right answer is that he sinks.
    """
    walk, truth = trial.walk, trial.converged()
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    late, weight = _late(walk), _weight(walk)
    speed = sinking_speed(walk, 0.5 * walk.t[-1])
    crept = speed * 0.5 * walk.t[-1]
    com, work = walk.com[late], walk.work[late].sum(axis=1)
    return [
        *_carried(walk),
        Measure("speed", float(np.hypot(*walk.velocity[late].T).max() / speed), YIELDING),
        Measure("drift", float(np.hypot(*(com[-1] - com[0])) / crept), YIELDING),
        Measure("work", float(abs(work[-1] - work[0]) / (weight * crept)), YIELDING),
    ]


def judge_rest(trial: Trial) -> list[Measure]:
    """Standing still: in the second half nothing moves, and numerics do not choose the place."""
    walk, truth = trial.walk, trial.converged()
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    setup, com = trial.setup, walk.com[_late(walk)]
    length = rest_length(setup.scene.effects)
    effects = tuple(Rest(length / 10.0) if isinstance(e, Rest) else e for e in setup.scene.effects if length)
    accuracy = setup.accuracy if length else replace(setup.accuracy, creep=setup.accuracy.creep / 10.0)
    finer = simulate(setup.foot, replace(setup.scene, effects=effects or setup.scene.effects), accuracy)
    places = [float(np.hypot(*(com[-1] - other.com[-1]))) for other in (truth, finer) if len(other.t)]
    return [
        *_carried(walk),
        Measure("rest", float(np.hypot(*np.ptp(com, axis=0))), REST),
        Measure("place", max(places), PLACE),
    ]


def judge_long_walk(trial: Trial) -> list[Measure]:
    """Ten minutes: the last minute is as fast as the second, and energy is accounted for."""
    walk = trial.walk
    if walk.reason:
        return [outcome(walk, "")]
    x = np.interp([60.0, 120.0, walk.t[-1] - 60.0, walk.t[-1]], walk.t, walk.com[:, 0])
    second, last = (x[1] - x[0]) / 60.0, (x[3] - x[2]) / 60.0
    return [*_sound(walk), Measure("slowing", float(abs(last / second - 1.0)), DRIFT)]


def judge_sunk(trial: Trial) -> list[Measure]:
    """Sand that cannot carry the walker: the walk is infeasible, and the reason is that he sank."""
    return [outcome(trial.walk, "sunk")]


def outcome(walk: Walk, expected: str) -> Measure:
    """0 if a walk ended as expected ("": well), 1 if not."""
    return Measure(walk.reason or "no failure", float(walk.reason != expected), 0.0)


def _sound(walk: Walk) -> list[Measure]:
    """What holds for every walk: all steps are finite, energy adds up, the sand gives none.

    What bristles give back they have stored: of them the energy balance is asked, and the power is told.
    """
    allowed = smoothing_power(walk.scene.sand.stress_map)
    missing = 1.0 - walk.t[-1] / walk.scene.duration  # a trace ends where it is no longer finite
    return [
        Measure("not finite", float(missing) if missing > 1e-9 else 0.0, 0.0),
        Measure("energy", energy_gap(walk), ENERGY),
        Measure("power", power_from_sand(walk), UNJUDGED if rest_length(walk.scene.effects) else allowed),
    ]


def _late(walk: Walk) -> NDArray[np.bool_]:
    """The second half of a walk."""
    return np.asarray(walk.t > 0.5 * walk.t[-1])


def _weight(walk: Walk) -> float:
    """The part of the weight that presses on the sand, N."""
    return walk.scene.walker.mass * walk.scene.gravity[1]


def _carried(walk: Walk) -> list[Measure]:
    """As `_sound`, and in the second half the sand carries exactly the weight, without chatter."""
    force = walk.force[_late(walk), :, 1].sum(axis=1) / _weight(walk)
    return [
        *_sound(walk),
        Measure("chatter", float(force.std()), CHATTER),
        Measure("load", float(abs(force.mean() - 1.0)), CHATTER),
    ]
