"""numba's `njit` with footopt's options, and its cache on disk where there is a place for one."""

from __future__ import annotations

import hashlib
import logging
import os
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
from filelock import FileLock
from numba import cfunc, config, njit, types
from numba.core import cgutils
from numba.core.caching import FunctionCache
from numba.extending import intrinsic, overload, register_jitable

log = logging.getLogger("footopt")

SOURCES = ("sand", "effects", "foot", "walk", "mujoco")  # what is compiled, with this file
KEPT, DAY = 8, 86_400  # folders of other sources that stay in any case; s without use until others go
_choosing = threading.RLock()  # numba has one setting for where it keeps code

#: Assumptions about floating-point numbers in the loop over plates: sums may be reordered, so that
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


def unless_none(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function, compiled inline, that is None wherever its first argument is None.

    numba leaves out a branch on None where there is None, not where there is something else: the result of a
    function with such a branch may then be None, and what comes of it is not vectorised.
    """

    def given(*arguments: Any) -> Any:
        return None if arguments[0] is None else function(*arguments)

    def resolve(*arguments: Any) -> Any:
        return (lambda *arguments: None) if isinstance(arguments[0], types.NoneType) else function

    overload(given, strict=False, jit_options=INLINE)(resolve)
    return given


class _Cache(FunctionCache):  # type: ignore[misc]  # numba has no types
    """numba's cache of a function, which numbers the files of its signatures: one process at a time does."""

    def save_overload(self, sig: Any, data: Any) -> None:
        with FileLock(Path(self.cache_path) / "lock"):
            super().save_overload(sig, data)


def sources() -> list[Path]:
    """The files that compiled code is made of."""
    rooms = (Path(__file__).parent / name for name in SOURCES)
    return [Path(__file__), *sorted(path for room in rooms for path in room.rglob("*.py"))]


@cache
def cache_folder() -> str | None:
    """Where compiled code is kept: a folder of the user alone for these sources; None if it has no place.

    numba looks at the file that a function is in; what that imports is compiled into it, too. The times of
    files count, as they do for numba: in one folder no file is ever given to another signature.
    """
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__}".encode())
    for path in sources():
        digest.update(f"{path} {path.stat().st_mtime_ns}".encode() + path.read_bytes())
    base = Path(
        config.CACHE_DIR or Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "footopt"
    )
    place = base / f"footopt-{digest.hexdigest()[:16]}"
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        os.utime(place)  # it is in use
    except OSError as error:
        log.warning("compiled code cannot be kept (%s). Set NUMBA_CACHE_DIR to a folder of yours.", error)
        return None
    for old in sorted(base.glob("footopt-*"), key=os.path.getmtime)[:-KEPT]:
        if time.time() - old.stat().st_mtime > DAY:  # no process that began to compile there is at it still
            shutil.rmtree(old, ignore_errors=True)
    return str(place)


@contextmanager
def _in_folder() -> Iterator[bool]:
    """Have numba keep code in `cache_folder` for the block; whether there is one."""
    with _choosing:
        before, config.CACHE_DIR = config.CACHE_DIR, cache_folder() or config.CACHE_DIR
        try:
            yield cache_folder() is not None
        finally:
            config.CACHE_DIR = before


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit(cache=True, **options)`, of which many processes may save at once."""

    def decorate(function: Callable[..., Any]) -> Any:
        compiled = njit(**options)(function)
        with _in_folder() as there:
            if there and not config.DISABLE_JIT:
                compiled._cache = _Cache(function)
        return compiled

    return decorate


def cached_cfunc(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.cfunc(signature, cache=True)`, for functions of one signature, each of its own name."""

    def decorate(function: Callable[..., Any]) -> Any:
        with _in_folder() as there:
            return cfunc(signature, cache=there, error_model="numpy")(function)

    return decorate


def _unowned(typingctx: Any, array: Any) -> Any:
    """An array without a reference to the owner of its memory."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, args[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        return view._getvalue()

    return array(array), generate


unowned = intrinsic(_unowned)


def processor() -> tuple[str, int]:
    """The target of numba: the processor's name, and the bits that one instruction works on."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    given = (config.CPU_FEATURES or "").split(",")  # numba's own setting, such as "-avx512f"
    on = {name for name, there in features.items() if there and f"-{name}" not in given}
    widths = {"avx512f": 512, "avx": 256, "sse2": 128, "neon": 128}
    return config.CPU_NAME or llvm.get_host_cpu_name(), max((widths.get(f, 0) for f in on), default=0)
