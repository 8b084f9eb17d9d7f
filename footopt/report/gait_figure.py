"""The figure of a gait from a file: the strides that were found, their mean, and what is walked."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from footopt.files.gaits import Strides
from footopt.gait import Gait
from footopt.report.figures import BLUE, COLUMN, GREY, VERMILLION, _figure, _legend_above, styled

SIGNS = {"thigh": "forward", "knee": "flexed", "foot": "toe up"}


@styled
def gait_fit(strides: Strides, gait: Gait) -> Figure:
    """A row for each joint over one stride: every stride found, their mean, the fitted series."""
    figure = _figure(COLUMN, 0.6 + 1.15 * len(strides.curves))
    rows = figure.subplots(len(strides.curves), sharex=True, squeeze=False)[:, 0]
    phase, dense, residual = 100.0 * strides.phase, np.linspace(0.0, 1.0, 401), dict(gait.residual)
    for axes, (joint, curves) in zip(rows, strides.curves.items(), strict=True):
        if len(curves) > 1:
            axes.plot(phase, curves.T, color=GREY, lw=0.4, label=["strides", *["_"] * (len(curves) - 1)])
        axes.plot(phase, curves.mean(axis=0), color=BLUE, label="mean")
        series = np.degrees(getattr(gait, joint).at(dense)[0])
        axes.plot(100.0 * dense, series, "--", color=VERMILLION, label="fit")
        axes.set_ylabel(f"{joint} (deg), {SIGNS[joint]}")
        axes.set_title(f"misfit {residual[joint]:.2f}° rms", loc="right", pad=2)
    rows[-1].set(xlabel="stride (%), from heel strike", xlim=(0, 100))
    figure.align_ylabels(rows)
    _legend_above(figure, *rows[0].get_legend_handles_labels())
    return figure
