"""Screening of a scene before anything walks: dimensionless numbers against thresholds with sources.

A number of an effect, or of something that footopt lacks, is about the share of the force on a foot that it
makes up. These are estimates within a factor of two or so; the audit (`footopt.studies.audit`) walks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from footopt.effects import EFFECTS
from footopt.foot import Foot
from footopt.walk.scene import SOLE, Scene

# assumed of the sand: quartz as on a beach
DENSITY = 1600.0  # kg/m^3
GRAIN = 3e-4  # m
COHESION, INNER = 1.04e3, math.radians(28.0)  # Pa, and angle of friction: a dry sand in Wong (2008)
FRICTION = 0.5  # of sand on a face, and of its pressure sideways over that from above: assumed
CONE = math.radians(60.0)  # of the sand that moves with a foot at impact: assumed


def bearing_factor(friction: float) -> float:
    """N_c of cohesion in the bearing capacity of a strip (Prandtl 1921), of an angle of friction, rad."""
    n_q = math.exp(math.pi * math.tan(friction)) * math.tan(math.pi / 4 + friction / 2) ** 2
    return (n_q - 1.0) / math.tan(friction)


EFFECT, RANGE, LACKS = "effect", "tested range", "not in footopt"


@dataclass(frozen=True)
class Criterion:
    """A dimensionless number of a scene, and its threshold.

    Parameters
    ----------
    name : str
        Of the effect, or of what is tested.
    kind : str
        `EFFECT`, `RANGE` or `LACKS`.
    number : str
        Its formula, in words.
    value : float
        Dimensionless.
    threshold : float
        Above which it matters.
    source : str
        Of number and threshold.
    on : bool
        Whether the scene has the effect.
    """

    name: str
    kind: str
    number: str
    value: float
    threshold: float
    source: str
    on: bool = False

    @property
    def above(self) -> bool:
        """Whether it matters, or is outside."""
        return not self.value <= self.threshold

    @property
    def verdict(self) -> str:
        """In words."""
        if self.kind == RANGE:
            return "outside" if self.above else "inside"
        if self.on:
            return "is on"
        if self.kind == LACKS:
            return "may matter" if self.above else "small"
        return "called for" if self.above else "small"

    @property
    def warning(self) -> str:
        """The warning where a scene is outside of the tested range; "" inside."""
        if self.kind != RANGE or not self.above:
            return ""
        about = f"{self.number} is about {self.value:.2g}"
        return f"{self.name}: {about}, tested to {self.threshold:g} ({self.source})"


def screening(scene: Scene, feet: Sequence[Foot], tolerance: float = 0.01) -> list[Criterion]:
    """Screen a scene.

    Parameters
    ----------
    scene : Scene
        The scene to simulate.
    feet : sequence of Foot
        Their medians count.
    tolerance : float
        The relative change that matters.

    Returns
    -------
    list of Criterion
        Of effects, of the law's tested ranges, and of effects that footopt lacks.
    """
    scale = scene.scale
    size = np.median([[*np.ptp(foot.contour, axis=0), foot.width, foot.hollow] for foot in feet], axis=0)
    length, _, width, hollow = (float(v) for v in size)
    area = length * width
    depth = scale.depth * SOLE / area
    ankle = float(np.median([foot.ankle[1] - foot.contour[:, 1].min() for foot in feet]))
    scale = scale._replace(depth=depth, hollow=hollow, sweep=scene.sweep(depth))
    g, weight, speed = scene.walker.g, scene.walker.weight, scale.speed

    found = []
    for name, kind in EFFECTS.items():
        given = next((effect for effect in scene.effects if isinstance(effect, kind)), None)
        if given is None and not kind.literature:  # such an effect says what the ground is like
            continue
        effect = given or kind()
        if math.isnan(value := effect.estimate(scale)):
            continue
        title, on = name.replace("_", " "), given is not None
        found.append(Criterion(title, EFFECT, effect.number, value, tolerance, effect.source, on))

    cone = DENSITY * area * math.sqrt(area / math.pi) * math.tan(CONE) / 3.0
    sides = (length + width) * depth**2 * DENSITY * g * FRICTION**2
    angle = math.degrees(math.atan2(abs(scene.gravity[0]), scene.gravity[1]))
    rows = [
        ("depth", RANGE, "depth / width of the foot", depth / width, 1.0, "Li, Zhang & Goldman (2013)"),
        ("ankle", RANGE, "depth / height of the ankle", depth / ankle if ankle > 0 else math.inf, 1.0,
         "the leg feels no sand"),
        ("speed", RANGE, "v / sqrt(g L)", speed / math.sqrt(g * length), 0.31,
         "0.5 m/s on the Earth; Li, Zhang & Goldman (2013)"),
        ("slope", RANGE, "angle / that of repose", angle / 30.0, 0.6,
         "the map is that of a level surface"),
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
