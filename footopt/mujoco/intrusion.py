"""3D-RFT: the stress on a face of any body, and what makes it that of a certain sand.

Agarwal, Goldman & Kamrin, PNAS 120, e2214017120 (2023). With the face's outward normal n, the direction h of
its motion and the direction g of gravity, the stress per depth is

    xi (f1 n + f2 h + f3 g),   f_i polynomials of (h.g, n.g, n.h), where n.h > 0; else 0.

The paper writes it in angles beta, gamma and psi about a frame that turns with the motion, which has no
direction where the motion is vertical; the vectors have no such place. Its tangential part is at most the
friction of the surface times the normal part.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footopt.compiled import inlined
from footopt.effects.leading_edge import leading_gate
from footopt.errors import check
from footopt.sand import Sand
from footopt.sand.law import PER_CM3
from footopt.walk.contact import EDGE
from footopt.walk.scene import EARTH

Array = NDArray[np.float64]

#: Rows: 1, x1, x2, x3, x1^2, x2^2, x3^2, x1 x2, x2 x3, x3 x1, x1^3, x2^3, x3^3, x1 x2^2, x2 x1^2, x2 x3^2,
#: x3 x2^2, x3 x1^2, x1 x3^2, x1 x2 x3 with x1 = h.g, x2 = n.g, x3 = n.h. Columns: f1, f2, f3 (the paper's
#: table S1). Public copies differ in one number, x3 x2^2 of f2: with .18589 alpha_z(0, 90 deg) is .87504.
TABLE = np.array(
    [
        (0.00212, -0.06796, -0.02634),
        (-0.02320, -0.10941, -0.03436),
        (-0.20890, 0.04725, 0.45256),
        (-0.43083, -0.06914, 0.00835),
        (-0.00259, -0.05835, 0.02553),
        (0.48872, -0.65880, -1.31290),
        (-0.00415, -0.11985, -0.05532),
        (0.07204, -0.25739, 0.06790),
        (-0.02750, -0.26834, -0.16404),
        (-0.08772, 0.02692, 0.02287),
        (0.01992, -0.00736, 0.02927),
        (-0.45961, 0.63758, 0.95406),
        (0.40799, 0.08997, -0.00131),
        (-0.10107, 0.21069, -0.11028),
        (-0.06576, 0.04748, 0.01487),
        (0.05664, 0.20406, -0.02730),
        (-0.09269, 0.18519, 0.10911),
        (0.01892, 0.04934, -0.04097),
        (0.01033, 0.13527, 0.07881),
        (0.15120, -0.33207, -0.27519),
    ]
)

leads = inlined(leading_gate)

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
        """The material constant rho g (894 mu^3 - 386 mu^2 + 89 mu), N/m^3: the paper's fit."""
        mu = self.friction
        return self.density * EARTH * (894.0 * mu**3 - 386.0 * mu**2 + 89.0 * mu)

    @property
    def sand(self) -> Sand:
        """The planar map's sand on which a level plate that moves down feels the same."""
        return Sand(self.xi * DOWN / PER_CM3, name="grains")


def xi_of(zeta: float) -> float:
    """The material constant, N/m^3, of a sand of this zeta: equal where a level face moves down."""
    return zeta * PER_CM3 / DOWN


@inlined
def coefficients(x1, x2, x3):
    """f1, f2 and f3 at x1 = h.g, x2 = n.g, x3 = n.h."""
    terms = (
        1.0, x1, x2, x3, x1 * x1, x2 * x2, x3 * x3, x1 * x2, x2 * x3, x3 * x1, x1 * x1 * x1, x2 * x2 * x2,
        x3 * x3 * x3, x1 * x2 * x2, x2 * x1 * x1, x2 * x3 * x3, x3 * x2 * x2, x3 * x1 * x1, x1 * x3 * x3,
        x1 * x2 * x3,
    )  # fmt: skip
    f1 = f2 = f3 = 0.0
    for i in range(20):
        f1 += TABLE[i, 0] * terms[i]
        f2 += TABLE[i, 1] * terms[i]
        f3 += TABLE[i, 2] * terms[i]
    return f1, f2, f3


@inlined
def stress(n, h, up, surface):
    """Stress per depth over xi on a face, three numbers: the law, times |h| where bristles hold it.

    n: outward normal. h: direction of motion, |h| <= 1, the sand's bristles. up: against gravity. surface:
    friction of the surface; infinity leaves the law as it is. All in one frame.
    """
    size = np.sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2])
    if size < 1e-12:
        return 0.0, 0.0, 0.0
    x3 = (n[0] * h[0] + n[1] * h[1] + n[2] * h[2]) / size
    if x3 <= -EDGE:
        return 0.0, 0.0, 0.0
    x1 = -(up[0] * h[0] + up[1] * h[1] + up[2] * h[2]) / size
    x2 = -(up[0] * n[0] + up[1] * n[1] + up[2] * n[2])
    f1, f2, f3 = coefficients(x1, x2, x3)
    inwards = max(-(f1 + f2 * x3 + f3 * x2), 0.0)  # sand pushes and never pulls
    tx = f2 * (h[0] / size - x3 * n[0]) - f3 * (up[0] + x2 * n[0])
    ty = f2 * (h[1] / size - x3 * n[1]) - f3 * (up[1] + x2 * n[1])
    tz = f2 * (h[2] / size - x3 * n[2]) - f3 * (up[2] + x2 * n[2])
    along = np.sqrt(tx * tx + ty * ty + tz * tz)
    slip = min(1.0, surface * inwards / max(along, 1e-12))
    size *= leads(None, (1.0, 0.0), x3, EDGE)[0]
    return (
        size * (slip * tx - inwards * n[0]),
        size * (slip * ty - inwards * n[1]),
        size * (slip * tz - inwards * n[2]),
    )
