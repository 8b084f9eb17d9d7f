"""The paper, reproduced and judged: its figures, its claims one by one, and its slips."""

from footopt.studies.paper.study import run

__all__ = ["run"]
