"""`Evaluator`: values of designs, read from a store or walked. `Archive`: all designs of a run."""

import logging
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from statistics import median
from typing import Any, NamedTuple, Self

import numpy as np

from footopt.arrays import Array, Ints, Words
from footopt.design.executor import Workers, walk
from footopt.design.fronts import Volume, nondominated
from footopt.design.problem import FootProblem, Known
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import Solver
from footopt.design.store import ERROR, Store
from footopt.errors import FootoptError
from footopt.foot.waypoints import heights_text
from footopt.walk.objectives import MEASURES

log = logging.getLogger("footopt")


class Evaluator:
    """Recorded values and reasons of designs, each read from the store, or evaluated and kept there.

    The store is of the same problem. The workers of the executor evaluate, by default this process. `reused`
    counts designs that were read. One whose walk raised an exception is evaluated again.
    """

    def __init__(
        self, problem: FootProblem, store: Store | None = None, executor: Executor | None = None
    ) -> None:
        if store is not None and store.problem is not problem:
            raise ValueError("the store was opened for another problem than the one that is searched")
        self.problem, self.store, self.executor, self.reused = problem, store, executor, 0
        self._walk: Any = partial(walk, problem) if executor is None else Workers(problem, executor)
        self._works = False  # whether some walk has raised no exception

    def __call__(self, k: Ints) -> tuple[Array, Words]:
        """Recorded values (designs, record) and why each walk failed, or "", of designs (designs, n)."""
        values, reasons = np.empty((len(k), len(self.problem.record))), np.full(len(k), ERROR, object)
        if self.store is not None:
            values, reasons = self.store.get(k)
        new = np.array([reason.startswith(ERROR) for reason in reasons])
        self.reused += int((~new).sum())
        if new.any():
            values[new], reasons[new] = self._walk(k[new])
            values[np.isnan(values)] = np.nan  # one NaN: a store keeps no other
            self._report(k[new], reasons[new].tolist())
            if self.store is not None:
                self.store.add(k[new], values[new], reasons[new])
        return values, reasons.astype(np.str_)

    def _report(self, k: Ints, reasons: Sequence[str]) -> None:
        """Warn of walks that have raised an exception; raise if all have, from the first one on."""
        failed = [i for i, reason in enumerate(reasons) if reason.startswith(ERROR)]
        if len(failed) == len(k) and not (self._works or self.reused):
            raise FootoptError(f"All {len(k)} designs of the first generation end in an {reasons[0]}")
        self._works = True
        for i in failed:
            log.warning("design %s is left out: %s", heights_text(k[i]), reasons[i])


class Designs(NamedTuple):
    """Evaluated designs, a row each; see `SearchResult` for the columns."""

    k: Ints
    values: Array
    reasons: Words
    violation: Array
    generation: Ints

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """All designs of some parts."""
        return cls._make(np.concatenate(columns) for columns in zip(*parts, strict=True))


def causes(counts: Mapping[str, int]) -> str:
    """How many designs are infeasible for which reasons, in words."""
    words = {"box": "outside the box"} | {name: f"beyond the limit of {name}" for name in MEASURES}
    return ", ".join(f"{n} {words.get(cause, cause)}" for cause, n in sorted(counts.items()))


class Archive:
    """Every distinct design of a run; `walk`, such as an `Evaluator`, evaluates new ones."""

    def __init__(self, problem: FootProblem, walk: Callable[[Ints], tuple[Array, Words]]) -> None:
        self.problem, self._walk = problem, walk
        self.history: list[Generation] = []
        k, values = np.empty((0, problem.space.n), np.int64), np.empty((0, len(problem.record)))
        # each generation's; joined at the end only
        self.found = [Designs(k, values, np.empty(0, np.str_), np.empty(0), np.empty(0, np.int64))]
        # of these, minimised objectives and constraints
        self._f, self._g = np.empty((0, problem.n_obj)), np.empty((0, problem.n_ieq_constr))
        self.known = Known()  # where a design is in `designs`
        self._latest = np.empty(0, np.int64)
        self._box: tuple[Array, Array] | None = None  # worst values and ranges that volumes are measured by
        self._hypervolume = Volume()
        # at the end of the last generation: generations, designs, front, which an interrupted search reports
        self._closed = (0, 0, np.empty(0, np.int64))

    def affordable(self, k: Ints, most: float) -> int:
        """How many of some designs, from the first on, fit into a budget of `most` different designs."""
        room = most - len(self.known)
        fresh = self.known.fresh(k) if len(k) > room else ()
        return len(k) if len(fresh) <= room else int(fresh[int(room)])

    def evaluate(self, k: Ints) -> tuple[Array, Array]:
        """F and G of a generation, (designs, ...); known designs are not evaluated again."""
        new, problem = k[self.known.fresh(k)], self.problem
        if len(new):
            values, reasons = self._walk(new)
            self.known.add(new)
            violation, generation = problem.space.box_violation(new), np.full(len(new), len(self.history) + 1)
            self.found.append(Designs(new, values, reasons, violation, generation))
            self._f = np.concatenate([self._f, problem.minimised(values)])
            self._g = np.concatenate([self._g, problem.constraints(values, reasons, violation)])
        self._latest = self.known.places(k)
        return self._f[self._latest], self._g[self._latest]

    def close_generation(self, seconds: float) -> None:
        """Write the generation into the history."""
        front, one, sign = self._front(), self.problem.n_obj == 1, self.problem.objectives[0].sign
        latest = self._latest[(self._g[self._latest] <= 0.0).all(axis=1)]
        self.history.append(
            Generation(
                generation=len(self.history) + 1,
                evaluations=len(self._latest) + (self.history[-1].evaluations if self.history else 0),
                best=float(sign * self._f[front].min()) if one and len(front) else math.nan,
                median=sign * median(self._f[latest, 0].tolist()) if one and len(latest) else math.nan,
                front=len(front),
                seconds=seconds,
                hypervolume=math.nan if one else self._volume(front),
            )
        )
        self._closed = (len(self.history), len(self.known), front)

    def _volume(self, front: Ints) -> float:
        """Hypervolume of the front, in units of the box of what the first generation walked."""
        if self._box is None:
            f = self._f[self._g[:, 0] <= 0.0]  # with all values
            if not len(f) or (np.ptp(f, axis=0) == 0.0).any():
                return math.nan
            self._box = f.max(axis=0), np.ptp(f, axis=0)
        worst, span = self._box
        return self._hypervolume((self._f[front] - worst) / span)

    def result(self, solver: Solver, seconds: float, interrupted: bool, reused: int) -> SearchResult:
        """Everything that was evaluated up to the last finished generation, and the best of it."""
        generations, count, front = self._closed
        designs = Designs._make(column[:count] for column in Designs.joined(self.found))
        reasons = self.problem.reasons(designs.values, designs.reasons, designs.violation)
        if not len(front) and interrupted:
            raise KeyboardInterrupt("before a feasible design was found")
        if not len(front):
            raise FootoptError(
                f"No feasible design among {count}: {causes(Counter(reasons.tolist()))}. "
                "Try more generations, a larger foot.box_tolerance, wider limits, or harder sand."
            )
        front = front[np.argsort(self.problem.scores(designs.values[front]), kind="stable")]
        return SearchResult(
            problem=self.problem,
            solver=solver,
            **designs._replace(reasons=reasons)._asdict(),
            history=self.history[:generations],
            best=int(front[0]),
            front=front[:1] if self.problem.n_obj == 1 else front,
            evaluations=self.history[generations - 1].evaluations,
            seconds=seconds,
            interrupted=interrupted,
            reused=reused,
        )

    def _front(self) -> Ints:
        """The non-dominated of the last front and the newest feasible designs."""
        _, count, front = self._closed
        new = count + np.flatnonzero((self._g[count:] <= 0.0).all(axis=1))
        if not len(new):
            return front
        both = np.concatenate([front, new])
        return both[nondominated(self._f[both])]
