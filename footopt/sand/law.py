"""Resistive force theory (RFT): the stress on one plate, in its angles; sands by name.

A plate with world angle beta (counter-clockwise, rad) that moves in the direction gamma
(rad, positive downwards: gamma = atan2(-v_z, v_x)) at depth |z| below the surface feels

    f_x = -zeta alpha_x(beta, gamma) |z| dA,    f_z = +zeta alpha_z(beta, gamma) |z| dA

with nine Fourier coefficients (Li, Zhang & Goldman, Science 339, 2013, table S2): the paper's eq. 1.
`alpha` is that map as published. With c = cos 2 beta, s = sin 2 beta and h = (cos gamma, -sin gamma) it is
anisotropic dry friction with a bias, f / (zeta |z| dA) = a - M h (`footopt.walk.contact.resistance`)::

    a = ( -D10 s,  A00 + A10 c )
    M = [ C01 + (C11 + C-11) c      (C11 - C-11) s       ]
        [ -(B11 - B-11) s           B01 + (B11 + B-11) c ]
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array
from footopt.errors import check, is_number

LARGEST = 1e4  # of a coefficient, N/cm^3; concrete has less
PER_CM3 = 1e6  # N/cm^3 in N/m^3
EARTH = 9.81  # m/s^2: g where stress maps are measured


@dataclass(frozen=True)
class StressMap:
    """The nine Fourier coefficients of the stresses per depth, in N/cm^3.

    ``Bm11`` and ``Cm11`` are the (-1, 1) terms. Defaults: the generic map of Li, Zhang & Goldman,
    Science 339 (2013), table S2.

    Raises
    ------
    SettingError
        A coefficient is not a number, or beyond `LARGEST`.
    """

    A00: float = 0.206
    A10: float = 0.169
    B11: float = 0.212
    B01: float = 0.358
    Bm11: float = 0.055
    C11: float = -0.124
    C01: float = 0.253
    Cm11: float = 0.007
    D10: float = 0.088

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            allowed = f"from -{LARGEST:g} to {LARGEST:g}, in N/cm^3"
            check(abs(value) <= LARGEST, f"sand.coefficients.{f.name}", value, allowed)

    @property
    def law(self) -> Law:
        """The coefficients as the affine form uses them (N/cm^3)."""
        b = self.B01, self.B11 + self.Bm11, self.B11 - self.Bm11
        c = self.C01, self.C11 + self.Cm11, self.C11 - self.Cm11
        return Law(self.A00, self.A10, *b, *c, self.D10)

    def dissipation(self) -> float:
        """Smallest `power_taken` over all angles, N/cm^3: 0.054 of the generic map.

        A law below zero somewhere gives energy to the walker there. Mirrored plates take the same power.
        """
        beta, gamma = np.meshgrid(np.linspace(0.0, np.pi / 2, 91), np.linspace(-np.pi, np.pi, 361))
        return float(np.min(power_taken(beta, gamma, self))) / PER_CM3


class Law(NamedTuple):
    """Coefficients of the affine form, N/cm^3; compiled code gets them times zeta, in N/m^3."""

    A00: float
    A10: float
    B01: float
    B_sum: float  # B11 + B-11
    B_diff: float  # B11 - B-11
    C01: float
    C_sum: float  # C11 + C-11
    C_diff: float  # C11 - C-11
    D10: float


GENERIC = StressMap()


def alpha(beta: ArrayLike, gamma: ArrayLike, stress_map: StressMap = GENERIC) -> tuple[Array, Array]:
    """Stresses per depth from the angles: the reference that every fast form is tested against.

    Parameters
    ----------
    beta : array_like, rad
        Angle of the plate in the world, counter-clockwise from the x-axis.
    gamma : array_like, rad
        Direction of motion, atan2(-v_z, v_x): positive when the plate moves down.
    stress_map : StressMap
        The nine coefficients.

    Returns
    -------
    alpha_x, alpha_z : arrays of the broadcast shape, N/m^3 (for zeta = 1)

    Notes
    -----
    Li, Zhang & Goldman, Science 339 (2013), eq. S1 with table S2. The reflection
    alpha_z(-beta, pi - gamma) = alpha_z, alpha_x(-beta, pi - gamma) = -alpha_x holds identically,
    so |gamma| > 90 deg needs no branch.
    """
    b, g, m = np.asarray(beta, float), np.asarray(gamma, float), stress_map
    az = (
        m.A00
        + m.A10 * np.cos(2 * b)
        + m.B11 * np.sin(2 * b + g)
        + m.B01 * np.sin(g)
        + m.Bm11 * np.sin(-2 * b + g)
    )
    ax = m.C11 * np.cos(2 * b + g) + m.C01 * np.cos(g) + m.Cm11 * np.cos(-2 * b + g) + m.D10 * np.sin(2 * b)
    return PER_CM3 * ax, PER_CM3 * az


def power_taken(beta: ArrayLike, gamma: ArrayLike, stress_map: StressMap = GENERIC) -> Array:
    """The power that the sand takes per depth, area and speed, N/m^3 (for zeta = 1); as of `alpha`."""
    ax, az = alpha(beta, gamma, stress_map)
    return np.asarray(ax * np.cos(gamma) + az * np.sin(gamma))


#: zeta of sands by name: the paper's three, and media measured in the literature
#: (Agarwal et al., J. Terramechanics 85, 2019; Treers, Cao & Stuart, IEEE RA-L 6, 2021).
MEDIA: dict[str, float] = {
    "soft": 0.2,
    "regular": 1.0,
    "hard": 5.0,
    "poppy_loose": 0.35,
    "poppy_close": 0.55,
    "glass_beads": 0.33,
    "medium_sand": 2.02,
    "mars_simulant": 3.05,
}


@dataclass(frozen=True)
class Sand:
    """A dry granular medium: a stress map and its scale.

    Parameters
    ----------
    zeta : float > 0
        Scale of the map (1 is the generic material).
    stress_map : StressMap
        Nine coefficients, N/cm^3.
    name : str
        For tables and legends.
    fit_error : (x, z), optional
        Rms misfit of a fitted table over the table's own rms, per component; None if the map was not
        fitted.

    Raises
    ------
    SettingError
        zeta is not a number from 1e-6 to 1e6.
    """

    zeta: float = 1.0
    stress_map: StressMap = GENERIC
    name: str = "custom"
    fit_error: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        allowed = "a number > 0, from 1e-6 to 1e6 (soft sand 0.2, the generic material 1, hard sand 5)"
        good = is_number(self.zeta) and 1e-6 <= self.zeta <= 1e6
        check(good, "sand.zeta", self.zeta, allowed, "Try sand=regular or sand.zeta=1.")

    @property
    def title(self) -> str:
        """By its name, or by its strength if it has none."""
        return f"sand of zeta {self.zeta:g}" if self.name == Sand.name else f"{self.name} sand"

    @classmethod
    def named(cls, name: str) -> Self:
        """A sand of `MEDIA` by its name."""
        check(name in MEDIA, "sand", name, f"one of {', '.join(MEDIA)}", "Or give sand.zeta.")
        return cls(zeta=MEDIA[name], name=name)
