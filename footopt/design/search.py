"""`search`: an ask/tell loop around any solver that keeps every design it has evaluated."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path

from footopt.design.archive import Archive
from footopt.design.evaluator import Evaluator
from footopt.design.exhaustive import enumerate_space
from footopt.design.problem import FootProblem
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import EXHAUSTIVE, Solver
from footopt.design.store import Store
from footopt.errors import check, check_kind

BUDGET = ("pop_size", "n_gen", "seed")  # of a solver that is named


def search(
    problem: FootProblem,
    solver: Solver | str | None = None,
    progress: Callable[[Generation], None] | None = None,
    store: Store | str | Path | None = None,
    executor: Executor | None = None,
    **budget: int,
) -> SearchResult:
    """Search a design space.

    Parameters
    ----------
    problem : FootProblem
        What is searched.
    solver : Solver or str, optional
        A name will do. By default the memetic GA for one objective and NSGA-II for several.
    progress : callable, optional
        Called with each `Generation`.
    store : str, Path or Store, optional
        A file to keep every evaluation in. The same search with the same store goes on where it was
        stopped: nothing is walked twice, and the result is the same, to the last bit, as that of a
        search never stopped.
    executor : concurrent.futures.Executor, optional
        Who walks: threads, processes, a dask client's executor, MPI. By default this process does. The
        result is the same, to the last bit.
    **budget : int
        pop_size, n_gen and seed of the solver.

    Returns
    -------
    SearchResult
        Also when the user interrupts it (Ctrl-C), of what was found so far.

    Raises
    ------
    SettingError
        The solver does not fit the number of objectives.
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
    for name, value in budget.items():
        check(name in BUDGET, name, value, f"one of {', '.join(BUDGET)}, as a keyword")
    if not isinstance(solver, Solver):
        default = "memetic" if problem.n_obj == 1 else "nsga2"
        solver = Solver(name=solver or default, **budget)
    elif budget:
        solver = Solver(**(asdict(solver) | budget))
    opened = Store(store, problem) if isinstance(store, (str, Path)) else nullcontext(store)
    with opened as kept:
        evaluator = Evaluator(problem, kept, executor)
        if solver.name == EXHAUSTIVE:
            return enumerate_space(problem, solver, progress, evaluator)
        return ask_and_tell(problem, solver, progress, evaluator)


def ask_and_tell(
    problem: FootProblem,
    solver: Solver,
    progress: Callable[[Generation], None] | None,
    evaluator: Evaluator,
) -> SearchResult:
    """Ask the solver for a generation, walk what is new of it, tell the solver, and so on."""
    from footopt.design.pymoo_problem import Algorithm

    algorithm, archive = Algorithm(problem, solver), Archive(problem, evaluator)
    started, interrupted = time.perf_counter(), False
    try:
        while (k := algorithm.ask()) is not None:
            algorithm.tell(*archive.evaluate(k))
            archive.close_generation(time.perf_counter() - started)
            if progress is not None:
                progress(archive.history[-1])
    except KeyboardInterrupt:
        interrupted = True
    return archive.result(solver, time.perf_counter() - started, interrupted, evaluator.reused)
