"""Figures of soles: in their box with hull and hollow, several in one frame, and as a workshop's drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from footopt.files.outline import MM, body_outline
from footopt.foot import Foot, lower_hull
from footopt.report import style
from footopt.report.style import Axes

Point = tuple[float, float]

ANKLE: dict[str, Any] = {"marker": "+", "ls": "", "color": "black", "ms": 6, "mew": 1, "zorder": 5}
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


@style.styled()
def drawing(foot: Foot, block: Sequence[float] | None = None) -> Figure:
    """The outline that a workshop makes, with its dimensions in mm.

    A mounting block above the foot has a length and a height, m; see `footopt.files.outline.body_outline`.
    """
    outline = MM * body_outline(foot, block)
    (left, low), (right, high) = outline.min(axis=0), outline.max(axis=0)
    gap = 0.03 * (right - left)
    figure = style.new_figure(style.PAGE, style.PAGE)
    axes = figure.subplots()
    axes.add_patch(Polygon(outline, closed=True, fc=style.PALE, ec="black", lw=0.8))
    axes.plot(*(MM * foot.contour).T, color=style.BEST, zorder=3)
    axes.plot(*(MM * np.array(foot.ankle)), **ANKLE)
    _dimension(axes, (left, low - gap), (right, low - gap))
    _dimension(axes, (right + gap, low), (right + gap, high))
    if block is not None:
        (length, height), middle = MM * np.array(block), MM * foot.ankle[0]
        ends = middle - length / 2, middle + length / 2
        _dimension(axes, (ends[0], high + gap), (ends[1], high + gap))
        _dimension(axes, (ends[0] - 3 * gap, high - height), (ends[0] - 3 * gap, high))
    axes.update_datalim([(left - 4 * gap, low), (right + 4 * gap, high)])
    axes.set_title(f"{MM * foot.width:.4g} mm wide", loc="left")
    _label_axes(axes)
    style.fit_height(figure, [axes])
    return figure


def draw_contour(axes: Axes, foot: Foot) -> None:
    """A sole in the foot frame, mm; see `contour`."""
    near = {"textcoords": "offset points", "zorder": 6}
    if foot.space is not None:
        length, height = MM * foot.space.L, MM * foot.space.H
        axes.add_patch(Rectangle((-length, -height), 2 * length, height, color=style.PALE, lw=0))
        axes.annotate("box", (-length, 0.0), (0, 2), **near, color="0.4")
    axes.plot(*(MM * foot.contour).T, color=style.BEST, label="_sole", zorder=3)
    if foot.space is not None and foot.k is not None:
        points = foot.space.x, foot.space.heights(foot.k)[0]
        axes.plot(*(MM * np.array(points)), "o", color=style.BEST, mfc="white", label="_waypoint", zorder=4)
    ankle = MM * np.array(foot.ankle)
    axes.plot(*ankle, **ANKLE)
    axes.annotate("ankle", ankle, (4, 3), **near)
    hull, x, low, high = lower_hull(foot.contour)
    depth = MM * foot.hollow
    if depth >= HOLLOW:
        axes.plot(*(MM * hull).T, ":", color="black", label="_lower hull", zorder=2)
        _measure(axes, (MM * x, MM * high), (MM * x, MM * low), mutation_scale=min(0.6 * depth, 10.0))
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


def _measure(axes: Axes, start: Point, end: Point, **looks: Any) -> None:
    """An arrow with two heads between two points."""
    looks = {"arrowstyle": "<->", "lw": 0.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 10.0} | looks
    axes.annotate("", end, start, arrowprops=looks, zorder=4)


def _dimension(axes: Axes, start: Point, end: Point) -> None:
    """An arrow between two points, mm, along x or upwards, and its length."""
    _measure(axes, start, end, color=style.GREY)
    upright = start[0] == end[0]
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    length = end[1] - start[1] if upright else end[0] - start[0]
    place = {"va": "center"} if upright else {"ha": "center", "va": "bottom"}
    axes.annotate(f"{length:.4g}", middle, (3, 1), textcoords="offset points", **place)
