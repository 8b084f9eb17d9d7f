"""Fronts of several solvers and seeds over each other, with the hypervolume of each and what half attain."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from footopt.design.fronts import median_attainment
from footopt.report.figures.search import scatter_matrix
from footopt.report.numbers import percent
from footopt.report.style import marker, styled

Array = NDArray[np.float64]


class Fronts(NamedTuple):
    """Fronts of one problem that several solvers or seeds have found."""

    names: tuple[str, ...]  # of the objectives
    maximise: tuple[bool, ...]
    places: list[int]  # which of the runs they are of
    labels: list[str]  # what each run is called without its seed
    values: list[Array]  # (designs, objectives) each, natural signs
    shares: list[float]  # hypervolume of each, over that of all of them merged

    def median_attainment(self, label: str) -> Array:
        """What half of the runs of a label attain, (points, 2), natural signs; of two objectives only."""
        sign = np.where(self.maximise, -1.0, 1.0)
        chosen = [v for v, name in zip(self.values, self.labels, strict=True) if name == label]
        points = median_attainment([v * sign for v in chosen]) * sign
        return np.asarray(points[np.argsort(points[:, 0])])


@styled
def fronts(found: Fronts) -> Figure:
    """Every pair of objectives of several fronts; a colour for all runs that differ by their seeds only.

    The legend has the median of each colour's hypervolume, in that of all fronts merged. Of two objectives a
    line shows what half of the runs of a colour attain.
    """
    groups, labels = {}, list(dict.fromkeys(found.labels))
    for label in labels:
        own = [i for i, name in enumerate(found.labels) if name == label]
        runs = f"{len(own)} seeds, " if len(own) > 1 else ""
        share = percent(float(np.median([found.shares[i] for i in own])))
        groups[f"{label}: {runs}hypervolume {share}"] = np.concatenate([found.values[i] for i in own])
    figure = scatter_matrix(groups, found.names)
    for i, label in enumerate(labels):
        if len(found.names) == 2 and found.labels.count(label) > 1:
            points = found.median_attainment(label)
            # a point is attained with all that is worse: the step goes by way of the worse corner
            steps = "steps-pre" if found.maximise[0] else "steps-post"
            figure.axes[0].plot(*points.T, drawstyle=steps, color=marker(i)["color"], lw=1.2)
    return figure
