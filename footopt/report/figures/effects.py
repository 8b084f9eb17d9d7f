"""The figure of study=effects: how much each effect changes every objective, and the ranking of feet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from footopt.report.style import GRID, PAGE, marker, new_figure, styled
from footopt.walk import FIVE
from footopt.walk.audit import Audit


@styled
def changes(audits: Sequence[Audit]) -> Figure:
    """A row for each effect and sand, a marker for each objective, a line where a change matters."""
    figure = new_figure(PAGE, 1.5 + 0.33 * len(audits))
    axes = figure.subplots()
    rows = np.arange(len(audits))
    for i, name in enumerate(FIVE):
        values = 100.0 * np.array([a.changes[i] for a in audits])
        axes.plot(values, rows, **marker(i), ms=5, label=name.replace("_", " "))
    limit = 100.0 * audits[0].tolerance
    axes.axvline(limit, color="black", lw=0.8, ls="--", label=f"what matters ({limit:g} %)")
    axes.set_xscale("log")
    axes.set_yticks(rows, [f"{a.name.replace('_', ' ')}, {a.scene.sand.name} sand" for a in audits])
    axes.set_ylim(len(audits) - 0.5, -0.5)
    axes.set_xlabel("change not exceeded by 95 % of the feet (%)")
    axes.grid(color=GRID, lw=0.6)
    right = axes.secondary_yaxis("right")
    right.set_yticks(rows, [f"τ {a.tau:.2f}, time × {a.cost:.2f}" for a in audits])
    right.tick_params(length=0, colors="0.35")
    figure.legend(loc="outside upper center", ncols=3)
    return figure
