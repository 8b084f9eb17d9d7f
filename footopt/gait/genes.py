"""Four numbers of a gait that a person changes at will: stride time, step, knee lift, pitch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest

import numpy as np

from footopt.gait.fourier import Fourier
from footopt.gait.gait import Gait

PHASES = np.arange(200) / 200  # of a stride, among which the knee is least bent
ASSUMED = "assumed"
WALKED = "0.79 to 1.25 s and +- 22 % of length were walked: Danion et al., Gait & Posture 18, 2003"
ANKLE = "as far as the ankle bends in a stride: Perry, Gait Analysis, table 4.1"


@dataclass(frozen=True)
class Gene:
    """A number of a gait.

    Parameters
    ----------
    given : float, optional
        Its value of a gait that is as given; None for the gait's own stride time.
    low, high : float
        The range that a person's is assumed to be.
    unit : str
        Of the value; "" for a factor.
    source : str
        That it is assumed, and what was measured that it can be held against.
    """

    given: float | None
    low: float
    high: float
    unit: str
    source: str

    def at_end(self, value: float) -> bool:
        """Whether a value is as low or as high as a person's can be."""
        return value <= self.low or value >= self.high

    def value(self, level: int, levels: int, own: float) -> float:
        """Of a level, 1 to `levels`: the lowest, the gait's own in the middle, the highest, linear between.

        A gait that is outside the range has its own as that end.
        """
        at = (1, (levels + 1) // 2, levels)
        return float(np.interp(level, at, (min(self.low, own), own, max(self.high, own))))


#: By name. Ranges are assumed, not measured. Stride time: of 123 to 87 steps a minute. Step: the thigh's
#: swing about its mean. Lift: the bend of the knee above its least one. Pitch: of the foot to the shank,
#: + toe up, for the whole stride; as far as the ankle bends within one, 10 deg up and 20 deg down.
GENES: dict[str, Gene] = {
    "stride_time": Gene(None, 0.98, 1.38, "s", f"{ASSUMED}; {WALKED}"),
    "step": Gene(1.0, 0.9, 1.1, "", f"{ASSUMED}; {WALKED}"),
    "lift": Gene(1.0, 0.8, 1.2, "", ASSUMED),
    "pitch": Gene(0.0, -20.0, 10.0, "deg", f"{ASSUMED}, {ANKLE}"),
}


def values_of(gait: Gait, levels: Sequence[int], count: int) -> dict[str, float]:
    """Values of the genes by name, of their levels, 1 to `count`; (count + 1) // 2 is the gait's own."""
    return {
        name: gene.value(level, count, gait.period if gene.given is None else gene.given)
        for (name, gene), level in zip(GENES.items(), levels, strict=True)
    }


def varied(gait: Gait, values: Mapping[str, float]) -> Gait:
    """A gait with values of `GENES`; with its own, it is the same gait to the last bit."""
    thigh, knee, foot, pitch = gait.thigh, gait.knee, gait.foot, gait.pitch
    if values["step"] != 1.0:
        thigh = _scaled(thigh, values["step"], thigh.a0)
    if values["lift"] != 1.0:
        knee = _scaled(knee, values["lift"], float(np.degrees(knee.at(PHASES)[0]).min()))
    if values["pitch"] != 0.0:
        turned = _difference(thigh, knee) if foot is None or pitch == "shank" else foot
        foot, pitch = turned._replace(a0=turned.a0 + values["pitch"]), "measured"
    return replace(gait, thigh=thigh, knee=knee, foot=foot, pitch=pitch, period=values["stride_time"])


def _scaled(angle: Fourier, factor: float, about: float) -> Fourier:
    """The way of an angle from another one, times a factor; deg."""
    return Fourier(
        about + factor * (angle.a0 - about),
        tuple(factor * c for c in angle.a),
        tuple(factor * c for c in angle.b),
    )


def _difference(one: Fourier, other: Fourier) -> Fourier:
    return Fourier(
        one.a0 - other.a0,
        tuple(p - q for p, q in zip_longest(one.a, other.a, fillvalue=0.0)),
        tuple(p - q for p, q in zip_longest(one.b, other.b, fillvalue=0.0)),
    )
