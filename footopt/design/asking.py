"""A solver's pymoo algorithm, asked for designs and told what became of them."""

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from pymoo.core.algorithm import Algorithm as PymooAlgorithm
from pymoo.core.initialization import Initialization

from footopt.arrays import Array, Ints
from footopt.design.problem import FootProblem, Known, whole
from footopt.design.solvers import Solver
from footopt.design.solvers.moves import KNOWN
from footopt.errors import SettingError, check, check_kind

REPEATS = 10  # times as many generations as its walks need, where a solver asks for designs again


@dataclass(frozen=True)
class OfPymoo(Solver):
    """An algorithm of pymoo as a solver, of the name of its class.

    Parameters
    ----------
    algorithm : pymoo.core.algorithm.Algorithm
        A copy of it searches.
    """

    algorithm: Any = None

    def _check_name(self) -> None:
        """Any name: it is not looked up."""

    def build(self, n_obj: int) -> Any:
        """A copy of the algorithm."""
        return copy.deepcopy(self.algorithm)


def as_solver(algorithm: Any, budget: dict[str, Any]) -> Solver:
    """A `Solver` of an algorithm of pymoo; it ends as other solvers do."""
    check_kind(algorithm, PymooAlgorithm, "solver", "Try solver='memetic', or an algorithm of pymoo")
    size = getattr(algorithm, "pop_size", None)
    size = {"pop_size": max(size, 4)} if isinstance(size, int) else {}
    check(not {"operators", "pop_size"} & set(budget), "solver", type(algorithm).__name__,
          "an algorithm that has its pop_size and operators already")  # fmt: skip
    return OfPymoo(name=type(algorithm).__name__, algorithm=algorithm, **size, **budget)


class Algorithm:
    """A solver's pymoo algorithm at work: `ask` it for designs, `tell` it what became of them.

    `known` are the designs so far, which the caller adds; some solvers propose none of them again.
    """

    def __init__(
        self, problem: FootProblem, solver: Solver, known: Known, start: Ints | None, termination: Any
    ) -> None:
        solver.check_space(problem.space)
        self._algorithm = solver.build(problem.n_obj)
        self._algorithm.data[KNOWN] = known
        self._problem = problem
        most = solver.n_gen or REPEATS * solver.generations(problem.space)
        ends = copy.deepcopy(termination) or ("n_gen", most)
        try:
            self._algorithm.setup(problem, termination=ends, seed=solver.seed, verbose=False)
        except AssertionError as error:  # their way to say it: MOEA/D, DNSGA2, KGB
            needs = "an algorithm that takes constraints: a walk may fail, and a sole leave its box"
            hint = f"pymoo says: {error} Try solver=nsga3, or another."
            raise SettingError("solver", solver.name, needs, hint) from error
        self._proposed: Any = None
        if start is not None:
            initial: Any = getattr(self._algorithm, "initialization", None)
            check(initial is not None, "start", solver.name, "left out: this solver draws its own designs")
            most = next(solver.sizes())
            check(len(start) <= most, "start", len(start), f"at most {most} designs")
            drawing = Initialization(initial.sampling)
            drawn = drawing.do(problem, most, random_state=self._algorithm.random_state).get("X").copy()
            drawn[: len(start)] = start
            initial.sampling = drawn

    @property
    def terminated(self) -> bool:
        """Whether its termination has ended it, and not that it has found nothing new."""
        ending = self._algorithm.termination
        return bool(ending.has_terminated() and not ending.force_termination)

    def ask(self) -> Ints | None:
        """The next generation, (designs, n) heights; None when the budget or the space is used up."""
        self._proposed = self._algorithm.ask() if self._algorithm.has_next() else None
        return None if self._proposed is None else whole(self._proposed.get("X"), self._problem)

    def tell(self, f: Array, g: Array) -> None:
        """F and G of the generation that was proposed, (designs, ...)."""
        violation = np.maximum(g, 0.0).sum(axis=1, keepdims=True)  # what each would be asked for later
        for one, *columns in zip(np.atleast_1d(self._proposed), f, g, violation, strict=True):  # may be alone
            one.F, one.G, one.CV = columns
            one.evaluated.update("FG")
        self._algorithm.evaluator.n_eval += len(f)
        self._algorithm.tell(infills=self._proposed)
