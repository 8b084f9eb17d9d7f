"""`Pool`, a population with its columns, and `RankModel`, which predicts ranks of designs from known ones."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from pymoo.core.population import Population
from scipy.linalg.lapack import dposv

from footopt.arrays import Array, Ints
from footopt.design.fronts import nondominated, ranks

TRAINED = 250  # designs that a model knows at most: half of them the newest, the others the best
WIDTH, SMOOTHING = 0.7, 1e-3  # one over the Gaussians' length, in the range of heights; added to their matrix


class Pool(NamedTuple):
    """A population with its heights, objectives and violations as arrays, a row for each individual."""

    pop: Any
    X: Ints
    F: Array
    violation: Array

    @classmethod
    def of(cls, pop: Any) -> Pool:
        """The pool of a population."""
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
        kept = rows[nondominated(every.F[rows])]
        return every.take(kept), int((kept >= len(self.X)).sum())


class Memory(NamedTuple):
    """Designs that a model may be made of: the newest, and the best by each objective."""

    X: Ints  # (designs, n), heights, in the order in which they were evaluated
    F: Array  # (designs, objectives), minimised
    told: int = 0  # designs evaluated so far, including those that are forgotten

    def joined(self, X: Ints, F: Array) -> Memory:
        """With new designs, without the old ones that are not among the best `TRAINED` by any objective."""
        told, X, F = self.told + len(X), np.concatenate([self.X, X]), np.concatenate([self.F, F])
        kept = np.arange(len(F)) >= len(F) - TRAINED // 2
        kept |= (ranks(F) < TRAINED).any(axis=1)
        return Memory(X[kept], F[kept], told)

    def trained(self) -> tuple[Ints, Array]:
        """Heights and objectives of the newest designs and the best others."""
        older = len(self.X) - TRAINED // 2 if self.told > TRAINED else 0
        best = ranks(self.F).min(axis=1)[:older].argsort(kind="stable")[: TRAINED // 2]
        chosen = np.concatenate([np.sort(best), np.arange(older, len(self.X))])
        return self.X[chosen], self.F[chosen]


class RankModel:
    """Interpolates ranks by each objective with Gaussian radial basis functions and a constant.

    Soles are as far from each other as their heights and the differences of neighbours are: few of these
    change where a run is shifted. It is made of the heights of `known` designs (designs, n), of their
    objectives F (designs, objectives), minimised, and of the largest height, `top`.
    """

    def __init__(self, known: Ints, F: Array, top: int) -> None:
        self.ranks = ranks(F) / len(F)
        self._scale, rows = -((WIDTH / top) ** 2), _rows(known)
        self._known = np.concatenate([-2.0 * rows[:, :-2], rows[:, :-3:-1]], axis=1).T
        kernel = self._kernel(rows)
        np.fill_diagonal(kernel, 1.0 + SMOOTHING)
        ranks_and_ones = np.column_stack([self.ranks, rows[:, -1]])
        _, solved, _ = dposv(kernel.T, ranks_and_ones, lower=True, overwrite_a=True)
        self._constant = solved[:, :-1].sum(axis=0) / solved[:, -1].sum()
        self._weights = solved[:, :-1] - solved[:, -1:] * self._constant

    def __call__(self, X: Ints) -> Array:
        """Ranks of designs (designs, n) by each objective, (designs, objectives); the best is near 0."""
        expected = self._kernel(_rows(X)) @ self._weights + self._constant
        return np.asarray(np.round(expected, 6))  # sums in another order must not lead elsewhere

    def _kernel(self, rows: Array) -> Array:
        """exp(-(WIDTH r / top)^2) for the distances r from those that are known; of whole numbers exactly."""
        square = rows @ self._known
        square *= self._scale
        return np.asarray(np.exp(square, out=square))


def _rows(X: Any) -> Array:
    """Heights and differences of neighbours, the sum of their squares, and 1: (designs, 2 n + 1)."""
    n = X.shape[1]
    rows = np.ones((len(X), 2 * n + 1))
    rows[:, :n], rows[:, n:-2] = X, X[:, 1:] - X[:, :-1]
    rows[:, -2] = np.vecdot(rows[:, :-2], rows[:, :-2])
    return rows
