"""Where a search evaluates its designs: threads of this process, processes of loky, or any executor's.

Any `concurrent.futures.Executor` will do: it gets chunks, each the pickled problem and the heights of some
designs. Results depend neither on the executor nor on the chunks, to the last bit: a worker whose versions or
processor would give other numbers refuses.
"""

import math
import os
import pickle
import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cached_property, lru_cache
from typing import Any, cast

import numpy as np

from footopt.arrays import Array, Ints, Words
from footopt.design.problem import FootProblem
from footopt.design.store import ERROR, differences, key_of, listed
from footopt.errors import EngineError, FootoptError, check, shortened
from footopt.walk.loop import at_once

IDLE = 3600.0  # s, for which a worker process stays without work
ENGINES = ("local", "processes")
EACH = 2  # chunks per worker and batch, so that a slow one does not keep the others waiting
LARGEST = 1000  # designs in a chunk
LONGEST = 480  # characters of the reason of a design
DIED = "A worker process has died: it was killed, has crashed, or there was too little memory."


def make_executor(name: str = "local", workers: int | None = None) -> AbstractContextManager[Executor | None]:
    """Return the executor of an engine, for a `with` statement.

    Parameters
    ----------
    name : str
        "local", the threads of this process: None. "processes": loky's, each with one thread.
    workers : int, optional
        Processes; by default as many as processors.
    """
    check(name in ENGINES, "engine", name, f"one of {', '.join(ENGINES)}")
    check(workers is None or name == "processes", "engine.workers", workers, f"null for engine={name}")
    return _processes(at_once(workers, "engine.workers")) if name == "processes" else nullcontext()


@contextmanager
def _processes(workers: int) -> Iterator[Executor]:
    from loky import get_reusable_executor

    main = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGINT, signal.SIG_IGN) if main else None
    try:
        # a worker that waits while another one compiles must not leave: loky's own timeout is 10 s
        options = {"initializer": _start_worker, "env": {"NUMBA_NUM_THREADS": "1"}}
        pool = get_reusable_executor(workers, "loky_init_main", IDLE, initargs=(tuple(sys.path),), **options)
        pool.submit(os.getpid)  # starts the workers while Ctrl-C is ignored, which they inherit
    finally:
        if before is not None:
            signal.signal(signal.SIGINT, before)
    try:
        yield pool  # the next `with` has the same workers, unless plugins have come
    except BaseException:
        pool.shutdown(kill_workers=True)
        raise


def _start_worker(places: tuple[str, ...]) -> None:
    """Find the modules of plugins, and leave Ctrl-C, which all processes of a terminal get, to the search."""
    sys.path[:] = places
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def walk(problem: FootProblem, k: Ints) -> tuple[Array, Words]:
    """Walk with designs (designs, n) in this process: values (designs, record), reasons (designs,).

    If that raises an exception, each design is walked alone, and the reason of those that do so is the error.
    Errors that no design has caused are raised.
    """
    try:
        return problem.walk(k)
    except (FootoptError, OSError, MemoryError):
        raise
    except Exception as error:
        if len(k) == 1:
            words = f"{ERROR} {type(error).__name__}: {error}".split()
            reason = shortened(" ".join(words), LONGEST)
            return np.full((1, len(problem.record)), np.nan), np.array([reason])
    return _joined(walk(problem, one) for one in np.split(k, len(k)))


def _joined(parts: Any) -> tuple[Array, Words]:
    values, reasons = zip(*parts, strict=True)
    return np.concatenate(values), np.concatenate(reasons)


def walk_chunk(sent: bytes, k: Ints) -> tuple[Array, Words]:
    """`walk` in a worker, with the problem that was sent to it."""
    return walk(_received(sent), k)


@lru_cache(maxsize=8)
def _received(sent: bytes) -> FootProblem:
    try:
        problem, there = pickle.loads(sent)
        here = key_of(problem)
    except Exception as error:
        why = "Its classes have to be in a module that workers can import."
        raise FootoptError(f"A worker cannot load the problem ({error!r}). {why}") from None
    if here != there:
        differ = listed([*differences(there, here).values()])
        hint = "Install the same versions on both, and use processors of one model."
        raise FootoptError(f"A worker would give other numbers: {differ} differ. {hint}")
    problem.threads = 1
    return cast(FootProblem, problem)


class Workers:
    """The workers of an executor, which evaluate designs of a problem as `walk` does here."""

    def __init__(self, problem: FootProblem, executor: Executor) -> None:
        self.problem, self.executor = problem, executor

    def __call__(self, k: Ints) -> tuple[Array, Words]:
        """Walk with designs (designs, n); `EngineError` if a worker dies."""
        workers = getattr(self.executor, "workers", getattr(self.executor, "_max_workers", None))
        size = min(math.ceil(len(k) / EACH / at_once(workers)), LARGEST)
        chunks = [k[i : i + size] for i in range(0, len(k), size)]
        sent = [self._sent] * len(chunks)
        try:
            return _joined(self.executor.map(walk_chunk, sent, chunks))
        except (FootoptError, MemoryError):
            raise
        except Exception as error:
            died = isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"  # dask's
            why = f"The workers, or their scheduler, cannot go on ({type(error).__name__}: {error})."
            raise EngineError(DIED if died else why) from None

    @cached_property
    def _sent(self) -> bytes:
        """The problem, compiled once, here, for all workers that share the cache, and its key."""
        problem = self.problem
        walk(problem, np.full((1, problem.space.n), problem.space.K))
        try:
            return pickle.dumps((problem, key_of(problem)))
        except Exception as error:
            raise FootoptError(
                f"The problem cannot be sent to other processes ({error}). Its classes have to be in a "
                "module, not in a function or typed into a session; or take engine=local."
            ) from None
