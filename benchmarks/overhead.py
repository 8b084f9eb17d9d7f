"""Where a search's time goes: inside the compiled walk, and around it."""

from __future__ import annotations

import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib import import_module
from typing import Any
from unittest.mock import patch

import footopt as fo
from footopt.design.archive import Archive
from footopt.design.solvers import Solver
from footopt.walk import loop

# functions of the same names hide these modules in their packages
scene_module = import_module("footopt.walk.scene")
prepare_module = import_module("footopt.walk.discretize")
problem_module = import_module("footopt.design.problem")


class Clock:
    """Wall time inside functions, by name, summed over threads."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._lock = threading.Lock()

    def timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, its time added up under a name."""

        def run(*args: Any, **kwargs: Any) -> Any:
            start = time.perf_counter()
            try:
                return function(*args, **kwargs)
            finally:
                with self._lock:
                    self.seconds[name] += time.perf_counter() - start

        return run

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Time the parts of a search while this lasts."""
        build = Solver.build

        def watched(solver: Solver, n_obj: int) -> Any:
            algorithm = build(solver, n_obj)
            algorithm.ask = self.timed("ask", algorithm.ask)
            algorithm.tell = self.timed("tell", algorithm.tell)
            return algorithm

        with ExitStack() as stack:
            for owner, attribute, name in (
                (scene_module, "walk_batch", "walk"),
                (scene_module, "as_plates", "plates"),
                (prepare_module, "soles", "blocks"),
                (problem_module, "evaluated", "evaluate"),
                (fo.FootProblem, "minimised", "judge"),
                (Archive, "evaluate", "archive"),
                (Archive, "close_generation", "history"),
            ):
                wrapped = self.timed(name, getattr(owner, attribute))
                if isinstance(owner, type):
                    stack.enter_context(patch.object(owner, attribute, _method(wrapped)))
                else:
                    stack.enter_context(patch.object(owner, attribute, wrapped))
            kernel = loop.compiled_for
            timed = patch.object(loop, "compiled_for", lambda *of: self.timed("kernel", kernel(*of)))
            stack.enter_context(timed)
            stack.enter_context(patch.object(Solver, "build", watched))
            yield


def _method(function: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *args, **kwargs: function(*args, **kwargs)


def search_shares(threads: int, pop_size: int = 100, n_gen: int = 100) -> tuple[dict[str, float], float]:
    """Shares of a GA run's wall time (they sum to 1), and that time, s.

    "kernel" is the time inside the compiled walk, summed over threads, per thread; "threads" what
    those threads wait for work or for each other.
    """
    problem = fo.FootProblem(threads=threads)
    fo.search(problem, pop_size=4, n_gen=1)  # compiles and imports
    clock = Clock()
    with clock.watching():
        start = time.perf_counter()
        fo.search(problem, pop_size=pop_size, n_gen=n_gen, seed=1)
        wall = time.perf_counter() - start
    s = clock.seconds
    parts = {
        "kernel": s["kernel"] / threads,
        "threads": s["walk"] - s["blocks"] - s["kernel"] / threads,
        "blocks of plates": s["blocks"],
        "plates": s["plates"],
        "table": s["evaluate"] - s["walk"] - s["plates"],
        "box violation, F and G": s["judge"],
        "archive": s["archive"] - s["evaluate"] - s["judge"] + s["history"],
        "pymoo ask": s["ask"],
        "pymoo tell": s["tell"],
    }
    parts["rest"] = wall - sum(parts.values())
    return {name: value / wall for name, value in parts.items()}, wall
