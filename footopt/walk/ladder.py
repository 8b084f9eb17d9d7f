"""The numerical parameters for a tolerance: a ladder of refinements, climbed with a few soles, the probes.

Errors have three sides: the time step with its control, the plates, and the creep speed. A rung of a side
is finer than the one below by a known factor. From the coarsest parameters on, each side alone goes up by a
rung: the change of the objectives, times `SAFE`, estimates the error that the side causes. The side with
the largest error for the cost of its refinement goes up, until the errors add up to `SHARE` of the
tolerance. One rung may by chance change little: a walk further up on all sides (`DEEP`) has to agree, or the
climb goes on. Then sides go down again as long as that walk agrees, because a climb learns late which side
causes the error. A climb that has to stop ends on the cheapest rung where most soles agree with the finest
walks. Costs are evaluations and plates, never seconds: the choice is the same on every machine.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from operator import sub
from typing import Any, NamedTuple

import numpy as np

from footopt.arrays import Array
from footopt.effects.base import laws, reshaping
from footopt.errors import check
from footopt.foot import Foot, Soles, Waypoints, as_feet, as_plates
from footopt.foot.plates import CORNER
from footopt.walk.accuracy import LEAST, LEAST_DT, Accuracy, AnyAccuracy, Tolerance, work
from footopt.walk.discretize import Path, too_many_poses
from footopt.walk.objectives import FIVE, OBJECTIVES, by_name, sizes
from footopt.walk.simulator import Simulator, Walked
from footopt.walk.state import LANES
from footopt.walk.steppers import STEPPERS

#: The first rungs: time steps over the period of a stride, speeds over the legs' length in a period.
LONGEST = {True: 1 / 96, False: 1 / 960}  # time step of implicit and of explicit steppers
CONTROL, CREEP = 5e-3, 2.5e-4
FEWEST = 24  # plates
ORDER = 3  # of the error of a step in its length: rungs of half the control each that halve the longest step
SAFE = 2.0  # an error is at most this many times the change by the next rung, if each rung halves it
SHARE = 0.5  # share of the tolerance allowed to the probes: other soles of their kind have larger errors
AGAIN = 0.8  # of that share, allowed to a rung further down: one of several may be good by chance
WORTH = 0.8  # of a rung's work: a rung further down is taken only if it costs less than this
SMALL = 1 / 6  # of that share: a smaller error is not worth a rung
FAR = 4.0  # times that share: a larger error takes two rungs at once
SAFE_DEEP = 4 / 3  # as `SAFE`, for rungs that leave a quarter of an error
ALIKE = 2.0  # the worst probe's error counts as at most this many times the next one's, against `DEEP` walks
NEARLY = 1.25  # times the smallest error: counts as equally good where none is small enough
MOST = 1000.0  # walks in whose work the parameters are found: a fifth of a search of 5,000
MOST_WORK = 2e10  # evaluations of a plate in which any parameters are found: a minute or two
CHEAP = 0.02  # of a walk's work: the least that a rung is taken to cost

PROBES, DRAWN = 10, 40  # random soles of a space that walk, of those that are drawn
FEW = 8  # fewer probes than this may by chance change little on one rung: two are tried, and the worst counts


class Rung(NamedTuple):
    """How far each side is refined."""

    time: int = 0
    plates: int = 0
    creep: int = 0

    def up(self, by: "Rung", times: int, top: "Rung") -> "Rung":
        """The rung that is finer by so many times another, at most the top one's."""
        return Rung(*(min(here + times * more, end) for here, more, end in zip(self, by, top, strict=True)))

    def sides(self) -> "tuple[Rung, Rung, Rung]":
        """Each side's part of it alone."""
        return Rung(self.time), Rung(0, self.plates), Rung(0, 0, self.creep)


BOTTOM, NEXT = Rung(), Rung(1, 1, 1)
#: Half the longest step with an eighth of the control, twice the plates, and a quarter of the creep speed.
DEEP = Rung(ORDER, 2, 2)
#: Steps of 1/25 of the first ones, 8,700 plates, a creep speed of 1/8000: nothing finer has been asked for.
TOP = Rung(15, 17, 13)


class Found(NamedTuple):
    """The end of a ladder."""

    rung: Rung
    error: float  # of the probes' objectives, relative; NaN if all fail, infinite if refined ones do
    work: float  # of one of their walks, in evaluations of a plate
    price: float = math.nan  # of all walks that found it
    path: tuple[Rung, ...] = ()  # from the coarsest parameters on


def numerics(
    accuracy: AnyAccuracy, simulator: Simulator, feet: Waypoints | Foot | Sequence[Foot]
) -> Accuracy:
    """The numerical parameters with which feet walk, the same for all; an `Accuracy` is returned as it is.

    The probes of a space are random soles, those of feet up to ten of them. Feet that are all of one space
    have the space's.
    """
    if isinstance(accuracy, Accuracy):
        return accuracy
    return replace(ladder(accuracy, simulator, feet)[0], name=accuracy.name, tolerance=accuracy.error)


def ladder(
    of: Tolerance, simulator: Simulator, feet: Waypoints | Foot | Sequence[Foot]
) -> tuple[Accuracy, Found]:
    """The numerical parameters for a tolerance, and how they were found."""
    return simulator.ladder(of, _soles(feet)) or (Accuracy(), Found(Rung(), math.nan, math.nan))


def _soles(feet: Waypoints | Foot | Sequence[Foot]) -> Waypoints | tuple[Foot, ...]:
    """The space that the probes of feet are drawn from, or the feet that are the probes."""
    if isinstance(feet, Waypoints):
        return feet
    if isinstance(feet, Soles):
        return feet.space
    feet = as_feet(feet)
    check(len(feet) > 0, "feet", "[]", "at least one foot")
    spaces = {foot.space for foot in feet}
    if len(spaces) == 1 and (space := spaces.pop()) is not None:
        return space
    spread = np.unique(np.linspace(0, len(feet) - 1, PROBES).round()).astype(int)
    return tuple(dict.fromkeys(feet[i] for i in spread.tolist()))


@lru_cache(maxsize=256)
def climbed(of: Tolerance, simulator: Simulator, path: Path, soles: Any) -> Found:
    """The end of the ladder of the planar walker for a space or some feet."""
    top, first, rows, drawing = _top(of, path), BOTTOM, np.arange(DRAWN), 0.0
    if isinstance(soles, Waypoints):
        values, cost = _walked(simulator, soles, tuple(rows), numbers_at(of, path, first))
        rows, drawing = np.argsort(np.isnan(values).all(axis=1), kind="stable")[:PROBES], DRAWN * cost
    else:
        first = Rung(0, _resolving(of, simulator, soles, top.plates))

    def walked(rung: Rung) -> tuple[Array, float]:
        return _walked(simulator, soles, tuple(rows), numbers_at(of, path, rung))

    found = climb(walked, top, of.error, MOST, DEEP, first)
    return found._replace(price=found.price + drawing)


@lru_cache(maxsize=1024)  # ladders for several tolerances have rungs in common
def _walked(simulator: Simulator, soles: Any, rows: Any, numbers: Accuracy) -> tuple[Array, float]:
    """Objectives of feet, or of some of those drawn from a space, (feet, objectives), and a walk's work."""
    feet = Soles(drawn(soles).k[list(rows)], soles) if isinstance(soles, Waypoints) else soles
    found = simulator.walk(feet, numbers)
    return five(simulator, found), work(found.evaluations, found.counts["plates"]).mean()


def five(simulator: Simulator, found: Walked) -> Array:
    """The `FIVE` of feet that have walked, (feet, objectives), NaN for those that failed.

    In units of the simulator's own `sizes`.
    """
    raw = by_name(np.where(found.reasons[:, None] == "", found.raw, np.nan), simulator.quantities)
    values = np.stack([OBJECTIVES[name].value(raw, simulator) for name in FIVE], axis=1)
    units: Array = sizes(np.zeros(len(FIVE))) / sizes(np.zeros(len(FIVE)), simulator)
    return values * units


@lru_cache(maxsize=16)
def drawn(space: Waypoints) -> Soles:
    """`DRAWN` random soles of a space: every other one rough, those between on lines through few heights.

    Smooth soles take to the sand all at once, and a search ends among them.
    """
    random, x = np.random.default_rng(0), np.linspace(0.0, 1.0, space.n)
    rows = random.integers(1, space.K + 1, (DRAWN, space.n))
    for i in range(1, DRAWN, 2):
        knots = np.linspace(0.0, 1.0, min(2 + i // 2 % 4, space.n))
        rows[i] = np.rint(np.interp(x, knots, rows[i, : len(knots)]))
    return Soles(rows, space)


def _top(of: Tolerance, path: Path) -> Rung:
    """The finest rung of each side: the first where it is held by hand, or where a finer walk is too long."""
    time = 0 if None not in (of.dt, of.control) else TOP.time
    while time and too_many_poses(path, numbers_at(of, path, Rung(time))):
        time -= 1
    return Rung(time, 0 if of.plates else TOP.plates, 0 if of.creep else TOP.creep)


def _resolving(of: Tolerance, simulator: Any, feet: tuple[Foot, ...], top: int) -> int:
    """The rung of plates that resolves drawings, if effects ask for the direction of a side.

    Within a plate, sides then differ by less than a corner. Noise that is finer has the same means on
    neighbouring rungs, which thus agree: only a walk that resolves it knows what such an effect makes of it.
    """
    acting, drawings = laws(simulator.effects), [foot for foot in feet if foot.k is None]
    if not drawings or (acting.gates is None and acting.pushes is None):
        return 0
    for rung in range(top):
        cut = as_plates(drawings, plates_at(Rung(0, rung)), of.rule, reshaping(simulator.effects))
        turns = np.sqrt(np.sum(cut.turn**2 * cut.area, axis=1) / np.sum(cut.area, axis=1))
        if turns.max() < CORNER:
            return rung
    return top


def plates_at(rung: Rung) -> int:
    """Plates along the sole on a rung."""
    return LANES * round(FEWEST / LANES * 2 ** (rung.plates / 2))


@lru_cache(maxsize=1024)
def numbers_at(of: Tolerance, path: Path, rung: Rung) -> Accuracy:
    """The numerical parameters of a rung for a walk; those that are set by hand replace them."""
    period = path.gait.period
    speed = (path.l1 + path.l2) / period
    dt = LONGEST[STEPPERS[of.stepper].implicit] * period * min(1.0, 2 ** ((1 - rung.time) / ORDER))
    numbers = Accuracy(
        stepper=of.stepper,
        dt=min(max(dt, LEAST_DT), 1.0),
        plates=plates_at(rung),
        creep=min(max(CREEP * speed / 2**rung.creep, LEAST), 1.0),
        rule=of.rule,
        control=min(max(CONTROL * speed / 2**rung.time, LEAST), 1.0),
    )
    return replace(numbers, **of.by_hand)


def climb(
    walk: Callable[[Rung], tuple[Array, float]],
    top: Rung,
    tolerance: float,
    most: float = MOST,
    deep: Rung | None = None,
    first: Rung = BOTTOM,
) -> Found:
    """Climb a ladder until the relative error of the worst objective is within a tolerance.

    walk: from a rung to the probes' objectives (probes, objectives) and the work of a walk. top: the finest
    rung. most: how many walks with the parameters that it would end with so far the climb may cost. deep: how
    many rungs further up a walk has to agree in the end, or None. first: the lowest rung.
    """
    walked: dict[Rung, tuple[Array, float]] = {}
    path: list[Rung] = []
    rung, allowed, by, safe = first, SHARE * tolerance, NEXT, SAFE

    def at(one: Rung) -> tuple[Array, float]:
        if one not in walked:
            walked[one] = walk(one)
        return walked[one]

    def up(by: Rung) -> list[tuple[Array, float]]:
        twice = by is not deep and len(at(rung)[0]) < FEW
        return [at(rung.up(by, times, top)) for times in range(1, 2 + twice)]

    def closest() -> Found:
        """The cheapest rung nearly as close as any to the finest walks, of those with fewest probes off."""
        ups = [at(one) for one in walked if min(map(sub, one, rung)) >= 0]
        errors = {one: safe * _changed(at(one)[0], ups) for one in path}
        missed = {one: (each.max(axis=1) > allowed).sum() for one, each in errors.items()}
        fewest = [one for one in errors if missed[one] == min(missed.values())]
        means = {one: np.log(np.clip(errors[one].max(axis=1), allowed, 1.0)).mean() for one in fewest}
        near = [one for one in fewest if means[one] <= min(means.values()) + math.log(NEARLY)]
        least = min(near, key=lambda one: at(one)[1])
        return Found(least, worst(errors[least], ALIKE), at(least)[1])

    def too_expensive(more: float, work: float) -> bool:
        return price() + more > min(most * work, MOST_WORK)

    def price() -> float:
        return sum(len(values) * cost for values, cost in walked.values())

    while True:
        values, cost = at(rung)
        path.append(rung)
        if by is deep:
            found = Found(rung, worst(_changed(values, up(deep)), ALIKE), cost)
            if found.error <= allowed:
                break
        finer = [up(side) for side in by.sides()]
        changes = [safe * _changed(values, ups) for ups in finer]
        if by is NEXT:
            error = math.nan if np.isnan(values).all() else worst(np.sum(changes, axis=0))
            found = Found(rung, error, cost)
            if found.error <= allowed:
                grows = math.prod((ups[0][1] / cost) ** n for ups, n in zip(finer, deep or NEXT, strict=True))
                if deep is None or too_expensive(len(values) * grows * cost, cost):
                    break
                by, safe = deep, SAFE_DEEP
                continue
        errors = [worst(change) for change in changes]
        worth = {
            side: errors[side] / max(finer[side][0][1] - cost, CHEAP * cost)
            for side in range(len(rung))
            if rung[side] < top[side] and errors[side] > SMALL * allowed
        }
        if not worth:
            break
        side = max(worth, key=lambda side: worth[side])
        rungs = 2 if errors[side] > FAR * allowed else 1
        trial = len(values) * (cost + sum(other for ups in finer for _, other in ups))
        if too_expensive(trial * (finer[side][0][1] / cost) ** rungs, closest().work):
            break
        rung = rung.up(NEXT.sides()[side], rungs, top)
    if by is deep and found.error <= allowed:
        found = _descended(found, first, at, up(deep), AGAIN * allowed, too_expensive)
    elif found.error > allowed:
        found = closest()
    return found._replace(price=price(), path=tuple(dict.fromkeys(path)))


def _descended(
    found: Found,
    first: Rung,
    at: Callable[[Rung], tuple[Array, float]],
    ups: Sequence[tuple[Array, float]],
    allowed: float,
    too_expensive: Callable[[float, float], bool],
) -> Found:
    """The cheapest rung to which sides go down, one by one, while walks further up (`ups`) agree with it."""
    lowest, last = found, None
    while lowest is not last:
        last, tried = lowest, [lowest]
        for side in NEXT.sides():
            below = Rung(*(here - less for here, less in zip(last.rung, side, strict=True)))
            if min(map(sub, below, first)) >= 0:
                values, cost = at(below)
                tried.append(Found(below, worst(_changed(values, ups), ALIKE), cost))
        lowest = min((one for one in tried if one.error <= allowed or one is last), key=lambda one: one.work)
        if too_expensive(0.0, lowest.work):
            break
    return lowest if lowest.work <= WORTH * found.work else found


def _changed(values: Array, ups: Sequence[tuple[Array, float]]) -> Array:
    """The largest relative changes of the probes' objectives to finer walks."""
    return np.max([changes_of(values, other) for other, _ in ups], axis=0)


def changes_of(values: Array, others: Array, simulator: Simulator | None = None) -> Array:
    """Relative changes of the probes' objectives (probes, objectives), by `sizes`.

    Infinite where a walk ends otherwise, and 0 where it fails on both rungs.
    """
    same = (values == others) | (np.isnan(values) & np.isnan(others))
    change = np.where(same, 0.0, np.abs(others - values) / sizes(others, simulator))
    return np.where(np.isnan(change), math.inf, change)


def worst(errors: Array, alike: float = 1.0) -> float:
    """The largest of the probes' errors (probes, objectives); of many at most `alike` times the next one.

    One probe of ten may be on the verge of a fall, however fine its walk is.
    """
    ordered = np.sort(errors.max(axis=1))
    return float(ordered[-1] if len(errors) < FEW else min(ordered[-1], alike * ordered[-2]))
