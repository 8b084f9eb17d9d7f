"""`Stage`: the walker on the sand at instants of a walk, in matplotlib; report.html has stage.js for that."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import to_hex, to_rgb
from matplotlib.patheffects import withStroke
from matplotlib.quiver import Quiver
from numpy.typing import ArrayLike

from footopt.arrays import Array, Ints
from footopt.files.feet import closed_contour
from footopt.report import style
from footopt.report.numbers import title
from footopt.walk import Scene, Walk

ARROWS = 20  # parts of a sole, at most, that have a force each
POSES = 9  # of the walker in the picture of a walk
THIN = 0.02  # of a sole's length: what is drawn of a foot above the highest point of its sole
ARROW = 0.2  # of the picture's height: an arrow of half of the walk's largest force
FAR = 1e6  # m, beyond any view
WIDE, HIGH = 0.12, 0.05  # of a picture: a narrower patch or a thinner layer has no room for its name
INK = style.PALETTE["ink"]
LEG = {"lw": 3.0, "alpha": 0.75, "solid_capstyle": "round", "solid_joinstyle": "round"}
TIMES = "\N{MULTIPLICATION SIGN}"


def forces_along(walk: Walk, index: Ints) -> tuple[Array, Array]:
    """Forces along both soles at samples (M,) of a walk, summed over neighbouring plates.

    Returns places, m, and forces, N, each (M, 2 feet, parts, 2).
    """
    plates = walk.plates(index)
    begin, size = groups(plates.position.shape[2])
    middle = np.add.reduceat(plates.position, begin, axis=2) / size[:, None]
    return middle, np.add.reduceat(plates.force, begin, axis=2)


def groups(count: int) -> tuple[Ints, Ints]:
    """The begins of `ARROWS` groups of neighbours, for `np.add.reduceat`, and the size of each."""
    parts = min(ARROWS, count)
    begin = count * np.arange(parts) // parts
    return begin, np.diff(np.append(begin, count))


def resultant(at: Array, force: Array) -> tuple[Array, Array]:
    """The whole force on each foot and its place, from the result of `forces_along`, and in its form.

    The place is the mean of the parts' places, weighted by their forces; NaN for a foot without a force.
    """
    size = np.linalg.norm(force, axis=-1, keepdims=True)
    total = size.sum(axis=2, keepdims=True)
    weight = size / np.where(total > 0.0, total, np.nan)
    return (weight * at).sum(axis=2, keepdims=True), force.sum(axis=2, keepdims=True)


def ground(scene: Scene) -> dict[str, list[dict[str, Any]]]:
    """Strips of sand: the layers of a scene, and its patches, which cross them; and gravity on a slope."""
    strata = [layer for effect in scene.effects for layer in effect.strata]
    whole = [(0.0, strata[0][0] if strata else FAR, 1.0), *strata]
    strips = [
        _strip("layer", (-FAR, FAR), layer[:2], layer[2], f"layer {TIMES} {layer[2]:g}") for layer in strata
    ]
    for begin, end, factor in (zone for effect in scene.effects for zone in effect.zones):
        for top, bottom, there in whole:
            text = f"patch {TIMES} {factor:g}" if top == 0.0 else ""
            strips.append(_strip("patch", (begin, end), (top, bottom), factor * there, text))
    tilt, g = scene.gravity
    way = f"{abs(math.degrees(math.atan2(tilt, g))):g}° {'uphill' if tilt < 0 else 'downhill'}"
    words = [f"g = {scene.g:g} m/s²", way]
    slope = {"x": tilt / scene.g, "z": -g / scene.g, "words": words}
    return {"strips": strips, "gravity": [slope] if tilt else []}


def _strip(
    kind: str, along: Sequence[float], down: Sequence[float], factor: float, text: str
) -> dict[str, Any]:
    """Sand `factor` times as strong between two places and two depths, m: darker is stronger."""
    weight = float(np.clip(0.7 * np.log10(factor), -0.8, 0.6)) if factor > 0.0 else -0.8
    goal = np.array(to_rgb("white" if weight < 0 else style.STRONG_SAND))
    return {
        "kind": kind,
        "begin": max(along[0], -FAR),
        "end": min(along[1], FAR),
        "top": -down[0],
        "bottom": -min(down[1], FAR),
        "colour": to_hex((1.0 - abs(weight)) * np.array(to_rgb(style.SAND)) + abs(weight) * goal),
        "text": text,
    }


class Stage:
    """A walk at instants t (M,), s, in order, linear between its samples; drawn on Axes in m.

    Of both feet, left one first, it has `legs` (M, 2, joints, 2), from hip to ankle, `sole` and `outline`,
    the sole with the foot's top, each (M, 2, points, 2), m, and the forces on parts of the soles, N.
    """

    def __init__(self, walk: Walk, t: ArrayLike) -> None:
        self.walk, self.t, foot = walk, np.asarray(t, float), walk.foot
        self.legs, pitch = walk.legs(self.t), walk.pitch(self.t)
        turn = np.array([[np.cos(pitch), np.sin(pitch)], [-np.sin(pitch), np.cos(pitch)]])
        turned, ankle = np.moveaxis(turn, (0, 1), (-2, -1)), self.legs[:, :, -1, None]
        outline = closed_contour(
            foot.contour, max(0.0, foot.contour[:, 1].max() + THIN * np.ptp(foot.contour[:, 0]))
        )
        self.sole, self.outline = (ankle + (line - foot.ankle) @ turned for line in (foot.contour, outline))
        self.index = np.minimum(np.searchsorted(walk.t, self.t), len(walk.t) - 1)  # of samples with forces
        self.at, self.force = forces_along(walk, self.index)
        self.ground = ground(walk.world)

    @property
    def limits(self) -> tuple[float, float, float, float]:
        """Left, right, low and high around all that is drawn, m."""
        points = np.concatenate([part.reshape(-1, 2) for part in (self.legs, self.outline)])
        (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
        low = min(low, 0.0)
        tall = high - low
        return left - 0.1 * tall, right + 0.1 * tall, low - 0.14 * tall, high + 0.08 * tall

    @property
    def scale(self) -> float:
        """Newtons per metre of arrows of whole forces."""
        return max(0.5 * float(np.abs(self.walk.force).max()), 1e-9) / (ARROW * self.limits[3])

    def draw_feet(
        self,
        axes: style.Axes,
        i: int,
        scale: float,
        only: int | None = None,
        close: bool = False,
        legs: bool = True,
    ) -> Quiver:
        """Draw all feet or one, with their legs or without, the hip, and the forces at the i-th instant.

        Arrows have `scale` newtons per metre; `close` ones are forces on parts of the soles and end there,
        others are whole forces and begin where they act.
        """
        named = style.sides(self.walk)
        feet = range(len(named)) if only is None else [only]
        for foot in feet:
            (side, colour), order = named[foot], 1.7 + 0.4 * foot
            joints = self.legs[i, foot].T
            axes.fill(*self.outline[i, foot].T, fc=colour, lw=0, alpha=0.16, zorder=order)
            if legs:
                axes.plot(*joints, color=colour, zorder=order + 0.1, label=f"_{side}-leg", **LEG)
                axes.plot(*joints[:, 1:], "o", color=INK, ms=4.5, mew=0, zorder=order + 0.2)
            axes.plot(*self.sole[i, foot].T, color=colour, lw=1.9, zorder=order + 0.3, label=f"_{side}-sole")
        axes.plot(*self.legs[i, 0, 0], "o", color=INK, ms=9.0, mew=0, zorder=3.0)  # the hip
        parts = (self.at, self.force) if close else resultant(self.at, self.force)
        at, force = (part[i, list(feet)].reshape(-1, 2) for part in parts)
        pushed = np.any(force != 0.0, axis=1)
        return draw_arrows(axes, at[pushed], force[pushed], scale, "tip" if close else "tail")


def draw_ground(axes: style.Axes, ground: dict[str, list[dict[str, Any]]], words: bool = True) -> None:
    """Draw the sand within the limits of the axes: its surface, its strips, and gravity on a slope."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    axes.fill_between((left, right), low, 0.0, fc=style.SAND, lw=0, zorder=1.0)
    edge = {"ec": style.SURFACE, "lw": 0.4, "zorder": 1.1}
    for strip in ground["strips"]:
        a, b = np.clip((strip["begin"], strip["end"]), left, right)
        c, d = np.clip((strip["bottom"], strip["top"]), low, high)
        if a >= b or c >= d:
            continue
        axes.fill([a, a, b, b], [c, d, d, c], fc=strip["colour"], **edge)
        if words and strip["kind"] == "layer" and d - c >= HIGH * (high - low):
            write(axes, strip["text"], (b, c), (-3, 2), ha="right")
        elif words and strip["kind"] == "patch" and b - a >= WIDE * (right - left):
            write(axes, strip["text"], (a, d), (3, -2), va="top")
    axes.plot((left, right), (0.0, 0.0), color=style.SURFACE, lw=1.1, zorder=1.3)
    for slope in ground["gravity"] if words else ():
        wide, tall = right - left, 0.2 * (high - low)
        begin = np.array([[right - 0.03 * wide, high - 0.1 * tall]])
        along = tall * np.array([[slope["x"], slope["z"]]])
        draw_arrows(axes, begin, along, 1.0, "tail")
        place = right - 0.04 * wide + min(along[0, 0], 0.0), high
        write(axes, "\n".join(slope["words"]), place, (0, -2), ha="right", va="top")


def draw_arrows(axes: style.Axes, at: Array, along: Array, scale: float, pivot: str) -> Quiver:
    """Draw arrows at places (n, 2) m along vectors (n, 2), of which `scale` are a metre."""
    looks = {"width": 0.014, "headwidth": 4.0, "headlength": 5.0, "headaxislength": 4.5, "minlength": 0.3}
    units = {"angles": "xy", "scale_units": "xy", "scale": scale, "units": "inches"}
    return axes.quiver(*at.T, *along.T, pivot=pivot, color=INK, zorder=2.7, **looks, **units)


def draw_key(axes: style.Axes, arrows: Quiver, largest: float) -> None:
    """Draw an arrow as long as a round number of newtons, at most the largest force, with the number."""
    power, (left, right) = 10.0 ** np.floor(np.log10(largest)), axes.get_xlim()
    newtons = power * max(m for m in (1, 2, 5) if m * power <= largest * (1 + 1e-12))
    tip = 0.03 + newtons / (arrows.scale or 1.0) / (right - left)
    axes.quiverkey(arrows, tip, 0.06, newtons, f"{newtons:g} N", coordinates="axes", labelpos="E", zorder=6)


def write(axes: style.Axes, text: str, place: ArrayLike, offset: tuple[float, float], **looks: Any) -> None:
    """Write into the picture at a place in m, moved by an offset in points."""
    halo = [withStroke(linewidth=2.0, foreground="white")]
    axes.annotate(text, place, offset, textcoords="offset points", zorder=6, path_effects=halo, **looks)


def draw_walk(axes: style.Axes, walk: Walk) -> None:
    """The walker at equal times, the path of the COM, and the force of the sand on each foot."""
    axes.set(xlabel="$x$ (m)", ylabel="$z$ (m)")
    if len(walk.t) == 0:
        style.message(axes, f"the walk failed: {walk.reason}, before its first step of time")
        return
    begin = min(max(walk.world.gait.start, walk.t[0]), walk.t[-1])
    index = np.unique(np.searchsorted(walk.t, np.linspace(begin, walk.t[-1], POSES)))
    stage = Stage(walk, walk.t[index])
    axes.set(xlim=stage.limits[:2], ylim=stage.limits[2:], aspect="equal")
    draw_ground(axes, stage.ground)
    for i in range(len(index)):
        arrows = stage.draw_feet(axes, i, stage.scale)
    for side, colour in style.sides(walk):
        axes.plot([], [], color=colour, label=f"{side} leg", **LEG)
    draw_key(axes, arrows, 0.5 * float(np.abs(walk.force).max()))
    axes.plot(*walk.com.T, color="black", lw=0.8, label="path of the COM", zorder=3.5)
    step = f", every {walk.t[index[1]] - walk.t[index[0]]:.2g} s" if len(index) > 1 else ""
    axes.set_title(
        style.walk_label(f"{title(walk.foot.name)} on {walk.world.sand.title}{step}", walk), loc="left"
    )
