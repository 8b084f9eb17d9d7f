"""What solvers find, held against a space whose every design has been walked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from footopt.design.exhaustive import batches, check_size
from footopt.design.fronts import REFERENCE
from footopt.design.problem import Array, Evaluated, FootProblem, Ints, Words
from footopt.design.result import SearchResult
from footopt.errors import FootoptError

BATCH = 4096  # designs that are walked at a time
CHECKPOINTS = 10  # of a run, at which the front that it has found is measured
REACHED = 0.95  # of the exact hypervolume: counts as having found the front


def walk_all(problem: FootProblem, step: Callable[[], None] = lambda: None) -> Evaluated:
    """Walk with every design of a space, also those outside their box, for which a solver may ask.

    `step` is called after every `BATCH` designs. A space that is too large, or without a feasible design,
    raises a `FootoptError`.
    """
    check_size(problem)
    parts = []
    for k in batches(problem.space, BATCH):
        parts.append(problem.evaluate(k))
        step()
    table = Evaluated._make(np.concatenate(columns) for columns in zip(*parts, strict=True))
    if not (problem.constraints(*table) <= 0.0).all(axis=1).any():
        raise FootoptError(
            f"None of all {len(table.reasons)} designs is feasible. "
            "Try a larger foot.box_tolerance, or harder sand."
        )
    return table


class Tabulated(FootProblem):
    """A problem that looks its designs up: solvers see what they would if these were walked again.

    Parameters
    ----------
    problem : FootProblem
        Its scene, space and accuracy are taken.
    table : Evaluated
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

    def __init__(self, problem: FootProblem, table: Evaluated, objective: str | tuple[str, ...]) -> None:
        from moocore import hypervolume

        super().__init__(problem.scene, objective, problem.space, problem.accuracy, problem.threads)
        self.table = table
        self._powers = self.space.K ** np.arange(self.space.n)[::-1]
        feasible = (self.constraints(*table) <= 0.0).all(axis=1)
        self.feasible = int(feasible.sum())
        j = np.where(feasible, table.values[:, self.record.index("efficiency")], np.inf)
        self.optimum = float(j.min())
        self.best_k = 1 + int(j.argmin()) // self._powers % self.space.K
        front = _front(self.minimised(table.values)[feasible])
        self._low = front.min(axis=0)
        self._span = np.maximum(front.max(axis=0) - self._low, 1e-300)
        self.front = self.scaled(front)
        self._volume = hypervolume(self.front, ref=REFERENCE)

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """What is in the table of the designs."""
        number = (k - 1) @ self._powers
        return self.table.values[number], self.table.reasons[number]

    def scaled(self, f: Array) -> Array:
        """F (designs, objectives) in units of the exact front's extent."""
        return np.asarray((f - self._low) / self._span)

    def hypervolume(self, f: Array) -> float:
        """Share of the exact front's hypervolume that a set F (designs, objectives) covers."""
        from moocore import hypervolume

        return float(hypervolume(_front(self.scaled(f)), ref=REFERENCE) / self._volume)

    def igd_plus(self, f: Array) -> float:
        """Mean shortfall of a set F from the exact front, in units of its extent (IGD+, Ishibuchi 2015)."""
        from moocore import igd_plus

        return float(igd_plus(_front(self.scaled(f)), ref=self.front))


@dataclass(frozen=True)
class Attempt:
    """One run of a solver against the truth.

    Parameters
    ----------
    solver, seed
        Which run.
    regret : float
        By how much its best J_W falls short of the exact one, relative.
    found_at : float
        Evaluations when it came upon the optimum, or, of several objectives, upon `REACHED` of the exact
        hypervolume; NaN if it did not.
    hypervolume, igd_plus : float
        Of everything it found, see `Tabulated`; NaN for one objective.
    checkpoints : tuple
        (evaluations, share of the hypervolume) during the run; none for one objective.
    """

    solver: str
    seed: int
    regret: float
    found_at: float
    hypervolume: float = float("nan")
    igd_plus: float = float("nan")
    checkpoints: tuple[tuple[int, float], ...] = ()

    @property
    def hit(self) -> bool:
        """Whether it found the design with the best J_W."""
        return self.regret == 0.0


def judge(result: SearchResult, truth: Tabulated) -> Attempt:
    """A search of a `Tabulated` problem against what is there to be found."""
    column = result.problem.record.index("efficiency")
    regret = 1.0 - float(result.values[result.feasible, column].min()) / truth.optimum
    name, seed, history = result.solver.name, result.solver.seed, result.history
    if truth.n_obj == 1:
        found = [g.evaluations for g in history if g.best == truth.optimum]
        return Attempt(name, seed, regret, float(found[0]) if found else float("nan"))
    f = truth.minimised(result.values)
    chosen = np.unique(np.linspace(1, len(history), min(CHECKPOINTS, len(history))).round().astype(int))
    checkpoints = []
    for generation in chosen:
        so_far = f[result.feasible & (result.generation <= generation)]
        share = truth.hypervolume(so_far) if len(so_far) else 0.0
        checkpoints.append((history[generation - 1].evaluations, share))
    reached = [evaluations for evaluations, share in checkpoints if share >= REACHED]
    return Attempt(
        solver=name,
        seed=seed,
        regret=regret,
        found_at=float(reached[0]) if reached else float("nan"),
        hypervolume=checkpoints[-1][1],
        igd_plus=truth.igd_plus(f[result.feasible]),
        checkpoints=tuple(checkpoints),
    )


def _front(f: Array) -> Array:
    from moocore import filter_dominated

    front: Array = filter_dominated(f)
    return front
