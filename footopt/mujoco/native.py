"""Compiled functions that are called by their addresses, each of which is compiled once, and MuJoCo's."""

import ctypes
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

from footopt.compiled import FAST, kept
from footopt.errors import needed


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


#: For compiled code: a whole number as a pointer, and a call of the function at an address.
pointer, call = intrinsic(_pointer), intrinsic(_call)


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


def entry(function: Callable[..., Any], *arguments: Any, returns: Any = types.void, keep: bool = True) -> Any:
    """A function in C, compiled once and kept on disk: what calls it by its address does not compile it."""
    options = {"error_model": "numpy", "fastmath": FAST, "_nrt": False}
    made = CFunc(function, (arguments, returns), {}, options)
    made = kept(made) if keep else made
    made.compile()
    return made
