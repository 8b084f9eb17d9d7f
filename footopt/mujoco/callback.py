"""The C function that MuJoCo calls in every step: it finds what is attached, and steps its sand."""

import ctypes
import hashlib
import pickle
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, from_dtype, types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from footopt.compiled import FAST, kept
from footopt.errors import needed
from footopt.mujoco import step as steps
from footopt.mujoco.implicit import solve
from footopt.mujoco.step import BODY, FREEDOM, HOLD, MEAN, RESTART, STEP, WHOLE, Workspace
from footopt.walk.own_code import own_code

MOST = 256  # models on sand at once in one process
#: Models that are attached: addresses of its MjData, of its `Contact.addresses`, of its compiled step and of
#: its first foot's name, which is never freed, and micrometres from its origin to its farthest face.
ATTACHED = np.zeros((MOST, 5), np.int64)
#: Messages for a foot that falls through the sand, and for bristles that begin anew after a jump in time.
LOST = ctypes.create_string_buffer(b"footopt: a foot fell through: this MjData has no sand; attach it, too")
FORGOT = ctypes.create_string_buffer(b"footopt: time or time step jumped: sand about the feet began anew")


def _pointer(typingctx: Any, address: Any) -> Any:
    """A whole number as a pointer."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return types.voidptr(address), generate


def _call(typingctx: Any, function: Any, arguments: Any) -> Any:
    """Call the function at an address with a tuple of whole numbers: the one that it returns, if it does."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        given = cgutils.unpack_tuple(builder, args[1])
        kind = ir.FunctionType(ir.IntType(32), [argument.type for argument in given])
        return builder.call(builder.inttoptr(args[0], kind.as_pointer()), given)

    return types.int32(function, arguments), generate


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

    kinds = {"step": STEP, "bodies": BODY, "freedoms": FREEDOM, **dict.fromkeys(WHOLE, np.dtype(np.int64))}
    given = (kinds.get(name, np.dtype(float)) for name in Workspace._fields)
    arrays = [types.Array(from_dtype(of), 2 - bool(of.fields), "C", aligned=not of.fields) for of in given]
    return types.NamedTuple(arrays, Workspace)(table), generate


#: For compiled code: a whole number as a pointer, a call of the function at an address, and a workspace.
pointer, call, workspace = intrinsic(_pointer), intrinsic(_call), intrinsic(_workspace)


@lru_cache(maxsize=1)
def library() -> ctypes.CDLL:
    """MuJoCo's."""
    folder = Path(needed("mujoco", "footopt.mujoco", "mujoco").__file__).parent
    paths = [p for name in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll") for p in folder.glob(name)]
    return ctypes.CDLL(str(paths[0]))


@lru_cache
def functions(*names: str) -> tuple[int, ...]:
    """Addresses of functions of MuJoCo's."""
    return tuple(ctypes.cast(getattr(library(), name), ctypes.c_void_p).value or 0 for name in names)


@lru_cache
def compiled(effects: bytes, meshes: bool | None) -> Any:
    """The step with some effects, pickled `Laws`, which is compiled once."""
    acting = pickle.loads(effects)

    def passive(model, data, address):
        space = workspace(address)
        outside = space.outside[0]
        call(outside[0], (model, data, outside[2], np.int32(1)))  # mjSTATE_TIME
        meaning, columns = steps.meaning_of(space.step[0]), space.jacobian.shape[1]
        for b in range(len(space.bodies)):
            linear, body = outside[3] + 48 * columns * b, np.int32(space.bodies[b].row)
            call(outside[1], (model, data, linear, linear + 24 * columns, body))
        if steps.begin(space, meaning):
            solve(space, acting, meshes)
            if meaning == RESTART and space.step[0].restarts == 2 and space.step[0].time > 0.0:
                call(outside[4], (outside[5],))  # it forgets for the first time
        if meaning != HOLD:
            steps.leave_trace(space)
        for i in range(len(space.jacobian)):
            for k in range(columns):
                space.passive[0, k] += space.jacobian[i, k] * space.vectors[MEAN, i]

    passive.__qualname__ = f"passive_{hashlib.sha256(effects).hexdigest()[:16]}"  # a file of its own
    function = CFunc(
        passive,
        ((types.intp,) * 3, types.void),
        {},
        {"error_model": "numpy", "fastmath": FAST, "_nrt": False},
    )
    function = function if own_code(acting.all) else kept(function)
    function.compile()
    return function


@lru_cache(maxsize=1)
def callback() -> Any:
    """The function that MuJoCo calls; where mjData is not `ATTACHED`, it stops feet that fall through."""
    table_address, lost = ATTACHED.ctypes.data, ctypes.addressof(LOST)
    row_of, place_of, stop = functions("mj_name2id", "mj_local2Global", "mju_error")

    @cfunc(types.void(types.intp, types.intp))
    def passive(model, data):
        table = carray(pointer(table_address), (MOST, 5), np.int64)
        for row in range(MOST):
            if table[row, 0] == data:
                call(table[row, 2], (model, data, table[row, 1]))
                return
        place = np.zeros(3)
        at = place.ctypes.data
        for row in range(MOST):
            body = call(row_of, (model, np.int32(1), table[row, 3])) if table[row, 0] else -1  # mjOBJ_BODY
            if body > 0:
                call(place_of, (data, at, 0, at, 0, body, np.uint8(1)))  # mjSAMEFRAME_BODY
                if place[2] < -1e-6 * table[row, 4]:
                    call(stop, (lost,))

    return passive.ctypes
