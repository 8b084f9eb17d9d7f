"""The search for a foot: a pymoo problem, solvers by name, and the loop that runs them."""

from footopt.design.cluster import Dask
from footopt.design.engines import ENGINES, Local, make_engine
from footopt.design.problem import FootProblem
from footopt.design.processes import Processes
from footopt.design.robust import RobustProblem
from footopt.design.safely import evaluate_safely
from footopt.design.search import Confirmation, Generation, SearchResult, confirm, search
from footopt.design.solvers import EXHAUSTIVE, SINGLE, SOLVERS, Solver
from footopt.design.store import Store
from footopt.design.workers import Engine, WorkerError

__all__ = [
    "ENGINES",
    "EXHAUSTIVE",
    "SINGLE",
    "SOLVERS",
    "Confirmation",
    "Dask",
    "Engine",
    "FootProblem",
    "Generation",
    "Local",
    "Processes",
    "RobustProblem",
    "SearchResult",
    "Solver",
    "Store",
    "WorkerError",
    "confirm",
    "evaluate_safely",
    "make_engine",
    "search",
]
