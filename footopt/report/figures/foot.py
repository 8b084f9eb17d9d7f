"""Figures of soles: in their box with hull and hollow, and several in one frame."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from footopt.files.feet import MM
from footopt.foot import Foot, lower_hull
from footopt.report import style
from footopt.report.style import Axes

HOLLOW = 0.05  # mm; a smaller one is called none


@style.styled()
def contour(foot: Foot) -> Figure:
    """The sole in its box with its waypoints, its lower convex hull and the depth of its hollow."""
    figure = style.new_figure(style.COLUMN, style.COLUMN)
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


def draw_contour(axes: Axes, foot: Foot) -> None:
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
        # under the hull, where there is never a sole nor an ankle
        axes.annotate(f"hollow {depth:.1f} mm", (MM * x, MM * low), (0, -8), **near, ha="center", va="top")
    circles = ["circles: waypoints"] * (foot.k is not None)
    axes.set_title("; ".join([*circles, "dotted: lower hull" if depth >= HOLLOW else "no hollow"]))
    _label_axes(axes, 0.09, 0.06)  # for words


def _label_axes(axes: Axes, below: float = 0.03, above: float = 0.03) -> None:
    """Label axes in mm with equal scales, with room below and above what is drawn, as parts of the width."""
    axes.set(xlabel="$x_p$ (mm), to the toe", ylabel="$z_p$ (mm)", aspect="equal")
    (low, high), wide = axes.get_ylim(), np.ptp(axes.get_xlim())
    axes.set_ylim(low - below * wide, high + above * wide)
