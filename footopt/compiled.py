"""numba's `njit` with footopt's options, and its cache on disk where there is a place for one."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from numba import config, njit
from numba.core.caching import FunctionCache

#: What may be assumed of floating-point numbers in the loop over plates: sums may be reordered, so that
#: the loop is vectorised. NaN and infinity may not be assumed away: a walk that diverges must be seen.
FAST = {"contract", "reassoc", "arcp", "nsz"}

#: Every function under the walk's loop is inlined by force: a function with a symbol of its own may be
#: taken from another compilation of the same source, which rounds otherwise. A walk then differed in its
#: last bits between the process that compiled it and those that load it from the cache on disk.
INLINE = {"error_model": "numpy", "forceinline": True}
inlined = njit(**INLINE)
inlined_fast = njit(fastmath=FAST, **INLINE)


class _Cache(FunctionCache):  # type: ignore[misc]  # numba has no types
    """numba's cache of one function, begun anew where it holds types that have moved since."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load compiled code; None, so that it is compiled again, if what is kept cannot be read."""
        try:
            return super().load_overload(sig, target_context)
        except (AttributeError, ImportError):  # numba unpickles types by the names of their modules
            self.flush()
            return None


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit(cache=True, **options)`; if no cache folder can be written, the same without one."""

    def decorate(function: Callable[..., Any]) -> Any:
        try:
            compiled = njit(cache=True, **options)(function)
            if active():
                compiled._cache = _Cache(function)
            return compiled
        except RuntimeError as error:  # numba: no locator available
            logging.getLogger("footopt").warning(
                "compiled code cannot be kept, so that every start compiles it again (%s). "
                "Set NUMBA_CACHE_DIR to a folder that can be written.",
                error,
            )
            return njit(**options)(function)

    return decorate


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
