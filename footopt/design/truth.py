"""What solvers find, held against a space whose every design has been walked."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.design.context import context, digest
from footopt.design.exhaustive import batches, check_size
from footopt.design.fronts import REFERENCE
from footopt.design.problem import Array, Evaluated, FootProblem, Ints, Words
from footopt.design.result import SearchResult
from footopt.errors import FootoptError
from footopt.walk.simulate import REASONS

BATCH = 4096  # designs that are walked at a time
CHECKPOINTS = 10  # of a run, at which the front that it has found is measured
WITHIN = 1e-3  # of the best J_W, relative: counts as having found it; walks at `standard` err by as much
ENDINGS = tuple(REASONS.values())  # of a walk; one more than its place is what a table has of them


def walk_all(
    problem: FootProblem, step: Callable[[], None] = lambda: None, folder: Path | None = None
) -> Array:
    """Walk with every design of a space, also those outside their box, for which a solver may ask.

    Parameters
    ----------
    problem : FootProblem
        Of one scene.
    step : callable
        Called after every `BATCH` designs.
    folder : Path, optional
        Where the table is kept, of 8 bytes a number: it is read again, and what is missing is walked.

    Returns
    -------
    (designs, record + 2)
        By the designs' numbers: recorded values, the box violation in m, and 1 + the place of its reason in
        `ENDINGS`.

    Raises
    ------
    FootoptError
        The space is too large, or has no feasible design.
    """
    check_size(problem)
    space, columns = problem.space, len(problem.record) + 2
    shape = (space.K**space.n, columns)
    table = np.zeros(shape) if folder is None else _kept(problem, folder, shape)
    for number, k in enumerate(batches(space, BATCH)):
        rows = table[number * BATCH : number * BATCH + len(k)]
        if not rows[:, -1].all():
            found = problem.evaluate(k)
            rows[:, :-2], rows[:, -2] = found.values, found.violation
            rows[:, -1] = 1 + np.array([ENDINGS.index(reason) for reason in found.reasons])  # last: it counts
        step()
    if not any(_feasible(problem, table[i : i + BATCH]).any() for i in range(0, len(table), BATCH)):
        raise FootoptError(
            f"None of all {len(table)} designs is feasible. Try a larger foot.box_tolerance, or harder sand."
        )
    return table


def _kept(problem: FootProblem, folder: Path, shape: tuple[int, int]) -> Array:
    """The table in its file, of zeros where nothing is known yet."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{digest(context(problem))[:16]}.f8"
    size = shape[0] * shape[1] * 8
    if not path.exists() or path.stat().st_size != size:
        with open(path, "wb") as file:  # with holes: it takes no room before it is written
            os.truncate(file.fileno(), size)
    return np.memmap(path, np.float64, "r+", shape=shape)


def _evaluated(rows: Array) -> Evaluated:
    """Rows of a table as what they were made of."""
    return Evaluated(rows[:, :-2], np.array(ENDINGS)[rows[:, -1].astype(int) - 1], rows[:, -2])


def _feasible(problem: FootProblem, rows: Array) -> NDArray[np.bool_]:
    return np.asarray((problem.constraints(*_evaluated(rows)) <= 0.0).all(axis=1))


class Tabulated(FootProblem):
    """A problem that looks its designs up: solvers see what they would if these were walked again.

    Parameters
    ----------
    problem : FootProblem
        Its scene, space and accuracy are taken.
    table : (designs, record + 2)
        Of `walk_all`.
    objective : str or tuple of str
        As in `FootProblem`, of what is in the problem's record.

    Attributes
    ----------
    optimum, best_k : float, (n,)
        The exact best J_W and its heights.
    feasible : int
        How many designs are.
    front : (designs, objectives)
        F on the exact front, scaled by it to 0 ... 1.
    """

    def __init__(self, problem: FootProblem, table: Array, objective: str | tuple[str, ...]) -> None:
        from moocore import hypervolume

        super().__init__(problem.scene, objective, problem.space, problem.accuracy, problem.threads)
        self.table = table
        self._powers = self.space.K ** np.arange(self.space.n)[::-1]
        self.feasible, self.optimum, best = 0, np.inf, 0
        front = np.empty((0, self.n_obj))
        for begin in range(0, len(table), 16 * BATCH):  # seven waypoints are more than memory should hold
            rows = table[begin : begin + 16 * BATCH]
            good = _feasible(self, rows)
            j = np.where(good, rows[:, self.record.index("efficiency")], np.inf)
            self.feasible += int(good.sum())
            if j.min() < self.optimum:
                self.optimum, best = float(j.min()), begin + int(j.argmin())
            if good.any():
                front = _front(np.concatenate([front, self.minimised(rows[good, :-2])]))
        self.best_k = 1 + best // self._powers % self.space.K
        self._low = front.min(axis=0)
        self._span = np.maximum(front.max(axis=0) - self._low, 1e-300)
        self.front = self.scaled(front)
        self._volume = hypervolume(self.front, ref=REFERENCE)

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """What is in the table of the designs."""
        found = _evaluated(np.asarray(self.table[(k - 1) @ self._powers]))
        return found.values, found.reasons

    def scaled(self, f: Array) -> Array:
        """F (designs, objectives) in units of the exact front's extent."""
        return np.asarray((f - self._low) / self._span)

    def hypervolume(self, f: Array) -> float:
        """Share of the exact front's hypervolume that a set F (designs, objectives) covers.

        Up to `REFERENCE` times the exact front's extent in every objective: the same point for all solvers.
        """
        from moocore import hypervolume

        return float(hypervolume(_front(self.scaled(f)), ref=REFERENCE) / self._volume)


@dataclass(frozen=True)
class Attempt:
    """One run of a solver against the truth. Walks are different designs in their box: others cost nothing.

    Parameters
    ----------
    solver, seed
        Which run.
    walks : int
        That it took in all.
    regret : float
        By how much its best J_W falls short of the exact one, relative.
    within_at : float
        Walks when it first had a J_W within `WITHIN` of the exact one; NaN if it never had.
    hypervolume : float
        Of everything it found, see `Tabulated`; NaN for one objective.
    checkpoints : tuple
        (walks, share of the hypervolume) during the run; none for one objective.
    """

    solver: str
    seed: int
    walks: int
    regret: float
    within_at: float
    hypervolume: float = float("nan")
    checkpoints: tuple[tuple[int, float], ...] = ()

    @property
    def hit(self) -> bool:
        """Whether it came within `WITHIN` of the best J_W."""
        return bool(np.isfinite(self.within_at))


def judge(result: SearchResult, truth: Tabulated) -> Attempt:
    """A search of a `Tabulated` problem against what is there to be found."""
    name, seed, inside = str(result.solver.name), result.solver.seed, result.reasons != "box"
    single = judge_designs(name, seed, result.k[inside], truth)
    if truth.n_obj == 1:
        return single
    f, last = truth.minimised(result.values), len(result.history)
    checkpoints = []
    for generation in np.unique(np.linspace(1, last, min(CHECKPOINTS, last)).round().astype(int)):
        known = result.generation <= generation
        so_far = f[result.feasible & known]
        checkpoints.append((int((known & inside).sum()), truth.hypervolume(so_far) if len(so_far) else 0.0))
    return Attempt(
        solver=name,
        seed=seed,
        walks=single.walks,
        regret=single.regret,
        within_at=single.within_at,
        hypervolume=checkpoints[-1][1],
        checkpoints=tuple(checkpoints),
    )


def judge_designs(solver: str, seed: int, k: Ints, truth: Tabulated) -> Attempt:
    """Different designs (designs, n) in their box, in the order in which they were asked for, by J_W."""
    found = truth.evaluate(k)
    good = (truth.constraints(*found) <= 0.0).all(axis=1)
    best = np.minimum.accumulate(np.where(good, found.values[:, truth.record.index("efficiency")], np.inf))
    hit = best <= truth.optimum * (1.0 - WITHIN)
    within = 1.0 + float(hit.argmax()) if hit.any() else float("nan")
    return Attempt(solver, seed, len(k), 1.0 - float(best[-1]) / truth.optimum, within)


def expected_walks(attempts: Sequence[Attempt]) -> float:
    """Walks until a J_W within `WITHIN` of the best, if a run that does not find it is started again.

    The expected running time of Hansen, Auger, Ros, Mersmann, Tusar & Brockhoff, "COCO" (2021): all walks
    up to a success or the end, over the successes; infinite without one.
    """
    hits = sum(a.hit for a in attempts)
    spent = sum(a.within_at if a.hit else a.walks for a in attempts)
    return spent / hits if hits else float("inf")


def _front(f: Array) -> Array:
    from moocore import filter_dominated

    front: Array = filter_dominated(f)
    return front
