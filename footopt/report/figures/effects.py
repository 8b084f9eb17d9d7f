"""The figure of study=effects: how much each effect changes every objective, and the ranking of feet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from footopt.report.style import GRID, PAGE, Axes, marker, new_figure, styled
from footopt.walk import FIVE
from footopt.walk.audit import Audit, Joint


@styled
def changes(audits: Sequence[Audit]) -> Figure:
    """A row for each effect and sand, a marker for each objective, a line where a change matters."""
    labels = [f"{a.name.replace('_', ' ')}, {a.scene.sand.name} sand" for a in audits]
    figure, axes = _rows(labels, np.array([a.changes for a in audits]), audits[0].tolerance)
    axes.set_xlabel("change not exceeded by 95 % of the feet (%)")
    right = axes.secondary_yaxis("right")
    right.set_yticks(np.arange(len(audits)), [f"τ {a.tau:.2f}, time × {a.cost:.2g}" for a in audits])
    right.tick_params(length=0, colors="0.35")
    return figure


@styled
def pairs(joints: Sequence[Joint], tolerance: float) -> Figure:
    """The same for effects in pairs and together: what they change beyond what each changes alone."""
    labels = [" + ".join(j.names).replace("_", " ") for j in joints]
    labels = [label if label.count("+") < 2 else f"all {label.count('+') + 1}" for label in labels]
    figure, axes = _rows(labels, np.array([j.extra for j in joints]), tolerance)
    axes.set_xlabel("change beyond that by each alone, not exceeded by 95 % of the feet (%)")
    return figure


def _rows(labels: Sequence[str], values: NDArray[np.float64], tolerance: float) -> tuple[Figure, Axes]:
    """A row for each label with a marker for each objective, relative values (rows, objectives)."""
    figure = new_figure(PAGE, 1.5 + 0.33 * len(labels))
    axes, rows = figure.subplots(), np.arange(len(labels))
    for i, name in enumerate(FIVE):
        axes.plot(100.0 * values[:, i], rows, **marker(i), ms=5, label=name.replace("_", " "))
    limit = 100.0 * tolerance
    axes.axvline(limit, color="black", lw=0.8, ls="--", label=f"what matters ({limit:g} %)")
    axes.set_xscale("log")
    axes.set_yticks(rows, labels)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.grid(color=GRID, lw=0.6)
    figure.legend(loc="outside upper center", ncols=3)
    return figure, axes
