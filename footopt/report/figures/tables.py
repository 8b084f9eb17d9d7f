"""Tables as heat maps, the number in each cell and its colour for the eye: regrets, stability, claims."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Colormap, ListedColormap, Normalize
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from footopt.report import style
from footopt.report.style import Axes

Array = NDArray[np.float64]

ROW = 0.21  # height of a row, inches
CHECK = "✓"
VERDICTS = ListedColormap(["#F7C6A3", "#DBEAF3"])  # not stable, stable


def draw_heat_map(
    axes: Axes,
    values: Array,
    rows: Sequence[str],
    columns: Sequence[str],
    texts: Sequence[Sequence[str]],
    cmap: str | Colormap,
    most: float = 1.0,
) -> None:
    """One cell a value from 0 to `most`, (rows, columns), with its text; white where there is none."""
    colours = colormaps.get_cmap(cmap).with_extremes(bad="white")
    shade = colours(np.ma.masked_invalid(Normalize(0.0, most)(values)))
    axes.imshow(shade, aspect="auto", interpolation="nearest")
    for row, column in np.ndindex(values.shape):
        dark = shade[row, column, :3] @ (0.299, 0.587, 0.114) < 0.55
        look = {"fontsize": 7, "color": "white" if dark else "black"}
        axes.text(column, row, texts[row][column], ha="center", va="center_baseline", **look)
    axes.set_xticks(range(len(columns)), columns, fontsize=7)
    axes.set_yticks(range(len(rows)), rows)
    axes.set_xticks(np.arange(len(columns) - 1) + 0.5, minor=True)
    axes.set_yticks(np.arange(len(rows) - 1) + 0.5, minor=True)
    axes.grid(which="minor", color="white", lw=1.0)
    axes.xaxis.tick_top()
    axes.tick_params(which="both", length=0)
    axes.spines[:].set_visible(False)


@style.styled()
def regrets(values: ArrayLike, feet: Sequence[str], scenarios: Sequence[str]) -> Figure:
    """The regret of each foot (row) in each scenario (column) against the best foot known there, %."""
    table = 100.0 * np.asarray(values, float)
    table = np.column_stack([table, table.mean(axis=1), table.max(axis=1)])
    texts = [[f"{v:.1f}" if np.isfinite(v) else "failed" for v in row] for row in table]
    columns = [name.removeprefix("draw ").replace(" ", "\n") for name in (*scenarios, "mean", "worst")]
    figure = style.new_figure(style.PAGE if len(scenarios) > 4 else style.COLUMN, 0.95 + ROW * len(feet))
    axes = figure.subplots()
    draw_heat_map(axes, table, feet, columns, texts, "Blues", max(1.0, float(np.nanmax(table, initial=0.0))))
    axes.axvline(len(scenarios) - 0.5, color="white", lw=5.0)
    axes.set_ylabel("foot made for")
    figure.supxlabel("regret against the best specialist in each scenario (%)")
    return figure


@style.styled()
def verdicts(faults: Mapping[str, Sequence[str]], methods: Sequence[str]) -> Figure:
    """Stable (a tick) or at fault (what decides, and its value), of each case by name with each method."""
    figure = style.new_figure(style.PAGE, 0.75 + ROW * len(faults))
    stable = np.array([[not fault for fault in row] for row in faults.values()], float)
    texts = [[fault or CHECK for fault in row] for row in faults.values()]
    names = ["\n".join(method.rsplit("_", 1)).replace("_", " ") for method in methods]
    draw_heat_map(figure.subplots(), stable, list(faults), names, texts, VERDICTS)
    figure.supxlabel(f"{CHECK} stable; where it is not: the measure that is furthest beyond its limit")
    return figure


@style.styled()
def claims(entries: Sequence[Mapping[str, Any]]) -> Figure:
    """Every claim, and whether it holds at the settings and with each open choice made otherwise.

    The claims are those of result.json, with `says`, `margin` and `changed`; a margin that is None is white.
    """
    figure = style.new_figure(style.PAGE, 1.6 + 0.17 * len(entries))
    axes = figure.subplots()
    columns = ["the settings", *entries[0]["changed"]]
    margins = np.array([[e["margin"], *e["changed"].values()] for e in entries], float)
    holds = np.where(np.isfinite(margins), margins > 0.0, np.nan)
    blank = [[""] * len(columns)] * len(entries)
    draw_heat_map(axes, holds, [entry["says"] for entry in entries], columns, blank, VERDICTS)
    axes.tick_params(axis="x", rotation=90)
    axes.tick_params(axis="y", labelsize=7)
    figure.supxlabel("blue: the claim holds; orange: it does not")
    return figure
