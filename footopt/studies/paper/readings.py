"""The meanings that the paper's p_max and dV_x may have: walks read that way, and a search that ranks so."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.design import FootProblem
from footopt.errors import check
from footopt.foot import Foot
from footopt.studies.settings import StudyConfig
from footopt.walk import Walk, simulate

Array = NDArray[np.float64]

PEAK_POWER = ("stance", "single")
#: dV_x by name: how long about each heel strike a fall counts, in strides; None is the whole walk.
SPEED_LOSS = {"walk": None, "window": 1.0 / 4.0, "narrow": 1.0 / 8.0}

LIFTED = 0.05  # of the weight: a foot that carries less does not stand
SWITCHES = 3  # stance switches that the paper names: t = 1.1, 1.7, 2.3 s


class Readings(NamedTuple):
    """How two quantities that the paper does not define are read.

    Parameters
    ----------
    peak_power : {"stance", "single"}
        p_max from any instant after the first heel strike; or only from those at which the other foot
        carries less than `LIFTED` of the weight.
    speed_loss : {"walk", "window", "narrow"}
        dV_x as the largest fall below the running maximum from the first heel strike to t_f; or as the
        largest one within a quarter, or an eighth, of a stride about a heel strike. An eighth is about as
        long as both feet stand.
    """

    peak_power: str = "stance"
    speed_loss: str = "walk"

    @classmethod
    def of(cls, config: StudyConfig) -> Readings:
        """Return the readings that the settings name."""
        for name, allowed in (("peak_power", PEAK_POWER), ("speed_loss", SPEED_LOSS)):
            value = getattr(config, name)
            check(value in allowed, f"study.{name}", value, f"one of {', '.join(allowed)}")
        return cls(config.peak_power, config.speed_loss)


def read(walk: Walk, readings: Readings) -> Walk:
    """Return the walk with p_max and dV_x as they are read; J_W follows.

    The default readings are the library's own, with extremes between steps; the others are taken from the
    traces, at the ends of steps.
    """
    totals = dict(walk.totals)
    if walk.feasible and readings.peak_power == "single":
        totals["peak_power"] = single_stance_power(walk)
    window = SPEED_LOSS[readings.speed_loss]
    if walk.feasible and window is not None:
        totals["speed_loss"] = max(_falls(walk, window, window), default=float("nan"))
    return replace(walk, totals=totals)


def single_stance_power(walk: Walk) -> float:
    """Return the largest |sum f.v| of a foot that stands alone, W; NaN if none ever does."""
    after = walk.t >= walk.scene.gait.heel_strike
    up = walk.force[after, :, 1]
    alone = np.abs(up[:, ::-1]) < LIFTED * walk.scene.walker.weight
    return float(np.abs(walk.power[after])[alone].max(initial=-np.inf)) if alone.any() else float("nan")


def switch_losses(walk: Walk, readings: Readings) -> Array:
    """Return the fall of V_x about each of the paper's three switches, (3,), m/s; NaN where there is none.

    The fall is that within the window of the reading; for "walk", from a quarter of a stride before the heel
    strike to the next one.
    """
    window = SPEED_LOSS[readings.speed_loss]
    losses = _falls(walk, 0.25, 0.5) if window is None else _falls(walk, window, window)
    return np.array([*losses, *[np.nan] * SWITCHES])[:SWITCHES]


def _falls(walk: Walk, before: float, behind: float) -> list[float]:
    """Fall of V_x about each heel strike, from and to so many strides of it, m/s."""
    period = walk.scene.gait.period
    return [_fall(walk, h - before * period, h + behind * period) for h in _strikes(walk)]


def _strikes(walk: Walk) -> Iterator[float]:
    """Heel strikes that the walk goes on after, s."""
    if not walk.feasible:
        return
    yield from (float(h) for h in walk.scene.gait.heel_strikes(walk.scene.duration) if h < walk.t[-1])


def _fall(walk: Walk, begin: float, end: float) -> float:
    inside = (walk.t >= begin) & (walk.t <= end)
    speed = walk.velocity[inside, 0]
    return float((np.maximum.accumulate(speed) - speed).max(initial=0.0))


class ReadProblem(FootProblem):
    """A `FootProblem` on J_W with p_max and dV_x as they are read.

    Other readings than the library's need the traces of every design, which takes about twice the time.
    """

    def __init__(self, readings: Readings, **parameters: Any) -> None:
        super().__init__(**parameters)
        self.readings = readings

    @property
    def conditions(self) -> dict[str, Any]:
        """What is walked through, and how it is read."""
        return {**super().conditions, "readings": self.readings}

    def walk(self, k: NDArray[np.int64]) -> tuple[Array, NDArray[np.str_]]:
        """Recorded values as they are read, (designs, record), and why a walk failed."""
        values, reasons = super().walk(k)
        if self.readings == Readings():
            return values, reasons
        for row, heights in enumerate(k):
            walk = simulate(Foot.from_waypoints(heights, self.space), self.scene, self.accuracy)
            objectives = read(walk, self.readings).objectives
            values[row] = [objectives[name] for name in self.record]
        return values, reasons
