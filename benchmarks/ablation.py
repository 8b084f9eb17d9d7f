"""What each part of the default search is worth: `memetic` without one after the other, counted in walks.

`python benchmarks/ablation.py` searches the scenes of `solvers.py`, and keeps its rows in the same
file, `outputs/optimisers.csv`, so that all are judged by the same best known soles. With --quick: one scene,
one seed, 100 walks.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from solvers import main

from footopt.design import SINGLE, SOLVERS
from footopt.design.solvers.memetic import CROSSED, TWICE, Memetic


class WithoutModel(Memetic):
    """No model chooses among children: the first ones are asked for."""

    def _screened(self, X: Any, count: int) -> Any:
        return X


class WithoutDescents(Memetic):
    """Where it stalls, the best one's neighbourhood is not asked for."""

    def _near(self, count: int) -> Any:
        return np.empty((0, self.problem.n_var), np.int64)


class WithoutRestarts(Memetic):
    """Where it has stalled for long, it goes on with the parents that it has."""

    def _restart(self, size: int) -> Any:
        return np.empty((0, self.problem.n_var), np.int64)


class WithoutRuns(Memetic):
    """Children differ from their parents by single waypoints, not by runs of neighbours."""

    def _moved(self, count: int) -> Any:
        draw = self.random_state
        X = self._parents(count)
        n = X.shape[1]

        def stepped(X: Any) -> Any:
            at = draw.integers(n, size=count)
            return X + (np.arange(n) == at[:, None]) * draw.choice([-1, 1], count)[:, None]

        crossed = draw.random(count) < CROSSED
        uniform = np.where(draw.random(X.shape) < 0.5, self._parents(count), X)
        X = np.where(crossed[:, None], uniform, X)
        coin = draw.random(count)
        often = np.where(crossed, coin < 0.5, 1 + (coin < TWICE))
        X = np.where((often > 0)[:, None], stepped(X), X)
        return np.where((often > 1)[:, None], stepped(X), X)


VARIANTS = {
    "without its model": WithoutModel,
    "without descents": WithoutDescents,
    "without restarts": WithoutRestarts,
    "without moves of runs": WithoutRuns,
}

if __name__ == "__main__":
    for name, solver in VARIANTS.items():
        SOLVERS[name] = lambda given, n_obj, solver=solver: solver(given.pop_size)
        SINGLE.append(name)
    main(("memetic", *VARIANTS), __doc__)
