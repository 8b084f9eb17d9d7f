"""The walker of the paper: a mass on two massless legs."""

from dataclasses import dataclass

from footopt.errors import check
from footopt.sand.law import EARTH

#: Units and ranges of a walker's numbers, from an insect to an excavator that walks.
WALKERS = {
    "mass": ("kg", 1e-9, 1e9),
    "l1": ("m", 1e-4, 10.0),
    "l2": ("m", 1e-4, 10.0),
    "g": ("m/s^2", 1e-6, 1e6),
}


@dataclass(frozen=True)
class Walker:
    """A biped with all its mass at the hip and massless legs (the paper's table 1).

    Parameters
    ----------
    mass : float, kg
        Of the whole walker, M.
    l1 : float, m
        Length of a thigh.
    l2 : float, m
        Length of a shank.
    g : float, m/s^2
        Gravity. The sand's strength is in proportion to it: see `Scene.zeta`.

    Raises
    ------
    SettingError
        A number is not in `WALKERS`' range.
    """

    mass: float = 60.0
    l1: float = 0.47
    l2: float = 0.45
    g: float = EARTH

    def __post_init__(self) -> None:
        for name, (unit, low, high) in WALKERS.items():
            value = getattr(self, name)
            allowed = f"a number > 0, from {low:g} to {high:g}, in {unit}"
            check(low <= value <= high, f"walker.{name}", value, allowed)

    @property
    def weight(self) -> float:
        """M g, N."""
        return self.mass * self.g
