"""Compiled functions that are called by their addresses, and MuJoCo's; the sand's memory as a plugin's state.

Each function is compiled once. The plugin does nothing but remember: `mj_getState` holds its state.
"""

import ctypes
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

from footopt.arrays import Array
from footopt.compiled import FAST, Wide, kept
from footopt.errors import check, needed

NAME, INSTANCE, SIZE = "footopt.sand", "footopt_sand", "size"
SENSOR = 2  # mjPLUGIN_SENSOR; its function does nothing


def _pointer(typingctx: Any, address: Any) -> Any:
    """A whole number as a pointer."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return types.voidptr(address), generate


def _call(typingctx: Any, function: Any, arguments: Any) -> Any:
    """Call the function at an address with a tuple of whole numbers; returns a whole number, if it does."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        given = cgutils.unpack_tuple(builder, args[1])
        kind = ir.FunctionType(ir.IntType(32), [argument.type for argument in given])
        return builder.call(builder.inttoptr(args[0], kind.as_pointer()), given)

    return types.int32(function, arguments), generate


#: For compiled code: a whole number as a pointer, and a call of the function at an address.
pointer, call = intrinsic(_pointer), intrinsic(_call)


@lru_cache(maxsize=1)
def library() -> ctypes.CDLL:
    """MuJoCo's shared library."""
    folder = Path(needed("mujoco", "footopt.mujoco", "mujoco").__file__).parent
    paths = [p for name in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll") for p in folder.glob(name)]
    return ctypes.CDLL(str(paths[0]))


@lru_cache
def functions(*names: str) -> tuple[int, ...]:
    """Addresses of functions of MuJoCo's."""
    return tuple(ctypes.cast(getattr(library(), name), ctypes.c_void_p).value or 0 for name in names)


def entry(function: Callable[..., Any], *arguments: Any, returns: Any = types.void, keep: bool = True) -> Any:
    """A C function, compiled once and cached on disk: code that calls its address does not compile it."""
    check(not config.DISABLE_JIT, "NUMBA_DISABLE_JIT", config.DISABLE_JIT, "0: only compiled code walks")
    options = {"error_model": "numpy", "fastmath": FAST, "_nrt": False}
    made = CFunc(function, (arguments, returns), {}, options, pipeline_class=Wide)
    made = kept(made) if keep else made
    made.compile()
    return made


@lru_cache(maxsize=1)
def register() -> tuple[Any, ...]:
    """Register the plugin; all that MuJoCo keeps pointers to."""
    whole, place = ctypes.c_int, ctypes.c_void_p
    lib = library()
    lib.mj_getPluginConfig.restype = ctypes.c_char_p
    lib.mj_getPluginConfig.argtypes = place, whole, ctypes.c_char_p

    def size(model: int, instance: int) -> int:
        return int(lib.mj_getPluginConfig(model, instance, SIZE.encode()))

    def forget(model: int, state: int, _: int, instance: int) -> None:
        ctypes.memset(state, 0, 8 * size(model, instance))

    calls = (
        ctypes.CFUNCTYPE(whole, place, whole)(size),
        ctypes.CFUNCTYPE(whole, place, place, whole)(lambda model, data, instance: 0),
        ctypes.CFUNCTYPE(None, place, place, place, whole)(forget),
        ctypes.CFUNCTYPE(None, place, place, whole, whole)(lambda *given: None),
    )
    state_size, begin, reset, compute = (ctypes.cast(call, place).value for call in calls)
    name, names = ctypes.create_string_buffer(NAME.encode()), (ctypes.c_char_p * 1)(SIZE.encode())
    # mjpPlugin: name, attributes, capability, functions; those that come after, in any version, are none
    head = ctypes.addressof(name), 1, ctypes.addressof(names), SENSOR
    lib.mjp_registerPlugin((place * 64)(*head, state_size, 0, begin, 0, 0, reset, compute))
    return calls, name, names


def remembering(spec: Any, size: int) -> Any:
    """The model of a specification, with memory for `size` numbers; the specification is not changed."""
    register()
    own = spec.copy()
    own.activate_plugin(NAME)
    own.add_plugin(name=INSTANCE, plugin_name=NAME, active=True).config = {SIZE: str(size)}
    return own.compile()


def memory(model: Any, data: Any, size: int) -> Array:
    """Memory of the sand for `size` numbers: the state of the plugin in MjData, or else a new array."""
    mujoco = needed("mujoco", "footopt.mujoco", "mujoco")
    row = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_PLUGIN, INSTANCE)
    if row < 0:
        return np.zeros(size)
    same, first = model.plugin_statenum[row] == size, model.plugin_stateadr[row]
    check(same, "feet", "others", "those for which the specification was attached", "Attach it again.")
    return data.plugin_state[first : first + size]
