"""The sand's surface over a plate, where feet have moved it (`footopt.walk.ground`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.compiled import inlined, inlined_fast
from footopt.walk.state import lent

Array = NDArray[np.float64]


class Surface(NamedTuple):
    """A height field; cell i has its middle at (first + i) / each."""

    first: int
    each: float  # cells a metre
    height: Array  # (cells,), m


@inlined_fast
def surface_at(surface, x):
    """Height of a surface (m) at x, linear between the middles of its cells, and its slope."""
    at = x * surface.each - surface.first
    i = min(max(int(at), 0), len(surface.height) - 2)
    here, next_ = surface.height[i], surface.height[i + 1]
    return here + (at - i) * (next_ - here), (next_ - here) * surface.each


@inlined
def highest(ground, foot):
    """The highest sand that a foot may feel, m."""
    if ground is None:
        return 0.0
    return lent(ground.top)[foot]


@inlined
def found_by(ground, foot):
    """The surface that a foot found, or None where it is level."""
    if ground is None:
        return None
    return Surface(ground.first, 1.0 / ground.cell, lent(ground.found)[foot])


@inlined
def over(ground, foot, sole, first, last, ankle):
    """Height of the sand over the plates of a foot, and its slope, or None where it is level.

    In a loop of its own: it looks up cells, and that over plates would no longer be vectorised.
    """
    if ground is None:
        return None
    found, over = found_by(ground, foot), lent(ground.over)[foot]
    for i in range(first, last):
        place = ankle.x + ankle.cos * sole.x[i] - ankle.sin * sole.z[i]
        over[0, i], over[1, i] = surface_at(found, place)
    return over
