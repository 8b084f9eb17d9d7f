"""One implicit stage of a step, solved for the hip's velocity by Newton's method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined, unless_none
from footopt.walk.bristles import update_bristles
from footopt.walk.contact import contact
from footopt.walk.state import Contact, Force, no_force

MAX_NEWTON = 20  # contact evaluations of one implicit stage at one creep speed, back-tracking included
MAX_RESCUE = 1000  # ... and in all, if it has to be approached from a larger creep speed
GATED = 2.0  # last step of Newton's method over the creep speed, where an effect's gate is
STANDS = 10.0  # speed of the hip over the creep speed, below which the walker stands


class Stage(NamedTuple):
    """The end of an implicit stage."""

    vx: float  # m/s
    vz: float
    contact: Contact
    solved: bool


@inlined
def guess(creep, vx, vz, change_x, change_z):
    """A velocity to begin Newton's method with, m/s: the last one, with its change unless the walker stands.

    While he stands, friction follows his velocity within the creep speed: extrapolated, it leads away.
    """
    if abs(vx) + abs(vz) < STANDS * creep and abs(change_x) + abs(change_z) > creep:
        return vx, vz
    return vx + change_x, vz + change_z


@inlined
def solve_stage(world, sole, poses, x0, z0, vx0, vz0, c, vx, vz, bristles, counts):
    """Velocity V of an implicit stage: V = v0 + c a(r0 + c V, V), by Newton's method.

    Starts from the guess (vx, vz) and halves a step that makes the residual larger. It ends with a
    step that is small against the speed at which the plates of the slower foot move through the sand
    (`_speed`, at least the creep speed), on which the law is smooth: Newton's method has then
    converged to the square of that ratio. The stage's forces are carried along the last step to first
    order, so that its momentum balance closes to rounding.

    Where that fails, because the law turns too sharply on the way, the stage is rescued: it is
    solved for a creep speed so large that the law is viscous, then for smaller and smaller ones,
    each from the solution before. Rescues are counted.

    Parameters
    ----------
    x0, z0, vx0, vz0 : float, m and m/s
        r0 and v0.
    c : float, s
        The stage's coefficient times the time step.
    bristles : bristles.Stage or None
        What the stage bends.
    world, sole, poses, counts
        As in `contact`.

    Returns
    -------
    Stage
    """
    guess_x, guess_z = vx, vz
    inv = c / world.mass
    turning_speed = _turning_speed(world.bristle_length, world.creep, c)
    creep, best, tries = turning_speed, np.inf, 0
    rescue, ratio, solved_at, viscous = False, 0.25, np.inf, np.inf
    dvx = dvz = 0.0
    at = Contact(no_force(), no_force())
    for _ in range(MAX_RESCUE):
        x, z = x0 + c * vx, z0 + c * vz
        at = contact(world, sole, poses, x, z, vx, vz, creep, c, _h0(bristles), counts)
        left, right = at.left, at.right
        rx = vx - (vx0 + c * world.tilt) - inv * (left.x + right.x)
        rz = vz - vz0 - inv * (left.z + right.z) + c * world.g
        residual = rx * rx + rz * rz
        tries += 1
        if residual > best and tries <= MAX_NEWTON:  # go back half of the way
            dvx, dvz = 0.5 * dvx, 0.5 * dvz
            vx, vz = vx - dvx, vz - dvz
            if abs(dvx) + abs(dvz) < 1e-13 * (1.0 + abs(vx) + abs(vz)):
                best = np.inf  # nothing but rounding is left to gain
            continue
        if tries > MAX_NEWTON or not residual < 1e18:
            if not rescue:
                rescue = True
                counts.rescues += 1
                creep = viscous = 10.0 * (1.0 + abs(guess_x) + abs(guess_z))
            else:  # a smaller stride from the last creep speed that went well
                ratio = np.sqrt(ratio)
                if ratio > 0.97 or creep == viscous:
                    break
                creep = max(ratio * solved_at, turning_speed)
            vx, vz = guess_x, guess_z
            best, tries = np.inf, 0
            continue
        best = residual
        jxx = 1.0 - inv * (left.xx + right.xx)
        jxz = -inv * (left.xz + right.xz)
        jzx = -inv * (left.zx + right.zx)
        jzz = 1.0 - inv * (left.zz + right.zz)
        det = 1.0 / (jxx * jzz - jxz * jzx)
        dvx, dvz = (jxz * rz - jzz * rx) * det, (jzx * rx - jxx * rz) * det
        vx, vz = vx + dvx, vz + dvz
        size = abs(dvx) + abs(dvz)
        force = (abs(left.x) + abs(left.z)) + (abs(right.x) + abs(right.z))
        rounding = 1e-13 * (1.0 + abs(vx) + abs(vz))
        # a rescue follows the plate that sticks, whatever the mean speed of the others
        speed = creep
        if not rescue and force > 0.0:
            speed = _least_speed(world.bristle_length, creep) + min(_speed(left, force), _speed(right, force))
        enough = _smooth_step(world.tolerance * speed, creep, world.effects.gates)
        if size <= rounding or (force > 0.0 and size <= enough + rounding):
            if creep == turning_speed:
                _bend(sole, poses, x0 + c * vx, z0 + c * vz, vx, vz, creep, bristles)
                return Stage(
                    vx, vz, Contact(_extrapolated(left, dvx, dvz), _extrapolated(right, dvx, dvz)), True
                )
            guess_x, guess_z, solved_at = vx, vz, creep
            creep, best, tries = max(ratio * creep, turning_speed), np.inf, 0
    return Stage(vx, vz, at, False)


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
    """The speed over which a plate's direction turns over in a stage, m/s."""
    if length is None:
        return creep
    return length / c


@inlined
def _least_speed(length, creep):
    """The least speed against which a step of Newton's method is small, m/s: at rest it would be a drift."""
    if length is None:
        return creep
    return 1e-3 * creep


@inlined
def _bend(sole, poses, x, z, vx, vz, creep, bristles):
    """Bend the bristles, where there are any."""
    if bristles is not None:
        update_bristles(sole, poses, x, z, vx, vz, creep, bristles)


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
def _smooth_step(step, creep, gates):
    """A step of Newton's method on which the law is smooth, m/s: a gate turns within the creep speed."""
    if gates is None:
        return step
    return min(step, GATED * creep)
