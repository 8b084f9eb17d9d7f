"""The figure of study=effects: how much each effect changes every objective, and the ranking of feet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from footopt.report.numbers import sand_title
from footopt.report.style import CHOSEN, GREY, GRID, PAGE, new_figure, styled
from footopt.walk import FIVE


@styled
def changes(audits: Sequence[Any]) -> Figure:
    """Draw audits (`footopt.studies.audit.Audit`): a row for each effect and sand, a panel an objective.

    A line is where a change matters.
    """
    sands, labels = [sand_title(a.scene.sand) for a in audits], [a.name.replace("_", " ") for a in audits]
    where = f" on {sands[0]}" if len(set(sands)) == 1 else ""
    labels = [label if where else f"{label}, {sand}" for label, sand in zip(labels, sands, strict=True)]
    figure, rows, limit = (
        new_figure(PAGE, 1.0 + 0.2 * len(labels)), np.arange(len(labels)), 100.0 * audits[0].tolerance,
    )  # fmt: skip
    panels = figure.subplots(1, len(FIVE), sharex=True, sharey=True)
    for axes, name, column in zip(panels, FIVE, 100.0 * np.array([a.changes for a in audits]).T, strict=True):
        for found, colour in ((column > limit, CHOSEN), (column <= limit, GREY)):
            axes.plot(column[found], rows[found], "o", color=colour, ms=4)
        axes.axvline(limit, color="black", lw=0.8, ls="--")
        axes.set(xscale="log", title=name.replace("_", " "))
        axes.margins(x=0.1)
        axes.grid(color=GRID, lw=0.6)
        axes.tick_params(axis="y", length=0)
    panels[0].set_yticks(rows, labels)
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    right = panels[-1].secondary_yaxis("right")
    right.set_yticks(rows, [f"τ {a.tau:.2f}, time × {a.cost:.2g}" for a in audits])
    right.tick_params(length=0, colors="0.35")
    figure.supxlabel(
        f"change{where}, not exceeded by 95 % of the feet (%); dashed: what matters ({limit:g} %)"
    )
    return figure
