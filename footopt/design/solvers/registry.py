"""Solvers by name: what a `Solver` is, and how one's own joins the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from footopt.errors import SettingError, check
from footopt.foot import Waypoints

#: Walks with every design of a small space, for any objectives: `footopt.design.exhaustive`.
EXHAUSTIVE = "exhaustive"

#: Builders of pymoo algorithms by name: from a `Solver` and the number of objectives.
SOLVERS: dict[str, Callable[[Solver, int], Any]] = {}

#: Solvers of one objective; the others want two or more.
SINGLE: list[str] = []


#: What operators can be told, by solver; a solver of one's own may add its own words.
GENETIC = ("crossover_prob", "crossover_eta", "mutation_prob", "mutation_eta")
OPERATORS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("ga", "nsga2", "nsga3", "agemoea2", "smsemoa", "rvea"), GENETIC),
    "de": ("CR", "F"),
}


@dataclass(frozen=True)
class Solver:
    """A solver and its budget.

    Parameters
    ----------
    name : str
        In `SOLVERS`, or `EXHAUSTIVE`.
    pop_size : int
        Designs a generation.
    n_gen : int
        Generations.
    seed : int
        Of everything random; the same seed gives the same result.
    operators : dict of str to float, optional
        Of crossover and mutation: crossover_prob, crossover_eta, mutation_prob, mutation_eta; CR and F of de.
        The memetic solver has moves of its own.
    """

    name: str = "memetic"
    pop_size: int = 100
    n_gen: int = 100
    seed: int = 1
    operators: Any = None

    def __post_init__(self) -> None:
        names = (*SOLVERS, EXHAUSTIVE)
        check(self.name in names, "solver.name", self.name, f"one of {', '.join(names)}")
        size, count = self.pop_size, self.n_gen
        check(4 <= size <= 100_000, "solver.pop_size", size, "a whole number >= 4 and <= 100,000")
        check(1 <= count <= 10**6, "solver.n_gen", count, "a whole number >= 1 and <= 1e6")
        check(0 <= self.seed < 2**32, "solver.seed", self.seed, "a whole number from 0 to 2^32 - 1")

    def generations(self, space: Waypoints) -> int:
        """How many generations there will be; for the exhaustive solver, batches of the space."""
        return self.n_gen if self.name != EXHAUSTIVE else -(-(space.K**space.n) // self.pop_size)

    def build(self, n_obj: int) -> Any:
        """A fresh pymoo algorithm; `SettingError` if it is not for that many objectives."""
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
        known, given = OPERATORS.get(self.name, ()), self.operators or {}
        check(isinstance(given, dict), "solver.operators", given, "numbers by name: {crossover_eta: 10}")
        for name, value in given.items():
            allowed = f"one of {', '.join(known)}" if known else f"left out with solver={self.name}"
            check(name in known, "solver.operators", name, allowed)
            most = 1 if name == "CR" or name.endswith("_prob") else 100
            good = isinstance(value, (int, float)) and 0 <= value <= most
            check(good, f"solver.operators.{name}", value, f"a number from 0 to {most}")
        return SOLVERS[self.name](self, n_obj)


def register(build: Callable[[Solver, int], Any], single: bool = False) -> Callable[[Solver, int], Any]:
    """Offer a builder of a pymoo algorithm as the solver of its name.

    Parameters
    ----------
    build : callable
        From a `Solver` (pop_size, seed, ...) and the number of objectives to the algorithm. Designs are
        whole numbers: what the algorithm asks for is rounded.
    single : bool
        Whether it is for one objective, or for several.
    """
    SOLVERS[build.__name__] = build
    if single and build.__name__ not in SINGLE:
        SINGLE.append(build.__name__)
    return build
