"""Semi-implicit (symplectic) Euler: velocity from the old force, then position from the new velocity.

Order 1. Stable against the smoothed law only for dt < 2 eps / g.
"""

from __future__ import annotations

from typing import NamedTuple

from footopt.walk.state import moved
from footopt.walk.steppers.base import STEPPERS, Stepper, acceleration, accumulate, finish_step


class SemiImplicitEuler(NamedTuple):
    """It has no parameters."""

    def step(self, world, sole, poses, state, h, counts):
        """v + h a, r + h v of the new v."""
        start, (ax, az) = state.hip, acceleration(world, state.contact)
        sums = accumulate(state.integrals, h, start, state.contact)
        end = moved(start, h, start.vx + h * ax, start.vz + h * az, ax, az)
        return finish_step(world, sole, poses[0], end, sums, state.bristles, h, counts)


STEPPERS["semi_implicit_euler"] = Stepper(
    SemiImplicitEuler(),
    (1.0,),
    1,
    source="Hairer, Lubich & Wanner, Geometric Numerical Integration, 2006, I.1.2",
)
