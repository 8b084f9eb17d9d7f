"""The C function that MuJoCo calls in every step: it finds what is attached, and steps its sand."""

import ctypes
import hashlib
import pickle
from functools import lru_cache
from typing import Any

import numpy as np
from numba import carray, cfunc, types

from footopt.effects.base import Laws
from footopt.mujoco import implicit
from footopt.mujoco import step as steps
from footopt.mujoco.native import call, entry, pointer
from footopt.walk.own_code import fingerprint, own_code

MOST = 256  # models on sand at once in one process
#: A row for each attached model: addresses of its MjData, of its `Contact.addresses`, of its compiled step.
ATTACHED = np.zeros((MOST, 3), np.int64)
#: Message for bristles that are reset after a jump in time.
FORGOT = ctypes.create_string_buffer(b"footopt: time or time step jumped: sand about the feet began anew")


def passive(model, data, address):
    """Step the sand of a `Workspace`."""
    space = steps.workspace(address)
    step, outside, columns = space.step[0], space.outside[0], space.jacobian.shape[1]
    call(outside[steps.GET_STATE], (model, data, outside[steps.TIME], np.int32(1)))  # mjSTATE_TIME
    meaning = steps.meaning_of(step, space.moment[0])
    for b in range(len(space.bodies)):
        linear, body = outside[steps.JACOBIAN] + 48 * columns * b, np.int32(space.bodies[b].row)
        call(outside[steps.JAC_BODY], (model, data, linear, linear + 24 * columns, body))
    if call(outside[steps.BEGIN], (address, meaning)):
        call(outside[steps.PREPARE], (address,))
        for stage in range(2):
            implicit.predict(address, stage)
            call(outside[steps.NEWTON], (address, stage))
            call(outside[steps.BEND], (address, stage))
        implicit.give(address)
        if meaning == steps.RESTART and step.restarts == 2 and step.time > 0.0:
            call(outside[steps.WARN], (outside[steps.WORDS],))  # the first time that bristles are reset
    if meaning != steps.HOLD:
        steps.leave_trace(address)
    for i in range(len(space.jacobian)):
        for k in range(columns):
            space.passive[0, k] += space.jacobian[i, k] * space.vectors[steps.MEAN, i]


@lru_cache(maxsize=1)
def compiled() -> dict[Any, Any]:
    """The compiled functions of a step that are the same for any sand, by their numbers or names."""
    one, whole = types.intp, types.int32
    return {
        steps.BEGIN: entry(steps.begin, one, one, returns=whole),
        steps.PREPARE: entry(implicit.prepare, one),
        steps.NEWTON: entry(implicit.newton, one, one),
        steps.BEND: entry(implicit.bend, one, one),
        "lift": entry(implicit.lift, one),
        "passive": entry(passive, one, one, one),
    }


def with_effects(acting: Laws) -> Any:
    """The wrenches under some effects."""
    kinds = tuple(tuple(map(type, one or ())) for one in acting)
    values = pickle.dumps([[tuple(law) for law in one or ()] for one in acting])
    return _with_effects(kinds, values, tuple(map(fingerprint, own_code(acting.all))))


@lru_cache
def _with_effects(kinds: tuple[tuple[type[Any], ...], ...], values: bytes, own: tuple[Any, ...]) -> Any:
    made = (
        [kind(*row) for kind, row in zip(*one, strict=True)]
        for one in zip(kinds, pickle.loads(values), strict=True)
    )
    acting = Laws(*(tuple(one) or None for one in made))

    def wrenches(address, stage, c):
        implicit.wrenches(address, acting, stage, c)

    named = repr([[kind.__qualname__ for kind in one] for one in kinds]).encode()
    wrenches.__qualname__ = f"wrenches_{hashlib.sha256(named + values).hexdigest()[:16]}"  # a file of its own
    return entry(wrenches, types.intp, types.intp, types.float64, keep=not own)


@lru_cache(maxsize=1)
def callback() -> Any:
    """The function that MuJoCo calls; it does nothing where mjData is not `ATTACHED`."""
    table_address = ATTACHED.ctypes.data

    @cfunc(types.void(types.intp, types.intp))
    def passive(model, data):
        table = carray(pointer(table_address), (MOST, 3), np.int64)
        for row in range(MOST):
            if table[row, 0] == data:
                call(table[row, 2], (model, data, table[row, 1]))
                return

    return passive.ctypes
