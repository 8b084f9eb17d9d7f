"""The sand: its stress map and its scale zeta."""

from footopt.sand import law as stress
from footopt.sand.law import GENERIC, MEDIA, Sand, StressMap, affine, affine_direction, alpha, fit_table

__all__ = [
    "GENERIC",
    "MEDIA",
    "Sand",
    "StressMap",
    "affine",
    "affine_direction",
    "alpha",
    "fit_table",
    "stress",
]
