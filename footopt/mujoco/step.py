"""One time step of MuJoCo on sand: all that it reads and writes, and the meaning of a call of the callback.

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
from footopt.mujoco.faces import dot
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

#: What joints, servos and limits do to a degree of freedom.
PULL = np.dtype(
    [
        ("speed", float),
        ("more", float),  # by how much more they pull back than in the step before, N m, ...
        ("past", float),  # ... and its part that this step does not change
        ("change", float),  # of the speed in the step before, but for the sand
        ("torque", float),  # of servos and limits, N m
        ("added", float),  # damping that MuJoCo's integrator adds to the inertia, N m s
        ("held", float),  # 1 where a limit pushes
    ]
)

#: Rows of `Workspace.vectors`: twists at the beginning, m/s and rad/s; mean wrenches over the step before, N
#: and N m; accelerations by all but the sand, and by the sand; mean wrenches that it gives, and the end's.
TWIST, BEFORE, FREE, GAINED, MEAN, END = range(6)

#: Columns of `Workspace.moment`: whether there was a step, when it began, s, and RK4's stages since then.
BEGAN, START, SEEN = range(3)
#: Rows of `Workspace.spent`: work of the sand over the steps before, J, and over the step.
WORK, PENDING = range(2)

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
    angles: Any  # (1, nq): qpos
    velocity: Any  # (1, nv): qvel
    passive: Any  # (1, nv): qfrc_passive
    controls: Any  # (1, nu): ctrl
    activations: Any  # (1, na): act
    lengths: Any  # (1, outputs): actuator_length
    speeds: Any  # (1, outputs): actuator_velocity
    faces: Any  # (1, 10 p): `faces.X` and so on, a body's as (10, its faces)
    moment: Any  # (1, 3)
    spent: Any  # (2, b)
    pulls: Any  # (nv,) of `PULL`
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

    kinds = {"step": STEP, "bodies": BODY, "freedoms": FREEDOM, "servos": SERVO, "pulls": PULL}
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
