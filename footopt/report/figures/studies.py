"""Figures of the studies accuracy (error against time), effects (changes) and calibrate (zeta by depth)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from footopt.report import style
from footopt.report.numbers import sand_title
from footopt.walk import FIVE

WORST = "error of the worst objective (%),\nnot exceeded by 95 % of the feet"
HIGHEST = 2.5  # of zeta: what is shown of shallow measurements, whose zeta is noise


@style.styled()
def work_precision(settings: Sequence[Any], presets: Sequence[Any]) -> Figure:
    """Error against time of measurements (`footopt.studies.accuracy.Measurement`), a line for each method."""
    figure = style.new_figure(style.PAGE, 3.6)
    axes = figure.subplots()
    for i, method in enumerate(dict.fromkeys(m.method for m in settings)):
        own = [m for m in settings if m.method == method]
        looks = style.marker(i) | {"ls": "-", "lw": 1.0, "ms": 4, "label": method.replace("_", " ")}
        axes.plot([m.ms for m in own], [100.0 * m.error for m in own], **looks)
    for m in presets:
        axes.plot(m.ms, 100.0 * m.error, "o", mfc="none", mec="black", ms=10, mew=1.2)
        looks = {"xytext": (-8, -12), "textcoords": "offset points", "weight": "bold", "ha": "right"}
        axes.annotate(m.method, (m.ms, 100.0 * m.error), **looks)
    axes.set(xscale="log", yscale="log", xlabel="time per design and core (ms)", ylabel=WORST)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.grid()
    style.legend_above(figure)
    return figure


@style.styled()
def changes(audits: Sequence[Any]) -> Figure:
    """Change of each objective by an effect and sand (`footopt.studies.audit.Audit`), a row each.

    A line is where a change matters.
    """
    sands, labels = [sand_title(a.scene.sand) for a in audits], [a.name.replace("_", " ") for a in audits]
    where = f" on {sands[0]}" if len(set(sands)) == 1 else ""
    labels = [label if where else f"{label}, {sand}" for label, sand in zip(labels, sands, strict=True)]
    rows, limit = np.arange(len(labels)), 100.0 * audits[0].tolerance
    figure = style.new_figure(style.PAGE, 1.0 + 0.2 * len(labels))
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


@style.styled()
def calibration(found: Any) -> Figure:
    """Force over the map's force at zeta 1 of measurements (`footopt.studies.calibration.Calibration`)."""
    figure = style.new_figure(style.COLUMN, 2.5)
    axes = figure.subplots()
    axes.axhspan(found.zeta.low, found.zeta.high, color=style.PALE, lw=0, label="95 % interval of $\\zeta$")
    axes.axhline(found.zeta.value, color="black", lw=0.8, label="linear in depth, as footopt has it")
    for i, name in enumerate(found.set_ups):
        own = found.set_up == name
        looks = style.marker(i) | {
            "ms": 3,
            "alpha": 0.7,
            "label": name if len(found.set_ups) > 1 else "measured",
        }
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
