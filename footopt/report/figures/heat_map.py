"""Tables as heat maps: the number in each cell, its colour for the eye."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Colormap, Normalize
from numpy.typing import NDArray

from footopt.report.style import Axes, no_frame

Array = NDArray[np.float64]

ROW = 0.21  # height of a row, inches


def draw_heat_map(
    axes: Axes,
    values: Array,
    rows: Sequence[str],
    columns: Sequence[str],
    texts: Sequence[Sequence[str]],
    norm: Normalize,
    cmap: str | Colormap,
) -> None:
    """One cell a value, (rows, columns), with its text; white where there is none."""
    colours = colormaps.get_cmap(cmap).with_extremes(bad="white")
    shade = colours(np.ma.masked_invalid(norm(values)))
    axes.imshow(shade, aspect="auto", interpolation="nearest")
    for (row, column), _ in np.ndenumerate(values):
        dark = shade[row, column, :3] @ (0.299, 0.587, 0.114) < 0.55
        axes.text(
            column, row, texts[row][column],
            ha="center", va="center_baseline", fontsize=7, color="white" if dark else "black",
        )  # fmt: skip
    axes.set_xticks(range(len(columns)), columns, fontsize=7)
    axes.set_yticks(range(len(rows)), rows)
    axes.set_xticks(np.arange(len(columns) - 1) + 0.5, minor=True)
    axes.set_yticks(np.arange(len(rows) - 1) + 0.5, minor=True)
    axes.grid(which="minor", color="white", lw=1.0)
    axes.xaxis.tick_top()
    no_frame(axes)
