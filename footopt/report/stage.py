"""The stage: the walker on the sand at instants of a walk, in matplotlib; stage.js is the page's own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import to_hex, to_rgb
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike, NDArray

from footopt.effects import Layers, Patches, Slope
from footopt.report.body import ARROWS, body, forces_along
from footopt.report.style import PALETTE, SAND, SIDES, STRONG_SAND, Axes
from footopt.walk import Scene, Walk

Array = NDArray[np.float64]

FAR = 1e6  # m, beyond any view
SHORTEST = 0.8  # arrow that is drawn, in half letters: shorter ones would be heads alone
BOTH = (0, 1)  # feet, the left one first
TIMES = "\N{MULTIPLICATION SIGN}"
ROUND: dict[str, Any] = {"solid_capstyle": "round", "solid_joinstyle": "round"}


class View(NamedTuple):
    """What is seen, m, and how long forces are in it."""

    left: float
    right: float
    low: float
    high: float
    unit: float  # half as high as letters are
    metres: float = 0.0  # of an arrow per newton
    newtons: float = 0.0  # of the arrow that is the key; 0: none
    close: bool = False  # forces on parts of soles, ending there; else whole ones, from where they act


def ground(scene: Scene) -> dict[str, list[dict[str, Any]]]:
    """Layers of a scene and its patches, which go through them, as strips, and gravity on a slope.

    The page draws the same ones.
    """
    found: list[tuple[str, float, float, float, float, float, str]] = []
    layers = [(0.0, -FAR, 1.0)]  # top, bottom, factor
    for effect in scene.effects:
        if isinstance(effect, Layers):
            ends = [*(-d for d in effect.depths), -FAR]
            layers = [*zip([0.0, *ends], ends, [1.0, *effect.factors], strict=False)]
            found += [
                ("layer", -FAR, FAR, top, bottom, factor, f"layer {TIMES} {factor:g}")
                for top, bottom, factor in layers[1:]
            ]
    for effect in scene.effects:
        if isinstance(effect, Patches):
            for begin, end, factor in zip(effect.begins, effect.ends, effect.factors, strict=True):
                begin, end = max(begin, -FAR), min(end, FAR)
                for top, bottom, there in layers:
                    text = f"patch {TIMES} {factor:g}" * (top == 0.0)
                    found.append(("patch", begin, end, top, bottom, factor * there, text))
    names = ("kind", "begin", "end", "top", "bottom", "colour", "text")
    strips = [
        dict(zip(names, (*place, _strength(factor), text), strict=True)) for *place, factor, text in found
    ]
    x, z = ((part or 0.0) / scene.walker.g for part in scene.gravity)
    slopes = [
        {"x": x, "z": -abs(z), "words": [f"g = {scene.walker.g:g} m/s²", f"{abs(effect.angle):g}° "
         f"{'uphill' if effect.angle > 0 else 'downhill'}"]}
        for effect in scene.effects if isinstance(effect, Slope)
    ]  # fmt: skip
    return {"strips": strips, "gravity": slopes}


def _strength(factor: float) -> str:
    """The colour of sand so many times as strong: darker is stronger."""
    weight = float(np.clip(0.7 * np.log10(factor), -0.8, 0.6)) if factor > 0.0 else -0.8
    goal = np.array(to_rgb("white" if weight < 0 else STRONG_SAND))
    return to_hex((1.0 - abs(weight)) * np.array(to_rgb(SAND)) + abs(weight) * goal)


class Stage:
    """A walk at some instants, drawn on Axes in metres.

    Parameters
    ----------
    walk : Walk
        What is drawn.
    t : (M,), s
        The instants, in order.
    parts : int
        Of a sole, at most, that have an arrow each.
    """

    def __init__(self, walk: Walk, t: ArrayLike, parts: int = ARROWS) -> None:
        self.walk, self.t = walk, np.asarray(t, float)
        index = np.minimum(np.searchsorted(walk.t, self.t), len(walk.t) - 1)  # forces are known at samples
        self.body, self.forces = body(walk, self.t), forces_along(walk, index, parts)
        self.ground = ground(walk.scene)

    def draw_ground(self, axes: Axes, view: View, words: bool = True) -> list[Any]:
        """Draw the sand; with words, gravity and the key, too."""
        drawn = draw_ground(axes, self.ground, view, words)
        if words and view.newtons:
            at, length = (view.left + view.unit, view.low + 1.5 * view.unit), view.metres * view.newtons
            drawn += draw_arrows(axes, np.array([at]), np.array([[length, 0.0]]), view, "key")
            place = at[0] + length + view.unit, at[1]
            drawn += draw_words(axes, place, f"{view.newtons:g} N")
        return drawn

    def draw_feet(
        self, axes: Axes, i: int, view: View, feet: Sequence[int] = BOTH, label: bool = False
    ) -> list[Any]:
        """Draw some feet with their legs and forces, and the hip, at the i-th instant."""
        drawn: list[Any] = []
        for foot in feet:
            side, colour = SIDES[foot]
            joints, order = self.body.legs[i, foot], 1.7 + 0.4 * foot
            outline, sole = self.body.outline[i, foot], self.body.sole[i, foot]
            drawn += axes.fill(*outline.T, fc=colour, lw=0, alpha=0.16, zorder=order)
            drawn += draw_leg(axes, foot, joints, label)
            drawn += axes.plot(
                *sole.T, color=colour, lw=1.9, zorder=order + 0.3, label=f"_{side}-sole", **ROUND
            )
            x, z = joints[2]
            if view.close and len(feet) > 1 and view.left + 3 * view.unit < x < view.right - 3 * view.unit:
                drawn += draw_words(axes, (x, z + 5.5 * view.unit), side, "center")
        at, force = self.forces if view.close else self.forces.resultant()
        arrows = view.metres * force[i, list(feet)].reshape(-1, 2)
        begin = at[i, list(feet)].reshape(-1, 2) - view.close * arrows
        drawn += draw_arrows(axes, begin, arrows, view, "force")
        return drawn + draw_hip(axes, self.body.hip[i])


def draw_ground(
    axes: Axes, ground: dict[str, list[dict[str, Any]]], view: View, words: bool = True
) -> list[Any]:
    """Draw sand with its level surface, its strips, and gravity on a slope."""
    unit, edge = view.unit, PALETTE["surface"]
    ends = view.left, view.right
    drawn = [axes.fill_between(ends, view.low, 0.0, fc=SAND, lw=0, zorder=1.0)]
    for strip in ground["strips"]:
        a, b = max(strip["begin"], view.left), min(strip["end"], view.right)
        low, top = max(strip["bottom"], view.low), strip["top"]
        if a >= b or low >= top:
            continue
        drawn += axes.fill([a, a, b, b], [low, top, top, low], fc=strip["colour"], lw=0, zorder=1.1)
        drawn += axes.plot([a, a, b, b], [low, top, top, low], color=edge, lw=0.4, zorder=1.1, label="_strip")
        if not words:
            continue
        if strip["kind"] == "layer":
            place = b - 0.6 * unit, max(low + 1.3 * unit, top - 3 * unit)
            drawn += draw_words(axes, place, strip["text"], "right")
        elif len(strip["text"]) * unit <= b - a:  # where enough of it is seen for its name
            place = a + 0.6 * unit, min(top - 1.6 * unit, view.low + (1.5 + 4.2 * view.close) * unit)
            drawn += draw_words(axes, place, strip["text"])
    drawn += axes.plot(ends, (0.0, 0.0), color=edge, lw=1.1, zorder=1.3, label="_surface", **ROUND)
    for slope in ground["gravity"] if words else ():
        begin = np.array([[view.right - 4 * unit, view.high - 5.4 * unit]])
        along = 6 * unit * np.array([[slope["x"], slope["z"]]])
        drawn += draw_arrows(axes, begin, along, view, "gravity", 1.4)
        for line, down in zip(slope["words"], (1.5, 4.0), strict=True):
            drawn += draw_words(axes, (view.right - unit, view.high - down * unit), line, "right")
    return drawn


def draw_leg(axes: Axes, foot: int, joints: Array, label: bool = False) -> list[Any]:
    """Draw hip, knee and ankle (3, 2) of a leg."""
    side, colour = SIDES[foot]
    order, name = 1.8 + 0.4 * foot, f"{side} leg" if label else f"_{side}-leg"
    leg = axes.plot(*joints.T, color=colour, lw=3.0, alpha=0.75, zorder=order, label=name, **ROUND)
    dots = {"color": PALETTE["ink"], "ms": 4.5, "mew": 0, "label": "_joints"}
    return [*leg, *axes.plot(*joints[1:].T, "o", **dots, zorder=order + 0.1)]


def draw_hip(axes: Axes, place: ArrayLike, label: str = "_hip") -> list[Any]:
    """Draw the hip, where the COM is."""
    x, z = np.asarray(place, float)
    return list(axes.plot(x, z, "o", color=PALETTE["ink"], ms=9.0, mew=0, zorder=3.0, label=label))


def draw_arrows(
    axes: Axes, begin: Array, along: Array, view: View, name: str, width: float = 1.0
) -> list[Any]:
    """Draw arrows from places (n, 2) along vectors (n, 2), m, as one line with gaps."""
    long = np.linalg.norm(along, axis=1)
    seen = long > SHORTEST * view.unit
    begin, along, long = begin[seen], along[seen], long[seen, None]
    head, tip = np.minimum(1.3 * view.unit / np.maximum(long, view.unit), 0.5), begin + along
    aside = 0.4 * along[:, ::-1] * [1.0, -1.0]
    gap = np.full_like(tip, np.nan)
    barbs = tip - head * (along + aside), tip, tip - head * (along - aside)
    points = np.stack([begin, tip, gap, *barbs, gap], axis=1).reshape(-1, 2)
    return list(axes.plot(*points.T, color=PALETTE["ink"], lw=width, zorder=2.7, label=f"_{name}", **ROUND))


def draw_words(axes: Axes, place: tuple[float, float], text: str, ha: str = "left") -> list[Any]:
    """Write into the picture, from a place (ha="left"), to it or about it."""
    halo = [withStroke(linewidth=2.0, foreground="white")]
    return [axes.text(*place, text, ha=ha, va="center", path_effects=halo, zorder=6, clip_on=True)]


def round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(m for m in (1, 2, 5) if m * power <= value * (1 + 1e-12)))
