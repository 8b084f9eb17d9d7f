"""What is drawn of a walk at an instant, and how: the one description that the page, films and figures draw.

`PARTS`, from behind to the front, and `WORDS` say of which kind of thing each is, where, and how it looks.
Places are formulas in the words that Python and JavaScript share: `shapes` computes them for figures and
films, `script` and `css` hand the same ones to the page, which walks by itself.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.report.style import SIDES

Array = NDArray[np.float64]
Things = Mapping[str, Sequence[Mapping[str, Any]]]  # what is there, by kind: each with numbers of its own
Formulas = tuple[tuple[str, str], ...]


SHORTEST = 0.8  # arrow that is drawn, in half letters


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


class Look(NamedTuple):
    """How a part is drawn: colours by role (`style.PALETTE`), widths in points."""

    fill: str = ""
    stroke: str = ""
    width: float = 0.0
    opacity: float = 1.0
    dashes: tuple[float, ...] = ()
    dots: bool = False  # so wide, at the points


class Part(NamedTuple):
    """What is drawn of each thing of a kind; its formulas have the numbers of the view and of the thing."""

    name: str
    look: Look
    of: str
    points: str | Formulas  # x and z, m; or the name of the thing's own line
    let: Formulas = ()  # what later formulas are written with
    when: tuple[str, ...] = ()
    ends: Formulas | None = None  # of the one line that all things are; None: each has its own


class Word(NamedTuple):
    """Where the text of each thing of a kind is: from a place, to it ("end"), or about it ("middle")."""

    of: str
    points: Formulas
    anchor: str = "start"
    let: Formulas = ()
    when: tuple[str, ...] = ()


def _box(left: str, right: str, low: str, high: str) -> Formulas:
    return (left, low), (left, high), (right, high), (right, low)


def _foot(side: str) -> list[Part]:
    return [
        Part(f"{side}-foot", Look(fill=side, opacity=0.16), side, "outline"),
        Part(f"{side}-leg", Look(stroke=side, width=3.0, opacity=0.75), side, "leg"),
        Part(f"{side}-joints", Look(stroke="ink", width=4.5, dots=True), side, "joints"),
        Part(f"{side}-sole", Look(stroke=side, width=1.9), side, "sole"),
    ]


def _arrows(name: str, width: float, x: str, z: str, along: str, up: str) -> Part:
    """Arrows as one line with gaps; short ones would be heads alone."""
    let = (("u", along), ("w", up), ("x0", x), ("z0", z), ("x1", "x0 + u"), ("z1", "z0 + w"),
           ("long", "hypot(u, w)"), ("head", "min(1.3 * unit / max(long, unit), 0.5)"))  # fmt: skip
    tip, gap = ("x1", "z1"), ("nan", "nan")
    barbs = (("x1 - head * (u + 0.4 * w)", "z1 - head * (w - 0.4 * u)"), tip,
             ("x1 - head * (u - 0.4 * w)", "z1 - head * (w + 0.4 * u)"))  # fmt: skip
    points = (("x0", "z0"), tip, gap, *barbs, gap)
    return Part(name, Look(stroke="ink", width=width), name, points, let, (f"long > {SHORTEST} * unit",), ())


_STRIP = (("a", "max(begin, left)"), ("b", "min(end, right)"), ("c", "max(bottom, low)"))
_SEEN = ("a < b", "c < top")
_LEFT, _RIGHT = "left - 0.05", "right + 0.05"  # the surface is drawn past the view


def _surface(name: str, look: Look, z: str, level: str = "0") -> Part:
    ends = ((_LEFT, level), (_RIGHT, level))
    return Part(name, look, "surface", (("x", z),), (), (f"{_LEFT} < x", f"x < {_RIGHT}"), ends)


PARTS = (
    Part("sand", Look(fill="sand"), "view", _box("left", "right", "low", "0")),
    *(Part(kind, Look("sand", "surface", 0.4), kind, _box("a", "b", "c", "top"), _STRIP, _SEEN)
      for kind in ("layer", "patch")),
    _surface("print", Look(fill="paper"), "min(z, 0)", "0.1 * unit"),  # the edges of strips end at prints
    _surface("rim", Look(fill="sand"), "max(z, 0)"),
    _surface("surface", Look(stroke="surface", width=1.1), "z"),
    Part("ghost", Look(stroke="flat", width=1.2, dashes=(4, 3)), "ghost", "line"),
    *_foot("left"),
    *_foot("right"),
    Part("edge", Look(stroke="ink", width=5.2), "edge", "line"),  # of a sole that is coloured by a quantity
    Part("paint", Look(stroke="ink", width=3.4), "paint", "line"),
    _arrows("force", 1.0, "x - close * u", "z - close * w", "metres * fx", "metres * fz"),
    _arrows("key", 1.0, "left + unit", "low + 1.5 * unit", "metres * newtons", "0"),
    _arrows("gravity", 1.4, "right - 4 * unit", "high - 5.4 * unit", "6 * unit * x", "6 * unit * z"),
    Part("hip", Look(stroke="ink", width=9.0, dots=True), "hip", (("x", "z"),)),
)  # fmt: skip

WORDS = (
    Word("layer", (("b - 0.6 * unit", "max(c + 1.3 * unit, top - 3 * unit)"),), "end", _STRIP, _SEEN),
    Word("patch", (("a + 0.6 * unit", "min(top - 1.6 * unit, low + (1.5 + 4.2 * close) * unit)"),), "start",
         _STRIP, (*_SEEN, "letters * unit <= b - a")),  # where enough of it is seen for its name
    Word("gravity", (("right - unit", "high - 1.5 * unit"),), "end"),
    Word("slope", (("right - unit", "high - 4 * unit"),), "end"),
    Word("key", (("left + metres * newtons + 2 * unit", "low + 1.5 * unit"),)),
    # beside the key, or above it
    Word("drawn", (("right - unit", "low + (1.5 + 2.1 * (right - left <= 70 * unit)) * unit"),), "end", (),
         ("close",)),
    *(Word(side, (("x", "z + 5.5 * unit"),), "middle", (),
           ("close", "left + 3 * unit < x", "x < right - 3 * unit")) for side, _ in SIDES),
)  # fmt: skip
LOOKS = {part.name: part.look for part in PARTS}
DRAWN = {"text": "print drawn, not computed"}
_CALLS = {"min": min, "max": max, "hypot": math.hypot, "nan": math.nan}


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
    anchor: str


def shapes(things: Things, view: View) -> tuple[list[Shape], list[Label]]:
    """Parts and words of what is there, in order."""
    seen, found, labels = view._asdict(), [], []
    for part in PARTS:
        lines = [(_places(part, seen, thing), thing.get("colour", "")) for thing in things.get(part.of, ())]
        if part.ends is not None and lines:
            ends = list(_places(Word("", part.ends), seen, {}))
            lines = [([*ends[:1], *(place for line, _ in lines for place in line), *ends[1:]], "")]
        found += [Shape(part.name, np.reshape(line, (-1, 2)), colour) for line, colour in lines if len(line)]
    for word in WORDS:
        for thing in things.get(word.of, ()):
            labels += [Label(x, z, thing["text"], word.anchor) for x, z in _places(word, seen, thing)]
    return found, labels


def _places(part: Part | Word, view: Mapping[str, Any], thing: Mapping[str, Any]) -> Sequence[Any]:
    """Where a part of a thing is, m; nothing where it is not seen."""
    if isinstance(part.points, str):
        line: Sequence[Any] = thing[part.points]
        return line
    names = {**view, **thing}
    for name, formula in part.let:
        names[name] = _value(formula, names)
    seen = all(_value(formula, names) for formula in part.when)
    return [(_value(x, names), _value(z, names)) for x, z in part.points] if seen else ()


def _value(formula: str, names: dict[str, Any]) -> Any:
    return eval(_code(formula), _CALLS, names)


@cache
def _code(formula: str) -> Any:
    return compile(formula, "<picture>", "eval")


def script() -> str:
    """`PARTS` and `WORDS` for the page's script: their formulas as its functions."""
    parts = [
        f"{{ name: {part.name!r}, of: {part.of!r}, dots: {str(part.look.dots).lower()}, "
        f"own: {'fill' if part.look.fill else 'stroke'!r}, points: {_function(part)}, "
        f"ends: {'null' if part.ends is None else _function(Word('', part.ends))} }},"
        for part in PARTS
    ]
    words = [f"{{ of: {word.of!r}, anchor: {word.anchor!r}, points: {_function(word)} }}," for word in WORDS]
    calls = "const { min, max, hypot } = Math, nan = NaN;"
    return "\n".join([calls, "const PARTS = [", *parts, "];", "const WORDS = [", *words, "];"])


def _function(part: Part | Word) -> str:
    """The places of a part in JavaScript."""
    if isinstance(part.points, str):
        return f"(view, thing) => thing.{part.points}"
    points = ", ".join(f"[{x}, {z}]" for x, z in part.points)
    formulas = " ".join([points, *(formula for _, formula in part.let), *part.when])
    used = set(re.findall(r"[a-z]\w*", formulas)) - {*_CALLS, *dict(part.let)}
    view, own = (", ".join(sorted(names)) for names in (used & {*View._fields}, used - {*View._fields}))
    let = "".join(f"const {name} = {formula}; " for name, formula in part.let)
    seen = " && ".join(part.when) or "true"
    return f"({{ {view} }}, {{ {own} }}) => {{ {let}return {seen} ? [{points}] : []; }}"


def css() -> str:
    """The looks as the page's style: rules for elements of a part's name."""
    rules = []
    for name, look in LOOKS.items():
        roles = (("fill", look.fill), ("stroke", look.stroke))
        rule = [f"{kind}: {f'var(--{role})' if role else 'none'}" for kind, role in roles]
        rule += [f"stroke-width: {look.width:g}pt"] * bool(look.stroke)
        rule += [f"opacity: {look.opacity:g}"] * (look.opacity < 1.0)
        rule += [f"stroke-dasharray: {' '.join(map(str, look.dashes))}"] * bool(look.dashes)
        rules.append(f".{name} {{ {'; '.join(rule)}; }}")
    return "\n".join(rules)
