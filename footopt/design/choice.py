"""`Choice`: which design of a front is the answer where several objectives were asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from footopt.errors import check
from footopt.kinds import says_kinds
from footopt.walk.objectives import MEASURES

Array = NDArray[np.float64]

#: Ways to choose, in words.
WAYS = {
    "knee": "the design nearest to the ideal point, with objectives scaled to the front",
    "weights": "the design whose worst weighted distance from the ideal point is least",
    "limits": "the best in the first objective of those within the limits",
    "efficiency": "the best in J_W",
}


@says_kinds
@dataclass(frozen=True)
class Choice:
    """How one design of a front is chosen.

    Parameters
    ----------
    by : str
        A name of `WAYS`. "knee" is compromise programming with equal weights (Zeleny 1973), "weights" an
        achievement scalarising function (Wierzbicki 1980).
    weights : dict of str to float
        Of the objectives, for "weights": the more, the nearer to its best; 1 for those not named.
    limits : dict of str to float
        Of the objectives, for "limits": the largest of one that is minimised, the smallest of another.

    Raises
    ------
    SettingError
        There is no such way, a number is not allowed, or what a way needs is missing or not read by it.
    """

    by: str = "knee"
    weights: Mapping[str, float] = field(default_factory=dict)
    limits: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check(self.by in WAYS, "choose", self.by, f"one of {', '.join(WAYS)}")
        for name in ("weights", "limits"):
            given, setting, needed = getattr(self, name), f"choose.{name}", self.by == name
            hint = f"Try choose={name} 'choose.{name}={{work:2}}'"
            allowed = f"{'' if needed else 'not '}given with choose={self.by}"
            check(bool(given) == needed, setting, dict(given), allowed, hint)
        for key, value in self.weights.items():
            good = isinstance(value, (int, float)) and 0 < value < np.inf
            check(good, f"choose.weights.{key}", value, "a number > 0")

    def check_names(self, names: Sequence[str]) -> None:
        """Raise a `SettingError` unless weights and limits are of these objectives, and can be kept."""
        for setting, given in (("weights", self.weights), ("limits", self.limits)):
            for name in given:
                check(name in names, f"choose.{setting}", name, f"one of {', '.join(names)}")
                if setting == "limits":
                    MEASURES[name].check_limit(f"choose.limits.{name}", given[name])

    def scores(self, f: Array, values: Array, names: Sequence[str], record: Sequence[str]) -> Array:
        """How far designs are from the choice, (designs,): the least is chosen.

        Parameters
        ----------
        f : (designs, objectives)
            All minimised.
        values : (designs, record)
            Recorded values, natural signs.
        names, record : sequence of str
            Of the columns.
        """
        if self.by == "efficiency":
            return np.asarray(values[:, list(record).index("efficiency")])
        low, span = f.min(axis=0), np.ptp(f, axis=0)
        scaled = (f - low) / np.where(span > 0.0, span, 1.0)
        if self.by == "knee":
            return np.asarray(np.sqrt((scaled**2).sum(axis=1)))
        if self.by == "weights":
            weighted = scaled * [self.weights.get(name, 1.0) for name in names]
            return np.asarray(weighted.max(axis=1) + 1e-4 * weighted.sum(axis=1))
        beyond = np.zeros(len(f))
        for name, limit in self.limits.items():
            beyond += np.maximum(excess(name, limit, values[:, list(record).index(name)]), 0.0)
        return np.asarray(np.where(beyond > 0.0, 2.0 + beyond, scaled[:, 0]))


def excess(name: str, limit: float, values: Array) -> Array:
    """How far values are beyond a limit, relative to it; at most 0 within it, 1 for no value."""
    scale = abs(limit) or 1.0
    over = MEASURES[name].sign * (values - limit) / scale
    return np.asarray(np.where(np.isfinite(over), over, 1.0))
