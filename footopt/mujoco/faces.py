"""The compiled force on the faces of one body at the end of an implicit stage, with its derivatives.

All vectors are in the body's frame: its twist (v of its origin, omega), the faces' places r and the direction
up, which is all that the law depends on of the attitude. A face moves with v + omega x r.

They feel the planar law (`footopt.sand.law`), written with vectors, so that a plate may be tilted
across its motion. With the normal n, up u, <n n> the mean over a bent plate, q = <n n> u, l = q.u (1 for a
level plate, 0 for a wall), c = 2 l - 1, s = -2 (q - l u) and P = 1 - u u, the stress is a - M h::

    a = (A00 + A10 c) u - D10 s
    M = (l (C01 + C_sum) + (1 - l) F) P + (C01 - C_sum - F) P <n n> P
        + C_diff s u - B_diff u s + (B01 + B_sum c) u u,     F = B01 - B_sum

It is the planar law wherever motion, normal and up are in one plane. Elsewhere a wall resists the part of the
motion along its normal, and F is its friction, the same sideways as up and down. (To project a plate into the
plane of its motion instead would give it no direction where the motion is vertical.)
"""

from footopt.compiled import inlined_fast
from footopt.effects import base as effects
from footopt.effects.dual import Dual, lift
from footopt.sand.law import Law
from footopt.walk.contact import rsqrt

EDGE = 0.05  # n.h over which an effect's gate opens; at less, robots on hard sand diverge
#: Rows of a table of faces: place, m; area, m^2; outward normal; <n n>'s xx, xz and zz.
X, Y, Z, AREA, NX, NY, NZ, QXX, QXZ, QZZ, COLUMNS = range(11)


@inlined_fast
def dot(a, b):
    """a . b"""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined_fast
def cross(a, b):
    """a x b"""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined_fast
def times(k, a):
    """k a"""
    return k * a[0], k * a[1], k * a[2]


@inlined_fast
def plus(a, k, b):
    """a + k b"""
    return a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]


@inlined_fast
def moved(faces, h0, i, twist, turn):
    """A face's place, m, its velocity, m/s, and its bristles at the stage's end before they slide."""
    r = faces[X, i], faces[Y, i], faces[Z, i]
    v = plus((twist[0], twist[1], twist[2]), 1.0, cross((twist[3], twist[4], twist[5]), r))
    return r, v, plus((h0[0, i], h0[1, i], h0[2, i]), turn, v)


@inlined_fast
def planar(law, qxx, qxz, qzz, u, h):
    """The planar law's stress per depth, and its derivatives by h, three rows; see the top of this module."""
    q = (qxx * u[0] + qxz * u[2], 0.0, qxz * u[0] + qzz * u[2])
    level = dot(q, u)
    c, s = 2.0 * level - 1.0, times(-2.0, plus(q, -level, u))
    slide = law.B01 - law.B_sum
    flat, wall = level * (law.C01 + law.C_sum) + (1.0 - level) * slide, law.C01 - law.C_sum - slide
    # M = flat 1 + wall <n n> + d u + u e
    d, e = plus(times(law.C_diff, s), -wall, q), plus(times(-law.B_diff, s), -wall, q)
    e = plus(e, wall * level - flat + law.B01 + law.B_sum * c, u)
    by_h = (
        plus(plus((-flat - wall * qxx, 0.0, -wall * qxz), -d[0], u), -u[0], e),
        plus(plus((0.0, -flat, 0.0), -d[1], u), -u[1], e),
        plus(plus((-wall * qxz, 0.0, -flat - wall * qzz), -d[2], u), -u[2], e),
    )
    turned = dot(by_h[0], h), dot(by_h[1], h), dot(by_h[2], h)
    return plus(plus(turned, law.A00 + law.A10 * c, u), -law.D10, s), by_h


@inlined_fast
def by_twist(r, k, by_h, h, slides, sinking, u, throw, n):
    """A row of the derivative of a face's force by the twist, (6,).

    By its velocity: h turns by k (1 - slides h h), it sinks along u and throws sand along n.
    """
    row = plus(plus(times(k, plus(by_h, -slides * dot(by_h, h), h)), sinking, u), -throw, n)
    turned = cross(r, row)
    return row[0], row[1], row[2], turned[0], turned[1], turned[2]


@inlined_fast
def add(total, a, one, b, two):
    """total + a one - b two, (6,)"""
    return (
        total[0] + a * one[0] - b * two[0],
        total[1] + a * one[1] - b * two[1],
        total[2] + a * one[2] - b * two[2],
        total[3] + a * one[3] - b * two[3],
        total[4] + a * one[4] - b * two[4],
        total[5] + a * one[5] - b * two[5],
    )


@inlined_fast
def forces(acting, open, faces, a, u, surface, forward, twist, c, turn, h0):
    """The wrench (6,) on a body about its origin, N and N m, and its derivative (6, 6) by the twist.

    The loop over plates stores nothing, so that it is vectorised: five times faster.

    acting: `Laws` of effects, whose derivatives are here by depth and place, and by n.v and depth. open:
    added to how far a face leads, 0 or enough to open all gates. a: the `footopt.sand.law.Law` times zeta,
    N/m^3. u: up. surface, forward: height and x of a face at the stage's end are the first number, m, plus
    the scalar product of the vector and its place. twist: (6,), at the stage's end. c: length of the stage,
    s. turn: c over delta, s/m. h0: bristles at its beginning.
    """
    law = Law(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8])
    total = k0 = k1 = k2 = k3 = k4 = k5 = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(faces.shape[1]):
        r, v, bent = moved(faces, h0, i, twist, turn)
        n, area = (faces[NX, i], faces[NY, i], faces[NZ, i]), faces[AREA, i]
        depth = max(-surface[0] - dot(surface[1], r), 0.0)
        square = dot(bent, bent)
        q = rsqrt(max(square, 1.0))
        h, slides = times(q, bent), 1.0 if square > 1.0 else 0.0
        p, by_h = planar(law, faces[QXX, i], faces[QXZ, i], faces[QZZ, i], u, h)
        place = forward[0] + dot(forward[1], r)
        load = effects.load(acting.loads, Dual(depth, 1.0, 0.0), Dual(place, 0.0, 1.0))
        gate = lift(effects.gate(acting.gates, Dual(open + dot(h, n) / EDGE, 1.0 / EDGE, 0.0), depth))
        push = lift(effects.push(acting.pushes, Dual(dot(v, n), 1.0, 0.0), Dual(depth, 0.0, 1.0)))
        if acting.gates is not None:
            by_h = (
                plus(times(gate.value, by_h[0]), gate.dx * p[0], n),
                plus(times(gate.value, by_h[1]), gate.dx * p[1], n),
                plus(times(gate.value, by_h[2]), gate.dx * p[2], n),
            )
            p = times(gate.value, p)
        f = plus(times(area * load.value, p), -area * push.value, n)
        torque = cross(r, f)
        total = add(total, 1.0, (f[0], f[1], f[2], torque[0], torque[1], torque[2]), 0.0, total)
        k, throw = area * load.value * q * turn, times(area * push.dx, n)
        w = times(-c * area if depth > 0.0 else 0.0, plus(times(load.dx, p), -push.dz, n))
        x = by_twist(r, k, by_h[0], h, slides, w[0], u, throw[0], n)
        y = by_twist(r, k, by_h[1], h, slides, w[1], u, throw[1], n)
        z = by_twist(r, k, by_h[2], h, slides, w[2], u, throw[2], n)
        k0, k1, k2 = add(k0, 1.0, x, 0.0, x), add(k1, 1.0, y, 0.0, y), add(k2, 1.0, z, 0.0, z)
        k3, k4, k5 = add(k3, r[1], z, r[2], y), add(k4, r[2], x, r[0], z), add(k5, r[0], y, r[1], x)
    return total, (k0, k1, k2, k3, k4, k5)
