"""Figures of studies: accuracy, calibrate, transfer, validate, and those of the paper with their captions."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from footopt.files.feet import MM
from footopt.foot import SHAPES
from footopt.gait import Gait
from footopt.report import style
from footopt.report.figures.scenes import contour, contours, draw_angles, draw_path
from footopt.report.figures.walks import com, forces, power_work, step
from footopt.report.numbers import title
from footopt.walk import Walk, Walker

WORST = "error of the worst objective (%),\nnot exceeded by 95 % of the feet"
SHOWN = (2.5, 97.5)  # %, of measurements: those that are furthest off are shallow, and noise

NAMES = {"alpha_x": r"$\alpha_x$", "alpha_z": r"$\alpha_z$", "zeta": r"$\zeta$"}
VERDICTS = {"agrees": (style.BEST, "o"), "differs": ("#000000", "X"), "undecided": (style.FLAT, "s")}
DATA: dict[str, Any] = {"color": "black", "ls": "", "marker": "o", "elinewidth": 0.8}
MEASURED = "measured; all ± 2 u"
MANY = 10  # points that have no rows of their own
FLOOR = 1.0  # %, the least that the overview shows


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
    axes.margins(x=0.12)  # for the names of presets
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
    low, high = low - 0.2 * (high - low), high + 0.2 * (high - low)
    axes.set_ylim(low, high)
    if outside := np.sum((found.local < low) | (found.local > high)):
        axes.set_title(f"{outside} of {len(found.local)} outside of these axes", loc="right")
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


def law_name(law: Sequence[str]) -> str:
    """A set of effects in words."""
    return " + ".join(name.replace("_", " ") for name in law) or "plain law"


def axis_name(c: Any) -> str:
    """A quantity with its unit."""
    unit = {"1": "", "N/cm3": " (N/cm³)"}.get(c.unit, f" ({c.unit})")
    return f"{NAMES.get(c.quantity, c.quantity)}{unit}"


@style.styled()
def experiment(found: Sequence[Any], x: str = "") -> Figure:
    """Each `studies.validate.Comparison` of an experiment: data, prediction, and 2 standard uncertainties.

    Numbered points are on the axis `x`, points with names in a row each; many of these are drawn as the
    prediction against the measurement.
    """
    quantities = list(dict.fromkeys(c.quantity for c in found))
    laws = list(dict.fromkeys(c.law for c in found))
    points = found[0].points
    numbers = all(isinstance(point, (int, float)) for point in points)
    draw = _against_x if numbers else _by_name if len(points) < MANY else _parity
    height = 0.7 + 0.2 * len(points) * (1 + len(laws)) if draw is _by_name else 2.5
    figure = style.new_figure(min(style.PAGE, max(4.6, 2.9 * len(quantities))), height)
    axes = figure.subplots(1, len(quantities), squeeze=False)[0]
    for ax, quantity in zip(axes, quantities, strict=True):
        own = [c for c in found if c.quantity == quantity]
        draw(ax, own, [style.COLOURS[laws.index(c.law)] for c in own])
        ax.grid()
        if draw is _against_x:
            ax.set_xlabel(x)
    style.legend_above(figure)
    return figure


def _against_x(ax: style.Axes, own: Sequence[Any], colours: Sequence[str]) -> None:
    """Lines with bands, and the data."""
    for c, colour, dashes in zip(own, colours, style.DASHES, strict=False):
        ax.plot(c.points, c.simulated, color=colour, ls=dashes, label=law_name(c.law))
        low, high = c.simulated - c.spread, c.simulated + c.spread
        ax.fill_between(c.points, low, high, color=colour, alpha=0.15, lw=0)
    ax.errorbar(c.points, c.measured, c.bar, **DATA, label=MEASURED)
    ax.set_ylabel(axis_name(c))


def _by_name(ax: style.Axes, own: Sequence[Any], colours: Sequence[str]) -> None:
    """A row for each point, in it the data and each law."""
    rows, gap = np.arange(len(own[0].points)), 0.8 / (len(own) + 1)
    for i, (c, colour) in enumerate(zip(own, colours, strict=True), start=1):
        look = DATA | {"color": colour, "marker": style.MARKERS[i]}
        ax.errorbar(c.simulated, rows + gap * i, xerr=c.spread, **look, label=law_name(c.law))
    ax.errorbar(c.measured, rows, xerr=c.bar, **DATA, label=MEASURED)
    ax.set_yticks(rows + 0.5 * gap * len(own) if any(c.points) else [], c.points if any(c.points) else [])
    ax.tick_params(axis="y", length=0)
    ax.set(xlabel=axis_name(c), ylim=(rows[-1] + 1.0 - gap, -gap))


def _parity(ax: style.Axes, own: Sequence[Any], colours: Sequence[str]) -> None:
    """Prediction against measurement, with the band in which they agree."""
    for i, (c, colour) in enumerate(zip(own, colours, strict=True)):
        size = {"mfc": "none", "mew": 0.8, "ms": 5.0} if i else {"ms": 3.5}  # one often lies on the other
        look = style.marker(i) | {"color": colour} | size
        ax.plot(c.measured, c.simulated, **look, label=law_name(c.law))
    c = own[0]
    every = np.concatenate([c.measured, *(other.simulated for other in own)])
    ends = np.array([every.min(), every.max()])
    ax.fill_between(ends, ends - c.band, ends + c.band, color=style.PALE, lw=0, zorder=0)
    limits = ends[0] - c.band, ends[1] + c.band
    ax.set(xlim=limits, ylim=limits, box_aspect=1.0)
    ax.locator_params(nbins=5)
    ax.plot(ends, ends, color="black", lw=0.8, label="equal, with 2 u")
    ax.set(xlabel=f"measured {axis_name(c)}", ylabel=f"predicted {axis_name(c)}")


@style.styled()
def overview(found: Sequence[Any], titles: Mapping[str, str]) -> Figure:
    """A row for each comparison: its error over the data's scale, and what it could have resolved."""
    begins = np.array([i == 0 or found[i - 1].experiment != c.experiment for i, c in enumerate(found)])
    rows = np.arange(len(found)) + 1.15 * np.cumsum(begins)  # room for the experiments' titles
    figure = style.new_figure(style.PAGE, 0.7 + 0.165 * rows[-1])
    ax = figure.subplots()
    ax.set_xscale("log")
    ax.barh(rows, [axis_percent(c.band, c) for c in found], height=0.7, color="0.87", label="2 u")
    for verdict, (colour, shape) in VERDICTS.items():
        own = [i for i, c in enumerate(found) if c.verdict == verdict]
        size = [axis_percent(found[i].size, found[i]) for i in own]
        ax.plot(size, rows[own], shape, color=colour, ms=5.5, mew=0, clip_on=False, label=verdict)
    for row, c in zip(rows[begins], (c for c, new in zip(found, begins, strict=True) if new), strict=True):
        ax.text(FLOOR, row - 1.0, f" {titles[c.experiment]}", va="center", weight="bold")
    ax.set_xlim(FLOOR, 1200.0)
    ticks = [1, 3, 10, 30, 100, 300, 1000]
    ax.set_xticks(ticks, [f"≤ {FLOOR:g} %", *(f"{tick} %" for tick in ticks[1:])])
    ax.set_xlabel("error (rms of S − D) over the scale of the data")
    ax.set_yticks(rows, [f"{NAMES.get(c.quantity, c.quantity)}, {law_name(c.law)}" for c in found])
    ax.set_ylim(rows[-1] + 0.7, rows[0] - 1.7)
    ax.tick_params(axis="y", length=0)
    ax.tick_params(axis="x", which="minor", length=0)
    ax.grid(axis="x")
    style.legend_above(figure)
    return figure


def axis_percent(value: float, c: Any) -> float:
    """A part of the scale in percent, where a logarithmic axis can show it."""
    return max(100.0 * value / float(c.scale), FLOOR)


@style.styled()
def _gait(shown: Gait, walker: Walker) -> Figure:
    """Fig. 2b: the joint angles over a stride, and the ankle's path around the hip."""
    figure = style.new_figure(style.PAGE, 2.5)
    angles, path = figure.subplots(1, 2)
    draw_angles(angles, shown)
    draw_path(path, shown, walker)
    style.legend_above(figure)
    return figure


def all_figures(walks: Mapping[str, Walk]) -> dict[str, tuple[Figure, str]]:
    """The paper's figures and their captions, by file name.

    They show walks of the five shapes and of each sand's best foot by their names, and "crossed", that of the
    foot for regular sand on hard sand.
    """
    by_shape = {title(name): walks[name] for name in SHAPES}
    by_sand = {sand: walks[sand] for sand in style.SANDS}
    crossed, hard = walks["crossed"], walks["hard"]
    shapes = {name: walk.foot for name, walk in by_shape.items()}
    feet = {f"{sand} (hollow {MM * w.foot.hollow:.1f} mm)": w.foot for sand, w in by_sand.items()}
    joints = _gait(crossed.scene.gait, crossed.scene.walker)
    waypoints = contour(hard.foot)
    return {
        "fig2b_gait": (joints, "Joint angles over a stride, and the ankle's path (figure 2b)."),
        "fig3_shapes": (contours(shapes), "The five shapes, all of one length (figure 3)."),
        "fig4a_shapes_states": (com(by_shape), "Position and velocity of the COM by shape (figure 4a)."),
        "fig4b_shapes_power_work": (power_work(by_shape), "Power and work by shape (figure 4b)."),
        "fig5_waypoints": (waypoints, "The waypoints of a sole, their box, and its spline (figure 5)."),
        "fig6_contours": (contours(feet), "The best soles for soft, regular and hard sand (figure 6)."),
        "fig7a_step": (step(hard), "A step on hard sand with its best foot (figure 7)."),
        "fig7b_step": (step(crossed), "The same with the best foot for regular sand (figure 7)."),
        "fig8a_sands_states": (com(by_sand), "Position and velocity of the COM by sand (figure 8a)."),
        "fig8b_sands_forces": (forces(by_sand), "Force on each foot by sand (figure 8b)."),
        "fig8c_sands_power_work": (power_work(by_sand), "Power and work by sand (figure 8c)."),
    }
