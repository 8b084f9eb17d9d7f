"""Explicit methods: Euler, Heun and RK4 by their tableaux, and semi-implicit Euler.

Each stage of a tableau begins with the slope of the stage before:

    0       |                              a_{i, i-1} = c_i, all others 0
    c_2     | c_2
    c_3     | 0    c_3
    --------+-----------------
            | b_1  b_2  b_3

All are stable against the smoothed law only for dt < 2 eps / g (2.8 eps / g of RK4).
"""

from typing import NamedTuple

from footopt.errors import check
from footopt.walk.state import moved
from footopt.walk.steppers import STEPPERS, Stepper, acceleration, accumulate, explicit_contact, finish_step


class Tableau(NamedTuple):
    """A Butcher tableau: its nodes c, its weights b, and which of the stepper's poses a stage has."""

    c: tuple[float, ...]
    b: tuple[float, ...]
    pose: tuple[int, ...]

    def step(self, world, sole, poses, state, h, counts):
        """The first stage is the contact that the state holds."""
        start, hip, at = state.hip, state.hip, state.contact
        ax, az = acceleration(world, at)
        weight = self.b[0] * h
        sums, end = accumulate(state.integrals, weight, hip, at), moved(start, weight, hip.vx, hip.vz, ax, az)
        for i in range(1, len(self.b)):
            reach, weight, pose = self.c[i] * h, self.b[i] * h, poses[self.pose[i]]
            hip = moved(start, reach, hip.vx, hip.vz, ax, az)
            at = explicit_contact(world, sole, pose, hip, state.bristles.e_n, reach, counts)
            ax, az = acceleration(world, at)
            sums, end = accumulate(sums, weight, hip, at), moved(end, weight, hip.vx, hip.vz, ax, az)
        return finish_step(world, sole, poses[-1], end, sums, state.bristles, h, counts)


class SemiImplicitEuler(NamedTuple):
    """Symplectic Euler: velocity from the old force, then position from the new velocity."""

    def step(self, world, sole, poses, state, h, counts):
        """v + h a, r + h v of the new v."""
        start, (ax, az) = state.hip, acceleration(world, state.contact)
        sums = accumulate(state.integrals, h, start, state.contact)
        end = moved(start, h, start.vx + h * ax, start.vz + h * az, ax, az)
        return finish_step(world, sole, poses[0], end, sums, state.bristles, h, counts)


def runge_kutta(c: tuple[float, ...], b: tuple[float, ...]) -> Stepper:
    """The stepper of a tableau whose stages each begin with the slope of the stage before."""
    good = len(b) == len(c) > 0 and c[0] == 0.0 and abs(sum(b) - 1.0) < 1e-9
    check(good, "b", b, f"as many weights as nodes, {len(c)}, with a sum of 1; the first node is 0")
    nodes = (*sorted({*c[1:]} - {1.0}), 1.0)
    return Stepper(Tableau(c, b, (0, *map(nodes.index, c[1:]))), nodes)


STEPPERS["explicit_euler"] = runge_kutta((0.0,), (1.0,))  # the paper's eq. 6
# Hairer, Lubich & Wanner, Geometric Numerical Integration, 2006, I.1.2
STEPPERS["semi_implicit_euler"] = Stepper(SemiImplicitEuler(), (1.0,))
STEPPERS["heun"] = runge_kutta((0.0, 1.0), (0.5, 0.5))  # Hairer, Norsett & Wanner, ODEs I, 1993, II.1
# Kutta, Z. Math. Phys. 46, 1901
STEPPERS["rk4"] = runge_kutta((0.0, 0.5, 0.5, 1.0), (1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0))
