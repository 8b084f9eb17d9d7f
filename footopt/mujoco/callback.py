"""The C function that MuJoCo calls in every step: it finds what is attached, and steps its sand."""

from __future__ import annotations

import ctypes
import hashlib
import pickle
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

from footopt.compiled import kept
from footopt.errors import needed
from footopt.mujoco import step as steps
from footopt.mujoco.implicit import solve
from footopt.mujoco.step import BODY, FREEDOM, HOLD, MEAN, STEP, Workspace, align
from footopt.walk.own_code import own_code

MOST, ARRAYS = 256, len(Workspace._fields)  # models on sand at once in one process, and arrays of each
#: Models that are attached: address of its MjData, of its `Contact.addresses`, and of its compiled step.
ATTACHED = np.zeros((MOST, 3), np.int64)


def _pointer(typingctx: Any, address: Any) -> Any:
    """A whole number as a pointer."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return types.voidptr(address), generate


def _call(typingctx: Any, function: Any, arguments: Any) -> Any:
    """Call the function at an address with a tuple of whole numbers."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        given = cgutils.unpack_tuple(builder, args[1])
        kind = ir.FunctionType(ir.VoidType(), [argument.type for argument in given])
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), given)
        return context.get_dummy_value()

    return types.void(function, arguments), generate


#: For compiled code: a whole number as a pointer, and a call of the function at an address.
pointer, call = intrinsic(_pointer), intrinsic(_call)


@njit
def _numbers(row):
    """The array of numbers whose address and shape are in a row."""
    return carray(pointer(row[0]), (row[1], row[2]), np.float64)


@njit
def _whole(row):
    """The same of whole numbers."""
    return carray(pointer(row[0]), (row[1], row[2]), np.int64)


@lru_cache(maxsize=1)
def library() -> ctypes.CDLL:
    """MuJoCo's."""
    folder = Path(needed("mujoco", "footopt.mujoco", "mujoco").__file__).parent
    paths = [p for name in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll") for p in folder.glob(name)]
    return ctypes.CDLL(str(paths[0]))


@lru_cache(maxsize=1)
def functions() -> tuple[int, int, int]:
    """Addresses of mj_getState and mj_jacBody, and 0."""
    given = library().mj_getState, library().mj_jacBody
    state, jacobian = (ctypes.cast(function, ctypes.c_void_p) for function in given)
    return state.value or 0, jacobian.value or 0, 0


@lru_cache
def compiled(effects: bytes) -> Any:
    """The step with some effects, pickled `Laws`, which is compiled once."""
    acting = pickle.loads(effects)

    def passive(model, data, address):
        table, time = carray(pointer(address), (ARRAYS + 1, 3), np.int64), np.zeros(1)
        step = carray(pointer(table[0, 0]), (table[0, 1],), STEP)
        bodies = carray(pointer(table[1, 0]), (table[1, 1],), BODY)
        freedoms = carray(pointer(table[2, 0]), (table[2, 1],), FREEDOM)
        space = Workspace(
            step, bodies, freedoms, _whole(table[3]), _numbers(table[4]), _numbers(table[5]),
            _numbers(table[6]), _numbers(table[7]), _numbers(table[8]), _numbers(table[9]),
            _numbers(table[10]), _numbers(table[11]), _numbers(table[12]), _numbers(table[13]),
            _numbers(table[14]), _numbers(table[15]), _whole(table[16]), _numbers(table[17]),
            _numbers(table[18]), _numbers(table[19]), _numbers(table[20]), _numbers(table[21]),
            _numbers(table[22]), _numbers(table[23]),
        )  # fmt: skip
        call(table[ARRAYS, 0], (model, data, time.ctypes.data, np.int32(1)))  # mjSTATE_TIME
        meaning = steps.meaning_of(step[0], time[0])
        for b in range(len(bodies)):
            linear, angular = space.jacobian[6 * b : 6 * b + 3], space.jacobian[6 * b + 3 : 6 * b + 6]
            body = np.int32(bodies[b].row)
            call(table[ARRAYS, 1], (model, data, linear.ctypes.data, angular.ctypes.data, body))
        if meaning == HOLD:
            align(space)
        elif steps.begin(space, meaning):
            solve(space, acting)
        if meaning != HOLD:
            steps.leave_trace(space)
        for i in range(len(space.jacobian)):
            for k in range(space.jacobian.shape[1]):
                space.passive[0, k] += space.jacobian[i, k] * space.vectors[MEAN, i]

    passive.__qualname__ = f"passive_{hashlib.sha256(effects).hexdigest()[:16]}"  # a file of its own
    function = CFunc(passive, ((types.intp,) * 3, types.void), {}, {"error_model": "numpy"})
    function = function if own_code(acting.all) else kept(function)
    function.compile()
    return function


@lru_cache(maxsize=1)
def callback() -> Any:
    """The function that MuJoCo calls; it does nothing unless its mjData is `ATTACHED`."""
    table_address = ATTACHED.ctypes.data

    @cfunc(types.void(types.intp, types.intp))
    def passive(model, data):
        table = carray(pointer(table_address), (MOST, 3), np.int64)
        for row in range(MOST):
            if table[row, 0] == data:
                call(table[row, 2], (model, data, table[row, 1]))
                return

    return passive.ctypes
