"""Layers of sand: strength that changes with depth."""

import itertools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from footopt.arrays import Array
from footopt.effects.base import MOST, Effect, as_floats, check_factors, numbers
from footopt.effects.dual import positive
from footopt.errors import check


class LayersLaw(NamedTuple):
    """Interfaces (m) and the jump of the strength at each, in units of the sand's zeta."""

    depths: tuple[float, ...] | Array
    jumps: tuple[float, ...] | Array

    def load(self, load, depth, x):
        """The integral of zeta over depth: each interface adds its jump times the depth below it."""
        for i in range(len(self.depths)):
            load = load + self.jumps[i] * positive(depth - self.depths[i])
        return load


@dataclass(frozen=True)
class Layers(Effect, name="layers"):
    """Layers: the stress is the integral of zeta over depth, so that it is continuous at an interface.

    The first layer, from the surface to the first interface, is the scene's sand. With one sand the
    integral is zeta |z|. It is a superposition of the depth-linear law, exact for what the sand above
    weighs on a failure surface at the plate. Source: footopt's own, from the linear growth of Li, Zhang &
    Goldman (2013). Range: a plate feels no interface ahead (measured: about one plate width ahead).

    Parameters
    ----------
    depths : tuple of float, m
        Interfaces below the surface, increasing.
    factors : tuple of float
        zeta of the layer under each interface, divided by the sand's.

    Raises
    ------
    SettingError
        Depths do not increase, or factors are not as many numbers > 0.
    """

    depths: tuple[float, ...] = (0.03,)
    factors: tuple[float, ...] = (0.3,)
    in_page = True

    def __post_init__(self) -> None:
        depths, count = as_floats(self, "depths"), len(self.depths)
        rising = all(a < b for a, b in itertools.pairwise((0.0, *depths, math.inf)))
        allowed = f"1 to {MOST} increasing depths > 0, in m"
        check(rising and 1 <= count <= MOST, "effects.layers.depths", list(depths), allowed)
        allowed = f"{count} numbers > 0: zeta under each interface over the sand's"
        check_factors("effects.layers.factors", as_floats(self, "factors"), count, allowed)

    @property
    def law(self) -> LayersLaw:
        """Interfaces and jumps."""
        return LayersLaw(numbers(self.depths), numbers(np.diff((1.0, *self.factors)).tolist()))

    @property
    def strata(self) -> tuple[tuple[float, float, float], ...]:
        """Each layer below the first: top and bottom, m, and its factor."""
        return tuple(zip(self.depths, (*self.depths[1:], math.inf), self.factors, strict=True))
