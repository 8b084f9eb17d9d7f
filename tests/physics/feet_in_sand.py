"""One foot in the sand, by the compiled contact: what tests of the law and of effects share."""

import math

import numpy as np
from hypothesis import strategies as st

import footopt as fo
from footopt.effects import laws
from footopt.foot import Plates
from footopt.walk.contact import contact
from footopt.walk.discretize import sole_of
from footopt.walk.own_code import compiled_for
from footopt.walk.state import ALOFT, COUNTS, Motion

PITCH, RATE, SPEED = st.floats(-1.2, 1.2), st.floats(-6.0, 6.0), st.floats(-1.5, 1.5)
SOLES = st.lists(st.integers(1, 10), min_size=11, max_size=11).map(fo.Foot.from_waypoints)
PLACE, HEIGHT = st.floats(0.0, 1.8), st.floats(-0.1, 0.05)

SKY = (0.0, 10.0, 0.0, 0.0, 1.0, 0.0, 0.0)  # pose of a foot far above the sand


def pose_of(height, pitch, rate):
    """Pose of a foot whose ankle is at a height (m) above the sand when the hip is at 0."""
    return (0.0, height, 0.0, 0.0, math.cos(pitch), math.sin(pitch), rate)


def both_feet(world, sole, poses, hip, transition, stage, counts):
    """`contact` without bristles, to be compiled for Python."""
    return contact(world, sole, poses, hip, transition, stage, None, counts)


def feel(plates, pose, vx, vz, *on, zeta=1.0, creep=1e-2, stage=None, x=0.0, z=0.0):
    """`Force` on one foot with effects, as an array, and the counts; the other foot is in the sky."""
    scene = fo.Scene(sand=fo.Sand(zeta), effects=on)
    acting = laws(scene.effects)
    counts, constants = np.zeros(1, COUNTS)[0], scene.constants(fo.Accuracy(creep=creep))
    state = constants, sole_of(plates), np.array([pose, SKY]), Motion(x, z, vx, vz), creep, stage, counts
    found = compiled_for(both_feet, acting.all)(*state)
    assert found.right == ALOFT.right
    return np.array(found.left), counts


def momentum_gap(walk):
    """Momentum that neither the sand's impulse nor gravity explains, (2,), N s; rounding only."""
    walker = walk.scene.walker
    tilt, g = walk.scene.gravity
    gravity = walker.mass * np.array([tilt, -g])
    impulse = np.array([walk.totals["impulse_x"], walk.totals["impulse_z"]]) + gravity * walk.t[-1]
    return walker.mass * walk.velocity[-1] - impulse


def force(*arguments, **options):
    """F_x and F_z, N."""
    return feel(*arguments, **options)[0][:2]


def blade(beta, length=0.016, width=0.016, parts=8):
    """A straight plate, its middle at the ankle, in the direction beta (rad): normal (sin, -cos)."""
    s = length * ((np.arange(parts) + 0.5) / parts - 0.5)
    columns = (s * math.cos(beta), s * math.sin(beta), math.cos(2 * beta), math.sin(2 * beta))
    columns = (*columns, length * width / parts, math.cos(beta), math.sin(beta), 0.0)
    return Plates(*(np.full((1, parts), column) for column in columns), np.zeros(1), np.full(1, width))
