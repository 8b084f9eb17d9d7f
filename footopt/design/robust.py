"""`RobustProblem`: one foot for many scenarios, judged by the mean, the worst case or the worst tail."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.errors import SettingError, check
from footopt.foot import Waypoints
from footopt.walk.accuracy import Accuracy
from footopt.walk.objectives import MEASURES
from footopt.walk.scenarios import Scenario, check_measure, measured
from footopt.walk.simulate import evaluate


class RobustProblem(FootProblem):
    """Find one foot that is good in many scenarios at once.

    Every recorded value is a measure, over the scenarios, of that value in each: of one that is
    minimised "worst" is the largest and "tail" the mean of the largest ones, of one that is
    maximised the smallest. All designs meet the same scenarios, so that they differ by their soles
    and not by chance. A walk that fails in any scenario fails, with that scenario in its reason.

    Parameters
    ----------
    scenarios : sequence of Scenario
        From `footopt.walk.scenarios`; up to `simulate.POSES` different gaits are quick.
    objective, space, accuracy, threads
        As in `FootProblem`.
    measure : str
        "mean", "tail" or "worst".
    tail : float
        The share of the scenarios that "tail" averages over.
    references : (scenarios,), optional
        The value of `guide` that a good foot has in each scenario, by whose magnitude it is divided
        there. Without, hard sand has more say in J_W than soft sand, where J_W is a tenth. A loss
        relative to the reference (`regret`) is then the measure of the scenarios'.

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
        self.references = None if references is None else np.array(references, float)
        if self.references is not None and (
            self.references.shape != (len(names),)
            or not (np.isfinite(self.references) & (self.references != 0.0)).all()
        ):
            raise SettingError(
                "references", self.references.tolist(), f"{len(names)} finite numbers other than 0"
            )

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
        values, reasons = self.walk_each(k)
        if self.references is not None:
            values[..., self.record.index(self.guide)] /= np.abs(self.references)[:, None]
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


def regret(values: Array, references: Array, name: str) -> Array:
    """What is lost relative to reference values of an objective: 0 is as good, 0.1 a tenth worse."""
    loss: Array = MEASURES[name].sign * (values - references) / np.abs(references)
    return loss
