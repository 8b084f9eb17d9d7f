"""The compiled force loops: RFT on every plate of both feet, with its analytic Jacobian.

The law is the affine form of `footopt.sand.stress.affine`: no angle and no branch in the plate
loop. Motion directions are smoothed by the creep speed, h = v / sqrt(|v|^2 + eps^2), so that the
law is single-valued at rest and implicit steps converge.

Vectorisation needs sums to be reordered (`reassoc`); flags that assume no NaN stay off, so that a
walk that diverges is seen. A foot's sum depends on nothing but that foot: results do not change
with the batch or the number of threads.

Every function under the loop is inlined by force: a function with a symbol of its own may be taken
from another compilation of the same source, which rounds otherwise, and then a walk differed in its
last bits between the process that compiled it and the ones that load it from the cache on disk.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

FAST = {"contract", "reassoc", "arcp", "nsz"}
LANES = 8  # plates are padded to a multiple of this, and summed in such blocks

# columns of a contact, (2 feet, 9): force, power, dF/dV (x by x, x by z, z by x, z by z), dF/dz
FX, FZ, POWER, JXX, JXZ, JZX, JZZ, DX, DZ = range(9)


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
    reach: float  # the sole's largest distance from the ankle, m


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
    g: float  # m/s^2
    creep: float  # m/s
    tolerance: float  # of Newton's method, m/s


@njit(fastmath=FAST, error_model="numpy", forceinline=True)
def rsqrt(square):
    """1 / sqrt(x) to 4e-14: a single-precision estimate and one Newton step, 3 times faster.

    Good for 1e-37 < x < 1e37, far beyond any speed squared that a walk can hold.
    """
    q = np.float64(np.float32(1.0) / np.sqrt(np.float32(square)))
    return q * (1.5 - 0.5 * square * q * q)


@njit(fastmath=FAST, error_model="numpy", forceinline=True)
def plate_sums(sole, world, first, last, za, vx, vz, cos, sin, rate, jacobian):
    """Sums over plates first..last of one foot: f_x, f_z, power, the Jacobian of
    f in the ankle's velocity, and its derivative in the height of the ankle.

    za: height of the ankle, m. vx, vz: its velocity, m/s. cos, sin, rate: of the foot's pitch.
    jacobian: None leaves the derivatives (then 0) out of the compiled code.
    """
    c2p, s2p = cos * cos - sin * sin, 2.0 * sin * cos
    eps2 = world.creep * world.creep
    rate_cos, rate_sin = rate * cos, rate * sin
    fx = fz = power = jxx = jxz = jzx = jzz = dx = dz = 0.0
    # slices from 0: an index that could be negative would keep the loop from being vectorised
    x, z, area = sole.x[first:last], sole.z[first:last], sole.area[first:last]
    c2, s2 = sole.c2[first:last], sole.s2[first:last]
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
        fx += k * px
        fz += k * pz
        power += k * (px * ux + pz * uz)
        if jacobian is not None:
            wet = area[i] if depth > 0.0 else 0.0
            dx -= wet * px
            dz -= wet * pz
            kq = k * q  # dh/dv = (I - h h^T) / |v|
            txx, txz, tzz = 1.0 - hx * hx, -hx * hz, 1.0 - hz * hz
            jxx -= kq * (mxx * txx + mxz * txz)
            jxz -= kq * (mxx * txz + mxz * tzz)
            jzx -= kq * (mzx * txx + mzz * txz)
            jzz -= kq * (mzx * txz + mzz * tzz)
    return fx, fz, power, jxx, jxz, jzx, jzz, dx, dz


@njit(forceinline=True)
def submerged(sole, za, cos, sin):
    """First and one past the last plate below the surface, whole blocks; (0, 0) for a dry foot."""
    n = len(sole.x)
    if za > sole.reach:
        return 0, 0
    first = 0
    while first < n and za + sin * sole.x[first] + cos * sole.z[first] >= 0.0:
        first += 1
    if first == n:
        return 0, 0
    last = n
    while za + sin * sole.x[last - 1] + cos * sole.z[last - 1] >= 0.0:
        last -= 1
    blocks = (last - first + LANES - 1) // LANES
    last = first + blocks * LANES
    return (first, last) if last <= n else (n - blocks * LANES, n)


@njit(forceinline=True)
def contact(out, sole, world, pose, z, vx, vz, jacobian):
    """Force, power and derivatives of both feet at a hip height z (m) and velocity (m/s).

    Parameters
    ----------
    out : (2, 9), filled; columns as named at the top of this module (N, W, N s/m, N/m)
    pose : (2, 7), as made by `gait.Pose.table`
    jacobian : 1 for the derivatives, None to leave them out of the compiled code
    """
    for foot in range(2):
        za, cos, sin, rate = z + pose[foot, 1], pose[foot, 4], pose[foot, 5], pose[foot, 6]
        first, last = submerged(sole, za, cos, sin)
        if first == last:
            for j in range(9):
                out[foot, j] = 0.0
            continue
        ax, az = vx + pose[foot, 2], vz + pose[foot, 3]
        fx, fz, power, jxx, jxz, jzx, jzz, dx, dz = plate_sums(
            sole, world, first, last, za, ax, az, cos, sin, rate, jacobian
        )
        out[foot, FX], out[foot, FZ] = fx, fz
        out[foot, POWER] = power
        out[foot, JXX], out[foot, JXZ] = jxx, jxz
        out[foot, JZX], out[foot, JZZ] = jzx, jzz
        out[foot, DX], out[foot, DZ] = dx, dz


@njit(error_model="numpy", forceinline=True)
def solve_stage(out, sole, world, pose, z0, vx0, vz0, c, vx, vz):
    """Velocity V of an implicit stage: V = v0 + c a(z0 + c V_z, V), by Newton's method.

    Starts from the guess (vx, vz) and halves a step that makes the residual larger. The last step
    is smaller than the world's tolerance; `out` then holds the forces carried along it to first
    order, so that the stage's momentum balance closes to rounding.

    Returns
    -------
    vx, vz : m/s. evaluations : of the contact; negative if Newton's method did not converge.
    """
    best = np.inf
    dvx = dvz = 0.0
    for evaluation in range(1, 41):
        contact(out, sole, world, pose, z0 + c * vz, vx, vz, 1)
        inv = c / world.mass
        rx = vx - vx0 - inv * (out[0, FX] + out[1, FX])
        rz = vz - vz0 - inv * (out[0, FZ] + out[1, FZ]) + c * world.g
        residual = rx * rx + rz * rz
        if residual > best and evaluation > 1:  # go back half of the way
            dvx, dvz = 0.5 * dvx, 0.5 * dvz
            vx, vz = vx - dvx, vz - dvz
            continue
        best = residual
        a = 1.0 - inv * (out[0, JXX] + out[1, JXX])
        b = -inv * (out[0, JXZ] + out[1, JXZ] + c * (out[0, DX] + out[1, DX]))
        d = -inv * (out[0, JZX] + out[1, JZX])
        e = 1.0 - inv * (out[0, JZZ] + out[1, JZZ] + c * (out[0, DZ] + out[1, DZ]))
        det = a * e - b * d
        dvx, dvz = -(e * rx - b * rz) / det, -(a * rz - d * rx) / det
        vx, vz = vx + dvx, vz + dvz
        size = abs(dvx) + abs(dvz)
        if size <= world.tolerance:
            for foot in range(2):
                out[foot, FX] += out[foot, JXX] * dvx + (out[foot, JXZ] + c * out[foot, DX]) * dvz
                out[foot, FZ] += out[foot, JZX] * dvx + (out[foot, JZZ] + c * out[foot, DZ]) * dvz
            return vx, vz, evaluation
        if not size < 1e9:
            break
    return vx, vz, -40


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
                total += sole.area[i] * depth * stress
    return total


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
