"""Tables of verdicts, with the reason in a cell where one is short: stability, and the paper's claims."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from footopt.arrays import Array
from footopt.report import style

ROW = 0.21  # height of a row, inches
CHECK = "✓"
SHADES = ListedColormap(["#F7C6A3", "#DBEAF3"])  # bad, good; white where there is no verdict


@style.styled()
def verdicts(faults: Mapping[str, Sequence[str]], methods: Sequence[str]) -> Figure:
    """Stable (a tick) or at fault (what decides, and its value), of each case by name with each method."""
    figure = style.new_figure(style.PAGE, 0.75 + ROW * len(faults))
    axes, good = figure.subplots(), np.array([[not fault for fault in row] for row in faults.values()], float)
    names = ["\n".join(method.rsplit("_", 1)).replace("_", " ") for method in methods]
    _draw(axes, good, list(faults), names)
    for row, column in np.ndindex(good.shape):
        text = [*faults.values()][row][column] or CHECK
        axes.text(column + 0.5, row + 0.5, text, ha="center", va="center_baseline", fontsize=7)
    figure.supxlabel(f"{CHECK} stable; where it is not: the measure that is furthest beyond its limit")
    return figure


@style.styled()
def claims(entries: Sequence[Mapping[str, Any]]) -> Figure:
    """Every claim, and whether it holds at the settings and with each open choice made otherwise.

    The claims are those of result.json, with `says`, `margin` and `changed`; a margin that is None is white.
    """
    figure = style.new_figure(style.PAGE, 1.6 + 0.17 * len(entries))
    axes = figure.subplots()
    margins = np.array([[e["margin"], *e["changed"].values()] for e in entries], float)
    holds = np.where(np.isfinite(margins), margins > 0.0, np.nan)
    _draw(axes, holds, [e["says"] for e in entries], ["the settings", *entries[0]["changed"]])
    axes.tick_params(axis="x", rotation=90)
    axes.tick_params(axis="y", labelsize=7)
    figure.supxlabel("blue: the claim holds; orange: it does not")
    return figure


def _draw(axes: style.Axes, good: Array, rows: Sequence[str], columns: Sequence[str]) -> None:
    """One cell a verdict (rows, columns): 1 is good, 0 bad, NaN none."""
    axes.pcolormesh(good, cmap=SHADES, vmin=0.0, vmax=1.0, edgecolor="white", lw=1.0)
    axes.set_xticks(np.arange(len(columns)) + 0.5, columns, fontsize=7)
    axes.set_yticks(np.arange(len(rows)) + 0.5, rows)
    axes.invert_yaxis()
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
