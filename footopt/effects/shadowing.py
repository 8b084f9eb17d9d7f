"""Shadowing: the sand that rests in a groove of the sole moves with the foot."""

from dataclasses import dataclass

from footopt.arrays import Array
from footopt.effects.base import Effect
from footopt.effects.hull import filled
from footopt.errors import check_number


@dataclass(frozen=True)
class Shadowing(Effect, name="shadowing"):
    """A groove counts with a part of its depth: the sole comes nearer to its lower convex hull.

    Each point of the sole is moved straight down, in the foot frame, until its gap to the convex hull is
    `effective` times what it was; plates are cut from that sole. A convex sole stays as it is.

    Source: Agarwal, Karsai, Goldman & Kamrin, Science Advances 7 (2021), who let a third of the height of a
    wheel's grousers count. Range: grooves that are narrow, and sand that has come to rest in them. The law
    does not know where the foot moves.

    Parameters
    ----------
    effective : float
        The part of a groove's depth that counts: 1 is the plain law, 0 the hull.

    Raises
    ------
    SettingError
        The part is not from 0 to 1.
    """

    effective: float = 1.0 / 3.0
    literature = plausible = True

    def __post_init__(self) -> None:
        check_number("effects.shadowing.effective", self.effective, 0, 1, "a part, from 0 to 1")

    def reshape(self, points: Array) -> Array:
        """Soles (designs, points, 2), m, with what is left of their grooves."""
        return filled(points, self.effective)
