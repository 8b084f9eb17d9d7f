"""Time steppers: how the hip's position and velocity advance by one step.

A stepper is a small parameter tuple and one function, joined by `register`; nothing else has to
change for a new one. The function advances the state from t to t + h:

    solved = step(stepper, y, now, quad, tally, h, poses, sole, world, work)

- ``y`` (4,): hip x, z (m), v_x, v_z (m/s); advanced in place.
- ``now`` (2, 7): the contact at (t, y) when called, at the new time and state when it returns.
- ``quad``: integrals along the walk; the step adds its own quadrature of every stage with `add`.
- ``poses`` (nodes, 2, 7): the pose of both feet at t + node h, for the registered nodes; the last
  node is 1.
- ``work`` (2, 7): scratch.
- ``tally``: the walk's counts (`kernels.EVALUATIONS` and so on).
- It returns whether the step could be solved.

The function is chosen at compile time by the type of the tuple, so the loop over steps holds one
stepper only, inlined, and is cached on disk for each.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from numba import njit
from numba.extending import overload

from footopt.walk.contact import FX, FZ, POWER, contact, leaning, solve_stage

#: The integrals along a walk: work of the left and the right foot (J), hip height (m s), positive
#: and net work of the joints of both legs (J), and the impulse of the sand (N s).
WORK_L, WORK_R, HEIGHT, JOINT, JOINT_NET, IMPULSE_X, IMPULSE_Z = range(7)


@dataclass(frozen=True)
class Stepper:
    """A stepper's entry: its parameters, its step function, where in a step it needs the pose, and
    whether it is L-stable, so that its steps may be long while the walker stands.
    """

    parameters: Any
    step: Callable[..., bool]
    nodes: tuple[float, ...]
    implicit: bool


STEPPERS: dict[str, Stepper] = {}
STEPS: dict[type, Callable[..., bool]] = {}


def register(
    name: str,
    parameters: Any,
    step: Callable[..., bool],
    nodes: tuple[float, ...],
    implicit: bool = False,
) -> None:
    """Offer a stepper under a name. `parameters` is an instance of a class of its own."""
    STEPPERS[name] = Stepper(parameters, step, nodes, implicit)
    STEPS[type(parameters)] = step


def advance(stepper, y, now, quad, tally, h, poses, sole, world, work):
    """The step of whichever stepper the first argument is; resolved when the loop is compiled."""
    return STEPS[type(stepper)](stepper, y, now, quad, tally, h, poses, sole, world, work)


@overload(advance, jit_options={"forceinline": True})
def _resolve(stepper, y, now, quad, tally, h, poses, sole, world, work):
    return STEPS[stepper.instance_class]


@njit(forceinline=True)
def add(quad, weight, z, vx, vz, at):
    """Add one stage, with its weight in s, to the integrals along the walk."""
    for foot in range(2):
        quad[WORK_L + foot] += weight * at[foot, POWER]
        joint = at[foot, FX] * vx + at[foot, FZ] * vz - at[foot, POWER]
        quad[JOINT] += weight * max(joint, 0.0)
        quad[JOINT_NET] += weight * joint
        quad[IMPULSE_X] += weight * at[foot, FX]
        quad[IMPULSE_Z] += weight * at[foot, FZ]
    quad[HEIGHT] += weight * z


@njit(forceinline=True)
def acceleration(at, world):
    """Of the hip, from a contact: a_x, a_z in m/s^2 (the paper's eq. 5)."""
    ax = leaning((at[0, FX] + at[1, FX]) / world.mass, world.tilt, 1.0)
    return ax, (at[0, FZ] + at[1, FZ]) / world.mass - world.g


class ExplicitEuler(NamedTuple):
    """See `explicit_euler`; it has no parameters."""


def explicit_euler(stepper, y, now, quad, tally, h, poses, sole, world, work):
    """The paper's stepper (its eq. 6): position and velocity both from the old state. Order 1."""
    ax, az = acceleration(now, world)
    add(quad, h, y[1], y[2], y[3], now)
    y[0] += h * y[2]
    y[1] += h * y[3]
    y[2] += h * ax
    y[3] += h * az
    contact(now, tally, sole, world, poses[0], y[0], y[1], y[2], y[3], world.creep, None)
    return True


register("explicit_euler", ExplicitEuler(), explicit_euler, nodes=(1.0,))


class SemiImplicitEuler(NamedTuple):
    """See `semi_implicit_euler`; it has no parameters."""


def semi_implicit_euler(stepper, y, now, quad, tally, h, poses, sole, world, work):
    """Velocity from the old force, then position from the new velocity. Order 1."""
    ax, az = acceleration(now, world)
    add(quad, h, y[1], y[2], y[3], now)
    y[2] += h * ax
    y[3] += h * az
    y[0] += h * y[2]
    y[1] += h * y[3]
    contact(now, tally, sole, world, poses[0], y[0], y[1], y[2], y[3], world.creep, None)
    return True


register("semi_implicit_euler", SemiImplicitEuler(), semi_implicit_euler, nodes=(1.0,))


class Heun(NamedTuple):
    """See `heun`; it has no parameters."""


def heun(stepper, y, now, quad, tally, h, poses, sole, world, work):
    """Explicit trapezoidal rule: the mean of the slopes at both ends. Order 2."""
    ax, az = acceleration(now, world)
    x1, z1, vx1, vz1 = y[0] + h * y[2], y[1] + h * y[3], y[2] + h * ax, y[3] + h * az
    contact(work, tally, sole, world, poses[0], x1, z1, vx1, vz1, world.creep, None)
    bx, bz = acceleration(work, world)
    add(quad, 0.5 * h, y[1], y[2], y[3], now)
    add(quad, 0.5 * h, z1, vx1, vz1, work)
    y[0] += 0.5 * h * (y[2] + vx1)
    y[1] += 0.5 * h * (y[3] + vz1)
    y[2] += 0.5 * h * (ax + bx)
    y[3] += 0.5 * h * (az + bz)
    contact(now, tally, sole, world, poses[0], y[0], y[1], y[2], y[3], world.creep, None)
    return True


register("heun", Heun(), heun, nodes=(1.0,))


class RK4(NamedTuple):
    """See `rk4`; it has no parameters."""


def rk4(stepper, y, now, quad, tally, h, poses, sole, world, work):
    """The classical Runge-Kutta method (Kutta 1901). Order 4 where the forces are smooth."""
    x0, z0, vx0, vz0 = y[0], y[1], y[2], y[3]
    ax, az = acceleration(now, world)
    add(quad, h / 6.0, z0, vx0, vz0, now)
    px, pz, qx, qz = vx0, vz0, ax, az  # sums of the slopes of place and velocity
    vx, vz = vx0, vz0  # slope of the place at the stage before
    for stage in range(3):
        reach = h if stage == 2 else 0.5 * h
        weight = 1.0 if stage == 2 else 2.0
        x1, z1, vx1, vz1 = x0 + reach * vx, z0 + reach * vz, vx0 + reach * ax, vz0 + reach * az
        pose = poses[1 if stage == 2 else 0]
        contact(work, tally, sole, world, pose, x1, z1, vx1, vz1, world.creep, None)
        add(quad, weight * h / 6.0, z1, vx1, vz1, work)
        ax, az = acceleration(work, world)
        vx, vz = vx1, vz1
        px, pz = px + weight * vx, pz + weight * vz
        qx, qz = qx + weight * ax, qz + weight * az
    y[0], y[1] = x0 + h / 6.0 * px, z0 + h / 6.0 * pz
    y[2], y[3] = vx0 + h / 6.0 * qx, vz0 + h / 6.0 * qz
    contact(now, tally, sole, world, poses[1], y[0], y[1], y[2], y[3], world.creep, None)
    return True


register("rk4", RK4(), rk4, nodes=(0.5, 1.0))


class ImplicitEuler(NamedTuple):
    """See `implicit_euler`; it has no parameters."""


def implicit_euler(stepper, y, now, quad, tally, h, poses, sole, world, work):
    """Force and velocity at the end of the step, L-stable. Order 1."""
    ax, az = acceleration(now, world)
    vx, vz, solved = solve_stage(
        now, tally, sole, world, poses[0], y[0], y[1], y[2], y[3], h, y[2] + h * ax, y[3] + h * az
    )
    if not solved:
        return False
    y[0] += h * vx
    y[1] += h * vz
    y[2], y[3] = vx, vz
    add(quad, h, y[1], vx, vz, now)
    return True


register("implicit_euler", ImplicitEuler(), implicit_euler, nodes=(1.0,), implicit=True)


class SDIRK2(NamedTuple):
    """See `sdirk2`; ``gamma`` is the coefficient of both implicit stages."""

    gamma: float = 1.0 - 1.0 / math.sqrt(2.0)


def sdirk2(stepper, y, now, quad, tally, h, poses, sole, world, work):
    """Two implicit stages with the same coefficient, L-stable. Order 2.

    Alexander, SIAM J. Numer. Anal. 14 (1977): gamma = 1 - 1/sqrt(2), stages at gamma and 1, the
    second being the end of the step. The unknown of a stage is the hip's velocity; its height
    follows from it.
    """
    g = stepper.gamma
    c, r = g * h, (1.0 - g) * h
    x0, z0, vx0, vz0 = y[0], y[1], y[2], y[3]
    ax, az = acceleration(now, world)
    vx, vz, solved = solve_stage(
        work, tally, sole, world, poses[0], x0, z0, vx0, vz0, c, vx0 + c * ax, vz0 + c * az
    )
    if not solved:
        return False
    add(quad, r, z0 + c * vz, vx, vz, work)
    bx, bz = acceleration(work, world)
    x1, z1 = x0 + r * vx, z0 + r * vz
    # the guess follows the change of acceleration so far, to the end of the step
    gx, gz = vx + r * (bx + (bx - ax)), vz + r * (bz + (bz - az))
    vx, vz, solved = solve_stage(
        now, tally, sole, world, poses[1], x1, z1, vx0 + r * bx, vz0 + r * bz, c, gx, gz
    )
    if not solved:
        return False
    y[0], y[1], y[2], y[3] = x1 + c * vx, z1 + c * vz, vx, vz
    add(quad, c, y[1], vx, vz, now)
    return True


register("sdirk2", SDIRK2(), sdirk2, nodes=(SDIRK2().gamma, 1.0), implicit=True)
