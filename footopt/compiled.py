"""numba's `njit` with footopt's options, and its cache on disk where there is a place for one."""

import hashlib
import logging
import os
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
from filelock import FileLock
from numba import config, njit, types
from numba.core.caching import FunctionCache
from numba.core.compiler import Compiler
from numba.core.registry import cpu_target
from numba.core.runtime import rtsys
from numba.extending import overload, register_jitable

log = logging.getLogger("footopt")

SOURCES = ("sand", "effects", "foot", "gait", "walk", "mujoco")  # what walks are made of, with this file
_choosing = threading.Lock()  # numba has one setting for where it keeps code

#: Assumptions about floating-point numbers in the loop over plates: sums may be reordered, so that
#: the loop is vectorised. NaN and infinity may not be assumed away: a walk that diverges must be seen.
FAST = {"contract", "reassoc", "arcp", "nsz"}

#: Every function under the walk's loop is inlined by force: a function with a symbol of its own may be
#: taken from another compilation of the same source, which rounds otherwise. A walk then differed in its
#: last bits between the process that compiled it and those that load it from the cache on disk.
#:
#: From Python they are Python: they have no entry of their own there, which is a third of the compiling.
INLINE = {"error_model": "numpy", "forceinline": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
inlined = register_jitable(**INLINE)
inlined_fast = register_jitable(fastmath=FAST, **INLINE)
#: A function that is called rounds alike anywhere. One that makes no array needs none counted either, which
#: takes a fifth of a robot's walk.
called_fast = register_jitable(fastmath=FAST, _nrt=False, **{**INLINE, "forceinline": False})


class Wide(Compiler):
    """numba's compiler with whole registers of AVX-512, of which LLVM by itself fills half: walks take .8."""

    def compile_extra(self, func: Any) -> Any:
        """Compile, with passes for another target than numba's, which then emits what they have made."""
        codegen = self.state.targetctx.codegen()
        usual, codegen._tm = codegen._tm, _wide() or codegen._tm
        try:
            return super().compile_extra(func)
        finally:
            codegen._tm = usual


@cache
def _wide() -> Any:
    """LLVM's target for whole registers of AVX-512; None where there are none."""
    _, name, features = cpu_target.target_context.codegen().magic_tuple()
    if "+avx512f" not in features:
        return None
    triple = llvmlite.binding.Target.from_default_triple()
    return triple.create_target_machine(name, f"{features},-prefer-256-bit", config.OPT)


def wide_njit(**options: Any) -> Any:
    """`numba.njit`, with whole registers."""
    return njit(pipeline_class=Wide, **options)


def unless_none(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    """A function, compiled inline, that is None wherever its first argument is None.

    numba leaves out a branch on None where there is None, not where there is something else: the result of a
    function with such a branch may then be None, and what comes of it is not vectorised.
    """

    def given(*arguments: Any) -> Any:
        return None if arguments[0] is None else function(*arguments)

    def resolve(*arguments: Any) -> Any:
        return (lambda *arguments: None) if isinstance(arguments[0], types.NoneType) else function

    overload(given, strict=False, jit_options=INLINE | options)(resolve)
    return given


def sources() -> list[Path]:
    """The files that walks are made of."""
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
    home = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser()
    place = Path(config.CACHE_DIR or home / "footopt") / f"footopt-{digest.hexdigest()[:16]}"
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        log.warning("compiled code cannot be kept (%s). Set NUMBA_CACHE_DIR to a folder of yours.", error)
        return None
    return str(place)


class _Cache(FunctionCache):
    """numba's cache of a function, in `cache_folder`, saved under a lock.

    numba numbers the files of a function's signatures, and two processes could take the same number.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        with _choosing:
            before, config.CACHE_DIR = config.CACHE_DIR, cache_folder()
            try:
                super().__init__(function)
            finally:
                config.CACHE_DIR = before

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load what is there, without numba's registries, which are only needed (and loaded) to compile."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save what is compiled for a signature."""
        with FileLock(Path(self.cache_path) / "lock"):
            super().save_overload(sig, data)


def kept(compiled: Any) -> Any:
    """A function of numba's that is still to be compiled; it keeps what it is compiled to on disk."""
    if cache_folder() and not config.DISABLE_JIT:
        compiled._cache = _Cache(compiled.__wrapped__)
    return compiled


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit(cache=True, **options)`, with footopt's cache."""
    return lambda function: kept(wide_njit(**options)(function))


@cache
def target() -> dict[str, str]:
    """What numba compiles for: only where all of it is the same are results the same, bit for bit."""
    system, processor, features = cpu_target.target_context.codegen().magic_tuple()
    digest = hashlib.sha256(features.encode()).hexdigest()
    return {"system": system, "processor": processor, "features": digest}
