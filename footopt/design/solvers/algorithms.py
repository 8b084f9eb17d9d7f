"""A builder for each solver; pymoo's modules are imported when one of them is asked for."""

from dataclasses import replace
from functools import partial
from importlib import import_module
from typing import Any

from footopt.design.solvers.registry import Solver, register

single = partial(register, single=True)


def genetic(solver: Solver, path: str, **parameters: Any) -> Any:
    """The algorithm at a path below `pymoo.algorithms`, with moves of runs, or the operators given."""
    from pymoo.core.repair import NoRepair

    from footopt.design.solvers.operators import by_runs, operators

    module, name = path.split(":")
    algorithm = getattr(import_module(f"pymoo.algorithms.{module}"), name)
    moves = by_runs() if solver.operators is None else operators(**solver.operators)
    built = algorithm(pop_size=solver.size, **moves, **parameters)
    built.initialization.repair = NoRepair()  # what a user begins with is proposed, wherever it lies
    return built


@single
def memetic(solver: Solver, n_obj: int) -> Any:
    """Genetic algorithm with moves that suit a spline, few parents, descents and restarts."""
    from footopt.design.solvers.memetic import Memetic

    return Memetic(solver.pop_size)


@register
def archive(solver: Solver, n_obj: int) -> Any:
    """The moves of `memetic`; every design that no other dominates is a parent."""
    from footopt.design.solvers.memetic import Archive

    return Archive(solver.pop_size)


@single
def ga(solver: Solver, n_obj: int) -> Any:
    """Genetic algorithm with elitist survival: the paper's solver."""
    return genetic(replace(solver, operators=solver.operators or {}), "soo.nonconvex.ga:GA")


@single
def de(solver: Solver, n_obj: int) -> Any:
    """Differential evolution, DE/rand/1/bin, rounded (Storn & Price 1997)."""
    from pymoo.algorithms.soo.nonconvex.de import DE
    from pymoo.operators.repair.rounding import RoundingRepair
    from pymoo.operators.sampling.rnd import IntegerRandomSampling

    return DE(
        pop_size=solver.size,
        variant="DE/rand/1/bin",
        **{"CR": 0.5, "F": 0.5, **(solver.operators or {})},
        sampling=IntegerRandomSampling(),
        repair=RoundingRepair(),
    )


@register
def nsga2(solver: Solver, n_obj: int) -> Any:
    """NSGA-II: non-dominated sorting and crowding (Deb et al. 2002)."""
    return genetic(solver, "moo.nsga2:NSGA2")


@register
def nsga3(solver: Solver, n_obj: int) -> Any:
    """NSGA-III: survival by reference directions (Deb & Jain 2014)."""
    from pymoo.operators.selection.tournament import TournamentSelection

    from footopt.design.solvers.operators import less_violation, reference_directions

    directions = reference_directions(n_obj, solver.size)
    selection = TournamentSelection(func_comp=less_violation)
    return genetic(solver, "moo.nsga3:NSGA3", ref_dirs=directions, selection=selection)


@register
def agemoea2(solver: Solver, n_obj: int) -> Any:
    """AGE-MOEA-II: survival by an estimate of the front's geometry (Panichella 2022)."""
    from footopt.design.solvers.operators import Geometry

    algorithm = genetic(solver, "moo.age2:AGEMOEA2")
    algorithm.survival = Geometry()
    return algorithm


@register
def smsemoa(solver: Solver, n_obj: int) -> Any:
    """SMS-EMOA: survival by contribution to the hypervolume (Beume, Naujoks & Emmerich 2007)."""
    return genetic(solver, "moo.sms:SMSEMOA")


@register
def rvea(solver: Solver, n_obj: int) -> Any:
    """RVEA: reference vectors with an angle-penalised distance (Cheng et al. 2016)."""
    from footopt.design.solvers.operators import reference_directions

    return genetic(solver, "moo.rvea:RVEA", ref_dirs=reference_directions(n_obj, solver.size))


@register
def exhaustive(solver: Solver, n_obj: int) -> Any:
    """Every design of a small space, in batches."""
    from footopt.design.solvers.exhaustive import Exhaustive

    return Exhaustive(solver.size)
