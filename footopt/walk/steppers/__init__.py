"""Time steppers: NamedTuples of parameters with a method that advances the walker by a time step.

A new file in this folder is imported automatically.

The method makes the state at t + h out of that at t, and changes nothing but the counts:

    state = self.step(world, sole, poses, state, h, counts)

- The loop over steps finds the method by the type of ``self`` when it is compiled. Each compiled loop holds
  one stepper only, inlined.
- ``world``, ``sole``, ``state``, ``counts``: see `footopt.walk.state`. ``state.contact`` is the contact at
  the state's own time; ``state.integrals`` grow by the step's own quadrature of every stage (`accumulate`).
- ``poses`` (nodes, 2, 7): both feet at t + node h, for the stepper's nodes; the last node is 1.
- ``solved`` of the new state says whether the step could be made.
"""

import pkgutil
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from numba.extending import overload

from footopt.compiled import INLINE, inlined
from footopt.errors import check
from footopt.walk.bristles import bend, next_step, transition_speed_of
from footopt.walk.contact import contact
from footopt.walk.state import Integrals, State


@dataclass(frozen=True)
class Stepper:
    """A stepper's entry in `STEPPERS`."""

    parameters: Any  # a NamedTuple with the method `step`, see the top of this module
    nodes: tuple[float, ...]  # where in a step it needs the pose, as shares of the step
    implicit: bool = False  # whether it is L-stable, so that its steps may be long while the walker stands

    def __post_init__(self) -> None:
        check(
            self.nodes and self.nodes[-1] == 1.0, "nodes", self.nodes, "some that end with 1, the step's end"
        )


STEPPERS: dict[str, Stepper] = {}


def advance(method, world, sole, poses, state, h, counts):
    """The step of whichever stepper the first argument is; resolved when the loop is compiled."""
    return method.step(world, sole, poses, state, h, counts)


@overload(advance, strict=False, jit_options=INLINE)
def _resolve(method, world, sole, poses, state, h, counts):
    return method.instance_class.step


@inlined
def acceleration(world, at):
    """The hip's acceleration (a_x, a_z), m/s^2, by the contact forces and gravity: the paper's eq. 5."""
    ax = (at.left.x + at.right.x) / world.mass + world.tilt
    return ax, (at.left.z + at.right.z) / world.mass - world.g


@inlined
def explicit_contact(world, sole, poses, hip, e0, time, counts):
    """The contact at a motion of the hip, without derivatives.

    e0: bristles at the step's beginning, or None. time: since then, s, for which they have followed plates.
    """
    transition = transition_speed_of(world.bristle_length, world, time)
    return contact(world, sole, poses, hip, transition, world.given, e0, counts)


@inlined
def finish_step(world, sole, poses, hip, integrals, bristles, h, counts):
    """The state at the end of an explicit step."""
    at = explicit_contact(world, sole, poses, hip, bristles.e_n, h, counts)
    bend(bristles.e_n, bristles.e_next, 1.0, world, sole, poses, hip, h)
    return State(hip, at, integrals, next_step(bristles), True)


@inlined
def accumulate(sums, weight, hip, at):
    """Integrals along the walk with one stage more, of a weight in s, a motion of the hip, a contact."""
    left, right = at.left, at.right
    joint_left = left.x * hip.vx + left.z * hip.vz - left.power
    joint_right = right.x * hip.vx + right.z * hip.vz - right.power
    return Integrals(
        work_left=sums.work_left + weight * left.power,
        work_right=sums.work_right + weight * right.power,
        height=sums.height + weight * hip.z,
        joint=sums.joint + weight * max(joint_left, 0.0) + weight * max(joint_right, 0.0),
        joint_net=sums.joint_net + weight * joint_left + weight * joint_right,
        impulse_x=sums.impulse_x + weight * left.x + weight * right.x,
        impulse_z=sums.impulse_z + weight * left.z + weight * right.z,
    )


for _module in pkgutil.iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
