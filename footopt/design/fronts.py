"""Fronts: which designs are on them, their hypervolume, and which design is the answer."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from footopt.arrays import Array, Bools, Ints
from footopt.errors import check, is_number
from footopt.walk.objectives import MEASURES

REFERENCE = 1.1  # of hypervolumes, where the merged front spans 0 to 1 in every objective
EXACT = 1000  # designs of a front up to which its hypervolume is exact: the time grows with a power of them
DIRECTIONS = 1024  # samples of the estimate for a larger front of more than three objectives

#: Ways to choose a design, and what is chosen.
FRONT_RULES = {
    "knee": "Knee of the front",
    "weights": "Design of the front by weights",
    "limits": "Best design of the front within limits",
    "efficiency": "Design of the front with the best J_W",
}


class Volume:
    """Hypervolume of a front that grows, up to the origin: exact, and estimated where the front is large.

    The estimate is moocore's (Deng & Zhang, IEEE Transactions on Evolutionary Computation 23, 2019), in
    proportion to the exact value of the first front that is large: it goes on from there.
    """

    def __init__(self) -> None:
        self._scale = 0.0

    def __call__(self, f: Array) -> float:
        """The hypervolume of F (designs, objectives), minimised."""
        from moocore import hv_approx, hypervolume

        worst = np.zeros(f.shape[1])
        small = f.shape[1] <= 3 or len(f) <= EXACT
        if small or not self._scale:
            exact = float(hypervolume(f, ref=worst))
            if small:
                return exact
        estimate = float(hv_approx(f, ref=worst, nsamples=DIRECTIONS, seed=1, method="DZ2019-MC"))
        self._scale = self._scale or exact / estimate
        return self._scale * estimate


def nondominated(F: Array) -> Bools:
    """Which designs no other dominates, (designs,)."""
    if F.shape[1] == 1:
        return np.asarray(F[:, 0] == F.min(initial=np.inf))
    from moocore import is_nondominated

    return np.asarray(is_nondominated(np.ascontiguousarray(F, float), keep_weakly=True))


def ranks(F: Array) -> Ints:
    """Place of each design by each objective, (designs, objectives)."""
    return F.T.argsort(kind="stable").argsort(kind="stable").T


def hypervolume_shares(fronts: Sequence[Array]) -> list[float]:
    """Hypervolume of each front over that of all merged; F (designs, objectives) of each, minimised."""
    from moocore import filter_dominated, hypervolume

    merged = filter_dominated(np.concatenate(fronts))
    low, span = merged.min(axis=0), np.ptp(merged, axis=0)
    span = np.where(span > 0.0, span, 1.0)
    whole, *parts = (hypervolume((f - low) / span, ref=REFERENCE) for f in (merged, *fronts))
    return [float(part / whole) for part in parts]


@dataclass(frozen=True)
class Choice:
    """How one design of a front is chosen.

    Parameters
    ----------
    by : str
        A name of `FRONT_RULES`. "knee" is compromise programming with equal weights (Zeleny 1973),
        "weights" an achievement scalarising function (Wierzbicki 1980).
    weights : dict of str to float
        Of the objectives, for "weights": a larger one demands to be nearer to the objective's best; 1 for
        those not named.
    limits : dict of str to float
        Of the objectives, for "limits": the largest value of one that is minimised, the smallest of one that
        is maximised.

    Raises
    ------
    SettingError
        There is no such rule, a number is not allowed, or weights or limits are missing or not used by it.
    """

    by: str = "knee"
    weights: Mapping[str, float] = field(default_factory=dict)
    limits: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check(self.by in FRONT_RULES, "choose", self.by, f"one of {', '.join(FRONT_RULES)}")
        for name in ("weights", "limits"):
            given, setting, needed = getattr(self, name), f"choose.{name}", self.by == name
            hint = f"Try choose={name} 'choose.{name}={{work:2}}'"
            allowed = f"{'' if needed else 'not '}given with choose={self.by}"
            check(bool(given) == needed, setting, dict(given), allowed, hint)
        for key, value in self.weights.items():
            good = is_number(value) and 0 < value < np.inf
            check(good, f"choose.weights.{key}", value, "a number > 0")

    def check_names(self, names: Sequence[str], known: Sequence[str]) -> None:
        """Raise a `SettingError` unless these objectives and the `known` measures allow the choice."""
        there = self.by != "efficiency" or "efficiency" in known
        check(there, "choose", self.by, "knee or another rule, as these walks have no efficiency")
        for setting in ("weights", "limits"):
            for name in getattr(self, setting):
                check(name in names, f"choose.{setting}", name, f"one of {', '.join(names)}")
        for name, limit in self.limits.items():
            MEASURES[name].check_limit(f"choose.limits.{name}", limit)

    def scores(self, f: Array, names: Sequence[str], column: Callable[[str], Array]) -> Array:
        """How far designs are from the choice, (designs,): the least is chosen.

        f (designs, objectives) are minimised and have the columns `names`; `column` gives a value of designs
        by its name, in its natural sign, (designs,).
        """
        if self.by == "efficiency":
            return column("efficiency")
        low, span = f.min(axis=0), np.ptp(f, axis=0)
        scaled = (f - low) / np.where(span > 0.0, span, 1.0)
        if self.by == "knee":
            return np.asarray(np.linalg.norm(scaled, axis=1))
        if self.by == "weights":
            weighted = scaled * [self.weights.get(name, 1.0) for name in names]
            return np.asarray(weighted.max(axis=1) + 1e-4 * weighted.sum(axis=1))
        beyond = np.zeros(len(f))
        for name, limit in self.limits.items():
            beyond += np.maximum(excess(name, limit, column(name)), 0.0)
        return np.asarray(np.where(beyond > 0.0, 2.0 + beyond, scaled[:, 0]))


def excess(name: str, limit: float, values: Array) -> Array:
    """How far values are beyond a limit, relative to it; at most 0 within it, 1 for no value."""
    scale = abs(limit) or 1.0
    over = MEASURES[name].sign * (values - limit) / scale
    return np.asarray(np.where(np.isfinite(over), over, 1.0))
