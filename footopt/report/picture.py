"""A walk at some instants as the things whose parts are drawn, and what draws them in figures and films."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import to_hex, to_rgb
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike, NDArray

from footopt.effects import Layers, Patches, Slope
from footopt.report.body import ARROWS, body, forces_along
from footopt.report.parts import DRAWN, LOOKS, Label, Shape, View, shapes
from footopt.report.style import PALETTE, SAND, SIDES, STRONG_SAND, Axes
from footopt.walk import Scene, Walk

Array = NDArray[np.float64]

FAR = 1e6  # m, beyond any view
TIMES = "\N{MULTIPLICATION SIGN}"
BOTH = (0, 1)  # feet, the left one first
STEP = 0.004  # m, between the places where the depth of a drawn print is known
OFTEN = 0.005  # s, between the soles that it is drawn of


def ground(scene: Scene) -> dict[str, Any]:
    """Layers of a scene, its patches, which go through them, and gravity where it is not straight down."""
    strips: dict[str, list[dict[str, Any]]] = {"layer": [], "patch": [], "gravity": [], "slope": []}
    layers = [(0.0, -FAR, 1.0)]  # top, bottom, factor

    def strip(
        kind: str, begin: float, end: float, top: float, bottom: float, factor: float, text: str
    ) -> None:
        weight = float(np.clip(0.7 * np.log10(factor), -0.8, 0.6)) if factor > 0.0 else -0.8
        goal = np.array(to_rgb("white" if weight < 0 else STRONG_SAND))  # darker is stronger
        colour = to_hex((1.0 - abs(weight)) * np.array(to_rgb(SAND)) + abs(weight) * goal)
        strips[kind].append({"begin": begin, "end": end, "top": top, "bottom": bottom, "colour": colour,
                             "text": text, "letters": len(text)})  # fmt: skip

    for effect in scene.effects:
        if isinstance(effect, Layers):
            ends = [*(-d for d in effect.depths), -FAR]
            layers = [*zip([0.0, *ends], ends, [1.0, *effect.factors], strict=False)]
            for top, bottom, factor in layers[1:]:
                strip("layer", -FAR, FAR, top, bottom, factor, f"layer {TIMES} {factor:g}")
    for effect in scene.effects:
        if isinstance(effect, Patches):
            for begin, end, factor in zip(effect.begins, effect.ends, effect.factors, strict=True):
                for top, bottom, there in layers:
                    text = f"patch {TIMES} {factor:g}" * (top == 0.0)
                    strip("patch", max(begin, -FAR), min(end, FAR), top, bottom, factor * there, text)
        if isinstance(effect, Slope):
            x, z = ((part or 0.0) / scene.walker.g for part in scene.gravity)
            way = "uphill" if effect.angle > 0 else "downhill"
            strips["gravity"].append({"x": x, "z": -abs(z), "text": f"g = {scene.walker.g:g} m/s²"})
            strips["slope"].append({"text": f"{abs(effect.angle):g}° {way}"})
    return {"view": [{}], **strips}


def standing(side: str, leg: Array) -> dict[str, Any]:
    """A foot as a thing of the picture: its leg alone, (3, 2), m."""
    x, z = leg[2]
    return {"leg": leg, "joints": leg[1:], "outline": leg[:0], "sole": leg[:0], "x": x, "z": z, "text": side}


class Picture:
    """A walk at some instants.

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
        self.body, self.forces, self.sand = (
            body(walk, self.t),
            forces_along(walk, index, parts),
            walk.sand(index),
        )
        self.ground = ground(walk.scene)
        self.x, self.height = printed(walk, self.t) if self.sand is None else self.sand[:2]

    def shapes(
        self, i: int, view: View, feet: Sequence[int] = BOTH, ground: bool = True
    ) -> tuple[list[Shape], list[Label]]:
        """Parts and words of the i-th instant: of the ground with its prints, and of some feet."""
        things: dict[str, Any] = {}
        if ground:
            surface = zip(self.x.tolist(), self.height[i].tolist(), strict=True)
            things |= self.ground | {"surface": [{"x": x, "z": z} for x, z in surface]}
            things["key"] = [{"text": f"{view.newtons:g} N"}] * bool(view.newtons)
            things["drawn"] = [DRAWN] * (self.sand is None)
        for foot in feet:
            side = SIDES[foot][0]
            placed = {"outline": self.body.outline[i, foot], "sole": self.body.sole[i, foot]}
            things[side] = [standing(side * (len(feet) > 1), self.body.legs[i, foot]) | placed]
        if feet:
            at, force = self.forces if view.close else self.forces.resultant()
            rows = np.concatenate([part[i, list(feet)].reshape(-1, 2) for part in (at, force)], axis=1)
            things["force"] = [dict(zip(("x", "z", "fx", "fz"), row, strict=True)) for row in rows.tolist()]
            things["hip"] = [dict(zip("xz", self.body.hip[i], strict=True))]
        return shapes(things, view)


def printed(walk: Walk, t: Array) -> tuple[Array, Array]:
    """The lowest that soles have been at each place: a print as it would stay if no sand fell back.

    Returns
    -------
    x : (cells,), m
        Places along the ground.
    z : (M, cells), m
        Of the sand there, at each of the times t (M,), s, which are in order.
    """
    fine = np.arange(0, max(float(t[-1]), walk.t[0]) + OFTEN, OFTEN).clip(walk.t[0], t[-1])
    soles = body(walk, fine, walk.foot.points(200)).sole
    first = float(soles[..., 0].min()) - STEP
    x = first + STEP * np.arange(2 + math.ceil((soles[..., 0].max() - first) / STEP))
    z, found, depth = np.zeros((len(t), len(x))), 0, np.zeros(len(x))
    for n, now in enumerate(soles):
        while found < len(t) and t[found] < fine[n] - 1e-12:
            z[found] = depth
            found += 1
        # heel and toe go on between two instants
        swept = np.linspace(soles[max(n - 1, 0)][:, [0, -1]], now[:, [0, -1]], 8)
        points = np.concatenate([now.reshape(-1, 2), swept.reshape(-1, 2)])
        np.minimum.at(depth, np.rint((points[:, 0] - first) / STEP).astype(int), points[:, 1])
    z[found:] = depth
    return x, z


def draw(axes: Axes, shapes: Iterable[Shape], labels: Iterable[Label] = ()) -> list[Any]:
    """Draw parts and words on Axes in metres; returns what they are drawn with."""
    drawn: list[Any] = []
    for part, points, colour in shapes:
        look, order = LOOKS[part], 1.0 + 0.1 * list(LOOKS).index(part)
        if look.fill:
            fill = colour or PALETTE[look.fill]
            drawn += axes.fill(*points.T, fc=fill, lw=0, alpha=look.opacity, zorder=order)
        if look.stroke:
            colour = PALETTE[look.stroke] if look.fill or not colour else colour
            line = {"color": colour, "alpha": look.opacity, "zorder": order, "label": f"_{part}"}
            ends = {"solid_capstyle": "round", "solid_joinstyle": "round"}
            kind = {"ls": "", "marker": "o", "ms": look.width, "mew": 0} if look.dots else {
                "lw": look.width, "ls": (0, look.dashes) if look.dashes else "-", **ends
            }  # fmt: skip
            drawn += axes.plot(*points.T, **line, **kind)
    halo = [withStroke(linewidth=2.0, foreground="white")]
    for x, z, text, anchor in labels:
        side = {"start": "left", "middle": "center", "end": "right"}[anchor]
        drawn.append(axes.text(x, z, text, ha=side, va="center", path_effects=halo, zorder=6, clip_on=True))
    return drawn


def round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(m for m in (1, 2, 5) if m * power <= value * (1 + 1e-12)))
