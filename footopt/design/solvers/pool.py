"""`Pool`: a population with its columns, as solvers read it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from pymoo.core.population import Population

from footopt.arrays import Array, Ints
from footopt.design.fronts import extended


class Pool(NamedTuple):
    """A population, and its heights, objectives and violation, a row each: pymoo asks every individual."""

    pop: Any
    X: Ints
    F: Array
    violation: Array

    @classmethod
    def of(cls, pop: Any) -> Pool:
        """A population."""
        X, F, violation = (np.array([getattr(one, of) for one in pop.tolist()]) for of in ("X", "F", "CV"))
        return cls(pop, X.astype(np.int64), F.astype(float), violation[:, 0])

    def take(self, rows: Any) -> Pool:
        """Some of its designs."""
        return Pool(*(column[rows] for column in self))

    def joined(self, new: Pool) -> Pool:
        """These and others."""
        columns: Any = map(np.concatenate, zip(self[1:], new[1:], strict=True))
        return Pool(Population.merge(self.pop, new.pop), *columns)

    def order(self) -> Ints:
        """Places for one objective, best first: the feasible, then the least violation."""
        return np.lexsort((self.F[:, 0], np.maximum(self.violation, 0.0)))

    def front_with(self, new: Pool) -> tuple[Pool, int]:
        """A front and what others add to it, and how many; without a feasible design, of least violation."""
        every = self.joined(new)
        rows = np.flatnonzero(every.violation <= max(every.violation.min(), 0.0))
        old, F = np.count_nonzero(rows < len(self.X)), every.F[rows]
        kept = rows[extended(F[:old], F[old:])]
        return every.take(kept), int((kept >= len(self.X)).sum())
