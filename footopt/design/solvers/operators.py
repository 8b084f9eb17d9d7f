"""Operators that suit whole numbers, and what pymoo's own would do otherwise.

pymoo's SBX truncates children of an integer population before they are repaired; with
``vtype=float`` and a `RoundingRepair` of the whole algorithm they are rounded instead. A large eta
on a range of ten heights makes most mutations round back to the parent, hence eta = 3. Operators
are built afresh for every run: pymoo's defaults are shared objects.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from pymoo.core.duplicate import DuplicateElimination
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling

from footopt.arrays import Array, Bools
from footopt.design.solvers.moves import ExchangeRun, OnlyNew, RandomInside, ShiftRun
from footopt.errors import check

DIRECTIONS = 1000  # of reference, at most


class SameHeights(DuplicateElimination):
    """Drop designs that came before: equal rows of whole numbers, found by their bytes.

    Does what pymoo's own does by comparing all distances, in a tenth of the time.
    """

    def _do(self, pop: Any, other: Any, is_duplicate: Bools) -> Bools:
        seen: set[bytes] = set() if other is None else set(self._rows(other))
        for i, key in enumerate(self._rows(pop)):
            is_duplicate[i] = key in seen
            if other is None:
                seen.add(key)
        return is_duplicate

    def _rows(self, pop: Any) -> list[bytes]:
        return [row.tobytes() for row in np.round(self.func(pop).astype(float)).astype(np.int64)]


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
        "eliminate_duplicates": SameHeights(),
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
        "crossover": ExchangeRun(),
        "mutation": ShiftRun(),
        "repair": OnlyNew(),
        "eliminate_duplicates": SameHeights(),
    }


@lru_cache(maxsize=8)
def reference_directions(n_obj: int, count: int) -> Array:
    """`count` directions spread evenly over the simplex, (count, n_obj), by Riesz energy."""
    allowed = f"at most {DIRECTIONS} for a solver with reference directions"
    hint = "Their places take minutes to find for more. Try solver=nsga2."
    check(count <= DIRECTIONS, "solver.pop_size", count, allowed, hint)
    from pymoo.util.ref_dirs import get_reference_directions

    return get_reference_directions("energy", n_obj, count, seed=1)
