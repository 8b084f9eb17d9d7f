"""The figures of study=robust: what every foot loses where, and how the robust one does elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from footopt.report.figures.heat_map import ROW, draw_heat_map
from footopt.report.style import BEST, COLUMN, GREY, PAGE, new_figure, styled

SHORT = 7  # letters that a column of a narrow table has room for


@styled
def regrets(values: ArrayLike, feet: Sequence[str], scenarios: Sequence[str]) -> Figure:
    """What each foot (row) loses in each scenario (column) relative to the best known there, %."""
    table = 100.0 * np.asarray(values, float)
    summary = np.stack([table.mean(axis=1), table.max(axis=1)], axis=1)
    many = len(scenarios) > 6
    longest = max(len(word) for name in scenarios for word in name.split())
    width = PAGE if many else COLUMN + (0.3 * len(scenarios) if longest > SHORT else 0.0)
    figure = new_figure(width, 0.95 + ROW * len(feet))
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=[len(scenarios), 2])
    norm = Normalize(0.0, max(1.0, float(np.nanmax(table, initial=0.0))))
    names = [name.removeprefix("draw ") if many else name.replace(" ", "\n") for name in scenarios]
    for axes, part, columns in ((left, table, names), (right, summary, ["mean", "worst"])):
        texts = [[f"{v:.1f}" if np.isfinite(v) else "failed" for v in row] for row in part]
        draw_heat_map(axes, part, feet, columns, texts, norm, "Blues")
    right.tick_params(labelleft=False)
    left.set_ylabel("foot made for")
    figure.supxlabel("loss against the best specialist in each scenario (%)")
    return figure


@styled
def held_out(values: ArrayLike) -> Figure:
    """Loss of the robust foot against the median scene's in fresh scenarios, %: its distribution.

    Negative is a gain. Scenarios in which one of them fails are left out.
    """
    loss = np.sort(100.0 * np.asarray(values, float))
    loss = loss[np.isfinite(loss)]
    figure = new_figure(COLUMN, 2.2)
    axes = figure.subplots()
    axes.axvline(0.0, color=GREY, lw=0.8, ls="--")
    axes.step(loss, 100.0 * np.arange(1, len(loss) + 1) / len(loss), where="post", color=BEST)
    axes.set(ylim=(0, 100), ylabel=f"share of {len(loss)} scenarios (%)")
    axes.set_xlabel("loss against the median scene's foot (%)\n\N{LEFTWARDS ARROW} robust foot better")
    return figure
