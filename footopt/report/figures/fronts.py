"""Fronts of several solvers and seeds over each other, with the hypervolume of each and what half attain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from footopt.report.numbers import percent
from footopt.report.style import COLOURS, MARKERS, PAGE, as_text, new_figure, styled
from footopt.walk.objectives import lookup

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
    n, labels = len(found.names), list(dict.fromkeys(found.labels))
    colours = {label: COLOURS[i % len(COLOURS)] for i, label in enumerate(labels)}
    markers = {label: MARKERS[i % len(MARKERS)] for i, label in enumerate(labels)}
    size = min(PAGE, 1.6 * n + 1.0)
    figure = new_figure(size, size if n > 2 else 0.75 * size)
    grid = figure.subplots(n - 1, n - 1, squeeze=False)
    titles = [o.label for o in lookup(found.names)]
    for (row, column), axes in np.ndenumerate(grid):
        if column > row:
            axes.set_axis_off()
            continue
        for label, values in zip(found.labels, found.values, strict=True):
            look = {"color": colours[label], "ms": 2.5, "mew": 0, "ls": "", "alpha": 0.6}
            axes.plot(values[:, column], values[:, row + 1], markers[label], **look)
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.yaxis.set_major_locator(MaxNLocator(3))
        axes.tick_params(labelbottom=row == n - 2, labelleft=column == 0)
        if row == n - 2:
            axes.set_xlabel(titles[column])
        if column == 0:
            axes.set_ylabel(titles[row + 1])
    if n == 2:
        for label in labels:
            if found.labels.count(label) > 1:
                points = found.median_attainment(label)
                # a point is attained with all that is worse: the step goes by way of the worse corner
                where = "post" if found.sign[0] > 0 else "pre"
                grid[0, 0].step(points[:, 0], points[:, 1], where=where, color=colours[label], lw=1.2)
    handles = []
    for label in labels:
        shares = [s for s, name in zip(found.shares, found.labels, strict=True) if name == label]
        runs = f"{len(shares)} seeds, " if len(shares) > 1 else ""
        words = f"{as_text(label)}: {runs}hypervolume {percent(float(np.median(shares)))}"
        handles.append(Line2D([], [], color=colours[label], ls="", marker=markers[label], ms=4, label=words))
    place = grid[0, -1] if n > 2 else grid[0, 0]
    place.legend(handles=handles, loc="upper right" if n > 2 else "best")
    return figure
