"""Which constant forces over a time step bring the feet where sand would bring them.

The law is stiff: sand holds what stands, and a force from the beginning of a step is that of where the body
was. So a step solves the motion of the feet alone over its length, by SDIRK2 (`walk.steppers.implicit`),

    dV/dt = a + W F(V, places),   W = J inv(M + dt D) J'

with the twists V of the bodies near the sand, J their Jacobian, M MuJoCo's inertia, D the damping of joints
and servos that its integrator takes implicitly, and F the sand's wrenches, all in the bodies' own axes. a is
how they accelerate by all but sand: that of the step before, from how their twists changed, less what springs
and dampers of joints and servos pull back since. MuJoCo is given the mean of F.
"""

from __future__ import annotations

import numpy as np

from footopt.compiled import called_fast, inlined_fast
from footopt.effects import Laws
from footopt.mujoco.faces import COLUMNS, cross, dot, forces, moved, plus
from footopt.mujoco.step import BEFORE, END, FREE, GAINED, MEAN, TWIST, inner, of_body, product
from footopt.walk.contact import rsqrt
from footopt.walk.state import write
from footopt.walk.steppers.implicit import SDIRK2

GAMMA = SDIRK2().gamma
MAX_NEWTON = 100  # evaluations of one stage, line search included
TIGHT = 1e-3  # last step of Newton's method over the speed of the feet; forces err by its square


@called_fast
def responses(space, jacobian):
    """inv(M + dt D) J', by L' L along the tree of joints (Featherstone 2008, section 6.5)."""
    freedoms, columns, m, x = space.freedoms, space.columns[0], space.inertia[0].copy(), jacobian.T.copy()
    for freedom in freedoms:
        m[freedom.last] += space.step[0].dt * freedom.implicit
    for k in range(len(freedoms) - 1, -1, -1):
        first, last = freedoms[k].first, freedoms[k].last
        m[last] = 1.0 / m[last]
        for a in range(last - 1, first - 1, -1):
            i = freedoms[columns[a]]
            share = m[last] * m[a]
            for j in range(i.last - i.first + 1):  # ancestors of an ancestor come first in a row
                m[i.first + j] -= share * m[first + j]
            m[a] *= m[last]
            for j in range(x.shape[1]):
                x[columns[a], j] -= m[a] * x[k, j]
    for k in range(len(freedoms)):
        for j in range(x.shape[1]):
            x[k, j] *= m[freedoms[k].last]
        for a in range(freedoms[k].first, freedoms[k].last):
            for j in range(x.shape[1]):
                x[k, j] -= m[a] * x[columns[a], j]
    return x


@inlined_fast
def surface_of(body, axes, way):
    """Height of a body's origin at a stage's end, where it has moved on its way, and up in its axes."""
    up, turned = (axes[6], axes[7], axes[8]), (way[3], way[4], way[5])
    return body.height + dot(up, (way[0], way[1], way[2])), plus(up, -1.0, cross(turned, up))


@called_fast
def solution(mobility, stiffness, c, rest, a, y):
    """Solve (1 - c W dF/dV) y = c W rest by elimination with pivots, in the room a (n, n + 1).

    That takes a quarter of LAPACK's time, and nothing is allocated: arrays cost as much as what is in them.
    """
    n = len(y)
    for i in range(n):
        for first in range(0, n, 6):  # a wrench follows the twist of its own body
            for j in range(6):
                a[i, first + j] = 0.0
            for m in range(first, first + 6):
                share = -c * mobility[i, m]
                for j in range(6):
                    a[i, first + j] += share * stiffness[m, j]
        a[i, i] += 1.0
        a[i, n] = c * inner(mobility[i], rest)
    for i in range(n):
        best = i
        for j in range(i + 1, n):
            if abs(a[j, i]) > abs(a[best, i]):
                best = j
        if best != i:
            for m in range(i, n + 1):
                a[i, m], a[best, m] = a[best, m], a[i, m]
        inverse = 1.0 / a[i, i]
        for j in range(i + 1, n):
            factor = a[j, i] * inverse
            for m in range(i, n + 1):
                a[j, m] -= factor * a[i, m]
    for i in range(n - 1, -1, -1):
        y[i] = (a[i, n] - inner(a[i, i + 1 : n], y[i + 1 :])) / a[i, i]


@called_fast
def newton(space, effects, near, mobility, base, v0, v, c, turn, h0, f):
    """Solve v = v0 + c W f, f = F(v), for the near bodies' twists v and wrenches, from f; whether it can be.

    Sand resists motion, so that dv . (F - f) falls along a step dv: a step is cut where it changes its sign,
    as where a face comes to rest. The size of F - f rises there.
    """
    n, load, meshed = len(v), f.copy(), Laws(effects.loads, None, effects.pushes)
    stiffness, wide, dv, dload = np.zeros((n, 6)), np.ones(n), np.zeros(n), np.zeros(n)
    way, rest, room = np.zeros(n), np.zeros(n), np.zeros((n, n + 1))
    slope, t, low, high, at_low, at_high = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # of a step: 0 before, 1 in full
    for i in range(n):
        wide[i] = space.bodies[near[i // 6]].reach if i % 6 > 2 else 1.0  # makes speeds of twists
    write(v, v0 + c * product(mobility, load))
    for _ in range(MAX_NEWTON):
        space.step[0].evaluations += 1
        for i in range(n):
            way[i] = base[i] + c * v[i]
        for k in range(len(near)):
            body, axes, six = space.bodies[near[k]], space.frame[near[k]], slice(6 * k, 6 * k + 6)
            up, x = (axes[6], axes[7], axes[8]), (axes[0], axes[1], axes[2])
            surface, forward = surface_of(body, axes, way[six]), (space.places[body.row, 0], x)
            faces, h = of_body(space.faces[0], body, COLUMNS), of_body(h0, body, 3)
            state = faces, body.law, up, surface, forward, v[six], c, turn, h
            if body.mesh:
                total, rows = forces(body.friction, meshed, *state)
            else:
                total, rows = forces(None, effects, *state)
            for i in range(6):
                f[6 * k + i] = total[i]
                for j in range(6):
                    stiffness[6 * k + i, j] = rows[i][j]
        for i in range(n):
            rest[i] = f[i] - load[i]
        gain = inner(dv, rest)
        if abs(gain) > 0.5 * slope > 0.0 and high - low > 1e-12 and (gain < 0.0 or t < 1.0):
            if gain < 0.0:
                high, at_high = t, gain
            else:
                low, at_low, at_high = t, gain, 0.5 * at_high
            share = low + (high - low) * at_low / (at_low - at_high) - t
        else:
            solution(mobility, stiffness, c, rest, room, dv)
            for i in range(n):
                dload[i] = rest[i] + inner(stiffness[i], dv[i - i % 6 :])
            at_low = slope = inner(dv, rest)
            share, t, low, high, at_high = 1.0, 0.0, 0.0, 1.0, 0.0
        t += share
        speed, change = 0.1 / turn, 0.0
        for i in range(n):
            v[i] += share * dv[i]
            load[i] += share * dload[i]
            speed, change = max(speed, abs(wide[i] * v[i])), max(change, abs(wide[i] * dv[i]))
        if share == 1.0 and change <= TIGHT * speed + 1e-13:
            write(f, load)  # forces follow the last change to first order
            return True
    return False


@called_fast
def stage(space, effects, near, mobility, base, v0, v, c, before, after, share, f):
    """Solve an implicit stage of length c; bend bristles from before to after by a share, 0 in the air."""
    turn = c / space.step[0].length
    if not newton(space, effects, near, mobility, base, v0, v, c, turn, before, f):
        space.step[0].failures += 1
    way = base + c * v
    for k in range(len(near)):
        body, twist = space.bodies[near[k]], v[6 * k : 6 * k + 6]
        surface = surface_of(body, space.frame[near[k]], way[6 * k : 6 * k + 6])
        faces, h, new = (
            of_body(space.faces[0], body, COLUMNS),
            of_body(before, body, 3),
            of_body(after, body, 3),
        )
        for i in range(faces.shape[1]):
            r, _, bent = moved(faces, h, i, twist, turn)
            q = rsqrt(max(dot(bent, bent), 1.0))
            inside = 1.0 if surface[0] + dot(surface[1], r) < 0.0 else 0.0
            for a in range(3):
                new[a, i] = inside * (h[a, i] + share * (bent[a] * q - h[a, i]))


@called_fast
def solve(space, effects):
    """Find the mean wrenches of a step on the bodies."""
    dt, vectors, h = space.step[0].dt, space.vectors, space.bristles
    c, r, near = GAMMA * dt, (1.0 - GAMMA) * dt, np.flatnonzero(space.bodies.near)
    rows = (6 * near.reshape(-1, 1) + np.arange(6)).ravel()
    jacobian = space.jacobian[rows]
    answer = responses(space, jacobian)
    mobility = jacobian @ answer
    v0, a = vectors[TWIST][rows], vectors[FREE][rows] - product(answer.T, space.freedoms["pull"])
    base, one, two, f1 = -0.5 * dt * v0, np.zeros(len(v0)), np.zeros(len(v0)), vectors[BEFORE][rows]
    stage(space, effects, near, mobility, base, v0 + c * a, one, c, h[0], h[1], r / c, f1)
    f2, start = f1.copy(), v0 + dt * a + r * product(mobility, f1)
    stage(space, effects, near, mobility, base + r * one, start, two, c, h[1], h[2], 1.0, f2)
    mean = (1.0 - GAMMA) * f1 + GAMMA * f2
    for i in range(len(rows)):
        vectors[MEAN, rows[i]], vectors[END, rows[i]] = mean[i], f2[i]
    write(vectors[GAINED], product(space.jacobian, product(answer, mean)))
    for k in range(len(near)):
        body, six = space.bodies[near[k]], slice(6 * k, 6 * k + 6)
        body.power = np.sum(f2[six] * two[six])
        body.pending = r * np.sum(f1[six] * one[six]) + c * body.power
