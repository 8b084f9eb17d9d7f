"""Solvers by name: one builder each, with operators that suit whole numbers.

pymoo's SBX truncates children of an integer population before they are repaired; with
``vtype=float`` and a `RoundingRepair` of the whole algorithm they are rounded instead. A large eta
on a range of ten heights makes most mutations round back to the parent, hence eta = 3. Operators
are built afresh for every run: pymoo's defaults are shared objects.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.duplicate import DuplicateElimination

from footopt.errors import SettingError, check
from footopt.foot import Waypoints

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solver:
    """A solver and its budget.

    Parameters
    ----------
    name : in `SOLVERS`, or `EXHAUSTIVE`. pop_size : designs a generation. n_gen : generations. seed :
        of everything random; the same seed gives the same result.
    """

    name: str = "memetic"
    pop_size: int = 100
    n_gen: int = 100
    seed: int = 1

    def __post_init__(self) -> None:
        if self.name not in (*SOLVERS, EXHAUSTIVE):
            raise SettingError("solver.name", self.name, f"one of {', '.join((*SOLVERS, EXHAUSTIVE))}")
        check(
            4 <= self.pop_size <= 100_000,
            "solver.pop_size",
            self.pop_size,
            "a whole number >= 4 and <= 100,000",
        )
        check(1 <= self.n_gen <= 10**6, "solver.n_gen", self.n_gen, "a whole number >= 1 and <= 1e6")
        check(0 <= self.seed < 2**32, "solver.seed", self.seed, "a whole number from 0 to 2^32 - 1")

    def generations(self, space: Waypoints) -> int:
        """How many generations there will be; for the exhaustive solver, batches of the space."""
        return self.n_gen if self.name != EXHAUSTIVE else -(-(space.K**space.n) // self.pop_size)

    def build(self, n_obj: int) -> Any:
        """A fresh pymoo algorithm for that many objectives."""
        single = self.name in SINGLE
        if single and n_obj > 1:
            many = ", ".join(name for name in SOLVERS if name not in SINGLE)
            raise SettingError(
                "solver",
                self.name,
                f"a solver of several objectives ({many}) for {n_obj} objectives",
                "Or minimise the scalar J_W: objective=efficiency.",
            )
        if not single and n_obj < 2:
            raise SettingError(
                "solver",
                self.name,
                f"a solver of one objective ({', '.join(SINGLE)}) for one objective",
                "Or ask for several: objective=pareto.",
            )
        return SOLVERS[self.name](self, n_obj)


class SameHeights(DuplicateElimination):  # type: ignore[misc]
    """Drop designs that came before: equal rows of whole numbers, found by their bytes.

    Does what pymoo's own does by comparing all distances, in a tenth of the time.
    """

    def _do(self, pop: Any, other: Any, is_duplicate: NDArray[np.bool_]) -> NDArray[np.bool_]:
        seen: set[bytes] = set() if other is None else set(self._rows(other))
        for i, key in enumerate(self._rows(pop)):
            is_duplicate[i] = key in seen
            if other is None:
                seen.add(key)
        return is_duplicate

    def _rows(self, pop: Any) -> list[bytes]:
        return [row.tobytes() for row in np.round(self.func(pop).astype(float)).astype(np.int64)]


DIRECTIONS = 1000  # of reference, at most


def _operators() -> dict[str, Any]:
    from pymoo.operators.crossover.sbx import SBX
    from pymoo.operators.mutation.pm import PM
    from pymoo.operators.repair.rounding import RoundingRepair
    from pymoo.operators.sampling.rnd import IntegerRandomSampling

    return {
        "sampling": IntegerRandomSampling(),
        "crossover": SBX(prob=0.9, eta=3, vtype=float),
        "mutation": PM(eta=3),
        "repair": RoundingRepair(),
        "eliminate_duplicates": SameHeights(),
    }


def memetic(solver: Solver, n_obj: int) -> Any:
    """Genetic algorithm with moves that suit a spline, and a local search where it stalls."""
    from footopt.design.memetic import Memetic

    return Memetic(solver.pop_size)


def ga(solver: Solver, n_obj: int) -> Any:
    """Genetic algorithm with elitist survival: the paper's solver."""
    from pymoo.algorithms.soo.nonconvex.ga import GA

    return GA(pop_size=solver.pop_size, **_operators())


def de(solver: Solver, n_obj: int) -> Any:
    """Differential evolution, DE/rand/1/bin, rounded (Storn & Price 1997)."""
    from pymoo.algorithms.soo.nonconvex.de import DE
    from pymoo.operators.repair.rounding import RoundingRepair
    from pymoo.operators.sampling.rnd import IntegerRandomSampling

    return DE(
        pop_size=solver.pop_size,
        variant="DE/rand/1/bin",
        CR=0.5,
        F=0.5,
        sampling=IntegerRandomSampling(),
        repair=RoundingRepair(),
    )


def nsga2(solver: Solver, n_obj: int) -> Any:
    """NSGA-II: non-dominated sorting and crowding (Deb et al. 2002)."""
    from pymoo.algorithms.moo.nsga2 import NSGA2

    return NSGA2(pop_size=solver.pop_size, **_operators())


def nsga3(solver: Solver, n_obj: int) -> Any:
    """NSGA-III: survival by reference directions (Deb & Jain 2014)."""
    from pymoo.algorithms.moo.nsga3 import NSGA3
    from pymoo.operators.selection.tournament import TournamentSelection

    directions = reference_directions(n_obj, solver.pop_size)
    selection = TournamentSelection(func_comp=less_violation)
    return NSGA3(ref_dirs=directions, pop_size=solver.pop_size, selection=selection, **_operators())


def agemoea2(solver: Solver, n_obj: int) -> Any:
    """AGE-MOEA-II: survival by an estimate of the front's geometry (Panichella 2022)."""
    from pymoo.algorithms.moo.age2 import AGEMOEA2

    return AGEMOEA2(pop_size=solver.pop_size, **_operators())


def smsemoa(solver: Solver, n_obj: int) -> Any:
    """SMS-EMOA: survival by contribution to the hypervolume (Beume, Naujoks & Emmerich 2007)."""
    from pymoo.algorithms.moo.sms import SMSEMOA

    return SMSEMOA(pop_size=solver.pop_size, **_operators())


def rvea(solver: Solver, n_obj: int) -> Any:
    """RVEA: reference vectors with an angle-penalised distance (Cheng et al. 2016)."""
    from pymoo.algorithms.moo.rvea import RVEA

    directions = reference_directions(n_obj, solver.pop_size)
    return RVEA(ref_dirs=directions, pop_size=solver.pop_size, **_operators())


SOLVERS: dict[str, Callable[[Solver, int], Any]] = {
    "memetic": memetic,
    "ga": ga,
    "de": de,
    "nsga2": nsga2,
    "nsga3": nsga3,
    "agemoea2": agemoea2,
    "smsemoa": smsemoa,
    "rvea": rvea,
}

#: Solvers of one objective; the others want two or more.
SINGLE = ["memetic", "ga", "de"]

#: Walks with every design of a small space, for any objectives: `footopt.design.exhaustive`.
EXHAUSTIVE = "exhaustive"


def register(build: Callable[[Solver, int], Any], single: bool = False) -> Callable[[Solver, int], Any]:
    """Offer a builder of a pymoo algorithm as the solver of its name, of one objective or of several.

    Parameters
    ----------
    build : from a `Solver` (pop_size, seed, ...) and the number of objectives. Designs are whole numbers:
        what the algorithm asks for is rounded.
    single : whether it is for one objective.
    """
    SOLVERS[build.__name__] = build
    if single and build.__name__ not in SINGLE:
        SINGLE.append(build.__name__)
    return build


@lru_cache(maxsize=8)
def reference_directions(n_obj: int, count: int) -> Array:
    """`count` directions spread evenly over the simplex, (count, n_obj), by Riesz energy."""
    check(
        count <= DIRECTIONS,
        "solver.pop_size",
        count,
        f"at most {DIRECTIONS} for a solver with reference directions",
        "Their places take minutes to find for more. Try solver=nsga2.",
    )
    from pymoo.util.ref_dirs import get_reference_directions

    directions: Array = get_reference_directions("energy", n_obj, count, seed=1)
    return directions


def less_violation(pop: Any, pairs: NDArray[np.int64], random_state: Any = None, **kwargs: Any) -> Any:
    """Winner of each pair: the smaller constraint violation, a tie by the run's own random state.

    pymoo's own comparison for NSGA-III draws ties from a generator of its own, so that equal seeds
    gave different results.
    """
    cv = pop.get("CV")[:, 0]
    first, second = cv[pairs[:, 0]], cv[pairs[:, 1]]
    coin = random_state.integers(0, 2, len(pairs)).astype(bool)
    take_second = np.where(first == second, coin, second < first)
    return np.where(take_second, pairs[:, 1], pairs[:, 0])[:, None].astype(int)
