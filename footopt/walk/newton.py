"""One implicit stage of a step, solved for the hip's velocity by Newton's method.

The motion of a foot may reverse within a stage. At velocities far beyond n, the speed over which a plate's
direction h reverses, the slope of h does not show the way back. The unknown is then w instead of the
velocity, v = n w / sqrt(1 - |w|^2): a range of many n in velocity is less than 2 in w, and the gate of an
effect, which is almost a jump in the velocity, opens over much of the unit disc.

A foot that slides may meet such a jump, too, where it moves along one of its plates. The residual may have a
minimum there that is no root: the roots are on either side, a whole step away.
"""

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined
from footopt.walk.bristles import transition_speed_of
from footopt.walk.contact import TURN, contact, kinematics
from footopt.walk.state import ALOFT, NO_FOOT, Contact, Force, Motion, Reversal, ankle_of, lowest

NEWTON = 0.03  # last step of Newton's method over the plates' mean speed; the forces' error is the square
STICKING = 1e-3  # the same where bristles hold plates: the law is bent where they begin to slide
MAX_NEWTON = 200  # contact evaluations of one implicit stage, before it is left unsolved
SHORTEST = 2.0**-16  # part of a step of Newton's method
INSIDE = 0.999  # |w| at most; beyond it a foot slides, and steps are those of the velocity
SMOOTH_STEP = 2.0  # largest last step over the transition, where a foot reverses or an effect has a gate
CHANGED = 0.05  # share of the force on both feet by which the last step may change that on one of them ...
CHANGED_GATED = 0.01  # ... and where an effect has a gate: it is open or closed before the end of such a step


@inlined
def solve_stage(world, sole, poses, start, c, vx, vz, e0, reversal, counts):
    """Velocity V of an implicit stage: V = v0 + c a(r0 + c V, V), by Newton's method.

    Starts from the guess (vx, vz) and ends with a step that is small (`converged`): Newton's method has then
    converged to the square of that ratio. The stage's forces are carried along the last step to first order,
    so that its momentum balance closes to rounding, and their power with them.

    Where a step makes the residual larger, the motion of a foot has reversed. Newton's method goes on
    half-way in that foot's direction w, and its steps are those of w, halved until they make the residual
    smaller. With a gate, the next step is at most twice as long as the halved one. Where the shortest does
    not help, Newton's method begins again a whole step away, on one side and on the other in turn.

    start: r0, m, and v0, m/s. c: the stage's coefficient times the time step, s. vx, vz: the guess, m/s.
    e0: bristles before it, or None. reversal: of the stage before. The others are as in `contact`. Returns
    the hip's motion and the contact at the stage's end, and whether it is solved.
    """
    inv = c / world.mass
    transition = transition_speed_of(world.bristle_length, world, c)
    hip = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
    plate, vx, vz = first_guess(sole, poses, hip, reversal, transition, e0)
    best, best_vx, best_vz, dvx, dvz, part, side = np.inf, vx, vz, 0.0, 0.0, 1.0, 1.0
    for _ in range(MAX_NEWTON):
        hip = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
        at = contact(world, sole, poses, hip, transition, c, e0, counts)
        rx, rz = residual(world, start, c, hip, at)
        square = rx * rx + rz * rz
        if square <= best:
            best, best_vx, best_vz, part = square, vx, vz, min(2.0 * part, 1.0) if gated(world) else 1.0
            dvx, dvz = newton_step(inv, at, rx, rz)
            if converged(world, sole, poses, vx, vz, dvx, dvz, at, transition, plate):
                vx, vz = vx + dvx, vz + dvz
                end = Motion(start.x + c * vx, start.z + c * vz, vx, vz)
                left, right = _extrapolated(at.left, dvx, dvz), _extrapolated(at.right, dvx, dvz)
                return end, Contact(left, right, reversal_after(plate, vx, vz)), True
            dvx, dvz = part * dvx, part * dvz
            vx, vz = stepped(plate, vx, vz, dvx, dvz, e0)
        elif plate.foot == NO_FOOT:
            plate = reversing_plate(sole, poses, hip, best_vx, best_vz, transition, e0)
            vx, vz = _middle_velocity(plate, best_vx, best_vz, vx, vz)
            best = np.inf
        elif part > SHORTEST:
            dvx, dvz, part = 0.5 * dvx, 0.5 * dvz, 0.5 * part
            vx, vz = stepped(plate, best_vx, best_vz, dvx, dvz, e0)
        else:
            vx, vz = best_vx + side * dvx / part, best_vz + side * dvz / part
            best, part, side = np.inf, 1.0, -side
    counts.unsolved += 1
    return start, ALOFT, False


@inlined
def residual(world, start, c, hip, at):
    """V - v0 - c a, m/s."""
    inv, left, right = c / world.mass, at.left, at.right
    rx = hip.vx - (start.vx + c * world.tilt) - inv * (left.x + right.x)
    return rx, hip.vz - start.vz - inv * (left.z + right.z) + c * world.g


@inlined
def newton_step(inv, at, rx, rz):
    """Solution of J dV = -r, m/s, with the residual's slope J = 1 - c/M dF/dV; inv: c/M."""
    left, right = at.left, at.right
    jxx = 1.0 - inv * (left.xx + right.xx)
    jxz = -inv * (left.xz + right.xz)
    jzx = -inv * (left.zx + right.zx)
    jzz = 1.0 - inv * (left.zz + right.zz)
    det = 1.0 / (jxx * jzz - jxz * jzx)
    return (jxz * rz - jzz * rx) * det, (jzx * rx - jxx * rz) * det


@inlined
def gated(world):
    """Whether effects have gates, which are almost jumps in the velocity."""
    return not world.bypass and world.effects.gates is not None


@inlined
def converged(world, sole, poses, vx, vz, dvx, dvz, at, transition, plate):
    """Whether a step is small against the speed at which the plates of the slower foot move through the sand.

    That speed (`_speed`) is at least the creep speed, on which the law is smooth.
    """
    left, right = at.left, at.right
    size = abs(dvx) + abs(dvz)
    force = (abs(left.x) + abs(left.z)) + (abs(right.x) + abs(right.z))
    rounding = 1e-13 * (1.0 + abs(vx) + abs(vz))
    speed = transition
    if force > 0.0:
        # at rest a step that is small against the transition speed of bristles would be a drift
        speed *= 1.0 if world.bristle_length is None else 1e-3
        speed += min(_speed(left, force), _speed(right, force))
    enough, share = world.tolerance * speed, CHANGED
    if plate.foot != NO_FOOT:
        enough = min(enough, SMOOTH_STEP * plate.speed)
    if gated(world):
        slower = min(abs(ankle_of(poses, 0).rate), abs(ankle_of(poses, 1).rate))
        enough, share = min(enough, SMOOTH_STEP * _smooth_speed(sole, slower, transition)), CHANGED_GATED
    change = max(_change(left, dvx, dvz), _change(right, dvx, dvz))
    return size <= rounding or (force > 0.0 and size <= enough + rounding and change <= share * force)


@inlined
def _change(force, dvx, dvz):
    """How a change of the velocity changes a foot's force, N, to first order."""
    return abs(force.xx * dvx + force.xz * dvz) + abs(force.zx * dvx + force.zz * dvz)


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
    """A foot's force after a small change of the velocity, to first order, and its power there.

    All plates change their velocity alike. How their forces change counts for the power where gates open:
    without gates, forces turn with the motion, and stay as large along it.
    """
    x = force.x + (force.xx * dvx + force.xz * dvz)
    z = force.z + (force.zx * dvx + force.zz * dvz)
    power = force.power + (force.along_x * dvx + force.along_z * dvz) + (x * dvx + z * dvz)
    return Force(x, z, power, force.xx, force.xz, force.zx, force.zz, force.along_x, force.along_z)


class Plate(NamedTuple):
    """The deepest plate of a foot."""

    foot: int  # whose motion reverses, or `NO_FOOT`
    x: float  # m/s, the hip's velocity at which w = 0: the plate rests, or its bristles stand upright
    z: float
    speed: float  # n, m/s
    height: float  # m, above the hip


#: No motion reverses: steps are those of the velocity.
NO_PLATE = Plate(NO_FOOT, 0.0, 0.0, 1.0, 0.0)


@inlined
def deepest_plate(sole, poses, foot, transition, e0):
    """The deepest plate of a foot in a stage."""
    ankle = ankle_of(poses, foot)
    i, height = lowest(sole, ankle)
    motion = kinematics(ankle, sole.plates[0, i], sole.plates[1, i])
    speed = _smooth_speed(sole, ankle.rate, transition)
    x, z = _held(e0, foot, i)
    return Plate(foot, -motion.vx - speed * x, -motion.vz - speed * z, speed, height)


@inlined
def _smooth_speed(sole, rate, transition):
    """The speed over which a plate's direction turns, m/s; a gate opens over no less.

    rate: of the foot's pitch, rad/s.
    """
    within = TURN * rate * sole.span
    return np.sqrt(transition * transition + within * within)


@inlined
def _held(e0, foot, i):
    """The direction in which bristles hold a plate; 0 without them."""
    if e0 is None:
        return 0.0, 0.0
    return e0[foot, 0, i], e0[foot, 1, i]


@inlined
def reversing_plate(sole, poses, hip, vx, vz, transition, e0):
    """The plate of the foot whose motion reverses on the way from (vx, vz), m/s, to the hip's velocity.

    Of the feet in the sand, that with the smaller |w| half-way.
    """
    found, least = NO_PLATE, np.inf
    for foot in range(2):
        plate = deepest_plate(sole, poses, foot, transition, e0)
        x, z = _middle_direction(plate, vx, vz, hip.vx, hip.vz)
        if hip.z + plate.height < 0.0 and x * x + z * z < least:
            found, least = plate, x * x + z * z
    return found


@inlined
def first_guess(sole, poses, hip, reversal, transition, e0):
    """The plate whose motion reverses as a stage begins, and the hip's velocity with the w before it."""
    if reversal.foot != NO_FOOT:
        plate = deepest_plate(sole, poses, reversal.foot, transition, e0)
        if hip.z + plate.height < 0.0:
            vx, vz = _velocity(plate, reversal.x, reversal.z, hip.vx, hip.vz)
            return plate, vx, vz
    return NO_PLATE, hip.vx, hip.vz


@inlined
def reversal_after(plate, vx, vz):
    """The foot whose motion reverses, with its w at the end of a stage; `NO_FOOT` where it slides."""
    x, z, _ = _direction(plate, vx, vz)
    slides = x * x + z * z > INSIDE * INSIDE
    return Reversal(NO_FOOT if slides else plate.foot, x, z)


@inlined
def _middle_velocity(plate, vx, vz, to_vx, to_vz):
    """The velocity half-way in w from a velocity of the hip to another, m/s."""
    x, z = _middle_direction(plate, vx, vz, to_vx, to_vz)
    return _velocity(plate, x, z, 0.5 * (vx + to_vx), 0.5 * (vz + to_vz))


@inlined
def stepped(plate, vx, vz, dvx, dvz, e0):
    """The velocity after a step of Newton's method, m/s, as one of w: dw/dv dv."""
    if e0 is not None:  # inside the disc they are linear in v
        return vx + dvx, vz + dvz
    x, z, rate = _direction(plate, vx, vz)
    along = x * dvx + z * dvz
    x, z = x + rate * (dvx - x * along), z + rate * (dvz - z * along)
    return _velocity(plate, x, z, vx + dvx, vz + dvz)


@inlined
def _middle_direction(plate, vx, vz, to_vx, to_vz):
    """w half-way between those at two velocities of the hip, m/s."""
    x, z, _ = _direction(plate, vx, vz)
    to_x, to_z, _ = _direction(plate, to_vx, to_vz)
    return 0.5 * (x + to_x), 0.5 * (z + to_z)


@inlined
def _direction(plate, vx, vz):
    """w at a velocity of the hip, m/s, and its rate in dw/dv = rate (I - w w^T), s/m."""
    x, z = vx - plate.x, vz - plate.z
    rate = 1.0 / np.sqrt(x * x + z * z + plate.speed * plate.speed)
    return x * rate, z * rate, rate


@inlined
def _velocity(plate, x, z, vx, vz):
    """The hip's velocity with a direction w, m/s; (vx, vz) where no motion reverses, or the foot slides."""
    square = x * x + z * z
    if plate.foot == NO_FOOT or square > INSIDE * INSIDE:
        return vx, vz
    speed = plate.speed / np.sqrt(1.0 - square)
    return plate.x + speed * x, plate.z + speed * z
