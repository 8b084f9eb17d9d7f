"""The only door to pymoo: a `FootProblem` as pymoo's algorithms want it, and an algorithm asked and told."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.problem import Problem
from pymoo.core.sampling import Sampling
from pymoo.problems.static import StaticProblem

from footopt.design.problem import Array, FootProblem, Ints
from footopt.design.solvers import Solver
from footopt.errors import check

REPEATS = 10  # times as many generations as its walks need, where a solver asks for designs again


class PymooProblem(Problem):  # type: ignore[misc]  # pymoo has no types
    """A `FootProblem` as a vectorised pymoo problem with integer variables, for `pymoo.optimize.minimize`.

    One call walks a whole population. A failed walk violates the first constraint, a sole that leaves
    its box the second, and so on (`FootProblem.constraints`). Beside F and G, ``out`` has the fields of
    `Evaluated`.

    Parameters
    ----------
    problem : FootProblem
        What is evaluated.
    """

    def __init__(self, problem: FootProblem) -> None:
        self.problem = problem
        super().__init__(
            problem.space.n, problem.n_obj, problem.n_constraints, xl=1, xu=problem.space.K, vtype=int
        )

    def _evaluate(self, x: Any, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        found = self.problem.evaluate(x)
        out.update(found._asdict())
        out["F"], out["G"] = (
            self.problem.minimised(found.values),
            self.problem.constraints(*found),
        )


class Size(Problem):  # type: ignore[misc]  # pymoo has no types
    """What an algorithm knows of a `FootProblem` that it asks for designs of: no walks, the box, a memory."""

    def __init__(self, problem: FootProblem) -> None:
        n, space = problem.space.n, problem.space
        super().__init__(
            n, problem.n_obj, problem.n_constraints, xl=np.ones(n), xu=np.full(n, space.K), vtype=int
        )
        self._space, self._asked = space, set[bytes]()

    def inside(self, k: Ints) -> NDArray[np.bool_]:
        """Which designs are inside their box."""
        return np.asarray(self._space.box_violation(k) <= self._space.box_tolerance * self._space.H)

    def seen(self, k: Ints) -> NDArray[np.bool_]:
        """Which designs have been asked for."""
        return np.array([row.tobytes() in self._asked for row in k.astype(np.int64)], bool)

    def remember(self, k: Ints) -> None:
        """Note designs that are asked for."""
        self._asked.update(row.tobytes() for row in k)

    def __deepcopy__(self, memo: Any) -> Size:
        """Itself: pymoo copies what it holds in every generation."""
        return self


class Begun(Sampling):  # type: ignore[misc]  # pymoo has no types
    """A sampling whose first designs are given; the others are drawn as before."""

    def __init__(self, other: Sampling, start: Ints) -> None:
        super().__init__()
        self._other, self._start = other, start

    def _do(self, problem: Problem, n_samples: int, **kwargs: Any) -> Any:
        drawn = self._other(problem, n_samples, **kwargs).get("X").copy()
        drawn[: len(self._start)] = self._start
        return drawn


class Algorithm:
    """A solver's pymoo algorithm at work: `ask` it for designs, `tell` it what became of them.

    pymoo knows the problem's size only: it copies what it holds in every generation.
    """

    def __init__(self, problem: FootProblem, solver: Solver, start: Ints | None = None) -> None:
        self._algorithm = solver.build(problem.n_obj)
        self._size = Size(problem)
        most = solver.n_gen or REPEATS * solver.generations(problem.space)
        self._algorithm.setup(self._size, termination=("n_gen", most), seed=solver.seed, verbose=False)
        self._asked: Any = None
        if start is not None:
            initial: Any = getattr(self._algorithm, "initialization", None)
            check(initial is not None, "start", solver.name, "left out: this solver draws its own designs")
            most = next(solver.sizes())
            check(len(start) <= most, "start", len(start), f"at most {most} designs")
            initial.sampling = Begun(initial.sampling, start)

    def ask(self) -> Ints | None:
        """The next generation, (designs, n) heights; None when the budget or the space is used up."""
        self._asked = self._algorithm.ask() if self._algorithm.has_next() else None
        if self._asked is None:
            return None
        k: Ints = np.round(self._asked.get("X").astype(float)).astype(np.int64)
        self._size.remember(k)
        return k

    def tell(self, f: Array, g: Array) -> None:
        """F and G of the generation that was asked for, (designs, ...)."""
        self._algorithm.evaluator.eval(StaticProblem(self._size, F=f, G=g), self._asked)
        self._algorithm.tell(infills=self._asked)
