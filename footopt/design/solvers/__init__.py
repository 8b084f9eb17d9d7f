"""Solvers by name: what a `Solver` is, how those of pymoo are built, and how a user's own is registered."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import accumulate
from numbers import Integral
from typing import Any

from footopt.errors import SettingError, check, check_free, is_number
from footopt.foot import Waypoints

#: Walks with every design of a small space, for one objective or several.
EXHAUSTIVE = "exhaustive"

#: Builders of pymoo algorithms by name: from a `Solver` and the number of objectives.
SOLVERS: dict[str, Callable[[Solver, int], Any]] = {}

#: Solvers of one objective; the others need two or more.
SINGLE: list[str] = []

#: Our own algorithms by name, as classes below this package.
OWN = {"memetic": "memetic.Memetic", "archive": "memetic.Archive", EXHAUSTIVE: "moves.Exhaustive"}

#: Genetic algorithms of pymoo by name, as classes below `pymoo.algorithms`.
GENETIC = {
    "ga": "soo.nonconvex.ga.GA",  # the paper's
    "nsga2": "moo.nsga2.NSGA2",
    "agemoea2": "moo.age2.AGEMOEA2",
    "smsemoa": "moo.sms.SMSEMOA",
    "rvea": "moo.rvea.RVEA",
}

#: Names of the operators' parameters, by solver; a user's own solver may add its own.
OPERATORS = dict.fromkeys(GENETIC, ("crossover_prob", "crossover_eta", "mutation_prob", "mutation_eta"))

#: The best for one objective, and for several (docs/solvers.md).
AUTO, BEST = "auto", ("memetic", "archive")

#: Sizes of the generations of `BEST` without pop_size: a share of all designs so far, within bounds.
SHARE, FIRST, MOST = 0.05, 10, 100

WALKS = 10_000  # budget of a solver without n_gen
LIMIT = 1_000_000  # largest space, in designs inside their box or not, that exhaustive accepts
SIZE, BATCH = 100, 4096  # sizes of generations that do not grow, and of exhaustive


@dataclass(frozen=True)
class Solver:
    """A solver and its budget.

    Parameters
    ----------
    name : str
        Name of the solver; auto: the best one for the number of objectives (see `fitting`). Any other
        algorithm of pymoo by the path of its class below `pymoo.algorithms`, "moo.ctaea.CTAEA", at its
        defaults.
    pop_size : int, optional
        Designs in a generation. By default it is a twentieth of all designs so far, from 10 to 100; 100 for
        solvers whose population has a fixed size; 4096 for exhaustive.
    n_gen : int, optional
        Largest number of generations.
    seed : int
        Of all random numbers; the same seed gives the same result.
    operators : dict of str to float, optional
        Of crossover and mutation: crossover_prob, crossover_eta, mutation_prob, mutation_eta.
        With them, {} too, a solver of several objectives has simulated binary crossover and polynomial
        mutation in place of moves that suit a spline.
    seconds : float, s, optional
        Time limit: the search ends after the generation during which it is reached.
    walks : int, optional
        Largest number of different designs; by default 10,000, unless n_gen is given.
    """

    name: str = AUTO
    pop_size: int | None = None
    n_gen: int | None = None
    seed: int = 1
    operators: Any = None
    walks: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        self._check_name()
        for name, low, high in (("walks", 1, 10**9), ("pop_size", 4, 10**5), ("n_gen", 1, 10**6)):
            value = getattr(self, name)
            allowed = f"null, or a whole number >= {low} and <= {high:,}"
            whole = is_number(value) and low <= value <= high and value == int(value)
            check(value is None or whole, f"solver.{name}", value, allowed)
        good = self.seconds is None or self.seconds > 0
        check(good, "solver.seconds", self.seconds, "null, or a number > 0")
        seed = is_number(self.seed, Integral) and 0 <= self.seed < 2**32
        check(seed, "solver.seed", self.seed, "a whole number from 0 to 2^32 - 1")

    def _check_name(self) -> None:
        names = (AUTO, *SOLVERS)
        allowed = f"one of {', '.join(names)}, or a class of pymoo.algorithms, such as moo.ctaea.CTAEA"
        check(self.name in names or "." in self.name, "solver.name", self.name, allowed)

    def fitting(self, n_obj: int) -> Solver:
        """This one, or instead of `AUTO` the best for that many objectives."""
        return self if self.name != AUTO else replace(self, name=BEST[n_obj > 1])

    @property
    def most(self) -> float:
        """Largest number of different designs; infinity where only generations limit it."""
        return self.walks or (math.inf if self.n_gen or self.name == EXHAUSTIVE else WALKS)

    def check_space(self, space: Waypoints) -> None:
        """Raise a `SettingError` if every design of the space is to be evaluated, and these are too many."""
        few = self.name != EXHAUSTIVE or space.K**space.n <= LIMIT
        allowed = f"small enough that foot.K^foot.n is at most {LIMIT:,} soles, to walk with all of them"
        check(few, "foot.n", space.n, allowed, "Try foot.n=5 or foot.K=4, or solver=memetic.")

    @property
    def size(self) -> int:
        """Designs of a generation that does not grow."""
        return self.pop_size or (BATCH if self.name == EXHAUSTIVE else SIZE)

    def sizes(self) -> Iterator[int]:
        """Designs of each generation, without end."""
        proposed, grows = 0, self.pop_size is None and self.name in (AUTO, *BEST)
        while True:
            yield (size := grown(proposed) if grows else self.size)
            proposed += size

    def generations(self, space: Waypoints) -> int:
        """How many generations there will be at most; for the exhaustive solver, batches of the space."""
        if self.name == EXHAUSTIVE:
            return int(-(-(space.K**space.n) // self.size))
        proposed = enumerate(accumulate(self.sizes()), start=1)
        return next(last for last, designs in proposed if designs >= self.most or last == self.n_gen)

    def build(self, n_obj: int) -> Any:
        """A fresh pymoo algorithm; `SettingError` if it is not for that many objectives."""
        name, several = self.fitting(n_obj).name, n_obj > 1
        fit = [other for other in SOLVERS if other == EXHAUSTIVE or (other in SINGLE) != several]
        if name not in fit and ("." not in name or name.startswith("soo.") == several):
            kind, hint = "one objective", "Or ask for several: objective=pareto."
            if several:
                kind, hint = "several objectives", "Or minimise the scalar J_W: objective=efficiency."
            raise SettingError("solver", name, f"a solver of {kind} ({', '.join(fit)})", hint)
        known, given = OPERATORS.get(name, ()), self.operators or {}
        check(isinstance(given, dict), "solver.operators", given, "numbers by name: {crossover_eta: 10}")
        for word, value in given.items():
            allowed = f"one of {', '.join(known)}" if known else f"left out with solver={name}"
            check(word in known, "solver.operators", word, allowed)
            most = 1 if word.endswith("_prob") else 100
            good = is_number(value) and 0 <= value <= most
            check(good, f"solver.operators.{word}", value, f"a number from 0 to {most}")
        return SOLVERS.get(name, by_class)(self, n_obj)


def register(build: Callable[[Solver, int], Any], single: bool = False) -> Callable[[Solver, int], Any]:
    """Offer a builder of a pymoo algorithm as the solver of its name.

    Parameters
    ----------
    build : callable
        From a `Solver` (size, seed, ...) and the number of objectives to the algorithm. Designs are
        whole numbers: what the algorithm asks for is rounded.
    single : bool
        Whether it is for one objective, or for several.
    """
    check_free(build.__name__, SOLVERS.get(build.__name__), build)
    SOLVERS[build.__name__] = build
    if single and build.__name__ not in SINGLE:
        SINGLE.append(build.__name__)
    return build


def by_class(solver: Solver, n_obj: int) -> Any:
    """An algorithm of `OWN` or of pymoo; those of `GENETIC` get operators for integers, or moves by runs."""
    solver = solver.fitting(n_obj)
    home = __package__ if solver.name in OWN else "pymoo.algorithms"
    module, _, name = (OWN | GENETIC).get(solver.name, solver.name).rpartition(".")
    try:
        algorithm = getattr(import_module(f"{home}.{module}"), name)
    except (ImportError, AttributeError) as error:
        raise SettingError("solver.name", solver.name, "a class of pymoo.algorithms", f"{error}") from None
    from pymoo.core.algorithm import Algorithm
    from pymoo.core.repair import NoRepair

    from footopt.design.solvers.moves import by_runs, operators, reference_directions

    kind = isinstance(algorithm, type) and issubclass(algorithm, Algorithm)
    check(kind, "solver.name", solver.name, "a class of an algorithm", "Try soo.nonconvex.de.DE")
    takes = inspect.signature(algorithm).parameters
    size = solver.pop_size if solver.name in BEST else solver.size
    given: dict[str, Any] = {"pop_size": size} if "pop_size" in takes else {}
    if "ref_dirs" in takes:
        given["ref_dirs"] = reference_directions(n_obj, solver.size)
    if solver.name not in GENETIC:
        bare = (n for n, p in takes.items() if p.default is p.empty and p.kind < p.VAR_POSITIONAL)
        needs = [n for n in bare if n not in given]
        hint = f"In Python: fo.search(problem, {name}(...))"
        check(not needs, "solver.name", solver.name, f"an algorithm that takes no {', '.join(needs)}", hint)
        return algorithm(**given)
    runs = n_obj > 1 and solver.operators is None
    built = algorithm(**given, **(by_runs() if runs else operators(**(solver.operators or {}))))
    built.initialization.repair = NoRepair()  # designs that a user begins with may be outside their box
    return built


def grown(proposed: int) -> int:
    """Designs of the next generation, after so many were proposed."""
    return min(max(int(SHARE * proposed), FIRST), MOST)


SOLVERS |= dict.fromkeys([*OWN, *GENETIC], by_class)
SINGLE += ["memetic", "ga"]
