"""Dimensionless numbers that estimate which effects matter before a scene is simulated.

The number of an effect, or of something that footopt lacks, is about its share of the force on a foot, within
a factor of two or so. `footopt.studies.audit` simulates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from footopt.effects import EFFECTS
from footopt.foot import Foot
from footopt.report import terminal
from footopt.walk.scene import SOLE, Scene

# assumed of the sand: quartz as on a beach
DENSITY = 1600.0  # kg/m^3
GRAIN = 3e-4  # m
COHESION, INNER = 1.04e3, math.radians(28.0)  # Pa, and angle of friction: a dry sand in Wong (2008)
FRICTION = 0.5  # of sand on a face, and of its pressure sideways over that from above: assumed
CONE = math.radians(60.0)  # of the sand that moves with a foot at impact: assumed

EFFECT, LACKS = "effect", "not in footopt"
ABOVE = {EFFECT: "called for", LACKS: "may matter"}  # verdicts above the threshold


@dataclass(frozen=True)
class Criterion:
    """A dimensionless number of a scene, and its threshold."""

    name: str  # of the effect
    kind: str  # EFFECT or LACKS
    number: str  # the formula, in words
    value: float
    threshold: float  # above which it matters
    source: str  # of number and threshold
    on: bool = False  # whether the scene has the effect

    @property
    def verdict(self) -> str:
        """In words."""
        return "is on" if self.on else "small" if self.value <= self.threshold else ABOVE[self.kind]


def bearing_factor(friction: float) -> float:
    """N_c of cohesion in the bearing capacity of a strip (Prandtl 1921), of an angle of friction, rad."""
    n_q = math.exp(math.pi * math.tan(friction)) * math.tan(math.pi / 4 + friction / 2) ** 2
    return (n_q - 1.0) / math.tan(friction)


def screening(scene: Scene, feet: Sequence[Foot], tolerance: float = 0.01) -> list[Criterion]:
    """Screen a scene for effects, and for effects that footopt lacks.

    Parameters
    ----------
    scene : Scene
        The scene to simulate.
    feet : sequence of Foot
        Their medians count.
    tolerance : float
        The relative change that matters.
    """
    scale = scene.scale
    size = np.median([[*np.ptp(foot.contour, axis=0), foot.width, foot.hollow] for foot in feet], axis=0)
    length, _, width, hollow = (float(v) for v in size)
    area = length * width
    depth = scale.depth * SOLE / area
    scale = scale._replace(depth=depth, hollow=hollow, sweep=scene.sweep(depth))
    g, weight, speed = scene.walker.g, scene.walker.weight, scale.speed
    cone = DENSITY * area * math.sqrt(area / math.pi) * math.tan(CONE) / 3.0
    sides = (length + width) * depth**2 * DENSITY * g * FRICTION**2

    found = []
    for name, kind in EFFECTS.items():
        given = next((effect for effect in scene.effects if isinstance(effect, kind)), None)
        if given is None and not kind.literature:  # such an effect says what the ground is like
            continue
        effect = given or kind()
        if not math.isnan(value := effect.estimate(scale)):
            about = (name.replace("_", " "), EFFECT, effect.number, value, tolerance, effect.source)
            found.append(Criterion(*about, on=given is not None))
    rows = [
        ("cohesion", LACKS, "N_c c / pressure of the foot",
         bearing_factor(INNER) * COHESION * area / weight, tolerance,
         "N_c: Prandtl (1921); c 1.04 kPa, 28 deg: a dry sand, Wong (2008)"),
        ("added mass at impact", LACKS, "m v^2 / (z weight)", cone * speed**2 / (depth * weight),
         tolerance, "added mass: Aguilar & Goldman (2016); a cone of 60 deg, assumed"),
        ("sides of the foot", LACKS, "friction on them / weight", sides / weight, tolerance,
         "pressure at rest 0.5, friction 0.5, assumed"),
        ("grains", LACKS, "grain / depth", GRAIN / depth, 0.1, "grains of 0.3 mm, ten for a continuum"),
    ]  # fmt: skip
    return [*found, *(Criterion(*row) for row in rows)]


def table(found: Sequence[Criterion]) -> Table:
    """The numbers of a scene for the terminal."""
    shown = terminal.table(("effect", "number", "value", "limit", "verdict"), ("effect", "number", "verdict"))
    shown.title = "Estimates before the scene is simulated: a number above its limit matters"
    for c in found:
        style = "yellow" if c.verdict == ABOVE[c.kind] else ""
        verdict = Text(f"{c.kind}: {c.verdict}", style=style)
        shown.add_row(c.name, c.number, f"{c.value:.2g}", f"{c.threshold:g}", verdict)
    return shown


def entry(found: Sequence[Criterion]) -> list[dict[str, Any]]:
    """The numbers of a scene in result.json."""
    return [asdict(c) | {"verdict": c.verdict} for c in found]
