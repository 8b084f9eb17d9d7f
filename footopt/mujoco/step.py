"""One time step of MuJoCo on sand: which constant forces bring the feet where sand would bring them.

The law is stiff: sand holds what stands, and a force from the beginning of a step is that of where the body
was. So a step solves the motion of the feet alone over its length, by SDIRK2 (`walk.steppers.sdirk2`),

    dV/dt = a + W F(V, places),   W = J inv(M) J'

with the twists V of the bodies, J their Jacobian, M MuJoCo's inertia and F the sand's wrenches, all in the
bodies' own axes. a is how they accelerate by all but sand: that of the step before, from how their twists
changed. MuJoCo is given the mean of F. Constraints and servos make bodies heavier than W says, which slows
the correction of a.

MuJoCo's Euler and implicit steps move places by the new velocity, which is the leapfrog: velocities belong
to the middle of steps, and to places half a step back. RK4's belong to the same time.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from footopt.compiled import FAST, cached_njit, inlined
from footopt.mujoco.faces import COLUMNS, X, Y, Z, cross, dot, forces, moved, plus

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

#: Rows of `Workspace.vectors`: the twists at the beginning, m/s and rad/s; accelerations by all but the
#: sand, and by the sand; the mean wrenches that MuJoCo is given, N and N m, and those at the step's end.
TWIST, FREE, GAINED, MEAN, END = range(5)


class Workspace(NamedTuple):
    """All that a step reads and writes: MuJoCo's own arrays, and those of b bodies with p faces."""

    step: Any  # (1,) of `STEP`
    bodies: Any  # (b,) of `BODY`
    places: Any  # (nbody, 3), m: MuJoCo's xpos
    attitude: Any  # (nbody, 9): xmat
    velocity: Any  # (1, nv): qvel
    passive: Any  # (1, nv): qfrc_passive
    faces: Any  # (1, 10 p): `faces.X` and so on, a body's as (10, its faces)
    bristles: Any  # (3, 3 p): at the step's beginning, middle, end
    vectors: Any  # (5, 6 b): of the bodies' origins in the world's axes, linear, then angular; see `TWIST`
    jacobian: Any  # (6 b, nv): of all bodies, in the world's axes
    answer: Any  # (6 b, nv): inv(M) J'; 0 for bodies in the air
    frame: Any  # (6 b, 6 b): turns all vectors from the bodies' axes to the world's


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


@cached_njit(nogil=True, error_model="numpy")
def begin(space, meaning):
    """Begin a step, after a RESTART with all sunk straight down; whether a body may touch sand."""
    step, touched, vectors = space.step[0], False, space.vectors
    twist = space.jacobian @ space.velocity[0]
    late = 0.5 * step.dt * step.rk4  # from MuJoCo's places to the middle
    if meaning == NEW:
        step.steps += 1
        vectors[FREE] = (twist - vectors[TWIST]) / step.dt - vectors[GAINED]
        space.bristles[0] = space.bristles[2]
    elif meaning == RESTART:
        step.restarts += 1
        vectors[FREE] = 0.0
    vectors[TWIST], vectors[GAINED:], space.bristles[2], space.answer[:] = twist, 0.0, 0.0, 0.0
    for b in range(len(space.bodies)):
        body, o, frame = space.bodies[b], 6 * b, space.frame
        axes, height = space.attitude[body.row], space.places[body.row, 2]
        if meaning == NEW:
            body.work += body.pending
        elif meaning == RESTART:
            vectors[FREE, o : o + 3] = step.gravity
            for a in range(3):
                of_body(space.bristles[0], body, 3)[a] = -axes[6 + a]
        body.power = body.pending = 0.0
        turned = axes.reshape(3, 3) + late * np.cross(twist[o + 3 : o + 6], axes.reshape(3, 3).T).T
        frame[o : o + 3, o : o + 3] = frame[o + 3 : o + 6, o + 3 : o + 6] = turned
        body.height = height + late * twist[o + 2]
        speed = abs(twist[o + 2]) + (abs(twist[o + 3]) + abs(twist[o + 4])) * body.reach
        margin, low = 2.0 * step.dt * (speed + 10.0 * step.dt), np.inf
        if height - body.reach < margin:
            faces = of_body(space.faces[0], body, COLUMNS)
            low = height + np.min(axes[6] * faces[X] + axes[7] * faces[Y] + axes[8] * faces[Z])
        body.depth, body.near = max(-low, 0.0), low < margin
        touched = touched or low < margin
    return touched


@inlined
def surface_of(space, b, base, c, v):
    """Height of a body's origin at a stage's end, where it has moved by base + c v, and up in its axes."""
    o = 6 * b
    u = space.frame[o + 2, o], space.frame[o + 2, o + 1], space.frame[o + 2, o + 2]
    d = plus((base[o], base[o + 1], base[o + 2]), c, (v[o], v[o + 1], v[o + 2]))
    turn = plus((base[o + 3], base[o + 4], base[o + 5]), c, (v[o + 3], v[o + 4], v[o + 5]))
    return space.bodies[b].height + dot(u, d), plus(u, -1.0, cross(turn, u))


@cached_njit(nogil=True, error_model="numpy", fastmath=FAST)
def body_forces(space, effects, b, surface, v, c, turn, h0, f, stiffness):
    """`faces.forces` on a body, written into those of all bodies."""
    body, o, frame, (loads, gates, pushes) = space.bodies[b], 6 * b, space.frame, effects
    up = frame[o + 2, o], frame[o + 2, o + 1], frame[o + 2, o + 2]
    forward = space.places[body.row, 0], (frame[o, o], frame[o, o + 1], frame[o, o + 2])
    faces, h = of_body(space.faces[0], body, COLUMNS), of_body(h0, body, 3)
    state = faces, body.law, up, surface, forward, v[o : o + 6], c, turn, h
    if body.mesh:
        total, rows = forces(body.friction, loads, None, pushes, *state)
    else:
        total, rows = forces(None, loads, gates, pushes, *state)
    for i in range(6):
        f[o + i] = total[i]
        for j in range(6):
            stiffness[o + i, o + j] = rows[i][j]


@cached_njit(nogil=True, error_model="numpy")
def solution(mobility, stiffness, c, x):
    """Solve (1 - c W dF/dV) y = x by elimination with pivots, which takes half of LAPACK's time."""
    n, a = len(x), np.eye(len(x), len(x) + 1)
    a[:, n] = x
    for i in range(n):
        for j in range(n):
            for m in range(j - j % 6, j - j % 6 + 6):  # a wrench follows the twist of its own body
                a[i, j] -= c * mobility[i, m] * stiffness[m, j]
    for i in range(n):
        best = i + np.argmax(np.abs(a[i:, i]))
        for m in range(i, n + 1):
            a[i, m], a[best, m] = a[best, m], a[i, m]
        for j in range(n):
            factor = a[j, i] / a[i, i]
            if j != i and factor != 0.0:
                for m in range(i, n + 1):
                    a[j, m] -= factor * a[i, m]
    return a[:, n] / np.diag(a)


@cached_njit(nogil=True, error_model="numpy")
def newton(space, effects, mobility, base, v0, v, c, turn, h0, f):
    """Solve v = v0 + c W F(v) for the twists v of the bodies; whether it could be. f: their wrenches."""
    n, best = len(v), np.inf
    stiffness, wide, dv = np.zeros((n, n)), np.ones(n), np.zeros(n)
    for b in range(len(space.bodies)):
        wide[6 * b + 3 : 6 * b + 6] = space.bodies[b].reach  # makes speeds of twists
    for _ in range(MAX_NEWTON):
        space.step[0].evaluations += 1
        for b in range(len(space.bodies)):
            if space.bodies[b].near:
                surface = surface_of(space, b, base, c, v)
                body_forces(space, effects, b, surface, v, c, turn, h0, f, stiffness)
        rest = v0 - v + c * (mobility @ f)
        size = np.sum((wide * rest) ** 2)
        if size > best:  # go back half of the way, unless nothing but rounding is left to gain
            dv *= 0.5
            v -= dv
            if np.max(np.abs(wide * dv)) < 1e-14 * np.max(np.abs(v)):
                best = np.inf
            continue
        if not np.isfinite(size):
            break
        best = size
        dv = solution(mobility, stiffness, c, rest)
        v += dv
        if np.max(np.abs(wide * dv)) <= TIGHT * max(0.1 / turn, np.max(np.abs(wide * v))) + 1e-13:
            f += stiffness @ dv  # forces follow the last change to first order
            return True
    return False


@cached_njit(nogil=True, error_model="numpy")
def stage(space, effects, mobility, base, v0, v, c, before, after, share, f):
    """Solve an implicit stage of length c; bend bristles from before to after by a share, 0 in the air."""
    turn = c / space.step[0].length
    if not newton(space, effects, mobility, base, v0, v, c, turn, before, f):
        space.step[0].failures += 1
    for b in range(len(space.bodies)):
        body = space.bodies[b]
        faces, h = of_body(space.faces[0], body, COLUMNS), of_body(before, body, 3)
        surface, new = surface_of(space, b, base, c, v), of_body(after, body, 3)
        for i in range(faces.shape[1]):
            r, _, bent = moved(faces, h, i, v[6 * b : 6 * b + 6], turn)
            q = 1.0 / np.sqrt(max(dot(bent, bent), 1.0))
            inside = 1.0 if body.near and surface[0] + dot(surface[1], r) < 0.0 else 0.0
            for a in range(3):
                new[a, i] = inside * (h[a, i] + share * (bent[a] * q - h[a, i]))


@cached_njit(nogil=True, error_model="numpy")
def solve(space, effects):
    """Find the mean wrenches of a step on the bodies."""
    dt, vectors, frame, h = space.step[0].dt, space.vectors, space.frame, space.bristles
    c, r = GAMMA * dt, (1.0 - GAMMA) * dt
    mobility = frame.T @ (space.jacobian @ space.answer.T) @ frame
    v0, a = vectors[TWIST] @ frame, vectors[FREE] @ frame
    base, one, f1, f2 = -0.5 * dt * v0, v0.copy(), np.zeros(len(v0)), np.zeros(len(v0))
    stage(space, effects, mobility, base, v0 + c * a, one, c, h[0], h[1], r / c, f1)
    two, start = one.copy(), v0 + dt * a + r * (mobility @ f1)
    stage(space, effects, mobility, base + r * one, start, two, c, h[1], h[2], 1.0, f2)
    mean = (1.0 - GAMMA) * f1 + GAMMA * f2
    vectors[GAINED], vectors[MEAN], vectors[END] = frame @ (mobility @ mean), frame @ mean, frame @ f2
    for b in range(len(space.bodies)):
        body, o = space.bodies[b], 6 * b
        body.power = np.sum(f2[o : o + 6] * two[o : o + 6])
        body.pending = r * np.sum(f1[o : o + 6] * one[o : o + 6]) + c * body.power
