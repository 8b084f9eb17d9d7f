"""One time step of MuJoCo on sand: which constant forces bring the feet where sand would bring them.

The law is stiff: sand holds what stands, and a force from the beginning of a step is that of where the body
was. So a step solves the motion of the feet alone over its length, by SDIRK2 (`walk.steppers.sdirk2`),

    dV/dt = a + W F(V, places),   W = J inv(M + dt D) J'

with the twists V of the bodies near the sand, J their Jacobian, M MuJoCo's inertia, D the damping that its
integrator takes implicitly, of joints and servos, and F the sand's wrenches, all in the bodies' own axes. a is how they accelerate by all but sand: that of the step before, from how their
twists changed. MuJoCo is given the mean of F. Where constraints and stiff springs make bodies heavier than W
says, a is corrected more slowly.

MuJoCo's Euler and implicit steps move places by the new velocity, which is the leapfrog: velocities belong
to the middle of steps, and to places half a step back. RK4's belong to the same time.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from footopt.compiled import FAST, cached_njit, inlined, inlined_fast
from footopt.mujoco.faces import COLUMNS, X, Y, Z, cross, dot, forces, moved, plus
from footopt.walk.contact import rsqrt
from footopt.walk.state import write

AGAIN, NEW, HOLD, RESTART = range(4)
GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
MAX_NEWTON = 100  # evaluations of one stage, back-tracking included
TIGHT = 1e-3  # last step of Newton's method over the speed of the feet; forces err by its square

COUNTED = ("steps", "evaluations", "failures", "restarts")
#: A step of MuJoCo.
STEP = np.dtype(
    [
        ("start", float),  # s; -inf before the first one
        ("dt", float),  # s
        ("rk4", np.int64),  # 1 where the integrator is RK4, 0 elsewhere
        ("seen", np.int64),  # of RK4's stages: 1 once the step's middle has been called for, 2 once its end
        ("length", float),  # over which bristles bend, m
        ("gravity", float, 3),  # m/s^2
        *[(name, np.int64) for name in COUNTED],
    ]
)

#: A body on the sand.
BODY = np.dtype(
    [
        ("row", np.int64),  # in MuJoCo
        ("first", np.int64),  # of its faces
        ("last", np.int64),  # one past the last of them
        ("mesh", np.int64),  # 1 for a mesh, 0 for a sole
        ("law", float, 9),  # N/m^3: `sand.law.Law`, or xi
        ("friction", float),  # of a mesh's surface
        ("reach", float),  # of its farthest face, m
        ("near", np.int64),  # 1 if it may touch sand within the step
        ("height", float),  # of its origin in the middle of the step, m
        ("power", float),  # of the sand at the step's end, W
        ("pending", float),  # its work over the step, J
        ("work", float),  # over the steps before, J
        ("depth", float),  # of the deepest face at the step's beginning, m
    ]
)

#: A degree of freedom of MuJoCo's, in radians or metres.
FREEDOM = np.dtype(
    [
        ("first", np.int64),  # of its row in the sparse inertia
        ("last", np.int64),  # of its row: the diagonal's element
        ("implicit", float),  # damping that MuJoCo's integrator adds to the inertia, N m s
        ("damping", float),  # of joint and servos, N m s
        ("stiffness", float),  # N m
        ("speed", float),  # 1/s
        ("pull", float),  # by which damping and stiffness pull back more than in the step before, N m
    ]
)

#: Rows of `Workspace.vectors`: twists at the beginning, m/s and rad/s; accelerations over the step before, by
#: all but the sand, and by the sand; mean wrenches that MuJoCo is given, N and N m, and those at the end.
TWIST, BEFORE, FREE, GAINED, MEAN, END = range(6)


class Workspace(NamedTuple):
    """All that a step reads and writes: MuJoCo's own arrays, and those of b bodies with p faces."""

    step: Any  # (1,) of `STEP`
    bodies: Any  # (b,) of `BODY`
    freedoms: Any  # (nv,) of `FREEDOM`
    columns: Any  # (1, nC): of MuJoCo's inertia
    inertia: Any  # (1, nC): MuJoCo's
    places: Any  # (nbody, 3), m: MuJoCo's xpos
    attitude: Any  # (nbody, 9): xmat
    velocity: Any  # (1, nv): qvel
    passive: Any  # (1, nv): qfrc_passive
    faces: Any  # (1, 10 p): `faces.X` and so on, a body's as (10, its faces)
    bristles: Any  # (3, 3 p): at the step's beginning, middle, end
    vectors: Any  # (6, 6 b): of the bodies' origins in their own axes, linear, then angular; see `TWIST`
    jacobian: Any  # (6 b, nv): of all bodies; `align` turns it
    answer: Any  # (6 b, nv): inv(M + dt D) J', where a body is near the sand
    frame: Any  # (b, 9): as attitude, in the middle of the step


@inlined
def meaning_of(step, time):
    """What a call at a time means: the same step AGAIN, a NEW one, a stage of RK4 to HOLD, or a RESTART."""
    passed = (time - step.start) / step.dt
    if abs(passed) < 1e-6:
        return AGAIN
    ends = abs(passed - 1.0) < 1e-6
    if step.rk4 and (abs(passed - 0.5) < 1e-6 or (ends and step.seen == 1)):
        step.seen = 2 if ends else 1
        return HOLD
    step.start, step.seen = time, 0
    return NEW if ends else RESTART


@inlined
def of_body(table, body, rows):
    """A body's part of a flat table of all faces, (rows, its faces)."""
    return table[rows * body.first : rows * body.last].reshape(rows, body.last - body.first)


@inlined_fast
def product(a, x):
    """a x: of few numbers, in a third of BLAS's time."""
    out = np.zeros(len(a))
    for i in range(len(a)):
        for j in range(len(x)):
            out[i] += a[i, j] * x[j]
    return out


@inlined_fast
def align(space):
    """Turn the Jacobian from the world's axes to the bodies' own ones in the middle of the step."""
    for i in range(0, len(space.jacobian), 3):
        rows, axes = space.jacobian[i : i + 3], space.frame[i // 6]
        for j in range(rows.shape[1]):
            row = rows[0, j], rows[1, j], rows[2, j]
            for a in range(3):
                rows[a, j] = dot((axes[a], axes[3 + a], axes[6 + a]), row)


@cached_njit(nogil=True, error_model="numpy", fastmath=FAST)
def begin(space, meaning):
    """Begin a step, after a RESTART with all sunk straight down; whether a body may touch sand."""
    step, vectors, twist = space.step[0], space.vectors, product(space.jacobian, space.velocity[0])
    late = 0.5 * step.dt * step.rk4  # from MuJoCo's places to the middle
    for b in range(len(space.bodies)):
        body, (_, _, vz, wx, wy, wz) = space.bodies[b], twist[6 * b : 6 * b + 6]
        axes, height, frame = space.attitude[body.row], space.places[body.row, 2], space.frame[b]
        for a in range(3):
            axis = axes[a], axes[3 + a], axes[6 + a]
            frame[a], frame[3 + a], frame[6 + a] = plus(axis, late, cross((wx, wy, wz), axis))
        body.height = height + late * vz
        margin, low = 2.0 * step.dt * (abs(vz) + (abs(wx) + abs(wy)) * body.reach + 10.0 * step.dt), np.inf
        if height - body.reach < margin:
            faces, up = of_body(space.faces[0], body, COLUMNS), (axes[6], axes[7], axes[8])
            for i in range(faces.shape[1]):
                low = min(low, height + dot(up, (faces[X, i], faces[Y, i], faces[Z, i])))
        body.depth, body.near = max(-low, 0.0), low < margin
        if meaning == NEW:
            body.work += body.pending
        elif meaning == RESTART:
            for a in range(3):
                of_body(space.bristles[2], body, 3)[a] = -frame[6 + a]
        body.power = body.pending = 0.0
    align(space)
    twist = product(space.jacobian, space.velocity[0])
    if meaning == NEW:
        step.steps += 1
        write(vectors[BEFORE], (twist - vectors[TWIST]) / step.dt)  # `=` compiles for seconds
        write(vectors[FREE], vectors[BEFORE] - vectors[GAINED])
    elif meaning == RESTART:
        step.restarts += 1
        vectors[BEFORE:] = 0.0
        for b in range(len(space.bodies)):
            write(vectors[FREE, 6 * b : 6 * b + 3], step.gravity @ space.frame[b].reshape(3, 3))
    write(vectors[TWIST], twist)
    if meaning != AGAIN:
        for freedom, speed in zip(space.freedoms, space.velocity[0]):
            pull = freedom.damping * (speed - freedom.speed) + step.dt * freedom.stiffness * speed
            freedom.pull, freedom.speed = pull if meaning == NEW else 0.0, speed
        write(space.bristles[0], space.bristles[2])
    vectors[GAINED:] = space.bristles[2] = 0.0
    return np.any(space.bodies.near)


@cached_njit(nogil=True, error_model="numpy", fastmath=FAST)
def respond(space):
    """Solve (M + dt D) answer = J', by L' L along the tree of joints (Featherstone 2008, section 6.5)."""
    freedoms, columns, m = space.freedoms, space.columns[0], space.inertia[0].copy()
    for freedom in freedoms:
        m[freedom.last] += space.step[0].dt * freedom.implicit
    for k in range(len(freedoms) - 1, -1, -1):
        first, last = freedoms[k].first, freedoms[k].last
        m[last] = 1.0 / m[last]
        for a in range(last - 1, first - 1, -1):
            i = freedoms[columns[a]]
            for j in range(i.last - i.first + 1):  # ancestors of an ancestor come first in a row
                m[i.first + j] -= m[last] * m[a] * m[first + j]
        for a in range(first, last):
            m[a] *= m[last]
    for row in range(len(space.answer)):
        x = space.answer[row]
        write(x, space.jacobian[row])
        for k in range(len(freedoms) - 1, -1, -1):
            if x[k] != 0.0:
                for a in range(freedoms[k].first, freedoms[k].last):
                    x[columns[a]] -= m[a] * x[k]
        for k in range(len(freedoms)):
            x[k] *= m[freedoms[k].last]
            for a in range(freedoms[k].first, freedoms[k].last):
                x[k] -= m[a] * x[columns[a]]


@inlined_fast
def surface_of(body, axes, way):
    """Height of a body's origin at a stage's end, where it has moved on its way, and up in its axes."""
    up, turned = (axes[6], axes[7], axes[8]), (way[3], way[4], way[5])
    return body.height + dot(up, (way[0], way[1], way[2])), plus(up, -1.0, cross(turned, up))


@cached_njit(nogil=True, error_model="numpy", fastmath=FAST)
def solution(mobility, stiffness, c, x):
    """Solve (1 - c W dF/dV) y = x by elimination with pivots, which takes a quarter of LAPACK's time."""
    n, a = len(x), np.eye(len(x), len(x) + 1)
    write(a[:, n], x)
    for i in range(n):
        for j in range(n):
            o = j - j % 6  # a wrench follows the twist of its own body
            for m in range(6):
                a[i, j] -= c * mobility[i, o + m] * stiffness[o + m, j - o]
    for i in range(n):
        best = i
        for j in range(i + 1, n):
            if abs(a[j, i]) > abs(a[best, i]):
                best = j
        if best != i:
            for m in range(n + 1):
                a[i, m], a[best, m] = a[best, m], a[i, m]
        for j in range(i + 1, n):
            factor = a[j, i] / a[i, i]
            for m in range(n + 1):
                a[j, m] -= factor * a[i, m]
    for i in range(n - 1, -1, -1):
        for m in range(i + 1, n):
            a[i, n] -= a[i, m] * a[m, n]
        a[i, n] /= a[i, i]
    return a[:, n]


@cached_njit(nogil=True, error_model="numpy", fastmath=FAST)
def newton(space, effects, near, mobility, base, v0, v, c, turn, h0, f):
    """Solve v = v0 + c W F(v) for the twists v of the near bodies; whether it could be. f: their wrenches."""
    n, best, (loads, gates, pushes) = len(v), np.inf, effects
    stiffness, wide, dv = np.zeros((n, 6)), np.ones(n), np.zeros(n)
    for k in range(len(near)):
        wide[6 * k + 3 : 6 * k + 6] = space.bodies[near[k]].reach  # makes speeds of twists
    for _ in range(MAX_NEWTON):
        space.step[0].evaluations += 1
        way = base + c * v
        for k in range(len(near)):
            body, axes, six = space.bodies[near[k]], space.frame[near[k]], slice(6 * k, 6 * k + 6)
            up, x = (axes[6], axes[7], axes[8]), (axes[0], axes[1], axes[2])
            surface, forward = surface_of(body, axes, way[six]), (space.places[body.row, 0], x)
            faces, h = of_body(space.faces[0], body, COLUMNS), of_body(h0, body, 3)
            state = faces, body.law, up, surface, forward, v[six], c, turn, h
            if body.mesh:
                total, rows = forces(body.friction, loads, None, pushes, *state)
            else:
                total, rows = forces(None, loads, gates, pushes, *state)
            for i in range(6):
                f[6 * k + i] = total[i]
                for j in range(6):
                    stiffness[6 * k + i, j] = rows[i][j]
        rest = v0 - v + c * product(mobility, f)
        size = np.sum((wide * rest) ** 2)
        if not size <= best:  # nor NaN: go back half of the way, unless only rounding is left
            dv *= 0.5
            v -= dv
            if np.max(np.abs(wide * dv)) < 1e-14 * np.max(np.abs(v)):
                best = np.inf
            continue
        best = size
        dv = solution(mobility, stiffness, c, rest)
        v += dv
        if np.max(np.abs(wide * dv)) <= TIGHT * max(0.1 / turn, np.max(np.abs(wide * v))) + 1e-13:
            for i in range(n):  # forces follow the last change to first order
                for j in range(6):
                    f[i] += stiffness[i, j] * dv[i - i % 6 + j]
            return True
    return False


@cached_njit(nogil=True, error_model="numpy", fastmath=FAST)
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


@cached_njit(nogil=True, error_model="numpy")
def solve(space, effects):
    """Find the mean wrenches of a step on the bodies."""
    dt, vectors, h = space.step[0].dt, space.vectors, space.bristles
    c, r, near = GAMMA * dt, (1.0 - GAMMA) * dt, np.flatnonzero(space.bodies.near)
    rows = (6 * near.reshape(-1, 1) + np.arange(6)).ravel()
    respond(space)
    answer = space.answer[rows]
    mobility = space.jacobian[rows] @ answer.T
    v0, a = vectors[TWIST][rows], vectors[FREE][rows] - product(answer, space.freedoms["pull"])
    base, one, f1, f2 = -0.5 * dt * v0, v0 + c * vectors[BEFORE][rows], np.zeros(len(v0)), np.zeros(len(v0))
    stage(space, effects, near, mobility, base, v0 + c * a, one, c, h[0], h[1], r / c, f1)
    two, start = v0 + (one - v0) / GAMMA, v0 + dt * a + r * product(mobility, f1)
    stage(space, effects, near, mobility, base + r * one, start, two, c, h[1], h[2], 1.0, f2)
    mean = (1.0 - GAMMA) * f1 + GAMMA * f2
    for i in range(len(rows)):
        vectors[MEAN, rows[i]], vectors[END, rows[i]] = mean[i], f2[i]
    write(vectors[GAINED], product(space.jacobian, product(answer.T, mean)))
    for k in range(len(near)):
        body, six = space.bodies[near[k]], slice(6 * k, 6 * k + 6)
        body.power = np.sum(f2[six] * two[six])
        body.pending = r * np.sum(f1[six] * one[six]) + c * body.power
