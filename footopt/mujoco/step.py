"""One time step of MuJoCo on sand: which constant forces bring the feet where sand would bring them.

The law is stiff: sand holds what stands, and a force that is taken at the beginning of a step is that of where
the body was. So a step solves the motion of the feet alone over its length, by SDIRK2 (`walk.steppers.sdirk2`),

    dV/dt = a + W F(V, places),   W = J inv(M) J'

with the twists V of the bodies in the sand, J their Jacobian, M MuJoCo's inertia and F the sand's wrenches. a is
how they accelerate by all but sand: that of the step before, from how their twists changed. MuJoCo is given the
mean of F. Constraints and servos make bodies heavier than W says, which slows the correction of a and no more.

MuJoCo's Euler and implicit steps move places by the new velocity, which is the leapfrog: velocities belong
to the middle of steps. The places at which they begin are then half a step back. RK4's belong to the same time.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from footopt.compiled import cached_njit, inlined
from footopt.mujoco.stage import AREA, at, bent, mesh_forces, sole_forces, stiffness_of, wrench_of

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
MAX_NEWTON = 25  # evaluations of one stage, back-tracking included
RESCUE = 6  # decades by which a stage that fails is made viscous, and then less and less
AGAIN, NEW, HOLD, RESTART = range(4)
SOLE, MESH = range(2)

TIGHT = 1e-3  # last step of Newton's method over the speed of the feet; forces err by its square

#: A clock's numbers: start of the step, its length, s; 1 where the integrator is RK4; 1 once its middle has been
#: seen, 2 once its end has; 1 once it runs.
START, STEP, RK4, STAGE, RUNS = range(5)
#: What is counted: steps, evaluations, stages that had to be rescued, that failed, and restarts.
COUNTED = ("steps", "evaluations", "rescues", "failures", "restarts")


class Desk(NamedTuple):
    """All that a step reads and writes: MuJoCo's own arrays and those of one attachment of b bodies, p faces."""

    places: Any  # (nbody, 3), m: MuJoCo's xpos
    attitude: Any  # (nbody, 9): xmat
    velocity: Any  # (nv,): qvel
    passive: Any  # (nv,): qfrc_passive
    bodies: Any  # (b, 4): row in MuJoCo, first face, one past the last, SOLE or MESH
    active: Any  # (b,): those in the sand, the first of it
    counts: Any  # (len(COUNTED),)
    clock: Any  # see `START`
    length: Any  # (1,), m: over which bristles bend
    laws: Any  # (b, 9), N/m^3: `sand.law.Law`, or xi and the surface's friction
    reach: Any  # (b,), m
    faces: Any  # (10 p,): `stage.X` and so on, a body's as (10, its faces)
    moments: Any  # (p, 10): of their places
    bristles: Any  # (3, 3 p): at the step's beginning, middle, end
    forces: Any  # (3 p,), N
    slopes: Any  # (9 p,), N s/m
    now: Any  # (b, 6): twists in the world's axes, m/s and rad/s
    twists: Any  # (b, 6): those of the step before
    gained: Any  # (b, 6): accelerations that the sand gave in it
    free: Any  # (b, 6): accelerations by all but the sand
    gravity: Any  # (3,), m/s^2
    mean: Any  # (b, 6), N and N m: the wrench that MuJoCo is given
    last: Any  # (b, 6): the wrench at the step's end
    power: Any  # (b,), W: of the sand, at the step's end
    pending: Any  # (b,), J: its work over the step
    work: Any  # (b,), J: over the steps before
    depths: Any  # (b,), m: of the deepest face
    jacobian: Any  # (6 b, nv): of all bodies, in the world's axes
    own: Any  # (6 b, nv): of those in the sand, in their own
    answer: Any  # (6 b, nv): inv(M) J' of these


class Feet(NamedTuple):
    """The bodies in the sand, in the middle of a step."""

    bodies: Any  # (k,)
    ups: Any  # (k, 3): up, in their axes
    heights: Any  # (k,), m: of their origins
    along: Any  # (k, 4): x of a place in them, as `stage.at` takes it
    wide: Any  # (6 k,): what makes speeds of twists
    mobility: Any  # (6 k, 6 k): W


@inlined
def tick(clock, time):
    """What a call at a time means: the same step AGAIN, a NEW one, a stage of RK4 to HOLD, or a RESTART."""
    passed = (time - clock[START]) / clock[STEP]
    if clock[RUNS] == 0.0:
        passed = -1.0
    if abs(passed) < 1e-6:
        return AGAIN
    if clock[RK4] == 1.0 and abs(passed - 0.5) < 1e-6:
        clock[STAGE] = 1.0
        return HOLD
    ends = abs(passed - 1.0) < 1e-6
    if ends and clock[STAGE] == 1.0:
        clock[STAGE] = 2.0
        return HOLD
    clock[START], clock[STAGE], clock[RUNS] = time, 0.0, 1.0
    return NEW if ends else RESTART


@inlined
def begin(desk, meaning):
    """Make the end of the last step the beginning of this one; after a RESTART all has sunk straight down."""
    if meaning == NEW:
        desk.counts[0] += 1
        desk.bristles[0] = desk.bristles[2]
        desk.work[:] += desk.pending
    elif meaning == RESTART:
        desk.counts[4] += 1
        for b in range(len(desk.bodies)):
            first, last = desk.bodies[b, 1], desk.bodies[b, 2]
            h = desk.bristles[0, 3 * first : 3 * last].reshape(3, last - first)
            for a in range(3):
                h[a] = -desk.attitude[desk.bodies[b, 0], 6 + a]
    desk.pending[:] = 0.0


@inlined
def _forces(desk, effects, b, up, surface, forward, twist, c, turn, h0, wrench, stiffness):
    """The sand's wrench on a body, and its derivative by the twist."""
    loads, gates, pushes = effects
    first, last = desk.bodies[b, 1], desk.bodies[b, 2]
    n = last - first
    faces, h = desk.faces[10 * first : 10 * last].reshape(10, n), h0[3 * first : 3 * last].reshape(3, n)
    f, d = desk.forces[3 * first : 3 * last].reshape(3, n), desk.slopes[9 * first : 9 * last].reshape(9, n)
    if desk.bodies[b, 3] == SOLE:
        sole_forces(
            faces, desk.laws[b], loads, gates, pushes, up, surface, forward, twist, c, turn, h, f, d
        )
    else:
        mesh_forces(faces, desk.laws[b], loads, pushes, up, surface, forward, twist, c, turn, h, f, d)
    wrench_of(faces, f, wrench)
    stiffness_of(desk.moments[first:last], d, stiffness)


@inlined
def _plane(up, height, moved):
    """Height of a place in the body once it has moved by a small twist, as `stage.at` takes it."""
    mx, my, mz = moved[3], moved[4], moved[5]
    return (
        height + up[0] * moved[0] + up[1] * moved[1] + up[2] * moved[2],
        up[0] + up[1] * mz - up[2] * my,
        up[1] + up[2] * mx - up[0] * mz,
        up[2] + up[0] * my - up[1] * mx,
    )


@inlined
def _newton(desk, effects, feet, base, v0, v, c, turn, h0, f):
    """Solve v = v0 + c W F(v) for the twists v of the feet; whether it could be. f: their wrenches."""
    n = len(v)
    stiffness, total, best, dv = np.zeros((6, 6)), np.eye(n), np.inf, np.zeros(n)
    all_stiffness = np.zeros((n, 6))
    for _ in range(MAX_NEWTON):
        desk.counts[1] += 1
        for k in range(len(feet.bodies)):
            part = slice(6 * k, 6 * k + 6)
            _forces(
                desk, effects, feet.bodies[k], feet.ups[k],
                _plane(feet.ups[k], feet.heights[k], base[part] + c * v[part]),
                feet.along[k], v[part], c, turn, h0, f[part], stiffness,
            )  # fmt: skip
            all_stiffness[part] = stiffness
            total[:, part] = -c * np.dot(feet.mobility[:, part].copy(), stiffness)
            for i in range(6 * k, 6 * k + 6):
                total[i, i] += 1.0
        rest = v - v0 - c * np.dot(feet.mobility, f)
        size = np.sum((feet.wide * rest) ** 2)
        if size > best:  # go back half of the way
            dv *= 0.5
            v -= dv
            if np.max(np.abs(feet.wide * dv)) < 1e-14 * (1.0 + np.max(np.abs(v))):
                best = np.inf
            continue
        best = size
        dv = np.linalg.solve(total, -rest)
        v += dv
        if np.max(np.abs(feet.wide * dv)) <= TIGHT * (0.1 / turn + np.max(np.abs(feet.wide * v))) + 1e-13:
            for k in range(len(feet.bodies)):  # forces follow the last change to first order
                part = slice(6 * k, 6 * k + 6)
                f[part] += np.dot(all_stiffness[part], dv[part])
            return True
    return False


@inlined
def _stage(desk, effects, feet, base, v0, v, c, h0, f):
    """`_newton`; where it fails, by way of sand that is viscous at first, and then less and less."""
    turn, guess = c / desk.length[0], v.copy()
    if _newton(desk, effects, feet, base, v0, v, c, turn, h0, f):
        return
    desk.counts[2] += 1
    v[:] = guess
    solved = False
    for decade in range(RESCUE, -1, -1):
        solved = _newton(desk, effects, feet, base, v0, v, c, turn * 10.0**-decade, h0, f)
    desk.counts[3] += 0 if solved else 1


@inlined
def _bend(desk, b, up, surface, twist, turn, before, after, share):
    """Bend a body's bristles over a stage, to a share of their way; those in the air are 0."""
    first, last = desk.bodies[b, 1], desk.bodies[b, 2]
    n = last - first
    faces = desk.faces[10 * first : 10 * last].reshape(10, n)
    h, new = before[3 * first : 3 * last].reshape(3, n), after[3 * first : 3 * last].reshape(3, n)
    for i in range(n):
        x, y, z, _, _, _ = bent(faces, h, i, twist, turn)
        q = 1.0 / np.sqrt(max(x * x + y * y + z * z, 1.0))
        inside = 1.0 if at(surface, faces, i) < 0.0 else 0.0
        new[0, i] = inside * (h[0, i] + share * (x * q - h[0, i]))
        new[1, i] = inside * (h[1, i] + share * (y * q - h[1, i]))
        new[2, i] = inside * (h[2, i] + share * (z * q - h[2, i]))


@inlined
def find_active(desk):
    """Bodies that may touch sand within the step, and their depths."""
    count = 0
    for b in range(len(desk.bodies)):
        first, last = desk.bodies[b, 1], desk.bodies[b, 2]
        faces, row = desk.faces[10 * first : 10 * last].reshape(10, last - first), desk.bodies[b, 0]
        height, up = desk.places[row, 2], desk.attitude[row, 6:9]
        desk.depths[b] = 0.0
        twist = desk.now[b]
        speed = abs(twist[2]) + (abs(twist[3]) + abs(twist[4])) * desk.reach[b]
        if height - desk.reach[b] - 2.0 * desk.clock[STEP] * speed < 0.0:
            low = np.inf
            for i in range(last - first):
                if faces[AREA, i] > 0.0:
                    low = min(low, at((height, up[0], up[1], up[2]), faces, i))
            desk.depths[b] = max(-low, 0.0)
            if low < 2.0 * desk.clock[STEP] * (speed + 10.0 * desk.clock[STEP]):
                desk.active[count] = b
                count += 1
    return count


@inlined
def frame(desk, count, jacobian):
    """Turn the Jacobians of the feet in the sand, (6 count, nv), from the world's axes to their own."""
    for k in range(count):
        turned = desk.attitude[desk.bodies[desk.active[k], 0]].reshape(3, 3)
        for i in range(6 * k, 6 * k + 6, 3):
            jacobian[i : i + 3] = np.dot(turned.T.copy(), jacobian[i : i + 3].copy())


@inlined
def _feet(desk, count, mobility):
    """The bodies that are active, at the middle of the step, and their twists (6 count,) and accelerations."""
    dt, late = desk.clock[STEP], 0.5 * desk.clock[STEP] * desk.clock[RK4]  # from MuJoCo's place to the middle
    ups, along, heights = np.empty((count, 3)), np.empty((count, 4)), np.empty(count)
    wide, v0, a = np.ones(6 * count), np.empty(6 * count), np.empty(6 * count)
    for k in range(count):
        b = desk.active[k]
        row = desk.bodies[b, 0]
        turned = desk.attitude[row].reshape(3, 3)
        for i in range(2):
            part = slice(6 * k + 3 * i, 6 * k + 3 * i + 3)
            v0[part] = np.dot(desk.now[b, 3 * i : 3 * i + 3], turned)
            a[part] = np.dot(desk.free[b, 3 * i : 3 * i + 3], turned)
        wide[6 * k + 3 : 6 * k + 6] = desk.reach[b]
        up, spin = desk.attitude[row, 6:9], v0[6 * k + 3 : 6 * k + 6]
        for i in range(3):
            j, m = (i + 1) % 3, (i + 2) % 3
            ups[k, i] = up[i] + late * (up[j] * spin[m] - up[m] * spin[j])
        ups[k] /= np.sqrt(np.sum(ups[k] ** 2))
        heights[k] = desk.places[row, 2] + late * desk.now[b, 2]
        along[k, 0], along[k, 1:] = desk.places[row, 0], desk.attitude[row, 0:3]
    return Feet(desk.active[:count], ups, heights, along, wide, mobility), v0, a, dt


@inlined
def solve(desk, effects, count, jacobian, answer):
    """The mean wrenches (6 count,) of a step on the feet in the sand, each in its own axes.

    jacobian, answer: (6 count, nv), J of these feet, and inv(M) J'. In the world's axes all goes to the desk.
    """
    desk.mean[:] = 0.0
    desk.last[:] = 0.0
    desk.power[:] = 0.0
    if count == 0:
        desk.bristles[2] = 0.0
        return np.zeros(0)
    feet, v0, a, dt = _feet(desk, count, np.dot(jacobian, answer.T))
    c, r = GAMMA * dt, (1.0 - GAMMA) * dt
    now, middle, end = desk.bristles[0], desk.bristles[1], desk.bristles[2]
    end[:] = 0.0
    one, f1, f2, base = v0.copy(), np.zeros(len(v0)), np.zeros(len(v0)), -0.5 * dt * v0
    _stage(desk, effects, feet, base, v0 + c * a, one, c, now, f1)
    turn = c / desk.length[0]
    for k in range(count):
        part = slice(6 * k, 6 * k + 6)
        surface = _plane(feet.ups[k], feet.heights[k], base[part] + c * one[part])
        _bend(desk, feet.bodies[k], feet.ups[k], surface, one[part], turn, now, middle, r / c)
    two, base = one.copy(), base + r * one
    start = v0 + r * (a + np.dot(feet.mobility, f1)) + c * a
    _stage(desk, effects, feet, base, start, two, c, middle, f2)
    mean = (1.0 - GAMMA) * f1 + GAMMA * f2
    for k in range(count):
        b, part = feet.bodies[k], slice(6 * k, 6 * k + 6)
        surface = _plane(feet.ups[k], feet.heights[k], base[part] + c * two[part])
        _bend(desk, b, feet.ups[k], surface, two[part], turn, middle, end, 1.0)
        turned = desk.attitude[desk.bodies[b, 0]].reshape(3, 3)
        for i in range(2):
            half = slice(6 * k + 3 * i, 6 * k + 3 * i + 3)
            desk.mean[b, 3 * i : 3 * i + 3] = np.dot(turned, mean[half])
            desk.last[b, 3 * i : 3 * i + 3] = np.dot(turned, f2[half])
        desk.power[b] = np.dot(f2[part], two[part])
        desk.pending[b] = r * np.dot(f1[part], one[part]) + c * desk.power[b]
    return mean


@cached_njit(nogil=True, error_model="numpy")
def prepare(desk, meaning):
    """From MuJoCo's state and the Jacobians of all bodies to those in the sand, first; how many they are."""
    begin(desk, meaning)
    for b in range(len(desk.bodies)):
        desk.now[b] = np.dot(desk.jacobian[6 * b : 6 * b + 6], desk.velocity)
        if meaning == NEW:
            desk.free[b] = (desk.now[b] - desk.twists[b]) / desk.clock[STEP] - desk.gained[b]
        elif meaning == RESTART:
            desk.free[b, 0:3], desk.free[b, 3:6] = desk.gravity, 0.0
        desk.twists[b] = desk.now[b]
    count = find_active(desk)
    for k in range(count):
        b = desk.active[k]
        desk.own[6 * k : 6 * k + 6] = desk.jacobian[6 * b : 6 * b + 6]
    frame(desk, count, desk.own)
    return count


@cached_njit(nogil=True, error_model="numpy")
def push(desk, effects, count):
    """Solve the step, and give MuJoCo the forces."""
    desk.gained[:] = 0.0
    own, answer = desk.own[: 6 * count], desk.answer[: 6 * count]
    f = solve(desk, effects, count, own, answer)
    if count > 0:
        desk.passive[:] += np.dot(f, own)
        change = np.dot(f, answer)
        for b in range(len(desk.bodies)):
            desk.gained[b] = np.dot(desk.jacobian[6 * b : 6 * b + 6], change)


@cached_njit(nogil=True, error_model="numpy")
def hold(desk):
    """Give MuJoCo the forces of the step again, in a stage of RK4."""
    for b in range(len(desk.bodies)):
        desk.passive[:] += np.dot(desk.mean[b], desk.jacobian[6 * b : 6 * b + 6])
