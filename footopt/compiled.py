"""numba's `njit` with footopt's options, and its cache on disk where there is a place for one."""

import hashlib
import logging
import os
import threading
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
from numba import config, njit, types
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.registry import cpu_target
from numba.core.runtime import rtsys
from numba.extending import overload, register_jitable

log = logging.getLogger("footopt")

ENTRIES = "_ZN7cpython", "cfunc."  # how the names begin by which Python and C call a function of numba
SOURCES = ("sand", "effects", "foot", "gait", "walk", "mujoco")  # with this file, they determine a walk
_lock = threading.Lock()  # numba has one folder for all caches, which `_Cache` changes for a moment

#: Assumptions about floating-point numbers in the loop over plates: sums may be reordered, so that
#: the loop is vectorised. NaN and infinity may not be assumed away: a walk that diverges must be seen.
FAST = {"contract", "reassoc", "arcp", "nsz"}

#: Every function under the walk's loop is inlined by force: a function with a symbol of its own may be
#: taken from another compilation of the same source, which rounds otherwise. A walk then differed in its
#: last bits between the process that compiled it and those that load it from the cache on disk.
#:
#: Called from Python, they run as plain Python: compiled entries would take a third of the compile time.
INLINE = {"error_model": "numpy", "forceinline": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
inlined = register_jitable(**INLINE)
inlined_fast = register_jitable(fastmath=FAST, **INLINE)
#: For functions that are called, not inlined, and therefore round the same everywhere. They create no arrays,
#: so they do without reference counts, which take a fifth of a robot's walk.
called_fast = register_jitable(fastmath=FAST, _nrt=False, **{**INLINE, "forceinline": False})


class Library(JITCodeLibrary):
    """numba's library of a function, without machine code if neither Python nor C can call it.

    Its callers have the code inlined or linked in. Compiling takes 0.86 of the time and gives the same code.
    """

    def _finalize_final_module(self) -> None:
        if any(one.name.startswith(ENTRIES) for one in self._final_module.functions):
            super()._finalize_final_module()
        self._finalized = True


class Wide(Compiler):
    """numba's compiler with 512-bit registers, where LLVM prefers 256: walks take 0.8 of the time."""

    def compile_extra(self, func: Any) -> Any:
        """Compile with LLVM's passes for the wide target; numba's own target emits their code."""
        codegen = self.state.targetctx.codegen()
        usual = {name: getattr(codegen, name) for name in ("_tm", "_library_class", "set_env")}
        codegen._tm, codegen._library_class = _wide() or codegen._tm, Library
        codegen.set_env = partial(_set_env, codegen._engine, codegen.set_env)
        try:
            return super().compile_extra(func)
        finally:
            for name, value in usual.items():
                setattr(codegen, name, value)


def _set_env(engine: Any, set_env: Callable[..., None], name: str, env: Any) -> None:
    """Set the environment of a function that has machine code."""
    if engine.is_symbol_defined(name):
        set_env(name, env)


@cache
def _wide() -> Any:
    """LLVM's target with 512-bit registers; None if the processor has no AVX-512."""
    _, name, features = cpu_target.target_context.codegen().magic_tuple()
    if "+avx512f" not in features:
        return None
    triple = llvmlite.binding.Target.from_default_triple()
    return triple.create_target_machine(name, f"{features},-prefer-256-bit", config.OPT)


wide_njit: Any = partial(njit, pipeline_class=Wide)  # numba's, with the compiler `Wide`


def unless_none(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    """An inlined function that returns None where its first argument is None.

    numba removes a branch ``if x is None`` only where x is None. Elsewhere the result of the function would
    have an optional type, and loops that use it would not be vectorised.
    """

    def given(*arguments: Any) -> Any:
        return None if arguments[0] is None else function(*arguments)

    def resolve(*arguments: Any) -> Any:
        return (lambda *arguments: None) if isinstance(arguments[0], types.NoneType) else function

    overload(given, strict=False, jit_options=INLINE | options)(resolve)
    return given


def sources() -> list[Path]:
    """The source files that determine a walk."""
    rooms = (Path(__file__).parent / name for name in SOURCES)
    return [Path(__file__), *sorted(path for room in rooms for path in room.rglob("*.py"))]


@cache
def cache_folder() -> str | None:
    """The folder for compiled code of these sources, readable by the user only; None if it cannot be made.

    numba's own cache key is the file of a function, but functions imported from other files are compiled into
    it. File times are part of the folder's name, as they are of numba's key: numba then never resets an index
    in this folder, so that no file is reused for another signature.
    """
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__}".encode())
    for path in sources():
        digest.update(f"{path} {path.stat().st_mtime_ns}".encode() + path.read_bytes())
    below = config.CACHE_DIR or Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache", "footopt")
    try:
        place = Path(below).expanduser() / f"footopt-{digest.hexdigest()[:16]}"
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
    except (OSError, RuntimeError) as error:  # or nobody's home is known
        log.warning("compiled code cannot be kept (%s). Set NUMBA_CACHE_DIR to a folder of yours.", error)
        return None
    return str(place)


class _Cache(FunctionCache):
    """numba's cache of a function, in `cache_folder`, saved under a lock.

    numba numbers the files of a function's signatures, and two processes could take the same number.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        with _lock:
            before, config.CACHE_DIR = config.CACHE_DIR, cache_folder()
            try:
                super().__init__(function)
            finally:
                config.CACHE_DIR = before

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load compiled code without numba's registries, which only compiling needs (and which are slow)."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save what is compiled for a signature."""
        from filelock import FileLock  # takes a hundredth of a second, and nearly no run compiles

        with FileLock(Path(self.cache_path) / "lock"):
            super().save_overload(sig, data)


def kept(compiled: Any) -> Any:
    """A function of numba's that is still to be compiled, with footopt's cache on disk."""
    if cache_folder() and not config.DISABLE_JIT:
        compiled._cache = _Cache(compiled.__wrapped__)
    return compiled


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit(cache=True, **options)`, with footopt's cache."""
    return lambda function: kept(wide_njit(**options)(function))


@cache
def target() -> dict[str, str]:
    """The machine that numba compiles for: results are bit-identical only where all of these are equal."""
    system, processor, features = cpu_target.target_context.codegen().magic_tuple()
    digest = hashlib.sha256(features.encode()).hexdigest()
    return {"system": system, "processor": processor, "features": digest}
