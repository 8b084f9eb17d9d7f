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
        start, (ax, az) = state.hip, acceleration(world, state.contact)
        gx, gz = guess(world.creep, start.vx, start.vz, h * ax, h * az)
        end = solve_stage(world, sole, poses[0], start, h, gx, gz, whole_step(state.bristles), counts)
        sums = accumulate(state.integrals, h, end.hip, end.contact)
        return State(end.hip, end.contact, sums, next_step(state.bristles), end.solved)


STEPPERS["implicit_euler"] = Stepper(
    ImplicitEuler(), (1.0,), 1, implicit=True, source="Hairer & Wanner, ODEs II, 1996, IV.3"
)
