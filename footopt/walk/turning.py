"""Where a foot turns over within a stage: the direction of its motion as the unknown of Newton's method.

Far beyond the speed n over which a plate turns its direction over, the slope of h does not show the way back.
There w takes the place of the velocity, v = n w / sqrt(1 - |w|^2): many n of velocity are less than 2 of w,
and the gate of an effect, a jump in the velocity, opens over much of the unit disc.
"""

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined
from footopt.walk.contact import TURN, kinematics
from footopt.walk.state import NO_FOOT, Turning, ankle_of, lowest

INSIDE = 0.999  # |w| at most; beyond it a foot slides, and steps are those of the velocity


class Plate(NamedTuple):
    """The deepest plate of a foot."""

    foot: int  # that turns over, or `NO_FOOT`
    x: float  # m/s, the hip's velocity at which w = 0: the plate rests, or its bristles stand upright
    z: float
    speed: float  # n, m/s
    height: float  # m, above the hip


@inlined
def no_plate():
    """Of no foot: steps are those of the velocity."""
    return Plate(NO_FOOT, 0.0, 0.0, 1.0, 0.0)


@inlined
def deepest_plate(sole, poses, foot, turning_speed, h0):
    """The deepest plate of a foot in a stage."""
    ankle = ankle_of(poses, foot)
    i, height = lowest(sole, ankle)
    motion = kinematics(ankle, sole.plates[0, i], sole.plates[1, i])
    within = TURN * ankle.rate * sole.span
    speed = np.sqrt(turning_speed * turning_speed + within * within)
    x, z = _held(h0, foot, i)
    return Plate(foot, -motion.vx - speed * x, -motion.vz - speed * z, speed, height)


@inlined
def _held(h0, foot, i):
    """The direction in which bristles hold a plate; 0 without them."""
    if h0 is None:
        return 0.0, 0.0
    return h0[foot, 0, i], h0[foot, 1, i]


@inlined
def turning_plate(sole, poses, hip, vx, vz, turning_speed, h0):
    """The plate of the foot that turns over on the way from (vx, vz), m/s, to the hip's velocity.

    Of both feet in the sand that with the smaller w half-way.
    """
    found, least = no_plate(), np.inf
    for foot in range(2):
        plate = deepest_plate(sole, poses, foot, turning_speed, h0)
        x, z = _half_way(plate, vx, vz, hip.vx, hip.vz)
        if hip.z + plate.height < 0.0 and x * x + z * z < least:
            found, least = plate, x * x + z * z
    return found


@inlined
def begun(sole, poses, hip, turning, turning_speed, h0):
    """The plate that turns over as a stage begins, and the hip's velocity with its w of the stage before."""
    if turning.foot != NO_FOOT:
        plate = deepest_plate(sole, poses, turning.foot, turning_speed, h0)
        if hip.z + plate.height < 0.0:
            vx, vz = _velocity(plate, turning.x, turning.z, hip.vx, hip.vz)
            return plate, vx, vz
    return no_plate(), hip.vx, hip.vz


@inlined
def ended(plate, vx, vz):
    """How the foot that turns over moves at the end of a stage; none where it slides."""
    x, z, _ = _direction(plate, vx, vz)
    slides = x * x + z * z > INSIDE * INSIDE
    return Turning(NO_FOOT if slides else plate.foot, x, z)


@inlined
def half_way(plate, vx, vz, to_vx, to_vz):
    """The velocity half-way in w from a velocity of the hip to another, m/s."""
    x, z = _half_way(plate, vx, vz, to_vx, to_vz)
    return _velocity(plate, x, z, 0.5 * (vx + to_vx), 0.5 * (vz + to_vz))


@inlined
def stepped(plate, vx, vz, dvx, dvz, h0):
    """The velocity after a step of Newton's method, m/s, as one of w: dw/dv dv."""
    if h0 is not None:  # inside the disc they are linear in v
        return vx + dvx, vz + dvz
    x, z, rate = _direction(plate, vx, vz)
    along = x * dvx + z * dvz
    x, z = x + rate * (dvx - x * along), z + rate * (dvz - z * along)
    return _velocity(plate, x, z, vx + dvx, vz + dvz)


@inlined
def _half_way(plate, vx, vz, to_vx, to_vz):
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
    """The hip's velocity with a direction w, m/s; (vx, vz) where no foot turns over, or where it slides."""
    square = x * x + z * z
    if plate.foot == NO_FOOT or square > INSIDE * INSIDE:
        return vx, vz
    speed = plate.speed / np.sqrt(1.0 - square)
    return plate.x + speed * x, plate.z + speed * z
