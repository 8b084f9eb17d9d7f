"""`search`: an ask/tell loop around a solver's pymoo algorithm that keeps every design it has evaluated."""

import copy
import math
import sys
import time
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from footopt.arrays import Array
from footopt.design.archive import Archive, Evaluator
from footopt.design.problem import KNOWN, FootProblem, Known, as_heights
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import AUTO, EXHAUSTIVE, WALKS, Solver
from footopt.design.store import Store
from footopt.errors import SettingError, check, check_kind

BUDGET = ("walks", "pop_size", "n_gen", "seconds", "seed", "operators")  # of a solver that is named
ENOUGH = "by the solver, which proposed nothing more"
REPEATS = 10  # times as many generations as its walks need, where a solver asks for designs again


def search(
    problem: FootProblem,
    solver: Solver | str | Any = None,
    progress: Callable[[Generation], object] | bool | None = None,
    store: Store | str | Path | None = None,
    executor: Executor | None = None,
    stop: Any = None,
    start: ArrayLike | None = None,
    **budget: Any,
) -> SearchResult:
    """Search a design space.

    Parameters
    ----------
    problem : FootProblem
        What is searched.
    solver : Solver, str or pymoo.core.algorithm.Algorithm, optional
        A name will do, and so will an algorithm of pymoo, of which a copy searches; seed and termination are
        those given here. By default the best one for the number of objectives (`Solver.fitting`).
    progress : callable or bool, optional
        Called with each `Generation`; the search ends if it returns True. True itself shows a line on
        standard error.
    store : str, Path or Store, optional
        A file to keep every evaluation in. The same search with the same store goes on where it was
        stopped: nothing is walked twice, and the result is the same, to the last bit, as that of a
        search never stopped.
    executor : concurrent.futures.Executor, optional
        Of the workers that evaluate: threads, processes, a dask client's executor, MPI; by default this
        process. The result is the same, to the last bit.
    stop : pymoo.core.termination.Termination, optional
        Ends it before its last generation, in place of walks and n_gen; its short form ("n_gen", 50) will do.
    start : (designs, n), optional
        Heights of designs to begin with, in place of as many of the random first generation.
    **budget : int
        walks, pop_size, n_gen, seconds, seed and operators of the solver.

    Returns
    -------
    SearchResult
        Also when the user interrupts it (Ctrl-C), of what was found so far.

    Raises
    ------
    SettingError
        The solver does not fit the number of objectives, or cannot begin with designs.
    FootoptError
        No feasible design was found; every design of the first generation breaks the program; or the
        executor cannot go on.
    FileError
        The store cannot be used.
    KeyboardInterrupt
        It was interrupted before a feasible design was found.
    ValueError
        The store was opened for another problem.
    """
    check_kind("problem", problem, FootProblem, "Try fo.FootProblem(scene)")
    own, hint = type(problem)._evaluate is FootProblem._evaluate, "Override walk, minimised or constraints."
    check(own, "problem", type(problem).__name__, "one with the _evaluate of a FootProblem", hint)
    ends = stop is None or isinstance(stop, tuple) or hasattr(stop, "has_terminated")
    check(ends, "stop", stop, "a termination of pymoo", 'Try ("n_gen", 50)')
    for name, value in budget.items():
        check(name in BUDGET, name, value, f"one of {', '.join(BUDGET)}, as a keyword")
    solver = _as_solver(solver, budget).fitting(problem.n_obj)
    opened = Store(store, problem) if isinstance(store, (str, Path)) else nullcontext(store)
    tell, interrupted, stopped = _line if progress is True else progress or None, False, ""
    with opened as kept:
        evaluator = Evaluator(problem, kept, executor)
        archive = Archive(problem, evaluator)
        algorithm = _begun(problem, solver, archive.known, start, stop)
        most = math.inf if stop is not None and not solver.walks else solver.most
        began = time.perf_counter()
        try:
            with threadpool_limits(1, "blas"):  # too little for threads, which would wait for each other
                stopped = _ask_and_tell(archive, algorithm, solver, tell, most, bool(stop or solver.n_gen))
        except KeyboardInterrupt:
            interrupted = True
        result = archive.result(solver, time.perf_counter() - began, interrupted, evaluator.reused)
    if progress is True:
        print(file=sys.stderr)
    return replace(result, stopped=stopped)


@dataclass(frozen=True)
class OfPymoo(Solver):
    """An algorithm of pymoo as a solver, of the name of its class; a copy of it searches."""

    algorithm: Any = None

    def _check_name(self) -> None:
        """Any name: it is not looked up."""

    def build(self, n_obj: int) -> Any:
        """The copy."""
        single = type(self.algorithm).__module__.startswith("pymoo.algorithms.soo")
        check(n_obj == 1 or not single, "solver", self.name, "an algorithm for several objectives: NSGA2()")
        return copy.deepcopy(self.algorithm)


def _as_solver(solver: Any, budget: dict[str, Any]) -> Solver:
    """A solver, its name, or an algorithm of pymoo, which ends as other solvers do, with a budget."""
    if isinstance(solver, Solver):
        return replace(solver, **budget)
    if solver is None or isinstance(solver, str):
        return Solver(name=solver or AUTO, **budget)
    from pymoo.core.algorithm import Algorithm  # takes a tenth of a second

    check_kind("solver", solver, Algorithm, "Try solver='memetic', or an algorithm of pymoo")
    size = getattr(solver, "pop_size", None)
    given = {"pop_size": max(size, 4)} if isinstance(size, int) else {}
    check(not {"operators", "pop_size"} & set(budget), "solver", type(solver).__name__,
          "an algorithm that has its pop_size and operators already")  # fmt: skip
    return OfPymoo(name=type(solver).__name__, algorithm=solver, **given, **budget)


def _line(g: Generation) -> None:
    """A progress that keeps one line of standard error up to date."""
    value = f"best {g.best:.4g}" if math.isfinite(g.best) else f"hypervolume {g.hypervolume:.4g}"
    where = f"generation {g.generation}, {g.evaluations} evaluations"
    print(f"\r{f'{where}, {value}, {g.seconds:.1f} s':<78}", end="", file=sys.stderr, flush=True)


def _ask_and_tell(
    archive: Archive, algorithm: Any, solver: Solver, progress: Any, most: float, stops: bool
) -> str:
    """Ask for a generation, evaluate its new designs, tell the algorithm, and repeat; says why it stopped."""
    began = time.perf_counter()
    while len(archive.known) < most:
        proposed = algorithm.ask() if algorithm.has_next() else None
        if proposed is None:
            end = algorithm.termination
            ended = stops and end.has_terminated() and not end.force_termination
            ended = ended or len(archive.history) == solver.n_gen or solver.name == EXHAUSTIVE
            return "" if ended else ENOUGH
        k = as_heights([one.X for one in np.atleast_1d(proposed)], archive.problem)
        count = archive.affordable(k, most)  # the last generation is cut where the budget ends
        found = archive.evaluate(k[:count])
        if count == len(k):
            _tell(algorithm, proposed, *found)
        archive.close_generation(time.perf_counter() - began)
        latest = archive.history[-1]
        if progress is not None and progress(latest) is True:
            return "by its progress"
        if solver.seconds is not None and latest.seconds >= solver.seconds:
            return f"after {solver.seconds:g} s"
    return ""


def _begun(problem: FootProblem, solver: Solver, known: Known, start: Any, termination: Any) -> Any:
    """A solver's pymoo algorithm, set up; moves by runs propose none of the `known` designs again."""
    solver.check_space(problem.space)
    algorithm = solver.build(problem.n_obj)
    algorithm.data[KNOWN] = known
    size = getattr(algorithm, "pop_size", None)  # a variable of pymoo's in G3PCX
    needed = (solver.walks or WALKS) // (size if isinstance(size, int) and size else solver.size) + 1
    most = solver.n_gen or REPEATS * max(needed, solver.generations(problem.space))
    ends = copy.deepcopy(termination) or ("n_gen", most)
    try:
        algorithm.setup(problem, termination=ends, seed=solver.seed, verbose=False)
    except AssertionError as error:  # by which MOEA/D, DNSGA2 and KGB refuse constraints
        needs = "an algorithm that takes constraints: a walk may fail, and a sole leave its box"
        hint = f"pymoo says: {error} Try solver=nsga2, or another."
        raise SettingError("solver", solver.name, needs, hint) from error
    if start is not None:
        from pymoo.core.initialization import Initialization

        initial: Any = getattr(algorithm, "initialization", None)
        check(initial is not None, "start", solver.name, "left out: this solver draws its own designs")
        most = next(solver.sizes())
        start = problem.space.check(start)
        check(len(start) <= most, "start", len(start), f"at most {most} designs")
        drawing = Initialization(initial.sampling)
        drawn = drawing.do(problem, most, random_state=algorithm.random_state)
        check(len(start) <= len(drawn), "start", len(start), f"no more than its sampling gives, {len(drawn)}")
        for one, k in zip(drawn, start, strict=False):
            one.X = dict(zip(problem.vars, k.tolist(), strict=True)) if isinstance(one.X, dict) else k
        initial.sampling = drawn
    return algorithm


def _tell(algorithm: Any, proposed: Any, f: Array, g: Array) -> None:
    """Tell F and G of the generation that was proposed, (designs, ...)."""
    violation = np.maximum(g, 0.0).sum(axis=1, keepdims=True)  # which pymoo would compute for each design
    individuals, columns = np.atleast_1d(proposed), map(list, (f, g, violation))  # it may be one individual
    for one, *values in zip(individuals, *columns, strict=True):
        one.F, one.G, one.CV = values
        one.evaluated.update("FG")
    algorithm.evaluator.n_eval += len(f)
    algorithm.tell(infills=proposed)
