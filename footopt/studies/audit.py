"""The effect audit: how much an effect changes each objective and the ranking of feet, and its cost in time.

Simulate only the effects that a scene calls for.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.effects import Effect, name_of
from footopt.foot import Foot, Waypoints
from footopt.walk.accuracy import Accuracy, resolve
from footopt.walk.objectives import FIVE
from footopt.walk.scene import Scene
from footopt.walk.simulate import evaluate

Array = NDArray[np.float64]

#: Seconds of this thread alone, whatever else the machine does. Windows counts those by 1/64: too coarse.
own_time = time.perf_counter if os.name == "nt" else time.thread_time
QUANTILE = 95.0  # of the feet: the change that this share of them does not exceed, as for accuracy, %


@dataclass(frozen=True, eq=False)
class Audit:
    """The changes that one effect makes in a scene.

    Parameters
    ----------
    effect : Effect
        The effect that was switched on.
    scene : Scene
        Without it.
    changes : (objectives,)
        Relative, not exceeded by 95 % of the feet; columns `FIVE`. NaN if no foot walks in both.
    shifts : (objectives,)
        The median change with its sign.
    tau : float
        Kendall's tau of J_W over the feet, without and with it: 1 is the same ranking.
    lost : int
        Feet that walk without it and fail with it.
    feet : int
        How many walked both ways.
    cost : float
        Time of a walk with it over that without it.
    tolerance : float
        The relative change that matters.
    """

    effect: Effect
    scene: Scene
    changes: Array
    shifts: Array
    tau: float
    lost: int
    feet: int
    cost: float
    tolerance: float

    @property
    def name(self) -> str:
        """Of the effect."""
        return name_of(self.effect)

    @property
    def worst(self) -> str:
        """The objective that changes most."""
        return FIVE[int(np.argmax(np.nan_to_num(self.changes, nan=-1.0)))]

    @property
    def matters(self) -> bool:
        """Whether it changes an objective by more than the tolerance, or makes walks fail."""
        return self.lost > 0 or not bool((self.changes <= self.tolerance).all())

    @property
    def verdict(self) -> str:
        """In words."""
        change = 100.0 * float(np.max(np.nan_to_num(self.changes, nan=0.0)))
        says = f"changes {self.worst.replace('_', ' ')} by {percent(change)} %"
        limit = f"your {100 * self.tolerance:g} %"
        if self.matters:
            fails = f", {self.lost} walks fail" if self.lost else ""
            return f"{says}{fails}: above {limit}, keep it"
        return f"{says}: below {limit}, leave it out, saves {100 * (1 - 1 / self.cost):.0f} %"


def percent(value: float) -> str:
    """Two digits, without an exponent."""
    return f"{value:.0f}" if value >= 10.0 else f"{value:.2g}"


def audit(
    effect: Effect,
    scene: Scene,
    feet: Sequence[Foot] | ArrayLike,
    accuracy: Accuracy | str = "standard",
    tolerance: float = 0.01,
    space: Waypoints | None = None,
    repeats: int = 3,
) -> Audit:
    """Evaluate feet in a scene with an effect and without it.

    Parameters
    ----------
    effect : Effect
        Switched on, in place of one of its kind.
    scene : Scene
        Its other effects stay on.
    feet : sequence of Foot, or (designs, n)
        As in `evaluate`.
    accuracy : Accuracy or str
        As in `evaluate`.
    tolerance : float
        The relative change of an objective that matters.
    space : Waypoints, optional
        As in `evaluate`.
    repeats : int
        Of the walks, alternating, of which the median time counts.

    Returns
    -------
    Audit
        Its changes and its cost.
    """
    accuracy, scenes = resolve(accuracy), switched(effect, scene)
    tables = [evaluate(feet, s, accuracy, space=space) for s in scenes]  # compiled, poses made
    seconds: list[list[float]] = [[], []]
    for _ in range(repeats):
        for taken, s in zip(seconds, scenes, strict=True):
            started = own_time()
            evaluate(feet, s, accuracy, space=space, threads=1)
            taken.append(own_time() - started)
    without, with_ = tables
    both = without.feasible & with_.feasible
    if both.any():
        change = with_.values[both] / without.values[both] - 1.0
        changes, shifts = np.percentile(np.abs(change), QUANTILE, axis=0), np.median(change, axis=0)
    else:
        changes = shifts = np.full(len(FIVE), np.nan)
    return Audit(
        effect=effect,
        scene=scenes[0],
        changes=changes,
        shifts=shifts,
        tau=tau(without.efficiency[both], with_.efficiency[both]),
        lost=int((without.feasible & ~with_.feasible).sum()),
        feet=int(both.sum()),
        cost=statistics.median(b / a for a, b in zip(*seconds, strict=True)),
        tolerance=tolerance,
    )


def switched(effect: Effect, scene: Scene) -> tuple[Scene, Scene]:
    """A scene without an effect, and with it in place of one of its kind."""
    others = tuple(e for e in scene.effects if not isinstance(e, type(effect)))
    return replace(scene, effects=others), replace(scene, effects=(*others, effect))


def tau(a: Array, b: Array) -> float:
    """Kendall's rank correlation, tau-b; NaN where all feet are equal, or fewer than two."""
    s, t = (np.sign(np.subtract.outer(x, x)) for x in (a, b))
    pairs = np.sqrt((s * s).sum() * (t * t).sum())
    return float((s * t).sum() / pairs) if pairs else float("nan")
