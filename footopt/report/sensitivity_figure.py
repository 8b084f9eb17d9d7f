"""The figure of study=sensitivity: parameters as rows, objectives as columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from footopt.report.figures import PAGE, _figure, styled
from footopt.report.heat_map import ROW, draw_heat_map


@styled
def sensitivity(found: Mapping[str, Any], names: Sequence[str]) -> Figure:
    """Total Sobol indices, and the change that one standard deviation of each parameter makes, %.

    Parameters
    ----------
    found : of `studies.sensitivity.Indices`, by block; each block has indices of its own.
    names : of the objectives.
    """
    columns = [name.replace("_", "\n") for name in names]
    heights = [len(block.parameters) for block in found.values()]
    largest = max(float(np.nanmax(np.abs(100.0 * block.change), initial=1e-9)) for block in found.values())
    figure = _figure(PAGE, 1.0 + ROW * sum(heights))
    panels = figure.subplots(len(found), 2, height_ratios=heights, squeeze=False)
    for (left, right), (title, block) in zip(panels, found.items(), strict=True):
        rows = [name.replace("_", " ") for name in block.parameters]
        totals = [[f"{value:.2f}" for value in row] for row in block.total]
        draw_heat_map(left, block.total, rows, columns, totals, Normalize(0.0, 1.0), "Blues")
        left.set_ylabel(title)
        change = 100.0 * block.change
        texts = [[f"{value:+.1f}" if np.isfinite(value) else "" for value in row] for row in change]
        draw_heat_map(right, change, rows, columns, texts, Normalize(-largest, largest), "PuOr")
        right.tick_params(labelleft=False)
    for axes in panels[1:].flat:
        axes.tick_params(labeltop=False)
    panels[-1, 0].set_xlabel("total Sobol index")
    panels[-1, 1].set_xlabel("change by one standard deviation (%)")
    return figure
