"""`RobustProblem`: one foot for many scenarios, judged by the mean, the worst case or the worst tail."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, cast

import numpy as np

from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.design.scenarios import Scenario, check_measure, measured
from footopt.design.search import search
from footopt.design.solvers import EXHAUSTIVE
from footopt.errors import FootoptError, SettingError, check
from footopt.foot import Waypoints
from footopt.walk.accuracy import Accuracy
from footopt.walk.objectives import MEASURES
from footopt.walk.simulate import evaluate

FEW = 10_000  # soles of a space that are all walked for a scenario's best one: no more than a search walks


class RobustProblem(FootProblem):
    """Find one foot that is good in many scenarios at once.

    Every recorded value is a measure, over the scenarios, of that value in each: of one that is
    minimised "worst" is the largest and "tail" the mean of the largest ones, of one that is
    maximised the smallest. All designs meet the same scenarios, so that they differ by their soles
    and not by chance. A walk that fails in any scenario fails, with that scenario in its reason.

    Parameters
    ----------
    scenarios : sequence of Scenario
        From `footopt.design.scenarios`; up to `simulate.POSES` different gaits are quick.
    objective, space, accuracy, threads
        As in `FootProblem`.
    measure : str
        "mean", "tail" or "worst".
    tail : float
        The share of the scenarios that "tail" averages over.
    references : (scenarios,), optional
        The value of `ranking_objective` that a good foot has in each scenario, by whose magnitude it is
        divided there: the measure is then one of the loss relative to it (`regret`). By default each
        scenario's own best: before the first walk, one default search of each (`own_best`), 10,000 walks,
        which ``fo.search(..., progress=True)`` shows. Ones leave the values as they are: the worst J_W of
        three sands is that on soft sand, where J_W is a tenth, and the foot that is best by it a specialist.

    Raises
    ------
    SettingError
        Names are not different, or a scenario, the measure or a reference cannot be used.
    """

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        objective: str | Sequence[str] = "efficiency",
        space: Waypoints | None = None,
        accuracy: Accuracy | str = "standard",
        threads: int | None = None,
        measure: str = "worst",
        tail: float = 0.25,
        references: Sequence[float] | Array | None = None,
    ) -> None:
        check(len(scenarios) > 0, "scenarios", list(scenarios), "at least one")
        names = [scenario.name for scenario in scenarios]
        check(len(set(names)) == len(names), "scenarios", names, "of different names")
        check_measure(measure, tail)
        for scenario in scenarios:
            scenario.scene.need_heel_strike()
        super().__init__(scenarios[0].scene, objective, space, accuracy, threads)
        self.scenarios = tuple(scenarios)
        self.measure, self.tail = measure, tail
        self._references = None if references is None else _checked(references, len(names))

    @property
    def references(self) -> Array:
        """The value of `ranking_objective` that a good foot has in each scenario, (scenarios,)."""
        self.prepare()
        return cast(Array, self._references)

    def prepare(
        self,
        store: str | Path | None = None,
        executor: Executor | None = None,
        progress: bool = False,
    ) -> None:
        """Search each scenario's own best, unless the references are known."""
        if self._references is None:
            self._references = own_best(self, store, executor, progress)

    @property
    def conditions(self) -> dict[str, Any]:
        """What is walked through, and how it becomes one value."""
        return {
            "scenarios": self.scenarios,
            "measure": self.measure,
            "tail": self.tail,
            "references": self.references,
        }

    def walk_each(self, k: Ints) -> tuple[Array, Words]:
        """Values in every scenario, (scenarios, designs, record), natural signs, and why walks failed."""
        tables = [
            evaluate(k, s.scene, self.accuracy, self.record, s.space(self.space), self.threads)
            for s in self.scenarios
        ]
        return np.stack([t.values for t in tables]), np.stack([t.reasons for t in tables])

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """Measures of the values over the scenarios, (designs, record), and why a walk failed where."""
        return self._measured(*self.walk_each(k))

    def _measured(self, values: Array, reasons: Words) -> tuple[Array, Words]:
        """The same of what `walk_each` returns."""
        values[..., self.record.index(self.ranking_objective)] /= np.abs(self.references)[:, None]
        sign = np.array([MEASURES[name].sign for name in self.record])
        weights = np.array([s.weight for s in self.scenarios])
        total = sign * measured(sign * values, weights, self.measure, self.tail)
        first = [next((i for i, reason in enumerate(column) if reason), None) for column in reasons.T]
        why = [
            "" if i is None else f"{column[i]} ({self.scenarios[i].name})"
            for i, column in zip(first, reasons.T, strict=True)
        ]
        total[[i is not None for i in first]] = np.nan
        return total, np.array(why, dtype=np.str_)


def own_best(
    problem: RobustProblem,
    store: str | Path | None = None,
    executor: Executor | None = None,
    progress: bool = False,
) -> Array:
    """The ranking objective of the best foot of each scenario alone, (scenarios,), as a search finds it.

    It is the default search, or every sole of a space with no more soles than that evaluates.

    Parameters
    ----------
    problem : RobustProblem
        Its scenarios, space and accuracy are taken.
    store : str or Path, optional
        A file to keep every walk in.
    executor : Executor, optional
        Of the workers that evaluate.
    progress : bool
        Whether to show on standard error how far it is.

    Raises
    ------
    FootoptError
        There is no feasible foot for a scenario.
    KeyboardInterrupt
        It was interrupted. With the same store it goes on where it was.
    """
    few = problem.space.K**problem.space.n <= FEW
    found = []
    for s in problem.scenarios:
        alone = FootProblem(
            s.scene, problem.ranking_objective, s.space(problem.space), problem.accuracy, problem.threads
        )
        try:
            if progress:
                print(
                    f"The best foot for {s.name} alone, to which {problem.ranking_objective} is relative:",
                    file=sys.stderr,
                )
            result = search(alone, EXHAUSTIVE if few else None, progress, store, executor)
        except FootoptError as error:
            raise FootoptError(f"{s.name}: {error}") from None
        if result.interrupted:
            raise KeyboardInterrupt(f"while searching the best foot for {s.name} alone")
        found.append(result.column(problem.ranking_objective)[result.best])
    return _checked(found, len(found))


def _checked(references: Sequence[float] | Array, count: int) -> Array:
    """References as an array; raise unless values can be divided by them."""
    array = np.array(references, float)
    if array.shape != (count,) or not (np.isfinite(array) & (array != 0.0)).all():
        raise SettingError("references", array.tolist(), f"{count} finite numbers other than 0")
    return array


def regret(values: Array, references: Array, name: str) -> Array:
    """What is lost relative to reference values of an objective: 0 is as good, 0.1 a tenth worse."""
    loss: Array = MEASURES[name].sign * (values - references) / np.abs(references)
    return loss
