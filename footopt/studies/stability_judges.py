"""How study=stability judges: measures, their limits, and one judge for each kind of case.

The judge is physics, not looks: energy is accounted for, the sand gives none beyond what smoothing
allows, a walker that stands still stays, and a converged walk says what the right answer is. A judge takes
the walk and a function that simulates the converged one, and returns its measures.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.effects import bristle_length
from footopt.walk import FIVE, Walk, simulate
from footopt.walk.balances import energy_gap, power_from_sand, sinking_speed, smoothing_power
from footopt.walk.objectives import FLOORS

#: Each with its reason; none depends on the stepper.
LIMITS = {
    "chatter": 1e-3,  # of the weight: what a force plate resolves; the trapped state has none at all
    "yielding": 3.0,  # in units of what the smoothed law itself yields, good to a factor for any sole
    "energy": 0.05,  # of |W|: half of the error that is allowed to results
    "error": 0.1,  # relative, of a result against the converged walk: beyond it the walk is another one
    "drift": 1e-3,  # relative: a periodic gait forgets its start in a few strides, then nothing changes
    "rest": 1e-6,  # m, of motion in half a minute of standing: a thousandth of a grain
    "place": 1e-4,  # m, by which the time step and delta, or the creep speed, may choose where it stands
}


class Measure(NamedTuple):
    """One number about a walk, stable within its limit."""

    name: str
    value: float
    limit: float

    @property
    def ratio(self) -> float:
        """Value over limit; infinite for a value that is not a number."""
        if not math.isfinite(self.value):
            return math.inf
        if self.limit == 0.0:
            return 0.0 if self.value == 0.0 else math.inf
        return self.value / self.limit


Converged = Callable[[], Walk]
Judge = Callable[[Walk, Converged], list[Measure]]


def judge_walk(walk: Walk, converged: Converged) -> list[Measure]:
    """A walk: right against the converged one, energy accounted for, none from the sand."""
    truth = converged()
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    errors = {}
    for name in FIVE:
        exact = truth.objectives[name]
        errors[name] = abs(walk.objectives[name] - exact) / max(abs(exact), FLOORS.get(name, 1e-3))
    peak = errors.pop("peak_power")  # on its own: an impact may be shorter than a step
    limit = LIMITS["error"]
    return [*_sound(walk), Measure("error", max(errors.values()), limit), Measure("peak", peak, limit)]


def judge_standing(walk: Walk, converged: Converged) -> list[Measure]:
    """Standing still: in the second half nothing moves, and the sand carries exactly the weight.

    Where the converged walker sinks, the right answer is that it sinks.
    """
    truth = converged()
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    late, limit = _late(walk), LIMITS["yielding"]
    speed = sinking_speed(walk, 0.5 * walk.t[-1])
    crept = speed * 0.5 * walk.t[-1]
    com, work = walk.com[late], walk.work[late].sum(axis=1)
    return [
        *_carried(walk),
        Measure("speed", float(np.hypot(*walk.velocity[late].T).max() / speed), limit),
        Measure("drift", float(np.hypot(*(com[-1] - com[0])) / crept), limit),
        Measure("work", float(abs(work[-1] - work[0]) / (_weight(walk) * crept)), limit),
    ]


def judge_rest(walk: Walk, converged: Converged) -> list[Measure]:
    """Standing still: in the second half nothing moves, and numerics do not choose the place."""
    truth, scene, accuracy = converged(), walk.scene, walk.accuracy
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    if bristle_length(scene.effects):
        shorter = (_shortened(e) if e.bristle_length else e for e in scene.effects)
        scene = replace(scene, effects=tuple(shorter))
    else:
        accuracy = replace(accuracy, creep=accuracy.creep / 10.0)
    finer, com = simulate(walk.foot, scene, accuracy), walk.com[_late(walk)]
    places = [float(np.hypot(*(com[-1] - other.com[-1]))) for other in (truth, finer) if len(other.t)]
    return [
        *_carried(walk),
        Measure("rest", float(np.hypot(*np.ptp(com, axis=0))), LIMITS["rest"]),
        Measure("place", max(places), LIMITS["place"]),
    ]


def _shortened(effect: Any) -> Any:
    """An effect whose bristles are a tenth as long."""
    return replace(effect, length=effect.length / 10.0)


def judge_long_walk(walk: Walk, converged: Converged) -> list[Measure]:
    """Ten minutes: the last minute is as fast as the second, and energy is accounted for."""
    if walk.reason:
        return [outcome(walk, "")]
    x = np.interp([60.0, 120.0, walk.t[-1] - 60.0, walk.t[-1]], walk.t, walk.com[:, 0])
    return [
        *_sound(walk),
        Measure("slowing", float(abs((x[3] - x[2]) / (x[1] - x[0]) - 1.0)), LIMITS["drift"]),
    ]


def judge_sunk(walk: Walk, converged: Converged) -> list[Measure]:
    """Sand that cannot carry the walker: the walk is infeasible, because it sank."""
    return [outcome(walk, "sunk")]


def outcome(walk: Walk, expected: str) -> Measure:
    """0 if a walk ended as expected ("": well), 1 if not."""
    return Measure(walk.reason or "no failure", float(walk.reason != expected), 0.0)


def _sound(walk: Walk) -> list[Measure]:
    """What holds for every walk: all steps are finite, energy adds up, the sand gives none.

    What bristles give back they have stored: of them only the energy balance is asked.
    """
    missing = 1.0 - walk.t[-1] / walk.scene.duration  # a trace ends where it is no longer finite
    found = [
        Measure("not finite", float(missing) if missing > 1e-9 else 0.0, 0.0),
        Measure("energy", energy_gap(walk), LIMITS["energy"]),
    ]
    if not bristle_length(walk.scene.effects):
        allowed = smoothing_power(walk.scene.sand.stress_map)
        found.append(Measure("power", power_from_sand(walk), allowed))
    return found


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
        Measure("chatter", float(force.std()), LIMITS["chatter"]),
        Measure("load", float(abs(force.mean() - 1.0)), LIMITS["chatter"]),
    ]
