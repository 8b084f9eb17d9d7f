"""Figures of what walks are made of: soles, the gait with the strides that it was fitted to, and the sand."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from footopt.files.feet import MM
from footopt.files.strides import Strides
from footopt.foot import Foot, lower_hull
from footopt.gait import Gait, ankle
from footopt.report import style
from footopt.sand import Sand
from footopt.sand.law import PER_CM3, alpha
from footopt.walk import Walker

HOLLOW = 0.05  # mm; a smaller one is called none
SIGNS = {"thigh": "forward", "knee": "flexed", "foot": "toe up"}


@style.styled()
def contour(foot: Foot) -> Figure:
    """The sole in its box with its waypoints, its lower convex hull and the depth of its hollow."""
    figure = style.new_figure(style.COLUMN, style.COLUMN, style.Margins(0.24))
    draw_contour(figure.subplots(), foot)
    style.fit_height(figure, figure.axes)
    return figure


@style.styled()
def contours(feet: Mapping[str, Foot]) -> Figure:
    """Several soles in one frame, by label."""
    figure = style.new_figure(style.PAGE, style.PAGE)
    axes = figure.subplots()
    for i, (label, foot) in enumerate(feet.items()):
        axes.plot(*(MM * foot.contour).T, **style.look(label, i), label=style.as_text(label))
    _label_axes(axes)
    style.legend_above(figure)
    style.fit_height(figure, [axes])
    return figure


def draw_contour(axes: style.Axes, foot: Foot) -> None:
    """A sole in the foot frame, mm; see `contour`."""
    near = {"textcoords": "offset points", "zorder": 6}
    if foot.space is not None:
        length, height = MM * foot.space.L, MM * foot.space.H
        axes.add_patch(Rectangle((-length, -height), 2 * length, height, color=style.PALE, lw=0))
        axes.annotate("box", (-length, 0.0), (0, 2), **near, color="0.4")
    colour = style.look(foot.name.partition(" ")[0], 0)["color"]  # "best of memetic" is the best
    axes.plot(*(MM * foot.contour).T, color=colour, label="_sole", zorder=3)
    if foot.space is not None and foot.k is not None:
        points = foot.space.x, foot.space.heights(foot.k)[0]
        axes.plot(*(MM * np.array(points)), "o", color=colour, mfc="white", label="_waypoint", zorder=4)
    ankle = MM * np.array(foot.ankle)
    axes.plot(*ankle, "+", color="black", ms=6, mew=1, zorder=5)
    axes.annotate("ankle", ankle, (4, 3), **near)
    hull, i = lower_hull(foot.contour)
    (x, high), low = foot.contour[i], hull[i, 1]
    depth = MM * foot.hollow
    if depth >= HOLLOW:
        axes.plot(*(MM * hull).T, ":", color="black", label="_lower hull", zorder=2)
        shape = "<->" if depth > 5.0 else "-"  # two heads need room
        arrow = {"arrowstyle": shape, "lw": 0.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 6}
        axes.annotate("", (MM * x, MM * high), (MM * x, MM * low), arrowprops=arrow)
        # below all of the hull, where there is never a sole nor an ankle
        ends = np.quantile(foot.contour[:, 0], (0.25, 0.75))
        side = ("left", "center", "right")[int(np.digitize(x, ends))]  # words stay within the axes
        axes.annotate(
            f"hollow {depth:.1f} mm", (MM * x, MM * hull[:, 1].min()), (0, -6), **near, ha=side, va="top"
        )
    circles = ["circles: waypoints"] * (foot.k is not None)
    axes.set_title("; ".join([*circles, "dotted: lower hull" if depth >= HOLLOW else "no hollow"]))
    _label_axes(axes, 0.09, 0.06)  # for words


def _label_axes(axes: style.Axes, below: float = 0.03, above: float = 0.03) -> None:
    """Label axes in mm with equal scales, with room below and above what is drawn, as parts of the width."""
    axes.set(xlabel="$x_p$ (mm), to the toe", ylabel="$z_p$ (mm)", aspect="equal")
    (low, high), wide = axes.get_ylim(), np.ptp(axes.get_xlim())
    axes.set_ylim(low - below * wide, high + above * wide)


@style.styled()
def gait_fit(strides: Strides, gait: Gait) -> Figure:
    """A row for each joint over one stride: every stride found, their mean, the fitted series."""
    figure = style.new_figure(style.COLUMN, 0.6 + 1.15 * len(strides.curves))
    rows = figure.subplots(len(strides.curves), sharex=True, squeeze=False)[:, 0]
    phase, dense, residual = 100.0 * strides.phase, np.linspace(0.0, 1.0, 401), dict(gait.residual)
    for axes, (joint, curves) in zip(rows, strides.curves.items(), strict=True):
        if len(curves) > 1:
            axes.plot(phase, curves.T, color=style.GREY, lw=0.4)[0].set_label("strides")
        axes.plot(phase, curves.mean(axis=0), color=style.COLOURS[0], label="mean")
        series = np.degrees(getattr(gait, joint).at(dense)[0])
        axes.plot(100.0 * dense, series, "--", color=style.COLOURS[1], label="fit")
        axes.set_ylabel(f"{joint} (deg), {SIGNS[joint]}")
        axes.set_title(f"misfit {residual[joint]:.2f}° rms", loc="right", pad=2)
    rows[-1].set(xlabel="stride (%), from heel strike", xlim=(0, 100))
    figure.align_ylabels(rows)
    style.legend_above(figure)
    return figure


def draw_angles(axes: style.Axes, gait: Gait) -> None:
    """Joint angles of the steady walk over a stride, deg."""
    phase = np.linspace(0.0, 1.0, 201)
    looks = zip(style.COLOURS, ("-", "--", "-."), strict=False)
    for (joint, sign), (colour, dashes) in zip(SIGNS.items(), looks, strict=True):
        if (series := getattr(gait, joint)) is not None:
            degrees = np.degrees(series.at(phase)[0])
            axes.plot(100.0 * phase, degrees, color=colour, ls=dashes, label=f"{joint}, + {sign}")
    axes.axhline(0.0, color=style.GREY, lw=0.5, zorder=0)
    axes.set(xlabel="stride (%), from heel strike", ylabel="angle (deg)", xlim=(0, 100))


def draw_path(axes: style.Axes, gait: Gait, walker: Walker | None = None) -> None:
    """The ankle's path around the hip over a stride, for a walker's legs."""
    walker = walker or Walker()
    (thigh, a), (shank, b), _ = gait.cycle(np.linspace(0.0, 1.0, 201))
    x, z, *_ = ankle(thigh, a, shank, b, walker.l1, walker.l2)
    axes.plot(x, z, color=style.COLOURS[0])
    for i in (40, 140):  # where it goes
        step = {"xy": (x[i + 3], z[i + 3]), "xytext": (x[i], z[i])}
        axes.annotate("", **step, arrowprops={"arrowstyle": "-|>", "color": style.COLOURS[0], "lw": 1.2})
    axes.plot(x[0], z[0], "o", color=style.COLOURS[0], label="heel strike")
    axes.set(xlabel="$x$ from the hip (m)", ylabel="$z$ from the hip (m)")
    axes.set_title(f"ankle, legs of {walker.l1:g} + {walker.l2:g} m", loc="left")
    axes.margins(0.08, 0.12)


def draw_stress(axes: style.Axes, sand: Sand, component: str = "alpha_z") -> None:
    """The stress per depth, zeta alpha_x or zeta alpha_z, by a plate's angle beta and its motion's, gamma."""
    angle = np.linspace(-90.0, 90.0, 181)
    gamma, beta = np.meshgrid(np.radians(angle), np.radians(angle))
    found = alpha(beta, gamma, sand.stress_map)
    values = sand.zeta * found[("alpha_x", "alpha_z").index(component)] / PER_CM3
    most = float(np.abs(values).max()) or 1.0
    shades = axes.contourf(angle, angle, values, levels=np.linspace(-most, most, 42), cmap="RdBu_r")
    lines = axes.contour(angle, angle, values, levels=8, colors="black", linewidths=0.5)
    axes.clabel(lines, fontsize="small")
    axes.set(xlabel=r"$\gamma$ (deg): motion, + down", ylabel=r"$\beta$ (deg): plate, + toe up")
    axes.set(xticks=range(-90, 91, 45), yticks=range(-90, 91, 45), aspect="equal")
    name = rf"\alpha_{component[-1]}"
    axes.set_title(rf"$\zeta{name}$ (N/cm³), {style.as_text(sand.name)} sand")
    axes.figure.colorbar(shades, ax=axes, shrink=0.9, ticks=MaxNLocator(6))
