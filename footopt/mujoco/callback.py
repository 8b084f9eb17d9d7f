"""The C function that MuJoCo calls in every step: it finds what is attached, and steps its sand."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import carray, cfunc, njit, types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from footopt.errors import needed
from footopt.mujoco.desk import HOLD, Desk, tick
from footopt.mujoco.step import hold, prepare, solve

#: MuJoCo's own functions that the callback calls, with the types of their arguments.
POINTER, INT = ctypes.c_void_p, ctypes.c_int
CALLED = {
    "mj_getState": (POINTER, POINTER, POINTER, INT),
    "mj_jacBody": (POINTER, POINTER, POINTER, POINTER, INT),
    "mj_solveM": (POINTER, POINTER, POINTER, POINTER, INT),
}

MOST = 256  # models on sand at once, in one process
WORDS = 3 * len(Desk._fields)
TIME = 1  # mjSTATE_TIME


@intrinsic
def _pointer(typingctx, address):
    """A whole number as a pointer."""

    def generate(context, builder, signature, args):
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return types.voidptr(address), generate


@lru_cache(maxsize=1)
def _library() -> tuple[Any, ...]:
    """MuJoCo's functions, as compiled code calls them."""
    folder = Path(needed("mujoco", "footopt.mujoco", "mujoco").__file__).parent
    paths = [
        p for pattern in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll") for p in folder.glob(pattern)
    ]
    library = ctypes.CDLL(str(paths[0]))
    for name, arguments in CALLED.items():
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, None
    return tuple(getattr(library, name) for name in CALLED)


def _reader(desk: Desk) -> Any:
    """A compiled function that makes a `Desk` of its arrays' addresses and shapes, three numbers each."""
    views = []
    for i, array in enumerate(desk):
        shape = ", ".join(f"spec[{3 * i + 1 + axis}]" for axis in range(array.ndim))
        views.append(f"carray(pointer(spec[{3 * i}]), ({shape},), {array.dtype})")
    names = {"carray": carray, "pointer": _pointer, "Desk": Desk, "float64": np.float64, "int64": np.int64}
    exec(f"def read(spec): return Desk({', '.join(views)})", names)
    return njit(names["read"])


def _compiled(acting: tuple[Any, ...], reader: Any, table_address: int) -> Any:
    """What MuJoCo is to call: nothing, unless its mjData is in the table (`MOST`, 2) of data and specs."""
    get_state, jacobian_of, solve_mass = _library()

    @njit(error_model="numpy")
    def passive(model, data):
        table = carray(_pointer(table_address), (MOST, 2), np.int64)
        for row in range(MOST):
            if table[row, 0] == data:
                desk, time = reader(carray(_pointer(table[row, 1]), (WORDS,), np.int64)), np.zeros(1)
                get_state(_pointer(model), _pointer(data), time.ctypes, TIME)
                meaning = tick(desk.clock, time[0])
                for b in range(len(desk.bodies)):
                    linear, angular = desk.jacobian[6 * b : 6 * b + 3], desk.jacobian[6 * b + 3 : 6 * b + 6]
                    body = np.int32(desk.bodies[b, 0])
                    jacobian_of(_pointer(model), _pointer(data), linear.ctypes, angular.ctypes, body)
                if meaning == HOLD:
                    hold(desk)
                else:
                    count = prepare(desk, meaning)
                    if count > 0:
                        solve_mass(
                            _pointer(model), _pointer(data), desk.answer.ctypes, desk.own.ctypes, 6 * count
                        )
                    solve(desk, acting, count)

    return passive


#: By the effects: a compiled callback, and its table.
KERNELS: dict[str, tuple[Any, NDArray[np.int64]]] = {}


def kernel(acting: tuple[Any, ...], desk: Desk) -> str:
    """The key of the callback for one set of effects, which is compiled once."""
    key = repr(acting)
    if key not in KERNELS:
        table = np.zeros((MOST, 2), np.int64)
        KERNELS[key] = _compiled(acting, _reader(desk), table.ctypes.data), table
    return key


@lru_cache
def callback(keys: tuple[str, ...]) -> Any:
    """One C function that calls each of some callbacks."""
    first, *others = (KERNELS[key][0] for key in keys)
    for other in others:
        first = _both(first, other)

    @cfunc(types.void(types.intp, types.intp))
    def passive(model, data):
        first(model, data)

    return passive


def _both(one: Any, two: Any) -> Any:
    @njit
    def call(model, data):
        one(model, data)
        two(model, data)

    return call
