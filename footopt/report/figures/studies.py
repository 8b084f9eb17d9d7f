"""Figures of the studies accuracy (error against time), calibrate (zeta by depth) and transfer (losses)."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from footopt.report import style

WORST = "error of the worst objective (%),\nnot exceeded by 95 % of the feet"
SHOWN = (2.5, 97.5)  # %, of measurements: those that are furthest off are shallow, and noise


@style.styled()
def work_precision(settings: Sequence[Any], presets: Sequence[Any]) -> Figure:
    """Error against time of measurements (`footopt.studies.accuracy.Measurement`), a line for each method."""
    figure = style.new_figure(style.PAGE, 3.6)
    axes = figure.subplots()
    for i, method in enumerate(dict.fromkeys(m.method for m in settings)):
        own = [m for m in settings if m.method == method]
        looks = style.marker(i) | {"ls": "-", "lw": 1.0, "ms": 4, "label": method.replace("_", " ")}
        if method == presets[0].accuracy.stepper:
            looks |= {"color": style.BEST, "lw": 2.0, "label": f"{looks['label']}, the default"}
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
def calibration(found: Any) -> Figure:
    """Force over the map's force at zeta 1 of measurements (`footopt.studies.calibrate.Calibration`)."""
    figure = style.new_figure(style.COLUMN, 2.5)
    axes = figure.subplots()
    axes.axhline(found.zeta.value, color="black", lw=0.8, label="$\\zeta$ of the sand")
    axes.axhspan(found.zeta.low, found.zeta.high, color="0.85", lw=0, label="its 95 % interval", zorder=0)
    for i, name in enumerate(dict.fromkeys(found.set_up.tolist())):
        own = found.set_up == name
        looks = style.marker(i) | {"ms": 3, "alpha": 0.7, "label": name}
        axes.plot(1e3 * found.depth[own], found.local[own], **looks)
    axes.set(xlabel="depth (mm)", ylabel=r"local $\zeta$: force over the map's", xlim=(0.0, None))
    ends = [*np.percentile(found.local, SHOWN), found.zeta.low, found.zeta.high]
    low, high = min(ends), max(ends)
    axes.set_ylim(low - 0.2 * (high - low), high + 0.2 * (high - low))
    axes.grid()
    style.legend_above(figure)
    return figure


@style.styled()
def transfer(found: Sequence[Any], objective: str) -> Figure:
    """What feet lose on both simulators (`footopt.studies.transfer.Comparison`), bars for each sand."""
    figure = style.new_figure(style.PAGE, 2.6)
    colours = {"flat": style.FLAT, "walker": style.DESIGNS, "robot": style.BEST}
    places = np.arange(len(found))
    for axes, side in zip(figure.subplots(1, 2, sharey=True), found[0].values, strict=True):
        for i, foot in enumerate(found[0].feet):
            losses = [100.0 * t.losses[side][foot] for t in found]
            looks = {"color": colours[foot], "label": "flat" if foot == "flat" else f"designed on the {foot}"}
            bars = axes.bar(places + 0.27 * (i - 1), losses, 0.25, **looks)
            axes.bar_label(bars, fmt="{:.0f}", fontsize=7, padding=1)
        sands = [f"{t.sand.name}\n$\\tau$ = {t.tau:.2f}" for t in found]
        axes.set_xticks(places, sands)
        axes.set_title(f"walked on the {side}")
        axes.tick_params(bottom=False)
    name = "$J_W$" if objective == "efficiency" else objective.replace("_", " ")
    figure.axes[0].set_ylabel(f"loss of {name} against\nthe better design (%)")
    style.legend_above(figure)
    return figure
