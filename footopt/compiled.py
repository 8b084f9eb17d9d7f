"""numba's `njit` with its cache on disk where there is a place for it, and without where there is not."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from numba import njit


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit(cache=True, **options)`; if no cache folder can be written, the same without one."""

    def decorate(function: Callable[..., Any]) -> Any:
        try:
            return njit(cache=True, **options)(function)
        except RuntimeError as error:  # numba: no locator available
            logging.getLogger("footopt").warning(
                "compiled code cannot be kept, so that every start compiles it again (%s). "
                "Set NUMBA_CACHE_DIR to a folder that can be written.",
                error,
            )
            return njit(**options)(function)

    return decorate
