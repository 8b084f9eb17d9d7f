"""`Archive`: every distinct design of a run, each walked once, and the history of its generations."""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.design.fronts import Volume, nondominated
from footopt.design.known import Known
from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import Solver
from footopt.errors import FootoptError
from footopt.walk.objectives import MEASURES


class Designs(NamedTuple):
    """Evaluated designs, a row each; see `SearchResult` for the columns."""

    k: Ints
    values: Array
    reasons: Words
    violation: Array
    generation: Ints

    def take(self, rows: Ints | NDArray[np.bool_] | slice) -> Designs:
        """Some of them."""
        return Designs._make(column[rows] for column in self)

    def joined(self, new: Designs) -> Designs:
        """These and others."""
        return Designs._make(np.concatenate(columns) for columns in zip(self, new, strict=True))


def no_designs(problem: FootProblem) -> Designs:
    """A table with a problem's columns and no row."""
    k, values = np.empty((0, problem.space.n), np.int64), np.empty((0, len(problem.record)))
    return Designs(k, values, np.empty(0, np.str_), np.empty(0), np.empty(0, np.int64))


def nothing_feasible(
    counts: Counter[str], interrupted: bool, hint: str = "more generations, "
) -> BaseException:
    """What ends a search without a feasible design; counts: of the designs, by their reasons."""
    if interrupted:
        return KeyboardInterrupt("before a feasible design was found")
    return FootoptError(
        f"No feasible design among {counts.total()}: {causes(counts)}. "
        f"Try {hint}a larger foot.box_tolerance, wider limits, or harder sand."
    )


def causes(counts: Mapping[str, int]) -> str:
    """How many designs are infeasible for which reasons, in words."""
    words = {"box": "outside the box"} | {name: f"beyond the limit of {name}" for name in MEASURES}
    return ", ".join(f"{n} {words.get(cause, cause)}" for cause, n in sorted(counts.items()))


class Archive:
    """Every distinct design of a run; `walk` is called with new ones, an `Evaluator` for one."""

    def __init__(self, problem: FootProblem, walk: Callable[[Ints], tuple[Array, Words]]) -> None:
        self.problem, self._walk = problem, walk
        self.history: list[Generation] = []
        self._table, self.count = no_designs(problem), 0  # the table has room for more
        self._good = np.empty(0, np.bool_)  # which are feasible
        self._known = Known()  # where a design is in `designs`
        self._latest = np.empty(0, np.int64)
        self._column = problem.record.index(problem.guide)
        self._sign = MEASURES[problem.guide].sign
        self._box: tuple[Array, Array] | None = None  # worst values and ranges that volumes are measured by
        self._hypervolume = Volume()
        # at the end of a generation: generations, designs, and the front, what an interrupted search reports
        self._closed = (0, 0, np.empty(0, np.int64))
        self._best = np.empty((0, problem.n_obj))  # objectives of that front, minimised

    @property
    def designs(self) -> Designs:
        """All so far, in order."""
        return self._table.take(slice(self.count))

    def first(self, k: Ints, most: float) -> int:
        """How many of designs, from the first, there can be with at most so many different ones in all."""
        fresh, room = self._known.fresh(k), most - self.count
        return len(k) if len(fresh) <= room else int(fresh[int(room)])

    def evaluate(self, k: Ints) -> tuple[Array, Array]:
        """F and G of a generation, (designs, ...); designs seen before are not walked again."""
        new = k[self._known.fresh(k)]
        if len(new):
            values, reasons = self._walk(new)
            self._known.add(new)
            words = np.array([sys.intern(word) for word in reasons.tolist()], object)  # of any length
            generation = np.full(len(new), len(self.history) + 1)
            small = new.astype(np.min_scalar_type(self.problem.space.K))
            self._add(Designs(small, values, words, self.problem.space.box_violation(new), generation))
        self._latest = self._known.places(k)
        asked = self._table.take(self._latest)
        return self.problem.minimised(asked.values), self._constraints(asked)

    def _add(self, new: Designs) -> None:
        """Add rows to the table, which grows by half when it is full: most generations copy nothing."""
        start, self.count = self.count, self.count + len(new.k)
        if self.count > len(self._table.k):
            size = max(self.count, len(self._table.k) * 3 // 2)
            grown = [np.empty((size, *column.shape[1:]), column.dtype) for column in new]
            for column, old in zip(grown, self._table, strict=True):
                column[:start] = old[:start]
            self._table = Designs._make(grown)
        for column, added in zip(self._table, new, strict=True):
            column[start : self.count] = added
        self._good = np.append(self._good, (self._constraints(new) <= 0.0).all(axis=1))

    def close_generation(self, seconds: float) -> None:
        """Write the generation into the history."""
        front = self._front()
        one = self.problem.n_obj == 1
        now = self._guide(self._latest[self._good[self._latest]])
        self.history.append(
            Generation(
                generation=len(self.history) + 1,
                evaluations=len(self._latest) + (self.history[-1].evaluations if self.history else 0),
                best=float(self._sign * self._guide(front).min()) if one and len(front) else math.nan,
                median=float(self._sign * np.median(now)) if one and len(now) else math.nan,
                front=len(front),
                seconds=seconds,
                hypervolume=math.nan if one else self._volume(front),
            )
        )
        self._closed = (len(self.history), self.count, front)

    def _guide(self, places: Ints) -> Array:
        """What ranks designs, minimised, of some of them."""
        return np.asarray(self._sign * self._table.values[places, self._column])

    def _volume(self, front: Ints) -> float:
        """Hypervolume of the front, in units of the box of what the first generation walked."""
        if self._box is None:
            f = self.problem.minimised(self.designs.values[self.designs.reasons == ""])
            if len(f) and (np.ptp(f, axis=0) > 0.0).all():
                self._box = f.max(axis=0), np.ptp(f, axis=0)
        if self._box is None:
            return math.nan
        worst, span = self._box
        return self._hypervolume((self._best - worst) / span, front >= self._closed[1])

    def result(self, solver: Solver, seconds: float, interrupted: bool, reused: int) -> SearchResult:
        """Everything that was evaluated up to the last finished generation, and the best of it."""
        generations, count, front = self._closed
        designs = self._table.take(slice(count))
        designs = designs._replace(k=designs.k.astype(np.int64), reasons=designs.reasons.astype(np.str_))
        reasons = self.problem.verdicts(designs.values, designs.reasons, designs.violation)
        if not len(front):
            raise nothing_feasible(Counter(reasons.tolist()), interrupted)
        front = front[np.argsort(self.problem.ranked(designs.values[front]), kind="stable")]
        return SearchResult(
            problem=self.problem,
            solver=solver,
            **designs._replace(reasons=reasons)._asdict(),
            feasible=self._good[:count],
            history=self.history[:generations],
            best=int(front[0]),
            front=front[:1] if self.problem.n_obj == 1 else front,
            evaluations=self.history[generations - 1].evaluations,
            seconds=seconds,
            interrupted=interrupted,
            reused=reused,
        )

    def _constraints(self, designs: Designs) -> Array:
        return self.problem.constraints(designs.values, designs.reasons, designs.violation)

    def _front(self) -> Ints:
        """The non-dominated of the last front and the newest feasible designs."""
        _, count, front = self._closed
        new = count + np.flatnonzero(self._good[count:])
        if not len(new):
            return front
        f = np.concatenate([self._best, self.problem.minimised(self._table.values[new])])
        kept = nondominated(f)
        self._best = f[kept]
        return np.concatenate([front, new])[kept]
