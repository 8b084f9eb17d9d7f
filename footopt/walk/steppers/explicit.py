"""Explicit Runge-Kutta methods whose stages each begin with the slope of the stage before: Euler, Heun, RK4.

    0       |                              a_{i, i-1} = c_i, all others 0
    c_2     | c_2
    c_3     | 0    c_3
    --------+-----------------
            | b_1  b_2  b_3

They are stable against the smoothed law only for dt < 2 eps / g (2.8 eps / g of RK4).
"""

from __future__ import annotations

from typing import NamedTuple

from footopt.walk.steppers.base import (
    STEPPERS,
    Stepper,
    acceleration,
    accumulate,
    explicit_contact,
    finish_step,
)


class Tableau(NamedTuple):
    """A Butcher tableau: its nodes c, its weights b, and which of the stepper's poses a stage has."""

    c: tuple[float, ...]
    b: tuple[float, ...]
    pose: tuple[int, ...]

    def step(self, world, sole, poses, state, h, counts):
        """The first stage is the contact that the state holds."""
        x0, z0, vx0, vz0, at = state.x, state.z, state.vx, state.vz, state.contact
        ax, az = acceleration(world, at)
        weight = self.b[0] * h
        sums = accumulate(state.integrals, weight, z0, vx0, vz0, at)
        x, z, vx, vz = x0 + weight * vx0, z0 + weight * vz0, vx0 + weight * ax, vz0 + weight * az
        ux, uz = vx0, vz0  # velocity of the stage before
        for i in range(1, len(self.b)):
            reach, weight = self.c[i] * h, self.b[i] * h
            x1, z1, ux1, uz1 = x0 + reach * ux, z0 + reach * uz, vx0 + reach * ax, vz0 + reach * az
            ux, uz, pose = ux1, uz1, poses[self.pose[i]]
            at = explicit_contact(world, sole, pose, x1, z1, ux, uz, state.bristles, reach, counts)
            sums = accumulate(sums, weight, z1, ux, uz, at)
            ax, az = acceleration(world, at)
            x, z, vx, vz = x + weight * ux, z + weight * uz, vx + weight * ax, vz + weight * az
        return finish_step(world, sole, poses[-1], x, z, vx, vz, sums, state.bristles, h, counts)


def runge_kutta(c: tuple[float, ...], b: tuple[float, ...], order: int, source: str) -> Stepper:
    """The stepper of a tableau."""
    nodes = tuple(sorted({*c[1:], 1.0}))
    pose = (0, *map(nodes.index, c[1:]))
    return Stepper(Tableau(c, b, pose), nodes, order, source=source)


STEPPERS["explicit_euler"] = runge_kutta((0.0,), (1.0,), 1, "the paper's eq. 6")
STEPPERS["heun"] = runge_kutta((0.0, 1.0), (0.5, 0.5), 2, "Hairer, Norsett & Wanner, ODEs I, 1993, II.1")
STEPPERS["rk4"] = runge_kutta(
    (0.0, 0.5, 0.5, 1.0), (1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0), 4, "Kutta, Z. Math. Phys. 46, 1901"
)
