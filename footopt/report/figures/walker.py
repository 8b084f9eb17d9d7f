"""The walker on the sand: how it stands before it walks, and the walk as a row of pictures with forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from footopt.effects import Layers, Patches
from footopt.report.body import Body, body, legs
from footopt.report.figures.traces import walk_label
from footopt.report.numbers import sand_title, title
from footopt.report.stage import Stage, View, draw_ground, draw_hip, draw_leg, ground, round_down
from footopt.report.style import PAGE, Axes, as_text, message
from footopt.walk import Scene, Walk

Array = NDArray[np.float64]

POSES = 9  # of the walker in the picture of a walk
ARROW = 0.2  # of the picture's height: an arrow of half of the walk's largest force


def draw_walk(axes: Axes, walk: Walk) -> None:
    """The walker at equal times, the path of the COM, and the force of the sand on each foot."""
    axes.set(xlabel="$x$ (m)", ylabel="$z$ (m)")
    if len(walk.t) == 0:
        axes.tick_params(bottom=False, labelbottom=False)
        message(axes, f"the walk failed: {walk.reason}, before its first step of time")
        return
    begin = min(max(walk.scene.gait.start, walk.t[0]), walk.t[-1])
    index = np.unique(np.searchsorted(walk.t, np.linspace(begin, walk.t[-1], POSES)))
    stage = Stage(walk, walk.t[index])
    view = view_of(stage)
    stage.draw_ground(axes, view)
    for i in range(len(index)):
        stage.draw_feet(axes, i, view, label=i == len(index) - 1)
    axes.plot(*walk.com.T, color="black", lw=0.8, label="path of the COM", zorder=3.5)
    axes.set(xlim=view[:2], ylim=view[2:4], aspect="equal")
    step = f", every {walk.t[index[1]] - walk.t[index[0]]:.2g} s" if len(index) > 1 else ""
    axes.set_title(walk_label(f"{title(walk.foot.name)} on {sand_title(walk.scene.sand)}{step}", walk))


def draw_scene(axes: Axes, scene: Scene) -> None:
    """The walker as it stands before the first step, and the ground that it will walk on."""
    joints = legs(scene, [0.0], np.zeros((1, 2)))[0]
    joints = joints - [0.0, joints[..., 1].min()]
    height = float(joints[..., 1].max())
    deep = [effect.depths[-1] for effect in scene.effects if isinstance(effect, Layers)]
    far = [end for effect in scene.effects if isinstance(effect, Patches) for end in effect.ends]
    right = max([1.7 * height, *(end + 0.15 for end in far)])
    low = -max([0.2 * height, *(2.0 * d for d in deep)])
    view = View(-0.5 * height, right, low, 1.12 * height, letters(right + 0.5 * height, 4.5))
    draw_ground(axes, ground(scene), view)
    for foot, leg in enumerate(joints):
        draw_leg(axes, foot, leg, label=True)
    draw_hip(axes, (0.0, height), f"COM, {scene.walker.mass:g} kg")
    axes.set(xlim=view[:2], ylim=view[2:4], aspect="equal")
    axes.set(xlabel="$x$ (m)", ylabel="$z$ (m)")
    axes.set_title(f"{as_text(scene.sand.name)} sand ($\\zeta$ = {scene.sand.zeta:g})")


def view_of(stage: Stage) -> View:
    """All of a walk, with whole forces on the feet."""
    left, right, low, high = bounds(stage.body)
    newtons = round_down(max(0.5 * float(np.abs(stage.walk.force).max()), 1e-9))
    return View(left, right, low, high, letters(right - left, PAGE), ARROW * high / newtons, newtons)


def letters(width: float, inches: float) -> float:
    """Half as high as the letters of a figure so wide that shows so many metres, m."""
    return width / (inches - 0.6) / 72.0 * 4.5


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
