"""The figure of study=effects: how much each effect changes every objective, and the ranking of feet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from footopt.report.numbers import sand_title
from footopt.report.style import CHOSEN, GREY, GRID, PAGE, Axes, new_figure, styled
from footopt.walk import FIVE
from footopt.walk.audit import Audit, Joint


@styled
def changes(audits: Sequence[Audit]) -> Figure:
    """A row for each effect and sand, a panel for each objective, a line where a change matters."""
    sands, labels = [sand_title(a.scene.sand) for a in audits], [a.name.replace("_", " ") for a in audits]
    where = f" on {sands[0]}" if len(set(sands)) == 1 else ""
    labels = [label if where else f"{label}, {sand}" for label, sand in zip(labels, sands, strict=True)]
    figure, axes = _rows(labels, np.array([a.changes for a in audits]), audits[0].tolerance, f"change{where}")
    right = axes.secondary_yaxis("right")
    right.set_yticks(np.arange(len(audits)), [f"τ {a.tau:.2f}, time × {a.cost:.2g}" for a in audits])
    right.tick_params(length=0, colors="0.35")
    return figure


@styled
def pairs(joints: Sequence[Joint], tolerance: float) -> Figure:
    """The same for effects in pairs and together: what they change beyond what each changes alone."""
    labels = [" + ".join(j.names).replace("_", " ") for j in joints]
    labels = [label if label.count("+") < 2 else f"all {label.count('+') + 1}" for label in labels]
    extra = np.array([j.extra for j in joints])
    return _rows(labels, extra, tolerance, "change beyond that by each alone")[0]


def _rows(
    labels: Sequence[str], values: NDArray[np.float64], tolerance: float, what: str
) -> tuple[Figure, Axes]:
    """A row for each label, a panel for each column of relative values; the last panel is returned, too."""
    figure, rows, limit = new_figure(PAGE, 1.0 + 0.2 * len(labels)), np.arange(len(labels)), 100.0 * tolerance
    panels = figure.subplots(1, len(FIVE), sharex=True, sharey=True)
    for axes, name, column in zip(panels, FIVE, 100.0 * values.T, strict=True):
        for found, colour in ((column > limit, CHOSEN), (column <= limit, GREY)):
            axes.plot(column[found], rows[found], "o", color=colour, ms=4)
        axes.axvline(limit, color="black", lw=0.8, ls="--")
        axes.set(xscale="log", title=name.replace("_", " "))
        axes.margins(x=0.1)
        axes.grid(color=GRID, lw=0.6)
        axes.tick_params(axis="y", length=0)
    panels[0].set_yticks(rows, labels)
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    figure.supxlabel(f"{what}, not exceeded by 95 % of the feet (%); dashed: what matters ({limit:g} %)")
    return figure, panels[-1]
