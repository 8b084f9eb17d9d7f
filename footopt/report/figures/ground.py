"""The ground of a scene: sand, its layers and patches, and the pull of gravity on a slope."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.patches import Rectangle

from footopt.effects import Layers, Patches, Slope
from footopt.report.style import SAND, STRONG_SAND, SURFACE, Axes
from footopt.walk import Scene


def draw_sand(axes: Axes, left: float, right: float, low: float) -> None:
    """Sand below z = 0, m."""
    axes.add_patch(Rectangle((left, low), right - left, -low, color=SAND, lw=0, zorder=0))
    axes.axhline(0.0, color=SURFACE, lw=0.8, zorder=1)


def draw_ground(axes: Axes, scene: Scene, left: float, right: float, low: float, high: float) -> None:
    """The sand of a scene from x = left to right and down to z = low, with its layers and patches.

    Darker is stronger; numbers are strengths over the scene's sand. On a slope the axes are along the
    plane and normal to it, and an arrow below z = high shows where gravity pulls.
    """
    draw_sand(axes, left, right, low)
    for effect in scene.effects:
        if isinstance(effect, Layers):
            ends = [-d for d in effect.depths] + [min(low, -2.0 * effect.depths[-1])]
            for top, bottom, factor in zip(ends, ends[1:], effect.factors, strict=False):
                _draw_strip(axes, (right, max(bottom, low)), (left, top), factor)
                axes.plot([left, right], [top, top], color=SURFACE, lw=0.5, ls="--", zorder=1)
        if isinstance(effect, Patches):
            for begin, end, factor in zip(effect.begins, effect.ends, effect.factors, strict=True):
                a, b = max(begin, left), min(end, right)
                if a < b:
                    _draw_strip(axes, (a, low), (b, 0.0), factor)
        if isinstance(effect, Slope):
            pull = np.array(scene.gravity) / scene.walker.g  # a unit vector, up to the sign of z
            size, x = 0.22 * (high - low), right - 0.1 * (right - left)
            tip = x + size * float(pull[0] or 0.0), high - size * float(pull[1] or 0.0)
            axes.annotate("", tip, (x, high), arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.0})
            way = "uphill" if effect.angle > 0 else "downhill"
            axes.text(right, high, f"g, {abs(effect.angle):g}° {way}", ha="right", va="bottom")


def _draw_strip(axes: Axes, corner: tuple[float, float], other: tuple[float, float], factor: float) -> None:
    """Sand of another strength between two corners, with the factor written at the first one."""
    weight = float(np.clip(0.35 * np.log10(factor), -0.7, 0.45))
    goal = np.array(to_rgb("white" if weight < 0 else STRONG_SAND))
    colour = (1.0 - abs(weight)) * np.array(to_rgb(SAND)) + abs(weight) * goal
    (x0, z0), (x1, z1) = corner, other
    towards = 1 if x1 > x0 else -1
    axes.add_patch(Rectangle(corner, x1 - x0, z1 - z0, fc=colour, ec=SURFACE, lw=0.4, zorder=0.5))
    note = {"xytext": (3 * towards, 2), "textcoords": "offset points", "va": "bottom"}
    note["ha"] = "left" if towards > 0 else "right"
    axes.annotate(f"× {factor:g}", corner, **note, fontsize="small", zorder=1.5)
