"""Every design of a small space: the exact best, or the exact front."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from pymoo.core.algorithm import Algorithm
from pymoo.core.population import Population

from footopt.arrays import Ints
from footopt.design.solvers.moves import allowed


def batches(n: int, K: int, size: int) -> Iterator[Ints]:
    """Every row of n whole numbers from 1 to K, `size` at a time; the last number counts fastest."""
    total, powers = K**n, K ** np.arange(n)[::-1]
    for begin in range(0, total, size):
        yield 1 + np.arange(begin, min(begin + size, total))[:, None] // powers % K


class Exhaustive(Algorithm):
    """Ask for every design that is inside its box, in order; a generation are those of `pop_size` rows."""

    def __init__(self, pop_size: int, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.pop_size = pop_size
        self._left: Iterator[Ints] = iter(())

    def _setup(self, problem: Any, **kwargs: Any) -> None:
        self._left = batches(problem.n_var, int(problem.xu[0]), self.pop_size)

    def _infill(self) -> Any:
        for k in self._left:
            if len(inside := k[allowed(self.problem, k)]):
                return Population.new(X=inside)
        self.termination.force_termination = True
        return None

    _initialize_infill = _infill
