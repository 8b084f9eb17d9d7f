"""The figure of a sand: its stress on a plate by the plate's angle and its direction of motion."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from footopt.report.style import Axes, as_text
from footopt.sand import Sand
from footopt.sand.law import PER_CM3, alpha


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
