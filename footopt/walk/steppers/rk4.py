"""The classical Runge-Kutta method.

    0   |
    1/2 | 1/2
    1/2 | 0    1/2
    1   | 0    0    1
    ----+--------------------
        | 1/6  1/3  1/3  1/6

Order 4 where the forces are smooth. Stable against the smoothed law only for dt < 2.8 eps / g.
"""

from __future__ import annotations

from typing import NamedTuple

from footopt.walk.steppers.base import acceleration, add, arrive, register, touch


class RK4(NamedTuple):
    """It has no parameters."""


def rk4(method, world, sole, poses, state, h, counts):
    """Four stages; the first is the contact that the state holds."""
    x0, z0, vx0, vz0 = state.x, state.z, state.vx, state.vz
    ax, az = acceleration(world, state.contact)
    sums = add(state.integrals, h / 6.0, z0, vx0, vz0, state.contact)
    rx, rz, wx, wz = vx0, vz0, ax, az  # sums of the slopes of place and velocity
    vx, vz = vx0, vz0  # slope of the place at the stage before
    for stage in range(3):
        reach = h if stage == 2 else 0.5 * h
        weight = 1.0 if stage == 2 else 2.0
        x1, z1, vx1, vz1 = x0 + reach * vx, z0 + reach * vz, vx0 + reach * ax, vz0 + reach * az
        pose = poses[1 if stage == 2 else 0]
        at = touch(world, sole, pose, x1, z1, vx1, vz1, state.bristles, reach, counts)
        sums = add(sums, weight * h / 6.0, z1, vx1, vz1, at)
        ax, az = acceleration(world, at)
        vx, vz = vx1, vz1
        rx, rz = rx + weight * vx, rz + weight * vz
        wx, wz = wx + weight * ax, wz + weight * az
    x, z, vx, vz = x0 + h / 6.0 * rx, z0 + h / 6.0 * rz, vx0 + h / 6.0 * wx, vz0 + h / 6.0 * wz
    return arrive(world, sole, poses[1], x, z, vx, vz, sums, state.bristles, h, counts)


register("rk4", RK4(), rk4, nodes=(0.5, 1.0), order=4, source="Kutta, Z. Math. Phys. 46, 1901")
