"""Rest: the sand holds what stands on it, by bristles in place of the creep speed."""

from dataclasses import dataclass

from footopt.effects.base import BRISTLE_LENGTH, Effect
from footopt.errors import check_number


@dataclass(frozen=True)
class Rest(Effect, name="rest"):
    """Friction with memory: a standing walker does not sink, and the sand carries it from the first instant.

    The direction h of a plate in the sand follows its motion over a length delta, damped, and stays in the
    unit disc (`footopt.walk.bristles`), so that at rest the force is what balance needs. Without it
    h = v / sqrt(|v|^2 + eps^2), and a walker that stands sinks on at about the creep speed eps.

    Source: an elastic displacement in friction, Dahl, "A solid friction model", The Aerospace Corporation
    (1968), damped as by Dupont, Hayward, Armstrong & Altpeter, IEEE Trans. Automatic Control 47 (2002), and
    applied to every plate of RFT. Range: delta is a numerical length as it stands. Forces in sand build up
    over about a millimetre; a delta like that makes the sand springy, which no experiment here supports.

    Parameters
    ----------
    length : float, m
        delta. On hard sand 1e-6 changes the objectives of 95 % of walks by less than 0.3 %, 1e-5 by 1.6 %;
        for a walker of a tenth of the size, a tenth of these lengths does.

    Raises
    ------
    SettingError
        The length is beyond 1e-8 to 1e-3 m.
    """

    length: float = BRISTLE_LENGTH

    def __post_init__(self) -> None:
        hint = "It is over that length that the force builds up; 1e-6 changes walks by less than 0.5 %."
        allowed = "a length from 1e-8 to 1e-3, in m"
        check_number("effects.rest.length", self.length, 1e-8, 1e-3, allowed, hint)

    @property
    def bristle_length(self) -> float:
        """delta, m."""
        return float(self.length)
