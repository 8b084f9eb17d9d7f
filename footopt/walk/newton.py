"""One implicit stage of a step, solved for the hip's velocity by Newton's method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined, unless_none
from footopt.walk.bristles import update_bristles
from footopt.walk.contact import contact
from footopt.walk.state import Contact, Force, Motion, Turning, no_force, no_turning
from footopt.walk.turning import (
    Foot,
    Step,
    ahead,
    begun,
    directions,
    distance,
    half_way,
    no_directions,
    stepped,
    sticking,
    turned,
    velocity,
)

MAX_NEWTON = 100  # contact evaluations of one implicit stage
PATIENCE = 8  # of them ahead of h without a smaller residual, before Newton's method goes on from the best
HALVINGS = 16  # the same, of steps in w
NEAR = 0.1  # |w_x - h_x| + |w_z - h_z| of both feet, within which no foot's direction of motion has reversed
GATE_STEP = 2.0  # largest last step of Newton's method over the creep speed, where an effect has a gate

#: Steps of Newton's method: with w = h; with w ahead of h; in w; with back-tracking.
PLAIN, AHEAD, WITHIN, DAMPED = range(4)


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
    Gates of effects open or shut between two velocities, of which the slope at neither tells: there Newton's
    method goes on in w itself (`footopt.walk.turning`), and a step that makes the residual larger is halved.
    Where w leads nowhere, and where bristles hold the plates of a scene with gates, steps in V are halved.

    Parameters
    ----------
    start : Motion
        r0, m, and v0, m/s.
    c : float, s
        The stage's coefficient times the time step.
    vx, vz : float, m/s
        The guess.
    bristles : bristles.StageBristles or None
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
    gated = world.effects.gates is not None and not world.bypass
    w, mode, idle, foot, step = turning, PLAIN, 0, Foot(0.0, 0.0, 0.0), Step(0.0, 0.0, 0.0, 0.0)
    if w.on:
        hip = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
        if distance(w, directions(world, sole, poses, hip, turning_speed, h0)) > NEAR:
            if gated:
                mode, (foot, step) = WITHIN, begun(sole, poses, hip, turning_speed, w)
                vx, vz = velocity(foot, step, vx, vz)
            else:
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
            idle = 0
        elif mode == PLAIN:
            before = Motion(hip.x - c * now.dvx, hip.z - c * now.dvz, hip.vx - now.dvx, hip.vz - now.dvz)
            h = directions(world, sole, poses, before, turning_speed, h0)
            w = Turning(True, h[0].x, h[0].z, h[1].x, h[1].z)
            if not gated:
                w = turned(w, h, now.dvx, now.dvz)
            h = directions(world, sole, poses, hip, turning_speed, h0)
            far = distance(w, h) > NEAR
            if far and not gated:
                mode = AHEAD  # the same velocity again, with the w that the step has led to
            elif far and h0 is None:
                w = half_way(w, h)
                mode, (foot, step) = WITHIN, begun(sole, poses, hip, turning_speed, w)
                vx, vz = velocity(foot, step, now.vx, now.vz)
                now = Iterate(vx, vz, 0.0, 0.0, np.inf, vx, vz)
            else:
                mode, now = DAMPED, back_track(now)
            continue
        elif mode == WITHIN and idle < HALVINGS:
            idle, dvx, dvz = idle + 1, 0.5 * now.dvx, 0.5 * now.dvz
            step = Step(step.x, step.z, 0.5 * step.dx, 0.5 * step.dz)
            vx, vz = velocity(foot, step, now.best_vx + dvx, now.best_vz + dvz)
            now = Iterate(vx, vz, dvx, dvz, now.best, now.best_vx, now.best_vz)
            continue
        elif mode == AHEAD and idle < PATIENCE:
            idle += 1
        elif mode != DAMPED:
            mode = DAMPED
            counts.rescues += 1
            now = Iterate(now.best_vx, now.best_vz, 0.0, 0.0, np.inf, now.best_vx, now.best_vz)
            continue
        else:
            now = back_track(now)
            continue
        dvx, dvz = newton_step(slope_of(inv, at), rx, rz)
        if mode == AHEAD:
            w = turned(w, h, dvx, dvz)
        now = Iterate(now.vx + dvx, now.vz + dvz, dvx, dvz, now.best, now.best_vx, now.best_vz)
        if converged(world, now, at, turning_speed):
            end = Motion(start.x + c * now.vx, start.z + c * now.vz, now.vx, now.vz)
            _bend(bristles, sole, poses, end, turning_speed)
            if mode == WITHIN:
                h = directions(world, sole, poses, end, turning_speed, h0)
                w = Turning(True, h[0].x, h[0].z, h[1].x, h[1].z)
            w = Turning(mode in (AHEAD, WITHIN), w.left_x, w.left_z, w.right_x, w.right_z)
            left, right = _extrapolated(at.left, dvx, dvz), _extrapolated(at.right, dvx, dvz)
            return Stage(end, Contact(left, right, w), True)
        if mode == WITHIN:
            step = stepped(foot, now.best_vx, now.best_vz, dvx, dvz)
            vx, vz = velocity(foot, step, now.vx, now.vz)
            now = Iterate(vx, vz, dvx, dvz, now.best, now.best_vx, now.best_vz)
    return Stage(start, at, False)


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
    if not world.bypass:
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
