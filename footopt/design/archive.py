"""`Archive`: every distinct design of a run, each walked once, and the history of its generations."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from footopt.design.problem import Array, Evaluated, FootProblem, Ints, Words
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import Solver
from footopt.errors import FootoptError
from footopt.walk.objectives import OBJECTIVES


class Design(NamedTuple):
    """One evaluated design; see `SearchResult` for the fields."""

    k: Ints
    values: Array
    f: Array  # what the solver minimises
    g: Array  # constraints, <= 0 when met
    reason: str
    violation: float
    generation: int

    @property
    def feasible(self) -> bool:
        """Walked, and inside the box."""
        return bool((self.g <= 0.0).all())


class Closed(NamedTuple):
    """How far a search is at the end of a generation: what an interrupted one reports."""

    generations: int
    designs: int
    front: Ints


class Archive:
    """Every distinct design of a run; `walk` is called with new ones, an `Evaluator` for one."""

    def __init__(self, problem: FootProblem, walk: Callable[[Ints], tuple[Array, Words]]) -> None:
        self.problem, self._walk = problem, walk
        self.history: list[Generation] = []
        self.designs: list[Design] = []
        self._place: dict[bytes, int] = {}  # of a design in `designs`, by its heights
        self._latest: list[int] = []
        self._column = problem.record.index(problem.guide)
        self._sign = -1.0 if OBJECTIVES[problem.guide].maximise else 1.0
        self._closed = Closed(0, 0, np.empty(0, np.int64))

    def evaluate(self, k: Ints) -> tuple[Array, Array]:
        """F and G of a generation, (designs, ...); designs seen before are not walked again."""
        keys = [heights.tobytes() for heights in k]
        new = list({key: i for i, key in enumerate(keys) if key not in self._place}.values())
        if new:
            found = Evaluated(*self._walk(k[new]), self.problem.space.box_violation(k[new]))
            f, g = self.problem.minimised(found.values), self.problem.constraints(found)
            for row, i in enumerate(new):
                self._place[keys[i]] = len(self.designs)
                reason = str(found.reasons[row]) or ("" if (g[row] <= 0.0).all() else "box")
                violation, generation = float(found.violation[row]), len(self.history) + 1
                self.designs.append(
                    Design(k[i], found.values[row], f[row], g[row], reason, violation, generation)
                )
        self._latest = [self._place[key] for key in keys]
        chosen = [self.designs[i] for i in self._latest]
        return np.array([d.f for d in chosen]), np.array([d.g for d in chosen])

    def close_generation(self, seconds: float) -> None:
        """Write the generation into the history."""
        front = self._front()
        now = [self.designs[i].values[self._column] for i in self._latest if self.designs[i].feasible]
        so_far = [self._sign * self.designs[i].values[self._column] for i in front]
        self.history.append(
            Generation(
                generation=len(self.history) + 1,
                evaluations=len(self._latest) + (self.history[-1].evaluations if self.history else 0),
                best=float(self._sign * np.min(so_far)) if so_far else float("nan"),
                median=float(np.median(now)) if now else float("nan"),
                front=len(front),
                seconds=seconds,
            )
        )
        self._closed = Closed(len(self.history), len(self.designs), front)

    def result(self, solver: Solver, seconds: float, interrupted: bool, reused: int) -> SearchResult:
        """Everything that was evaluated up to the last finished generation, and the best of it."""
        generations, count, front = self._closed
        designs = self.designs[:count]
        if not designs:
            raise FootoptError("The search was stopped before its first generation was evaluated.")
        if not len(front):
            causes = sorted(Counter(d.reason for d in designs).items())
            counts = ", ".join(f"{count} {cause}" for cause, count in causes)
            raise FootoptError(
                f"No feasible design among {len(designs)}: {counts}. "
                "Try more generations, a larger foot.box_tolerance, or harder sand."
            )
        rank = [self._sign * designs[i].values[self._column] for i in front]
        front = front[np.argsort(rank, kind="stable")]
        return SearchResult(
            problem=self.problem,
            solver=solver,
            k=np.array([d.k for d in designs]),
            values=np.array([d.values for d in designs]),
            feasible=np.array([d.feasible for d in designs]),
            reasons=np.array([d.reason for d in designs]),
            violation=np.array([d.violation for d in designs]),
            generation=np.array([d.generation for d in designs]),
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
        from moocore import is_nondominated

        fresh = [i for i in range(self._closed.designs, len(self.designs)) if self.designs[i].feasible]
        pool = np.concatenate([self._closed.front, np.array(fresh, np.int64)])
        if not len(pool):
            return pool
        best: Ints = pool[is_nondominated(np.array([self.designs[i].f for i in pool]), keep_weakly=True)]
        return best
