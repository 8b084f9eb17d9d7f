"""The compiled contact: RFT on every plate of both feet, with its Jacobian, and where it carries the walker.

The paper's eq. 4 places and moves each plate (`kinematics`), eq. 1 gives its force (`resistance`), effects
change it (`plate_force`), eq. 2 adds the plates of a foot (`foot_force`). Eq. 5, the motion that
they cause, is `steppers.acceleration`, in implicit stages `newton.residual`. The law is the affine form of
`footopt.sand.law`, so that the loop over plates holds no angle and no branch. Directions of motion are
smoothed by the creep speed, h = v / sqrt(|v|^2 + eps^2), so that the law is single-valued at rest and
implicit steps converge.

Everything that depends on the hip's velocity is a `Dual` in an implicit stage and a plain number without one.
An argument that is None is not compiled: stage, bristles, tangents, and effects that a scene does not name.
A foot's sum depends on nothing but that foot: results do not change with the batch or the number of threads.
"""

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined, inlined_fast, unless_none
from footopt.effects import base as effects
from footopt.effects.base import Laws
from footopt.effects.dual import combined, dual, lift, placed, positive, value
from footopt.walk.metrics import sinkage_of
from footopt.walk.state import ALOFT, LANES, Ankle, Contact, Force, Motion, ankle_of, in_world, plates_between

# over what the law is smoothed
TURN = 0.25  # a plate's direction: over this share of the difference in speed along a plate that rotates
EXPOSED = 0.5  # a gate: over this share of the same difference
BENT = 0.75  # a gate: over this share of the angle by which the contour turns within a plate
EDGE = 0.005  # a gate, where bristles say how a plate moves: over this n.h

# the downward motion by which the initial height of the hip is found
DOWN = 2.0**-30  # m/s: too slow to change the pressure of an effect; a power of two, which rounds nothing
SLOW = 1e-9 * DOWN  # m/s: its transition speed, too small to change a force; `rsqrt` can take its square


class Direction(NamedTuple):
    """A plate's direction of motion h, |h| <= 1, with dh/dv = rate (I - slides h h^T)."""

    x: float
    z: float
    rate: float  # s/m
    slides: float  # 1 for a plate that slides, 0 for one that bristles hold


@inlined_fast
def rsqrt(square):
    """1 / sqrt(x) to 4e-14: a single-precision estimate and one Newton step, 3 times faster.

    Good for 1e-37 < x < 1e37, far beyond any speed squared that a walk can hold.
    """
    q = np.float64(np.float32(1.0) / np.sqrt(np.float32(square)))
    return q * (1.5 - 0.5 * square * q * q)


@inlined_fast
def kinematics(ankle, x, z):
    """The plate at (x, z) in the foot's frame, m: the paper's eq. 4."""
    along, rise = ankle.cos * x - ankle.sin * z, ankle.sin * x + ankle.cos * z
    vx, vz = ankle.vx - ankle.rate * rise, ankle.vz + ankle.rate * along
    return Motion(ankle.x + along, ankle.z + rise, vx, vz)


@inlined_fast
def direction(motion, transition, within, e0, i):
    """h of plate i: v / |v|, smoothed over `transition` and the plate's rotation, or held by bristles.

    Along a plate that rotates the velocity differs by `within`, m/s: near the centre of the rotation the mean
    direction over the plate is smooth where the direction at its middle jumps. Bristles are bent from `e0`
    by the motion over a length delta; the transition speed is delta over the time since then.
    """
    vx, vz = motion.vx, motion.vz
    if e0 is None:
        rate = rsqrt(vx * vx + vz * vz + (transition * transition + TURN * TURN * within * within))
        return Direction(vx * rate, vz * rate, rate, 1.0)
    turn = 1.0 / transition
    ux, uz = e0[0][i] + vx * turn, e0[1][i] + vz * turn
    square = ux * ux + uz * uz
    inside = rsqrt(max(square, 1.0))
    return Direction(ux * inside, uz * inside, inside * turn, 1.0 if square > 1.0 else 0.0)


@inlined_fast
def resistance(law, c, s, h, felt, stage):
    """f = felt (a - M h), N in x and z: the paper's eq. 1 in its affine form, the stress times felt.

    c, s: cosine and sine of twice the plate's angle in the world. felt: area times depth, m^3, with effects;
    zeta is in the law.
    The stress p changes with the direction of motion, dp/dv = -rate (M - (M h) h^T).
    """
    mxx, mxz = law.C01 + law.C_sum * c, law.C_diff * s
    mzx, mzz = -law.B_diff * s, law.B01 + law.B_sum * c
    x, z = mxx * h.x + mxz * h.z, mzx * h.x + mzz * h.z  # M h
    px, pz = -law.D10 * s - x, law.A00 + law.A10 * c - z
    k, rate = lift(felt), -h.rate * value(felt)
    x, z = h.slides * x, h.slides * z
    xx, xz = combined(px, k.dx, rate, mxx - x * h.x), combined(px, k.dz, rate, mxz - x * h.z)
    zx, zz = combined(pz, k.dx, rate, mzx - z * h.x), combined(pz, k.dz, rate, mzz - z * h.z)
    return dual(stage, k.value * px, xx, xz), dual(stage, k.value * pz, zx, zz)


@inlined_fast
def outward_normal(tangent, i, ankle):
    """Of plate i in the world; 0 where no effect needs it."""
    if tangent is None:
        return 0.0, 0.0
    cos, sin, x, z = ankle.cos, ankle.sin, tangent.x[i], tangent.z[i]
    return sin * x + cos * z, sin * z - cos * x


@inlined_fast
def lead(tangent, i, motion, nx, nz, h, transition, within, e0, stage):
    """How far plate i leads, for gates: n.v over its smoothing width, or n.h over `EDGE`.

    The width is the range of speeds along the normal within a plate that rotates and is bent. The plate leads
    as a whole from 1 on, and trails from -1 on.
    """
    if tangent is None:
        return dual(stage, 0.0, 0.0, 0.0)
    if e0 is None:
        vx, vz = motion.vx, motion.vz
        bent = BENT * tangent.turn[i]
        bent *= bent
        square = transition * transition + EXPOSED * EXPOSED * within * within + bent * (vx * vx + vz * vz)
        narrow = rsqrt(square)
        ratio = (vx * nx + vz * nz) / (square * narrow)
        wider = ratio * bent * narrow  # the width grows with the speed
        return dual(stage, ratio, narrow * (nx - wider * vx), narrow * (nz - wider * vz))
    hn = h.x * nx + h.z * nz
    rate, sliding = h.rate / EDGE, h.slides * hn
    return dual(stage, hn / EDGE, rate * (nx - sliding * h.x), rate * (nz - sliding * h.z))


@inlined_fast
def plate_force(law, acting, part, i, ankle, transition, stage, e0):
    """The force on plate i of a foot, with the effects of a scene; arguments as in `foot_force`.

    zeta load share (a - M h) dA - pressure n dA, N in x and z, each a `Dual` in an implicit stage; the
    plate's motion; and its outward normal in x and z, 0 without a tangent.
    """
    area = part.area[i]
    motion = kinematics(ankle, part.x[i], part.z[i])
    depth, x = positive(placed(stage, -motion.z, 0.0, -1.0)), placed(stage, motion.x, 1.0, 0.0)
    within = ankle.rate * part.span
    h = direction(motion, transition, within, e0, i)

    nx, nz = outward_normal(part.tangent, i, ankle)
    vn = dual(stage, motion.vx * nx + motion.vz * nz, nx, nz)
    leads = lead(part.tangent, i, motion, nx, nz, h, transition, within, e0, stage)
    felt = area * effects.load(acting.loads, depth, x) * effects.gate(acting.gates, leads, depth)

    cos2, sin2 = ankle.cos * ankle.cos - ankle.sin * ankle.sin, 2.0 * ankle.sin * ankle.cos
    c, s = part.c2[i] * cos2 - part.s2[i] * sin2, part.s2[i] * cos2 + part.c2[i] * sin2
    fx, fz = resistance(law, c, s, h, felt, stage)
    if acting.pushes is not None:  # without one nothing is to be computed that could be NaN
        push = area * effects.push(acting.pushes, vn, depth)
        fx, fz = fx - push * nx, fz - push * nz
    return fx, fz, motion, nx, nz


@inlined_fast
def foot_force(law, acting, part, ankle, transition, stage, e0):
    """F = sum of f over some plates: the paper's eq. 2, with their power and derivatives.

    law: the stress map times zeta, N/m^3. acting: `Laws` of the scene's effects. part: the plates. ankle: in
    the world. transition, stage: see `contact`. e0: bristles of these plates, (e_x, e_z), or None.
    """
    x = z = power = xx = xz = zx = zz = along_x = along_z = 0.0
    for i in range(len(part.x)):
        fx, fz, motion, _, _ = plate_force(law, acting, part, i, ankle, transition, stage, e0)
        x += value(fx)
        z += value(fz)
        power += value(fx) * motion.vx + value(fz) * motion.vz  # eq. 7
        xx += lift(fx).dx
        xz += lift(fx).dz
        zx += lift(fz).dx
        zz += lift(fz).dz
        if acting.gates is not None:
            along_x += lift(fx).dx * motion.vx + lift(fz).dx * motion.vz
            along_z += lift(fx).dz * motion.vx + lift(fz).dz * motion.vz
    return Force(x, z, power, xx, xz, zx, zz, along_x, along_z)


@inlined
def part_force(world, sole, first, last, ankle, transition, stage, e0):
    """`foot_force` of the plates first..last of a sole, without the gates where they are bypassed."""
    acting = world.effects
    if world.bypass:
        part = plates_between(sole, acting.pushes, first, last)
        laws = Laws(acting.loads, None, acting.pushes)
        return foot_force(world.law, laws, part, ankle, transition, stage, e0)
    part = plates_between(sole, True, first, last)
    return foot_force(world.law, acting, part, ankle, transition, stage, e0)


@inlined
def submerged(sole, ankle):
    """First and one past the last plate of the blocks that reach below the sand's surface."""
    za, cos, sin = ankle.z, ankle.cos, ankle.sin
    if za > sole.reach:
        return 0, 0
    first, last = 0, sole.blocks.shape[1]
    while first < last and za + _lowest(sole, first, cos, sin) >= 0.0:
        first += 1
    while last > first and za + _lowest(sole, last - 1, cos, sin) >= 0.0:
        last -= 1
    return first * LANES, last * LANES


@inlined
def _lowest(sole, block, cos, sin):
    """Height of the lowest corner of the rectangle around a block of plates, relative to the ankle, m."""
    b = sole.blocks
    x, z, dx, dz = b[0, block], b[1, block], b[2, block], b[3, block]
    return sin * x + cos * z - abs(sin) * dx - abs(cos) * dz


@inlined
def contact(world, sole, poses, hip, transition, stage, e0, counts):
    """`Contact` of both feet with the sand.

    poses: (2 feet, 7), both feet relative to the hip (`state.ankle_of`). transition: over which a plate's
    direction turns, m/s: the creep speed eps; with bristles, delta over the time for which they have followed
    the plates. stage: dx/dv_x = dz/dv_z in an implicit stage, s: how the hip's place follows from its
    velocity; None leaves the derivatives out, which are then 0. e0: bristles at the beginning of that time,
    (2 feet, 2, plates), or None. counts: a record of `COUNTS`, added to.
    """
    counts.evaluations += 1
    left, right = ALOFT.left, ALOFT.right
    for foot in range(2):  # one copy of the loop over plates: what is written twice is compiled twice
        ankle = in_world(ankle_of(poses, foot), hip)
        first, last = submerged(sole, ankle)
        force = ALOFT.left
        if first < last:
            counts.plates += last - first
            bristles = bristles_between(e0, foot, first, last)
            force = part_force(world, sole, first, last, ankle, transition, stage, bristles)
        left, right = right, force
    return Contact(left, right, ALOFT.reversal)


@unless_none
def bristles_between(e0, foot, first, last):
    """Bristles of the plates first..last of one foot."""
    return e0[foot, 0, first:last], e0[foot, 1, first:last]


@inlined
def static_height(world, sole, poses, e0):
    """Hip height (m) at which the limit forces of downward motion on both feet carry the weight.

    Vertical balance only: eq. 2 with h = (0, -1) on every plate, and effects as at rest. NaN if even at the
    surface the forces do not carry the weight. Found by the Illinois method, which takes a tenth of the
    evaluations of bisection.

    e0: bristles that are bent straight down, or None.
    """
    weight, low, high = world.mass * world.g, 0.0, sinkage_of(sole, poses, Motion(0.0, 0.0, 0.0, 0.0))
    below, above, side = np.nan, -weight, 0
    z = low
    for _ in range(200):
        excess = _limit_force(world, sole, poses, z, e0) - weight
        if np.isnan(below):  # at the surface
            if high <= low or excess < 0.0:
                return np.nan
            below = excess
        elif abs(excess) <= 1e-13 * weight:
            return z
        elif excess > 0.0:
            above *= 0.5 if side > 0 else 1.0  # the other end has stayed twice: halve its value
            low, below, side = z, excess, 1
        else:
            below *= 0.5 if side < 0 else 1.0
            high, above, side = z, excess, -1
        z = (low * above - high * below) / (above - below)
        if not low < z < high:
            return z
    return low


@inlined
def _limit_force(world, sole, poses, z, e0):
    """Limit force of downward motion on both feet at the hip height z, N."""
    total = 0.0
    for foot in range(2):
        still = ankle_of(poses, foot)
        ankle = Ankle(still.x, z + still.z, 0.0, -DOWN, still.cos, still.sin, 0.0)
        first, last = submerged(sole, ankle)
        if first < last:
            slow, bristles = SLOW if e0 is None else np.inf, bristles_between(e0, foot, first, last)
            total += part_force(world, sole, first, last, ankle, slow, world.given, bristles).z
    return total
