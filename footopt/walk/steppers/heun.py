"""Heun's method, the explicit trapezoidal rule: the mean of the slopes at both ends.

    0 |
    1 | 1
    --+---------
      | 1/2  1/2

Order 2. Stable against the smoothed law only for dt < 2 eps / g.
"""

from __future__ import annotations

from typing import NamedTuple

from footopt.walk.steppers.base import acceleration, add, arrive, register, touch


class Heun(NamedTuple):
    """It has no parameters."""


def heun(method, world, sole, poses, state, h, counts):
    """An Euler step, then the mean of both slopes."""
    x, z, vx, vz = state.x, state.z, state.vx, state.vz
    ax, az = acceleration(world, state.contact)
    x1, z1, vx1, vz1 = x + h * vx, z + h * vz, vx + h * ax, vz + h * az
    at = touch(world, sole, poses[0], x1, z1, vx1, vz1, state.bristles, h, counts)
    ax1, az1 = acceleration(world, at)
    sums = add(state.integrals, 0.5 * h, z, vx, vz, state.contact)
    sums = add(sums, 0.5 * h, z1, vx1, vz1, at)
    x, z = x + 0.5 * h * (vx + vx1), z + 0.5 * h * (vz + vz1)
    vx, vz = vx + 0.5 * h * (ax + ax1), vz + 0.5 * h * (az + az1)
    return arrive(world, sole, poses[0], x, z, vx, vz, sums, state.bristles, h, counts)


register("heun", Heun(), heun, nodes=(1.0,), order=2, source="Hairer, Norsett & Wanner, ODEs I, 1993, II.1")
