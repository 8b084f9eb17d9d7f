"""Solvers by name: one builder each of a pymoo algorithm over whole numbers."""

from footopt.design.solvers import algorithms as algorithms
from footopt.design.solvers.registry import EXHAUSTIVE, SINGLE, SOLVERS, Solver, register

__all__ = ["EXHAUSTIVE", "SINGLE", "SOLVERS", "Solver", "register"]
