"""Implicit methods, all L-stable: implicit Euler and SDIRK2.

1 | 1         gamma | gamma
--+---        1     | 1 - gamma  gamma        gamma = 1 - 1 / sqrt(2)
  | 1         ------+------------------
                    | 1 - gamma  gamma
"""

import math
from typing import NamedTuple

from footopt.walk.bristles import bend, next_step
from footopt.walk.newton import solve_stage
from footopt.walk.state import State, moved
from footopt.walk.steppers import STEPPERS, Stepper, acceleration, accumulate


class ImplicitEuler(NamedTuple):
    """Force and velocity at the end of the step."""

    def step(self, world, sole, poses, state, h, counts):
        """One implicit stage, the end of the step."""
        start, (ax, az) = state.hip, acceleration(world, state.contact)
        gx, gz = start.vx + h * ax, start.vz + h * az
        b, reversal = state.bristles, state.contact.reversal
        hip, at, solved = solve_stage(world, sole, poses[0], start, h, gx, gz, b.e_n, reversal, counts)
        bend(b.e_n, b.e_next, 1.0, world, sole, poses[0], hip, h)
        return State(hip, at, accumulate(state.integrals, h, hip, at), next_step(b), solved)


class SDIRK2(NamedTuple):
    """Two stages, of which the second is the end of the step; ``gamma`` is the coefficient of both."""

    gamma: float = 1.0 - 1.0 / math.sqrt(2.0)

    def step(self, world, sole, poses, state, h, counts):
        """The unknown of a stage is the hip's velocity; its place follows from it."""
        c, r = self.gamma * h, (1.0 - self.gamma) * h
        start, hip, at, sums, solved = state.hip, state.hip, state.contact, state.integrals, True
        ax, az = acceleration(world, at)
        gx, gz = start.vx + c * ax, start.vz + c * az
        for i in range(2):  # one copy of the stage: what is written twice is compiled twice
            if i == 0:  # the second stage begins on the first one's slope, r / c of its way from the start
                before, after, part = state.bristles.e_n, state.bristles.e_stage, r / c
            else:
                before, after, part = state.bristles.e_stage, state.bristles.e_next, 1.0
            stage = solve_stage(world, sole, poses[i], start, c, gx, gz, before, at.reversal, counts)
            hip, at, solved = stage
            if not solved:
                break
            bend(before, after, part, world, sole, poses[i], hip, c)
            sums = accumulate(sums, r if i == 0 else c, hip, at)
            bx, bz = acceleration(world, at)
            start = moved(start, r, hip.vx, hip.vz, bx, bz)
            # the guess follows the change of acceleration so far, to the end of the step
            gx, gz = hip.vx + r * (bx + (bx - ax)), hip.vz + r * (bz + (bz - az))
        return State(hip, at, sums, next_step(state.bristles), solved)


# Hairer & Wanner, ODEs II, 1996, IV.3
STEPPERS["implicit_euler"] = Stepper(ImplicitEuler(), (1.0,), implicit=True)
# Alexander, SIAM J. Numer. Anal. 14, 1977
STEPPERS["sdirk2"] = Stepper(SDIRK2(), (SDIRK2().gamma, 1.0), implicit=True)
