"""Resistive force theory (RFT): the stress on one plate, in its angles, and fitted to a table; sands by name.

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

from dataclasses import dataclass, fields
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array
from footopt.errors import Unusable, check, check_kind, check_number

LARGEST = 1e4  # of a coefficient, N/cm^3; concrete has less
PER_CM3 = 1e6  # N/cm^3 in N/m^3
EARTH = 9.81  # m/s^2: g where stress maps are measured
MISFIT = 0.35  # of a column's rms: a table with a larger misfit does not follow a law of this form
GAIN = 0.1  # of the table's rms: a sand that supplies more power than this is not explained by noise
STRESSES = (1e-3, 50.0)  # largest stress of a table, N/cm^3; the hardest sand in the literature has 2


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
            check_number(f"sand.coefficients.{f.name}", value, -LARGEST, LARGEST, allowed)

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
    """Power that the sand takes per depth, area and speed, N/m^3 (for zeta = 1); arguments as in `alpha`."""
    ax, az = alpha(beta, gamma, stress_map)
    return np.asarray(ax * np.cos(gamma) + az * np.sin(gamma))


def fit_stress_map(
    beta: Array, gamma: Array, alpha_x: Array, alpha_z: Array
) -> tuple[StressMap, tuple[float, float]]:
    """Fit the nine coefficients to measured stresses by linear least squares.

    Angles of plate and motion (rows,), deg, have the signs of `footopt.sand.law.alpha`; stresses per depth
    (rows,) are in N/cm^3. Returns the map, and for x and z the rms of the misfit over that of the column.
    Raises `Unusable` if there are too few different angles to determine nine coefficients, or if no sand can
    have such stresses.
    """
    b, g = np.radians(beta), np.radians(gamma)
    terms_x = [np.cos(2 * b + g), np.cos(g), np.cos(-2 * b + g), np.sin(2 * b)]
    terms_z = [np.ones_like(b), np.cos(2 * b), np.sin(2 * b + g), np.sin(g), np.sin(-2 * b + g)]
    (C11, C01, Cm11, D10), error_x = _least_squares(terms_x, alpha_x)
    (A00, A10, B11, B01, Bm11), error_z = _least_squares(terms_z, alpha_z)
    stresses = np.stack([alpha_x, alpha_z])
    steepest, widest, largest = (abs(values).max() for values in (beta, gamma, stresses))
    if steepest > 180 or widest > 360:
        raise Unusable(f"beta reaches {steepest:.4g} and gamma {widest:.4g} deg. Check the columns.")
    if widest <= 2 * np.pi:
        raise Unusable(f"gamma reaches {widest:.4g} deg only. Angles must be in degrees.")
    if not STRESSES[0] <= largest <= STRESSES[1]:
        raise Unusable(
            f"its largest stress is {largest:.4g} N/cm^3, and that of sands {STRESSES[0]:g} to "
            f"{STRESSES[1]:g}. Stresses must be per depth, in N/cm^3 (1 N/cm^3 = 1e6 N/m^3)."
        )
    if (misfit := max(error_x, error_z)) > MISFIT:
        raise Unusable(f"no stress map comes near it (misfit {100 * misfit:.0f} %). Check columns and signs.")
    found = StressMap(A00, A10, B11, B01, Bm11, C11, C01, Cm11, D10)
    typical = float(np.sqrt(np.mean(stresses**2)))
    if (least := found.dissipation()) < -GAIN * typical:
        raise Unusable(
            f"such a sand would push a plate along (by {-least:.3g} N/cm^3 in some direction). Check the "
            "columns and the signs: a plate that moves down has gamma > 0 and alpha_z > 0."
        )
    aside = D10 - C11 + Cm11  # alpha_x of a plate at 45 deg that moves down
    if aside < -GAIN * typical:
        raise Unusable(
            f"such a sand would push a plate that moves down to its upper side (alpha_x = {aside:.3g} "
            "N/cm^3 at beta = 45, gamma = 90 deg). Check the sign of beta: counter-clockwise, + toe up."
        )
    for more, what in (
        (A00 + A10, "a level plate that is lifted more than one that is pushed in"),
        (A10 + B11 + Bm11, "a vertical plate that is pushed in more than a level one"),
    ):
        if more < -GAIN * typical:
            raise Unusable(
                f"such a sand would resist {what}. Check z, which is up, and beta, 0 for level plates."
            )
    return found, (error_x, error_z)


def _least_squares(terms: list[Array], target: Array) -> tuple[list[float], float]:
    """Coefficients of some terms, and the relative rms misfit of a column."""
    design = np.stack(terms, axis=1)
    solution, _, rank, _ = np.linalg.lstsq(design, target, rcond=1e-8)
    if rank < design.shape[1]:
        raise Unusable(f"{len(target)} rows do not determine it: give more combinations of beta and gamma.")
    misfit, scale = (float(np.sqrt(np.mean(v**2))) for v in (design @ solution - target, target))
    return solution.tolist(), misfit / scale if scale > 0 else misfit


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
        check_number("sand.zeta", self.zeta, 1e-6, 1e6, allowed, "Try sand=regular or sand.zeta=1.")
        check_kind("sand", self.stress_map, StressMap, "fo.StressMap(A00=0.2) changes a coefficient.")
        object.__setattr__(self, "zeta", float(self.zeta))  # 5 and 5.0 have the same designs in a store

    @property
    def title(self) -> str:
        """Its name, or its zeta if it has none, in words."""
        return f"sand of zeta {self.zeta:g}" if self.name == Sand.name else f"{self.name} sand"

    @classmethod
    def named(cls, name: str) -> Self:
        """A sand of `MEDIA` by its name."""
        check(name in MEDIA, "sand", name, f"one of {', '.join(MEDIA)}", "Or give sand.zeta.")
        return cls(zeta=MEDIA[name], name=name)
