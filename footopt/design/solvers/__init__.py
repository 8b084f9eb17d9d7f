"""Solvers by name: one builder each of a pymoo algorithm over whole numbers."""

from footopt.design.solvers.registry import AUTO, EXHAUSTIVE, SINGLE, SOLVERS, WALKS, Solver, register

__all__ = ["AUTO", "EXHAUSTIVE", "SINGLE", "SOLVERS", "WALKS", "Solver", "register"]
