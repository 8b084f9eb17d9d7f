"""What many runs have in common and what not: settings in columns, seeds summarised, fronts compared."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.design.fronts import hypervolume_shares, median_attainment
from footopt.files.identity import flat
from footopt.report.runs import Run

Array = NDArray[np.float64]

SEED = "solver.seed"
#: Settings that do not change which problem is searched.
HOW = ("solver.", "engine.", "study.", "choose.", "report", "plugins", "accuracy.")


def varied(runs: Sequence[Run]) -> dict[str, list[str]]:
    """The settings that differ, each with its values as text, (runs,); "" where they are not known."""
    tables = [{name: _text(value) for name, value in flat(run.settings).items()} for run in runs]
    known = [table for table in tables if table]
    names = list(dict.fromkeys(name for table in known for name in table))
    differ = [name for name in names if len({table.get(name, "") for table in known}) > 1]
    return {name: [table.get(name, "") for table in tables] for name in differ}


def _text(value: Any) -> str:
    return "" if value is None else f"{value:.12g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True, eq=False)
class Fronts:
    """Fronts of one problem that several solvers or seeds have found.

    Parameters
    ----------
    names : tuple of str
        Of the objectives.
    maximise : tuple of bool
        Their senses.
    places : list of int
        Which of the runs they are of.
    labels : list of str
        What each run is called without its seed: runs of one label differ by their seeds.
    values : list of arrays, (designs, objectives)
        Natural signs.
    shares : list of float
        Hypervolume of each, over that of all of them merged.
    """

    names: tuple[str, ...]
    maximise: tuple[bool, ...]
    places: list[int]
    labels: list[str]
    values: list[Array]
    shares: list[float]

    @property
    def sign(self) -> Array:
        """What turns values into what is minimised, (objectives,)."""
        return np.where(self.maximise, -1.0, 1.0)

    def median_attainment(self, label: str) -> Array:
        """What half of the runs of a label attain, (points, 2), natural signs; of two objectives only."""
        chosen = [v for v, name in zip(self.values, self.labels, strict=True) if name == label]
        points = median_attainment([v * self.sign for v in chosen]) * self.sign
        return np.asarray(points[np.argsort(points[:, 0])])


def fronts(runs: Sequence[Run]) -> list[Fronts]:
    """The fronts of all runs that found one, those of each problem together."""
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, run in enumerate(runs):
        names = tuple((run.result or {}).get("objective_names", ()))
        if len(names) > 1 and (run.result or {}).get("front_values"):
            problem = {n: _text(v) for n, v in flat(run.settings).items() if not n.startswith(HOW)}
            groups.setdefault((names, tuple(problem.items())), []).append(i)
    own = {name: values for name, values in varied(runs).items() if name != SEED}
    labels = [" ".join(filter(None, (values[i] for values in own.values()))) for i in range(len(runs))]
    return [_together(runs, names, places, labels) for (names, _), places in groups.items()]


def _together(runs: Sequence[Run], names: tuple[str, ...], places: list[int], labels: list[str]) -> Fronts:
    results: list[Mapping[str, Any]] = [runs[i].result or {} for i in places]
    maximise = tuple(bool(results[0]["maximise"][name]) for name in names)
    sign = np.where(maximise, -1.0, 1.0)
    values = [
        np.array(r["front_values"], float)[:, [r["front_columns"].index(name) for name in names]]
        for r in results
    ]
    shares = hypervolume_shares([v * sign for v in values])
    return Fronts(names, maximise, places, [labels[i] or runs[i].name for i in places], values, shares)


@dataclass(frozen=True)
class Spread:
    """A value of the runs that differ by their seeds: median and quartiles."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Of those that are numbers."""
        good = [v for v in values if math.isfinite(v)]
        if not good:
            return cls(math.nan, math.nan, math.nan)
        low, median, high = np.percentile(good, [25, 50, 75]).tolist()
        return cls(median, low, high)


def over_seeds(
    runs: Sequence[Run], columns: Mapping[str, Sequence[float]]
) -> list[tuple[dict[str, str], int, dict[str, Spread]]]:
    """Runs that differ by their seeds only, summarised; none if no two of them do.

    Parameters
    ----------
    runs : sequence of Run
        All runs.
    columns : mapping of str to (runs,)
        Values by name.

    Returns
    -------
    list of (settings, runs, values)
        Of each group: the settings that it does not share with the others, how many runs it has, and the
        spread of each value.
    """
    own = varied(runs)
    if SEED not in own:
        return []
    own.pop(SEED)
    groups: dict[tuple[str, ...], list[int]] = {}
    for i in range(len(runs)):
        groups.setdefault(tuple(values[i] for values in own.values()), []).append(i)
    if max(map(len, groups.values())) < 2:
        return []
    return [
        (
            dict(zip(own, key, strict=True)),
            len(places),
            {name: Spread.of([values[i] for i in places]) for name, values in columns.items()},
        )
        for key, places in groups.items()
    ]
