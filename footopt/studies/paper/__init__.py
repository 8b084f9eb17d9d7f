"""The paper, reproduced and judged: its figures, its claims one by one, and its slips."""

from footopt.studies.paper.study import run
from footopt.studies.paper.walks import Settings

__all__ = ["Settings", "run"]
