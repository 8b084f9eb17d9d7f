"""A race through a small space: a sole whose coarse walk has lost does not walk as finely as a search does.

The coarse walk (`FootProblem.coarser`) ends where it has lost: work, peak power and loss of speed only grow.
Two margins, both of the soles that a search has found, say who may still be among the best: a sole is better
than its coarse walk by at most `SAFETY` times what one of these was, and its distance times height is at most
`FARTHER` times the largest. Soles that walk twice are held against both, so that a result can say how near
they came.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from footopt.design import exhaustive
from footopt.design.context import context, digest
from footopt.design.evaluator import Evaluator
from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.design.result import SearchResult
from footopt.design.solvers import EXHAUSTIVE, Solver
from footopt.design.store import BEATEN
from footopt.errors import check
from footopt.files.tasks import Tasks
from footopt.walk.metrics import Ends
from footopt.walk.simulate import NEVER

SAFETY, FARTHER = 2.0, 1.2


def check_race(problem: FootProblem, solver: Solver) -> None:
    """Raise a `SettingError` where nothing tells on the way that a solver's walk can end."""
    if solver.race and solver.name == EXHAUSTIVE:
        several = "false for several objectives, of which no design can be told to have lost"
        check(problem.n_obj == 1, "solver.race", True, several)
    elif solver.race:
        needs = f"false for {', '.join(problem.names)}, of which a part of a walk does not tell"
        hint = "Of work, peak_power and speed_loss, in one scene, it does."
        check(problem.lost(0.0) != NEVER, "solver.race", True, needs, hint)


class Race:
    """`problem.Race` of a problem of one objective.

    Parameters
    ----------
    evaluator : Evaluator
        Of the problem. A file beside its store keeps which soles of a batch were not beaten.
    found : SearchResult
        Of a search of the problem: its soles give the margins, and the first limit.

    Attributes
    ----------
    margin, seen : float
        What a sole may be better than coarsely, and what one was at most; relative.
    room, reached : float
        What distance times height may be, and was at most; m^2.
    """

    def __init__(self, evaluator: Evaluator, found: SearchResult) -> None:
        self._evaluator, problem = evaluator, evaluator.problem
        own = found.k[found.feasible], found.values[found.feasible]
        f = np.sort(problem.minimised(own[1])[:, 0])
        self._first = float(f[exhaustive.KEPT - 1]) if len(f) >= exhaustive.KEPT else np.inf
        coarser = copy(problem) if problem.accuracy.coarser is None else problem.coarser()
        coarsely = coarser.minimised(Evaluator(coarser, None, evaluator.executor)(own[0])[0])[:, 0]
        self.seen = self.reached = 0.0
        self._compare(coarsely, own[1])
        self.margin, self.room = SAFETY * self.seen, FARTHER * self.reached
        raced = coarser.stopping(self._ends(problem))
        self._coarsely = Evaluator(raced, None, evaluator.executor)
        store = evaluator.store
        self._done = Tasks(None if store is None else store.path.with_suffix(".raced.jsonl"))
        self._name = digest([context(problem), problem.space.box_tolerance, self.margin, self.room])

    def __call__(self, k: Ints, limit: float) -> tuple[Array, Words]:
        limit = min(limit, self._first)
        batch = [self._name, limit, k[0].tolist(), k[-1].tolist(), len(k)]
        left, coarsely = self._done(batch, lambda: self._left(k, limit))
        values = np.full((len(k), len(self._evaluator.problem.record)), np.nan)
        reasons = np.full(len(k), BEATEN, dtype=object)
        if left:
            values[left], reasons[left] = self._evaluator(k[left])
            self._compare(np.array(coarsely), values[left])
        return values, reasons

    def _left(self, k: Ints, limit: float) -> tuple[list[int], list[float]]:
        """The places of those soles of a batch that may be within the limit, and what they are coarsely."""
        values, reasons = self._coarsely(k)
        f = self._evaluator.problem.minimised(values)[:, 0]
        lost = (reasons == BEATEN) | ((reasons == "") & (f - self.margin * np.abs(f) > limit))
        return np.flatnonzero(~lost).tolist(), f[~lost].tolist()

    def _compare(self, coarsely: Array, values: Array) -> None:
        """Take note of soles that have walked twice."""
        problem = self._evaluator.problem
        walked = np.isfinite(values[:, problem.record.index(problem.guide)]) & (
            coarsely != problem.objectives[0].worst
        )
        f, values = coarsely[walked], values[walked]
        if len(f):
            better = (f - problem.minimised(values)[:, 0]) / np.abs(f)
            far = values[:, problem.record.index("distance")] * values[:, problem.record.index("mean_height")]
            self.seen, self.reached = max(self.seen, float(better.max())), max(self.reached, float(far.max()))

    def _ends(self, problem: FootProblem) -> Ends:
        """What a coarse walk must not exceed, if it is to be within the first limit."""
        if problem.guide == "efficiency" and problem.takes and self._first < 0.0:
            return NEVER._replace(cost=-self.room * (1.0 + self.margin) / self._first)
        return problem.lost(self._first / max(1.0 - self.margin, 1e-9))
