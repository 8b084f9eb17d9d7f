"""The figures of study=robust: what every foot loses where, and how the robust one does elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from footopt.report.figures.heat_map import ROW, draw_heat_map
from footopt.report.labels import label_all
from footopt.report.style import BEST, COLUMN, FLAT, GREY, GRID, PAGE, new_figure, styled

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


@styled
def hollows(
    values: ArrayLike, filled: ArrayLike, feet: Sequence[str], laws: Sequence[str], name: str
) -> Figure:
    """What the hollow of each foot (row) is worth under each law (panel).

    Parameters
    ----------
    values : (laws, feet)
        Of the objective, as the feet are.
    filled : (laws, feet)
        Where they are convex: their hollows hold sand that moves with them.
    feet, laws : sequence of str
        Their names.
    name : str
        Of the objective, with its unit.
    """
    hollow, convex = np.asarray(values, float), np.asarray(filled, float)
    figure = new_figure(PAGE, 0.95 + 0.22 * len(feet))
    panels = figure.subplots(1, len(laws), sharex=True, sharey=True, squeeze=False)[0]
    rows = np.arange(len(feet))
    for axes, law, before, after in zip(panels, laws, hollow, convex, strict=True):
        axes.hlines(rows, before, after, color=GREY, lw=1.0)
        axes.plot(before, rows, "o", color=BEST, label="as it is")
        axes.plot(after, rows, "s", color=FLAT, mfc="none", ms=6.5, label="its hollows filled")
        axes.set_title(law)
        axes.xaxis.set_major_locator(MaxNLocator(20 // len(laws)))
        axes.grid(color=GRID, lw=0.6)
        axes.tick_params(axis="y", length=0)
    panels[0].set_yticks(rows, feet)
    panels[0].set_ylim(len(feet) - 0.5, -0.5)
    panels[0].set_ylabel("foot made for")
    figure.supxlabel(name)
    label_all(panels)
    return figure
