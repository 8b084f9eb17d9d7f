"""Directions of motion as unknowns of Newton's method, where a foot turns over within a stage.

Far beyond the creep speed n the slope of h = v / sqrt(|v|^2 + n^2) does not show the way back. There w stands
for h: ahead of it in dh/dv = rate (I - w h^T), as in primal-dual methods for total variation (Chan, Golub &
Mulet, SIAM J. Sci. Comput. 20, 1999); or, where effects have gates, for v = n w / sqrt(1 - |w|^2). Many creep
speeds of velocity are less than 2 of w, and a gate, a jump in the velocity, opens over much of the unit disc.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined
from footopt.walk.contact import TURN, Direction, bristles_between, direction, kinematics
from footopt.walk.state import Implicit, Turning, ankle_of, in_world, lowest

INSIDE = 0.999  # |w| at most
STICKS = 0.995  # |w| at most, of a foot whose velocity is known from w


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
    foot, x, z = _slower(w)
    ankle = in_world(ankle_of(poses, foot), hip)
    i, height = lowest(sole, ankle)
    square = x * x + z * z
    if height >= 0.0 or square > STICKS * STICKS or h0 is not None:
        return hip.vx, hip.vz
    motion = kinematics(ankle, sole.plates[0, i], sole.plates[1, i])
    speed = world.creep / np.sqrt(1.0 - square)
    return hip.vx + speed * x - motion.vx, hip.vz + speed * z - motion.vz


@inlined
def _slower(w):
    """The foot in the sand whose w is smaller, and its w."""
    left, right = w.left_x * w.left_x + w.left_z * w.left_z, w.right_x * w.right_x + w.right_z * w.right_z
    if left == 0.0 or 0.0 < right < left:
        return 1, w.right_x, w.right_z
    return 0, w.left_x, w.left_z


class Foot(NamedTuple):
    """The foot that turns over."""

    x: float  # m/s, the hip's velocity at which its deepest plate rests
    z: float
    speed: float  # n, m/s, over which that plate turns


class Step(NamedTuple):
    """The best direction so far, and the step that is tried next."""

    x: float
    z: float
    dx: float
    dz: float


@inlined
def half_way(w, h):
    """Half-way between two directions of either foot: small for the one that turns over."""
    left, right = h
    x, z = 0.5 * (w.left_x + left.x), 0.5 * (w.left_z + left.z)
    return Turning(True, x, z, 0.5 * (w.right_x + right.x), 0.5 * (w.right_z + right.z))


@inlined
def begun(sole, poses, hip, creep, w):
    """The foot that turns over, whose w is smaller, and no step from there."""
    foot, x, z = _slower(w)
    size = max(1.0, np.sqrt(x * x + z * z) / INSIDE)
    ankle = in_world(ankle_of(poses, foot), hip)
    i, _ = lowest(sole, ankle)
    motion = kinematics(ankle, sole.plates[0, i], sole.plates[1, i])
    within = TURN * ankle.rate * sole.span
    speed = np.sqrt(creep * creep + within * within)
    return Foot(hip.vx - motion.vx, hip.vz - motion.vz, speed), Step(x / size, z / size, 0.0, 0.0)


@inlined
def stepped(foot, vx, vz, dvx, dvz):
    """Where w is at a velocity of the hip, m/s, and its step for one of Newton's method, dh/dv dv."""
    x, z = vx - foot.x, vz - foot.z
    rate = 1.0 / np.sqrt(x * x + z * z + foot.speed * foot.speed)
    x, z = x * rate, z * rate
    along = x * dvx + z * dvz
    return Step(x, z, rate * (dvx - x * along), rate * (dvz - z * along))


@inlined
def velocity(foot, step, vx, vz):
    """The hip's velocity after a step, m/s; where it leaves the disc, (vx, vz), that of Newton's method."""
    x, z = step.x + step.dx, step.z + step.dz
    square = x * x + z * z
    if square > INSIDE * INSIDE:
        return vx, vz
    speed = foot.speed / np.sqrt(1.0 - square)
    return foot.x + speed * x, foot.z + speed * z
