"""The figure of study=credibility: the level of each factor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from footopt.report.style import BLUE, GRID, new_figure, styled

MOST = 4


@styled
def levels(names: Sequence[str], found: Sequence[int]) -> Figure:
    """A bar for each factor."""
    figure = new_figure(4.6, 0.6 + 0.24 * len(names))
    axes, rows = figure.subplots(), np.arange(len(names))
    axes.barh(rows, found, height=0.6, color=BLUE)
    axes.plot(np.zeros(len(rows)), rows, "|", color=BLUE, ms=9, mew=2)  # that a level of 0 is seen
    axes.set_yticks(rows, names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.set_xlim(0, MOST)
    axes.set_xticks(range(MOST + 1))
    axes.set_xlabel("level, 0 (nothing) to 4")
    axes.grid(axis="x", color=GRID, lw=0.6)
    return figure
