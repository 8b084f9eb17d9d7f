"""The meanings that the paper's p_max and dV_x may have, and walks read that way."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import check
from footopt.studies.settings import StudyConfig
from footopt.walk import OBJECTIVES, Walk
from footopt.walk.objectives import SLOW

PEAK_POWER = ("stance", "single")
#: dV_x by name: how long about each heel strike a fall counts, in strides; None is the whole walk.
SPEED_LOSS = {"walk": None, "window": 1.0 / 4.0, "narrow": 1.0 / 8.0}

LIFTED = 0.05  # of the weight: a foot that carries less does not stand
SWITCHES = 3  # stance switches that the paper names: t = 1.1, 1.7, 2.3 s


class Readings(NamedTuple):
    """How two quantities that the paper does not define are read.

    p_max is taken at any instant after the first heel strike ("stance"); or only while the other foot
    carries less than `LIFTED` of the weight ("single"). dV_x is the largest fall below the running maximum
    from the first heel strike to t_f ("walk"); or the largest one within a quarter of a stride about a heel
    strike ("window"), or an eighth ("narrow"), which is about as long as both feet stand.
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

    def objective(self) -> str:
        """Return the name of J_W as it is read; other readings than the library's own need every trace."""
        if self == Readings():
            return "efficiency"
        name = f"efficiency_{self.peak_power}_{self.speed_loss}"
        SLOW[name] = replace(
            OBJECTIVES["efficiency"],
            name=name,
            value=lambda walk: read(walk, self).objectives["efficiency"],
            of="walk",
        )
        return name


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
    alone = np.abs(walk.force[after, ::-1, 1]) < LIFTED * walk.scene.walker.weight
    return float(np.abs(walk.power[after])[alone].max()) if alone.any() else float("nan")


def switch_losses(walk: Walk, readings: Readings) -> NDArray[np.float64]:
    """Return the fall of V_x about each of the paper's three switches, (3,), m/s; NaN where there is none.

    The fall is that within the window of the reading; for "walk", from a quarter of a stride before the heel
    strike to the next one.
    """
    window = SPEED_LOSS[readings.speed_loss]
    losses = _falls(walk, 0.25, 0.5) if window is None else _falls(walk, window, window)
    return np.array([*losses, *[np.nan] * SWITCHES])[:SWITCHES]


def _falls(walk: Walk, before: float, behind: float) -> list[float]:
    """Return the fall of V_x from and to so many strides about each heel strike, m/s."""
    gait, losses = walk.scene.gait, []
    for strike in gait.heel_strikes(walk.scene.duration) if walk.feasible else ():
        since, until = strike - before * gait.period, strike + behind * gait.period
        speed = walk.velocity[(walk.t >= since) & (walk.t <= until), 0]
        if strike < walk.t[-1]:
            losses.append(float((np.maximum.accumulate(speed) - speed).max(initial=0.0)))
    return losses
