"""Semi-implicit (symplectic) Euler: velocity from the old force, then position from the new velocity.

Order 1. Stable against the smoothed law only for dt < 2 eps / g.
"""

from __future__ import annotations

from typing import NamedTuple

from footopt.walk.steppers.base import STEPPERS, Stepper, acceleration, accumulate, finish_step


class SemiImplicitEuler(NamedTuple):
    """It has no parameters."""

    def step(self, world, sole, poses, state, h, counts):
        """v + h a, r + h v of the new v."""
        ax, az = acceleration(world, state.contact)
        sums = accumulate(state.integrals, h, state.z, state.vx, state.vz, state.contact)
        vx, vz = state.vx + h * ax, state.vz + h * az
        x, z = state.x + h * vx, state.z + h * vz
        return finish_step(world, sole, poses[0], x, z, vx, vz, sums, state.bristles, h, counts)


STEPPERS["semi_implicit_euler"] = Stepper(
    SemiImplicitEuler(),
    (1.0,),
    1,
    source="Hairer, Lubich & Wanner, Geometric Numerical Integration, 2006, I.1.2",
)
