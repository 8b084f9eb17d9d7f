"""The compiled force on the faces of one body at the end of an implicit stage, with its derivatives.

All vectors are in the body's frame: its twist (v of its origin, omega), the faces' places r and the direction
up, which is all that the law must know of the attitude. A face moves with v + omega x r.

*Soles* feel the planar law (`footopt.sand.law.affine`), written with vectors so that it holds in any vertical
plane. With the normal n, up u, q = <n n> u, c = 2 q.u - 1 and s = -2 (q - (q.u) u), which are cos 2 beta and
sin 2 beta (along the surface) of the plane::

    a = (A00 + A10 c) u - D10 s
    M = (C01 + C_sum c) (1 - u u) + C_diff s u - B_diff u s + (B01 + B_sum c) u u

It is the planar law wherever motion, normal and up are in one plane, as for every motion of a level plate;
a plate that is tilted across its motion keeps its tilt, which the planar law does not know. <n n> is the mean
over a bent plate. *Meshes* feel 3D-RFT (`footopt.mujoco.intrusion`).
"""

from __future__ import annotations

import numpy as np

from footopt.compiled import inlined, inlined_fast
from footopt.effects import base as effects
from footopt.mujoco.intrusion import stress
from footopt.walk.contact import EDGE, rsqrt

#: Rows of a table of faces: place, m; area, m^2; outward normal; <n n>'s xx, xz and zz.
X, Y, Z, AREA, NX, NY, NZ, QXX, QXZ, QZZ = range(10)
NUDGE = 1e-5  # of h, over which 3D-RFT's derivative is taken


@inlined_fast
def bent(faces, h0, i, twist, turn):
    """A face's bristles at the stage's end before they slide, and its velocity, m/s."""
    x, y, z = faces[X, i], faces[Y, i], faces[Z, i]
    vx = twist[0] + twist[4] * z - twist[5] * y
    vy = twist[1] + twist[5] * x - twist[3] * z
    vz = twist[2] + twist[3] * y - twist[4] * x
    return h0[0, i] + vx * turn, h0[1, i] + vy * turn, h0[2, i] + vz * turn, vx, vy, vz


@inlined_fast
def at(plane, faces, i):
    """A quantity that is linear in the place, at a face."""
    return plane[0] + plane[1] * faces[X, i] + plane[2] * faces[Y, i] + plane[3] * faces[Z, i]


@inlined_fast
def sole_forces(faces, law, loads, gates, pushes, up, surface, forward, twist, c, turn, h0, f, d):
    """Forces on a sole's plates, f (3, plates), N, and their derivatives by velocity, d (9, plates), N s/m.

    law: `footopt.sand.law.Law` times zeta, N/m^3. loads, gates, pushes: laws of effects, or None. up: (3,).
    surface, forward: height and x of a face at the stage's end are the first number, m, plus the other three
    times its place. twist: (6,), at the stage's end. c: its length, s. turn: c over delta, s/m. h0: bristles.
    """
    a00, a10, b01, b_sum, b_diff = law[0], law[1], law[2], law[3], law[4]
    c01, c_sum, c_diff, d10 = law[5], law[6], law[7], law[8]
    ux, uy, uz = up[0], up[1], up[2]
    for i in range(faces.shape[1]):
        bx, by, bz, vx, vy, vz = bent(faces, h0, i, twist, turn)
        square = bx * bx + by * by + bz * bz
        q = rsqrt(max(square, 1.0))
        hx, hy, hz = bx * q, by * q, bz * q
        slides = 1.0 if square > 1.0 else 0.0
        depth = max(-at(surface, faces, i), 0.0)
        area = faces[AREA, i]

        qx, qz = faces[QXX, i] * ux + faces[QXZ, i] * uz, faces[QXZ, i] * ux + faces[QZZ, i] * uz
        qu = qx * ux + qz * uz
        c2 = 2.0 * qu - 1.0
        sx, sy, sz = -2.0 * (qx - qu * ux), 2.0 * qu * uy, -2.0 * (qz - qu * uz)
        level, upright = c01 + c_sum * c2, b01 + b_sum * c2
        hu = hx * ux + hy * uy + hz * uz
        sh = sx * hx + sy * hy + sz * hz
        along = a00 + a10 * c2 + b_diff * sh - (upright - level) * hu
        across = d10 + c_diff * hu
        px = along * ux - across * sx - level * hx
        py = along * uy - across * sy - level * hy
        pz = along * uz - across * sz - level * hz

        k, by_depth, share, by_gate, push, push_by_vn, push_by_depth = depth, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0
        nx, ny, nz = faces[NX, i], faces[NY, i], faces[NZ, i]
        if loads is not None:
            k, by_depth, _ = effects.load(loads, (depth, 1.0, 0.0), depth, at(forward, faces, i))
        if gates is not None:
            share, by_gate = effects.gate(gates, (1.0, 0.0), hx * nx + hy * ny + hz * nz, EDGE)
        if pushes is not None:
            vn = vx * nx + vy * ny + vz * nz
            push, push_by_vn, push_by_depth = effects.push(pushes, (0.0, 0.0, 0.0), vn, depth)
        k *= area
        f[0, i] = k * share * px - area * push * nx
        f[1, i] = k * share * py - area * push * ny
        f[2, i] = k * share * pz - area * push * nz

        # by h: share M, and the gate; h turns with v: dh/dv = turn (1 - slides h h) / max(1, |u|)
        kq = k * q * turn
        gx, gy, gz = by_gate * px, by_gate * py, by_gate * pz
        jump = upright - level
        # rows of df/dh before sliding
        xx = share * (b_diff * ux * sx - jump * ux * ux - c_diff * sx * ux - level) + gx * nx
        xy = share * (b_diff * ux * sy - jump * ux * uy - c_diff * sx * uy) + gx * ny
        xz = share * (b_diff * ux * sz - jump * ux * uz - c_diff * sx * uz) + gx * nz
        yx = share * (b_diff * uy * sx - jump * uy * ux - c_diff * sy * ux) + gy * nx
        yy = share * (b_diff * uy * sy - jump * uy * uy - c_diff * sy * uy - level) + gy * ny
        yz = share * (b_diff * uy * sz - jump * uy * uz - c_diff * sy * uz) + gy * nz
        zx = share * (b_diff * uz * sx - jump * uz * ux - c_diff * sz * ux) + gz * nx
        zy = share * (b_diff * uz * sy - jump * uz * uy - c_diff * sz * uy) + gz * ny
        zz = share * (b_diff * uz * sz - jump * uz * uz - c_diff * sz * uz - level) + gz * nz
        tx, ty, tz = xx * hx + xy * hy + xz * hz, yx * hx + yy * hy + yz * hz, zx * hx + zy * hy + zz * hz
        tx, ty, tz = slides * tx, slides * ty, slides * tz
        sinking = -c * area if depth > 0.0 else 0.0  # d(area depth)/d(v.u)
        wx = sinking * (by_depth * share * px - push_by_depth * nx)
        wy = sinking * (by_depth * share * py - push_by_depth * ny)
        wz = sinking * (by_depth * share * pz - push_by_depth * nz)
        throw = area * push_by_vn
        d[0, i] = kq * (xx - tx * hx) + wx * ux - throw * nx * nx
        d[1, i] = kq * (xy - tx * hy) + wx * uy - throw * nx * ny
        d[2, i] = kq * (xz - tx * hz) + wx * uz - throw * nx * nz
        d[3, i] = kq * (yx - ty * hx) + wy * ux - throw * ny * nx
        d[4, i] = kq * (yy - ty * hy) + wy * uy - throw * ny * ny
        d[5, i] = kq * (yz - ty * hz) + wy * uz - throw * ny * nz
        d[6, i] = kq * (zx - tz * hx) + wz * ux - throw * nz * nx
        d[7, i] = kq * (zy - tz * hy) + wz * uy - throw * nz * ny
        d[8, i] = kq * (zz - tz * hz) + wz * uz - throw * nz * nz


@inlined
def mesh_forces(faces, law, loads, pushes, up, surface, forward, twist, c, turn, h0, f, d):
    """`sole_forces` for the faces of a mesh, by 3D-RFT; law: xi, N/m^3, and the surface's friction."""
    u = np.empty(3)
    for i in range(faces.shape[1]):
        bx, by, bz, vx, vy, vz = bent(faces, h0, i, twist, turn)
        for a in range(9):
            f[a // 3, i] = d[a, i] = 0.0
        depth = -at(surface, faces, i)
        if depth <= 0.0:
            continue
        n = (faces[NX, i], faces[NY, i], faces[NZ, i])
        area, strength, by_depth = faces[AREA, i], depth, 1.0
        if loads is not None:
            strength, by_depth, _ = effects.load(loads, (depth, 1.0, 0.0), depth, at(forward, faces, i))
        u[0], u[1], u[2] = bx, by, bz
        p = stress(n, _inside(u), up, law[1])
        push, push_by_vn, push_by_depth = 0.0, 0.0, 0.0
        if pushes is not None:
            vn = vx * n[0] + vy * n[1] + vz * n[2]
            push, push_by_vn, push_by_depth = effects.push(pushes, (0.0, 0.0, 0.0), vn, depth)
        k = law[0] * area
        for a in range(3):
            f[a, i] = k * strength * p[a] - area * push * n[a]
        for b in range(3):
            u[b] += NUDGE
            there = stress(n, _inside(u), up, law[1])
            u[b] -= NUDGE
            for a in range(3):
                sinking = -c * up[b] * (k * by_depth * p[a] - area * push_by_depth * n[a])
                turning = k * strength * turn * (there[a] - p[a]) / NUDGE
                d[3 * a + b, i] = turning + sinking - area * push_by_vn * n[a] * n[b]


@inlined
def _inside(u):
    """The return map: u / max(1, |u|)."""
    q = 1.0 / np.sqrt(max(u[0] * u[0] + u[1] * u[1] + u[2] * u[2], 1.0))
    return u[0] * q, u[1] * q, u[2] * q


@inlined_fast
def wrench_of(faces, f, out):
    """Force and torque about the body's origin of the forces on its faces, into out (6,)."""
    fx = fy = fz = tx = ty = tz = 0.0
    for i in range(faces.shape[1]):
        x, y, z = faces[X, i], faces[Y, i], faces[Z, i]
        fx += f[0, i]
        fy += f[1, i]
        fz += f[2, i]
        tx += y * f[2, i] - z * f[1, i]
        ty += z * f[0, i] - x * f[2, i]
        tz += x * f[1, i] - y * f[0, i]
    out[0], out[1], out[2], out[3], out[4], out[5] = fx, fy, fz, tx, ty, tz


@inlined
def stiffness_of(s, out):
    """dF/dV of the wrench by the twist, into out (6, 6), from the faces' derivatives.

    With A = (1, -[r]x) it is the sum of A' D A. s: (9, 10), D times 1, x, y, z, xx, xy, xz, yy, yz, zz:
    one product of matrices makes all sums over faces.
    """
    second = ((4, 5, 6), (5, 7, 8), (6, 8, 9))
    for a in range(3):
        a1, a2 = (a + 1) % 3, (a + 2) % 3
        for b in range(3):
            b1, b2 = (b + 1) % 3, (b + 2) % 3
            out[a, b] = s[3 * a + b, 0]
            # v_b of omega: v_b1 += omega_b r_b2 ..., so column b takes D's columns b1 and b2
            out[a, 3 + b] = s[3 * a + b2, 1 + b1] - s[3 * a + b1, 1 + b2]
            out[3 + a, b] = s[3 * a2 + b, 1 + a1] - s[3 * a1 + b, 1 + a2]
            out[3 + a, 3 + b] = (
                s[3 * a2 + b2, second[a1][b1]] - s[3 * a2 + b1, second[a1][b2]]
                - s[3 * a1 + b2, second[a2][b1]] + s[3 * a1 + b1, second[a2][b2]]
            )  # fmt: skip
