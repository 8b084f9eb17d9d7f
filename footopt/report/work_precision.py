"""The figure of the accuracy study: what a smaller error costs, one panel per objective."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from footopt.report.figures import COLOURS, GREY, _figure, styled
from footopt.walk import FIVE, OBJECTIVES
from footopt.walk.accuracy import Accuracy

MARKERS = "osD^vP*"


@styled
def work_precision(measured: Sequence[Any], presets: Sequence[Accuracy], default: str = "standard") -> Figure:
    """Error against ms per design and core for every setting.

    Parameters
    ----------
    measured : of `studies.accuracy.Measurement`. Those that no other beats in a panel are joined.
    presets : marked by name where they were measured; the default one larger.
    """
    figure = _figure(7.0, 4.6)
    axes = figure.subplots(2, 3, sharex=True, sharey=True)
    methods = list(dict.fromkeys(_method(m.accuracy) for m in measured))
    panels: list[tuple[str, Any]] = [
        (OBJECTIVES[name].name.replace("_", " "), lambda m, i=i: float(m.errors[:, i].max()))
        for i, name in enumerate(FIVE)
    ]
    panels.append(("worst objective", lambda m: m.error))
    marked = {m.accuracy: m for m in measured}
    for ax, (title, error) in zip(axes.flat, panels, strict=True):
        for i, method in enumerate(methods):
            points = np.array(
                [
                    (m.ms, 100 * error(m))
                    for m in measured
                    if _method(m.accuracy) == method and 0 < error(m) < 1
                ]
            ).reshape(-1, 2)
            ax.plot(
                *points.T, MARKERS[i % len(MARKERS)], color=COLOURS[i % len(COLOURS)], ms=3, mew=0, alpha=0.7
            )
        ordered = sorted((m.ms, 100 * error(m)) for m in measured if error(m) > 0)
        least = np.minimum.accumulate([e for _, e in ordered])
        front = np.array([p for p, low in zip(ordered, least, strict=True) if p[1] == low]).reshape(-1, 2)
        ax.plot(*front.T, "-", color="black", lw=0.8)
        for preset in presets:
            m = marked.get(_anonymous(preset))
            if m is None or not error(m) > 0:
                continue
            size = 9 if preset.name == default else 6
            ax.plot(m.ms, 100 * error(m), "o", mfc="none", mec="black", ms=size, mew=1.0)
            if title == "worst objective":  # once: the circles are in the same order everywhere
                ax.annotate(
                    preset.name,
                    (m.ms, 100 * error(m)),
                    textcoords="offset points",
                    xytext=(14, 14),
                    fontsize=8,
                    arrowprops={"arrowstyle": "-", "lw": 0.6},
                    bbox={"boxstyle": "square,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85},
                )
        ax.set(xscale="log", yscale="log", title=title)
        ax.grid(color="0.92", lw=0.6)
    for ax in axes[-1]:
        ax.set_xlabel("time per design and core (ms)")
    for ax in axes[:, 0]:
        ax.set_ylabel("relative error (%)")
    handles = [
        Line2D([], [], ls="", marker=MARKERS[i % len(MARKERS)], color=COLOURS[i % len(COLOURS)], ms=4)
        for i in range(len(methods))
    ]
    handles += [
        Line2D([], [], color="black", lw=0.8),
        Line2D([], [], ls="", marker="o", mfc="none", mec="black", ms=6),
    ]
    labels = [*methods, "none better in both", "preset (default larger)"]
    figure.legend(handles, labels, loc="outside upper center", ncols=4)
    figure.supxlabel(
        "error not exceeded by 95 % of the feet, largest over soft, regular and hard sand",
        fontsize=8,
        color=GREY,
    )
    return figure


def _method(accuracy: Accuracy) -> str:
    name = accuracy.stepper.replace("_", " ")
    return name if accuracy.control is None else f"{name}, step control"


def _anonymous(accuracy: Accuracy) -> Accuracy:
    return replace(accuracy, name=Accuracy().name)
