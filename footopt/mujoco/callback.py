"""The C function that MuJoCo calls in every step: it finds what is attached, and steps its sand."""

import ctypes
import hashlib
import pickle
from functools import lru_cache
from typing import Any

import numpy as np
from numba import carray, cfunc, types

from footopt.mujoco import implicit
from footopt.mujoco import step as steps
from footopt.mujoco.native import call, entry, pointer
from footopt.walk.own_code import own_code

MOST = 256  # models on sand at once in one process
#: Models that are attached: addresses of its MjData and of its `Contact.addresses`.
ATTACHED = np.zeros((MOST, 2), np.int64)
#: A message for bristles that begin anew after a jump in time.
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
    if steps.begin(address, meaning):
        implicit.prepare(address)
        for stage in range(2):
            implicit.predict(address, stage)
            implicit.newton(address, stage)
            implicit.bend(address, stage)
        implicit.give(address)
        if meaning == steps.RESTART and step.restarts == 2 and step.time > 0.0:
            call(outside[steps.WARN], (outside[steps.WORDS],))  # it forgets for the first time
    if meaning != steps.HOLD:
        steps.leave_trace(address)
    for i in range(len(space.jacobian)):
        for k in range(columns):
            space.passive[0, k] += space.jacobian[i, k] * space.vectors[steps.MEAN, i]


@lru_cache(maxsize=1)
def lift() -> Any:
    """`implicit.lift`, compiled."""
    return entry(implicit.lift, types.intp)


@lru_cache
def with_effects(effects: bytes, meshes: bool | None) -> Any:
    """The wrenches under some effects, pickled `Laws`."""
    acting = pickle.loads(effects)

    def wrenches(address, stage, c):
        implicit.wrenches(address, acting, meshes, stage, c)

    wrenches.__qualname__ = f"wrenches_{hashlib.sha256(effects).hexdigest()[:16]}"  # a file of its own
    return entry(wrenches, types.intp, types.intp, types.float64, keep=not own_code(acting.all))


@lru_cache(maxsize=1)
def callback() -> Any:
    """The function that MuJoCo calls."""
    attached, step = ATTACHED.ctypes.data, entry(passive, types.intp, types.intp, types.intp).address

    @cfunc(types.void(types.intp, types.intp))
    def called(model, data):
        table = carray(pointer(attached), (MOST, 2), np.int64)
        for row in range(MOST):
            if table[row, 0] == data:
                call(step, (model, data, table[row, 1]))
                return

    return called.ctypes
