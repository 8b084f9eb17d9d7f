"""The picture of a walk: what is drawn of it at an instant, and how, for the page, films and figures alike.

`LOOKS` names every part, from behind to the front. `Ground` and `Picture` say where parts are, in metres.
Figures and films draw them with `draw`; the page's style is made of `LOOKS`, and its script, which walks
by itself, finds the same shapes (page/stage.js).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
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
BEYOND = 0.05  # m, that the surface is drawn past the view
BOTH = (0, 1)  # feet, the left one first
HEAD = 1.4  # of half a letter: the head of an arrow
STEP = 0.004  # m, between the places where the depth of a drawn print is known
OFTEN = 0.005  # s, between the soles that it is drawn of
DRAWN = "print drawn, not computed"


class Look(NamedTuple):
    """How a part is drawn: colours by role (`style.PALETTE`), widths in points."""

    fill: str = ""
    stroke: str = ""
    width: float = 0.0
    opacity: float = 1.0
    dashes: tuple[float, ...] = ()
    dots: bool = False  # so wide, at the points


def _foot(side: str) -> dict[str, Look]:
    return {
        f"{side}-foot": Look(fill=side, opacity=0.16),
        f"{side}-leg": Look(stroke=side, width=3.0, opacity=0.75),
        f"{side}-joints": Look(stroke="ink", width=4.5, dots=True),
        f"{side}-sole": Look(stroke=side, width=1.9),
    }


LOOKS: dict[str, Look] = {
    "sand": Look(fill="sand"),
    "strip": Look(fill="sand", stroke="surface", width=0.4),
    "print": Look(fill="paper"),
    "rim": Look(fill="sand"),
    "surface": Look(stroke="surface", width=1.1),
    "ghost": Look(stroke="flat", width=1.2, dashes=(4, 3)),
    **_foot("left"),
    **_foot("right"),
    "edge": Look(stroke="ink", width=5.2),  # of a sole that is coloured by a quantity
    "paint": Look(stroke="ink", width=3.4),
    "force": Look(stroke="ink", width=1.0),
    "gravity": Look(stroke="ink", width=1.4),
    "hip": Look(stroke="ink", width=9.0, dots=True),
}


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


class Shape(NamedTuple):
    """A part of the picture: points (n, 2), m; a row of NaN is a gap."""

    part: str
    points: Array
    colour: str = ""  # of its own, instead of its look's


class Label(NamedTuple):
    """Words in the picture at the height of a place, m, from there, to there or about it."""

    x: float
    z: float
    text: str
    anchor: str = "start"  # or end, or middle


class Strip(NamedTuple):
    """Sand of another strength than the scene's, between two x and two z, m."""

    kind: str  # "layer" or "patch"
    begin: float
    end: float
    top: float
    bottom: float
    factor: float

    @property
    def label(self) -> str:
        """Its strength, by that of the scene's sand."""
        return f"{self.kind} \N{MULTIPLICATION SIGN} {self.factor:g}"

    @property
    def colour(self) -> str:
        """Darker is stronger."""
        weight = float(np.clip(0.7 * np.log10(self.factor), -0.8, 0.6)) if self.factor > 0.0 else -0.8
        goal = np.array(to_rgb("white" if weight < 0 else STRONG_SAND))
        return to_hex((1.0 - abs(weight)) * np.array(to_rgb(SAND)) + abs(weight) * goal)


class Ground(NamedTuple):
    """The sand of a scene, and where gravity pulls on a slope (a unit vector): the same at every instant."""

    strips: Sequence[Strip] = ()
    gravity: Label | None = None

    def plain(self) -> dict[str, Any]:
        """As the page has it."""
        strips = [s._asdict() | {"label": s.label, "colour": s.colour} for s in self.strips]
        return {"strips": strips, "gravity": self.gravity and self.gravity._asdict()}

    def shapes(self, view: View) -> tuple[list[Shape], list[Label]]:
        """Parts and words of what is in view."""
        left, right, low, high, unit = view[:5]
        found, labels = [Shape("sand", _box(left, right, low, 0.0))], []
        for strip in self.strips:
            a, b, bottom = max(strip.begin, left), min(strip.end, right), max(strip.bottom, low)
            if a >= b or bottom >= strip.top:
                continue
            found.append(Shape("strip", _box(a, b, bottom, strip.top), strip.colour))
            if strip.kind == "patch" and b - a < unit * len(strip.label):
                continue  # too little of it is seen for its name
            if strip.kind == "patch":
                z = min(strip.top - 1.6 * unit, low + 5.7 * unit)
                labels.append(Label(a + 0.6 * unit, z, strip.label))
            else:
                z = max(bottom + 1.3 * unit, strip.top - 3.0 * unit)
                labels.append(Label(b - 0.6 * unit, z, strip.label, "end"))
        if self.gravity is not None:
            place = np.array([[right - 9 * unit, high - 3.2 * unit]])
            pull = 6 * unit * np.array([[self.gravity.x, self.gravity.z]])
            found.append(Shape("gravity", arrows(place, pull, unit)))
            labels.append(Label(right - unit, high - 1.5 * unit, self.gravity.text, "end"))
        return found, labels


def ground(scene: Scene) -> Ground:
    """Layers and patches of a scene, from the deepest upwards, and gravity where it is not straight down."""
    strips: list[Strip] = []
    gravity = None
    for effect in scene.effects:
        if isinstance(effect, Layers):
            ends = [*(-d for d in effect.depths), -FAR]
            for top, bottom, factor in zip(ends, ends[1:], effect.factors, strict=False):
                strips.append(Strip("layer", -FAR, FAR, top, bottom, factor))
        if isinstance(effect, Patches):
            for begin, end, factor in zip(effect.begins, effect.ends, effect.factors, strict=True):
                strips.append(Strip("patch", max(begin, -FAR), min(end, FAR), 0.0, -FAR, factor))
        if isinstance(effect, Slope):
            x, z = ((part or 0.0) / scene.walker.g for part in scene.gravity)
            way = "uphill" if effect.angle > 0 else "downhill"
            words = f"g = {scene.walker.g:g} m/s², {abs(effect.angle):g}° {way}"
            gravity = Label(x, -abs(z), words)
    return Ground(strips, gravity)


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
        """Parts and words of the i-th instant, in order; the walker's alone without `ground`."""
        found, labels = self.surface(i, view) if ground else ([], [])
        for foot in feet:
            side, leg = SIDES[foot][0], self.body.legs[i, foot]
            found += [
                Shape(f"{side}-foot", self.body.outline[i, foot]),
                Shape(f"{side}-leg", leg),
                Shape(f"{side}-joints", leg[1:]),
                Shape(f"{side}-sole", self.body.sole[i, foot]),
            ]
            if view.close and len(feet) > 1:
                labels.append(Label(leg[2, 0], leg[2, 1] + 5.5 * view.unit, side, "middle"))
        at, force = self.forces if view.close else self.forces.resultant()
        place, along = (part[i, list(feet)].reshape(-1, 2) for part in (at, view.metres * force))
        found.append(Shape("force", arrows(place, along, view.unit, view.close)))
        return [*found, Shape("hip", self.body.hip[i][None])], labels

    def surface(self, i: int, view: View) -> tuple[list[Shape], list[Label]]:
        """The ground at the i-th instant with its prints, and the key of the arrows."""
        found, labels = self.ground.shapes(view)
        left, right = view.left - BEYOND, view.right + BEYOND
        top = np.stack([self.x, self.height[i]], axis=1)[(self.x > left) & (self.x < right)]
        whole = np.concatenate([[[left, 0.0]], top, [[right, 0.0]]])
        found += [
            Shape("print", np.minimum(whole, [np.inf, 0.0])),
            Shape("rim", np.maximum(whole, [-np.inf, 0.0])),
            Shape("surface", whole),
        ]
        if view.newtons:
            long, z = view.newtons * view.metres, view.low + 1.5 * view.unit
            start = np.array([[view.left + view.unit, z]])
            found.append(Shape("force", arrows(start, np.array([[long, 0.0]]), view.unit)))
            labels.append(Label(view.left + long + 2.0 * view.unit, z, f"{view.newtons:g} N"))
        if self.sand is None and view.close:
            beside = view.right - view.left > 70.0 * view.unit  # the key, else above it
            z = view.low + (1.5 if beside else 3.6) * view.unit
            labels.append(Label(view.right - view.unit, z, DRAWN, "end"))
        return found, labels


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


def arrows(at: Array, along: Array, unit: float, tip: bool = False) -> Array:
    """Arrows (n, 2), m, from places (n, 2), m, or with their tips there: one line with gaps."""
    long = np.linalg.norm(along, axis=1)
    seen = np.isfinite(at).all(axis=1) & (long > 0.2 * HEAD * unit)
    at, along, long = at[seen], along[seen], long[seen, None]
    begin, end = (at - along, at) if tip else (at, at + along)
    ahead = np.minimum(HEAD * unit, 0.6 * long) * along / long
    aside, gap = 0.5 * np.stack([-ahead[:, 1], ahead[:, 0]], axis=1), np.full_like(at, np.nan)
    rows = [begin, end, gap, end - ahead + aside, end, end - ahead - aside, gap]
    return np.stack(rows, axis=1).reshape(-1, 2)


def draw(axes: Axes, shapes: Iterable[Shape], labels: Iterable[Label] = ()) -> list[Any]:
    """Draw parts and words on Axes in metres; returns what they are drawn with."""
    drawn: list[Any] = []
    for part, points, colour in shapes:
        look, order = LOOKS[part], 1.0 + 0.1 * list(LOOKS).index(part)
        if look.fill:
            fill = colour or PALETTE[look.fill]
            drawn += axes.fill(*points.T, fc=fill, lw=0, alpha=look.opacity, zorder=order)
        line = (
            {"color": PALETTE[look.stroke], "alpha": look.opacity, "zorder": order, "label": f"_{part}"}
            if look.stroke
            else {}
        )
        if look.dots:
            drawn += axes.plot(*points.T, "o", ms=look.width, mew=0, **line)
        elif look.stroke:
            ends = {"solid_capstyle": "round", "solid_joinstyle": "round"}
            drawn += axes.plot(
                *points.T, lw=look.width, ls=(0, look.dashes) if look.dashes else "-", **ends, **line
            )
    halo = [withStroke(linewidth=2.0, foreground="white")]
    for x, z, text, anchor in labels:
        side = {"start": "left", "middle": "center", "end": "right"}[anchor]
        drawn.append(axes.text(x, z, text, ha=side, va="center", path_effects=halo, zorder=6, clip_on=True))
    return drawn


def css() -> str:
    """The looks as the page's style: rules for elements of a part's name."""
    rules = []
    for part, look in LOOKS.items():
        paint = [
            f"{name}: {f'var(--{role})' if role else 'none'}"
            for name, role in (("fill", look.fill), ("stroke", look.stroke))
        ]
        more = [f"stroke-width: {look.width:g}pt"] * bool(look.stroke) + [f"opacity: {look.opacity:g}"] * (
            look.opacity < 1.0
        )
        dashes = [f"stroke-dasharray: {' '.join(map(str, look.dashes))}"] * bool(look.dashes)
        rules.append(f".{part} {{ {'; '.join([*paint, *more, *dashes])}; }}")
    return "\n".join(rules)


def round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(m for m in (1, 2, 5) if m * power <= value * (1 + 1e-12)))


def _box(left: float, right: float, low: float, high: float) -> Array:
    return np.array([[left, low], [left, high], [right, high], [right, low]])
