"""Explicit Euler, the paper's stepper: position and velocity both from the old state.

    0 |
    --+---
      | 1

Order 1. Stable against the smoothed law only for dt < 2 eps / g.
"""

from __future__ import annotations

from typing import NamedTuple

from footopt.walk.steppers.base import acceleration, add, arrive, register


class ExplicitEuler(NamedTuple):
    """It has no parameters."""


def explicit_euler(method, world, sole, poses, state, h, counts):
    """r + h v, v + h a."""
    x, z, vx, vz = state.x, state.z, state.vx, state.vz
    ax, az = acceleration(world, state.contact)
    sums = add(state.integrals, h, z, vx, vz, state.contact)
    x, z, vx, vz = x + h * vx, z + h * vz, vx + h * ax, vz + h * az
    return arrive(world, sole, poses[0], x, z, vx, vz, sums, state.bristles, h, counts)


register("explicit_euler", ExplicitEuler(), explicit_euler, nodes=(1.0,), order=1, source="the paper's eq. 6")
