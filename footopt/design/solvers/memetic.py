"""The default solvers: the fewest walks by moves that suit a spline, descents, and restarts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.core.initialization import Initialization
from pymoo.core.population import Population
from pymoo.util.display.multi import MultiObjectiveOutput
from pymoo.util.display.single import SingleObjectiveOutput

from footopt.design.solvers.moves import DRAWS, RandomInside, allowed, exchanged, shifted, shifts
from footopt.design.solvers.registry import grown

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

PARENTS = 10  # of one objective, at first; twice as many after each restart
PATIENCE = 8  # generations without a better design before the best one's neighbours are asked for
CROSSED = 0.4  # share of the children that have two parents
TWICE = 0.2  # share of the others that are shifted twice


class Moves(Algorithm):  # type: ignore[misc]  # pymoo has no types
    """What the solvers by moves have in common: no design twice, none outside its box, growing batches.

    Parameters
    ----------
    pop_size : int, optional
        Designs a generation; by default a tenth of all designs so far, from `FIRST` to `MOST`.
    """

    def __init__(self, pop_size: int | None = None, sampling: Any = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.pop_size = pop_size
        self.initialization = Initialization(RandomInside() if sampling is None else sampling)
        self.asked: set[bytes] = set()

    def _setup(self, problem: Any, **kwargs: Any) -> None:
        several = problem.n_obj > 1
        if self.output is None:
            self.output = MultiObjectiveOutput() if several else SingleObjectiveOutput()
            self.display.output = self.output

    def _size(self) -> int:
        """Designs of the next generation."""
        return self.pop_size or grown(len(self.asked))

    def _initialize_infill(self) -> Any:
        drawn = self.initialization.do(self.problem, self._size(), random_state=self.random_state)
        return Population.new(X=self._new(np.round(drawn.get("X").astype(float)).astype(np.int64), len(drawn)))

    def _infill(self) -> Any:
        size = self._size()
        found = self._propose(size)
        for _ in range(DRAWS):
            if len(found) >= size:
                break
            found = np.concatenate([found, self._new(self._children(4 * size), size - len(found))])
        if not len(found):
            found = self._drawn(size)
        if not len(found):  # of a small space no more is found
            self.termination.force_termination = True
            return None
        return Population.new(X=found)

    def _drawn(self, count: int) -> Ints:
        """New designs drawn at random."""
        return self._new(RandomInside().do(self.problem, 4 * count, random_state=self.random_state).get("X"), count)

    def _new(self, X: Ints, count: int) -> Ints:
        """The first `count` designs that are allowed and were never asked for, which they now are."""
        kept = []
        for x in X[allowed(self.problem, X)]:
            if len(kept) == count:
                break
            key = x.tobytes()
            if key not in self.asked:
                self.asked.add(key)
                kept.append(x)
        return np.array(kept, np.int64).reshape(-1, self.problem.n_var)

    def _children(self, count: int) -> Ints:
        """Children of the parents that a solver draws: exchanged, shifted, or both."""
        draw = self.random_state
        X = self._parents(count)
        crossed = draw.random(count) < CROSSED
        X = np.where(crossed[:, None], exchanged(X, self._parents(count), draw), X)
        coin = draw.random(count)
        often = np.where(crossed, coin < 0.5, 1 + (coin < TWICE))
        X = np.where((often > 0)[:, None], shifted(X, draw), X)
        return np.where((often > 1)[:, None], shifted(X, draw), X)

    def _parents(self, count: int) -> Ints:
        raise NotImplementedError

    def _propose(self, size: int) -> Ints:
        """Designs that are asked for ahead of children."""
        return np.empty((0, self.problem.n_var), np.int64)


class Memetic(Moves):
    """One objective: few parents, their children, the best one's neighbourhood where it stalls, restarts."""

    def __init__(self, pop_size: int | None = None, **kwargs: Any) -> None:
        super().__init__(pop_size, **kwargs)
        self.parents, self.age, self.restarts = PARENTS, 0, 0
        self.champion: Any = None

    def _initialize_advance(self, infills: Any = None, **kwargs: Any) -> None:
        self.pop = infills[order(infills)[: self.parents]]

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        pool = Population.merge(self.pop, infills)
        best = order(pool)[: self.parents]
        self.age = 0 if best[0] >= len(self.pop) else self.age + 1
        self.pop = pool[best]

    def _set_optimum(self) -> None:
        pool = self.pop[:1] if self.champion is None else Population.merge(self.champion, self.pop[:1])
        self.opt = self.champion = pool[order(pool)[:1]]

    def _parents(self, count: int) -> Ints:
        """The better, the more often: the square of a uniform number picks the place."""
        place = (len(self.pop) * self.random_state.random(count) ** 2).astype(np.int64)
        return self.pop.get("X")[place].astype(np.int64)

    def _propose(self, size: int) -> Ints:
        """Where it stalls, the best one's neighbourhood, in half of a generation; then a restart."""
        if self.age < PATIENCE:
            return super()._propose(size)
        near = self.pop[0].X.astype(np.int64) + shifts(self.problem.n_var)
        found = self._new(self.random_state.permutation(near), max(size // 2, 1))
        if len(found) or self.age < 3 * PATIENCE:
            return found
        self.age, self.restarts, self.parents = 0, self.restarts + 1, min(2 * self.parents, 8 * PARENTS)
        drawn = self._drawn(size)
        self.pop = self.pop[:0] if len(drawn) == size else self.pop
        return drawn


class Archive(Moves):
    """Several objectives: every design that no other dominates is a parent (Knowles & Corne 2000)."""

    def _initialize_advance(self, infills: Any = None, **kwargs: Any) -> None:
        self.pop = front(infills)

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        self.pop = front(Population.merge(self.pop, infills))

    def _parents(self, count: int) -> Ints:
        chosen = self.random_state.integers(len(self.pop), size=count)
        return self.pop.get("X")[chosen].astype(np.int64)


def order(pop: Any) -> Ints:
    """Places of a population for one objective, best first: the feasible, then the least violation."""
    f, violation = pop.get("F")[:, 0], pop.get("CV")[:, 0]
    return np.lexsort((f, np.maximum(violation, 0.0)))


def front(pop: Any) -> Any:
    """What of a population is not dominated; without a feasible design those of least violation."""
    from moocore import is_nondominated

    violation = pop.get("CV")[:, 0]
    pop = pop[violation <= max(violation.min(), 0.0)]
    return pop[is_nondominated(np.ascontiguousarray(pop.get("F"), float), keep_weakly=True)]
