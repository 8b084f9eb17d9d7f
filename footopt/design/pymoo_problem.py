"""The only door to pymoo: a `FootProblem` as pymoo's algorithms want it, and an algorithm asked and told."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm as PymooAlgorithm
from pymoo.core.initialization import Initialization
from pymoo.core.problem import Problem
from pymoo.core.sampling import Sampling
from pymoo.core.variable import Integer
from pymoo.problems.static import StaticProblem

from footopt.design.known import Known
from footopt.design.problem import Array, FootProblem, Ints
from footopt.design.result import SearchResult
from footopt.design.solvers import Solver
from footopt.errors import SettingError, check, check_kind
from footopt.foot import Waypoints

REPEATS = 10  # times as many generations as its walks need, where a solver asks for designs again


class PymooProblem(Problem):
    """A `FootProblem` as pymoo's algorithms want it, for `pymoo.optimize.minimize`.

    One call walks a whole population. Designs are rounded to whole numbers within their bounds, so that
    algorithms over real numbers work at their defaults, and mixed-variable ones find integers in `vars`. A
    failed walk violates the first constraint, a sole that leaves its box the second, and so on
    (`FootProblem.constraints`). Beside F and G, ``out`` has the fields of `Evaluated`.

    Parameters
    ----------
    problem : FootProblem
        What is evaluated.
    exact : SearchResult, optional
        Of ``fo.search(problem, "exhaustive")``: what `pareto_front`, `pareto_set`, `ideal_point` and
        `nadir_point` then say. Without, they are None, as is usual in pymoo where nobody knows them.
    **options
        Of pymoo's Problem. With an elementwise_runner, designs are walked one at a time, by it.
    """

    def __init__(self, problem: FootProblem, exact: SearchResult | None = None, **options: Any) -> None:
        self.problem, self.exact = problem, exact
        n, K = problem.space.n, problem.space.K
        options.setdefault("elementwise", "elementwise_runner" in options)
        super().__init__(n, problem.n_obj, problem.n_constraints, xl=1, xu=K, vtype=int, **options)
        self.vars = variables(problem.space)

    def inside(self, k: Ints) -> NDArray[np.bool_]:
        """Which designs (designs, n) are inside their box: moves by runs ask for no others."""
        return self.problem.space.inside(k)

    def _evaluate(self, x: Any, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        found = self.problem.evaluate(whole([x] if self.elementwise else x, self))
        columns = found._asdict() | {
            "F": self.problem.minimised(found.values),
            "G": self.problem.constraints(*found),
        }
        out.update({name: column[0] for name, column in columns.items()} if self.elementwise else columns)

    def _calc_pareto_front(self, *args: Any, **kwargs: Any) -> Any:
        return None if self.exact is None else np.atleast_2d(self.exact.F)

    def _calc_pareto_set(self, *args: Any, **kwargs: Any) -> Any:
        return None if self.exact is None else np.atleast_2d(self.exact.X)


def variables(space: Waypoints) -> dict[str, Integer]:
    """Each height by name, for algorithms of mixed variables."""
    return {f"k{i + 1}": Integer(bounds=(1, space.K)) for i in range(space.n)}


def whole(X: Any, problem: Any) -> Ints:
    """What an algorithm asks for as heights (designs, n): rounded, within bounds, dictionaries as rows."""
    X = [X] if isinstance(X, dict) else X  # of one individual
    if len(X) and isinstance(X[0], dict):
        X = [[row[name] for name in problem.vars] for row in X]
    rows = np.asarray(X, float).reshape(-1, problem.n_var)
    return np.clip(np.round(rows), problem.xl, problem.xu).astype(np.int64)


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


class Size(Problem):
    """What an algorithm knows of a `FootProblem` that it asks for designs of: no walks, the box, a memory."""

    def __init__(self, problem: FootProblem) -> None:
        n, space = problem.space.n, problem.space
        super().__init__(
            n, problem.n_obj, problem.n_constraints, xl=np.ones(n), xu=np.full(n, space.K), vtype=int
        )
        self.vars = variables(space)
        self._space, self._asked = space, Known()

    def inside(self, k: Ints) -> NDArray[np.bool_]:
        """Which designs are inside their box."""
        return self._space.inside(k)

    def seen(self, k: Ints) -> NDArray[np.bool_]:
        """Which designs have been asked for."""
        return np.asarray(self._asked.places(k) >= 0)

    def remember(self, k: Ints) -> None:
        """Note designs that are asked for."""
        self._asked.add(k[self._asked.fresh(k)])

    def __deepcopy__(self, memo: Any) -> Size:
        """Itself: pymoo copies what it holds in every generation."""
        return self


class Begun(Sampling):
    """A sampling whose first designs are given; the others are drawn as before."""

    def __init__(self, other: Sampling, start: Ints) -> None:
        super().__init__()
        self._other, self._start = other, start

    def _do(self, problem: Problem, n_samples: int, **kwargs: Any) -> Any:
        drawn = Initialization(self._other).do(problem, n_samples, **kwargs).get("X").copy()
        drawn[: len(self._start)] = self._start
        return drawn


class Algorithm:
    """A solver's pymoo algorithm at work: `ask` it for designs, `tell` it what became of them.

    pymoo knows the problem's size only: it copies what it holds in every generation.
    """

    def __init__(
        self,
        problem: FootProblem,
        solver: Solver,
        start: Ints | None = None,
        termination: Any = None,
    ) -> None:
        solver.check_space(problem.space)
        self._algorithm = solver.build(problem.n_obj)
        self._size = Size(problem)
        most = solver.n_gen or REPEATS * solver.generations(problem.space)
        ends = copy.deepcopy(termination) or ("n_gen", most)
        try:
            self._algorithm.setup(self._size, termination=ends, seed=solver.seed, verbose=False)
        except AssertionError as error:  # their way to say it: MOEA/D, DNSGA2, KGB
            needs = "an algorithm that takes constraints: a walk may fail, and a sole leave its box"
            hint = f"pymoo says: {error} Try solver=nsga3, or another."
            raise SettingError("solver", solver.name, needs, hint) from error
        self._asked: Any = None
        if start is not None:
            initial: Any = getattr(self._algorithm, "initialization", None)
            check(initial is not None, "start", solver.name, "left out: this solver draws its own designs")
            most = next(solver.sizes())
            check(len(start) <= most, "start", len(start), f"at most {most} designs")
            initial.sampling = Begun(initial.sampling, start)

    @property
    def terminated(self) -> bool:
        """Whether its termination has ended it, and not that it has found nothing new."""
        ending = self._algorithm.termination
        return bool(ending.has_terminated() and not ending.force_termination)

    def ask(self) -> Ints | None:
        """The next generation, (designs, n) heights; None when the budget or the space is used up."""
        self._asked = self._algorithm.ask() if self._algorithm.has_next() else None
        if self._asked is None:
            return None
        k = whole(self._asked.get("X"), self._size)
        self._size.remember(k)
        return k

    def tell(self, f: Array, g: Array) -> None:
        """F and G of the generation that was asked for, (designs, ...)."""
        self._algorithm.evaluator.skip_already_evaluated = False  # F has a row for each that was asked for
        self._algorithm.evaluator.eval(StaticProblem(self._size, F=f, G=g), self._asked)
        self._algorithm.tell(infills=self._asked)
