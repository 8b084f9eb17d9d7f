"""The sand: its stress map and its scale zeta."""

from footopt.sand import stress
from footopt.sand.stress import GENERIC, MEDIA, Sand, StressMap, affine, affine_direction, alpha, fit_table

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
