"""Fronts of several searches for the same objectives, compared: hypervolume, and what half of them attain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REFERENCE = 1.1  # of hypervolumes, where the merged front spans 0 to 1 in every objective


def hypervolume_shares(fronts: Sequence[Array]) -> list[float]:
    """Hypervolume of each front over that of all merged; F (designs, objectives) of each, minimised."""
    from moocore import filter_dominated, hypervolume

    merged = filter_dominated(np.concatenate(fronts))
    low, span = merged.min(axis=0), np.ptp(merged, axis=0)
    span = np.where(span > 0.0, span, 1.0)
    whole, *parts = (hypervolume((f - low) / span, ref=REFERENCE) for f in (merged, *fronts))
    return [float(part / whole) for part in parts]


def median_attainment(fronts: Sequence[Array]) -> Array:
    """What half of the fronts attain, (points, 2), of F (designs, 2), minimised.

    The empirical attainment function (Fonseca, Guerreiro, Lopez-Ibanez & Paquete 2011).
    """
    from moocore import eaf

    sets = np.repeat(np.arange(len(fronts)), [len(front) for front in fronts])
    return np.asarray(eaf(np.concatenate(fronts), sets, percentiles=[50])[:, :2])
