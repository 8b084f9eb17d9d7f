"""What is seen of a scene besides the walker: sand of other strengths, and the pull of gravity.

Figures, films and the page draw the same pieces.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import to_hex, to_rgb

from footopt.effects import Layers, Patches, Slope
from footopt.report.style import SAND, STRONG_SAND
from footopt.walk import Scene


class Strip(NamedTuple):
    """Sand of another strength than the scene's, between two x and two z, m; darker is stronger."""

    begin: float  # -inf: from wherever the view begins
    end: float
    top: float
    bottom: float  # -inf: down to wherever the view ends
    factor: float
    colour: str
    kind: str  # "layer" or "patch"

    @property
    def label(self) -> str:
        """Its strength, by that of the scene's sand."""
        return f"{self.kind} \N{MULTIPLICATION SIGN} {self.factor:g}"


class Pull(NamedTuple):
    """Gravity in the axes of the page, along the slope and normal to it."""

    x: float  # of a unit vector
    z: float
    label: str


def strips(scene: Scene) -> list[Strip]:
    """Layers and patches of a scene, from the deepest upwards."""
    found = []
    for effect in scene.effects:
        if isinstance(effect, Layers):
            ends = [*(-d for d in effect.depths), -math.inf]
            for top, bottom, factor in zip(ends, ends[1:], effect.factors, strict=False):
                found.append(Strip(-math.inf, math.inf, top, bottom, factor, _shade(factor), "layer"))
        if isinstance(effect, Patches):
            for begin, end, factor in zip(effect.begins, effect.ends, effect.factors, strict=True):
                found.append(Strip(begin, end, 0.0, -math.inf, factor, _shade(factor), "patch"))
    return found


def pull(scene: Scene) -> Pull | None:
    """Where gravity pulls, where it is not straight down."""
    for effect in scene.effects:
        if isinstance(effect, Slope):
            x, z = ((part or 0.0) / scene.walker.g for part in scene.gravity)
            way = "uphill" if effect.angle > 0 else "downhill"
            words = f"g = {scene.walker.g:g} m/s², {abs(effect.angle):g}° {way}"
            return Pull(x, -abs(z), words)
    return None


def scenery(scene: Scene) -> dict[str, Any]:
    """Strips and gravity as the page has them."""
    found = pull(scene)
    return {
        "strips": [strip._asdict() | {"label": strip.label} for strip in strips(scene)],
        "gravity": found and found._asdict(),
    }


def _shade(factor: float) -> str:
    weight = float(np.clip(0.7 * np.log10(factor), -0.8, 0.6)) if factor > 0.0 else -0.8
    goal = np.array(to_rgb("white" if weight < 0 else STRONG_SAND))
    return to_hex((1.0 - abs(weight)) * np.array(to_rgb(SAND)) + abs(weight) * goal)
