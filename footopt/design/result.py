"""The result of a search: every design, the best, its history, and the best walked again more finely."""

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from footopt.arrays import Array, Bools, Ints, Words
from footopt.design.fronts import nondominated
from footopt.design.problem import FootProblem
from footopt.design.solvers import Solver
from footopt.errors import check_whole
from footopt.foot import Foot
from footopt.walk.accuracy import AnyAccuracy, resolve
from footopt.walk.objectives import MEASURES, relative_change

SHOWN = 10_000  # designs of a front that are walked finely, drawn, and on the page; designs.csv has all


@dataclass(frozen=True)
class Generation:
    """One generation as the search's history keeps it; values are NaN before a design is feasible."""

    generation: int  # from 1
    evaluations: int  # designs proposed so far
    best: float  # value of the single objective so far; NaN when there are several
    median: float  # of that value over the generation's feasible designs
    front: int  # designs on the front of all evaluated so far; 1 for a single objective
    seconds: float  # s, since the search began
    #: of the front when there are several objectives: 1 is the box of the values of the first generation,
    #: from its worst corner, and a front that goes beyond it has more
    hypervolume: float = math.nan


@dataclass(frozen=True, eq=False, repr=False)
class SearchResult:
    """Every design that a search evaluated, in order, and which are best.

    Parameters
    ----------
    problem : FootProblem
        What was searched.
    solver : Solver
        The solver that searched it.
    k : (designs, n)
        Heights; no design twice.
    values : (designs, record)
        Recorded values with their natural signs, NaN for a failed walk; columns are ``problem.record``.
    reasons : (designs,)
        Why a walk failed ("error": it broke the program), or "box", or the limit that is not kept, or "".
    violation : (designs,), m
        How far the sole leaves its box.
    generation : (designs,)
        In which the design was first proposed.
    history : list of Generation
        One entry a generation.
    best : int
        Index of the best design: of the objective, or the one of the front that ``problem.choice`` takes.
    front : (front,)
        Indices of the non-dominated feasible designs, the chosen one first.
    evaluations : int
        Designs that the solver proposed; one that comes up again is not walked again.
    seconds : float, s
        How long it took.
    interrupted : bool
        Whether it was stopped before its last generation; all this is then of the finished ones.
    reused : int
        Designs that were read from the store, not walked.
    stopped : str
        Why it ended before its last generation: "after 60 s", "by its progress"; "" if it did not.
    """

    problem: FootProblem
    solver: Solver
    k: Ints
    values: Array
    reasons: Words
    violation: Array
    generation: Ints
    history: list[Generation]
    best: int
    front: Ints
    evaluations: int
    seconds: float
    interrupted: bool
    reused: int = 0
    stopped: str = ""

    def __repr__(self) -> str:
        best = zip(self.problem.record, self.values[self.best], strict=True)
        values = "; ".join(f"{name} {value:.4g}" for name, value in best)
        title = f"<SearchResult of {self.solver.name} on {self.problem.scene.title}"
        return f"{title}: {self.designs} designs; best {self.foot.name}: {values}>"

    @property
    def designs(self) -> int:
        """How many different designs were evaluated."""
        return len(self.k)

    @property
    def feasible(self) -> Bools:
        """Which of them walk, are inside their box and keep the limits, (designs,)."""
        return np.asarray(self.reasons == "")

    @property
    def X(self) -> Ints:
        """Heights of the front (front, n), or of the one best (n,), as in a pymoo result."""
        return np.asarray(self._of_pymoo(self.k))

    @property
    def F(self) -> Array:
        """Objectives of `X`, all minimised: (front, objectives), or (1,) of one best."""
        return np.asarray(self._of_pymoo(self.problem.minimised(self.values)))

    @property
    def G(self) -> Array:
        """Constraints of `X`, met where at most 0: (front, constraints), or (constraints,) of one best."""
        return np.asarray(self._of_pymoo(self.problem.constraints(self.values, self.reasons, self.violation)))

    def _of_pymoo(self, rows: Any) -> Any:
        """Rows of the front; the single row of the best design where there is one objective."""
        chosen = rows[self.front]
        return chosen[0] if self.problem.n_obj == 1 else chosen

    @property
    def shown(self) -> Ints:
        """Indices of the front, of which a large one is an even selection of `SHOWN`, the best first."""
        count = len(self.front)
        return self.front[np.linspace(0, count - 1, min(count, SHOWN)).astype(np.int64)]

    @property
    def foot(self) -> Foot:
        """The best design."""
        return Foot.from_waypoints(self.k[self.best], self.problem.space)

    def leaders(self, most: int) -> Ints:
        """Indices of the best feasible designs, at most `most` of them, the best first."""
        pool = np.flatnonzero(self.feasible)
        return pool[np.argsort(self.problem.scores(self.values[pool]), kind="stable")[:most]]

    def uninterrupted(self, doing: str) -> Self:
        """Itself; if it was interrupted, raises a `KeyboardInterrupt` that says what it was `doing`."""
        if self.interrupted:
            raise KeyboardInterrupt(f"while {doing}")
        return self

    def column(self, name: str) -> Array:
        """A recorded value of every design, (designs,), natural sign."""
        if name not in self.problem.record:
            raise KeyError(f"no {name!r} is recorded: there are {', '.join(self.problem.record)}")
        return self.problem.column(self.values, name)

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Every evaluated design, (designs,) by the names of designs.csv: SI, natural signs."""
        return {
            "generation": self.generation,
            **{f"k{i + 1}": column for i, column in enumerate(self.k.T)},
            **dict(zip(self.problem.record, self.values.T, strict=True)),
            "box_violation": self.violation,
            "feasible": self.feasible,
            "reason": self.reasons,
            "on_front": np.isin(np.arange(len(self.k)), self.front),
        }

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row for each evaluated design and the columns of designs.csv.

        Units are in ``frame.attrs["units"]``.
        """
        import pandas

        columns = {name: v.astype(object) if v.dtype.kind == "U" else v for name, v in self.columns.items()}
        frame = pandas.DataFrame(columns).rename_axis("design")
        units = {name: MEASURES[name].unit for name in self.problem.record if name in MEASURES}
        frame.attrs["units"] = units | {"box_violation": "m"}
        return frame

    @property
    def failures(self) -> dict[str, int]:
        """How many designs are infeasible, by reason, the most frequent first."""
        return dict(Counter(map(str, self.reasons[self.reasons != ""])).most_common())


@dataclass(frozen=True, eq=False)
class Confirmation:
    """The best designs of a search, evaluated again at a finer accuracy."""

    designs: Ints  # (finalists,), indices into the search's designs, best first by the finer values
    values: Array  # (finalists, record), with their natural signs
    accuracy: AnyAccuracy  # of the finer walks
    agrees: bool  # whether the search's own best is still the best
    largest_change: float  # relative, of any recorded value of any finalist; NaN if none can be walked
    good: Bools  # (finalists,), whether it still walks, keeps the limits, and no other finalist dominates it


def confirm(result: SearchResult, accuracy: AnyAccuracy | str, finalists: int = 20) -> Confirmation:
    """Evaluate the best designs of a search again at another accuracy: search coarsely, confirm finely.

    Parameters
    ----------
    result : SearchResult
        Its best feasible designs by the single objective, or its front as it is shown, are the finalists.
    accuracy : Accuracy or str
        Of the finer walks.
    finalists : int
        How many at most of a single objective.
    """
    check_finalists(finalists)
    accuracy, problem = resolve(accuracy), result.problem
    chosen = result.leaders(finalists) if problem.n_obj == 1 else result.shown
    if accuracy == problem.accuracy:
        values, reasons = result.values[chosen], np.full(len(chosen), "")
    else:
        values, reasons = problem.at(accuracy).walk(result.k[chosen])
    good = problem.feasible(values, reasons, result.violation[chosen])
    if problem.n_obj > 1 and good.any():
        good[good] = nondominated(problem.minimised(values[good]))
    scores = np.full(len(chosen), np.inf)
    if good.any():
        scores[good] = problem.scores(values[good])
    order = np.argsort(scores, kind="stable")  # designs that are no longer good come last
    return Confirmation(
        designs=chosen[order],
        values=values[order],
        accuracy=accuracy,
        agrees=bool(chosen[order][0] == result.best),
        largest_change=largest_change(result.values[chosen], values),
        good=good[order],
    )


def largest_change(before: Array, after: Array, none: float = math.nan) -> float:
    """The largest relative change of values, of those that are finite; `none` where there are none."""
    change = np.abs(relative_change(after, before))
    return float(change.max(initial=0.0, where=np.isfinite(change))) if np.isfinite(change).any() else none


def check_finalists(finalists: int) -> None:
    """Raise a `SettingError` unless so many designs can be walked again by `confirm`."""
    check_whole("study.finalists", finalists, 1, 10_000)
