"""Resistive force theory (RFT): the stress on one plate, in its readable and in its fast form.

A plate with world angle beta (counter-clockwise, rad) that moves in the direction gamma
(rad, positive downwards: gamma = atan2(-v_z, v_x)) at depth |z| below the surface feels

    f_x = -zeta alpha_x(beta, gamma) |z| dA,    f_z = +zeta alpha_z(beta, gamma) |z| dA

with nine Fourier coefficients (Li, Zhang & Goldman, Science 339, 2013, table S2). `alpha` is that
map as published; the compiled kernels use `affine`, the same law without an angle in it.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass, fields
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.errors import FileError, SettingError, check, one_line
from footopt.files.reading import named, number, read_table

LARGEST = 1e4  # of a coefficient, N/cm^3; concrete has less
PER_CM3 = 1e6  # N/cm^3 in N/m^3

MISFIT = 0.35  # of a column's rms; no law of this form is in such a table
GAIN = 0.1  # of the table's rms; more power than noise explains comes out of such a sand
STRESSES = (1e-3, 50.0)  # largest stress of a table, N/cm^3; the hardest sand in the literature has 2

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StressMap:
    """The nine Fourier coefficients of the stresses per depth, in N/cm^3.

    ``Bm11`` and ``Cm11`` are the (-1, 1) terms. Defaults: the generic map of Li, Zhang & Goldman,
    Science 339 (2013), table S2.
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
            check(
                abs(value) <= LARGEST,
                f"sand.coefficients.{f.name}",
                value,
                f"from -{LARGEST:g} to {LARGEST:g}, in N/cm^3",
            )

    @property
    def law(self) -> Law:
        """The coefficients as the affine form uses them (N/cm^3)."""
        return Law(
            A00=self.A00,
            A10=self.A10,
            B01=self.B01,
            B_sum=self.B11 + self.Bm11,
            B_diff=self.B11 - self.Bm11,
            C01=self.C01,
            C_sum=self.C11 + self.Cm11,
            C_diff=self.C11 - self.Cm11,
            D10=self.D10,
        )

    def dissipation(self, samples: int = 181) -> float:
        """Smallest alpha_x cos(gamma) + alpha_z sin(gamma) over all angles, N/cm^3.

        The power that the sand takes per depth, area and speed. A law below zero somewhere gives
        energy to the walker there; the generic map's minimum is .054.
        """
        beta, gamma = np.meshgrid(
            np.linspace(-np.pi / 2, np.pi / 2, samples), np.linspace(-np.pi, np.pi, 2 * samples - 1)
        )
        ax, az = alpha(beta, gamma, self)
        return float(np.min(ax * np.cos(gamma) + az * np.sin(gamma))) / PER_CM3


class Law(NamedTuple):
    """Coefficients of the affine form (`affine`), N/cm^3; what the compiled kernels receive."""

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
    stress_map : the nine coefficients; the generic map by default.

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


def affine(beta: ArrayLike, stress_map: StressMap = GENERIC) -> tuple[Array, Array]:
    """The same law as a bias and a matrix: f / (zeta |z| dA) = a - M h, with h = v / |v|.

    With c = cos 2 beta and s = sin 2 beta

        a = ( -D10 s,  A00 + A10 c )
        M = [ C01 + (C11 + C-11) c      (C11 - C-11) s       ]
            [ -(B11 - B-11) s           B01 + (B11 + B-11) c ]

    RFT is thus an anisotropic dry-friction law with a bias. Expand the angle sums of `alpha` with
    cos g = h_x and sin g = -h_z to see it.

    Parameters
    ----------
    beta : array_like of shape S, rad

    Returns
    -------
    a : (*S, 2), N/m^3
    M : (*S, 2, 2), N/m^3
    """
    b = np.asarray(beta, float)
    return affine_direction(np.cos(2 * b), np.sin(2 * b), stress_map)


def affine_direction(c: Array, s: Array, stress_map: StressMap = GENERIC) -> tuple[Array, Array]:
    """`affine` from c = cos 2 beta and s = sin 2 beta, or from their means over a curved plate."""
    law = stress_map.law
    a = np.stack([-law.D10 * s, law.A00 + law.A10 * c], axis=-1)
    rows = [
        np.stack([law.C01 + law.C_sum * c, law.C_diff * s], axis=-1),
        np.stack([-law.B_diff * s, law.B01 + law.B_sum * c], axis=-1),
    ]
    return PER_CM3 * a, PER_CM3 * np.stack(rows, axis=-2)


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
    zeta : scale of the map, > 0 (1 is the generic material).
    stress_map : nine coefficients, N/cm^3.
    name : for tables and legends.
    fit_error : rms misfit of a fitted table over the table's own rms, per component; None if the
        map was not fitted.
    """

    zeta: float = 1.0
    stress_map: StressMap = GENERIC
    name: str = "custom"
    fit_error: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", one_line(self.name))
        check(
            isinstance(self.zeta, (int, float, np.number)) and 1e-6 <= self.zeta <= 1e6,
            "sand.zeta",
            self.zeta,
            "a number > 0, from 1e-6 to 1e6 (soft sand .2, the generic material 1, hard sand 5)",
            "Try sand=regular or sand.zeta=1.",
        )

    @classmethod
    def named(cls, name: str) -> Sand:
        """A sand of `MEDIA` by its name."""
        if name not in MEDIA:
            raise SettingError("sand", name, f"one of {', '.join(MEDIA)}", "Or give sand.zeta.")
        return cls(zeta=MEDIA[name], name=name)

    @classmethod
    def from_table(cls, path: str | Path, zeta: float = 1.0) -> Sand:
        """A sand from a measured table of stresses (see `fit_table`); the fit error is kept."""
        stress_map, error = fit_table(path)
        return cls(zeta=zeta, stress_map=stress_map, name=Path(path).stem, fit_error=error)

    @property
    def stiffness(self) -> float:
        """zeta in the units of the kernels: multiplies `Law` to give N/m^3."""
        return self.zeta * PER_CM3


def fit_table(path: str | Path) -> tuple[StressMap, tuple[float, float]]:
    """Fit the nine coefficients to a table of measured stresses by linear least squares.

    Parameters
    ----------
    path : CSV file with a header and the columns ``beta``, ``gamma`` (degrees, signs as in
        `alpha`), ``alpha_x``, ``alpha_z`` (N/cm^3); other columns are ignored.

    Returns
    -------
    stress_map : the fitted coefficients
    error : (x, z), rms of the misfit over the rms of the column

    Raises
    ------
    FileError : the file cannot be read, lacks a column, holds something that is not a number, or
        has too few different angles to determine nine coefficients.
    """
    columns = ("beta", "gamma", "alpha_x", "alpha_z")
    reader = csv.DictReader(read_table(path, "sand", "sand.table").splitlines(), skipinitialspace=True)
    rows = []
    try:
        header = list(reader.fieldnames or [])
        missing = [c for c in columns if c not in header]
        if missing:
            raise _wrong(
                path,
                f"the header lacks {', '.join(missing)}; "
                f"the columns must be {', '.join(columns)} (deg, deg, N/cm^3, N/cm^3).",
            )
        if twice := next((c for c in columns if header.count(c) > 1), None):
            raise _wrong(path, f"two columns are called {twice!r}. Which one is it?")
        for line in reader:
            try:
                rows.append([number(line[c]) for c in columns])
                if None in line:  # more cells than the header has, as with decimal commas
                    raise ValueError
            except (TypeError, ValueError):
                shown = [*(line[c] for c in columns), *(line.get(None) or [])][:8]
                raise _wrong(path, f"line {reader.line_num}: not four numbers: {shown}.") from None
    except csv.Error as error:
        raise _wrong(path, f"not a table ({error}).") from None
    table = np.array(rows, float).reshape(-1, 4)
    if not np.isfinite(table).all():
        raise _wrong(path, "holds a value that is not finite.")
    _check_units(path, table)
    b, g = np.radians(table[:, 0]), np.radians(table[:, 1])
    design_z = np.stack(
        [np.ones_like(b), np.cos(2 * b), np.sin(2 * b + g), np.sin(g), np.sin(-2 * b + g)], axis=1
    )
    design_x = np.stack([np.cos(2 * b + g), np.cos(g), np.cos(-2 * b + g), np.sin(2 * b)], axis=1)
    found: list[Array] = []
    errors: list[float] = []
    for design, target in ((design_x, table[:, 2]), (design_z, table[:, 3])):
        solution, _, rank, _ = np.linalg.lstsq(design, target, rcond=1e-8)
        if rank < design.shape[1]:
            raise _wrong(
                path,
                f"{len(b)} rows do not determine the nine coefficients; "
                "give more combinations of beta and gamma.",
            )
        found.append(solution)
        misfit = float(np.sqrt(np.mean((design @ solution - target) ** 2)))
        scale = float(np.sqrt(np.mean(target**2)))
        errors.append(misfit / scale if scale > 0 else misfit)
    if max(errors) > MISFIT:
        raise _wrong(
            path,
            f"no stress map comes near it: the misfit is {100 * errors[0]:.0f} % of alpha_x and "
            f"{100 * errors[1]:.0f} % of alpha_z (rms). Check the columns and the signs of the angles.",
        )
    (C11, C01, Cm11, D10), (A00, A10, B11, B01, Bm11) = (map(float, f) for f in found)
    found_map = StressMap(A00, A10, B11, B01, Bm11, C11, C01, Cm11, D10)
    typical = float(np.sqrt(np.mean(table[:, 2:] ** 2)))
    if (least := found_map.dissipation()) < -GAIN * typical:
        raise _wrong(
            path,
            f"such a sand would push a plate along (by {-least:.3g} N/cm^3 in some direction). Check the "
            "columns and the signs: a plate that moves down has gamma > 0 and alpha_z > 0.",
        )
    aside = D10 - C11 + Cm11  # alpha_x of a plate at 45 deg that moves down
    if aside < -GAIN * typical:
        raise _wrong(
            path,
            f"such a sand would push a plate that moves down to its upper side (alpha_x = {aside:.3g} "
            "N/cm^3 at beta = 45, gamma = 90 deg). Check the sign of beta: counter-clockwise, + toe up.",
        )
    return found_map, (errors[0], errors[1])


def _check_units(path: str | Path, table: Array) -> None:
    """Raise unless angles can be degrees and stresses N/cm^3; `table` is (rows, 4)."""
    beta, gamma, stress = abs(table[:, 0]), abs(table[:, 1]), abs(table[:, 2:])
    if len(table) == 0:
        return
    if beta.max() > 180 or gamma.max() > 360:
        raise _wrong(
            path, f"beta reaches {beta.max():.4g} and gamma {gamma.max():.4g} deg. Check the columns."
        )
    if gamma.max() <= 2 * np.pi:
        raise _wrong(path, f"gamma reaches {gamma.max():.4g} deg only. Angles must be in degrees.")
    if not STRESSES[0] <= stress.max() <= STRESSES[1]:
        raise _wrong(
            path,
            f"its largest stress is {stress.max():.4g} N/cm^3, and that of sands {STRESSES[0]:g} to "
            f"{STRESSES[1]:g}. Stresses must be per depth, in N/cm^3 (1 N/cm^3 = 1e6 N/m^3).",
        )


def _wrong(path: str | Path, why: str) -> FileError:
    return FileError(f"{named(path, 'sand.table')}: {why}")
