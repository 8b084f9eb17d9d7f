"""One time step of MuJoCo on sand: the meaning of a call of the callback, and the beginning of a step.

MuJoCo's Euler and implicit steps move places by the new velocity, which is the leapfrog: velocities belong
to the middle of steps, and to places half a step back. RK4's belong to the same time.
"""

from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from footopt.compiled import called_fast, inlined, inlined_fast
from footopt.mujoco.faces import AREA, COLUMNS, NX, NZ, X, Y, Z, cross, dot, plus
from footopt.mujoco.joints import FREEDOM, SERVO

AGAIN, NEW, HOLD, RESTART = range(4)

COUNTED = ("steps", "evaluations", "failures", "restarts")
#: A step of MuJoCo.
STEP = np.dtype(
    [
        ("dt", float),  # s
        ("rk4", np.int64),  # 1 where the integrator is RK4, 0 elsewhere
        ("damped", np.int64),  # 1 where MuJoCo's integrator takes joints' damping implicitly ...
        ("implicit", np.int64),  # ... and servos' where this is 1 ...
        ("freed", np.int64),  # ... but not at the limits of their joints where this is 1 ...
        ("ahead", float),  # ... and stiffness over this time, s
        ("still", np.int64),  # 1 where depths are those of a stage's beginning
        ("time", float),  # s: MuJoCo's
        ("bypass", np.int64),  # 1 where the gates of effects are not applied
        ("bodies", np.int64),  # near the sand
        ("able", np.int64),  # rows of their twists in which the robot can move
        ("length", float),  # over which bristles bend, m
        ("gravity", float, 3),  # m/s^2
        ("weight", float),  # N, for which a lift is asked; 0 for a step
        ("lift", float),  # m; NaN where nothing carries the weight
        *[(name, np.int64) for name in COUNTED],
    ]
)

#: A body on the sand.
BODY = np.dtype(
    [
        ("row", np.int64),  # in MuJoCo
        ("first", np.int64),  # of its faces
        ("last", np.int64),  # one past the last of them
        ("law", float, 9),  # N/m^3: `sand.law.Law`
        ("reach", float),  # of its farthest face, m
        ("half", float),  # length of a face over its area, half of it, 1/m
        ("near", np.int64),  # 1 if it may touch sand within the step
        ("height", float),  # of its origin in the middle of the step, m
        ("power", float),  # of the sand at the step's end, W
        ("depth", float),  # of the deepest end of a face at the step's beginning, m
    ]
)

#: Rows of `Workspace.vectors`: twists at the beginning, m/s and rad/s; mean wrenches over the step before, N
#: and N m; accelerations by all but the sand, and by the sand; mean wrenches that it gives, and the end's.
TWIST, BEFORE, FREE, GAINED, MEAN, END = range(6)

#: Columns of `Workspace.moment`: whether there was a step, when it began, s, and RK4's stages since then.
BEGAN, START, SEEN = range(3)
#: Rows of `Workspace.spent`: work of the sand over the steps before, J, and over the step.
WORK, PENDING = range(2)
#: Rows of `Workspace.drift`: speeds; by how much more joints and servos pull back than in the step before,
#: N m, and its part that this step's servos do not change; how speeds changed but for the sand; the servos'
#: torques, N m, and the damping that MuJoCo's integrator adds to the inertia, N m s.
SPEED, PULL, PAST, CHANGE, TORQUE, ADDED, DRIFT = range(7)

#: Addresses: functions of MuJoCo's, of footopt's, and what is read and written.
GET_STATE, JAC_BODY, WARN, BEGIN, PREPARE, NEWTON, BEND, WRENCHES, TIME, JACOBIAN, WORDS, OUTSIDE = range(12)

#: Columns of each body in `Workspace.trace`: force at its end in the world's axes, N, power, W,
#: work since the first step, J, and depth at its beginning, m.
TRACED = ("fx", "fy", "fz", "power", "work", "depth")


class Workspace(NamedTuple):
    """All that a step reads and writes: MuJoCo's own arrays, and those of b bodies with p faces."""

    step: Any  # (1,) of `STEP`
    bodies: Any  # (b,) of `BODY`
    freedoms: Any  # (nv,) of `FREEDOM`
    servos: Any  # of `SERVO`
    columns: Any  # (1, nC): of MuJoCo's inertia
    inertia: Any  # (1, nC): MuJoCo's
    places: Any  # (nbody, 3), m: MuJoCo's xpos
    attitude: Any  # (nbody, 9): xmat
    velocity: Any  # (1, nv): qvel
    passive: Any  # (1, nv): qfrc_passive
    controls: Any  # (1, nu): ctrl
    activations: Any  # (1, na): act
    lengths: Any  # (1, outputs): actuator_length
    speeds: Any  # (1, outputs): actuator_velocity
    faces: Any  # (1, 10 p): `faces.X` and so on, a body's as (10, its faces)
    moment: Any  # (1, 3)
    spent: Any  # (2, b)
    drift: Any  # (`DRIFT`, nv)
    gained: Any  # (1, nv): by the mean wrenches
    bristles: Any  # (3, 3 p): at the step's beginning, middle, end
    vectors: Any  # (6, 6 b): of the bodies' origins in their own axes, linear, then angular; see `TWIST`
    jacobian: Any  # (6 b, nv): of all bodies; `align` turns it
    frame: Any  # (b, 9): as attitude, in the middle of the step
    trace: Any  # (rows, 6 b): of each step until it is full, of each body `TRACED`
    history: Any  # (rows, 3 p): bristles at the ends of steps
    chosen: Any  # (3, 6 b): bodies near the sand, and rows of their twists that move, of those and of all
    factor: Any  # (1, nC): of the inertia
    answers: Any  # (nv, 6 b): accelerations by wrenches, of the rows that move
    mobility: Any  # (6 b, 6 b): W, of the rows that move
    stiffness: Any  # (6 b, 6): dF/dV of the near bodies
    system: Any  # (6 b + 1, 6 b + 1): of equations
    room: Any  # (`implicit.ROOM`, 6 b)
    outside: Any  # (1, `OUTSIDE`): addresses


WHOLE = ("columns", "chosen", "outside")  # are whole numbers


def _workspace(typingctx: Any, table: Any) -> Any:
    """The `Workspace` of the arrays whose addresses and shapes are in a table at an address."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        whole, arrays = ir.IntType(64), []
        rows = builder.inttoptr(args[0], whole.as_pointer())
        for row, kind in enumerate(signature.return_type):
            places = (builder.gep(rows, [whole(3 * row + i)]) for i in range(1 + kind.ndim))
            address, *shape = (builder.load(place) for place in places)
            array, size = context.make_array(kind)(context, builder), context.get_data_type(kind.dtype)
            size = whole(context.get_abi_sizeof(size))
            strides = [*(builder.mul(columns, size) for columns in shape[1:]), size]
            data = builder.inttoptr(address, array.data.type)
            populate_array(array, data, shape, strides, size, meminfo=None)
            arrays.append(array._getvalue())
        return context.make_tuple(builder, signature.return_type, arrays)

    kinds = {"step": STEP, "bodies": BODY, "freedoms": FREEDOM, "servos": SERVO}
    plain = {name: np.dtype(np.int64 if name in WHOLE else float) for name in Workspace._fields}
    given = (plain | kinds).values()
    arrays = [types.Array(from_dtype(of), 2 - bool(of.fields), "C", aligned=not of.fields) for of in given]
    return types.NamedTuple(arrays, Workspace)(table), generate


workspace = intrinsic(_workspace)


@inlined
def meaning_of(step, moment):
    """The meaning of a call: the same step AGAIN, a NEW one, a stage of RK4 to HOLD, or a RESTART."""
    passed = (step.time - moment[START]) / step.dt if moment[BEGAN] > 0.0 else np.inf
    if abs(passed) < 1e-6:
        return AGAIN
    ends = abs(passed - 1.0) < 1e-6
    if step.rk4 and (abs(passed - 0.5) < 1e-6 or (ends and moment[SEEN] == 1.0)):
        moment[SEEN] = 2.0 if ends else 1.0
        return HOLD
    moment[BEGAN], moment[START], moment[SEEN] = 1.0, step.time, 0.0
    return NEW if ends else RESTART


@inlined_fast
def inner(a, b):
    """The sum of a[i] b[i].

    A loop that sums and stores is compiled twice, vectorised and not: how near its arrays lie to each other
    chooses, and so decides the last bit. Sums are therefore loops of their own.
    """
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@called_fast
def align(address):
    """Turn the Jacobian from the world's axes to the bodies' own ones in the middle of the step."""
    space = workspace(address)
    for i in range(0, len(space.jacobian), 3):
        rows, axes = space.jacobian[i : i + 3], space.frame[i // 6]
        for j in range(rows.shape[1]):
            row = rows[0, j], rows[1, j], rows[2, j]
            for a in range(3):
                rows[a, j] = dot((axes[a], axes[3 + a], axes[6 + a]), row)


@called_fast
def pulls(address, meaning):
    """Find by how much more joints and servos pull back in a step than in the one before."""
    space = workspace(address)
    step, drift, dt = space.step[0], space.drift, space.step[0].dt
    for k in range(len(space.freedoms)):
        freedom, speed = space.freedoms[k], space.velocity[0, k]
        if meaning != AGAIN:
            gain = speed - drift[SPEED, k]
            pull = freedom.damping * gain + dt * freedom.stiffness * speed + drift[TORQUE, k]
            drift[CHANGE, k] = gain - dt * space.gained[0, k] if meaning == NEW else 0.0
            drift[PAST, k] = pull - drift[ADDED, k] * drift[CHANGE, k] if meaning == NEW else 0.0
        drift[SPEED, k], drift[TORQUE, k], drift[ADDED, k], drift[PULL, k] = speed, 0.0, 0.0, 0.0
        space.gained[0, k] = 0.0
    for i in range(len(space.servos)):
        servo = space.servos[i]
        k, length, speed = servo.freedom, space.lengths[0, servo.output], space.speeds[0, servo.output]
        direct = servo.control >= 0
        given = space.controls[0, servo.control] if direct else space.activations[0, servo.activation]
        given = min(max(given, servo.inputs[0]), servo.inputs[1])
        by_length, by_speed = servo.bias[1] + servo.gain[1] * given, servo.bias[2] + servo.gain[2] * given
        free = servo.bias[0] + servo.gain[0] * given + by_length * length + by_speed * speed
        drift[TORQUE, k] += servo.gear * min(max(free, servo.forces[0]), servo.forces[1])
        if step.implicit and servo.forces[0] < free < servo.forces[1]:
            drift[ADDED, k] -= servo.gear * servo.gear * (by_speed + step.ahead * by_length)
            drift[PULL, k] -= servo.gear * step.ahead * by_length * speed
    for k in range(len(space.freedoms)):
        freedom, torque = space.freedoms[k], drift[TORQUE, k]
        drift[TORQUE, k] = min(max(torque, freedom.torques[0]), freedom.torques[1])
        if step.freed and drift[TORQUE, k] != torque:
            drift[ADDED, k] = drift[PULL, k] = 0.0
        ahead = step.ahead * freedom.stiffness
        drift[TORQUE, k] -= drift[PULL, k] + ahead * drift[SPEED, k]
        drift[ADDED, k] += step.damped * freedom.damping + ahead
        drift[PULL, k] = drift[PAST, k] - drift[TORQUE, k] + drift[ADDED, k] * drift[CHANGE, k]


def begin(address, meaning):
    """Begin a step, after a RESTART with all sunk straight down; whether the sand is to be solved for."""
    space = workspace(address)
    if meaning == HOLD:
        align(address)
        return False
    step, vectors, velocity, any_near = space.step[0], space.vectors, space.velocity[0], False
    late = 0.5 * step.dt * step.rk4  # from MuJoCo's places to the middle
    for b in range(len(space.bodies)):
        body, rows = space.bodies[b], space.jacobian[6 * b : 6 * b + 6]
        vz = inner(rows[2], velocity)
        spin = inner(rows[3], velocity), inner(rows[4], velocity), inner(rows[5], velocity)
        axes, height, frame = space.attitude[body.row], space.places[body.row, 2], space.frame[b]
        for a in range(3):
            axis = axes[a], axes[3 + a], axes[6 + a]
            frame[a], frame[3 + a], frame[6 + a] = plus(axis, late, cross(spin, axis))
        body.height = height + late * vz
        turned = abs(spin[0]) + abs(spin[1])
        margin = 2.0 * step.dt * (abs(vz) + turned * body.reach + 10.0 * step.dt)
        low = end = np.inf
        if height - body.reach < margin:
            faces = space.faces[0, COLUMNS * body.first : COLUMNS * body.last]
            faces, up = faces.reshape(COLUMNS, body.last - body.first), (axes[6], axes[7], axes[8])
            for i in range(faces.shape[1]):
                middle = height + dot(up, (faces[X, i], faces[Y, i], faces[Z, i]))
                rise = body.half * faces[AREA, i] * abs(up[0] * faces[NZ, i] - up[2] * faces[NX, i])
                low, end = min(low, middle), min(end, middle - rise)
        body.depth, body.near = max(-end, 0.0), low < margin
        any_near = any_near or low < margin
        if meaning == NEW:
            space.spent[WORK, b] += space.spent[PENDING, b]
        elif meaning == RESTART:
            count = body.last - body.first
            for i in range(3 * count):
                space.bristles[2, 3 * body.first + i] = -frame[6 + i // count]
        body.power = space.spent[PENDING, b] = 0.0
    align(address)
    step.steps += meaning == NEW
    step.restarts += meaning == RESTART
    for i in range(vectors.shape[1]):
        twist, frame = inner(space.jacobian[i], velocity), space.frame[i // 6]
        if meaning == NEW:
            vectors[BEFORE, i] = vectors[MEAN, i]
            vectors[FREE, i] = (twist - vectors[TWIST, i]) / step.dt - vectors[GAINED, i]
        elif meaning == RESTART:
            vectors[BEFORE, i] = vectors[FREE, i] = 0.0
            if i % 6 < 3:
                g, a = step.gravity, i % 6
                vectors[FREE, i] = dot((g[0], g[1], g[2]), (frame[a], frame[3 + a], frame[6 + a]))
        vectors[TWIST, i] = twist
        vectors[GAINED, i] = vectors[MEAN, i] = vectors[END, i] = 0.0
    pulls(address, meaning)
    for i in range(space.bristles.shape[1]):
        if meaning != AGAIN:
            space.bristles[0, i] = space.bristles[2, i]
        space.bristles[2, i] = 0.0
    return any_near


@called_fast
def leave_trace(address):
    """Write a step into the trace, if there is room."""
    space = workspace(address)
    row = space.step[0].steps
    if row >= len(space.trace):
        return
    for b in range(len(space.bodies)):
        body, axes, out = space.bodies[b], space.frame[b], space.trace[row, 6 * b : 6 * b + 6]
        f = space.vectors[END, 6 * b], space.vectors[END, 6 * b + 1], space.vectors[END, 6 * b + 2]
        for a in range(3):
            out[a] = dot((axes[3 * a], axes[3 * a + 1], axes[3 * a + 2]), f)
        out[3], out[4], out[5] = body.power, space.spent[WORK, b] + space.spent[PENDING, b], body.depth
    if row < len(space.history):
        for i in range(space.bristles.shape[1]):
            space.history[row, i] = space.bristles[2, i]
