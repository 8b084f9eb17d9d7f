"""The parts of the compiled walk: plain tuples with names."""

from typing import Any, NamedTuple

import numpy as np
from numba.core import cgutils
from numba.extending import intrinsic, overload

from footopt.arrays import Array
from footopt.compiled import INLINE, inlined, unless_none
from footopt.effects.base import Laws
from footopt.sand.law import Law

LANES = 8  # plates are padded to a multiple of this, and summed in such blocks

NO_FOOT = -1  # in place of a foot's number

#: Counts of a walk: evaluations of the contact, of plates in it, stages that Newton's method left unsolved,
#: steps that were halved, and repeats of the whole walk with a quarter of the time step.
COUNTED = ("plates", "unsolved", "shortened", "repeats")
COUNTS = np.dtype([(name, np.int64) for name in ("evaluations", *COUNTED)])


class World(NamedTuple):
    """The constants of a walk: the sand, the walker, the smoothing."""

    law: Law  # the stress map times `Scene.zeta`, N/m^3
    mass: float  # kg
    g: float  # against the surface's normal, m/s^2
    tilt: float  # gravity along the surface, m/s^2: 0 if it is level
    creep: float  # m/s
    bristle_length: float | None  # over which a plate's bristles bend, m; None without them
    retardation: float  # s, by which bristles lag behind the force on them
    tolerance: float  # of Newton's method: last step over the plates' mean speed
    effects: Laws
    #: The argument `stage` of `contact` where no derivatives are needed: None with explicit steppers; 0 with
    #: implicit ones, because unused derivatives cost less time than compiling a second loop over plates.
    given: float | None = None
    bypass: bool = False  # whether the gates of `effects` are compiled and not applied


class Tangent(NamedTuple):
    """The plates' direction from heel to toe, a unit vector; the outward normal is (z, -x)."""

    x: Array
    z: Array
    turn: Array  # by which the contour turns within a plate, rad


class Sole(NamedTuple):
    """One design's plates, relative to the ankle (`foot.Plates`); of a batch, each with an axis more.

    Plates are filled up to whole blocks of `LANES` by copies of the last plate without area. Two tables
    instead of a dozen arrays halve the compile time of every function that takes them.
    """

    plates: Array  # (rows, padded plates): the arrays of `Part` and its tangent
    blocks: Array  # (4, blocks): middle of a rectangle around each block, half its length and height, m
    reach: Any  # the sole's largest distance from the ankle, m
    span: Any  # length along the contour that a plate represents, m; 0 for chords
    width: Any  # m


class Part(NamedTuple):
    """Plates of a sole that lie beside each other, as the loop over plates takes them."""

    x: Array
    z: Array
    c2: Array
    s2: Array
    area: Array
    span: float
    tangent: Tangent | None


class Ankle(NamedTuple):
    """Where a foot is and how it moves: relative to the hip in tables of poses, in the world in `contact`."""

    x: float  # ankle, m
    z: float
    vx: float  # ankle, m/s
    vz: float
    cos: float  # of the foot's pitch
    sin: float
    rate: float  # rad/s


class Motion(NamedTuple):
    """Place and velocity in the world: of the hip, of a plate."""

    x: float  # m
    z: float
    vx: float  # m/s
    vz: float


class Force(NamedTuple):
    """Of the sand on one foot, with its derivatives by the hip's velocity."""

    x: float  # N
    z: float
    power: float  # W
    xx: float  # N s/m: dF_x/dv_x
    xz: float
    zx: float
    zz: float
    along_x: float  # N: sum of v df/dv_x, by which gates change the power with v_x; 0 without gates
    along_z: float


class Reversal(NamedTuple):
    """A foot whose direction of motion reverses, where Newton's method has to follow that (`walk.newton`)."""

    foot: int  # or `NO_FOOT`
    x: float  # w, see `footopt.walk.newton`
    z: float


class Contact(NamedTuple):
    """Of both feet with the sand."""

    left: Force
    right: Force
    reversal: Reversal  # in the stage that ends there


#: Feet in the air.
ALOFT = Contact(Force(*[0.0] * 9), Force(*[0.0] * 9), Reversal(NO_FOOT, 0.0, 0.0))


class Integrals(NamedTuple):
    """Integrals along a walk, by the stepper's own quadrature."""

    work_left: float  # J
    work_right: float
    height: float  # of the hip, m s
    joint: float  # positive work of the joints of both legs, J
    joint_net: float  # J
    impulse_x: float  # of the sand, N s
    impulse_z: float


class State(NamedTuple):
    """The walker at one time."""

    hip: Motion
    contact: Contact
    integrals: Integrals
    bristles: Any  # `bristles.Bristles`
    solved: bool  # whether the step to here could be made


@inlined
def moved(start, time, vx, vz, ax, az):
    """A motion after a time (s) at constant velocity (m/s) and acceleration (m/s^2), each for itself."""
    return Motion(start.x + time * vx, start.z + time * vz, start.vx + time * ax, start.vz + time * az)


def borrowed(array):
    """An array that the caller keeps alive, without reference counts.

    Counting a reference is an atomic instruction; for these arrays it took half of a walk's time.
    """
    return array


@intrinsic
def unowned(typingctx: Any, array: Any) -> Any:
    """An array without a reference to the owner of its memory."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, args[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        return view._getvalue()

    return array(array), generate


overload(borrowed, jit_options=INLINE)(lambda array: lambda array: unowned(array))


@inlined
def ankle_of(poses, foot):
    """A foot's ankle in a row of the table, (2 feet, 7), that `gait.Pose.table` makes."""
    row = poses[foot]
    return Ankle(row[0], row[1], row[2], row[3], row[4], row[5], row[6])


@inlined
def in_world(ankle, hip):
    """An ankle in the world, from the ankle relative to the hip, and the hip's motion."""
    x, z, vx, vz = hip.x + ankle.x, hip.z + ankle.z, hip.vx + ankle.vx, hip.vz + ankle.vz
    return Ankle(x, z, vx, vz, ankle.cos, ankle.sin, ankle.rate)


@inlined
def sole_at(soles, design):
    """One design's plates out of a batch's."""
    plates, blocks = borrowed(soles.plates)[design], borrowed(soles.blocks)[design]
    return Sole(plates, blocks, soles.reach[design], soles.span[design], soles.width[design])


@inlined
def plates_between(sole, directed, first, last):
    """A part of a sole; without tangents where `directed` is None.

    Slices, each from 0: an index that could be negative keeps the loop over plates from being vectorised.
    """
    rows = sole.plates
    return Part(
        rows[0, first:last], rows[1, first:last], rows[2, first:last], rows[3, first:last],
        rows[4, first:last], sole.span, _tangent_between(directed, rows, first, last),
    )  # fmt: skip


@unless_none
def _tangent_between(directed, rows, first, last):
    return Tangent(rows[5, first:last], rows[6, first:last], rows[7, first:last])


@inlined
def lowest(sole, ankle):
    """The lowest plate, and its height in the frame in which the ankle is given, m."""
    x, z, plate, height = sole.plates[0], sole.plates[1], 0, np.inf
    for i in range(len(x)):
        level = ankle.z + ankle.sin * x[i] + ankle.cos * z[i]
        if level < height:
            plate, height = i, level
    return plate, height


@inlined
def write(row, values):
    """Write a tuple of numbers into a row of a table."""
    for j in range(len(values)):
        row[j] = values[j]
