"""Moves that suit a spline, pymoo's own operators over whole numbers, and every design of a small space.

A spline changes its shape most when neighbouring waypoints move together. One waypoint that moves alone
makes a bump, which may cost more than its new level gains; a run of waypoints shifts the sole without one.
Random soles that are improved by single steps of one waypoint end in as many local optima; by shifts of
runs, on soft sand, all in the same one.

pymoo's SBX truncates children of an integer population before they are repaired; with
``vtype=float`` and a `RoundingRepair` of the whole algorithm they are rounded instead. A large eta
on a range of ten heights makes most mutations round back to the parent, hence eta = 3. Operators
are built afresh for every run: pymoo's defaults are shared objects.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.core.crossover import Crossover
from pymoo.core.mutation import Mutation
from pymoo.core.population import Population
from pymoo.core.repair import Repair
from pymoo.core.sampling import Sampling
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling

from footopt.arrays import Array, Bools, Ints
from footopt.design.problem import KNOWN
from footopt.errors import check

DRAWS = 200  # batches of random designs at most, until enough are inside their box
IDLE = 8  # batches without a new design before a space counts as used up
DIRECTIONS = 1000  # reference directions, at most


@lru_cache(maxsize=4)
def shifts(n: int) -> NDArray[np.int8]:
    """Every run of neighbours among n waypoints, one level down and one level up: (n (n + 1), n)."""
    first, last = np.triu_indices(n)
    at = np.arange(n)
    run = ((first[:, None] <= at) & (at <= last[:, None])).astype(np.int8)
    return np.stack([run, -run], axis=1).reshape(-1, n)


def allowed(problem: Any, X: Ints) -> Bools:
    """Which designs (designs, n) are within a problem's bounds, and inside their box if it has one."""
    kept: Bools = ((X >= problem.xl) & (X <= problem.xu)).all(axis=1)
    if kept.any() and hasattr(problem, "inside"):
        kept[kept] = problem.inside(X[kept])
    return kept


def exchanged(X: Ints, others: Ints, random_state: Any) -> Ints:
    """Designs (..., designs, n) with one run of neighbouring waypoints, of any length, of others."""
    runs = shifts(X.shape[-1])[::2]
    return np.where(runs[random_state.integers(len(runs), size=X.shape[-2])] > 0, others, X)


def shifted(X: Ints, random_state: Any) -> Ints:
    """Designs with one run of neighbouring waypoints, of any length, moved by one level."""
    moves = shifts(X.shape[1])
    return np.asarray(X + moves[random_state.integers(len(moves), size=len(X))])


class RandomInside(Sampling):
    """Random whole numbers, different and inside their box: as many as there are, at most."""

    def _do(self, problem: Any, n_samples: int, random_state: Any = None, **kwargs: Any) -> Ints:
        kept, idle = np.empty((0, problem.n_var), np.int64), 0
        low, high = problem.xl.astype(np.int64), problem.xu.astype(np.int64)
        for _ in range(DRAWS):
            drawn = random_state.integers(low, high + 1, (4 * n_samples, problem.n_var))
            before, kept = len(kept), np.concatenate([kept, drawn[allowed(problem, drawn)]])
            kept = kept[np.sort(np.unique(kept, axis=0, return_index=True)[1])]
            idle = idle + 1 if before and len(kept) == before else 0
            if len(kept) >= n_samples or idle == IDLE:
                break
        return kept[:n_samples] if len(kept) else drawn[:n_samples]


class ExchangeRun(Crossover):
    """Two parents exchange one run of neighbouring waypoints."""

    def _do(self, problem: Any, X: Ints, random_state: Any = None, **kwargs: Any) -> Ints:
        return exchanged(X, X[::-1], random_state)


class ShiftRun(Mutation):
    """Move one run of neighbouring waypoints by one level."""

    def _do(self, problem: Any, X: Ints, random_state: Any = None, **kwargs: Any) -> Ints:
        return np.clip(shifted(X, random_state), problem.xl.astype(np.int64), problem.xu.astype(np.int64))


class OnlyNew(Repair):
    """Drop what leaves its box, and what the algorithm has proposed before, instead of repairing it."""

    def do(self, problem: Any, pop: Any, algorithm: Any = None, **kwargs: Any) -> Any:
        """The designs of a population that are left."""
        if not len(pop):
            return pop
        X = pop.get("X")
        kept = allowed(problem, X)
        if algorithm is not None and KNOWN in algorithm.data:
            kept &= algorithm.data[KNOWN].places(X) < 0
        return pop[kept]


def operators(
    crossover_prob: float = 0.9, crossover_eta: float = 3, mutation_prob: float = 0.9, mutation_eta: float = 3
) -> dict[str, Any]:
    """Sampling, crossover, mutation and repair of a genetic algorithm over whole numbers.

    The larger an eta, the nearer children are to their parents (Deb & Agrawal 1995).
    """
    return {
        "sampling": IntegerRandomSampling(),
        "crossover": SBX(prob=crossover_prob, eta=crossover_eta, vtype=float),
        "mutation": PM(prob=mutation_prob, eta=mutation_eta),
        "repair": RoundingRepair(),
        "eliminate_duplicates": True,
    }


def by_runs() -> dict[str, Any]:
    """Operators that suit a spline, for any genetic algorithm of pymoo: ``NSGA2(**fo.by_runs())``.

    They exchange and shift runs of neighbouring waypoints, and propose no design twice and none outside its
    box.

    Returns
    -------
    dict
        Sampling, crossover, mutation, repair and the elimination of duplicates, by pymoo's names.
    """
    return {
        "sampling": RandomInside(),
        "crossover": ExchangeRun(n_parents=2, n_offsprings=2, prob=0.9),
        "mutation": ShiftRun(),
        "repair": OnlyNew(),
        "eliminate_duplicates": True,
    }


@lru_cache(maxsize=8)
def reference_directions(n_obj: int, count: int) -> Array:
    """`count` directions spread evenly over the simplex, (count, n_obj), by Riesz energy."""
    allowed = f"at most {DIRECTIONS} for a solver with reference directions"
    hint = "Their places take minutes to find for more. Try solver=nsga2."
    check(count <= DIRECTIONS, "solver.pop_size", count, allowed, hint)
    from pymoo.util.ref_dirs import get_reference_directions

    return get_reference_directions("energy", n_obj, count, seed=1)


def batches(n: int, K: int, size: int) -> Iterator[Ints]:
    """Every row of n whole numbers from 1 to K, `size` at a time; the last number counts fastest."""
    total, powers = K**n, K ** np.arange(n)[::-1]
    for begin in range(0, total, size):
        yield 1 + np.arange(begin, min(begin + size, total))[:, None] // powers % K


class Exhaustive(Algorithm):
    """Every design that is inside its box, in order; a generation has those of `pop_size` rows."""

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
