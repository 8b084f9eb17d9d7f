"""The numbers of a tolerance: a ladder of refinements, climbed with a few soles until errors are within it.

Errors have three sides: the time step with its control, the plates, and the creep speed. A rung of a side
is finer than the one below by a known factor. From the coarsest numbers on, each side alone goes up by a
rung: what that changes in the objectives, times `SAFE`, is the error that the side leaves. The side with
the largest error for what its refinement costs goes up, until the errors add up to `SHARE` of the
tolerance. Costs are evaluations and plates, never seconds: the choice is the same on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import SettingError
from footopt.foot import Foot, Waypoints
from footopt.walk import discretize
from footopt.walk.accuracy import LEAST, LEAST_DT, Accuracy, AnyAccuracy, Tolerance, work
from footopt.walk.batch import Options, chunks, walk_batch
from footopt.walk.loop import OK
from footopt.walk.objectives import FIVE, OBJECTIVES, by_name, sizes
from footopt.walk.scene import Scene
from footopt.walk.simulator import Simulator
from footopt.walk.state import LANES
from footopt.walk.steppers import STEPPERS

Array = NDArray[np.float64]

#: The first rungs: time steps over the period of a stride, speeds over the legs' length in a period.
LONGEST = {True: 1 / 96, False: 1 / 960}  # time step of implicit and of explicit steppers
CONTROL, CREEP = 5e-3, 2.5e-4
FEWEST = 24  # plates
STEP_HALVED = 3  # rungs of half the control each, of which the last also halves the longest step
SAFE = 2.0  # an error is at most so many times what the next rung changes, if each rung halves it
SHARE = 0.5  # of the tolerance, for the errors of the probes: other soles of their kind err more
SMALL = 1 / 6  # of that share: an error that is not worth a rung
FAR = 4.0  # times that share: an error that two rungs will not bring within it
VAIN, BARELY = 8.0, 1.5  # so many times the work is to bring the error down by this factor
NEARLY = 1.25  # times the smallest error: as good where none is small enough
CHEAP = 0.02  # of a walk's work: what a rung costs at least

PROBES, DRAWN = 10, 40  # random soles of a space that walk, of those that are drawn
FEW = 8  # soles that may by chance change little: two rungs are looked at, and no sole is left out


class Rung(NamedTuple):
    """How far each side is refined."""

    time: int = 0
    plates: int = 0
    creep: int = 0

    def up(self, side: int, by: int, top: Rung) -> Rung:
        """The rung that is finer on one side, at most the top one's."""
        return self._replace(**{self._fields[side]: min(self[side] + by, top[side])})


#: Steps of 1/16 of the first ones, 2,200 plates, a creep speed of 1/2000: nothing finer has been asked for.
TOP = Rung(12, 13, 11)


class Found(NamedTuple):
    """The end of a ladder."""

    rung: Rung
    error: float  # of the probes' objectives, relative; NaN if all fail, infinite if refined ones do
    work: float  # of one of their walks, in evaluations of a plate
    price: float = math.nan  # of all walks that found it
    path: tuple[Rung, ...] = ()  # from the coarsest numbers on


def numerics(
    accuracy: AnyAccuracy, scene: Scene | Simulator, feet: Any, space: Waypoints | None = None
) -> Accuracy:
    """The numbers with which feet walk through a scene.

    Parameters
    ----------
    accuracy : Accuracy or Tolerance
        Numbers, which are taken as they are, or a tolerance.
    scene : Scene or Simulator
        Where they walk.
    feet : Waypoints, Foot, sequence of Foot, or (designs, n)
        A space, whose probes are random soles; heights of one; or soles, of which up to ten are the probes.
        Feet that are all of one space have the space's.
    space : Waypoints, optional
        Of heights.

    Returns
    -------
    Accuracy
        The same for all of them.
    """
    if isinstance(accuracy, Accuracy):
        return accuracy
    return replace(ladder(accuracy, scene, feet, space)[0], name=accuracy.name, tolerance=accuracy.error)


def ladder(
    of: Tolerance, scene: Scene | Simulator, feet: Any, space: Waypoints | None = None
) -> tuple[Accuracy, Found]:
    """The numbers that a tolerance comes to, and how they were found."""
    soles = _soles(feet, space)
    if isinstance(scene, Simulator):
        return scene.ladder(of, soles) or (Accuracy(), Found(Rung(), math.nan, math.nan))
    try:
        found = _climbed(replace(of, name="", refinements=0), scene, soles)
    except TypeError:  # an effect of a user's own that cannot be hashed
        found = _climbed.__wrapped__(of, scene, soles)
    numbers = numbers_at(of, scene, found.rung)
    return replace(numbers.refined(of.refinements), **of.by_hand) if of.refinements else numbers, found


def _soles(feet: Any, space: Waypoints | None) -> Any:
    """The space that the probes of feet are drawn from, or the feet that are the probes."""
    if isinstance(feet, Waypoints):
        return feet
    if isinstance(feet, Foot):
        feet = [feet]
    if len(feet) == 0:
        raise SettingError("feet", "[]", "at least one foot")
    if not isinstance(feet[0], Foot):
        return space or Waypoints(n=len(feet[0]))
    spaces = {foot.space for foot in feet}
    if len(spaces) == 1 and None not in spaces:
        return spaces.pop()
    return tuple(dict.fromkeys(feet[i] for i in _spread(len(feet))))


def _spread(count: int) -> list[int]:
    """The places of up to `PROBES` of so many, spread evenly."""
    return [int(place) for place in np.unique(np.linspace(0, count - 1, PROBES).round())]


@lru_cache(maxsize=256)
def _climbed(of: Tolerance, scene: Scene, soles: Any) -> Found:
    """The end of the ladder for a space or some feet."""
    top = _top(of, scene)
    chosen, space, drawing = soles, None, 0.0
    if isinstance(soles, Waypoints):
        space = soles
        heights = drawn(soles)
        values, cost = _walked(numbers_at(of, scene, Rung()), scene, heights, space)
        fails = np.isnan(values).all(axis=1)
        chosen, drawing = heights[np.argsort(fails, kind="stable")[:PROBES]], DRAWN * cost
    found = climb(lambda rung: _walked(numbers_at(of, scene, rung), scene, chosen, space), top, of.error)
    return found._replace(price=found.price + drawing)


def probes(space: Waypoints) -> NDArray[np.int64]:
    """Soles of a space that stand for all of it, (PROBES, n)."""
    return drawn(space)[:PROBES]


def drawn(space: Waypoints) -> NDArray[np.int64]:
    """Random soles of a space, (DRAWN, n): every other one rough, those between on lines through few heights.

    Smooth soles take to the sand all at once, and a search ends among them.
    """
    random, x = np.random.default_rng(0), np.linspace(0.0, 1.0, space.n)
    rows = random.integers(1, space.K + 1, (DRAWN, space.n))
    for i in range(1, DRAWN, 2):
        knots = np.linspace(0.0, 1.0, min(2 + i // 2 % 4, space.n))
        rows[i] = np.rint(np.interp(x, knots, rows[i, : len(knots)]))
    return rows


def _top(of: Tolerance, scene: Scene) -> Rung:
    """The finest rung of each side: the first where it is held by hand, or where a finer walk is too long."""
    time = 0 if None not in (of.dt, of.control) else TOP.time
    while time and discretize.too_many_poses(scene, numbers_at(of, scene, Rung(time))):
        time -= 1
    return Rung(time, 0 if of.plates else TOP.plates, 0 if of.creep else TOP.creep)


def plates_at(rung: Rung) -> int:
    """Plates along the sole on a rung."""
    return LANES * round(FEWEST / LANES * 2 ** (rung.plates / 2))


def numbers_at(of: Tolerance, scene: Scene, rung: Rung) -> Accuracy:
    """The numbers of a rung in a scene, and those that are held by hand."""
    period = scene.gait.period
    speed = (scene.walker.l1 + scene.walker.l2) / period
    halvings = max(rung.time - 1, 0) // STEP_HALVED
    dt = LONGEST[STEPPERS[of.stepper].implicit] * period / 2**halvings
    numbers = Accuracy(
        stepper=of.stepper,
        dt=min(max(dt, LEAST_DT), 1.0),
        plates=plates_at(rung),
        creep=min(max(CREEP * speed / 2**rung.creep, LEAST), 1.0),
        rule=of.rule,
        control=min(max(CONTROL * speed / 2**rung.time, LEAST), 1.0),
    )
    return replace(numbers, **of.by_hand)


def _walked(accuracy: Accuracy, scene: Scene, probes: Any, space: Waypoints | None) -> tuple[Array, float]:
    """Objectives (probes, objectives), NaN for those that fail, and the work of a walk."""
    (plates,) = chunks(probes, scene, accuracy, space)
    walked = walk_batch(plates, scene, accuracy, Options(sink=False, threads=None))
    raw = np.where(walked.status[:, None] == OK, walked.raw, np.nan)
    values = np.stack([OBJECTIVES[name].value(by_name(raw), scene) for name in FIVE], axis=1)
    values *= sizes(np.zeros(len(FIVE))) / sizes(np.zeros(len(FIVE)), scene)  # in units of its own floors
    return values, work(walked.counts["evaluations"], walked.counts["plates"]).mean()


def climb(
    walk: Callable[[Rung], tuple[Array, float]], top: Rung, tolerance: float, most: float = math.inf
) -> Found:
    """Climb a ladder.

    Parameters
    ----------
    walk : callable
        The probes' objectives (probes, objectives) on a rung, and the work of a walk.
    top : Rung
        The finest of each side.
    tolerance : float
        The relative error of the worst objective.
    most : float
        Walks with the numbers that are found, in whose work they are to be found.
    """
    walked: dict[Rung, tuple[Array, float]] = {}
    passed: list[Found] = []
    rung, allowed = Rung(), SHARE * tolerance

    def at(one: Rung) -> tuple[Array, float]:
        if one not in walked:
            walked[one] = walk(one)
        return walked[one]

    def price() -> float:
        return sum(len(values) * cost for values, cost in walked.values())

    while True:
        values, cost = at(rung)
        looks = range(1, 2 + (len(values) < FEW))
        finer = [[at(rung.up(side, by, top)) for by in looks] for side in range(len(rung))]
        changes = [SAFE * np.max([changes_of(values, other) for other, _ in ups], axis=0) for ups in finer]
        errors = [worst(change) for change in changes]
        passed.append(Found(rung, math.nan if np.isnan(values).all() else worst(sum(changes)), cost))
        worth = {
            side: errors[side] / max(finer[side][0][1] - cost, CHEAP * cost)
            for side in range(len(rung))
            if rung[side] < top[side] and errors[side] > SMALL * allowed
        }
        if passed[-1].error <= allowed or not worth or _in_vain(passed):
            break
        side = max(worth, key=lambda side: worth[side])
        by = 2 if errors[side] > FAR * allowed else 1
        look = len(values) * (cost + sum(other for ups in finer for _, other in ups))
        ahead = look * (finer[side][0][1] / cost) ** by
        if price() + ahead > most * _best(passed, passed[0]).work:
            break
        rung = rung.up(side, by, top)
    found = passed[-1] if passed[-1].error <= allowed else _best(passed, passed[-1])
    return found._replace(price=price(), path=tuple(one.rung for one in passed))


def _best(passed: Sequence[Found], otherwise: Found) -> Found:
    """The cheapest rung of nearly the smallest error, if there is one that is finite."""
    good = NEARLY * min(one.error for one in passed)
    near = (one for one in passed if one.error <= good < math.inf)
    return min(near, key=lambda one: one.work, default=otherwise)


def changes_of(values: Array, others: Array) -> Array:
    """Relative changes of the probes' objectives (probes, objectives).

    Infinite where a walk ends otherwise, and 0 where it fails on both rungs.
    """
    same = (values == others) | (np.isnan(values) & np.isnan(others))
    change = np.where(same, 0.0, np.abs(others - values) / sizes(others))
    return np.where(np.isnan(change), math.inf, change)


def worst(errors: Array) -> float:
    """The largest of the probes' errors (probes, objectives), of many but for one probe.

    One probe of ten may stand at the brink of a fall, whatever the numbers are.
    """
    return float(np.sort(errors.max(axis=1))[-1 if len(errors) < FEW else -2])


def _in_vain(passed: Sequence[Found]) -> bool:
    """Whether the last rungs cost much and brought little: such errors are the scene's, not the numbers'."""
    before = [one.error for one in passed if VAIN * one.work <= passed[-1].work]
    return bool(before) and not min(one.error for one in passed) < min(before) / BARELY
