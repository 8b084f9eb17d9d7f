"""A genetic algorithm whose moves suit a spline: the default for one objective.

A spline through waypoints answers to neighbours that move together: where one waypoint alone would
make a bump that costs more than the new level brings, a run of them shifts the sole without one. Random
soles that are improved by single steps of one waypoint end in as many local optima; by shifts of
runs, on soft sand, all in the same one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.crossover import Crossover
from pymoo.core.mutation import Mutation
from pymoo.core.population import Population
from pymoo.operators.sampling.rnd import IntegerRandomSampling

from footopt.design.solvers.operators import SameHeights

Ints = NDArray[np.int64]

PATIENCE = 10  # generations without a better design before the best one's neighbours are asked for


@lru_cache(maxsize=4)
def shifts(n: int) -> NDArray[np.int8]:
    """Every run of neighbours among n waypoints, one level down and one level up: (n (n + 1), n)."""
    first, last = np.triu_indices(n)
    at = np.arange(n)
    run = ((first[:, None] <= at) & (at <= last[:, None])).astype(np.int8)
    return np.stack([run, -run], axis=1).reshape(-1, n)


class ExchangeRun(Crossover):  # type: ignore[misc]  # pymoo has no types
    """Two parents exchange one run of neighbouring waypoints, of any length: a stretch of the sole."""

    def __init__(self) -> None:
        super().__init__(n_parents=2, n_offsprings=2, prob=0.9)

    def _do(self, problem: Any, X: Ints, random_state: Any = None, **kwargs: Any) -> Ints:
        runs = shifts(problem.n_var)[::2]
        exchanged = runs[random_state.integers(len(runs), size=X.shape[1])] > 0
        return np.where(exchanged, X[::-1], X)


class ShiftRun(Mutation):  # type: ignore[misc]  # pymoo has no types
    """Move one run of neighbouring waypoints, of any length, by one level."""

    def _do(self, problem: Any, X: Ints, random_state: Any = None, **kwargs: Any) -> Ints:
        moves = shifts(problem.n_var)
        moved = X + moves[random_state.integers(len(moves), size=len(X))]
        out: Ints = np.clip(moved, problem.xl.astype(np.int64), problem.xu.astype(np.int64))
        return out


class NeverTwice(SameHeights):
    """Drop designs that were ever asked for, which those of the population were, or come twice."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: set[bytes] = set()

    def do(self, pop: Any, *others: Any, **kwargs: Any) -> Any:
        """What is new of `pop`: never asked for, and not in the last of the others (what was just found)."""
        found = set(self._rows(others[-1])) if others and len(others[-1]) else set()
        new = []
        for key in self._rows(pop) if len(pop) else ():
            new.append(key not in found and key not in self.asked)
            found.add(key)
        return pop[new] if len(pop) else pop


class Memetic(GA):  # type: ignore[misc]  # pymoo has no types
    """`ExchangeRun`, `ShiftRun`, no design twice, and where it stalls the best one's neighbourhood.

    When the best design has stood for `PATIENCE`
    generations, all its shifts that were not asked for yet take up to half of the next ones, so that
    what a run that stalls returns is a local optimum. To ask for them at once would be quicker on
    average, but converge too early now and then.
    """

    def __init__(self, pop_size: int) -> None:
        self._never_twice = NeverTwice()
        self._best, self._age = b"", 0
        super().__init__(
            pop_size=pop_size,
            sampling=IntegerRandomSampling(),
            crossover=ExchangeRun(),
            mutation=ShiftRun(),
            eliminate_duplicates=self._never_twice,
        )

    def _initialize_infill(self) -> Any:
        return self._remember(super()._initialize_infill())

    def _infill(self) -> Any:
        polish = self._neighbours()[: self.pop_size // 2]
        self.n_offsprings = self.pop_size - len(polish)
        self._remember(polish)
        offspring = super()._infill()  # None when nothing new is found
        if offspring is None:
            return polish if len(polish) else None
        return self._remember(Population.merge(polish, offspring))

    def _neighbours(self) -> Any:
        """The best design's shifts that were not asked for yet, if it has stood long enough."""
        best = self.pop[:1]
        key = best.get("X").tobytes()
        self._age = self._age + 1 if key == self._best else 0
        self._best = key
        if self._age < PATIENCE:
            return Population.new()
        k = best.get("X") + shifts(self.problem.n_var)
        k = k[((k >= self.problem.xl) & (k <= self.problem.xu)).all(axis=1)]
        return self._never_twice.do(Population.new("X", self.random_state.permutation(k)))

    def _remember(self, asked: Any) -> Any:
        self._never_twice.asked.update(self._never_twice._rows(asked) if len(asked) else ())
        return asked
