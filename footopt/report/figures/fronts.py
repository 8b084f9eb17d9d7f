"""Fronts of several solvers and seeds over each other, with the hypervolume of each and what half attain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from footopt.report.figures.search import scatter_matrix
from footopt.report.numbers import percent
from footopt.report.style import marker, styled

if TYPE_CHECKING:
    from footopt.report.sweeps import Fronts


@styled
def fronts(found: Fronts) -> Figure:
    """Every pair of objectives of several fronts; a colour for all runs that differ by their seeds only.

    The legend has the median of each colour's hypervolume, in that of all fronts merged. Of two objectives a
    line shows what half of the runs of a colour attain.

    Parameters
    ----------
    found : Fronts
        Of one problem.
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
            steps = "steps-post" if found.sign[0] > 0 else "steps-pre"
            figure.axes[0].plot(*points.T, drawstyle=steps, color=marker(i)["color"], lw=1.2)
    return figure
