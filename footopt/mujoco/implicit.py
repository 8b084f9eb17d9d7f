"""The constant forces that, over a time step of MuJoCo, move the feet as the sand would.

The law is stiff: sand holds what stands, and a force at the beginning of a step is that of where the body
was. So a step solves the motion of the feet alone over its length, by SDIRK2 (`walk.steppers.implicit`),

    dV/dt = a + W F(V, places),   W = J inv(M + dt D) J'

with the twists V of the bodies near the sand, J their Jacobian, M MuJoCo's inertia, D the damping of joints
and servos that its integrator takes implicitly, and F the sand's wrenches, all in the bodies' own axes. a is
their acceleration by everything but the sand: that of the step before, from the change of their twists, less
what springs and dampers of joints and servos pull back since then. MuJoCo gets the mean of F.
"""

import numpy as np

from footopt.compiled import called_fast, inlined_fast
from footopt.mujoco import step as steps
from footopt.mujoco.faces import COLUMNS, cross, dot, forces, moved, plus
from footopt.mujoco.native import call
from footopt.mujoco.step import inner, workspace
from footopt.walk.contact import rsqrt
from footopt.walk.steppers.implicit import SDIRK2

GAMMA = SDIRK2().gamma
DEEPEST = 100.0  # m, to which a robot may sink at first
MAX_NEWTON = 100  # evaluations of one stage, line search included
#: Rows of `Workspace.room`, of the twists and wrenches of the near bodies.
BASE, FREELY, AHEAD, TWISTS, FORCES, SUM, LOAD, DV, DLOAD, REST, WAY, ROOM = range(12)
OPEN = 1e9  # n.h over EDGE at which every gate has opened
TIGHT = 1e-3  # last step of Newton's method over the speed of the feet; the forces' error is its square


@called_fast
def responses(address, rows):
    """inv(M + dt D) J' of rows of J by L' L along the tree of joints (Featherstone 2008, section 6.5)."""
    space = workspace(address)
    freedoms, columns, m, x, n = space.freedoms, space.columns[0], space.factor[0], space.answers, len(rows)
    for a in range(len(m)):
        m[a] = space.inertia[0, a]
    for k in range(len(freedoms)):
        m[freedoms[k].last] += space.step[0].dt * space.drift[steps.ADDED, k]
        for j in range(n):
            x[k, j] = space.jacobian[rows[j], k]
    for k in range(len(freedoms) - 1, -1, -1):
        first, last = freedoms[k].first, freedoms[k].last
        m[last] = 1.0 / m[last]
        for a in range(last - 1, first - 1, -1):
            i = freedoms[columns[a]]
            share = m[last] * m[a]
            for j in range(i.last - i.first + 1):  # ancestors of an ancestor come first in a row
                m[i.first + j] -= share * m[first + j]
            m[a] *= m[last]
            for j in range(n):
                x[columns[a], j] -= m[a] * x[k, j]
    for k in range(len(freedoms)):
        for j in range(n):
            x[k, j] *= m[freedoms[k].last]
        for a in range(freedoms[k].first, freedoms[k].last):
            for j in range(n):
                x[k, j] -= m[a] * x[columns[a], j]


@inlined_fast
def surface_of(body, axes, way):
    """Height of a body's origin at a stage's end, and up in its axes, after it has moved by `way`."""
    up, turned = (axes[6], axes[7], axes[8]), (way[3], way[4], way[5])
    return body.height + dot(up, (way[0], way[1], way[2])), plus(up, -1.0, cross(turned, up))


@called_fast
def solution(address, moves, c, rest, y):
    """Solve (1 - c W dF/dV) y = c W rest by elimination with pivots, for the rows that can move.

    The other rows of y stay 0. This takes a quarter of LAPACK's time, and allocates nothing: creating small
    arrays costs as much as computing them.
    """
    space = workspace(address)
    a, n = space.system, len(moves)
    for p in range(n):
        row, all_columns = space.mobility[p], space.system[len(a) - 1]
        for i in range(len(rest)):
            all_columns[i] = 0.0
        for q in range(n):  # a wrench follows the twist of its own body
            r = moves[q]
            share, first = -c * row[r], r - r % 6
            for j in range(6):
                all_columns[first + j] += share * space.stiffness[r, j]
        for q in range(n):
            a[p, q] = all_columns[moves[q]]
        a[p, p] += 1.0
        a[p, n] = c * inner(row[: len(rest)], rest)
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
        for j in range(i):
            a[j, n] -= a[j, i] * (a[i, n] / a[i, i])
        y[moves[i]] = a[i, n] / a[i, i]


@inlined_fast
def wrenches(address, effects, stage, c):
    """The sand's wrenches on the near bodies, c seconds after the base at their twists, and derivatives."""
    space = workspace(address)
    step = space.step[0]
    step.evaluations += 1
    for k in range(step.bodies):
        body, axes = space.bodies[space.chosen[0, k]], space.frame[space.chosen[0, k]]
        six, f = space.room[TWISTS, 6 * k : 6 * k + 6], space.room[FORCES, 6 * k : 6 * k + 6]
        up, x = (axes[6], axes[7], axes[8]), (axes[0], axes[1], axes[2])
        way, sinks = space.room[WAY, 6 * k : 6 * k + 6], 0.0 if step.still else c
        for i in range(6):
            way[i] = space.room[BASE, 6 * k + i] + sinks * six[i]
        surface, forward = surface_of(body, axes, way), (space.places[body.row, 0], x)
        first, last = body.first, body.last
        faces = space.faces[0, COLUMNS * first : COLUMNS * last].reshape(COLUMNS, last - first)
        h = space.bristles[stage, 3 * first : 3 * last].reshape(3, last - first)
        state = OPEN * step.bypass, faces, body.law, up, surface, forward, six, sinks, c / step.length, h
        total, rows = forces(effects, *state)
        for i in range(6):
            f[i] = total[i]
            for j in range(6):
                space.stiffness[6 * k + i, j] = rows[i][j]


def newton(address, stage):
    """Solve v = v0 + c W f, f = F(v), for the near bodies' twists v and wrenches, from f, or count a failure.

    Sand resists motion, so that dv . (F - f) falls along a step dv: a step is cut where this changes its
    sign, as where a face comes to rest, although |F - f| rises there. Where a light body leaves the sand
    within the stage, it may not fall, and there may be several roots: a stage that fails is tried again with
    the depths of its beginning.
    """
    space = workspace(address)
    step, loads = space.step[0], space.room[FORCES]
    for still in range(2):
        step.still = still
        if solved(address, stage):
            step.still = 0
            return
        for i in range(len(loads)):
            loads[i] = 0.0
    step.still = 0
    step.failures += 1


@called_fast
def solved(address, stage):
    """Whether Newton's method finds a stage's twists and wrenches, starting from those in the workspace."""
    space = workspace(address)
    step, room = space.step[0], space.room
    n, c = 6 * step.bodies, GAMMA * step.dt
    load, dv, dload, rest = room[LOAD, :n], room[DV, :n], room[DLOAD, :n], room[REST, :n]
    moves, v, f = space.chosen[1, : step.able], room[TWISTS, :n], room[FORCES, :n]
    slope, t, low, high, at_low, at_high = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # of a step: 0 before, 1 in full
    for i in range(n):
        load[i], dv[i], v[i] = f[i], 0.0, 0.0
    for p in range(len(moves)):
        v[moves[p]] = room[AHEAD, moves[p]] + c * inner(space.mobility[p, :n], load)
    for _ in range(MAX_NEWTON):
        call(space.outside[0, steps.WRENCHES], (address, stage, c))
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
            solution(address, moves, c, rest, dv)
            for i in range(n):
                dload[i] = rest[i] + inner(space.stiffness[i], dv[i - i % 6 : i - i % 6 + 6])
            at_low = slope = inner(dv, rest)
            share, t, low, high, at_high = 1.0, 0.0, 0.0, 1.0, 0.0
        t += share
        speed, change = 0.1 * step.length / c, 0.0
        for i in range(n):
            v[i] += share * dv[i]
            load[i] += share * dload[i]
            body = space.bodies[space.chosen[0, i // 6]]
            wide = body.reach if i % 6 > 2 else 1.0  # an angular rate times this is a speed
            speed, change = max(speed, abs(wide * v[i])), max(change, abs(wide * dv[i]))
        if share == 1.0 and change <= TIGHT * speed + 1e-13:
            for i in range(n):
                f[i] = load[i]  # forces follow the last change to first order
            return True
    return False


def bend(address, stage):
    """Bend bristles by the motion of a stage, in part in the first one, 0 in the air; add its wrenches."""
    space = workspace(address)
    step, room = space.step[0], space.room
    c = GAMMA * step.dt
    weight = c if stage else (1.0 - GAMMA) * step.dt
    share, turn = 1.0 if stage else weight / c, c / step.length
    for k in range(step.bodies):
        body, way = space.bodies[space.chosen[0, k]], room[WAY, 6 * k : 6 * k + 6]
        twist, f = room[TWISTS, 6 * k : 6 * k + 6], room[FORCES, 6 * k : 6 * k + 6]
        body.power = inner(f, twist)
        space.spent[steps.PENDING, space.chosen[0, k]] += weight * body.power
        for i in range(6):
            room[SUM, 6 * k + i] += weight / step.dt * f[i]
            way[i] = room[BASE, 6 * k + i] + c * twist[i]
        surface = surface_of(body, space.frame[space.chosen[0, k]], way)
        first, last = body.first, body.last
        faces = space.faces[0, COLUMNS * first : COLUMNS * last].reshape(COLUMNS, last - first)
        h = space.bristles[stage, 3 * first : 3 * last].reshape(3, last - first)
        new = space.bristles[stage + 1, 3 * first : 3 * last].reshape(3, last - first)
        for i in range(faces.shape[1]):
            r, _, bent = moved(faces, h, i, twist, turn)
            q = rsqrt(max(dot(bent, bent), 1.0))
            inside = 1.0 if surface[0] + dot(surface[1], r) < 0.0 else 0.0
            for a in range(3):
                new[a, i] = inside * (h[a, i] + share * (bent[a] * q - h[a, i]))


def prepare(address):
    """Choose the bodies near the sand, and the rows of their twists that can move; find W and a."""
    space = workspace(address)
    step, vectors, room, x = space.step[0], space.vectors, space.room, space.answers
    near, moves, rows, bodies, n = space.chosen[0], space.chosen[1], space.chosen[2], 0, 0
    for b in range(len(space.bodies)):
        if space.bodies[b].near:
            near[bodies] = b
            for i in range(6):
                row, r = 6 * b + i, 6 * bodies + i
                room[BASE, r], room[SUM, r] = -0.5 * step.dt * vectors[steps.TWIST, row], 0.0
                room[FORCES, r] = vectors[steps.BEFORE, row]
                if inner(space.jacobian[row], space.jacobian[row]) > 0.0:
                    moves[n], rows[n] = r, row
                    n += 1
            bodies += 1
    step.bodies, step.able = bodies, n
    responses(address, rows[:n])
    for p in range(n):
        row, own, pull = space.mobility[p], space.jacobian[rows[p]], 0.0
        for i in range(6 * bodies):
            row[i] = 0.0
        for k in range(len(own)):
            pull += x[k, p] * space.drift[steps.PULL, k]
            for q in range(n):
                row[moves[q]] += own[k] * x[k, q]
        room[FREELY, moves[p]] = vectors[steps.FREE, rows[p]] - pull


@called_fast
def predict(address, stage):
    """The twists at the end of a stage of SDIRK2 without the stage's own force."""
    space = workspace(address)
    step, vectors, room = space.step[0], space.vectors, space.room
    n, r = 6 * step.bodies, (1.0 - GAMMA) * step.dt
    for p in range(step.able):
        i = space.chosen[1, p]
        ahead = step.dt if stage else GAMMA * step.dt
        room[AHEAD, i] = vectors[steps.TWIST, space.chosen[2, p]] + ahead * room[FREELY, i]
        if stage:
            room[AHEAD, i] += r * inner(space.mobility[p, :n], room[FORCES, :n])
            room[BASE, i] += r * room[TWISTS, i]


@called_fast
def give(address):
    """Set the mean wrenches of a step, and the accelerations of the bodies by them."""
    space = workspace(address)
    step, vectors, gained = space.step[0], space.vectors, space.gained[0]
    for i in range(6 * step.bodies):
        row = 6 * space.chosen[0, i // 6] + i % 6
        vectors[steps.MEAN, row], vectors[steps.END, row] = space.room[SUM, i], space.room[FORCES, i]
    for k in range(len(gained)):
        gained[k] = 0.0
    for p in range(step.able):
        for k in range(len(gained)):
            gained[k] += space.answers[k, p] * space.room[SUM, space.chosen[1, p]]
    for i in range(len(vectors[steps.GAINED])):
        vectors[steps.GAINED, i] = inner(space.jacobian[i], gained)


def lift(address):
    """Find, by bisection, the height at which the limit force of sinking carries the robot."""
    space = workspace(address)
    step, bodies, high = space.step[0], space.bodies, -np.inf
    for b in range(len(bodies)):
        body, frame = bodies[b], space.frame[b]
        for i in range(6):
            space.room[BASE, 6 * b + i] = space.room[TWISTS, 6 * b + i] = 0.0
        for i in range(9):
            frame[i] = space.attitude[body.row, i]
        count = body.last - body.first
        for i in range(3 * count):
            space.bristles[0, 3 * body.first + i] = -frame[6 + i // count]
        high, space.chosen[0, b] = max(high, body.reach - space.places[body.row, 2]), b
    low, step.bodies, step.lift = high - DEEPEST, len(bodies), np.nan
    while high - low > 1e-13:
        middle, more = 0.5 * (low + high), -step.weight
        for b in range(len(bodies)):
            bodies[b].height = space.places[bodies[b].row, 2] + middle
        call(space.outside[0, steps.WRENCHES], (address, 0, 0.0))
        for b in range(len(bodies)):
            for a in range(3):
                more += space.frame[b, 6 + a] * space.room[FORCES, 6 * b + a]
        if more > 0.0:
            low = step.lift = middle
        else:
            high = middle
    step.evaluations = 0
