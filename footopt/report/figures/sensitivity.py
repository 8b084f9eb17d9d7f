"""The figure of study=sensitivity: parameters as rows, objectives as columns."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from footopt.report.figures.heat_map import ROW, draw_heat_map
from footopt.report.style import PAGE, new_figure, styled


@styled
def sensitivity(found: Mapping[str, Any], names: Sequence[str], label: Callable[[str], str]) -> Figure:
    """Total Sobol indices with their intervals, and the change by one standard deviation, %.

    Parameters
    ----------
    found : mapping of str to footopt.studies.sensitivity.Indices
        By block; each block has indices of its own.
    names : sequence of str
        Of the objectives.
    label : callable
        From a parameter's name to its label with the standard deviation.
    """
    columns = ["$J_W$" if name == "efficiency" else name.replace("_", "\n") for name in names]
    heights = [len(block.parameters) for block in found.values()]
    largest = max(float(np.nanmax(np.abs(100.0 * block.change), initial=1e-9)) for block in found.values())
    figure = new_figure(PAGE, 1.0 + ROW * sum(heights))
    panels = figure.subplots(len(found), 2, height_ratios=heights, width_ratios=(4, 3), squeeze=False)
    for (left, right), (title, block) in zip(panels, found.items(), strict=True):
        rows = [label(name) for name in block.parameters]
        # what lies within its own interval of zero is not known to be anything
        known = np.where(block.total_error < block.total, block.total, np.nan)
        totals = [
            [f"{v:.2f}±{e:.2f}" if e < v else f"< {max(v + e, 0.01):.2f}" for v, e in zip(*pair, strict=True)]
            for pair in zip(block.total, block.total_error, strict=True)
        ]
        draw_heat_map(left, known, rows, columns, totals, Normalize(0.0, 1.0), "Blues")
        left.set_ylabel(title)
        change = 100.0 * block.change
        texts = [[_signed(value) for value in row] for row in change]
        draw_heat_map(right, change, rows, columns, texts, Normalize(-largest, largest), "PuOr")
        right.tick_params(labelleft=False)
    for axes in panels[1:].flat:
        axes.tick_params(labeltop=False)
    panels[-1, 0].set_xlabel("total Sobol index; white: within its interval of zero")
    panels[-1, 1].set_xlabel("change by one s.d. (%)")
    figure.align_ylabels(panels[:, 0])
    return figure


def _signed(value: float) -> str:
    if not np.isfinite(value):
        return ""
    text = f"{value:+.1f}".replace("-", "\N{MINUS SIGN}")
    return "0.0" if text[1:] == "0.0" else text
