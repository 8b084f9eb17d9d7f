"""numba's `njit` with footopt's options, and its cache on disk where there is a place for one."""

from __future__ import annotations

import hashlib
import logging
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

from llvmlite import ir
from numba import config, njit, types
from numba.core import cgutils
from numba.core.caching import FunctionCache, IndexDataCacheFile, _cache_log
from numba.core.ccallback import CFunc
from numba.extending import intrinsic, register_jitable

log = logging.getLogger("footopt")

#: What may be assumed of floating-point numbers in the loop over plates: sums may be reordered, so that
#: the loop is vectorised. NaN and infinity may not be assumed away: a walk that diverges must be seen.
FAST = {"contract", "reassoc", "arcp", "nsz"}

#: Every function under the walk's loop is inlined by force: a function with a symbol of its own may be
#: taken from another compilation of the same source, which rounds otherwise. A walk then differed in its
#: last bits between the process that compiled it and those that load it from the cache on disk.
#:
#: From Python they are Python: they have no entry of their own there, which is a third of the compiling.
INLINE = {
    "error_model": "numpy",
    "forceinline": True,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
inlined = register_jitable(**INLINE)
inlined_fast = register_jitable(fastmath=FAST, **INLINE)
called = register_jitable(**{**INLINE, "forceinline": False})  # rounds alike wherever it is taken from
called_fast = register_jitable(fastmath=FAST, **{**INLINE, "forceinline": False})


class _Files(IndexDataCacheFile):  # type: ignore[misc]  # numba has no types
    """One file for each signature of a function: a seal, the source's stamp, and the compiled code.

    numba's own files have no checksum: a flipped bit crashes or gives wrong numbers, and two files that
    are exchanged, or that two processes write at once, give the walk of another effect.
    """

    def load(self, key: Any) -> Any:
        """What is kept under a key; None if there is nothing of this source, or if it is damaged."""
        path = self._path(key)
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            log.warning("compiled code cannot be read and is compiled again (%s)", error)
            return None
        if content[:32] != _sha256(path.name.encode() + content[32:]):
            log.warning("compiled code was damaged and is compiled again (%s)", path)
            return None
        if content[32:64] != self._stamp():
            return None
        known, data = pickle.loads(content[64:])
        _cache_log("[cache] data loaded from %r", str(path))
        return data if known == key else None

    def save(self, key: Any, data: Any) -> None:
        """Keep compiled code under a key, in the place of what was made from another source."""
        path = self._path(key)
        content = self._stamp() + self._dump((key, data))
        with self._open_for_write(str(path)) as file:
            file.write(_sha256(path.name.encode() + content) + content)
        _cache_log("[cache] data saved to %r", str(path))

    def _path(self, key: Any) -> Path:
        signature, machine, _ = key
        name = _sha256(f"{signature}|{machine}".encode()).hex()[:16]
        return Path(self._cache_path, self._index_name).with_suffix(f".{name}.nbc")

    def _stamp(self) -> bytes:
        return _sha256(repr((self._version, self._source_stamp)).encode())


class _Cache(FunctionCache):  # type: ignore[misc]  # numba has no types
    """numba's cache of one function; what is wrong with a file is said, and the function compiled again."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file = _Files(
            self._cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp()
        )

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load compiled code; None, so that it is compiled again, if what is kept cannot be used."""
        try:
            return super().load_overload(sig, target_context)
        except (AttributeError, ImportError):  # it names types by modules from where they have moved
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep compiled code, where there is room for it."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            _cannot_be_kept(error)


def _sha256(content: bytes) -> bytes:
    return hashlib.sha256(content).digest()


def _cannot_be_kept(error: Exception) -> None:
    log.warning(
        "compiled code cannot be kept, so that every start compiles it again (%s). "
        "Set NUMBA_CACHE_DIR to a folder that can be written and has room.",
        error,
    )


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit(cache=True, **options)`; if no cache folder can be written, the same without one."""

    def decorate(function: Callable[..., Any]) -> Any:
        try:
            compiled = njit(cache=True, **options)(function)
            if active():
                compiled._cache = _Cache(function)
            return compiled
        except RuntimeError as error:  # numba: no locator available
            _cannot_be_kept(error)
            return njit(**options)(function)

    return decorate


def cached_cfunc(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.cfunc(signature)`, kept as `cached_njit` keeps its code."""

    def decorate(function: Callable[..., Any]) -> Any:
        made: Any = CFunc(function, (signature.args, signature.return_type), {}, {"error_model": "numpy"})
        try:
            made._cache = _Cache(function)
        except RuntimeError as error:  # numba: no locator available
            _cannot_be_kept(error)
        made.compile()
        return made

    return decorate


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


def _unowned(typingctx: Any, array: Any) -> Any:
    """An array that does not know who owns its memory."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, args[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        return view._getvalue()

    return array(array), generate


#: What compiled code may use: a whole number as a pointer, the function at an address, and such an array.
pointer, call, unowned = intrinsic(_pointer), intrinsic(_call), intrinsic(_unowned)


def processor() -> tuple[str, int]:
    """What numba compiles for: the processor's name, and the bits that one instruction works on."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    given = (config.CPU_FEATURES or "").split(",")  # numba's own setting, such as "-avx512f"
    on = {name for name, there in features.items() if there and f"-{name}" not in given}
    widths = {"avx512f": 512, "avx": 256, "sse2": 128, "neon": 128}
    return config.CPU_NAME or llvm.get_host_cpu_name(), max((widths.get(f, 0) for f in on), default=0)


def active() -> bool:
    """Whether numba compiles at all; with NUMBA_DISABLE_JIT=1 everything runs as Python."""
    return not config.DISABLE_JIT


def kept(function: Any) -> tuple[str | None, int]:
    """Where the code of a compiled function is kept on disk, and how often it was loaded from there."""
    return function.stats.cache_path, sum(function.stats.cache_hits.values())
