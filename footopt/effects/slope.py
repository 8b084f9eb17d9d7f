"""An inclined plane: gravity tilts in its frame. No other file knows how."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from footopt.compiled import inlined
from footopt.effects.base import EFFECTS, Effect, Scale
from footopt.errors import check


@dataclass(frozen=True)
class Slope:
    """A plane inclined by an angle, uphill positive.

    x runs along the surface, z along its normal, and so do depth, angles of the gait, distance and
    height. Source: mechanics. Range: the stress map is the level one, which holds well below the angle of
    repose.

    Parameters
    ----------
    angle : float, deg
        Between -25 and 25: dry sand slides at about 30.

    Raises
    ------
    SettingError
        The angle is beyond these.
    """

    angle: float = 5.0
    law = None
    number = "weight along the plane / weight"

    def __post_init__(self) -> None:
        check(
            -25 <= self.angle <= 25,
            "effects.slope.angle",
            self.angle,
            "an angle from -25 to 25, in deg",
            "Dry sand itself slides at about 30 deg.",
        )

    @property
    def nothing(self) -> bool:
        """Whether the plane is level."""
        return self.angle == 0.0

    def estimate(self, scale: Scale) -> float:
        """Weight along the plane over weight."""
        return abs(math.sin(math.radians(self.angle)))


def gravity(effects: Sequence[Effect], g: float) -> tuple[float | None, float]:
    """Gravity along the surface (negative uphill; None if it is level) and against its normal, m/s^2."""
    for effect in effects:
        if isinstance(effect, Slope):
            angle = math.radians(effect.angle)
            return -g * math.sin(angle), g * math.cos(angle)
    return None, g


@inlined
def tilted(value, tilt, time):
    """What gravity along the surface adds to a velocity (m/s) in a time (s); with 1 s, to an acceleration.

    tilt: m/s^2; None on level ground, where nothing is compiled.
    """
    if tilt is None:
        return value
    return value + time * tilt


EFFECTS["slope"] = Slope
