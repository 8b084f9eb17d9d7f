"""The search: an ask/tell loop around any solver that keeps every design it has evaluated."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable
from contextlib import nullcontext
from copy import copy
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.problem import Problem
from pymoo.problems.static import StaticProblem

from footopt.design.problem import FootProblem
from footopt.design.solvers import EXHAUSTIVE, Solver
from footopt.design.source import Source
from footopt.design.store import Store
from footopt.design.workers import Engine
from footopt.errors import FootoptError, check, check_kind, needed
from footopt.foot import Foot
from footopt.walk.accuracy import Accuracy
from footopt.walk.objectives import OBJECTIVES
from footopt.walk.simulate import resolve

Array = NDArray[np.float64]

BUDGET = ("pop_size", "n_gen", "seed")  # of a solver that is named


@dataclass(frozen=True)
class Generation:
    """One generation as the search's history keeps it.

    best : smallest value of the single objective so far, or of J_W when there are several.
    median : of that value over the generation's feasible designs. front : designs on the front of
    all evaluated so far (1 for a single objective). Values are NaN before a design is feasible.
    """

    generation: int
    evaluations: int
    best: float
    median: float
    front: int
    seconds: float


@dataclass(frozen=True, eq=False, repr=False)
class SearchResult:
    """Every design that a search evaluated, in order, and which are best.

    Parameters
    ----------
    k : (designs, n), heights; no design twice. values : (designs, record), natural signs, NaN for a
        failed walk; columns are ``problem.record``.
    feasible : (designs,), walked and inside the box. reasons : why a walk failed ("error": it broke
        the program), or "box", or "".
    violation : (designs,), of the box, m. generation : (designs,), in which it came up.
    best : index of the best design: of the objective, or by J_W on the front.
    front : indices of the non-dominated feasible designs, best first by J_W.
    evaluations : asked for by the solver; a design that comes up again is not walked again.
    interrupted : whether it was stopped by the user before its last generation; then all this is of
        the generations that were finished.
    reused : designs that were read from the store, not walked.
    """

    problem: FootProblem
    solver: Solver
    k: NDArray[np.int64]
    values: Array
    feasible: NDArray[np.bool_]
    reasons: NDArray[np.str_]
    violation: Array
    generation: NDArray[np.int64]
    history: list[Generation]
    best: int
    front: NDArray[np.int64]
    evaluations: int
    seconds: float
    interrupted: bool
    reused: int = 0

    def __repr__(self) -> str:
        best = zip(self.problem.record, self.values[self.best], strict=True)
        values = "; ".join(f"{name} {value:.4g}" for name, value in best)
        title = f"<SearchResult of {self.solver.name} on {self.problem.scene.sand.name} sand"
        return f"{title}: {self.designs} designs; best {self.foot.name}: {values}>"

    @property
    def designs(self) -> int:
        """How many different designs came up."""
        return len(self.k)

    @property
    def infeasible(self) -> int:
        """How many of them failed or leave their box."""
        return len(self.k) - int(self.feasible.sum())

    @property
    def foot(self) -> Foot:
        """The best design."""
        return Foot.from_waypoints(self.k[self.best], self.problem.space)

    def column(self, name: str) -> Array:
        """A recorded value of every design, (designs,), natural sign."""
        return np.asarray(self.values[:, self.problem.record.index(name)])

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

        Units are in ``frame.attrs["units"]``. Needs pandas: ``pip install "footopt[pandas]"``.
        """
        pandas = needed("pandas", "SearchResult.to_frame", "pandas")
        columns = {name: v.astype(object) if v.dtype.kind == "U" else v for name, v in self.columns.items()}
        frame = pandas.DataFrame(columns).rename_axis("design")
        units = {name: OBJECTIVES[name].unit for name in self.problem.record if name in OBJECTIVES}
        frame.attrs["units"] = units | {"box_violation": "m"}
        return frame

    @property
    def failures(self) -> dict[str, int]:
        """How many designs are infeasible, by reason, the most frequent first."""
        return dict(Counter(map(str, self.reasons[self.reasons != ""])).most_common())


def search(
    problem: FootProblem,
    solver: Solver | str | None = None,
    progress: Callable[[Generation], None] | None = None,
    store: Store | str | Path | None = None,
    engine: Engine | None = None,
    **budget: int,
) -> SearchResult:
    """Search a design space.

    Parameters
    ----------
    problem : what is searched.
    solver : a `Solver`, or a name; the budget (pop_size, n_gen, seed) as keywords. By default
        the memetic GA for one objective and NSGA-II for several.
    progress : called after every generation.
    store : a file to keep every evaluation in, or an open `Store`. The same search with the same
        store goes on where it was stopped: nothing is walked twice, and the result is the same, to
        the last bit, as that of a search never stopped.
    engine : where to walk, by default in this process; the result is the same, to the last bit.

    Returns
    -------
    SearchResult : also when the user interrupts it (Ctrl-C), of what was found so far.

    Raises
    ------
    SettingError : the solver does not fit the number of objectives.
    FootoptError : no feasible design was found, or it was interrupted before the first one, or
        every design of the first generation breaks the program.
    FileError : the store cannot be used. ValueError : it was opened for another problem.
    """
    check_kind(problem, FootProblem, "problem", "Try fo.FootProblem(scene)")
    for name, value in budget.items():
        check(name in BUDGET, name, value, f"one of {', '.join(BUDGET)}, as a keyword")
    if not isinstance(solver, Solver):
        default = "memetic" if problem.n_obj == 1 else "nsga2"
        solver = Solver(name=solver or default, **budget)
    elif budget:
        solver = Solver(**(asdict(solver) | budget))
    opened = Store(store, problem) if isinstance(store, (str, Path)) else nullcontext(store)
    if solver.name == EXHAUSTIVE:
        from footopt.design.exhaustive import enumerate_space

        with opened as kept:
            return enumerate_space(problem, solver, progress, Source(problem, kept, engine))
    algorithm = solver.build(problem.n_obj)
    algorithm.setup(problem, termination=("n_gen", solver.n_gen), seed=solver.seed, verbose=False)
    # pymoo copies what it is given, with all that belongs to it, in every generation
    shape = Problem(problem.n_var, problem.n_obj, problem.n_ieq_constr, xl=problem.xl, xu=problem.xu)
    started = time.perf_counter()
    interrupted = False
    with opened as kept:
        archive = Archive(problem, kept, engine)
        try:
            while algorithm.has_next():
                infills = algorithm.ask()
                if infills is None:  # nothing is left that was not tried
                    break
                f, g = archive.evaluate(np.round(infills.get("X").astype(float)).astype(np.int64))
                algorithm.evaluator.eval(StaticProblem(shape, F=f, G=g), infills)
                algorithm.tell(infills=infills)
                archive.close_generation(time.perf_counter() - started)
                if progress is not None:
                    progress(archive.history[-1])
        except KeyboardInterrupt:
            interrupted = True
    return archive.result(solver, time.perf_counter() - started, interrupted)


@dataclass(frozen=True, eq=False)
class Confirmation:
    """The best designs of a search, walked again more finely.

    designs : (finalists,), indices into the search's designs, best first by the finer values.
    values : (finalists, record), natural signs. accuracy : of the finer walks.
    agrees : whether the search's own best is still the best.
    largest_change : relative, of any recorded value of any finalist; NaN if none can be walked.
    """

    designs: NDArray[np.int64]
    values: Array
    accuracy: Accuracy
    agrees: bool
    largest_change: float


def confirm(result: SearchResult, accuracy: Accuracy | str, finalists: int = 20) -> Confirmation:
    """Search cheap, confirm fine: walk the best designs of a search again at another accuracy.

    The finalists are the best feasible designs by the single objective, or by J_W on the front.
    """
    check_finalists(finalists)
    accuracy, problem = resolve(accuracy), result.problem
    column = problem.record.index(problem.guide)
    sign = -1.0 if OBJECTIVES[problem.guide].maximise else 1.0
    pool = np.flatnonzero(result.feasible) if problem.n_obj == 1 else result.front
    chosen = pool[np.argsort(sign * result.values[pool, column], kind="stable")[:finalists]]
    finer = copy(problem)
    finer.accuracy = accuracy
    values, _ = finer.walk(result.k[chosen])
    order = np.argsort(sign * values[:, column], kind="stable")  # a walk that fails here comes last
    with np.errstate(invalid="ignore"):
        change = np.abs(values / result.values[chosen] - 1.0)
    change = change[np.isfinite(change)]
    return Confirmation(
        designs=chosen[order],
        values=values[order],
        accuracy=accuracy,
        agrees=bool(chosen[order][0] == result.best),
        largest_change=float(change.max()) if len(change) else math.nan,
    )


def check_finalists(finalists: int) -> None:
    """Raise unless so many designs can be walked again: `confirm`, before the search that it follows."""
    check(1 <= finalists <= 10_000, "study.finalists", finalists, "a whole number >= 1 and <= 10,000")


@dataclass(frozen=True)
class Design:
    """One evaluated design, as the archive keeps it; see `SearchResult` for the fields."""

    k: NDArray[np.int64]
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


@dataclass(frozen=True)
class Milestone:
    """How far a search is at the end of a generation: what an interrupted one reports."""

    generations: int
    designs: int
    evaluations: int
    front: NDArray[np.int64]


class Archive:
    """Every distinct design of a run, each walked once, and the history of its generations.

    With a store, a design that is in it is not walked at all.
    """

    def __init__(
        self, problem: FootProblem, store: Store | None = None, engine: Engine | None = None
    ) -> None:
        self.problem, self.source = problem, Source(problem, store, engine)
        self.history: list[Generation] = []
        self.designs: list[Design] = []
        self._place: dict[bytes, int] = {}  # of a design in `designs`, by its heights
        self._front = np.empty(0, np.int64)
        self._evaluations = 0
        self._latest: list[int] = []
        self._guide = problem.guide
        self._sign = -1.0 if OBJECTIVES[self._guide].maximise else 1.0
        self._closed = Milestone(0, 0, 0, self._front)

    def evaluate(self, k: NDArray[np.int64]) -> tuple[Array, Array]:
        """F and G of a generation, (designs, ...); designs seen before are not walked again."""
        keys = [heights.tobytes() for heights in k]
        new = list({key: i for i, key in enumerate(keys) if key not in self._place}.values())
        if new:
            values, reasons = self.source(k[new])
            out = self.problem.judge(k[new], values, reasons)
            for row, i in enumerate(new):
                g = np.asarray(out["G"][row], float)
                reason = str(reasons[row]) or ("" if (g <= 0.0).all() else "box")
                self._place[keys[i]] = len(self.designs)
                self.designs.append(
                    Design(
                        k=k[i],
                        values=values[row],
                        f=np.asarray(out["F"][row], float),
                        g=g,
                        reason=reason,
                        violation=float(out["violation"][row]),
                        generation=len(self.history) + 1,
                    )
                )
            self._extend_front(len(new))
        self._evaluations += len(k)
        self._latest = [self._place[key] for key in keys]
        chosen = [self.designs[i] for i in self._latest]
        return np.array([d.f for d in chosen]), np.array([d.g for d in chosen])

    def close_generation(self, seconds: float) -> None:
        """Write the generation into the history."""
        column = self.problem.record.index(self._guide)
        now = [self.designs[i].values[column] for i in self._latest if self.designs[i].feasible]
        so_far = [self.designs[i].values[column] for i in self._front]
        nan = float("nan")
        self.history.append(
            Generation(
                generation=len(self.history) + 1,
                evaluations=self._evaluations,
                best=float(self._sign * np.min(self._sign * np.array(so_far))) if so_far else nan,
                median=float(np.median(now)) if now else nan,
                front=len(self._front),
                seconds=seconds,
            )
        )
        self._closed = Milestone(len(self.history), len(self.designs), self._evaluations, self._front)

    def result(self, solver: Solver, seconds: float, interrupted: bool) -> SearchResult:
        """Everything that was evaluated up to the last finished generation, and the best of it."""
        closed = self._closed
        designs = self.designs[: closed.designs]
        if not designs:
            raise FootoptError("The search was stopped before its first generation was evaluated.")
        if not len(closed.front):
            causes = Counter(d.reason for d in designs)
            raise FootoptError(
                f"No feasible design among {len(designs)}: "
                + ", ".join(f"{n} {cause}" for cause, n in sorted(causes.items()))
                + ". Try more generations, a larger foot.box_tolerance, or harder sand."
            )
        column = self.problem.record.index(self._guide)
        rank = [self._sign * designs[i].values[column] for i in closed.front]
        front = closed.front[np.argsort(rank, kind="stable")]
        return SearchResult(
            problem=self.problem,
            solver=solver,
            k=np.array([d.k for d in designs]),
            values=np.array([d.values for d in designs]),
            feasible=np.array([d.feasible for d in designs]),
            reasons=np.array([d.reason for d in designs]),
            violation=np.array([d.violation for d in designs]),
            generation=np.array([d.generation for d in designs]),
            history=self.history[: closed.generations],
            best=int(front[0]),
            front=front[:1] if self.problem.n_obj == 1 else front,
            evaluations=closed.evaluations,
            seconds=seconds,
            interrupted=interrupted,
            reused=self.source.reused,
        )

    def _extend_front(self, new: int) -> None:
        """Let the newest designs join the front of all feasible ones."""
        from moocore import is_nondominated

        total = len(self.designs)
        fresh = [i for i in range(total - new, total) if self.designs[i].feasible]
        pool = np.concatenate([self._front, np.array(fresh, np.int64)])
        if len(pool):
            f = np.array([self.designs[i].f for i in pool])
            self._front = pool[is_nondominated(f, keep_weakly=True)]
