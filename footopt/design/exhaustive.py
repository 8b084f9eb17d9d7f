"""Every design of a small space: the exact best, or the exact Pareto front.

Designs stream through in batches, and only what may still be among the best is kept. What a solver
finds on such a space can be held against the truth: see `footopt.studies.trust`.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.design.evaluator import Evaluator
from footopt.design.problem import Array, FootProblem, Ints
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import Solver
from footopt.errors import FootoptError, SettingError
from footopt.foot import Waypoints

LIMIT = 20_000_000  # designs; two hours on two cores
KEPT = 1000  # of the best designs by a single objective; of several, the whole front is kept


@dataclass(frozen=True, eq=False, repr=False)
class Enumeration(SearchResult):
    """A space of designs and which are best; fields that differ from those of `SearchResult`:

    Parameters
    ----------
    k : (kept, n)
        The `KEPT` best by the single objective or the exact front, best first.
    counts : dict
        Designs by reason, "" for the feasible; those outside their box are not walked.
    evaluations : int
        Designs that were walked.
    """

    counts: dict[str, int] = field(default_factory=dict)

    @property
    def designs(self) -> int:
        """Every design of the space, walked or outside its box."""
        return sum(self.counts.values())

    @property
    def infeasible(self) -> int:
        """How many failed or leave their box."""
        return self.designs - self.counts.get("", 0)

    @property
    def failures(self) -> dict[str, int]:
        """How many designs are infeasible, by reason."""
        return {reason: count for reason, count in self.counts.items() if reason}


def batches(space: Waypoints, size: int) -> Iterator[Ints]:
    """Every design of a space, (designs, n), `size` at a time; the last waypoint counts fastest."""
    total, powers = space.K**space.n, space.K ** np.arange(space.n)[::-1]
    for begin in range(0, total, size):
        yield 1 + np.arange(begin, min(begin + size, total))[:, None] // powers % space.K


def check_size(problem: FootProblem) -> None:
    """Raise a `SettingError` if the space has too many designs, with the time they would take here."""
    space = problem.space
    if (total := space.K**space.n) <= LIMIT:
        return
    total = min(total, 10**300)  # a float still
    sample = space.random(256, seed=1)
    problem.walk(sample[:1])  # compiled before the clock runs
    started = time.perf_counter()
    problem.walk(sample)
    days = (time.perf_counter() - started) / len(sample) * total / 86400
    raise SettingError(
        "foot.n",
        space.n,
        f"small enough that foot.K^foot.n is at most {LIMIT:,} designs, to walk with all of them",
        f"{space.K}^{space.n} would take {days:.2g} days here. Try foot.n=5, or search with solver=memetic.",
    )


class _Best(NamedTuple):
    """What is worth keeping so far, one row a design."""

    k: Ints
    values: Array
    violation: Array
    batch: Ints

    def take(self, rows: Ints | NDArray[np.bool_]) -> _Best:
        return _Best._make(column[rows] for column in self)

    def joined(self, new: _Best, problem: FootProblem) -> _Best:
        """The best of both, best first."""
        both = _Best._make(np.concatenate(columns) for columns in zip(self, new, strict=True))
        if problem.n_obj == 1:
            return both.take(np.argsort(problem.minimised(both.values)[:, 0], kind="stable")[:KEPT])
        from moocore import is_nondominated

        front = both.take(is_nondominated(problem.minimised(both.values), keep_weakly=True))
        return front.take(np.argsort(front.values[:, problem.record.index(problem.guide)], kind="stable"))


def enumerate_space(
    problem: FootProblem,
    solver: Solver,
    progress: Callable[[Generation], None] | None,
    evaluator: Evaluator,
) -> Enumeration:
    """Walk with every design of a space that is inside its box.

    The solver's pop_size is the number of designs in memory at a time; `progress` is called after each
    batch. The result is exact, unless `interrupted`.
    """
    check_size(problem)
    started, space = time.perf_counter(), problem.space
    column, nan = problem.record.index(problem.guide), float("nan")
    best = _Best(
        np.empty((0, space.n), np.int64),
        np.empty((0, len(problem.record))),
        np.empty(0),
        np.empty(0, np.int64),
    )
    counts: Counter[str] = Counter()
    history: list[Generation] = []
    interrupted = False
    try:
        for number, k in enumerate(batches(space, solver.pop_size), start=1):
            violation, median = space.box_violation(k), nan
            inside = violation <= space.box_tolerance * space.H
            reasons = np.full(len(k), "box", dtype=object)
            if inside.any():
                values, why = evaluator(k[inside])
                reasons[inside] = why
                walked = _Best(k[inside], values, violation[inside], np.full(inside.sum(), number))
                feasible = walked.take(why == "")
                best = best.joined(feasible, problem)
                median = float(np.median(feasible.values[:, column])) if len(feasible.k) else nan
            counts.update(reasons)
            history.append(
                Generation(
                    generation=number,
                    evaluations=counts.total() - counts["box"],
                    best=float(best.values[0, column]) if len(best.k) else nan,
                    median=median,
                    front=min(len(best.k), 1) if problem.n_obj == 1 else len(best.k),
                    seconds=time.perf_counter() - started,
                )
            )
            if progress is not None:
                progress(history[-1])
    except KeyboardInterrupt:
        interrupted = True
    if not len(best.k):
        causes = ", ".join(f"{count} {reason}" for reason, count in counts.items())
        raise FootoptError(
            f"No feasible design among {counts.total()}: {causes or 'interrupted'}. "
            "Try a larger foot.box_tolerance, or harder sand."
        )
    return Enumeration(
        problem=problem,
        solver=solver,
        k=best.k,
        values=best.values,
        feasible=np.full(len(best.k), True),
        reasons=np.full(len(best.k), ""),
        violation=best.violation,
        generation=best.batch,
        history=history,
        best=0,
        front=np.arange(1 if problem.n_obj == 1 else len(best.k)),
        evaluations=history[-1].evaluations,
        seconds=time.perf_counter() - started,
        interrupted=interrupted,
        reused=evaluator.reused,
        counts=dict(counts),
    )
