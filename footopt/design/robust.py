"""`RobustProblem`: one foot for many scenarios, judged by the mean, the worst case or the worst tail."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.design.scenarios import Scenario, check_measure, risk
from footopt.design.search import search
from footopt.design.solvers import EXHAUSTIVE
from footopt.errors import FootoptError, check
from footopt.foot import Waypoints
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.objectives import MEASURES
from footopt.walk.simulate import evaluate

FEW = 10_000  # soles of a space that are all evaluated for a scenario's best one, as many as by a search


class RobustProblem(FootProblem):
    """Find one foot that is good in many scenarios at once.

    Every recorded value is a risk measure over the scenarios: of a value that is minimised "worst" is the
    largest and "tail" the mean of the largest ones, of one that is maximised of the smallest. All designs are
    evaluated in the same scenarios, so that they differ by their soles and not by chance. A walk that fails
    in any scenario fails, with that scenario in its reason.

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
        scenario's own best, for which `own_best` searches at once, 10,000 evaluations a scenario. Ones leave
        the values as they are: the worst J_W of three sands is that on soft sand, where J_W is a tenth, and
        the foot that is best by it a specialist.
    limits : dict of str to float, optional
        As in `FootProblem`, of the measures over the scenarios.

    Raises
    ------
    SettingError
        Names are not different, or a scenario, the measure or a reference cannot be used.
    FootoptError
        There is no feasible foot for a scenario.
    """

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        objective: str | Sequence[str] = "efficiency",
        space: Waypoints | None = None,
        accuracy: AnyAccuracy | str = "standard",
        threads: int | None = None,
        measure: str = "worst",
        tail: float = 0.25,
        references: Sequence[float] | Array | None = None,
        limits: Mapping[str, float] | None = None,
    ) -> None:
        check(len(scenarios) > 0, "scenarios", list(scenarios), "at least one")
        names = [scenario.name for scenario in scenarios]
        check(len(set(names)) == len(names), "scenarios", names, "of different names")
        check_measure(measure, tail)
        for scenario in scenarios:
            scenario.scene.need_heel_strike()
        super().__init__(scenarios[0].scene, objective, space, accuracy, threads, limits)
        self.scenarios = tuple(scenarios)
        self.measure, self.tail = measure, tail
        if references is None:
            references = own_best(scenarios, self.ranking_objective, self.space, accuracy, threads)
        self.references = np.array(references, float)
        usable = np.isfinite(self.references) & (self.references != 0.0)
        good = usable.shape == (len(names),) and usable.all()
        check(good, "references", self.references.tolist(), f"{len(names)} numbers other than 0")

    @property
    def conditions(self) -> dict[str, Any]:
        """The scenarios, and how values in them become one: a store keeps it with the designs."""
        return {
            "scenarios": self.scenarios,
            "measure": self.measure,
            "tail": self.tail,
            "references": self.references,
        }

    def walk_each(self, k: Ints) -> tuple[Array, Words]:
        """Values in every scenario, (scenarios, designs, record), and the reasons of failed walks."""
        tables = [
            evaluate(k, s.scene, self.accuracy, self.record, s.space(self.space), self.threads)
            for s in self.scenarios
        ]
        return np.stack([t.values for t in tables]), np.stack([t.reasons for t in tables])

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """Measures of the values over the scenarios, (designs, record), and the reasons of failed walks."""
        values, reasons = self.walk_each(k)
        values[..., self.record.index(self.ranking_objective)] /= np.abs(self.references)[:, None]
        sign = np.array([MEASURES[name].sign for name in self.record])
        total = sign * risk(sign * values, self.measure, self.tail)
        failed = reasons != ""
        total[failed.any(axis=0)] = np.nan
        first = zip(failed.argmax(axis=0), reasons.T, strict=True)  # the first scenario in which it fails
        why = [f"{column[i]} ({self.scenarios[i].name})" if column[i] else "" for i, column in first]
        return total, np.array(why, dtype=np.str_)


def own_best(
    scenarios: Sequence[Scenario],
    objective: str = "efficiency",
    space: Waypoints | None = None,
    accuracy: AnyAccuracy | str = "standard",
    threads: int | None = None,
    **options: Any,
) -> Array:
    """An objective of the best foot of each scenario alone, (scenarios,).

    The default search finds it, or an exhaustive one in a space that is small enough.

    Parameters
    ----------
    scenarios, objective, space, accuracy, threads
        As in `RobustProblem`.
    **options
        store, executor and progress, as in `search`.

    Raises
    ------
    FootoptError
        There is no feasible foot for a scenario.
    KeyboardInterrupt
        It was interrupted.
    """
    space, found = space or Waypoints(), []
    solver = EXHAUSTIVE if space.K**space.n <= FEW else None
    for s in scenarios:
        try:
            alone = FootProblem(s.scene, objective, s.space(space), accuracy, threads)
            result = search(alone, solver, **options)
        except FootoptError as error:
            raise FootoptError(f"{s.name}: {error}") from None
        if result.interrupted:
            raise KeyboardInterrupt(f"while searching the best foot for {s.name} alone")
        found.append(result.column(objective)[result.best])
    return np.array(found)


def regret(values: Array, references: Array, name: str) -> Array:
    """The relative loss against reference values of an objective: 0 is as good, 0.1 a tenth worse."""
    loss: Array = MEASURES[name].sign * (values - references) / np.abs(references)
    return loss
