"""The search for a foot: a pymoo problem, solvers by name, and the loop that runs them."""

from footopt.design.problem import FootProblem
from footopt.design.robust import RobustProblem
from footopt.design.safely import evaluate_safely
from footopt.design.search import Confirmation, Generation, SearchResult, confirm, search
from footopt.design.solvers import EXHAUSTIVE, SINGLE, SOLVERS, Solver
from footopt.design.store import Store

__all__ = [
    "EXHAUSTIVE",
    "SINGLE",
    "SOLVERS",
    "Confirmation",
    "FootProblem",
    "Generation",
    "RobustProblem",
    "SearchResult",
    "Solver",
    "Store",
    "confirm",
    "evaluate_safely",
    "search",
]
