"""The ground of a scene: sand, its layers and patches, and the pull of gravity on a slope."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.patches import Rectangle

from footopt.report.scenery import pull, strips
from footopt.report.style import SAND, SURFACE, Axes
from footopt.walk import Scene
from footopt.walk.prints import MovedSand


def draw_sand(axes: Axes, left: float, right: float, low: float) -> None:
    """Sand below z = 0, m."""
    axes.add_patch(Rectangle((left, low), right - left, -low, color=SAND, lw=0, zorder=0))
    axes.axhline(0.0, color=SURFACE, lw=0.8, zorder=1)


def draw_surface(axes: Axes, sand: MovedSand | None, i: int) -> list[Any]:
    """Prints and rims of sand that feet have moved, at its i-th sample; returns what they are drawn with."""
    if sand is None:
        return []
    x, z = sand.x, sand.height[i]
    return [
        axes.fill_between(x, np.minimum(z, 0.0), 0.0, fc="white", lw=0, zorder=1.1),
        axes.fill_between(x, 0.0, np.maximum(z, 0.0), fc=SAND, lw=0, zorder=1.1),
        *axes.plot(x, z, color=SURFACE, lw=0.8, zorder=1.2),
    ]


def draw_ground(
    axes: Axes, scene: Scene, left: float, right: float, low: float, high: float, named: bool = True
) -> None:
    """The sand of a scene from x = left to right and down to z = low, with its layers and patches.

    Darker is stronger; numbers are strengths over the scene's sand. On a slope the axes are along the
    plane and normal to it, and an arrow below z = high shows where gravity pulls.
    """
    draw_sand(axes, left, right, low)
    for strip in strips(scene):
        a, b = max(strip.begin, left), min(strip.end, right)
        top, bottom = strip.top, max(strip.bottom, low)
        if a >= b or bottom >= top:
            continue
        box = Rectangle((a, bottom), b - a, top - bottom, fc=strip.colour, ec=SURFACE, lw=0.4, zorder=0.5)
        axes.add_patch(box)
        place = (a, bottom) if strip.kind == "patch" else (b, bottom)
        side = 1 if strip.kind == "patch" else -1
        if named:
            axes.annotate(strip.label, place, (3 * side, 2), textcoords="offset points", va="bottom",
                          ha="left" if side > 0 else "right", fontsize="small", zorder=1.5)  # fmt: skip
    if (found := pull(scene)) is not None:
        size, x = 0.22 * (high - low), right - 0.1 * (right - left)
        tip = x + size * found.x, high + size * found.z
        axes.annotate("", tip, (x, high), arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.0})
        if named:
            axes.text(right, high, found.label, ha="right", va="bottom")
