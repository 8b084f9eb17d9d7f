"""Does a claim hold, and which open setting decides it? The judgement from the margins of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footopt.studies.paper.sweep import Factor, Plan, shown

Array = NDArray[np.float64]
NAN = float("nan")

ALWAYS = 0.95  # share of the sweep in which a claim must hold to hold; and, from 1, to not hold
VERDICTS = ("holds", "holds only if", "does not hold")


def sensitivity(held: Array, level: NDArray[np.int64]) -> float:
    """Return the share of a claim's variance that the levels of a factor explain, 0 to 1.

    This is the correlation ratio without its bias for many levels (epsilon squared, Kelley 1935).

    Parameters
    ----------
    held : (samples,)
        1 where the claim holds, 0 where not, NaN where it could not be decided.
    level : (samples,)
        Level of the factor.
    """
    known = np.isfinite(held)
    y, levels = held[known], level[known]
    total = float(((y - y.mean()) ** 2).sum()) if len(y) else 0.0
    groups = [y[levels == v] for v in np.unique(levels)]
    if total == 0.0 or len(y) <= len(groups):
        return 0.0
    within = sum(float(((g - g.mean()) ** 2).sum()) for g in groups)
    return max(0.0, 1.0 - within / total * (len(y) - 1) / (len(y) - len(groups)))


def chance(samples: int, levels: int) -> float:
    """Return the sensitivity that a setting without any influence stays below in 95 % of sweeps."""
    from scipy.stats import f

    if samples <= levels or levels < 2:
        return 1.0
    ratio = (levels - 1) * f.ppf(0.95, levels - 1, samples - levels) / (samples - levels)
    return float(1.0 - (samples - 1) / (samples - levels) / (1.0 + ratio))


@dataclass(frozen=True)
class Judgement:
    """What came out for one claim; the names are those of result.json.

    Parameters
    ----------
    margin : float
        At the settings.
    holds_at_the_settings : bool
        Whether that is positive.
    verdict, condition : str
        One of `VERDICTS`, and when the claim holds if that is "holds only if".
    share_of_sweep, undecided : float, int
        Of the random combinations the share in which the claim holds, NaN without any; and the number in
        which a walk failed.
    decides, share_by_level : str, dict
        The setting that explains more of the outcome than any other and than chance, if there is one; and the
        share of the combinations in which the claim holds, by the level of that setting.
    sensitivity : dict
        Share of the outcome's variance that each setting explains.
    single_changes, turned_by : dict, list
        Margins by single changes, "setting=level", and those changes that turn the outcome.
    """

    margin: float
    holds_at_the_settings: bool
    verdict: str
    condition: str
    share_of_sweep: float
    undecided: int
    decides: str
    share_by_level: dict[str, float]
    sensitivity: dict[str, float]
    single_changes: dict[str, float]
    turned_by: list[str]


def judge(margin: float, swept: Array, plan: Plan, about: str) -> Judgement:
    """Judge one claim.

    Parameters
    ----------
    margin : float
        At the settings.
    swept : (changes,)
        Margins of the plan's single changes, then of its random combinations.
    plan : Plan
        What was tried.
    about : str
        The walks that the claim is about; only factors that move them can decide it.
    """
    holds = margin > 0.0
    singles = dict(zip(plan.names, swept.tolist(), strict=False))
    margins = swept[len(singles) :]
    known = np.isfinite(margins)
    held = np.where(known, margins > 0.0, np.nan)
    share = float(held[known].mean()) if known.any() else NAN
    columns = {f.setting: (f, plan.levels[:, i]) for i, f in enumerate(plan.chosen) if about in f.moves}
    explained = {setting: sensitivity(held, column) for setting, (_, column) in columns.items()}
    decides = max(explained, key=lambda setting: explained[setting])
    factor, column = columns[decides]
    rates: dict[str, float] = {}
    if explained[decides] > chance(int(known.sum()), len(factor.levels)):
        rates = _rates(factor, column[known], held[known])
    else:
        decides = ""
    return Judgement(
        margin,
        holds,
        *verdict(holds, share, rates, decides),
        share_of_sweep=share,
        undecided=int((~known).sum()),
        decides=decides,
        share_by_level=rates,
        sensitivity=explained,
        single_changes=singles,
        turned_by=[name for name, m in singles.items() if np.isfinite(m) and (m > 0.0) != holds],
    )


def _rates(factor: Factor, column: NDArray[np.int64], held: Array) -> dict[str, float]:
    groups = {shown(level): held[column == v] for v, level in enumerate(factor.levels)}
    return {level: float(group.mean()) if len(group) else NAN for level, group in groups.items()}


def verdict(holds: bool, share: float, rates: Mapping[str, float], decides: str) -> tuple[str, str]:
    """Return one of `VERDICTS`, and the condition of "holds only if": the levels at which it mostly holds."""
    if np.isnan(share) or (share >= ALWAYS and holds) or (share <= 1.0 - ALWAYS and not holds):
        return ("holds" if holds else "does not hold"), ""
    if not decides:
        return "holds only if", "several settings combine"
    rates = {level: rate for level, rate in rates.items() if np.isfinite(rate)}
    top = max(rates.values())
    good = [level for level, rate in rates.items() if rate >= max(0.5, 0.9 * top)] or [
        level for level, rate in rates.items() if rate == top
    ]
    there, elsewhere = (
        [rate for level, rate in rates.items() if (level in good) is inside] for inside in (True, False)
    )
    several = "" if top >= ALWAYS else "several settings combine, above all "
    shares = f"{100 * np.mean(there):.0f} %"
    shares += f", else {100 * np.mean(elsewhere):.0f} %" if elsewhere else ""
    return "holds only if", f"{several}{decides} = {' or '.join(good)} ({shares})"


def summary(verdicts: Sequence[str]) -> str:
    """Return how many claims hold, in one line."""
    hold, depend, fail = (verdicts.count(verdict) for verdict in VERDICTS)
    return f"{len(verdicts)} claims: {hold} hold, {depend} hold only under some settings, {fail} do not hold"
