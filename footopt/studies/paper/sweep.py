"""What the paper leaves open, as settings and their levels; and which of them decides a claim."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.studies.settings import Config

Array = NDArray[np.float64]

ALWAYS = 0.95  # share of the sweep in which a claim must hold to hold; and, from 1, to not hold


@dataclass(frozen=True)
class Factor:
    """One thing that the paper leaves open.

    setting : by its name on the command line. levels : values to try; where a sweep starts from is
    the setting's own value. moves : which walks depend on it, the five shapes' or the optima's.
    """

    setting: str
    levels: tuple[Any, ...]
    why: str
    moves: tuple[str, ...] = ("shapes", "optima")


FACTORS = (
    Factor("foot.ankle", ([0.0, 0.0], [-0.03, 0.0], [-0.06, 0.0], [0.0, 0.05]), "not given"),
    Factor("foot.width", (0.10, 0.05, 0.15), "not given; acts like zeta"),
    Factor("foot.apex", ("middle", "toe"), "the drawing of the triangle", ("shapes",)),
    Factor("foot.upright", ("toe", "heel"), "the drawing of the L", ("shapes",)),
    Factor("study.mount", ("centre", "top"), "where the shank meets a shape", ("shapes",)),
    Factor("study.shape_sand", ("regular", "soft", "hard"), "the shapes' sand", ("shapes",)),
    Factor("gait.pitch", ("shank", "measured"), "theta_A: ankle locked, or as measured"),
    Factor("gait.harmonics", (6, 4, 2), "the gait's own data"),
    Factor("scene.t_f", (2.9, 2.6, 3.5), "t_f, s"),
    Factor("study.speed_loss", ("walk", "window", "narrow"), "dV_x is not defined"),
    Factor("study.peak_power", ("stance", "single"), "p_max: formula against text"),
    Factor("study.leading_edge", (False, True), "do trailing faces feel sand"),
    Factor("foot.box_tolerance", (0.05, float("inf")), "may the spline leave the box", ("optima",)),
    Factor("solver.seed", (1, 2, 3, 4, 5), "the search is random", ("optima",)),
)


def get(config: Config, setting: str) -> Any:
    """A setting by its name on the command line."""
    value: Any = config
    for part in setting.split("."):
        value = getattr(value, part)
    return value


def changed(config: Config, settings: Mapping[str, Any]) -> Config:
    """The configuration with some settings changed; the one given is left alone."""
    for setting, value in settings.items():
        group, name = setting.split(".")
        part = replace(getattr(config, group), **{name: value})
        config = replace(config, **{group: part})
    return config


def factors(config: Config) -> tuple[Factor, ...]:
    """`FACTORS` with the configuration's own value as the first level of each."""
    found = []
    for factor in FACTORS:
        own = get(config, factor.setting)
        if factor.setting == "scene.t_f" and own is None:
            own = config.gait.start + 2.0 * (config.gait.period or 1.2)
        found.append(replace(factor, levels=(own, *(v for v in factor.levels if v != own))))
    return tuple(found)


def one_at_a_time(chosen: Sequence[Factor]) -> list[dict[str, Any]]:
    """Every single change from the first levels.

    The seed's own level is among them: it shows what the sweep's smaller search changes by itself.
    """
    return [
        {factor.setting: level}
        for factor in chosen
        for level in factor.levels[0 if factor.setting == "solver.seed" else 1 :]
    ]


def combinations(chosen: Sequence[Factor], samples: int, seed: int) -> NDArray[np.int64]:
    """Random combinations of levels, (samples, factors), each level equally often but for remainders.

    A Latin hypercube of levels: every factor's levels are dealt out evenly and shuffled on their own.
    """
    rng = np.random.default_rng(seed)
    columns = [rng.permutation(np.arange(samples) % len(factor.levels)) for factor in chosen]
    return np.stack(columns, axis=1)


def sensitivity(held: Array, level: NDArray[np.int64]) -> float:
    """Share of a claim's variance (holds 1, holds not 0) that a factor's levels explain, 0 to 1.

    The correlation ratio without its bias for many levels (epsilon squared, Kelley 1935).

    Parameters
    ----------
    held : (samples,), 1, 0, or NaN where it could not be decided. level : (samples,)
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
    """The sensitivity that a setting without any influence stays below in 95 % of sweeps."""
    from scipy.stats import f

    if samples <= levels or levels < 2:
        return 1.0
    ratio = (levels - 1) * f.ppf(0.95, levels - 1, samples - levels) / (samples - levels)
    return float(1.0 - (samples - 1) / (samples - levels) / (1.0 + ratio))


@dataclass(frozen=True)
class Judgement:
    """What came out for one claim.

    margin : at the settings. verdict : in words. share : of the random combinations in which it
    holds, NaN without any; undecided : of those where a walk failed, a number. sensitivities : by
    setting. decides : the setting that explains most, if more than by chance; rates : share by its
    level. flips : single changes that turn the outcome, as "setting=level".
    """

    margin: float
    verdict: str
    share: float
    undecided: int
    decides: str
    sensitivities: dict[str, float]
    rates: dict[str, float]
    flips: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """At the settings."""
        return self.margin > 0.0


def judge(
    margin: float,
    alone: Iterable[tuple[str, float]],
    margins: Array,
    levels: NDArray[np.int64],
    chosen: Sequence[Factor],
    about: str,
) -> Judgement:
    """Judge one claim.

    Parameters
    ----------
    margin : at the settings. alone : single changes, "setting=level", and the margins they give.
    margins : (samples,), of random combinations. levels : (samples, factors), their levels.
    about : the walks that the claim is about; only factors that move them can decide it.
    """
    holds = margin > 0.0
    flips = tuple(name for name, m in alone if np.isfinite(m) and (m > 0.0) != holds)
    held = np.where(np.isfinite(margins), margins > 0.0, np.nan)
    known = held[np.isfinite(held)]
    share = float(known.mean()) if len(known) else float("nan")
    sensitivities = {
        f.setting: sensitivity(held, levels[:, i]) for i, f in enumerate(chosen) if about in f.moves
    }
    decides, rates = max(sensitivities, key=lambda s: sensitivities[s]), {}
    i = [f.setting for f in chosen].index(decides)
    if sensitivities[decides] > chance(len(known), len(chosen[i].levels)):
        for v, level in enumerate(chosen[i].levels):
            group = held[(levels[:, i] == v) & np.isfinite(held)]
            rates[shown(level)] = float(group.mean()) if len(group) else float("nan")
    else:
        decides = ""
    return Judgement(
        margin=margin,
        verdict=verdict(holds, share, rates, decides),
        share=share,
        undecided=len(held) - len(known),
        decides=decides,
        sensitivities=sensitivities,
        rates=rates,
        flips=flips,
    )


def verdict(holds: bool, share: float, rates: Mapping[str, float], decides: str) -> str:
    """holds, does not hold, or holds only if; with the levels at which it mostly does."""
    plain = "holds" if holds else "does not hold"
    if np.isnan(share) or (share >= ALWAYS and holds) or (share <= 1.0 - ALWAYS and not holds):
        return plain
    if not decides:
        return "holds only if several agree"
    top = max(rates.values())
    good = [level for level, rate in rates.items() if rate >= max(0.5, 0.9 * top)] or [
        level for level, rate in rates.items() if rate == top
    ]
    there, elsewhere = (
        np.mean([rate for level, rate in rates.items() if (level in good) is inside] or [np.nan])
        for inside in (True, False)
    )
    several = "" if top >= ALWAYS else "several agree, mostly "
    return f"holds only if {several}{decides} = {' or '.join(good)} ({there:.0%}, else {elsewhere:.0%})"


def shown(level: Any) -> str:
    """A level as one writes it on the command line."""
    if isinstance(level, (list, tuple)):
        return "[" + ",".join(f"{v:g}" for v in level) + "]"
    return f"{level:g}" if isinstance(level, float) else str(level)
