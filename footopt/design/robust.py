"""`RobustProblem`: one foot for many scenarios, judged by the mean, the worst case or the worst tail."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from footopt.arrays import Array, Ints, Words
from footopt.design.archive import Evaluator
from footopt.design.problem import FootProblem
from footopt.design.scenarios import Scenario
from footopt.design.search import search
from footopt.errors import TINY, FootoptError, check, check_kind, check_number
from footopt.foot import Waypoints
from footopt.walk import MEASURES, evaluate
from footopt.walk.accuracy import AnyAccuracy

#: How values over scenarios become one; "tail" is the mean over the worst share of them (CVaR).
RISK_MEASURES = ("mean", "tail", "worst")
KEPT = 10  # best worst cases: a design that loses more than all of them in one scenario is dropped


class RobustProblem(FootProblem):
    """Find one foot that is good in many scenarios at once.

    Every recorded value is a risk measure over the scenarios: of a value that is minimised "worst" is the
    largest and "tail" the mean of the largest ones, of one that is maximised of the smallest. All designs are
    evaluated in the same scenarios, so that they differ by their soles and not by chance. A walk that fails
    in any scenario fails, with that scenario in its reason.

    Parameters
    ----------
    scenarios : sequence of Scenario
        From `footopt.design.scenarios`; up to `footopt.walk.discretize.POSES` different gaits are quick.
    objective, space, accuracy, threads
        As in `FootProblem`.
    measure : str
        "mean", "tail" or "worst".
    tail : float
        The share of the scenarios that "tail" averages over.
    references : (scenarios,), optional
        The value of `ranking_objective` that a good foot has in each scenario, by whose magnitude it is
        divided there: the measure is then one of the loss relative to it (`regret`). By default, the best
        foot of each scenario is searched at once, by 10,000 evaluations a scenario. Ones leave the values as
        they are: the worst J_W of three sands is then always that on soft sand, a tenth of the others, and
        the foot that is best by it is a specialist for that sand.
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
        for scenario in scenarios:
            check_kind("scenarios", scenario, Scenario, "Try fo.Scenario(name, scene)")
            scenario.scene.check_comparable()
        names = [scenario.name for scenario in scenarios]
        check(len(set(names)) == len(names), "scenarios", names, "of different names")
        check_measure(measure, tail)
        super().__init__(scenarios[0].scene, objective, space, accuracy, threads, limits)
        self.scenarios = tuple(scenarios)
        self.signs = np.array([MEASURES[name].sign for name in self.record])  # of values, when minimised
        self.measure, self.tail = measure, tail
        #: (feet, n), heights: the best of these is the reference in each scenario, at any accuracy
        self.specialists: Ints | None = None
        self.references = np.array(self._own_bests() if references is None else references, float)
        usable = np.isfinite(self.references) & (self.references != 0.0)
        good = usable.shape == (len(names),) and usable.all()
        check(good, "references", self.references.tolist(), f"{len(names)} numbers other than 0")
        limit, divided = self.limits.get(self.ranking_objective), (self.references != 1.0).any()
        allowed = "left out: its values are divided by references"
        check(limit is None or not divided, f"constraint.{self.ranking_objective}", limit, allowed)

    def _own_bests(self) -> list[float]:
        """`ranking_objective` of the best foot of each scenario alone."""
        found, k = [], []
        for s in self.scenarios:
            space = s.space(self.space)
            alone = FootProblem(s.scene, self.ranking_objective, space, self.accuracy, self.threads)
            try:
                result = search(alone).uninterrupted(f"searching the best foot for {s.name} alone")
            except FootoptError as error:
                raise FootoptError(f"{s.name}: {error}") from None
            found.append(float(result.column(self.ranking_objective)[result.best]))
            k.append(result.k[result.best])
        self.specialists = np.array(k)
        return found

    def at(self, accuracy: AnyAccuracy) -> Self:
        """The same problem at another accuracy, with the specialists' values at that one as references."""
        other = super().at(accuracy)
        if self.specialists is not None:
            other.references = other.bests(other.walk_each(self.specialists)[0])
        return other

    def bests(self, values: Array) -> Array:
        """The ranking objective of the best of some feet in each scenario: (scenarios,)."""
        sign = MEASURES[self.ranking_objective].sign
        return sign * np.nanmin(sign * self.column(values, self.ranking_objective), axis=1)

    @property
    def conditions(self) -> dict[str, Any]:
        """The scenarios, and how values in them become one: a store keeps it with the designs."""
        names = ("scenarios", "measure", "tail", "references", "ranking_objective")
        return {name: getattr(self, name) for name in names}

    def walk_each(self, k: Ints) -> tuple[Array, Words]:
        """Values in every scenario, (scenarios, designs, record), and the reasons of failed walks."""
        tables = [
            evaluate(k, s.scene, self.accuracy, self.record, s.space(self.space), self.threads)
            for s in self.scenarios
        ]
        return np.stack([t.values for t in tables]), np.stack([t.reasons for t in tables])

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """Measures of the values over the scenarios, (designs, record), and the reasons of failed walks."""
        return self._measured(*self.walk_each(k))

    def _measured(self, values: Array, reasons: Words) -> tuple[Array, Words]:
        """Measures, and in the first of the scenarios (scenarios, designs, ...) that a design fails in, why.

        The ranking objective is divided by the references in place.
        """
        values[..., self.record.index(self.ranking_objective)] /= np.abs(self.references)[:, None]
        total, failed = self.signs * risk(self.signs * values, self.measure, self.tail), reasons != ""
        total[failed.any(axis=0)] = np.nan
        first = zip(failed.argmax(axis=0), reasons.T, strict=True)
        why = [f"{column[i]} ({self.scenarios[i].name})" if column[i] else "" for i, column in first]
        return total, np.array(why, dtype=np.str_)


class Race(RobustProblem):
    """The worst case of each design, evaluated only until it is worse than those of `KEPT` others.

    The scenario that has been the worst one most often comes first. A design that loses more in a scenario
    than each of the `KEPT` best designs in its worst one is evaluated in no further scenario: its values are
    those of the scenarios so far. The `evaluators` are those of each scenario alone; a limit of theirs on the
    ranking objective is left out.
    """

    def __init__(
        self, scenarios: Sequence[Scenario], references: Sequence[float], evaluators: Sequence[Evaluator]
    ) -> None:
        one = evaluators[0].problem
        limits = {name: limit for name, limit in one.limits.items() if name != one.ranking_objective}
        alike: Any = {"accuracy": one.accuracy, "threads": one.threads, "limits": limits}
        super().__init__(scenarios, one.names, one.space, **alike, references=references)
        self.evaluators = evaluators
        self._times_worst = np.zeros(len(evaluators))
        self._best = np.full(KEPT, np.inf)  # worst cases of the best designs so far, minimised

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """As in `RobustProblem`, over the scenarios that each design is evaluated in."""
        left, ranking = np.arange(len(k)), self.record.index(self.ranking_objective)
        values = np.full((len(self.scenarios), len(k), len(self.record)), np.nan)
        reasons = np.full(values.shape[:2], "", dtype=object)
        for i in np.argsort(-self._times_worst, kind="stable"):
            if len(left):
                values[i, left], reasons[i, left] = self.evaluators[i](k[left])
                lost = self.signs[ranking] * values[i, left, ranking] / abs(self.references[i])
                left = left[lost <= self._best[-1]]  # designs that failed have NaN, and drop out
        total, why = self._measured(values, reasons)
        losses = self.signs[ranking] * values[..., ranking]
        known = ~np.isnan(losses).any(axis=0)
        kept = known & self.feasible(total, why, np.zeros(len(k)))
        self._best = np.sort(np.append(self._best, losses[:, kept].max(axis=0)))[:KEPT]
        walked = ~np.isnan(losses).all(axis=0)
        np.add.at(self._times_worst, np.nanargmax(losses[:, walked], axis=0), 1)
        return total, why


def risk(values: Array, measure: str, tail: float) -> Array:
    """One of `RISK_MEASURES`, (...), of values (scenarios, ...) that are minimised, each as probable.

    "tail" averages over that share of the scenarios, the worst ones: the conditional value at risk
    (Rockafellar & Uryasev 2000), with a part of a scenario where the tail ends inside it. "worst" leaves out
    NaN.
    """
    share = {"mean": 1.0, "tail": tail, "worst": 0.0}[measure]
    scenarios = max(share * len(values), 1.0)
    parts = np.clip(scenarios - np.arange(math.ceil(scenarios)), 0.0, 1.0)
    worst_first = -np.sort(-values, axis=0)
    # numpy's sum over an axis may round differently from batch to batch
    return np.asarray(sum(part * value for part, value in zip(parts, worst_first, strict=False)) / scenarios)


def check_measure(measure: str, tail: float) -> None:
    """Raise unless a measure is one of `RISK_MEASURES` and its tail a share."""
    check(measure in RISK_MEASURES, "study.measure", measure, f"one of {', '.join(RISK_MEASURES)}")
    check_number("study.tail", tail, TINY, 1, "a share > 0 and <= 1 of the scenarios")


def regret(values: Array, references: Array, name: str) -> Array:
    """The relative loss against reference values of an objective: 0 is as good, 0.1 a tenth worse."""
    lost = MEASURES[name].sign * (values - references)
    with np.errstate(divide="ignore", invalid="ignore"):  # a hollow of 0 is beyond any share
        return np.where(lost == 0.0, 0.0, lost / np.abs(references))
