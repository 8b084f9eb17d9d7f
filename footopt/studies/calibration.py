"""zeta, and the exponent of depth, from plates or penetrometers pushed into one's own sand.

A plate of area A at depth z feels F = zeta P z against its motion, with P = A (alpha_x cos g + alpha_z sin g)
of the stress map. The sand is prepared once for each repeat, whose forces share that error: each repeat is
fitted alone by least squares, and the mean over the repeats has Student's interval. A single repeat has only
the interval of its own least squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import Unusable, naming
from footopt.files.io import read_columns
from footopt.sand.law import GENERIC, StressMap, alpha

Array = NDArray[np.float64]

SETTING = "study.tests"
COLUMNS = {"depth_mm": "", "force_N": "", "area_cm2": ""}
OPTIONAL = {"angle_deg": 0.0, "direction_deg": 90.0}  # a level plate that is pushed down
LABEL = "repeat"

COVERAGE = 0.95  # of the intervals
DEPTHS = 3  # different ones that each repeat must have at least
ZETAS = (0.005, 200.0)  # of any sand; the softest and hardest of the literature are .2 and 3
EXPONENTS = (0.2, 4.0)  # of any sand; 1 to 1.5 are measured
CHANGE = 0.1  # of zeta over the depths that were tested, or from set-up to set-up: less is no matter


@dataclass(frozen=True)
class Estimate:
    """A value with its interval of `COVERAGE`; infinite ends where the data do not say."""

    value: float
    low: float
    high: float

    @classmethod
    def of(cls, values: Array, error: float = np.inf, freedom: int = 1) -> Estimate:
        """Return the mean of repeats with Student's interval; of one, its value with its own error."""
        from scipy.special import stdtrit

        if (count := len(values)) > 1:
            error, freedom = float(values.std(ddof=1) / np.sqrt(count)), count - 1
        mean = float(values.mean())
        half = float(stdtrit(max(freedom, 1), 0.5 + 0.5 * COVERAGE)) * error
        return cls(mean, mean - half, mean + half)

    def exp(self) -> Estimate:
        """Return the estimate of a number from that of its logarithm."""
        return Estimate(*(float(np.exp(v)) for v in (self.value, self.low, self.high)))

    def excludes(self, value: float) -> bool:
        """Whether a value is outside the interval."""
        return not self.low <= value <= self.high


class SetUp(NamedTuple):
    """Tests with one plate in one direction."""

    name: str
    rows: int
    zeta: Estimate  # of these tests alone


@dataclass(frozen=True, eq=False)
class Calibration:
    """The estimates that tests give of a sand, with their intervals."""

    zeta: Estimate  # with force that grows linearly with depth, as footopt's law has it
    exponent: Estimate  # of depth, in a law with zeta (z / reference)^(exponent - 1)
    scale: float  # zeta of that law at the depth `reference`
    reference: float  # the geometric mean of the depths, m
    spread: float | None  # sd of log zeta where the sand is prepared anew; None with one repeat
    repeats: dict[str, tuple[float, float]]  # zeta and exponent of each alone
    set_ups: tuple[SetUp, ...]
    width: float  # of the smallest plate, m
    depth: Array  # (rows,), m
    local: Array  # (rows,), force over P z
    which: NDArray[np.int64]  # (rows,), the set-up
    left_out: int  # rows above the surface

    def zeta_at(self, depth: Array | float) -> Array:
        """Return zeta of the law with an exponent, by depth, m."""
        return np.asarray(self.scale * (np.asarray(depth) / self.reference) ** (self.exponent.value - 1.0))

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the estimates."""
        said = []
        shallow, deep, n = self.depth.min(), self.depth.max(), self.exponent
        low, high = self.zeta_at(shallow), self.zeta_at(deep)
        if n.excludes(1.0) and abs(high / low - 1.0) > CHANGE:
            said.append(
                f"Force does not grow linearly with depth, as the law has it, but with its power "
                f"{n.value:.2f} ({n.low:.2f} to {n.high:.2f}): zeta is {low:.2g} at {1e3 * shallow:.3g} mm "
                f"and {high:.2g} at {1e3 * deep:.3g} mm. Test to the depth to which your feet sink."
            )
        if len(self.repeats) == 1:
            said.append(
                "There is one repeat: its interval says nothing of how the sand differs from place to place. "
                "Prepare the sand anew, test again, and number the tests in a column repeat."
            )
        if deep > self.width:
            said.append(
                f"The deepest test ({1e3 * deep:.3g} mm) is deeper than the smallest plate is wide "
                f"({1e3 * self.width:.3g} mm): linear growth with depth is not known there."
            )
        odd = [
            f"{s.name}: {s.zeta.value:.2g}"
            for s in self.set_ups
            if s.zeta.excludes(self.zeta.value) and abs(s.zeta.value / self.zeta.value - 1.0) > CHANGE
        ]
        if len(self.set_ups) > 1 and odd:
            said.append(
                f"zeta differs from set-up to set-up ({'; '.join(odd)}): size, angle or direction act "
                "otherwise than in the stress map. Measure a table of stresses (sand.table)."
            )
        return said


def calibrate(path: str | Path, stress_map: StressMap = GENERIC) -> Calibration:
    """Fit zeta and the exponent of depth to tests with plates.

    Parameters
    ----------
    path : str or Path
        CSV file with a header and the columns ``depth_mm`` (of the plate's middle below the surface),
        ``force_N`` (against the motion), ``area_cm2`` and, optionally, ``angle_deg`` (of the plate, 0 is
        level), ``direction_deg`` (of the motion, 90 is down) and ``repeat`` (the preparation of the sand, any
        word); others are ignored.
    stress_map : StressMap
        The map that zeta scales.

    Returns
    -------
    Calibration
        With its intervals.

    Raises
    ------
    FileError
        The file cannot be read, lacks a column, holds something that is not a number, has too few depths, or
        no sand can have such forces.
    """
    columns, labels = read_columns(path, SETTING, COLUMNS, OPTIONAL, LABEL)
    with naming(path, SETTING):
        return _calibrate(columns, np.array(labels), stress_map)


def _calibrate(columns: dict[str, Array], labels: NDArray[np.str_], stress_map: StressMap) -> Calibration:
    inside = columns["depth_mm"] > 0
    if not inside.any():
        raise Unusable("has no row with depth_mm > 0: depth is below the surface, in mm.")
    columns, labels = {name: values[inside] for name, values in columns.items()}, labels[inside]
    depth, force, area = 1e-3 * columns["depth_mm"], columns["force_N"], 1e-4 * columns["area_cm2"]
    angle, direction = columns["angle_deg"], columns["direction_deg"]
    if not (area > 0).all():
        raise Unusable("area_cm2 must be > 0, the area of the plate's face.")
    if max(abs(angle).max(), abs(direction).max()) > 180:
        raise Unusable("angle_deg and direction_deg must be from -180 to 180.")
    gamma = np.radians(direction)
    x, z = alpha(np.radians(angle), gamma, stress_map)
    resistance = (x * np.cos(gamma) + z * np.sin(gamma)) * area
    if not (resistance > 0).all():
        raise Unusable("the stress map has a plate of these angles pushed along; zeta cannot be found.")
    unit, reference = resistance * depth, float(np.exp(np.log(depth).mean()))

    fits = {}
    for name in dict.fromkeys(labels.tolist()):
        own = labels == name
        fits[name] = _fit(unit[own], depth[own] / reference, force[own], f"repeat {name!r}: " if name else "")
    log_zeta, exponent, log_scale = (np.array([f[i] for f in fits.values()]) for i in range(3))
    alone, count = next(iter(fits.values())), len(fits)
    # of the next repeat about the mean that is known
    spread = float(log_zeta.std(ddof=1) * np.sqrt(1.0 + 1.0 / count)) if count > 1 else None
    distinct, which = np.unique(np.stack([area, angle, direction], axis=1), axis=0, return_inverse=True)
    which = which.ravel()
    set_ups = []
    for i, (size, beta, way) in enumerate(distinct):
        own = which == i
        each = [
            _zeta(unit[own & (labels == n)], force[own & (labels == n)])
            for n in dict.fromkeys(labels[own].tolist())
        ]
        zeta = Estimate.of(np.log(np.maximum(each, ZETAS[0]))).exp()
        name = f"{1e4 * size:.3g} cm² at {beta:g}° moved at {way:g}°"
        set_ups.append(SetUp(name, int(own.sum()), zeta))
    return Calibration(
        zeta=Estimate.of(log_zeta, alone[3], alone[5]).exp(),
        exponent=Estimate.of(exponent, alone[4], alone[5]),
        scale=float(np.exp(log_scale.mean())),
        reference=reference,
        spread=spread,
        repeats={name: (float(np.exp(f[0])), f[1]) for name, f in fits.items()},
        set_ups=tuple(set_ups),
        width=float(np.sqrt(area.min())),
        depth=depth,
        local=force / unit,
        which=which,
        left_out=int((~inside).sum()),
    )


def _zeta(unit: Array, force: Array) -> float:
    """Return zeta by least squares; unit: the force where zeta is 1, N."""
    return float(unit @ force / (unit @ unit))


def _fit(
    unit: Array, depth: Array, force: Array, whose: str
) -> tuple[float, float, float, float, float, int]:
    """One repeat: log zeta, exponent, log scale; standard errors of the first two, and degrees of freedom.

    unit: force where zeta is 1, N. depth: over the reference.
    """
    from scipy.optimize import least_squares

    if len(np.unique(depth)) < DEPTHS:
        raise Unusable(f"{whose}has fewer than {DEPTHS} different depths, which an exponent needs.")
    zeta = _zeta(unit, force)
    if not ZETAS[0] <= zeta <= ZETAS[1]:
        raise Unusable(
            f"{whose}zeta would be {zeta:.3g}, and that of sands is from {ZETAS[0]:g} to {ZETAS[1]:g}. Check "
            "the units (mm, N, cm2) and the sign: force_N is positive against the motion."
        )
    size = float(np.sqrt(np.mean(force**2)))

    def misfit(p: Array) -> Array:
        return np.asarray((np.exp(p[0]) * unit * depth ** (p[1] - 1.0) - force) / size)

    found = least_squares(misfit, [np.log(zeta), 1.0], method="lm")
    scale, exponent = (float(p) for p in found.x)
    freedom = len(force) - 2
    variance = 2.0 * found.cost / max(freedom, 1)
    error = float(np.sqrt((variance * np.linalg.pinv(found.jac.T @ found.jac))[1, 1]))
    # noise over a narrow range of depths is no reason to refuse
    if not (found.success and EXPONENTS[0] - 2.0 * error <= exponent <= EXPONENTS[1] + 2.0 * error):
        raise Unusable(
            f"{whose}force grows with the power {exponent:.3g} of depth, and that of sands is from "
            f"{EXPONENTS[0]:g} to {EXPONENTS[1]:g}. Check depth_mm and force_N."
        )
    # whether forces scatter by as much everywhere or in proportion to their size: HC3, MacKinnon & White 1985
    weight = unit / (unit @ unit)
    straight = float(np.sum((weight * (zeta * unit - force) / (1.0 - weight * unit)) ** 2))
    return np.log(zeta), exponent, scale, np.sqrt(straight) / zeta, error, freedom
