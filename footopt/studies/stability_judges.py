"""The judge of study=stability: measures of a walk, their limits, and the truth that it is compared with.

The judge is physics, not looks: energy is accounted for, the sand gives none beyond what smoothing allows, a
walker that stands still stays, and a refined walk says what the right answer is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from footopt.effects import bristle_length
from footopt.foot import Foot
from footopt.walk import FIVE, Accuracy, Scene, Walk, evaluate, simulate
from footopt.walk.balances import energy_gap, power_from_sand, sinking_speed, smoothing_power
from footopt.walk.discretize import too_many_poses
from footopt.walk.objectives import FLOORS

#: Each with its reason; none depends on the stepper. That of an error follows from the accuracy.
LIMITS = {
    "chatter": 1e-3,  # of the weight: what a force plate resolves; the trapped state has none at all
    "yielding": 3.0,  # in units of what the smoothed law itself yields, good to a factor for any sole
    "energy": 0.05,  # of |W|
    "slowing": 1e-3,  # relative: a periodic gait forgets its start in a few strides, then nothing changes
    "rest": 3e-8,  # m/s: in half a minute a thousandth of a grain
    "place": 1e-4,  # m, by which the time step and the length of bristles may choose where it stands
}
SETTLED = 0.1  # of every limit: the last refinement of a truth changes no measure by more
REFINED = range(1, 8)  # how often an accuracy is refined for a truth: at first, and at last
LONG = 180.0  # s: of such a walk the last minute is as fast as the second


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
        return 0.0 if self.value == 0.0 else self.value / self.limit if self.limit else math.inf


class Outcome(NamedTuple):
    """How a walk ended: why it failed, and its objectives, or where a walker that stands is, x and z in m."""

    reason: str
    numbers: Mapping[str, float]


class Truth(NamedTuple):
    """The outcome of a refined walk, and the largest measure over its limit that the last refinement made."""

    outcome: Outcome
    stands: float


def outcome_of(walk: Walk) -> Outcome:
    """The outcome of a walk with its traces."""
    if stands_still(walk.scene):
        return Outcome(walk.reason, {} if walk.reason else {"x": walk.com[-1, 0], "z": walk.com[-1, 1]})
    return Outcome(walk.reason, {name: walk.objectives[name] for name in FIVE})


def stands_still(scene: Scene) -> bool:
    """Whether the walker never begins to walk."""
    return math.isinf(scene.gait.start)


def find_truth(
    foot: Foot, scene: Scene, accuracy: Accuracy, given: Mapping[str, Any], limit: float
) -> Truth | None:
    """Refine a walk until it stands, but for what is given of the accuracy; None if it is too long for that.

    A walker that stands keeps its creep speed, which is the law that it sinks by; its bristles are a tenth as
    long. `limit` is that of the error of an objective.
    """
    if stands_still(scene):
        effects: tuple[Any, ...] = scene.effects
        shorter = (replace(e, length=0.1 * e.length) if e.bristle_length else e for e in effects)
        scene = replace(scene, effects=tuple(shorter))
        given = {"control": None, "creep": accuracy.creep, **given}
    found: list[Outcome] = []
    for times in REFINED:
        finer = replace(accuracy.refined(times), **given)
        if too_many_poses(scene, finer):
            break
        if stands_still(scene):
            found.append(outcome_of(simulate(foot, scene, finer)))
        else:  # without traces, which take memory
            table = evaluate([foot], scene, finer, FIVE, threads=1)
            found.append(Outcome(table.reasons[0], dict(zip(FIVE, table.values[0], strict=True))))
        if len(found) > 1:
            stands = max(measure.ratio for measure in compare(found[-2], found[-1], limit))
            if stands <= SETTLED:
                break
    return Truth(found[-1], stands) if len(found) > 1 else None


def judge(walk: Walk, truth: Truth | None, limit: float) -> list[Measure]:
    """Measures of a walk, of which none is beyond its limit if it is stable.

    A long walk needs no truth. `limit` is that of an objective's error.
    """
    own, long = outcome_of(walk), walk.scene.duration > LONG
    if truth:
        found = [*compare(own, truth.outcome, limit), Measure("truth", truth.stands, 1.0)]
    else:
        found = [_end(own, ""), Measure("truth", 0.0 if long else math.inf, 1.0)]
    if walk.reason or (truth and truth.outcome.reason):
        return found
    found.append(Measure("energy", energy_gap(walk), LIMITS["energy"]))
    if not bristle_length(walk.scene.effects):  # what bristles give back they have stored
        allowed = smoothing_power(walk.scene.sand.stress_map)
        found.append(Measure("power", power_from_sand(walk), allowed))
    if stands_still(walk.scene):
        found += _standing(walk)
    if long:
        begin, end, last, now = np.interp(
            [60.0, 120.0, walk.t[-1] - 60.0, walk.t[-1]], walk.t, walk.com[:, 0]
        )
        slowing = abs((now - last) / (end - begin) - 1.0)
        found.append(Measure("slowing", float(slowing), LIMITS["slowing"]))
    return found


def compare(own: Outcome, truth: Outcome, limit: float) -> list[Measure]:
    """Measures of an outcome against the right one: its end, its objectives, or where the walker stands."""
    if own.reason or truth.reason:
        return [_end(own, truth.reason)]
    off = {name: abs(own.numbers[name] - exact) for name, exact in truth.numbers.items()}
    if "x" in off:
        return [Measure("place", math.hypot(off["x"], off["z"]), LIMITS["place"])]
    errors = {name: off[name] / max(abs(truth.numbers[name]), FLOORS.get(name, 1e-3)) for name in off}
    peak = errors.pop("peak_power")  # on its own: an impact may be shorter than a step
    return [Measure("error", max(errors.values()), limit), Measure("peak", peak, limit)]


def _end(own: Outcome, expected: str) -> Measure:
    """0 if a walk ended as expected ("": well), 1 if not."""
    return Measure(own.reason or "no failure", float(own.reason != expected), 0.0)


def _standing(walk: Walk) -> list[Measure]:
    """In the second half of standing only the law itself lets the walker move, and the load is the weight."""
    half = 0.5 * walk.t[-1]
    late = walk.t > half
    weight = walk.scene.walker.mass * walk.scene.gravity[1]  # what of it presses on the sand
    force = walk.force[late, :, 1].sum(axis=1) / weight
    moved = float(np.hypot(*np.ptp(walk.com[late], axis=0)))
    plain = not bristle_length(walk.scene.effects)
    drift = LIMITS["yielding"] * sinking_speed(walk, half) * half if plain else 0.0
    return [
        Measure("chatter", float(force.std()), LIMITS["chatter"]),
        Measure("load", float(abs(force.mean() - 1.0)), LIMITS["chatter"]),
        Measure("drift", moved, LIMITS["rest"] * half + drift),
    ]
