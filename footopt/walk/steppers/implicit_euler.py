"""Implicit Euler: force and velocity at the end of the step.

    1 | 1
    --+---
      | 1

Order 1, L-stable.
"""

from __future__ import annotations

from typing import NamedTuple

from footopt.walk.bristles import next_step, whole_step
from footopt.walk.newton import guess, solve_stage
from footopt.walk.state import State
from footopt.walk.steppers.base import STEPPERS, Stepper, acceleration, accumulate


class ImplicitEuler(NamedTuple):
    """It has no parameters."""

    def step(self, world, sole, poses, state, h, counts):
        """One implicit stage, the end of the step."""
        x, z, vx, vz = state.x, state.z, state.vx, state.vz
        ax, az = acceleration(world, state.contact)
        gx, gz = guess(world.creep, vx, vz, h * ax, h * az)
        bristles = whole_step(state.bristles)
        end = solve_stage(world, sole, poses[0], x, z, vx, vz, h, gx, gz, bristles, counts)
        x, z = x + h * end.vx, z + h * end.vz
        sums = accumulate(state.integrals, h, z, end.vx, end.vz, end.contact)
        return State(x, z, end.vx, end.vz, end.contact, sums, next_step(state.bristles), end.solved)


STEPPERS["implicit_euler"] = Stepper(
    ImplicitEuler(), (1.0,), 1, implicit=True, source="Hairer & Wanner, ODEs II, 1996, IV.3"
)
