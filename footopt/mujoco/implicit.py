"""Which constant forces over a time step bring the feet where sand would bring them.

The law is stiff: sand holds what stands, and a force from the beginning of a step is that of where the body
was. So a step solves the motion of the feet alone over its length, by SDIRK2 (`walk.steppers.implicit`),

    dV/dt = a + W F(V, places),   W = J inv(M + dt D) J'

with the twists V of the bodies near the sand, J their Jacobian, M MuJoCo's inertia, D the damping of joints
and servos that its integrator takes implicitly, and F the sand's wrenches, all in the bodies' own axes. a is
how they accelerate by all but sand: that of the step before, from how their twists changed, less what springs
and dampers of joints and servos pull back since. MuJoCo is given the mean of F.
"""

from footopt.compiled import called_fast, inlined_fast
from footopt.effects import Laws
from footopt.mujoco.faces import COLUMNS, cross, dot, forces, moved, plus
from footopt.mujoco.step import BEFORE, END, FREE, GAINED, MEAN, TWIST, inner
from footopt.walk.contact import rsqrt
from footopt.walk.steppers.implicit import SDIRK2

GAMMA = SDIRK2().gamma
MAX_NEWTON = 100  # evaluations of one stage, line search included
#: Rows of `Workspace.room`, of the twists and wrenches of the near bodies.
BASE, FREELY, AHEAD, TWISTS, FORCES, SUM, LOAD, DV, DLOAD, REST, WAY, ROOM = range(12)
TIGHT = 1e-3  # last step of Newton's method over the speed of the feet; forces err by its square


@called_fast
def responses(space, rows):
    """inv(M + dt D) J' of rows of J by L' L along the tree of joints (Featherstone 2008, section 6.5)."""
    freedoms, columns, m, x, n = space.freedoms, space.columns[0], space.factor[0], space.answers, len(rows)
    for a in range(len(m)):
        m[a] = space.inertia[0, a]
    for k in range(len(freedoms)):
        m[freedoms[k].last] += space.step[0].dt * freedoms[k].implicit
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
    """Height of a body's origin at a stage's end, where it has moved on its way, and up in its axes."""
    up, turned = (axes[6], axes[7], axes[8]), (way[3], way[4], way[5])
    return body.height + dot(up, (way[0], way[1], way[2])), plus(up, -1.0, cross(turned, up))


@called_fast
def solution(space, moves, c, rest, y):
    """Solve (1 - c W dF/dV) y = c W rest by elimination with pivots, for what moves; the rest of y stays 0.

    That takes a quarter of LAPACK's time, and nothing is allocated: arrays cost as much as what is in them.
    """
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


@called_fast
def newton(space, effects, meshes, near, moves, c, turn, h0, v0, v, f):
    """Solve v = v0 + c W f, f = F(v), for the near bodies' twists v and wrenches, from f; whether it can be.

    Sand resists motion, so that dv . (F - f) falls along a step dv: a step is cut where it changes its sign,
    as where a face comes to rest. The size of F - f rises there.
    """
    n, room, stiffness = len(f), space.room, space.stiffness
    load, dv, dload, rest = room[LOAD, :n], room[DV, :n], room[DLOAD, :n], room[REST, :n]
    slope, t, low, high, at_low, at_high = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # of a step: 0 before, 1 in full
    for i in range(n):
        load[i], dv[i], v[i] = f[i], 0.0, 0.0
    for p in range(len(moves)):
        v[moves[p]] = v0[moves[p]] + c * inner(space.mobility[p, :n], load)
    for _ in range(MAX_NEWTON):
        space.step[0].evaluations += 1
        for k in range(len(near)):
            body, axes, six = space.bodies[near[k]], space.frame[near[k]], v[6 * k : 6 * k + 6]
            up, x = (axes[6], axes[7], axes[8]), (axes[0], axes[1], axes[2])
            way = room[WAY, 6 * k : 6 * k + 6]
            for i in range(6):
                way[i] = room[BASE, 6 * k + i] + c * six[i]
            surface, forward = surface_of(body, axes, way), (space.places[body.row, 0], x)
            first, last, plain = body.first, body.last, Laws(effects.loads, None, effects.pushes)
            faces = space.faces[0, COLUMNS * first : COLUMNS * last].reshape(COLUMNS, last - first)
            state = faces, body.law, up, surface, forward, six, c, turn
            h = h0[3 * first : 3 * last].reshape(3, last - first)
            if meshes is not None and body.mesh:
                total, rows = forces(body.friction, plain, *state, h)
            elif space.step[0].bypass:
                total, rows = forces(None, plain, *state, h)
            else:
                total, rows = forces(None, effects, *state, h)
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
            solution(space, moves, c, rest, dv)
            for i in range(n):
                dload[i] = rest[i] + inner(stiffness[i], dv[i - i % 6 : i - i % 6 + 6])
            at_low = slope = inner(dv, rest)
            share, t, low, high, at_high = 1.0, 0.0, 0.0, 1.0, 0.0
        t += share
        speed, change = 0.1 / turn, 0.0
        for i in range(n):
            v[i] += share * dv[i]
            load[i] += share * dload[i]
            wide = space.bodies[near[i // 6]].reach if i % 6 > 2 else 1.0  # makes speeds of twists
            speed, change = max(speed, abs(wide * v[i])), max(change, abs(wide * dv[i]))
        if share == 1.0 and change <= TIGHT * speed + 1e-13:
            for i in range(n):
                f[i] = load[i]  # forces follow the last change to first order
            return True
    return False


@called_fast
def bend(space, near, v, c, turn, before, after, share):
    """Bend bristles from before to after by a share, 0 in the air, where bodies have moved with twists v."""
    for k in range(len(near)):
        body, way, twist = space.bodies[near[k]], space.room[WAY, 6 * k : 6 * k + 6], v[6 * k : 6 * k + 6]
        for i in range(6):
            way[i] = space.room[BASE, 6 * k + i] + c * twist[i]
        surface = surface_of(body, space.frame[near[k]], way)
        first, last = body.first, body.last
        faces = space.faces[0, COLUMNS * first : COLUMNS * last].reshape(COLUMNS, last - first)
        h = before[3 * first : 3 * last].reshape(3, last - first)
        new = after[3 * first : 3 * last].reshape(3, last - first)
        for i in range(faces.shape[1]):
            r, _, bent = moved(faces, h, i, twist, turn)
            q = rsqrt(max(dot(bent, bent), 1.0))
            inside = 1.0 if surface[0] + dot(surface[1], r) < 0.0 else 0.0
            for a in range(3):
                new[a, i] = inside * (h[a, i] + share * (bent[a] * q - h[a, i]))


@called_fast
def chosen(space):
    """Choose the bodies near the sand, and rows of their twists in which the robot can move; how many."""
    near, moves, rows, bodies, n = space.chosen[0], space.chosen[1], space.chosen[2], 0, 0
    for b in range(len(space.bodies)):
        if space.bodies[b].near:
            near[bodies] = b
            for i in range(6):
                row = space.jacobian[6 * b + i]
                if inner(row, row) > 0.0:
                    moves[n], rows[n] = 6 * bodies + i, 6 * b + i
                    n += 1
            bodies += 1
    return bodies, n


@called_fast
def solve(space, effects, meshes):
    """Find the mean wrenches of a step on the bodies."""
    dt, vectors, h, room = space.step[0].dt, space.vectors, space.bristles, space.room
    c, r = GAMMA * dt, (1.0 - GAMMA) * dt
    bodies, able = chosen(space)
    near, moves, rows = space.chosen[0, :bodies], space.chosen[1, :able], space.chosen[2, :able]
    n, x = 6 * len(near), space.answers
    responses(space, rows)
    base, a, mean, v, f = (
        room[BASE, :n], room[FREELY, :n], room[SUM, :n], room[TWISTS, :n], room[FORCES, :n]
    )  # fmt: skip
    for p in range(len(moves)):
        row, own = space.mobility[p], space.jacobian[rows[p]]
        for i in range(n):
            row[i] = 0.0
        for k in range(len(own)):
            for q in range(len(moves)):
                row[moves[q]] += own[k] * x[k, q]
    for i in range(n):
        row = 6 * near[i // 6] + i % 6
        base[i], f[i], mean[i] = -0.5 * dt * vectors[TWIST, row], vectors[BEFORE, row], 0.0
    for p in range(len(moves)):
        a[moves[p]] = vectors[FREE, rows[p]]
    for k in range(len(space.freedoms)):
        for p in range(len(moves)):
            a[moves[p]] -= x[k, p] * space.freedoms[k].pull
    turn = c / space.step[0].length
    for stage in range(2):  # of SDIRK2
        weight = c if stage else r
        for p in range(len(moves)):
            i = moves[p]
            room[AHEAD, i] = vectors[TWIST, rows[p]] + (dt if stage else c) * a[i]
            if stage:
                room[AHEAD, i] += r * inner(space.mobility[p, :n], f)
                base[i] += r * v[i]
        if not newton(space, effects, meshes, near, moves, c, turn, h[stage], room[AHEAD, :n], v, f):
            space.step[0].failures += 1
        bend(space, near, v, c, turn, h[stage], h[stage + 1], 1.0 if stage else r / c)
        for k in range(len(near)):
            body, six = space.bodies[near[k]], slice(6 * k, 6 * k + 6)
            body.power = inner(f[six], v[six])
            body.pending += weight * body.power
        for i in range(n):
            mean[i] += weight / dt * f[i]
    for i in range(n):
        row = 6 * near[i // 6] + i % 6
        vectors[MEAN, row], vectors[END, row] = mean[i], f[i]
    gained = space.gained[0]
    for k in range(len(gained)):
        gained[k] = 0.0
    for p in range(len(moves)):
        for k in range(len(gained)):
            gained[k] += x[k, p] * mean[moves[p]]
    for i in range(len(vectors[GAINED])):
        vectors[GAINED, i] = inner(space.jacobian[i], gained)
