"""Measure the claims again for other choices where the paper leaves one: what is open, and what is tried."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FootoptError
from footopt.files.tasks import Tasks
from footopt.foot import Foot
from footopt.studies.paper.claims import CLAIMS, SANDS, measure
from footopt.studies.paper.setup import Setup, changed
from footopt.studies.settings import Config

Array = NDArray[np.float64]
Change = dict[str, Any]  # values by the settings' names

POP_SIZE, N_GEN = 40, 40  # where the sweep searches again, at most


@dataclass(frozen=True)
class Factor:
    """One thing that the paper leaves open.

    Parameters
    ----------
    setting : str
        Its name on the command line.
    levels : tuple
        Values to try; a sweep starts from the setting's own value.
    why : str
        What the paper does not say.
    moves : tuple of str
        The walks that depend on it: those of the five "shapes", of the "optima", or both.
    """

    setting: str
    levels: tuple[Any, ...]
    why: str
    moves: tuple[str, ...] = ("shapes", "optima")


FACTORS = (
    Factor("foot.ankle", ([0.0, 0.0], [-0.03, 0.0], [-0.06, 0.0], [0.0, 0.05]), "where the ankle is"),
    Factor("foot.width", (0.10, 0.05, 0.15), "how wide the foot is; it acts like zeta"),
    Factor("foot.apex", ("middle", "toe"), "how the triangle stands", ("shapes",)),
    Factor("foot.upright", ("toe", "heel"), "how the L stands", ("shapes",)),
    Factor("study.mount", ("centre", "top"), "where the shank meets a shape", ("shapes",)),
    Factor("study.shape_sand", ("regular", "soft", "hard"), "on which sand the shapes walk", ("shapes",)),
    Factor("gait.pitch", ("shank", "measured"), "whether the ankle is locked or moves as measured"),
    Factor("gait.harmonics", (6, 4, 2), "which data the gait is"),
    Factor("scene.t_f", (2.9, 2.6, 3.5), "when the walk ends, s"),
    Factor("study.speed_loss", ("walk", "window", "narrow"), "what dV_x is"),
    Factor("study.peak_power", ("stance", "single"), "whether the formula or the text defines p_max"),
    Factor("study.leading_edge", (False, True), "whether faces that trail feel sand"),
    Factor("foot.box_tolerance", (0.05, float("inf")), "whether the spline may leave the box", ("optima",)),
    Factor("solver.seed", (1, 2, 3, 4, 5), "which random numbers the search draws", ("optima",)),
    Factor("study.shadowing", (None, "sole", "motion"), "which hull hides what lies in a groove"),
)


def factors(config: Config) -> tuple[Factor, ...]:
    """Return `FACTORS` with the configuration's own value as the first level of each."""
    found = []
    for factor in FACTORS:
        group, name = factor.setting.split(".")
        own = getattr(getattr(config, group), name)
        if factor.setting == "scene.t_f" and own is None:
            own = config.gait.start + 2.0 * (config.gait.period or 1.2)
        found.append(replace(factor, levels=(own, *(v for v in factor.levels if v != own))))
    return tuple(found)


def combinations(chosen: tuple[Factor, ...], samples: int, seed: int) -> NDArray[np.int64]:
    """Draw random combinations of levels, (samples, factors), each level equally often but for remainders.

    They are a Latin hypercube of levels: the levels of every factor are dealt out evenly and shuffled.
    """
    rng = np.random.default_rng(seed)
    columns = [rng.permutation(np.arange(samples) % len(factor.levels)) for factor in chosen]
    return np.stack(columns, axis=1)


@dataclass(frozen=True, eq=False)
class Plan:
    """What a sweep tries: every single change from the settings, then random combinations.

    Parameters
    ----------
    config : Config
        The settings that are changed, with a smaller search, on one thread.
    chosen : tuple of Factor
        The factors, the settings' own values first.
    singles : list of dict
        Single changes; among them the seed's own level, which shows what the smaller search changes.
    levels : (samples, factors)
        Indices into the levels of the random combinations.
    """

    config: Config
    chosen: tuple[Factor, ...]
    singles: list[Change]
    levels: NDArray[np.int64]

    @classmethod
    def of(cls, config: Config) -> Plan:
        """Plan a sweep of `study.samples` combinations; with none there are no single changes either."""
        chosen, samples, solver = factors(config), config.study.samples, config.solver
        singles: list[Change] = [
            {factor.setting: level}
            for factor in chosen
            for level in factor.levels[0 if factor.setting == "solver.seed" else 1 :]
        ]
        pop_size, n_gen = min(POP_SIZE, solver.pop_size or POP_SIZE), min(N_GEN, solver.n_gen or N_GEN)
        few = {"solver.pop_size": pop_size, "solver.n_gen": n_gen, "engine.threads": 1}
        return cls(
            config=changed(config, few),
            chosen=chosen,
            singles=singles if samples else [],
            levels=combinations(chosen, samples, solver.seed),
        )

    @property
    def changes(self) -> list[Change]:
        """Single changes, then combinations."""
        drawn = [
            {f.setting: f.levels[v] for f, v in zip(self.chosen, row, strict=True)} for row in self.levels
        ]
        return [*self.singles, *drawn]

    @property
    def names(self) -> list[str]:
        """The single changes as "setting=level"."""
        return [f"{setting}={shown(level)}" for change in self.singles for setting, level in change.items()]

    def moves_feet(self, change: Change) -> bool:
        """Whether a change can move the best feet, so that they are searched again."""
        return any(f.setting in change and "optima" in f.moves for f in self.chosen)


def shown(level: Any) -> str:
    """Return a level as one writes it on the command line; JSON, which has no infinity, holds None for it."""
    if isinstance(level, (list, tuple)):
        return "[" + ",".join(f"{v:g}" for v in level) + "]"
    return "inf" if level is None else f"{level:g}" if isinstance(level, float) else str(level)


def sweep(
    plan: Plan,
    optima: Mapping[str, Foot],
    threads: int,
    step: Callable[[], None] = lambda: None,
    done: Tasks | None = None,
) -> Array:
    """Measure the claims for every change of a plan.

    Feet are searched again wherever a change could move them, by one run of the GA.

    Parameters
    ----------
    plan : Plan
        What is tried.
    optima : dict of Foot
        The best foot of each sand at the settings, for the other changes.
    threads : int
        Threads; they work on different changes.
    step : callable
        Called after every change.
    done : Tasks, optional
        Where margins are kept, and read again.

    Returns
    -------
    margins : (changes, claims)
        NaN where a walk failed, or where a search found no foot at all.
    """
    changes, done = plan.changes, done or Tasks()
    worn = [foot.k for foot in optima.values()]

    def margins(change: Change) -> Array:
        setup = Setup(changed(plan.config, change))
        task = ([setup.named(sand) for sand in SANDS], plan.moves_feet(change) or worn)
        return np.array(done(task, lambda: measured(setup, change).tolist()))

    def measured(setup: Setup, change: Change) -> Array:
        seed = setup.config.solver.seed
        try:
            feet = {sand: setup.best(sand, seed) for sand in SANDS} if plan.moves_feet(change) else optima
        except FootoptError:
            return np.full(len(CLAIMS), np.nan)
        return measure(setup.evidence(feet))

    rows = np.full((len(changes), len(CLAIMS)), np.nan)
    with ThreadPoolExecutor(threads) as pool:
        futures = {pool.submit(margins, change): i for i, change in enumerate(changes)}
        try:
            for future in as_completed(futures):
                rows[futures[future]] = future.result()
                step()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return rows
