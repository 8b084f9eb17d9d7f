"""One implicit stage of a step, solved for the hip's velocity by Newton's method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined, unless_none
from footopt.walk.bristles import update_bristles
from footopt.walk.contact import contact
from footopt.walk.state import Contact, Force, Motion, no_force

MAX_NEWTON = 20  # contact evaluations of one implicit stage at one turning speed, back-tracking included
MAX_RESCUE = 1000  # ... and in all, if it has to be approached from a larger one
GATE_STEP = 2.0  # largest last step of Newton's method over the turning speed, where an effect has a gate
STANDING = 10.0  # speed of the hip over the creep speed, below which the walker stands
LEAST_STRIDE = 0.97  # of a rescue, as the ratio of two turning speeds: beyond it is given up


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
    turning_speed: float  # m/s, for which the stage is solved at present (see `contact`)
    best: float  # least residual squared at this turning speed, m^2/s^2
    tries: int  # evaluations at it


class Rescue(NamedTuple):
    """The approach from a turning speed so large that the law is viscous."""

    active: bool
    viscous: float  # m/s, that turning speed
    ratio: float  # of a turning speed to the one before
    solved_at: float  # m/s, the last turning speed for which the stage is solved
    vx: float  # m/s, the solution there; the guess before there is one
    vz: float


@inlined
def guess(creep, vx, vz, change_x, change_z):
    """A velocity to begin Newton's method with, m/s: the last one, with its change unless the walker stands.

    While it stands, friction follows its velocity within the creep speed: extrapolated, it leads away.
    """
    if abs(vx) + abs(vz) < STANDING * creep and abs(change_x) + abs(change_z) > creep:
        return vx, vz
    return vx + change_x, vz + change_z


@inlined
def solve_stage(world, sole, poses, start, c, vx, vz, bristles, counts):
    """Velocity V of an implicit stage: V = v0 + c a(r0 + c V, V), by Newton's method.

    Starts from the guess (vx, vz) and halves a step that makes the residual larger (`back_track`). It ends
    with a step that is small (`converged`): Newton's method has then converged to the square of that ratio.
    The stage's forces are carried along the last step to first order, so that its momentum balance closes to
    rounding. Where that fails, because the law turns too sharply on the way, the stage is rescued (`rescue`).

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
    world, sole, poses, counts
        As in `contact`.

    Returns
    -------
    Stage
    """
    inv, goal = c / world.mass, _turning_speed(world.bristle_length, world.creep, c)
    now = Iterate(vx, vz, 0.0, 0.0, goal, np.inf, 0)
    approach = Rescue(False, np.inf, 0.25, np.inf, vx, vz)
    at = Contact(no_force(), no_force())
    for _ in range(MAX_RESCUE):
        hip = Motion(start.x + c * now.vx, start.z + c * now.vz, now.vx, now.vz)
        at = contact(world, sole, poses, hip, now.turning_speed, c, _h0(bristles), counts)
        rx, rz = residual(world, start, c, hip, at)
        square, tries = rx * rx + rz * rz, now.tries + 1
        if square > now.best and tries <= MAX_NEWTON:
            now = back_track(now, tries)
        elif tries > MAX_NEWTON or not square < 1e18:
            counts.rescues += 0 if approach.active else 1
            approach, turning_speed = rescue(approach, now.turning_speed, goal)
            if not approach.active:
                break
            now = Iterate(approach.vx, approach.vz, now.dvx, now.dvz, turning_speed, np.inf, 0)
        else:
            dvx, dvz = newton_step(inv, at, rx, rz)
            vx, vz = now.vx + dvx, now.vz + dvz
            now = Iterate(vx, vz, dvx, dvz, now.turning_speed, square, tries)
            if converged(world, now, at, approach.active):
                if now.turning_speed == goal:
                    end = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
                    _bend(bristles, sole, poses, end, goal)
                    left, right = _extrapolated(at.left, dvx, dvz), _extrapolated(at.right, dvx, dvz)
                    return Stage(end, Contact(left, right), True)
                approach = Rescue(True, approach.viscous, approach.ratio, now.turning_speed, vx, vz)
                now = Iterate(vx, vz, dvx, dvz, max(approach.ratio * now.turning_speed, goal), np.inf, 0)
    return Stage(start, at, False)


@inlined
def residual(world, start, c, hip, at):
    """V - v0 - c a, m/s."""
    inv, left, right = c / world.mass, at.left, at.right
    rx = hip.vx - (start.vx + c * world.tilt) - inv * (left.x + right.x)
    return rx, hip.vz - start.vz - inv * (left.z + right.z) + c * world.g


@inlined
def newton_step(inv, at, rx, rz):
    """The solution of (1 - c/M dF/dV) dV = -r, m/s; inv: c/M."""
    left, right = at.left, at.right
    jxx = 1.0 - inv * (left.xx + right.xx)
    jxz = -inv * (left.xz + right.xz)
    jzx = -inv * (left.zx + right.zx)
    jzz = 1.0 - inv * (left.zz + right.zz)
    det = 1.0 / (jxx * jzz - jxz * jzx)
    return (jxz * rz - jzz * rx) * det, (jzx * rx - jxx * rz) * det


@inlined
def back_track(now, tries):
    """Half of the way back, where a step has made the residual larger."""
    dvx, dvz = 0.5 * now.dvx, 0.5 * now.dvz
    vx, vz = now.vx - dvx, now.vz - dvz
    only_rounding = abs(dvx) + abs(dvz) < 1e-13 * (1.0 + abs(vx) + abs(vz))
    return Iterate(vx, vz, dvx, dvz, now.turning_speed, np.inf if only_rounding else now.best, tries)


@inlined
def converged(world, now, at, rescued):
    """Whether a step is small against the speed at which the plates of the slower foot move through the sand.

    That speed (`_speed`) is at least the turning speed, on which the law is smooth. A rescue follows the
    plate that sticks, whatever the mean speed of the others.
    """
    left, right = at.left, at.right
    size = abs(now.dvx) + abs(now.dvz)
    force = (abs(left.x) + abs(left.z)) + (abs(right.x) + abs(right.z))
    rounding = 1e-13 * (1.0 + abs(now.vx) + abs(now.vz))
    speed = now.turning_speed
    if not rescued and force > 0.0:
        speed = _least_speed(world.bristle_length, now.turning_speed) + min(
            _speed(left, force), _speed(right, force)
        )
    enough = _smooth_step(world.tolerance * speed, now.turning_speed, world.effects.gates)
    return size <= rounding or (force > 0.0 and size <= enough + rounding)


@inlined
def rescue(approach, turning_speed, goal):
    """The next turning speed, m/s, for which the stage is solved, where Newton's method has failed at one.

    The first is so large that the law is viscous; from there they are smaller and smaller, each begun from
    the solution before, in shorter strides where one fails. Where there is no shorter stride, or the law
    cannot be solved even at the first, the rescue ends and the stage is not solved.
    """
    if not approach.active:
        viscous = 10.0 * (1.0 + abs(approach.vx) + abs(approach.vz))
        return Rescue(True, viscous, approach.ratio, approach.solved_at, approach.vx, approach.vz), viscous
    ratio = np.sqrt(approach.ratio)
    active = not (ratio > LEAST_STRIDE or turning_speed == approach.viscous)
    return Rescue(active, approach.viscous, ratio, approach.solved_at, approach.vx, approach.vz), max(
        ratio * approach.solved_at, goal
    )


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
