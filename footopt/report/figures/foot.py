"""Figures of soles: in their box with hull and hollow, several in one frame, and as a workshop's drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from footopt.files.drawings import MM
from footopt.files.outline import body_outline
from footopt.foot import Foot, lower_hull
from footopt.report.style import (
    BEST,
    COLUMN,
    GREY,
    PAGE,
    PALE,
    Axes,
    as_text,
    legend_above,
    look,
    new_figure,
    styled,
)

Array = NDArray[np.float64]
Point = tuple[float, float]

ANKLE: dict[str, Any] = {"marker": "+", "ls": "", "color": "black", "ms": 6, "mew": 1}
HOLLOW = 0.05  # mm; a smaller one is called none


@styled
def contour(foot: Foot) -> Figure:
    """The sole in its box with its waypoints, its lower convex hull and the depth of its hollow."""
    figure = new_figure(COLUMN, foot_height(foot))
    draw_contour(figure.subplots(), foot)
    return figure


@styled
def contours(feet: Mapping[str, Foot]) -> Figure:
    """Several soles in one frame, by label."""
    figure = new_figure(PAGE, _height(np.concatenate([f.contour for f in feet.values()]), PAGE))
    axes = figure.subplots()
    for i, (label, foot) in enumerate(feet.items()):
        axes.plot(*(MM * foot.contour).T, **look(label, i), label=as_text(label))
    _label_axes(axes)
    legend_above(figure)
    return figure


@styled
def drawing(foot: Foot, block: Sequence[float] | None = None) -> Figure:
    """The outline that a workshop makes, with its dimensions in mm.

    Parameters
    ----------
    foot : Foot
        What is made.
    block : (float, float), m, optional
        Length and height of a mounting block above the foot, see `footopt.files.outline.body_outline`.
    """
    outline = MM * body_outline(foot, block)
    (left, low), (right, high) = outline.min(axis=0), outline.max(axis=0)
    gap = 0.03 * (right - left)
    x, z = (left - 4 * gap, right + 4 * gap), (low - 2 * gap, high + (3 * gap if block is not None else gap))
    figure = new_figure(PAGE, min(0.8 + 6.3 * (z[1] - z[0]) / (x[1] - x[0]), 6.0))
    axes = figure.subplots()
    axes.add_patch(Polygon(outline, closed=True, fc=PALE, ec="black", lw=0.8))
    axes.plot(*(MM * foot.contour).T, color=BEST, zorder=3)
    axes.plot(*(MM * np.array(foot.ankle)), **ANKLE, zorder=4)
    _dimension(axes, (left, low - gap), (right, low - gap))
    _dimension(axes, (right + gap, low), (right + gap, high))
    if block is not None:
        (length, height), middle = MM * np.array(block), MM * foot.ankle[0]
        ends = middle - length / 2, middle + length / 2
        _dimension(axes, (ends[0], high + gap), (ends[1], high + gap))
        _dimension(axes, (ends[0] - 3 * gap, high - height), (ends[0] - 3 * gap, high))
    axes.set_title(f"{MM * foot.width:.4g} mm wide", loc="left")
    _label_axes(axes)
    axes.update_datalim(np.transpose([x, z]))
    axes.margins(0.0)
    return figure


def draw_contour(axes: Axes, foot: Foot) -> None:
    """A sole in the foot frame, mm; see `contour`."""
    near = {"textcoords": "offset points", "zorder": 6}
    if foot.space is not None:
        length, height = MM * foot.space.L, MM * foot.space.H
        axes.add_patch(Rectangle((-length, -height), 2 * length, height, color=PALE, lw=0))
        axes.annotate("box", (-length, 0.0), (0, 2), **near, color="0.4")
    axes.plot(*(MM * foot.contour).T, color=BEST, label="_sole", zorder=3)
    if foot.space is not None and foot.k is not None:
        points = foot.space.x, foot.space.heights(foot.k)[0]
        axes.plot(*(MM * np.array(points)), "o", color=BEST, mfc="white", label="_waypoint", zorder=4)
    ankle = MM * np.array(foot.ankle)
    axes.plot(*ankle, **ANKLE, zorder=5)
    axes.annotate("ankle", ankle, (4, 3), **near)
    hull, x, low, high = lower_hull(foot.contour)
    depth = MM * foot.hollow
    if depth >= HOLLOW:
        axes.plot(*(MM * hull).T, ":", color="black", label="_lower hull", zorder=2)
        _measure(axes, (MM * x, MM * high), (MM * x, MM * low), "black", min(0.6 * depth, 10.0))
        # under the hull, where there is never a sole nor an ankle
        axes.annotate(f"hollow {depth:.1f} mm", (MM * x, MM * low), (0, -8), **near, ha="center", va="top")
    circles = ["circles: waypoints"] * (foot.k is not None)
    axes.set_title("; ".join([*circles, "dotted: lower hull" if depth >= HOLLOW else "no hollow"]))
    axes.update_datalim(MM * _points(foot))
    _label_axes(axes)


def foot_height(foot: Foot) -> float:
    """Height of a column-wide figure with a sole, its box and its ankle, inches."""
    return _height(_points(foot), COLUMN)


def _points(foot: Foot) -> Array:
    """What a picture of a sole has room for: the sole, its box, its ankle, and words above and below."""
    boxes = [] if foot.space is None else [[[foot.space.L, 0.0], [-foot.space.L, -foot.space.H]]]
    points: Array = np.concatenate([foot.contour, [foot.ankle], *boxes])
    (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
    room = 0.04 * (right - left)  # of a line of words; below, a gap is above it
    return np.concatenate([points, [[left, low - 2.2 * room], [left, high + room]]])


def _height(points: Array, width: float) -> float:
    """Height of a figure so wide (inches) whose axes, at equal scales, hold some points, inches."""
    wide, high = np.ptp(points, axis=0)
    # beside the axes are labels and ticks; within them the margins of `_label_axes`
    return float(min(0.6 + (width - 0.65) * 1.4 / 1.1 * max(high, 0.12 * wide) / wide, 6.0))


def _label_axes(axes: Axes) -> None:
    axes.set(xlabel="$x_p$ (mm), to the toe", ylabel="$z_p$ (mm)")
    axes.set_aspect("equal", adjustable="datalim")  # a box that shrinks loses its labels in the layout
    axes.margins(0.05, 0.2)


def _measure(axes: Axes, start: Point, end: Point, colour: str, heads: float = 10.0) -> None:
    """An arrow with two heads between two points."""
    looks = {"arrowstyle": "<->", "color": colour, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    looks["mutation_scale"] = heads
    axes.annotate("", end, start, arrowprops=looks, zorder=4)


def _dimension(axes: Axes, start: Point, end: Point) -> None:
    """An arrow between two points, mm, along x or upwards, and its length."""
    _measure(axes, start, end, GREY)
    along = start[1] == end[1]
    place = {"xytext": (0, 1), "ha": "center", "va": "bottom"} if along else {
        "xytext": (3, 0), "ha": "left", "va": "center"
    }  # fmt: skip
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    length = max(end[0] - start[0], end[1] - start[1])
    axes.annotate(f"{length:.4g}", middle, textcoords="offset points", **place)
