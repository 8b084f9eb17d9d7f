"""The C function that MuJoCo calls in every step: it finds what is attached, and steps its sand."""

from __future__ import annotations

import ctypes
import pickle
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic

from footopt.errors import needed
from footopt.mujoco import step as steps
from footopt.mujoco.implicit import solve
from footopt.mujoco.step import BODY, FREEDOM, HOLD, MEAN, STEP, Workspace, align, product

MOST, ARRAYS = 256, len(Workspace._fields)  # models on sand at once in one process, and arrays of each
#: What is attached: address of its MjData, of its `Contact.addresses`, and of its compiled step.
ATTACHED = np.zeros((MOST, 3), np.int64)


@intrinsic
def _pointer(typingctx, address):
    """A whole number as a pointer."""

    def generate(context, builder, signature, args):
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return types.voidptr(address), generate


@intrinsic
def _call(typingctx, function, model, data, space):
    """Call the function of three whole numbers at an address."""

    def generate(context, builder, signature, args):
        kind = ir.FunctionType(ir.VoidType(), [argument.type for argument in args[1:]])
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), args[1:])
        return context.get_dummy_value()

    return types.void(function, model, data, space), generate


@njit
def _numbers(table, row):
    """An array of numbers at its address, with its shape."""
    return carray(_pointer(table[row, 0]), (table[row, 1], table[row, 2]), np.float64)


@lru_cache
def compiled(effects: bytes) -> Any:
    """The step with some effects, a pickled tuple of loads, gates and pushes, which is compiled once."""
    folder, acting = Path(needed("mujoco", "footopt.mujoco", "mujoco").__file__).parent, pickle.loads(effects)
    paths = [p for name in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll") for p in folder.glob(name)]
    library = ctypes.CDLL(str(paths[0]))
    get_state, jacobian_of = library.mj_getState, library.mj_jacBody
    for function, pointers in ((get_state, 3), (jacobian_of, 4)):
        function.argtypes, function.restype = [ctypes.c_void_p] * pointers + [ctypes.c_int], None

    @cfunc(types.void(types.intp, types.intp, types.intp))
    def passive(model, data, address):
        table, time = carray(_pointer(address), (ARRAYS, 3), np.int64), np.zeros(1)
        step = carray(_pointer(table[0, 0]), (table[0, 1],), STEP)
        bodies = carray(_pointer(table[1, 0]), (table[1, 1],), BODY)
        freedoms = carray(_pointer(table[2, 0]), (table[2, 1],), FREEDOM)
        columns = carray(_pointer(table[3, 0]), (table[3, 1], table[3, 2]), np.int64)
        space = Workspace(
            step, bodies, freedoms, columns, _numbers(table, 4), _numbers(table, 5), _numbers(table, 6),
            _numbers(table, 7), _numbers(table, 8), _numbers(table, 9), _numbers(table, 10),
            _numbers(table, 11), _numbers(table, 12), _numbers(table, 13),
        )  # fmt: skip
        get_state(_pointer(model), _pointer(data), time.ctypes, 1)  # mjSTATE_TIME
        meaning = steps.meaning_of(step[0], time[0])
        for b in range(len(bodies)):
            linear, angular = space.jacobian[6 * b : 6 * b + 3], space.jacobian[6 * b + 3 : 6 * b + 6]
            body = np.int32(bodies[b].row)
            jacobian_of(_pointer(model), _pointer(data), linear.ctypes, angular.ctypes, body)
        if meaning == HOLD:
            align(space)
        elif steps.begin(space, meaning):
            solve(space, acting)
        space.passive[0] += product(space.jacobian.T, space.vectors[MEAN])

    return passive


@lru_cache(maxsize=1)
def callback() -> Any:
    """What MuJoCo is to call: nothing, unless its mjData is `ATTACHED`."""
    table_address = ATTACHED.ctypes.data

    @cfunc(types.void(types.intp, types.intp))
    def passive(model, data):
        table = carray(_pointer(table_address), (MOST, 3), np.int64)
        for row in range(MOST):
            if table[row, 0] == data:
                _call(table[row, 2], model, data, table[row, 1])

    return passive.ctypes
