"""The grains' inertia: a face that leads throws sand aside."""

from dataclasses import dataclass
from typing import NamedTuple

from footopt.effects.base import Effect
from footopt.effects.dual import clipped, positive
from footopt.errors import check_number


class InertiaLaw(NamedTuple):
    """lambda rho, kg/m^3, and the depth at which the traction reaches its full value, m."""

    density: float
    skin: float

    def push(self, vn, depth):
        """lambda rho (n.v)^2, in proportion to the depth within the skin."""
        speed = positive(vn)
        return self.density * speed * speed * clipped(depth / self.skin, 0.0, 1.0)


@dataclass(frozen=True)
class Inertia(Effect, name="inertia"):
    """The sand that a leading face throws aside: a traction -n lambda rho (n.v)^2 for n.v > 0.

    Source: dynamic RFT, Agarwal, Karsai, Goldman & Kamrin, Science Advances 7 (2021). Range: their drag
    test, F = K |z| + lambda rho A v^2 with lambda 1.1, had a plate 0.016 m long, 20-40 mm deep, at
    0.04-0.64 m/s, in grains of 900 kg/m^3.

    Parameters
    ----------
    factor : float
        lambda, the factor of the inertial stress rho v^2, without a unit.
    rho : float, kg/m^3
        Bulk density of the sand (quartz sand about 1600).
    skin : float, m
        Depth below which the full traction acts; above it the traction is proportional to the depth, so that
        there is no jump at the surface. A numerical parameter: scale it with the size of a small walker.

    Raises
    ------
    SettingError
        A number is negative or absurdly large.
    """

    factor: float = 1.1
    rho: float = 1600.0
    skin: float = 1e-3
    literature, is_inertia, in_page = True, True, True

    def __post_init__(self) -> None:
        check_number("effects.inertia.factor", self.factor, 0, 1e3, "a number >= 0 and <= 1000")
        check_number("effects.inertia.rho", self.rho, 0, 1e5, "a density >= 0 and <= 1e5, in kg/m^3")
        check_number("effects.inertia.skin", self.skin, 1e-9, 1, "a depth from 1e-9 to 1, in m")

    @property
    def law(self) -> InertiaLaw:
        """lambda rho, and the skin."""
        return InertiaLaw(self.factor * self.rho, self.skin)
