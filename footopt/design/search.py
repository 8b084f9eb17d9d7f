"""`search`: an ask/tell loop around any solver that keeps every design it has evaluated."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import NoneType
from typing import Any

from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from footopt.arrays import Ints
from footopt.design.archive import Archive, Evaluator
from footopt.design.problem import FootProblem
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import AUTO, EXHAUSTIVE, Solver
from footopt.design.store import Store
from footopt.errors import check, check_kind

BUDGET = ("walks", "pop_size", "n_gen", "seconds", "seed", "operators")  # of a solver that is named
ENOUGH = "by the solver, which proposed nothing more"


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
        A name will do, and so will an algorithm of pymoo, of which a copy searches. By default the best one
        for the number of objectives (`Solver.fitting`).
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
    check_kind(problem, FootProblem, "problem", "Try fo.FootProblem(scene)")
    ends = stop is None or isinstance(stop, tuple) or hasattr(stop, "has_terminated")
    check(ends, "stop", stop, "a termination of pymoo", 'Try ("n_gen", 50)')
    for name, value in budget.items():
        check(name in BUDGET, name, value, f"one of {', '.join(BUDGET)}, as a keyword")
    if not isinstance(solver, (Solver, str, NoneType)):
        from footopt.design.asking import as_solver

        solver = as_solver(solver, budget)
    elif not isinstance(solver, Solver):
        solver = Solver(name=solver or AUTO, **budget)
    elif budget:
        solver = replace(solver, **budget)
    solver = solver.fitting(problem.n_obj)
    opened = Store(store, problem) if isinstance(store, (str, Path)) else nullcontext(store)
    with opened as kept:
        evaluator = Evaluator(problem, kept, executor)
        tell = _line(solver.generations(problem.space)) if progress is True else progress or None
        first = None if start is None else problem.space.check(start)
        return ask_and_tell(problem, solver, tell, evaluator, stop, first)


def _line(generations: int) -> Callable[[Generation], None]:
    """A progress that keeps one line of standard error up to date."""

    def show(g: Generation) -> None:
        value = f"best {g.best:.4g}" if math.isfinite(g.best) else f"hypervolume {g.hypervolume:.4g}"
        end = "\n" if g.generation == generations else ""
        where = f"generation {g.generation}/{generations}, {g.evaluations} evaluations"
        print(f"\r{f'{where}, {value}, {g.seconds:.1f} s':<78}", end=end, file=sys.stderr, flush=True)

    return show


def ask_and_tell(
    problem: FootProblem,
    solver: Solver,
    progress: Callable[[Generation], object] | None,
    evaluator: Any,
    termination: Any,
    start: Ints | None = None,
) -> SearchResult:
    """Ask the solver for a generation, walk what is new of it, tell the solver, and so on.

    An `evaluator` is called like an `Evaluator`, and has its `reused`.
    """
    from footopt.design.asking import Algorithm

    archive = Archive(problem, evaluator)
    algorithm = Algorithm(problem, solver, archive.known, start, termination)
    most = math.inf if termination is not None and not solver.walks else solver.most
    started, interrupted, stopped = time.perf_counter(), False, ""
    try:
        with threadpool_limits(1, "blas"):  # too little for threads, which would wait for each other
            while archive.count < most:
                if (k := algorithm.ask()) is None:
                    ended = algorithm.terminated or len(archive.history) == solver.n_gen
                    stopped = "" if ended or solver.name == EXHAUSTIVE else ENOUGH
                    break
                first = archive.first(k, most)  # the last generation is cut where the walks end
                found = archive.evaluate(k[:first])
                if first == len(k):
                    algorithm.tell(*found)
                archive.close_generation(time.perf_counter() - started)
                if progress is not None and progress(archive.history[-1]) is True:
                    stopped = "by its progress"
                if solver.seconds is not None and archive.history[-1].seconds >= solver.seconds:
                    stopped = stopped or f"after {solver.seconds:g} s"
                if stopped:
                    break
    except KeyboardInterrupt:
        interrupted = True
    seconds = time.perf_counter() - started
    result = archive.result(solver, seconds, interrupted, evaluator.reused)
    return replace(result, stopped=stopped)
