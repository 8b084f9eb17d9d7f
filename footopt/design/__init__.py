"""The search for a foot: a pymoo Problem, solvers by name, and the loop that asks, walks and tells.

pymoo's algorithms take a third of a second to import: nothing here imports them before a search begins.
"""

from footopt.design.archive import Evaluator
from footopt.design.executor import ENGINES, make_executor
from footopt.design.fronts import FRONT_RULES, Choice
from footopt.design.problem import Evaluated, FootProblem
from footopt.design.result import Confirmation, Generation, SearchResult, confirm
from footopt.design.robust import RobustProblem
from footopt.design.scenarios import Scenario, Spread, draw
from footopt.design.search import search
from footopt.design.solvers import AUTO, EXHAUSTIVE, SINGLE, SOLVERS, WALKS, Solver
from footopt.design.store import Store
from footopt.design.to_print import UnderLaws, under_laws

__all__ = [
    "AUTO", "ENGINES", "EXHAUSTIVE", "FRONT_RULES", "SINGLE", "SOLVERS", "WALKS", "Choice",
    "Confirmation", "Evaluated", "Evaluator", "FootProblem", "Generation", "RobustProblem",
    "Scenario", "SearchResult", "Solver", "Spread", "Store", "UnderLaws", "confirm", "draw", "make_executor",
    "search", "under_laws",
]  # fmt: skip
