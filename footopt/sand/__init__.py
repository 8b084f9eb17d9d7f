"""The sand: its stress map and its scale zeta."""

from footopt.sand import law as stress
from footopt.sand.law import GENERIC, MEDIA, Sand, StressMap, alpha, fit_stress_map

__all__ = ["GENERIC", "MEDIA", "Sand", "StressMap", "alpha", "fit_stress_map", "stress"]
