"""The compiled contact: RFT on every plate of both feet, with its analytic Jacobian.

The paper's eq. 4 places and moves each plate, eq. 1 gives its force, eq. 2 adds the plates of a foot. The
law is the affine form of `footopt.sand.law.affine`, so that the loop over plates holds no angle and no
branch. Directions of motion are smoothed by the creep speed, h = v / sqrt(|v|^2 + eps^2), so that the law
is single-valued at rest and implicit steps converge. What a scene's effects change is in their own files
(`footopt.effects`); an effect that the scene does not name is None here, and not compiled.

A foot's sum depends on nothing but that foot: results do not change with the batch or the number of
threads.
"""

from __future__ import annotations

import numpy as np

from footopt.compiled import inlined, inlined_fast
from footopt.effects import base as effects
from footopt.walk.state import LANES, Contact, Force, Pose, no_force, pose_of

TURN = 0.25  # of the difference in speed along a turning plate, over which its direction is smoothed
SEEN = 0.5  # of the same, over which a gate opens
BENT = 0.75  # of the angle by which a plate is bent, over which a gate opens
EDGE = 0.05  # n.h over which an effect's gate opens where bristles say how a plate moves


@inlined_fast
def rsqrt(square):
    """1 / sqrt(x) to 4e-14: a single-precision estimate and one Newton step, 3 times faster.

    Good for 1e-37 < x < 1e37, far beyond any speed squared that a walk can hold.
    """
    q = np.float64(np.float32(1.0) / np.sqrt(np.float32(square)))
    return q * (1.5 - 0.5 * square * q * q)


@inlined_fast
def motion(ankle, x, z):
    """Height (m) and velocity (m/s) of the plate at (x, z) in the foot's frame, by the paper's eq. 4."""
    rise = ankle.sin * x + ankle.cos * z
    vx = ankle.vx - ankle.rate * rise
    vz = ankle.vz + ankle.rate * ankle.cos * x - ankle.rate * ankle.sin * z
    return ankle.z + rise, vx, vz


@inlined_fast
def foot_force(sole, law, loads, gates, pushes, tangent, first, last, ankle, creep, stage, h0):
    """F = sum of f: the force on one foot by the paper's eq. 2, its power, and its derivatives.

    What may be None is an argument of its own: numba leaves out branches on arguments only.

    Parameters
    ----------
    sole : Sole
        Its plates, of which those from `first` to `last` are summed; the others are not in the sand.
    law : Law
        The stress map times zeta, N/m^3.
    loads, gates, pushes : tuple or None
        The laws of the scene's effects (`World`).
    tangent : Tangent or None
        The sole's.
    ankle : Pose
        In the world.
    creep, stage, h0
        As in `contact`; `h0` of this foot, (2, plates).

    Returns
    -------
    Force
    """
    c2p, s2p = ankle.cos * ankle.cos - ankle.sin * ankle.sin, 2.0 * ankle.sin * ankle.cos
    cos, sin = ankle.cos, ankle.sin
    eps2 = creep * creep
    fx = fz = power = jxx = jxz = jzx = jzz = 0.0
    # slices from 0: an index that could be negative would keep the loop from being vectorised
    x, z, area = sole.x[first:last], sole.z[first:last], sole.area[first:last]
    c2, s2 = sole.c2[first:last], sole.s2[first:last]
    if h0 is not None:
        turn = 1.0 / creep
        h0x, h0z = h0[0, first:last], h0[1, first:last]
    if tangent is not None:
        tx, tz, turns = tangent.x[first:last], tangent.z[first:last], tangent.turn[first:last]
        along = ankle.rate * sole.span  # speeds along the normal that differ within a straight plate
        turning2 = eps2 + (SEEN * SEEN - TURN * TURN) * along * along  # eps2 has the part of TURN
    for i in range(len(x)):
        height, vx, vz = motion(ankle, x[i], z[i])
        depth = max(-height, 0.0)
        k = area[i] * depth

        # the direction of motion h = v / |v|: smoothed, or held by the sand's bristles
        if h0 is None:
            q = rsqrt(vx * vx + vz * vz + eps2)
            hx, hz = vx * q, vz * q
        else:
            bent_x, bent_z = h0x[i] + vx * turn, h0z[i] + vz * turn
            square = bent_x * bent_x + bent_z * bent_z
            q = rsqrt(max(square, 1.0))
            hx, hz = bent_x * q, bent_z * q
            slides = 1.0 if square > 1.0 else 0.0
            q *= turn

        # eq. 1: the stress per depth, p = a - M h, with cos and sin of twice the plate's angle in the world
        c = c2[i] * c2p - s2[i] * s2p
        s = s2[i] * c2p + c2[i] * s2p
        mxx = law.C01 + law.C_sum * c
        mxz = law.C_diff * s
        mzx = -law.B_diff * s
        mzz = law.B01 + law.B_sum * c
        turned_x, turned_z = mxx * hx + mxz * hz, mzx * hx + mzz * hz  # M h
        px = -law.D10 * s - turned_x
        pz = law.A00 + law.A10 * c - turned_z

        # effects: the strength over the depth in place of it, a share of the stress, a pressure
        if loads is not None:
            place = ankle.x + cos * x[i] - sin * z[i]
            strength, by_depth, by_x = effects.load(loads, (depth, 1.0, 0.0), depth, place)
            k = area[i] * strength
        if stage is not None:
            sinking = stage * area[i] if depth > 0.0 else 0.0  # -dk/dv_z
            kq = k * q  # dh/dv = (I - h h^T) / |v|
        if tangent is not None:
            nx, nz = sin * tx[i] + cos * tz[i], sin * tz[i] - cos * tx[i]  # outward normal
            vn = vx * nx + vz * nz
        if gates is not None:
            if h0 is None:
                # as wide as the speeds along the normal within a plate, which turns and is bent
                bent = BENT * turns[i]
                bent *= bent
                wide2 = turning2 + bent * (vx * vx + vz * vz)
                narrow = rsqrt(wide2)
                share, by_vn = effects.gate(gates, (1.0, 0.0), vn, wide2 * narrow)
            else:
                share, by_vn = effects.gate(gates, (1.0, 0.0), hx * nx + hz * nz, EDGE)
            if stage is not None:
                if h0 is None:
                    wider = vn * bent * narrow * narrow  # the gate, with the speed
                    gx, gz = nx - wider * vx, nz - wider * vz
                else:
                    sliding = slides * (hx * nx + hz * nz)
                    gx, gz = q * (nx - sliding * hx), q * (nz - sliding * hz)
                jxx += k * by_vn * px * gx
                jxz += k * by_vn * px * gz
                jzx += k * by_vn * pz * gx
                jzz += k * by_vn * pz * gz
                kq *= share
            px, pz = share * px, share * pz
        if pushes is not None:
            push, push_by_vn, push_by_depth = effects.push(pushes, (0.0, 0.0, 0.0), vn, depth)
            fx -= area[i] * push * nx
            fz -= area[i] * push * nz
            power -= area[i] * push * vn
            if stage is not None:
                jxx -= area[i] * push_by_vn * nx * nx
                jxz -= area[i] * push_by_vn * nx * nz - sinking * push_by_depth * nx
                jzx -= area[i] * push_by_vn * nx * nz
                jzz -= area[i] * push_by_vn * nz * nz - sinking * push_by_depth * nz

        # eq. 2, F = sum f with f = p |z| dA, and eq. 7, P = sum f.v
        fx += k * px
        fz += k * pz
        power += k * (px * vx + pz * vz)

        # dF/dV: the place follows the velocity, and h turns
        if stage is not None:
            if loads is not None:
                jxx += sinking * by_x * px
                jzx += sinking * by_x * pz
                sinking *= by_depth
            jxz -= sinking * px
            jzz -= sinking * pz
            if h0 is not None:
                turned_x, turned_z = slides * turned_x, slides * turned_z
            jxx -= kq * (mxx - turned_x * hx)  # M dh/dv = (M - (M h) h^T) / |v|
            jxz -= kq * (mxz - turned_x * hz)
            jzx -= kq * (mzx - turned_z * hx)
            jzz -= kq * (mzz - turned_z * hz)
    return Force(fx, fz, power, jxx, jxz, jzx, jzz)


@inlined
def ankle_of(poses, foot, x, z, vx, vz):
    """Pose of a foot in the world, from its pose relative to the hip, the hip's place and its velocity."""
    pose = pose_of(poses, foot)
    return Pose(x + pose.x, z + pose.z, vx + pose.vx, vz + pose.vz, pose.cos, pose.sin, pose.rate)


@inlined
def submerged(sole, ankle):
    """First and one past the last plate of the blocks that reach below the sand's surface."""
    za, cos, sin = ankle.z, ankle.cos, ankle.sin
    if za > sole.reach:
        return 0, 0
    first, last = 0, len(sole.block_x)
    while first < last and za + _lowest(sole, first, cos, sin) >= 0.0:
        first += 1
    while last > first and za + _lowest(sole, last - 1, cos, sin) >= 0.0:
        last -= 1
    return first * LANES, last * LANES


@inlined
def _lowest(sole, block, cos, sin):
    """Height of the lowest corner of the rectangle around a block of plates, relative to the ankle, m."""
    middle = sin * sole.block_x[block] + cos * sole.block_z[block]
    return middle - abs(sin) * sole.block_dx[block] - abs(cos) * sole.block_dz[block]


@inlined
def contact(world, sole, poses, x, z, vx, vz, creep, stage, h0, counts):
    """Force of the sand on both feet at the hip's place (m) and velocity (m/s).

    Parameters
    ----------
    world : World
        Sand, walker and effects.
    sole : Sole
        The plates of either foot.
    poses : (2 feet, 7)
        Both feet relative to the hip, see `state.pose_of`.
    creep : float, m/s
        eps; with bristles, delta over the time for which they have followed the plates.
    stage : float, s, or None
        dx/dv_x = dz/dv_z: how the place follows from the velocity in an implicit stage. None leaves the
        derivatives out; they are then 0.
    h0 : (2 feet, 2, plates) or None
        Bristles at the beginning of that time.
    counts : record of `COUNTS`
        Of the walk; added to.

    Returns
    -------
    Contact
    """
    counts.evaluations += 1
    left, right = no_force(), no_force()
    for foot in range(2):  # one copy of the loop over plates: what is written twice is compiled twice
        ankle = ankle_of(poses, foot, x, z, vx, vz)
        first, last = submerged(sole, ankle)
        force = no_force()
        if first < last:
            counts.plates += last - first
            force = foot_force(
                sole, world.law, world.loads, world.gates, world.pushes, sole.tangent, first, last, ankle,
                _slip(creep, ankle.rate, sole.span, h0), stage, _of_foot(h0, foot),
            )  # fmt: skip
        left, right = right, force
    return Contact(left, right)


@inlined
def _slip(creep, rate, span, h0):
    """Speed over which the direction of a foot's plates is smoothed, m/s.

    Along a plate that turns, the velocity differs by rate * span; near the centre of the turn, the mean
    direction over the plate is smooth where the direction in its middle jumps. Bristles need no smoothing.
    """
    if h0 is None:
        turn = TURN * rate * span
        return np.sqrt(creep * creep + turn * turn)
    return creep


@inlined
def _of_foot(h0, foot):
    """One foot's bristles, or None."""
    if h0 is None:
        return None
    return h0[foot]
