"""A builder for each solver of our own; its module is imported when it is asked for."""

from functools import partial
from typing import Any

from footopt.design.solvers.registry import Solver, register


@partial(register, single=True)
def memetic(solver: Solver, n_obj: int) -> Any:
    """Genetic algorithm with moves that suit a spline, few parents, descents and restarts."""
    from footopt.design.solvers.memetic import Memetic

    return Memetic(solver.pop_size)


@register
def archive(solver: Solver, n_obj: int) -> Any:
    """The moves of `memetic`; every design that no other dominates is a parent."""
    from footopt.design.solvers.memetic import Archive

    return Archive(solver.pop_size)


@register
def exhaustive(solver: Solver, n_obj: int) -> Any:
    """Every design of a small space, in batches."""
    from footopt.design.solvers.exhaustive import Exhaustive

    return Exhaustive(solver.size)
