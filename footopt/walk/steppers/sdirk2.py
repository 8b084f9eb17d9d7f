"""SDIRK2: two implicit stages with the same coefficient gamma = 1 - 1/sqrt(2).

    gamma | gamma
    1     | 1 - gamma  gamma
    ------+------------------
          | 1 - gamma  gamma

Order 2, L-stable and stiffly accurate: the second stage is the end of the step.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from footopt.walk.bristles import first_stage, next_step, second_stage
from footopt.walk.newton import guess, solve_stage
from footopt.walk.state import State
from footopt.walk.steppers.base import STEPPERS, Stepper, acceleration, accumulate


class SDIRK2(NamedTuple):
    """``gamma`` is the coefficient of both implicit stages."""

    gamma: float = 1.0 - 1.0 / math.sqrt(2.0)

    def step(self, world, sole, poses, state, h, counts):
        """The unknown of a stage is the hip's velocity; its place follows from it."""
        c, r = self.gamma * h, (1.0 - self.gamma) * h
        x0, z0, vx0, vz0 = state.x, state.z, state.vx, state.vz
        ax, az = acceleration(world, state.contact)
        half, whole = first_stage(state.bristles, r / c), second_stage(state.bristles)
        gx, gz = guess(world.creep, vx0, vz0, c * ax, c * az)
        one = solve_stage(world, sole, poses[0], x0, z0, vx0, vz0, c, gx, gz, half, counts)
        if not one.solved:
            return State(x0, z0, vx0, vz0, state.contact, state.integrals, state.bristles, False)
        sums = accumulate(state.integrals, r, z0 + c * one.vz, one.vx, one.vz, one.contact)
        bx, bz = acceleration(world, one.contact)
        x1, z1, vx1, vz1 = x0 + r * one.vx, z0 + r * one.vz, vx0 + r * bx, vz0 + r * bz
        # the guess follows the change of acceleration so far, to the end of the step
        dvx, dvz = r * (bx + (bx - ax)), r * (bz + (bz - az))
        gx, gz = guess(world.creep, one.vx, one.vz, dvx, dvz)
        two = solve_stage(world, sole, poses[1], x1, z1, vx1, vz1, c, gx, gz, whole, counts)
        x, z = x1 + c * two.vx, z1 + c * two.vz
        sums = accumulate(sums, c, z, two.vx, two.vz, two.contact)
        return State(x, z, two.vx, two.vz, two.contact, sums, next_step(state.bristles), two.solved)


STEPPERS["sdirk2"] = Stepper(
    SDIRK2(), (SDIRK2().gamma, 1.0), 2, implicit=True, source="Alexander, SIAM J. Numer. Anal. 14, 1977"
)
