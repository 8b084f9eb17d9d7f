"""The coefficients of a stress map, fitted to measured stresses."""

import numpy as np

from footopt.arrays import Array
from footopt.errors import Unusable
from footopt.sand.law import StressMap

MISFIT = 0.35  # of a column's rms; no law of this form is in such a table
GAIN = 0.1  # of the table's rms; more power than noise explains comes out of such a sand
STRESSES = (1e-3, 50.0)  # largest stress of a table, N/cm^3; the hardest sand in the literature has 2


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
    if max(error_x, error_z) > MISFIT:
        raise Unusable(
            f"no stress map comes near it: the misfit is {100 * error_x:.0f} % of alpha_x and "
            f"{100 * error_z:.0f} % of alpha_z (rms). Check the columns and the signs of the angles."
        )
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
    return found, (error_x, error_z)


def _least_squares(terms: list[Array], target: Array) -> tuple[list[float], float]:
    """Coefficients of some terms, and the relative rms misfit of a column."""
    design = np.stack(terms, axis=1)
    solution, _, rank, _ = np.linalg.lstsq(design, target, rcond=1e-8)
    if rank < design.shape[1]:
        raise Unusable(f"{len(target)} rows do not determine it: give more combinations of beta and gamma.")
    misfit, scale = (float(np.sqrt(np.mean(v**2))) for v in (design @ solution - target, target))
    return solution.tolist(), misfit / scale if scale > 0 else misfit
