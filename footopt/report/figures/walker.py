"""The walker on the sand: how it stands before it walks, and the walk as a row of pictures with forces."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.effects import Layers, Patches
from footopt.gait.gait import LEFT, RIGHT
from footopt.report.body import Body, body, forces_along, legs
from footopt.report.figures.ground import draw_ground
from footopt.report.figures.traces import walk_label
from footopt.report.style import GREY, PAGE, PALE, SIDES, Axes, as_text, legend_entry, message
from footopt.walk import Scene, Walk
from footopt.walk.phases import STANDS

Array = NDArray[np.float64]

POSES = 9  # of the walker in the picture of a walk
ARROW = 0.2  # of the picture's height: an arrow of `round_newtons`


def draw_walk(axes: Axes, walk: Walk) -> None:
    """The walker at equal times, the path of the COM, and the force of the sand on each foot."""
    axes.set(xlabel="$x$ (m)", ylabel="$z$ (m)")
    if len(walk.t) == 0:
        axes.tick_params(bottom=False, labelbottom=False)
        message(axes, f"the walk failed: {walk.reason}, before its first step of time")
        return
    begin = min(max(walk.scene.gait.start, walk.t[0]), walk.t[-1])
    index = np.unique(np.searchsorted(walk.t, np.linspace(begin, walk.t[-1], POSES)))
    placed = body(walk, walk.t[index])
    left, right, low, high = bounds(placed)
    draw_ground(axes, walk.scene, left, right, low, 0.9 * high)
    axes.plot(*walk.com.T, color="black", lw=0.8, label="COM", zorder=3.5)
    for i in range(len(index)):
        draw_body(axes, placed, i)
    at, force = (part.reshape(-1, 2) for part in forces_along(walk, index).resultant())
    draw_resultants(axes, at, force, ARROW * high / round_newtons(walk))
    label_arrows(axes, walk, high)
    axes.set(xlim=(left, right), ylim=(low, high), aspect="equal")
    step = f", every {walk.t[index[1]] - walk.t[index[0]]:.2g} s" if len(index) > 1 else ""
    title = walk_label(f"{walk.foot.name} on {walk.scene.sand.name} sand{step}", walk)
    axes.set_title(title)


def draw_scene(axes: Axes, scene: Scene) -> None:
    """The walker as it stands before the first step, and the ground that it will walk on."""
    walker = scene.walker
    joints = legs(scene, [0.0], np.zeros((1, 2)))[0]
    joints = joints - [0.0, joints[..., 1].min()]
    height = float(joints[..., 1].max())
    deep = [effect.depths[-1] for effect in scene.effects if isinstance(effect, Layers)]
    far = [end for effect in scene.effects if isinstance(effect, Patches) for end in effect.ends]
    left, right = -0.5 * height, max([1.7 * height, *(end + 0.15 for end in far)])
    low = -max([0.2 * height, *(2.0 * d for d in deep)])
    draw_ground(axes, scene, left, right, low, 0.9 * height)
    for (side, colour), leg in zip(SIDES, joints, strict=True):
        axes.plot(*leg.T, color=colour, lw=3, solid_capstyle="round", marker="o", mfc="black", mec="black",
                  ms=3, label=f"{side} leg", zorder=3)  # fmt: skip
    axes.plot(*joints[0, 0], "o", color="black", ms=8, zorder=4, label=f"COM, {walker.mass:g} kg")
    axes.set(xlim=(left, right), ylim=(low, 1.12 * height), aspect="equal")
    axes.set(xlabel="$x$ (m)", ylabel="$z$ (m)")
    axes.set_title(f"{as_text(scene.sand.name)} sand ($\\zeta$ = {scene.sand.zeta:g})")


def draw_body(axes: Axes, placed: Body, i: int) -> list[Any]:
    """The walker at the i-th instant, the right leg behind the left; returns what it is drawn with."""
    drawn = [*draw_leg(axes, placed, i, RIGHT, 2.0), *draw_leg(axes, placed, i, LEFT, 3.0)]
    return [*drawn, *axes.plot(*placed.hip[i], "o", color="black", ms=6, zorder=4)]


def draw_leg(axes: Axes, placed: Body, i: int, foot: int, order: float = 2.0) -> list[Any]:
    """One leg with its foot at the i-th instant; returns what it is drawn with."""
    colour = SIDES[foot][1]
    return [
        *axes.fill(*placed.outline[i, foot].T, fc=PALE, ec=GREY, lw=0.4, zorder=order),
        *axes.plot(*placed.legs[i, foot].T, color=colour, lw=2, alpha=0.75, marker="o", ms=2.5,
                   mfc="black", mec="black", mew=0, solid_capstyle="round", zorder=order),
        *axes.plot(*placed.sole[i, foot].T, color=colour, lw=1.4, zorder=order),
    ]  # fmt: skip


def draw_resultants(axes: Axes, at: Array, force: Array, metres: float) -> Any:
    """Arrows of forces (m, 2), N, that begin at places (m, 2), m, with so many metres per newton.

    Returns what they are drawn with. A foot without contact has none.
    """
    seen = np.isfinite(at).all(axis=-1) & (np.linalg.norm(force, axis=-1) > STANDS)
    return draw_arrows(axes, at[seen], force[seen], metres, width=0.012, color="black", zorder=5)


def draw_arrows(axes: Axes, at: Array, force: Array, metres: float, **looks: Any) -> Any:
    """Arrows (m, 2) at places (m, 2), in m; so many metres per newton."""
    return axes.quiver(
        *at.T, *force.T, angles="xy", scale_units="xy", scale=1.0 / metres, units="inches",
        headwidth=3.6, headlength=4.5, headaxislength=4, minlength=0, **looks,
    )  # fmt: skip


def label_arrows(axes: Axes, walk: Walk, high: float) -> None:
    """Entries of the legend for both legs and the arrows of a picture that is so many metres high."""
    text = f"force, {ARROW * high:.2g} m for {round_newtons(walk):g} N"
    legend_entry(axes, text, color="black", ls="", marker=r"$\uparrow$", ms=8)
    for side, colour in SIDES:
        legend_entry(axes, f"{side} leg", color=colour, lw=2)


def round_newtons(walk: Walk) -> float:
    """The force, N, that is drawn `ARROW` of the picture's height long: half of the walk's largest."""
    return round_down(max(0.5 * float(np.abs(walk.force).max()), 1e-9))


def round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(m for m in (1, 2, 5) if m * power <= value * (1 + 1e-12)))


def bounds(placed: Body) -> tuple[float, float, float, float]:
    """Left, right, low and high around all that is drawn, m."""
    points = np.concatenate([placed.legs.reshape(-1, 2), placed.outline.reshape(-1, 2)])
    (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
    tall = high - min(low, 0.0)
    return left - 0.1 * tall, right + 0.1 * tall, min(low, 0.0) - 0.08 * tall, high + 0.08 * tall


def walk_height(walk: Walk) -> float:
    """Of a page-wide figure with a walk at equal scales, inches."""
    if len(walk.t) == 0:
        return 1.0
    left, right, low, high = bounds(body(walk, walk.t[[0, -1]]))
    return float(np.clip((PAGE - 0.6) * (high - low) / (right - left), 1.5, 4.5) + 0.9)
