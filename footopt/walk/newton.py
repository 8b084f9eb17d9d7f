"""One implicit stage of a step, solved for the hip's velocity by Newton's method."""

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined
from footopt.walk.bristles import bend, turning_speed_of
from footopt.walk.contact import contact
from footopt.walk.state import NO_FOOT, Contact, Force, Motion, no_contact
from footopt.walk.turning import begun, ended, half_way, stepped, turning_plate

MAX_NEWTON = 100  # contact evaluations of one implicit stage
HALVINGS = 16  # of a step of Newton's method, before the stage is left unsolved
SMOOTH_STEP = 2.0  # largest last step over the turning speed, where a foot turns over or an effect has a gate


class Stage(NamedTuple):
    """The end of an implicit stage."""

    hip: Motion
    contact: Contact
    solved: bool


@inlined
def solve_stage(world, sole, poses, start, c, vx, vz, bristles, turning, counts):
    """Velocity V of an implicit stage: V = v0 + c a(r0 + c V, V), by Newton's method.

    Starts from the guess (vx, vz) and ends with a step that is small (`converged`): Newton's method has then
    converged to the square of that ratio. The stage's forces are carried along the last step to first order,
    so that its momentum balance closes to rounding.

    Where a step makes the residual larger, a foot has turned its direction of motion over. Newton's method
    goes on half-way in that foot's direction w, and its steps are those of w (`footopt.walk.turning`), halved
    until they make the residual smaller.

    Parameters
    ----------
    start : Motion
        r0, m, and v0, m/s.
    c : float, s
        The stage's coefficient times the time step.
    vx, vz : float, m/s
        The guess.
    bristles : bristles.StageBristles
        Those that the stage bends.
    turning : Turning
        Of the stage before.
    world, sole, poses, counts
        As in `contact`.

    Returns
    -------
    Stage
    """
    inv, h0 = c / world.mass, bristles.before
    turning_speed = turning_speed_of(world.bristle_length, world, c)
    hip = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
    plate, vx, vz = begun(sole, poses, hip, turning, turning_speed, h0)
    best, best_vx, best_vz, dvx, dvz, halved = np.inf, vx, vz, 0.0, 0.0, 0
    for _ in range(MAX_NEWTON):
        hip = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
        at = contact(world, sole, poses, hip, turning_speed, c, h0, counts)
        rx, rz = residual(world, start, c, hip, at)
        square = rx * rx + rz * rz
        if square <= best:
            best, best_vx, best_vz, halved = square, vx, vz, 0
            dvx, dvz = newton_step(slope_of(inv, at), rx, rz)
            if converged(world, vx, vz, dvx, dvz, at, turning_speed, plate):
                vx, vz = vx + dvx, vz + dvz
                end = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
                bend(h0, world, sole, poses, end, c, bristles)
                left, right = _extrapolated(at.left, dvx, dvz), _extrapolated(at.right, dvx, dvz)
                return Stage(end, Contact(left, right, ended(plate, vx, vz)), True)
            vx, vz = stepped(plate, vx, vz, dvx, dvz, h0)
        elif plate.foot == NO_FOOT:
            plate = turning_plate(sole, poses, hip, best_vx, best_vz, turning_speed, h0)
            vx, vz = half_way(plate, best_vx, best_vz, vx, vz)
            best = np.inf
        elif halved < HALVINGS:
            dvx, dvz, halved = 0.5 * dvx, 0.5 * dvz, halved + 1
            vx, vz = stepped(plate, best_vx, best_vz, dvx, dvz, h0)
        else:
            break
    return Stage(start, no_contact(), False)


@inlined
def residual(world, start, c, hip, at):
    """V - v0 - c a, m/s."""
    inv, left, right = c / world.mass, at.left, at.right
    rx = hip.vx - (start.vx + c * world.tilt) - inv * (left.x + right.x)
    return rx, hip.vz - start.vz - inv * (left.z + right.z) + c * world.g


@inlined
def slope_of(inv, at):
    """J = 1 - c/M dF/dV of the residual; inv: c/M."""
    left, right = at.left, at.right
    jxx = 1.0 - inv * (left.xx + right.xx)
    jxz = -inv * (left.xz + right.xz)
    jzx = -inv * (left.zx + right.zx)
    jzz = 1.0 - inv * (left.zz + right.zz)
    return jxx, jxz, jzx, jzz


@inlined
def newton_step(slope, rx, rz):
    """Solution of J dV = -r, m/s."""
    jxx, jxz, jzx, jzz = slope
    det = 1.0 / (jxx * jzz - jxz * jzx)
    return (jxz * rz - jzz * rx) * det, (jzx * rx - jxx * rz) * det


@inlined
def converged(world, vx, vz, dvx, dvz, at, turning_speed, plate):
    """Whether a step is small against the speed at which the plates of the slower foot move through the sand.

    That speed (`_speed`) is at least the creep speed, on which the law is smooth.
    """
    left, right = at.left, at.right
    size = abs(dvx) + abs(dvz)
    force = (abs(left.x) + abs(left.z)) + (abs(right.x) + abs(right.z))
    rounding = 1e-13 * (1.0 + abs(vx) + abs(vz))
    speed = turning_speed
    if force > 0.0:
        # at rest a step that is small against the turning speed of bristles would be a drift
        speed *= 1.0 if world.bristle_length is None else 1e-3
        speed += min(_speed(left, force), _speed(right, force))
    enough = world.tolerance * speed
    if plate.foot != NO_FOOT:
        enough = min(enough, SMOOTH_STEP * plate.speed)
    if not world.bypass and world.effects.gates is not None:  # a gate opens within the turning speed
        enough = min(enough, SMOOTH_STEP * turning_speed)
    return size <= rounding or (force > 0.0 and size <= enough + rounding)


@inlined
def _speed(foot, both):
    """Mean speed of a foot's plates, |P| / |F|, m/s: larger where it carries little of the force on both, N.

    Beside a foot that slips, one that sticks must not be solved at the speed of both together.
    """
    force = abs(foot.x) + abs(foot.z)
    if force == 0.0:
        return np.inf
    return abs(foot.power) / force * np.sqrt(both / force)


@inlined
def _extrapolated(force, dvx, dvz):
    """A foot's force after a small change of the velocity, to first order."""
    return Force(
        force.x + (force.xx * dvx + force.xz * dvz),
        force.z + (force.zx * dvx + force.zz * dvz),
        force.power,
        force.xx,
        force.xz,
        force.zx,
        force.zz,
    )
