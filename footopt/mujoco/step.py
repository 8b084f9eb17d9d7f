"""One time step of MuJoCo on sand: which constant forces bring the feet where sand would bring them.

The law is stiff: sand holds what stands, and a force from the beginning of a step is that of where the body
was. So a step solves the motion of the feet alone over its length, by SDIRK2 (`walk.steppers.sdirk2`),

    dV/dt = a + W F(V, places),   W = J inv(M) J'

with the twists V of the bodies in the sand, J their Jacobian, M MuJoCo's inertia and F the sand's wrenches.
a is how they accelerate by all but sand: that of the step before, from how their twists changed. MuJoCo is
given the mean of F. Constraints and servos make bodies heavier than W says, which slows the correction of a.

MuJoCo's Euler and implicit steps move places by the new velocity, which is the leapfrog: velocities belong
to the middle of steps, and to places half a step back. RK4's belong to the same time.
"""

from __future__ import annotations

import math

import numpy as np

from footopt.compiled import FAST, cached_njit, inlined
from footopt.mujoco.desk import NEW, RESTART, RK4, STEP, Feet
from footopt.mujoco.stage import at, bent, mesh_forces, sole_forces, stiffness_of, wrench_of

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
MAX_NEWTON = 25  # evaluations of one stage, back-tracking included
RESCUE = 6  # decades by which a stage that fails is made viscous, and then less and less
SOLE, MESH = range(2)

TIGHT = 1e-3  # last step of Newton's method over the speed of the feet; forces err by its square

#: What is counted: steps, evaluations, stages that had to be rescued, that failed, and restarts.
COUNTED = ("steps", "evaluations", "rescues", "failures", "restarts")


@inlined
def begin(desk, meaning):
    """Make the end of the last step the beginning of this one; after a RESTART all has sunk straight down."""
    before, after = desk.bristles[0], desk.bristles[2]
    if meaning == NEW:
        desk.counts[0] += 1
        for i in range(len(before)):
            before[i] = after[i]
    elif meaning == RESTART:
        desk.counts[4] += 1
    for b in range(len(desk.bodies)):
        row, first, last = desk.bodies[b, 0], desk.bodies[b, 1], desk.bodies[b, 2]
        if meaning == NEW:
            desk.work[b] += desk.pending[b]
        elif meaning == RESTART:
            for a in range(3):
                for i in range(last - first):
                    before[3 * first + a * (last - first) + i] = -desk.attitude[row, 6 + a]
        desk.pending[b] = 0.0


@cached_njit(nogil=True, error_model="numpy", fastmath=FAST)
def forces(desk, effects, b, up, surface, forward, twist, c, turn, h0, wrench, stiffness):
    """The sand's wrench on a body, and its derivative by the twist."""
    loads, gates, pushes = effects
    first, last = desk.bodies[b, 1], desk.bodies[b, 2]
    n = last - first
    faces, h = desk.faces[10 * first : 10 * last].reshape(10, n), h0[3 * first : 3 * last].reshape(3, n)
    f, d = desk.forces[3 * first : 3 * last].reshape(3, n), desk.slopes[9 * first : 9 * last].reshape(9, n)
    law = desk.laws[b]
    if desk.bodies[b, 3] == SOLE:
        sole_forces(faces, law, loads, gates, pushes, up, surface, forward, twist, c, turn, h, f, d)
    else:
        mesh_forces(faces, law, loads, pushes, up, surface, forward, twist, c, turn, h, f, d)
    wrench_of(faces, f, wrench)
    stiffness_of(np.dot(d, desk.moments[first:last]), stiffness)


@inlined
def _surface(feet, k, base, c, v):
    """Height of a place in a foot at a stage's end, as `stage.at` takes it: it has moved by base + c v."""
    u, o = feet.ups[k], 6 * k
    dx, dy, dz = base[o] + c * v[o], base[o + 1] + c * v[o + 1], base[o + 2] + c * v[o + 2]
    tx, ty, tz = base[o + 3] + c * v[o + 3], base[o + 4] + c * v[o + 4], base[o + 5] + c * v[o + 5]
    return (
        feet.heights[k] + u[0] * dx + u[1] * dy + u[2] * dz,
        u[0] + u[1] * tz - u[2] * ty,
        u[1] + u[2] * tx - u[0] * tz,
        u[2] + u[0] * ty - u[1] * tx,
    )


@inlined
def _eliminate(a, x):
    """Solve a y = x by Gauss's elimination with pivots; y takes the place of x, and a is used up."""
    n = len(x)
    for i in range(n):
        best = i
        for j in range(i + 1, n):
            if abs(a[j, i]) > abs(a[best, i]):
                best = j
        if best != i:
            x[i], x[best] = x[best], x[i]
            for j in range(i, n):
                a[i, j], a[best, j] = a[best, j], a[i, j]
        for j in range(i + 1, n):
            factor = a[j, i] / a[i, i]
            if factor != 0.0:
                x[j] -= factor * x[i]
                for m in range(i + 1, n):
                    a[j, m] -= factor * a[i, m]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= a[i, j] * x[j]
        x[i] /= a[i, i]


@cached_njit(nogil=True, error_model="numpy")
def newton(desk, effects, feet, base, v0, v, c, turn, h0, f):
    """Solve v = v0 + c W F(v) for the twists v of the feet; whether it could be. f: their wrenches."""
    n, best = len(v), np.inf
    stiffness, total, dv = np.zeros((len(feet.bodies), 6, 6)), np.zeros((n, n)), np.zeros(n)
    for _ in range(MAX_NEWTON):
        desk.counts[1] += 1
        for k in range(len(feet.bodies)):
            o = 6 * k
            forces(
                desk, effects, feet.bodies[k], feet.ups[k], _surface(feet, k, base, c, v), feet.along[k],
                v[o : o + 6], c, turn, h0, f[o : o + 6], stiffness[k],
            )  # fmt: skip
            for i in range(n):
                for j in range(6):
                    entry = 1.0 if i == o + j else 0.0
                    for m in range(6):
                        entry -= c * feet.mobility[i, o + m] * stiffness[k, m, j]
                    total[i, o + j] = entry
        size = 0.0
        for i in range(n):
            rest = v[i] - v0[i]
            for j in range(n):
                rest -= c * feet.mobility[i, j] * f[j]
            size += (feet.wide[i] * rest) ** 2
            feet.rest[i] = -rest
        if size > best:  # go back half of the way
            moved, speed = 0.0, 1.0
            for i in range(n):
                dv[i] *= 0.5
                v[i] -= dv[i]
                moved, speed = max(moved, abs(feet.wide[i] * dv[i])), max(speed, abs(v[i]))
            if moved < 1e-14 * speed:
                best = np.inf  # nothing but rounding is left to gain
            continue
        best, moved, speed = size, 0.0, 0.1 / turn
        _eliminate(total, feet.rest)
        for i in range(n):
            dv[i] = feet.rest[i]
            v[i] += dv[i]
            moved, speed = max(moved, abs(feet.wide[i] * dv[i])), max(speed, abs(feet.wide[i] * v[i]))
        if moved <= TIGHT * speed + 1e-13:
            for i in range(n):  # forces follow the last change to first order
                k = i // 6
                for j in range(6):
                    f[i] += stiffness[k, i - 6 * k, j] * dv[6 * k + j]
            return True
    return False


@cached_njit(nogil=True, error_model="numpy")
def stage(desk, effects, feet, base, v0, v, c, h0, f):
    """`newton`; where it fails, by way of sand that is viscous at first, and then less and less."""
    turn, guess = c / desk.length[0], v.copy()
    solved, decade = newton(desk, effects, feet, base, v0, v, c, turn, h0, f), RESCUE + 1
    if not solved:
        desk.counts[2] += 1
        for i in range(len(v)):
            v[i] = guess[i]
        while decade > 0:
            decade -= 1
            solved = newton(desk, effects, feet, base, v0, v, c, turn * 0.1**decade, h0, f)
        desk.counts[3] += 0 if solved else 1


@cached_njit(nogil=True, error_model="numpy")
def bend(desk, feet, base, v, c, before, after, share):
    """Bend the bristles of the feet over a stage, to a share of their way; those in the air are 0."""
    turn = c / desk.length[0]
    for k in range(len(feet.bodies)):
        b, surface = feet.bodies[k], _surface(feet, k, base, c, v)
        first, last = desk.bodies[b, 1], desk.bodies[b, 2]
        n, twist = last - first, v[6 * k : 6 * k + 6]
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
    """How many bodies may touch sand within the step, first in desk.active; and all their depths."""
    count, dt = 0, desk.clock[STEP]
    for b in range(len(desk.bodies)):
        row, first, last = desk.bodies[b, 0], desk.bodies[b, 1], desk.bodies[b, 2]
        twist, height, up = desk.now[b], desk.places[row, 2], desk.attitude[row]
        desk.depths[b] = 0.0
        near = 2.0 * dt * (abs(twist[2]) + (abs(twist[3]) + abs(twist[4])) * desk.reach[b] + 10.0 * dt)
        if height - desk.reach[b] < near:
            faces, low = desk.faces[10 * first : 10 * last].reshape(10, last - first), np.inf
            for i in range(last - first):
                low = min(low, at((height, up[6], up[7], up[8]), faces, i))
            desk.depths[b] = max(-low, 0.0)
            if low < near:
                desk.active[count] = b
                count += 1
    return count


@inlined
def _turn(desk, b, vector, to_world, out):
    """Six numbers, two vectors, from the world's axes to a body's own, or back."""
    turned = desk.attitude[desk.bodies[b, 0]]
    for o in range(0, 6, 3):
        for i in range(3):
            total = 0.0
            for j in range(3):
                total += vector[o + j] * (turned[3 * i + j] if to_world else turned[3 * j + i])
            out[o + i] = total


@cached_njit(nogil=True, error_model="numpy")
def prepare(desk, meaning):
    """Begin a step, with the Jacobians of the feet in the sand in their own axes; how many there are."""
    begin(desk, meaning)
    nv = len(desk.velocity)
    for b in range(len(desk.bodies)):
        for i in range(6):
            speed = 0.0
            for j in range(nv):
                speed += desk.jacobian[6 * b + i, j] * desk.velocity[j]
            desk.now[b, i] = speed
            if meaning == NEW:
                desk.free[b, i] = (speed - desk.twists[b, i]) / desk.clock[STEP] - desk.gained[b, i]
            elif meaning == RESTART:
                desk.free[b, i] = desk.gravity[i] if i < 3 else 0.0
            desk.twists[b, i] = speed
    count, column, own = find_active(desk), np.empty(6), np.empty(6)
    for k in range(count):
        b = desk.active[k]
        for j in range(nv):
            for i in range(6):
                column[i] = desk.jacobian[6 * b + i, j]
            _turn(desk, b, column, False, own)
            for i in range(6):
                desk.own[6 * k + i, j] = own[i]
    return count


@inlined
def _feet(desk, count):
    """The bodies in the sand at the middle of the step, with their twists and accelerations in their axes."""
    n, late = 6 * count, 0.5 * desk.clock[STEP] * desk.clock[RK4]  # from MuJoCo's place to the middle
    ups, along, heights = np.empty((count, 3)), np.empty((count, 4)), np.empty(count)
    wide, v0, a, mobility = np.ones(n), np.empty(n), np.empty(n), np.zeros((n, n))
    for k in range(count):
        b, o = desk.active[k], 6 * k
        row = desk.bodies[b, 0]
        up = desk.attitude[row]
        _turn(desk, b, desk.now[b], False, v0[o : o + 6])
        _turn(desk, b, desk.free[b], False, a[o : o + 6])
        for i in range(3):
            j, m = (i + 1) % 3, (i + 2) % 3
            wide[o + 3 + i] = desk.reach[b]
            ups[k, i] = up[6 + i] + late * (up[6 + j] * v0[o + 3 + m] - up[6 + m] * v0[o + 3 + j])
            along[k, 1 + i] = up[i]
        heights[k], along[k, 0] = desk.places[row, 2] + late * desk.now[b, 2], desk.places[row, 0]
    for i in range(n):
        for j in range(n):
            for m in range(len(desk.velocity)):
                mobility[i, j] += desk.own[i, m] * desk.answer[j, m]
    return Feet(desk.active[:count], ups, heights, along, wide, mobility, np.empty(n)), v0, a


@cached_njit(nogil=True, error_model="numpy")
def solve(desk, effects, count):
    """The mean wrenches of a step on the feet in the sand, to MuJoCo and to the desk."""
    n, dt = 6 * count, desk.clock[STEP]
    c, r = GAMMA * dt, (1.0 - GAMMA) * dt
    now, middle, end = desk.bristles[0], desk.bristles[1], desk.bristles[2]
    for i in range(len(end)):
        end[i] = 0.0
    for b in range(len(desk.bodies)):
        desk.power[b] = 0.0
        for i in range(6):
            desk.mean[b, i] = desk.last[b, i] = desk.gained[b, i] = 0.0
    if count == 0:
        return
    feet, v0, a = _feet(desk, count)
    f1, f2, base, start, one = np.zeros(n), np.zeros(n), np.empty(n), np.empty(n), v0.copy()
    for i in range(n):
        base[i], start[i] = -0.5 * dt * v0[i], v0[i] + c * a[i]
    stage(desk, effects, feet, base, start, one, c, now, f1)
    bend(desk, feet, base, one, c, now, middle, r / c)
    two = one.copy()
    for i in range(n):
        base[i], start[i] = base[i] + r * one[i], v0[i] + dt * a[i]
        for j in range(n):
            start[i] += r * feet.mobility[i, j] * f1[j]
    stage(desk, effects, feet, base, start, two, c, middle, f2)
    bend(desk, feet, base, two, c, middle, end, 1.0)

    for i in range(n):
        k = i // 6
        b = feet.bodies[k]
        desk.power[b] += f2[i] * two[i]
        desk.pending[b] += r * f1[i] * one[i] + c * f2[i] * two[i]
        f1[i] = (1.0 - GAMMA) * f1[i] + GAMMA * f2[i]
    for k in range(count):
        b, o = feet.bodies[k], 6 * k
        _turn(desk, b, f1[o : o + 6], True, desk.mean[b])
        _turn(desk, b, f2[o : o + 6], True, desk.last[b])
    for m in range(len(desk.velocity)):
        push = change = 0.0
        for i in range(n):
            push += f1[i] * desk.own[i, m]
            change += f1[i] * desk.answer[i, m]
        desk.passive[m] += push
        for b in range(len(desk.bodies)):
            for i in range(6):
                desk.gained[b, i] += desk.jacobian[6 * b + i, m] * change


@cached_njit(nogil=True, error_model="numpy")
def hold(desk):
    """Give MuJoCo the forces of the step again, in a stage of RK4."""
    for m in range(len(desk.velocity)):
        for b in range(len(desk.bodies)):
            for i in range(6):
                desk.passive[m] += desk.mean[b, i] * desk.jacobian[6 * b + i, m]
