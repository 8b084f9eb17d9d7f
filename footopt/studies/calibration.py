"""The fit of zeta, and of the exponent of depth, to tests with plates or penetrometers in one's own sand.

A plate of area A at depth z feels F = zeta P z against its motion, with P = A (alpha_x cos g + alpha_z sin g)
of the stress map. The sand is prepared once for each repeat, whose forces share that error: each repeat is
fitted alone by least squares, and the mean over the repeats has Student's interval. A single repeat has only
the interval of its own least squares.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import Unusable, naming
from footopt.files.io import read_columns
from footopt.sand import GENERIC, StressMap, alpha

Array = NDArray[np.float64]

SETTING = "study.tests"
COLUMNS = {"depth_mm": "", "force_N": "", "area_cm2": ""}
OPTIONAL = {"angle_deg": 0.0, "direction_deg": 90.0}  # a level plate that is pushed down
LABEL = "repeat"

COVERAGE = 0.95  # of the intervals
DEPTHS = 3  # different ones that each repeat must have at least
ZETAS = (0.005, 200.0)  # of any sand; the softest and hardest of the literature are .2 and 3
EXPONENTS = (0.2, 4.0)  # of any sand; 1 to 1.5 are measured
CHANGE = 0.1  # of zeta over the depths that were tested, or from set-up to set-up: less does not matter


class Estimate(NamedTuple):
    """A value with its interval of `COVERAGE`."""

    value: float
    low: float
    high: float

    def excludes(self, value: float) -> bool:
        """Whether a value is outside the interval."""
        return not self.low <= value <= self.high


class Fit(NamedTuple):
    """Least squares of one repeat."""

    zeta: float
    exponent: float
    scale: float  # zeta of the law with an exponent, at the reference depth
    log_zeta_error: float  # standard errors
    exponent_error: float
    freedom: int  # degrees of freedom


class Calibration(NamedTuple):
    """The estimates that tests give of a sand, with their intervals."""

    zeta: Estimate  # with force that grows linearly with depth, as footopt's law has it
    exponent: Estimate  # of depth, in a law with zeta (z / reference)^(exponent - 1)
    scale: float  # zeta of that law at the depth `reference`
    reference: float  # the geometric mean of the depths, m
    spread: float | None  # sd of log zeta where the sand is prepared anew; None with one repeat
    repeats: dict[str, tuple[float, float]]  # zeta and exponent of each alone
    set_ups: dict[str, Estimate]  # zeta by the plate and its direction
    depth: Array  # (rows,), m
    local: Array  # (rows,), force over P z
    set_up: NDArray[np.str_]  # (rows,)

    def zeta_at(self, depth: Array | float) -> Array:
        """Return zeta of the law with an exponent, by depth, m."""
        return np.asarray(self.scale * (np.asarray(depth) / self.reference) ** (self.exponent.value - 1.0))

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the estimates."""
        reasons = []
        shallow, deep, n = self.depth.min(), self.depth.max(), self.exponent
        low, high = self.zeta_at(shallow), self.zeta_at(deep)
        if n.excludes(1.0) and abs(high / low - 1.0) > CHANGE:
            reasons.append(
                f"Force does not grow linearly with depth, as the law has it, but with its power "
                f"{n.value:.2f} ({n.low:.2f} to {n.high:.2f}): zeta is {low:.2g} at {1e3 * shallow:.3g} mm "
                f"and {high:.2g} at {1e3 * deep:.3g} mm. Test to the depth to which your feet sink."
            )
        if len(self.repeats) == 1:
            reasons.append(
                "There is one repeat: its interval says nothing of how the sand differs from place to place. "
                "Prepare the sand anew, test again, and number the tests in a column repeat."
            )
        if odd := [
            f"{name}: {zeta.value:.2g}"
            for name, zeta in self.set_ups.items()
            if zeta.excludes(self.zeta.value) and abs(zeta.value / self.zeta.value - 1.0) > CHANGE
        ]:
            reasons.append(
                f"zeta differs from set-up to set-up ({'; '.join(odd)}): size, angle or direction act "
                "otherwise than in the stress map. Measure a table of stresses (sand.table)."
            )
        return reasons


def calibrate(path: str | Path, stress_map: StressMap = GENERIC) -> Calibration:
    """Fit zeta and the exponent of depth to tests with plates.

    Parameters
    ----------
    path : str or Path
        CSV file with a header and the columns ``depth_mm`` (of the plate's middle below the surface; rows
        above it are left out), ``force_N`` (against the motion), ``area_cm2`` and, optionally, ``angle_deg``
        (of the plate, 0 is level), ``direction_deg`` (of the motion, 90 is down) and ``repeat`` (the
        preparation of the sand, any word); others are ignored.
    stress_map : StressMap
        The map that zeta scales.

    Raises
    ------
    FileError
        The file cannot be read, lacks a column, holds something that is not a number, has too few depths, or
        no sand can have such forces.
    """
    table, words = read_columns(path, SETTING, COLUMNS, OPTIONAL, LABEL)
    with naming(path, SETTING):
        inside = table["depth_mm"] > 0
        if not inside.any():
            raise Unusable("has no row with depth_mm > 0: depth is below the surface, in mm.")
        labels = np.array(words)[inside]
        depth, force, area, angle, direction = (
            table[name][inside] for name in ("depth_mm", "force_N", "area_cm2", "angle_deg", "direction_deg")
        )
        if not (area > 0).all():
            raise Unusable("area_cm2 must be > 0, the area of the plate's face.")
        if max(abs(angle).max(), abs(direction).max()) > 180:
            raise Unusable("angle_deg and direction_deg must be from -180 to 180.")
        set_up = np.array([f"{a:.3g} cm² at {b:g}° moved at {g:g}°"
                           for a, b, g in zip(area, angle, direction, strict=True)])  # fmt: skip
        depth, area, gamma = 1e-3 * depth, 1e-4 * area, np.radians(direction)
        x, z = alpha(np.radians(angle), gamma, stress_map)
        unit = (x * np.cos(gamma) + z * np.sin(gamma)) * area * depth  # the force where zeta is 1, N
        if not (unit > 0).all():
            raise Unusable("the stress map has a plate of these angles pushed along; zeta cannot be found.")
        reference = float(np.exp(np.log(depth).mean()))
        rows = {name: labels == name for name in dict.fromkeys(labels.tolist())}
        fits = {name: _fit(unit[own], depth[own] / reference, force[own], f"repeat {name!r}: " * bool(name))
                for name, own in rows.items()}  # fmt: skip

    zeta, exponent, scale = np.array([f[:3] for f in fits.values()]).T
    first, count = next(iter(fits.values())), len(fits)
    set_ups = {}
    for name in dict.fromkeys(set_up.tolist()):
        each = [
            _zeta(unit[own], force[own]) for row in rows.values() if (own := row & (set_up == name)).any()
        ]
        set_ups[name] = _exp(_mean(np.log(np.maximum(each, ZETAS[0]))))
    return Calibration(
        zeta=_exp(_mean(np.log(zeta), first.log_zeta_error, first.freedom)),
        exponent=_mean(exponent, first.exponent_error, first.freedom),
        scale=float(np.exp(np.log(scale).mean())),
        reference=reference,
        # of the next repeat about the mean that is known
        spread=float(np.log(zeta).std(ddof=1) * np.sqrt(1.0 + 1.0 / count)) if count > 1 else None,
        repeats={name: (f.zeta, f.exponent) for name, f in fits.items()},
        set_ups=set_ups,
        depth=depth,
        local=force / unit,
        set_up=set_up,
    )


def _mean(values: Array, error: float = np.inf, freedom: int = 1) -> Estimate:
    """The mean of repeats with Student's interval; of a single one its value with its own standard error."""
    from scipy.special import stdtrit

    if (count := len(values)) > 1:
        error, freedom = float(values.std(ddof=1) / np.sqrt(count)), count - 1
    mean, half = float(values.mean()), float(stdtrit(freedom, 0.5 + 0.5 * COVERAGE)) * error
    return Estimate(mean, mean - half, mean + half)


def _exp(log: Estimate) -> Estimate:
    """The estimate of a number from that of its logarithm."""
    return Estimate(*np.exp(log).tolist())


def _zeta(unit: Array, force: Array) -> float:
    """zeta by least squares; unit: the force where zeta is 1, N."""
    return float(unit @ force / (unit @ unit))


def _fit(unit: Array, depth: Array, force: Array, whose: str) -> Fit:
    """One repeat; unit: the force where zeta is 1, N; depth: over the reference."""
    from scipy.optimize import curve_fit

    if len(np.unique(depth)) < DEPTHS:
        raise Unusable(f"{whose}has fewer than {DEPTHS} different depths, which an exponent needs.")
    zeta = _zeta(unit, force)
    if not ZETAS[0] <= zeta <= ZETAS[1]:
        raise Unusable(
            f"{whose}zeta would be {zeta:.3g}, and that of sands is from {ZETAS[0]:g} to {ZETAS[1]:g}. Check "
            "the units (mm, N, cm2) and the sign: force_N is positive against the motion."
        )

    def law(depth: Array, scale: float, exponent: float) -> Array:
        return scale * unit * depth ** (exponent - 1.0)

    try:
        (scale, exponent), covariance = curve_fit(law, depth, force, (zeta, 1.0))
    except RuntimeError:  # no optimum
        raise Unusable(f"{whose}force grows with no power of depth. Check depth_mm and force_N.") from None
    error = float(np.sqrt(covariance[1, 1]))
    # noise over a narrow range of depths is no reason to refuse
    if not (scale > 0.0 and EXPONENTS[0] - 2.0 * error <= exponent <= EXPONENTS[1] + 2.0 * error):
        raise Unusable(
            f"{whose}force grows with the power {exponent:.3g} of depth, and that of sands is from "
            f"{EXPONENTS[0]:g} to {EXPONENTS[1]:g}. Check depth_mm and force_N."
        )
    # whether forces scatter by as much everywhere or in proportion to their size: HC3, MacKinnon & White 1985
    weight = unit / (unit @ unit)
    variance = float(np.sum((weight * (zeta * unit - force) / (1.0 - weight * unit)) ** 2))
    return Fit(zeta, exponent, scale, np.sqrt(variance) / zeta, error, len(force) - 2)
