"""The figure of study=accuracy: what a smaller error costs, an objective a panel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from footopt.report.style import (
    GREY,
    GRID,
    PAGE,
    legend_above,
    marker,
    new_figure,
    styled,
)
from footopt.walk import FIVE, STEPPERS
from footopt.walk.accuracy import Accuracy

WORST = "worst objective"


@styled
def work_precision(measured: Sequence[Any], presets: Sequence[Accuracy], default: str = "standard") -> Figure:
    """Error against ms per design and core for every setting.

    Parameters
    ----------
    measured : sequence of footopt.studies.accuracy.Measurement
        Those that no other beats in a panel are joined by a line.
    presets : sequence of Accuracy
        Marked by name where they were measured.
    default : str
        Of the preset with the larger mark.
    """
    figure = new_figure(PAGE, 4.4)
    grid = figure.subplots(2, 3, sharex=True, sharey=True)
    found = [_method(m.accuracy) for m in measured]
    # a stepper has its colour whatever else was measured
    methods = {name: marker(i) for i, name in enumerate((*STEPPERS, *sorted({*found} - {*STEPPERS})))}
    shown = {name: looks for name, looks in methods.items() if name in found}
    ms = np.array([m.ms for m in measured])
    errors = 100.0 * np.array([[*np.max(m.errors, axis=0), m.error] for m in measured])
    at = {m.accuracy: i for i, m in enumerate(measured)}
    nameless = {preset.name: replace(preset, name=Accuracy().name, adapt=False) for preset in presets}
    marked = {name: at[accuracy] for name, accuracy in nameless.items() if accuracy in at}
    titles = [*(name.replace("_", " ") for name in FIVE), WORST]
    for axes, title, error in zip(grid.flat, titles, errors.T, strict=True):
        for name, looks in shown.items():
            seen = (np.array(found) == name) & (error > 0.0) & (error < 100.0)
            axes.plot(ms[seen], error[seen], **looks, ms=3, alpha=0.7, label=name.replace("_", " "))
        order = np.lexsort((error, ms))
        order = order[error[order] > 0.0]
        front = order[error[order] == np.minimum.accumulate(error[order])]
        axes.plot(ms[front], error[front], color="black", lw=0.8, label="none better in both")
        for name, i in marked.items():
            if error[i] > 0.0:
                size = 9 if name == default else 6
                axes.plot(ms[i], error[i], "o", mfc="none", mec="black", ms=size, mew=1.0)
                if title == WORST:  # once: the circles are in the same order everywhere
                    _name(axes, name, (ms[i], error[i]))
        axes.set(xscale="log", yscale="log", title=title)
        # matplotlib's own labels overprint where there is less than a decade
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.grid(color=GRID, lw=0.6)
    for axes in grid[-1]:
        axes.set_xlabel("time per design and core (ms)")
    for axes in grid[:, 0]:
        axes.set_ylabel("relative error (%)")
    figure.supxlabel(
        "error not exceeded by 95 % of the feet, largest over soft, regular and hard sand; "
        "circles: presets, the default's is larger",
        color=GREY,
    )
    legend_above(figure)
    return figure


def _name(axes: Any, name: str, place: tuple[float, float]) -> None:
    """A name beside a point, joined to it by a line."""
    box = {"boxstyle": "square,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85}
    line = {"arrowstyle": "-", "lw": 0.6}
    axes.annotate(name, place, xytext=(14, 14), textcoords="offset points", arrowprops=line, bbox=box)


def _method(accuracy: Accuracy) -> str:
    return accuracy.stepper if accuracy.control is None else f"{accuracy.stepper}, step control"
