"""Figures of what a scene is made of: its gait, with the strides that it was fitted to, and its sand."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from footopt.files.strides import Strides
from footopt.gait import Gait, ankle
from footopt.report import style
from footopt.report.style import Axes, as_text
from footopt.sand import Sand
from footopt.sand.law import PER_CM3, alpha
from footopt.walk import Walker

SIGNS = {"thigh": "forward", "knee": "flexed", "foot": "toe up"}


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


def draw_angles(axes: Axes, gait: Gait) -> None:
    """Joint angles of the steady walk over a stride, deg."""
    phase = np.linspace(0.0, 1.0, 201)
    looks = zip(style.COLOURS, ("-", "--", "-."), strict=False)
    for (joint, sign), (colour, dashes) in zip(SIGNS.items(), looks, strict=True):
        if (series := getattr(gait, joint)) is not None:
            degrees = np.degrees(series.at(phase)[0])
            axes.plot(100.0 * phase, degrees, color=colour, ls=dashes, label=f"{joint}, + {sign}")
    axes.axhline(0.0, color=style.GREY, lw=0.5, zorder=0)
    axes.set(xlabel="stride (%), from heel strike", ylabel="angle (deg)", xlim=(0, 100))


def draw_path(axes: Axes, gait: Gait, walker: Walker | None = None) -> None:
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


def draw_stress(axes: Axes, sand: Sand, component: str = "alpha_z") -> None:
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
    axes.set_title(rf"$\zeta{name}$ (N/cm³), {as_text(sand.name)} sand")
    axes.figure.colorbar(shades, ax=axes, shrink=0.9, ticks=MaxNLocator(6))
