"""One implicit stage of a step, solved for the hip's velocity by Newton's method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined, unless_none
from footopt.walk.bristles import update_bristles
from footopt.walk.contact import Direction, bristles_between, contact, direction, kinematics
from footopt.walk.state import (
    Contact,
    Force,
    Implicit,
    Motion,
    Turning,
    ankle_of,
    in_world,
    lowest,
    no_force,
    no_turning,
)

MAX_NEWTON = 100  # contact evaluations of one implicit stage
PATIENCE = 8  # of them ahead of h without a smaller residual, before Newton's method goes on from the best
NEAR = 0.1  # |w_x - h_x| + |w_z - h_z| of both feet, within which no foot has turned over
INSIDE = 0.999  # |w| at most
STICKS = 0.995  # |w| at most, of a foot whose velocity is known from w
GATE_STEP = 2.0  # largest last step of Newton's method over the creep speed, where an effect has a gate

PLAIN, AHEAD, DAMPED = range(3)  # steps of Newton's method: with w = h; with w ahead of h; with back-tracking


class Stage(NamedTuple):
    """The end of an implicit stage."""

    hip: Motion
    contact: Contact
    solved: bool


class Iterate(NamedTuple):
    """Where Newton's method is."""

    vx: float  # m/s, tried next
    vz: float
    dvx: float  # m/s, the step to there
    dvz: float
    best: float  # least residual squared, m^2/s^2
    best_vx: float  # m/s, where it is
    best_vz: float


@inlined
def solve_stage(world, sole, poses, start, c, vx, vz, bristles, turning, counts):
    """Velocity V of an implicit stage: V = v0 + c a(r0 + c V, V), by Newton's method.

    Starts from the guess (vx, vz) and ends with a step that is small (`converged`): Newton's method has then
    converged to the square of that ratio. The stage's forces are carried along the last step to first order,
    so that its momentum balance closes to rounding.

    Where a step makes the residual larger, a foot has turned its direction of motion over: far beyond the
    creep speed the slope of h does not show the way back. From there on the direction w of either foot is an
    unknown of its own (`turned`) and stands for h in dh/dv = rate (I - w h^T), as in primal-dual methods for
    total variation (Chan, Golub & Mulet, SIAM J. Sci. Comput. 20, 1999). The root is the same: w = h there.
    Between two velocities gates of effects may open or shut, of which the slope at neither tells: there the
    slope along the way from the best velocity so far is the `secant`. Where that leads nowhere, steps from
    there are halved until the residual is smaller.

    Parameters
    ----------
    start : Motion
        r0, m, and v0, m/s.
    c : float, s
        The stage's coefficient times the time step.
    vx, vz : float, m/s
        The guess.
    bristles : bristles.Stage or None
        Those that the stage bends.
    turning : Turning
        Of the stage before.
    world, sole, poses, counts
        As in `contact`.

    Returns
    -------
    Stage
    """
    inv, h0 = c / world.mass, _h0(bristles)
    turning_speed = _turning_speed(world.bristle_length, world.creep, c)
    w, mode, idle, best_rx, best_rz = turning, PLAIN, 0, 0.0, 0.0
    if w.on:
        hip = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
        if distance(w, directions(world, sole, poses, hip, turning_speed, h0)) > NEAR:
            mode = AHEAD
            vx, vz = sticking(world, sole, poses, hip, h0, w)
    now = Iterate(vx, vz, 0.0, 0.0, np.inf, vx, vz)
    at = Contact(no_force(), no_force(), no_turning())
    for _ in range(MAX_NEWTON):
        hip = Motion(start.x + c * now.vx, start.z + c * now.vz, now.vx, now.vz)
        h = directions(world, sole, poses, hip, turning_speed, h0) if mode == AHEAD else no_directions()
        at = contact(world, sole, poses, hip, turning_speed, ahead(w, h, c, mode == AHEAD), h0, counts)
        rx, rz = residual(world, start, c, hip, at)
        square = rx * rx + rz * rz
        if square <= now.best:
            now = Iterate(now.vx, now.vz, now.dvx, now.dvz, square, now.vx, now.vz)
            idle, best_rx, best_rz = 0, rx, rz
        elif mode == PLAIN:
            before = Motion(hip.x - c * now.dvx, hip.z - c * now.dvz, hip.vx - now.dvx, hip.vz - now.dvz)
            h = directions(world, sole, poses, before, turning_speed, h0)
            w = turned(Turning(True, h[0].x, h[0].z, h[1].x, h[1].z), h, now.dvx, now.dvz)
            if distance(w, directions(world, sole, poses, hip, turning_speed, h0)) > NEAR:
                mode = AHEAD  # the same velocity again, with the w that the step has led to
            else:
                mode, now = DAMPED, back_track(now)
            continue
        elif mode == AHEAD and idle < PATIENCE:
            idle += 1
        elif mode == AHEAD:
            mode = DAMPED
            counts.rescues += 1
            now = Iterate(now.best_vx, now.best_vz, 0.0, 0.0, np.inf, now.best_vx, now.best_vz)
            continue
        else:
            now = back_track(now)
            continue
        slope = slope_of(inv, at)
        if idle > 1 and world.effects.gates is not None and not world.shut:
            slope = secant(slope, now.vx - now.best_vx, now.vz - now.best_vz, rx - best_rx, rz - best_rz)
        dvx, dvz = newton_step(slope, rx, rz)
        if mode == AHEAD:
            w = turned(w, h, dvx, dvz)
        now = Iterate(now.vx + dvx, now.vz + dvz, dvx, dvz, now.best, now.best_vx, now.best_vz)
        if converged(world, now, at, turning_speed):
            end = Motion(start.x + c * now.vx, start.z + c * now.vz, now.vx, now.vz)
            _bend(bristles, sole, poses, end, turning_speed)
            w = Turning(mode == AHEAD, w.left_x, w.left_z, w.right_x, w.right_z)
            left, right = _extrapolated(at.left, dvx, dvz), _extrapolated(at.right, dvx, dvz)
            return Stage(end, Contact(left, right, w), True)
    return Stage(start, at, False)


@inlined
def directions(world, sole, poses, hip, turning_speed, h0):
    """h of the deepest plate of either foot, a pair of `Direction`; 0 in the air."""
    left = _direction_of(world, sole, poses, 0, hip, turning_speed, h0)
    return left, _direction_of(world, sole, poses, 1, hip, turning_speed, h0)


@inlined
def no_directions():
    """`directions` of feet in the air."""
    return Direction(0.0, 0.0, 0.0, 0.0), Direction(0.0, 0.0, 0.0, 0.0)


@inlined
def _direction_of(world, sole, poses, foot, hip, turning_speed, h0):
    ankle = in_world(ankle_of(poses, foot), hip)
    i, z = lowest(sole, ankle)
    if z >= 0.0:
        return Direction(0.0, 0.0, 0.0, 0.0)
    motion = kinematics(ankle, sole.plates[0, i], sole.plates[1, i])
    bristles = bristles_between(h0, foot, 0, sole.plates.shape[1])
    return direction(motion, turning_speed, ankle.rate * sole.span, bristles, i)


@inlined
def ahead(w, h, c, on):
    """A stage as either foot's plates have it, a pair of `Implicit`: w - h where w is an unknown."""
    if not on:
        return Implicit(c, 0.0, 0.0), Implicit(c, 0.0, 0.0)
    return (
        Implicit(c, w.left_x - h[0].x, w.left_z - h[0].z),
        Implicit(c, w.right_x - h[1].x, w.right_z - h[1].z),
    )


@inlined
def distance(w, h):
    """How far w is from h."""
    left, right = h
    far = abs(w.left_x - left.x) + abs(w.left_z - left.z)
    return far + abs(w.right_x - right.x) + abs(w.right_z - right.z)


@inlined
def turned(w, h, dvx, dvz):
    """w after a step of Newton's method, m/s, from `directions` at its beginning."""
    left_x, left_z = _turned(w.left_x, w.left_z, h[0], dvx, dvz)
    right_x, right_z = _turned(w.right_x, w.right_z, h[1], dvx, dvz)
    return Turning(True, left_x, left_z, right_x, right_z)


@inlined
def _turned(x, z, h, dvx, dvz):
    """h + rate (dv - w (h.dv)), kept in the unit disc."""
    along = h.slides * (h.x * dvx + h.z * dvz)
    x, z = h.x + h.rate * (dvx - x * along), h.z + h.rate * (dvz - z * along)
    size = max(1.0, np.sqrt(x * x + z * z) / INSIDE)
    return x / size, z / size


@inlined
def sticking(world, sole, poses, hip, h0, w):
    """The hip's velocity with which the foot that sticks moves as w says, m/s: v = eps w / sqrt(1 - |w|^2).

    Where both slip, and with bristles, that of the hip.
    """
    left, right = w.left_x * w.left_x + w.left_z * w.left_z, w.right_x * w.right_x + w.right_z * w.right_z
    foot, x, z, square = 0, w.left_x, w.left_z, left
    if left == 0.0 or 0.0 < right < left:
        foot, x, z, square = 1, w.right_x, w.right_z, right
    ankle = in_world(ankle_of(poses, foot), hip)
    i, height = lowest(sole, ankle)
    if height >= 0.0 or square > STICKS * STICKS or h0 is not None:
        return hip.vx, hip.vz
    motion = kinematics(ankle, sole.plates[0, i], sole.plates[1, i])
    speed = world.creep / np.sqrt(1.0 - square)
    return hip.vx + speed * x - motion.vx, hip.vz + speed * z - motion.vz


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
def secant(slope, dvx, dvz, drx, drz):
    """J with the least change by which J dV is the residual's (Broyden, Math. Comp. 19, 1965)."""
    jxx, jxz, jzx, jzz = slope
    square = dvx * dvx + dvz * dvz
    x, z = (drx - jxx * dvx - jxz * dvz) / square, (drz - jzx * dvx - jzz * dvz) / square
    return jxx + x * dvx, jxz + x * dvz, jzx + z * dvx, jzz + z * dvz


@inlined
def newton_step(slope, rx, rz):
    """Solution of J dV = -r, m/s."""
    jxx, jxz, jzx, jzz = slope
    det = 1.0 / (jxx * jzz - jxz * jzx)
    return (jxz * rz - jzz * rx) * det, (jzx * rx - jxx * rz) * det


@inlined
def back_track(now):
    """Half of the way back, where a step has made the residual larger."""
    dvx, dvz = 0.5 * now.dvx, 0.5 * now.dvz
    vx, vz = now.vx - dvx, now.vz - dvz
    only_rounding = abs(dvx) + abs(dvz) < 1e-13 * (1.0 + abs(vx) + abs(vz))
    return Iterate(vx, vz, dvx, dvz, np.inf if only_rounding else now.best, now.best_vx, now.best_vz)


@inlined
def converged(world, now, at, turning_speed):
    """Whether a step is small against the speed at which the plates of the slower foot move through the sand.

    That speed (`_speed`) is at least the creep speed, on which the law is smooth.
    """
    left, right = at.left, at.right
    size = abs(now.dvx) + abs(now.dvz)
    force = (abs(left.x) + abs(left.z)) + (abs(right.x) + abs(right.z))
    rounding = 1e-13 * (1.0 + abs(now.vx) + abs(now.vz))
    speed = turning_speed
    if force > 0.0:
        speed = _least_speed(world.bristle_length, turning_speed) + min(
            _speed(left, force), _speed(right, force)
        )
    enough = world.tolerance * speed
    if not world.shut:
        enough = _smooth_step(enough, turning_speed, world.effects.gates)
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
def _turning_speed(length, creep, c):
    """The speed over which a plate's direction turns in a stage, m/s."""
    if length is None:
        return creep
    return length / c


@inlined
def _least_speed(length, turning_speed):
    """The least speed against which a step of Newton's method is small, m/s: at rest it would be a drift."""
    if length is None:
        return turning_speed
    return 1e-3 * turning_speed


@unless_none
def _bend(bristles, sole, poses, hip, turning_speed):
    """Bend the bristles."""
    update_bristles(sole, poses, hip, turning_speed, bristles)


@unless_none
def _h0(bristles):
    """Directions at the stage's beginning."""
    return bristles.before


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


@inlined
def _smooth_step(step, turning_speed, gates):
    """A step of Newton's method on which the law is smooth, m/s: a gate opens within the turning speed."""
    if gates is None:
        return step
    return min(step, GATE_STEP * turning_speed)
