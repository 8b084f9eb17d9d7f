"""An inclined plane: gravity tilts in its frame."""

import math
from dataclasses import dataclass

from footopt.effects.base import Effect
from footopt.errors import check_number


@dataclass(frozen=True)
class Slope(Effect, name="slope"):
    """A plane inclined by an angle, uphill positive.

    x runs along the surface, z along its normal, and so do depth, angles of the gait, distance and
    height. Source: mechanics. Range: the stress map is the level one, which holds well below the angle of
    repose.

    Parameters
    ----------
    angle : float, deg
        Uphill positive; between -25 and 25, as dry sand slides at about 30.

    Raises
    ------
    SettingError
        The angle is beyond these.
    """

    angle: float = 5.0
    in_page = True

    def __post_init__(self) -> None:
        allowed, hint = "an angle from -25 to 25, in deg", "Dry sand itself slides at about 30 deg."
        check_number("effects.slope.angle", self.angle, -25, 25, allowed, hint)

    def gravity(self, g: float) -> tuple[float, float]:
        """-g sin(angle) along the plane, g cos(angle) against its normal."""
        angle = math.radians(self.angle)
        return -g * math.sin(angle), g * math.cos(angle)
