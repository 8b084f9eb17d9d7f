"""The figure of study=atlas: in every cell the best sole, and how good it is by the colour."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from footopt.report.style import PAGE, new_figure, styled

INSIDE = 0.8  # of a cell's width and height that a sole takes
TALL = 5.0  # of the figure, inches


@styled
def atlas(
    edges: ArrayLike,
    cells: ArrayLike,
    soles: Sequence[ArrayLike],
    quality: ArrayLike,
    labels: Sequence[str],
    legend: str,
) -> Figure:
    """The best sole of every cell.

    Parameters
    ----------
    edges : (2, cells + 1)
        Of the cells, along and across.
    cells : (filled, 2)
        Where each sole is.
    soles : sequence of (points, 2)
        Their contours, all to one scale, heights enlarged.
    quality : (filled,)
        Of each, for its colour: more is better.
    labels : (str, str)
        Of the axes.
    legend : str
        What the quality is.
    """
    x, y = np.asarray(edges, float)
    at, good = np.asarray(cells), np.asarray(quality, float)
    low = np.floor(10.0 * min(good.min(), 0.9 * good.max())) / 10.0
    colours, norm = colormaps["YlGnBu"], Normalize(low, good.max())
    figure = new_figure(PAGE, TALL)
    axes = figure.subplots()
    table = np.full((len(y) - 1, len(x) - 1), np.nan)
    table[at[:, 1], at[:, 0]] = good
    axes.pcolormesh(x, y, np.ma.masked_invalid(table), cmap=colours, norm=norm, ec="white", lw=0.5)
    points = np.concatenate([np.asarray(sole, float) for sole in soles])
    low, span = points.min(axis=0), np.ptp(points, axis=0)
    lines, dark = [], []
    for (i, j), sole, value in zip(at, soles, good, strict=True):
        unit = (np.asarray(sole, float) - low) / np.where(span > 0.0, span, 1.0)
        size = np.array([x[i + 1] - x[i], y[j + 1] - y[j]])
        lines.append([x[i], y[j]] + size * (0.5 + INSIDE * (unit - 0.5)))
        dark.append("white" if np.dot(colours(norm(value))[:3], (0.299, 0.587, 0.114)) < 0.55 else "black")
    axes.add_collection(LineCollection(lines, colors=dark, linewidths=0.8))
    axes.set(xlabel=labels[0], ylabel=labels[1])
    figure.colorbar(ScalarMappable(norm, colours), ax=axes, label=legend, aspect=30, pad=0.02)
    return figure
