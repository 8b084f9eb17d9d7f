"""Every design of a small space: the exact best, or the exact Pareto front.

Designs stream through in batches, and only what may still be among the best is kept. What a solver
finds on such a space can be held against the truth: see `footopt.studies.trust`.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from footopt.design.archive import Designs, no_designs, nothing_feasible
from footopt.design.evaluator import Evaluator
from footopt.design.fronts import nondominated
from footopt.design.problem import FootProblem, Ints
from footopt.design.result import Generation, SearchResult
from footopt.design.solvers import Solver
from footopt.errors import SettingError
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
        """How many failed or leave their box, in all."""
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


def best_of(designs: Designs, problem: FootProblem) -> Designs:
    """What is worth keeping: the `KEPT` best by a single objective, best first, or the front of several."""
    f = problem.minimised(designs.values)
    if problem.n_obj == 1:
        return designs.take(np.argsort(f[:, 0], kind="stable")[:KEPT])
    return designs.take(nondominated(f))


def enumerate_space(
    problem: FootProblem,
    solver: Solver,
    progress: Callable[[Generation], object] | None,
    evaluator: Evaluator,
) -> Enumeration:
    """Walk with every design of a space that is inside its box.

    The solver's pop_size is the number of designs in memory at a time; `progress` is called after each
    batch. The result is exact, unless `interrupted` or `stopped`.
    """
    check_size(problem)
    started, space = time.perf_counter(), problem.space
    column, nan = problem.record.index(problem.guide), float("nan")
    best = no_designs(problem)
    counts: Counter[str] = Counter()
    history: list[Generation] = []
    interrupted, stopped = False, ""
    single = problem.n_obj == 1
    try:
        for number, k in enumerate(batches(space, solver.size), start=1):
            violation, median = space.box_violation(k), nan
            inside = violation <= space.box_tolerance * space.H
            reasons = np.full(len(k), "box", dtype=object)
            if inside.any():
                values, why = evaluator(k[inside])
                reasons[inside] = verdicts = problem.verdicts(values, why, violation[inside])
                walked = Designs(k[inside], values, why, violation[inside], np.full(inside.sum(), number))
                feasible = walked.take(verdicts == "")
                best = best_of(best.joined(feasible), problem)
                if single and len(feasible.k):
                    median = float(np.median(feasible.values[:, column]))
            counts.update(reasons)
            history.append(
                Generation(
                    generation=number,
                    evaluations=counts.total() - counts["box"],
                    best=float(best.values[0, column]) if single and len(best.k) else nan,
                    median=median,
                    front=min(len(best.k), 1) if single else len(best.k),
                    seconds=time.perf_counter() - started,
                )
            )
            if progress is not None and progress(history[-1]) is True:
                stopped = "by its progress"
                break
    except KeyboardInterrupt:
        interrupted = True
    if not len(best.k):
        raise nothing_feasible(counts, interrupted, hint="")
    best = best.take(np.argsort(problem.ranked(best.values), kind="stable"))
    return Enumeration(
        problem=problem,
        solver=solver,
        **best._asdict(),
        feasible=np.full(len(best.k), True),
        history=history,
        best=0,
        front=np.arange(1 if single else len(best.k)),
        evaluations=history[-1].evaluations,
        seconds=time.perf_counter() - started,
        interrupted=interrupted,
        reused=evaluator.reused,
        stopped=stopped,
        counts=dict(counts),
    )
