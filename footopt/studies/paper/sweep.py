"""Measure the claims again for other choices where the paper leaves one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FootoptError
from footopt.foot import Foot
from footopt.studies.paper.claims import CLAIMS, measure
from footopt.studies.paper.evidence import SANDS
from footopt.studies.paper.factors import Change, Plan, changed
from footopt.studies.paper.setup import Setup
from footopt.studies.settings import Config

Array = NDArray[np.float64]

#: What takes as long as so many walks of a design: pymoo's part of a generation; measuring all claims.
GENERATION, EVIDENCE = 40.0, 500.0


def cost_of_search(config: Config, threads: int) -> float:
    """Return about how long a search takes, in walks of a design; threads do not share pymoo's part."""
    return config.solver.n_gen * (config.solver.pop_size / threads + GENERATION)


def costs(plan: Plan, threads: int) -> list[float]:
    """Return about how long every change of a plan takes, in walks of a design."""
    searches = len(SANDS) * cost_of_search(plan.config, threads)
    return [EVIDENCE / threads + searches * plan.moves_feet(change) for change in plan.changes]


def sweep(
    plan: Plan, optima: Mapping[str, Foot], threads: int, step: Callable[[float], None] = lambda cost: None
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
        Called with the cost of every change that is done.

    Returns
    -------
    margins : (changes, claims)
        NaN where a walk failed, or where a search found no foot at all.
    """
    changes = plan.changes

    def margins(change: Change) -> Array:
        setup = Setup(changed(plan.config, change))
        seed = setup.config.solver.seed
        try:
            feet = {sand: setup.best(sand, seed) for sand in SANDS} if plan.moves_feet(change) else optima
        except FootoptError:
            return np.full(len(CLAIMS), np.nan)
        return measure(setup.evidence(feet))

    rows = np.full((len(changes), len(CLAIMS)), np.nan)
    cost = costs(plan, threads)
    with ThreadPoolExecutor(threads) as pool:
        futures = {pool.submit(margins, change): i for i, change in enumerate(changes)}
        try:
            for future in as_completed(futures):
                rows[futures[future]] = future.result()
                step(cost[futures[future]])
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return rows
