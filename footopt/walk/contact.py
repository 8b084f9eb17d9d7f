"""The compiled force loops: RFT on every plate of both feet, with its analytic Jacobian.

The law is the affine form of `footopt.sand.law.affine`: no angle and no branch in the plate
loop. Motion directions are smoothed by the creep speed, h = v / sqrt(|v|^2 + eps^2), so that the
law is single-valued at rest and implicit steps converge. What a scene's effects change of it is in
`footopt.effects.base`; an effect that the scene does not name is None here, and not compiled.

Vectorisation needs sums to be reordered (`reassoc`); flags that assume no NaN stay off, so that a
walk that diverges is seen. A foot's sum depends on nothing but that foot: results do not change
with the batch or the number of threads.

Every function under the loop is inlined by force: a function with a symbol of its own may be taken
from another compilation of the same source, which rounds otherwise, and then a walk differed in its
last bits between the process that compiled it and the ones that load it from the cache on disk.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from footopt.compiled import FAST
from footopt.effects import base as effects

Array = NDArray[np.float64]

MAX_NEWTON = 20  # contact evaluations of one implicit stage at one creep speed, back-tracking included
MAX_RESCUE = 1000  # ... and in all, if it has to be approached from a larger creep speed
GATED = 2.0  # last step of Newton's method over the creep speed, where an effect's gate is
LANES = 8  # plates are padded to a multiple of this, and summed in such blocks

# columns of a contact, (2 feet, 7): force, power, and dF/dV (x by x, x by z, z by x, z by z)
FX, FZ, POWER, JXX, JXZ, JZX, JZZ = range(7)
CONTACT = 7

# what a walk counts: evaluations of the contact, of plates in it, stages that had to be rescued, steps
# that were repeated with half their length, and how often the whole walk was, with a quarter of it
EVALUATIONS, PLATES, RESCUES, SHORTENED, REPEATS = range(5)
TALLY = 5


class Sole(NamedTuple):
    """One design's plates, relative to the ankle; see `foot.Plates`.

    Each is (padded plates,): filled up to whole blocks of `LANES` by plates without area in the
    place of the last one.
    """

    x: Array
    z: Array
    c2: Array
    s2: Array
    area: Array
    block_x: Array  # (blocks,): a circle around each block of plates, m
    block_z: Array
    block_r: Array
    reach: float  # the sole's largest distance from the ankle, m
    tx: Array | None  # the plate's direction, a unit vector, where an effect needs its normal
    tz: Array | None


class World(NamedTuple):
    """What does not change during a walk: the law in N/m^3, the walker, the smoothing."""

    A00: float
    A10: float
    B01: float
    B_sum: float
    B_diff: float
    C01: float
    C_sum: float
    C_diff: float
    D10: float
    mass: float  # kg
    g: float  # against the surface's normal, m/s^2
    tilt: float | None  # gravity along the surface, m/s^2; None if it is level
    creep: float  # m/s
    tolerance: float  # of Newton's method: last step over the plates' mean speed
    loads: tuple[Any, ...] | None  # laws of the scene's effects: `effects.Laws`
    gates: tuple[Any, ...] | None
    pushes: tuple[Any, ...] | None


@njit(fastmath=FAST, error_model="numpy", forceinline=True)
def rsqrt(square):
    """1 / sqrt(x) to 4e-14: a single-precision estimate and one Newton step, 3 times faster.

    Good for 1e-37 < x < 1e37, far beyond any speed squared that a walk can hold.
    """
    q = np.float64(np.float32(1.0) / np.sqrt(np.float32(square)))
    return q * (1.5 - 0.5 * square * q * q)


@njit(fastmath=FAST, error_model="numpy", forceinline=True)
def plate_sums(
    sole, world, loads, gates, pushes, all_tx, all_tz, first, last, xa, za, vx, vz, cos, sin, rate, creep,
    jacobian,
):  # fmt: skip
    """Sums over plates first..last of one foot: f_x, f_z, power, and the Jacobian of f.

    loads, gates, pushes: the world's, and the sole's directions; None leaves an effect out of the
    compiled code. xa, za: the ankle, m. vx, vz: its velocity, m/s. cos, sin, rate: of the foot's pitch.
    jacobian: dx/dv_x = dz/dv_z in s, how the place follows from the velocity in an implicit stage; None
    leaves the derivatives (then 0) out.
    """
    c2p, s2p = cos * cos - sin * sin, 2.0 * sin * cos
    eps2 = creep * creep
    rate_cos, rate_sin = rate * cos, rate * sin
    fx = fz = power = jxx = jxz = jzx = jzz = 0.0
    # slices from 0: an index that could be negative would keep the loop from being vectorised
    x, z, area = sole.x[first:last], sole.z[first:last], sole.area[first:last]
    c2, s2 = sole.c2[first:last], sole.s2[first:last]
    if all_tx is not None:
        tx, tz = all_tx[first:last], all_tz[first:last]
    for i in range(len(x)):
        rz = sin * x[i] + cos * z[i]
        depth = max(-(za + rz), 0.0)
        k = area[i] * depth
        ux = vx - rate * rz
        uz = vz + rate_cos * x[i] - rate_sin * z[i]
        q = rsqrt(ux * ux + uz * uz + eps2)
        hx, hz = ux * q, uz * q
        c = c2[i] * c2p - s2[i] * s2p  # cos and sin of twice the plate's angle in the world
        s = s2[i] * c2p + c2[i] * s2p
        mxx = world.C01 + world.C_sum * c
        mxz = world.C_diff * s
        mzx = -world.B_diff * s
        mzz = world.B01 + world.B_sum * c
        px = -world.D10 * s - mxx * hx - mxz * hz
        pz = world.A00 + world.A10 * c - mzx * hx - mzz * hz
        if loads is not None:
            place = xa + cos * x[i] - sin * z[i]
            strength, grow, slide = effects.load(loads, (depth, 1.0, 0.0), depth, place)
            k = area[i] * strength
        if jacobian is not None:
            wet = jacobian * area[i] if depth > 0.0 else 0.0
            kq = k * q  # dh/dv = (I - h h^T) / |v|
        if all_tx is not None:
            nx, nz = sin * tx[i] + cos * tz[i], sin * tz[i] - cos * tx[i]  # outward normal
            into = ux * nx + uz * nz
        if gates is not None:
            share, bend = effects.gate(gates, (1.0, 0.0), into, creep)
            if jacobian is not None:
                jxx += k * bend * px * nx
                jxz += k * bend * px * nz
                jzx += k * bend * pz * nx
                jzz += k * bend * pz * nz
                kq *= share
            px, pz = share * px, share * pz
        if pushes is not None:
            push, stiff, sink = effects.push(pushes, (0.0, 0.0, 0.0), into, depth)
            fx -= area[i] * push * nx
            fz -= area[i] * push * nz
            power -= area[i] * push * into
            if jacobian is not None:
                jxx -= area[i] * stiff * nx * nx
                jxz -= area[i] * stiff * nx * nz - wet * sink * nx
                jzx -= area[i] * stiff * nx * nz
                jzz -= area[i] * stiff * nz * nz - wet * sink * nz
        fx += k * px
        fz += k * pz
        power += k * (px * ux + pz * uz)
        if jacobian is not None:
            if loads is not None:
                jxx += wet * slide * px
                jzx += wet * slide * pz
                wet *= grow
            jxz -= wet * px
            jzz -= wet * pz
            txx, txz, tzz = 1.0 - hx * hx, -hx * hz, 1.0 - hz * hz
            jxx -= kq * (mxx * txx + mxz * txz)
            jxz -= kq * (mxx * txz + mxz * tzz)
            jzx -= kq * (mzx * txx + mzz * txz)
            jzz -= kq * (mzx * txz + mzz * tzz)
    return fx, fz, power, jxx, jxz, jzx, jzz


@njit(forceinline=True)
def submerged(sole, za, cos, sin):
    """First and one past the last plate of the blocks that reach below the surface."""
    if za > sole.reach:
        return 0, 0
    first, last = 0, len(sole.block_x)
    while first < last and za + sin * sole.block_x[first] + cos * sole.block_z[first] >= sole.block_r[first]:
        first += 1
    while (
        last > first
        and za + sin * sole.block_x[last - 1] + cos * sole.block_z[last - 1] >= sole.block_r[last - 1]
    ):
        last -= 1
    return first * LANES, last * LANES


@njit(forceinline=True)
def contact(out, tally, sole, world, pose, x, z, vx, vz, creep, jacobian):
    """Force, power and derivatives of both feet at the hip's place (m) and velocity (m/s).

    Parameters
    ----------
    out : (2, 7), filled; columns as named at the top of this module (N, W, N s/m)
    pose : (2, 7), as made by `gait.Pose.table`
    tally : counts of the walk, added to
    creep : eps, m/s. jacobian : see `plate_sums`
    """
    tally[EVALUATIONS] += 1
    for foot in range(2):
        za, cos, sin, rate = z + pose[foot, 1], pose[foot, 4], pose[foot, 5], pose[foot, 6]
        first, last = submerged(sole, za, cos, sin)
        if first == last:
            for j in range(CONTACT):
                out[foot, j] = 0.0
            continue
        tally[PLATES] += last - first
        ax, az = vx + pose[foot, 2], vz + pose[foot, 3]
        fx, fz, power, jxx, jxz, jzx, jzz = plate_sums(
            sole, world, world.loads, world.gates, world.pushes, sole.tx, sole.tz, first, last,
            x + pose[foot, 0], za, ax, az, cos, sin, rate, creep, jacobian,
        )  # fmt: skip
        out[foot, FX], out[foot, FZ] = fx, fz
        out[foot, POWER] = power
        out[foot, JXX], out[foot, JXZ] = jxx, jxz
        out[foot, JZX], out[foot, JZZ] = jzx, jzz


@njit(forceinline=True)
def leaning(value, tilt, time):
    """A velocity along the surface with what gravity adds in a time: value + time tilt."""
    if tilt is None:
        return value
    return value + time * tilt


@njit(forceinline=True)
def small_step(step, creep, gates):
    """A step of Newton's method on which the law is smooth, m/s: a gate turns within the creep speed."""
    if gates is None:
        return step
    return min(step, GATED * creep)


@njit(error_model="numpy", forceinline=True)
def solve_stage(out, tally, sole, world, pose, x0, z0, vx0, vz0, c, vx, vz):
    """Velocity V of an implicit stage: V = v0 + c a(r0 + c V, V), by Newton's method.

    Starts from the guess (vx, vz) and halves a step that makes the residual larger. It ends with a
    step that is small against the speed at which the plates move through the sand (their mean
    |P| / |F|, at least the creep speed), on which the law is smooth: Newton's method has then
    converged to the square of that ratio. `out` holds the forces carried along the last step to
    first order, so that the stage's momentum balance closes to rounding.

    Where that fails, because the law turns too sharply on the way, the stage is rescued: it is
    solved for a creep speed so large that the law is viscous, then for smaller and smaller ones,
    each from the solution before. Rescues are counted.

    Returns
    -------
    vx, vz : m/s. solved : whether the stage was solved.
    """
    guess_x, guess_z = vx, vz
    inv = c / world.mass
    creep, best, tries = world.creep, np.inf, 0
    rescue, ratio, solved_at, viscous = False, 0.25, np.inf, np.inf
    dvx = dvz = 0.0
    for _ in range(MAX_RESCUE):
        contact(out, tally, sole, world, pose, x0 + c * vx, z0 + c * vz, vx, vz, creep, c)
        rx = vx - leaning(vx0, world.tilt, c) - inv * (out[0, FX] + out[1, FX])
        rz = vz - vz0 - inv * (out[0, FZ] + out[1, FZ]) + c * world.g
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
                tally[RESCUES] += 1
                creep = viscous = 10.0 * (1.0 + abs(guess_x) + abs(guess_z))
            else:  # a smaller stride from the last creep speed that went well
                ratio = np.sqrt(ratio)
                if ratio > 0.97 or creep == viscous:
                    break
                creep = max(ratio * solved_at, world.creep)
            vx, vz = guess_x, guess_z
            best, tries = np.inf, 0
            continue
        best = residual
        a = 1.0 - inv * (out[0, JXX] + out[1, JXX])
        b = -inv * (out[0, JXZ] + out[1, JXZ])
        d = -inv * (out[0, JZX] + out[1, JZX])
        e = 1.0 - inv * (out[0, JZZ] + out[1, JZZ])
        det = 1.0 / (a * e - b * d)
        dvx, dvz = (b * rz - e * rx) * det, (d * rx - a * rz) * det
        vx, vz = vx + dvx, vz + dvz
        size = abs(dvx) + abs(dvz)
        force = power = 0.0
        for foot in range(2):
            force += abs(out[foot, FX]) + abs(out[foot, FZ])
            power += abs(out[foot, POWER])
        rounding = 1e-13 * (1.0 + abs(vx) + abs(vz))
        # a rescue follows the plate that sticks, whatever the mean speed of the others
        speed = creep if rescue or force == 0.0 else creep + power / force
        enough = small_step(world.tolerance * speed, creep, world.gates)
        if size <= rounding or (force > 0.0 and size <= enough + rounding):
            if creep == world.creep:
                for foot in range(2):
                    out[foot, FX] += out[foot, JXX] * dvx + out[foot, JXZ] * dvz
                    out[foot, FZ] += out[foot, JZX] * dvx + out[foot, JZZ] * dvz
                return vx, vz, True
            guess_x, guess_z, solved_at = vx, vz, creep
            creep, best, tries = max(ratio * creep, world.creep), np.inf, 0
    return vx, vz, False


@njit(error_model="numpy", forceinline=True)
def static_height(sole, world, pose):
    """Hip height (m) at which the limit forces of downward motion on both feet carry the weight.

    Vertical balance only, h = (0, -1) on every plate. NaN if even at the surface they do not.
    """
    low, high = 0.0, -np.inf
    for foot in range(2):
        for i in range(len(sole.x)):
            high = max(high, -(pose[foot, 1] + pose[foot, 5] * sole.x[i] + pose[foot, 4] * sole.z[i]))
    if high <= low or _lift(sole, world, pose, low) < world.mass * world.g:
        return np.nan
    for _ in range(60):
        middle = 0.5 * (low + high)
        if _lift(sole, world, pose, middle) >= world.mass * world.g:
            low = middle
        else:
            high = middle
    return low


@njit(error_model="numpy", forceinline=True)
def _lift(sole, world, pose, z):
    """Limit force of downward motion on both feet at the hip height z, N."""
    total = 0.0
    for foot in range(2):
        cos, sin = pose[foot, 4], pose[foot, 5]
        c2p, s2p = cos * cos - sin * sin, 2.0 * sin * cos
        for i in range(len(sole.x)):
            depth = -(z + pose[foot, 1] + sin * sole.x[i] + cos * sole.z[i])
            if depth > 0.0:
                c = sole.c2[i] * c2p - sole.s2[i] * s2p
                stress = world.A00 + world.B01 + (world.A10 + world.B_sum) * c
                place = pose[foot, 0] + cos * sole.x[i] - sin * sole.z[i]
                strength = strengthened(world.loads, depth, place)
                share = sinking_share(world.gates, sole.tx, sole.tz, i, cos, sin)
                total += sole.area[i] * strength * stress * share
    return total


@njit(error_model="numpy", forceinline=True)
def strengthened(loads, depth, place):
    """Strength integrated over the depth, m."""
    if loads is None:
        return depth
    return effects.load(loads, (depth, 1.0, 0.0), depth, place)[0]


@njit(error_model="numpy", forceinline=True)
def sinking_share(gates, tx, tz, i, cos, sin):
    """Share of the stress that plate i feels when it moves straight down, by 1 m/s."""
    if gates is None:
        return 1.0
    return effects.gate(gates, (1.0, 0.0), cos * tx[i] - sin * tz[i], 1e-9)[0]


@njit(forceinline=True)
def deepest(sole, pose, z):
    """Depth of the lowest plate of both feet below the surface, m; 0 when both are above."""
    depth = 0.0
    for foot in range(2):
        za = z + pose[foot, 1]
        if za <= sole.reach:
            for i in range(len(sole.x)):
                depth = max(depth, -(za + pose[foot, 5] * sole.x[i] + pose[foot, 4] * sole.z[i]))
    return depth
