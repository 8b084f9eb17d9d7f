"""Figures of the studies accuracy (error against time), effects (changes) and calibrate (zeta by depth)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from footopt.report import style
from footopt.report.numbers import sand_title
from footopt.report.style import marker, new_figure, styled
from footopt.walk import FIVE, STEPPERS
from footopt.walk.accuracy import Accuracy

HIGHEST = 2.5  # of zeta: what is shown of shallow measurements, whose zeta is noise


@styled
def work_precision(measured: Sequence[Any], presets: Sequence[Accuracy], default: str = "standard") -> Figure:
    """Error against time per design of measurements (`footopt.studies.accuracy.Measurement`), by objective.

    A line joins those that no other beats in both; circles are presets, the default's is larger.
    """
    figure = new_figure(style.PAGE, 4.4)
    grid = figure.subplots(2, 3, sharex=True, sharey=True)
    found = np.array([_method(m.accuracy) for m in measured])
    # a stepper has its colour whatever else was measured
    methods = (*STEPPERS, *sorted({*found} - {*STEPPERS}))
    ms = np.array([m.ms for m in measured])
    errors = 100.0 * np.array([[*np.max(m.errors, axis=0), m.error] for m in measured])
    at = {m.accuracy: i for i, m in enumerate(measured)}
    nameless = {preset.name: replace(preset, name=Accuracy().name, adapt=False) for preset in presets}
    marked = {name: at[accuracy] for name, accuracy in nameless.items() if accuracy in at}
    for axes, name, error in zip(grid.flat, [*FIVE, "worst objective"], errors.T, strict=True):
        for i, method in enumerate(methods):
            if (own := found == method).any():
                looks = marker(i) | {"ms": 3, "alpha": 0.7, "label": method.replace("_", " ")}
                shown = own & (error > 0.0) & (error < 100.0)
                axes.plot(ms[shown], error[shown], **looks)
        order = np.lexsort((error, ms))
        order = order[error[order] > 0.0]
        front = order[error[order] == np.minimum.accumulate(error[order])]
        axes.plot(ms[front], error[front], color="black", lw=0.8, label="none better in both")
        for preset, i in marked.items():
            size = 9 if preset == default else 6
            axes.plot(ms[i], error[i], "o", mfc="none", mec="black", ms=size, mew=1.0)
        axes.set(xscale="log", yscale="log", title=name.replace("_", " "))
        # matplotlib's own labels overprint where there is less than a decade
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.grid()
    box, line = {"fc": "white", "ec": "none", "alpha": 0.85, "pad": 1.0}, {"arrowstyle": "-", "lw": 0.6}
    for preset, i in marked.items():  # once: the circles are in the same order everywhere
        near = {"xytext": (14, 14), "textcoords": "offset points", "arrowprops": line, "bbox": box}
        grid[-1, -1].annotate(preset, (ms[i], errors[i, -1]), **near)
    figure.supxlabel(
        "time per design and core (ms)\n"
        "error not exceeded by 95 % of the feet, largest over soft, regular and hard sand; "
        "circles: presets, the default's is larger"
    )
    figure.supylabel("relative error (%)")
    style.legend_above(figure)
    return figure


def _method(accuracy: Accuracy) -> str:
    return accuracy.stepper if accuracy.control is None else f"{accuracy.stepper}, step control"


@styled
def changes(audits: Sequence[Any]) -> Figure:
    """Change of each objective by an effect and sand (`footopt.studies.audit.Audit`), a row each.

    A line is where a change matters.
    """
    sands, labels = [sand_title(a.scene.sand) for a in audits], [a.name.replace("_", " ") for a in audits]
    where = f" on {sands[0]}" if len(set(sands)) == 1 else ""
    labels = [label if where else f"{label}, {sand}" for label, sand in zip(labels, sands, strict=True)]
    rows, limit = np.arange(len(labels)), 100.0 * audits[0].tolerance
    figure = new_figure(style.PAGE, 1.0 + 0.2 * len(labels))
    panels = figure.subplots(1, len(FIVE), sharex=True, sharey=True)
    for axes, name, column in zip(panels, FIVE, 100.0 * np.array([a.changes for a in audits]).T, strict=True):
        for found, colour in ((column > limit, style.CHOSEN), (column <= limit, style.GREY)):
            axes.plot(column[found], rows[found], "o", color=colour, ms=4)
        axes.axvline(limit, color="black", lw=0.8, ls="--")
        axes.set(xscale="log", title=name.replace("_", " "))
        axes.margins(x=0.1)
        axes.grid()
        axes.tick_params(axis="y", length=0)
    panels[0].set_yticks(rows, labels)
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    right = panels[-1].secondary_yaxis("right")
    right.set_yticks(rows, [f"τ {a.tau:.2f}, time × {a.cost:.2g}" for a in audits])
    right.tick_params(length=0, colors="0.35")
    figure.supxlabel(
        f"change{where}, not exceeded by 95 % of the feet (%); dashed: what matters ({limit:g} %)"
    )
    return figure


@styled
def calibration(found: Any) -> Figure:
    """Force over the map's force at zeta 1 of measurements (`footopt.studies.calibration.Calibration`)."""
    figure = new_figure(style.COLUMN, 2.5)
    axes = figure.subplots()
    axes.axhspan(found.zeta.low, found.zeta.high, color=style.PALE, lw=0, label="95 % interval of $\\zeta$")
    axes.axhline(found.zeta.value, color="black", lw=0.8, label="linear in depth, as footopt has it")
    for i, name in enumerate(found.set_ups):
        own = found.set_up == name
        looks = marker(i) | {"ms": 3, "alpha": 0.7, "label": name if len(found.set_ups) > 1 else "measured"}
        axes.plot(1e3 * found.depth[own], found.local[own], **looks)
    depth = np.geomspace(found.depth.min(), found.depth.max(), 200)
    power = f"depth to the power {found.exponent.value:.2f}"
    axes.plot(1e3 * depth, found.zeta_at(depth), color="black", ls="--", label=power)
    axes.set(xlabel="depth (mm)", ylabel=r"local $\zeta$: force over the map's")
    axes.set_xlim(0.0, None)
    top = HIGHEST * max(found.zeta.value, float(found.zeta_at(depth).max()) / 1.5)
    axes.set_ylim(0.0, min(top, 1.1 * float(np.max(found.local))))
    axes.grid()
    style.legend_above(figure)
    return figure
