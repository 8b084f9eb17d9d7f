"""3D-RFT: the stress on a face of any body, and what makes it that of a certain sand.

Agarwal, Goldman & Kamrin, PNAS 120, e2214017120 (2023). With the face's outward normal n, the direction h of
its motion and the direction g of gravity, the stress per depth is

    xi (f1 n + f2 h + f3 g),   f_i polynomials of (h.g, n.g, n.h), where n.h > 0; else 0.

The paper writes it in angles beta, gamma and psi about a frame that turns with the motion, which has no
direction where the motion is vertical; the vectors have no such place. Its tangential part is at most the
friction of the surface times the normal part.
"""

from dataclasses import dataclass

import numpy as np

from footopt.errors import check
from footopt.sand.law import EARTH, PER_CM3
from footopt.sand.media import Sand

#: f1, f2 and f3 (the paper's table S1) in 1, x1, x2, x3, x1^2, x2^2, x3^2, x1 x2, x2 x3, x3 x1, x1^3, x2^3,
#: x3^3, x1 x2^2, x2 x1^2, x2 x3^2, x3 x2^2, x3 x1^2, x1 x3^2, x1 x2 x3 with x1 = h.g, x2 = n.g, x3 = n.h.
#: Public copies differ in one number, x3 x2^2 of f2: with .18589 alpha_z(0, 90 deg) is .87504.
TABLE = np.array([
    [0.00212, -0.02320, -0.20890, -0.43083, -0.00259, 0.48872, -0.00415, 0.07204, -0.02750, -0.08772,
     0.01992, -0.45961, 0.40799, -0.10107, -0.06576, 0.05664, -0.09269, 0.01892, 0.01033, 0.15120],
    [-0.06796, -0.10941, 0.04725, -0.06914, -0.05835, -0.65880, -0.11985, -0.25739, -0.26834, 0.02692,
     -0.00736, 0.63758, 0.08997, 0.21069, 0.04748, 0.20406, 0.18519, 0.04934, 0.13527, -0.33207],
    [-0.02634, -0.03436, 0.45256, 0.00835, 0.02553, -1.31290, -0.05532, 0.06790, -0.16404, 0.02287,
     0.02927, 0.95406, -0.00131, -0.11028, 0.01487, -0.02730, 0.10911, -0.04097, 0.07881, -0.27519],
])  # fmt: skip

DOWN = 0.87574  # alpha_z of a level face that moves down: the sum of the table, its sign changed


@dataclass(frozen=True)
class Grains:
    """A sand as 3D-RFT takes it, where it is known by its density and friction.

    Parameters
    ----------
    density : float, kg/m^3
        Bulk density.
    friction : float
        Tangent of the angle of internal friction.
    surface : float
        Friction of the body's surface against the grains.

    Raises
    ------
    SettingError
        A number is out of range.
    """

    density: float = 1550.0
    friction: float = 0.67
    surface: float = 0.4

    def __post_init__(self) -> None:
        check(1 <= self.density <= 1e5, "grains.density", self.density, "a density from 1 to 1e5, in kg/m^3")
        check(0.01 <= self.friction <= 2, "grains.friction", self.friction, "a number from 0.01 to 2")
        check(0 <= self.surface <= 10, "grains.surface", self.surface, "a number from 0 to 10")

    @property
    def xi(self) -> float:
        """The material constant, N/m^3: eq. 3 of Agarwal et al. 2023, fitted for mu of 0.3 to 0.9."""
        mu = self.friction
        return self.density * EARTH * (894.0 * mu**3 - 386.0 * mu**2 + 89.0 * mu)

    @property
    def sand(self) -> Sand:
        """The planar map's sand on which a level plate that moves down feels the same."""
        return Sand(self.xi * DOWN / PER_CM3, name="grains")


def xi_of(sand: Sand) -> float:
    """The material constant of the planar map's sand, N/m^3: equal where a level face moves down."""
    return sand.zeta * PER_CM3 / DOWN
