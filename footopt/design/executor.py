"""Walk designs by any `concurrent.futures.Executor`, in chunks, as this process would, to the last bit.

A chunk goes out as the pickled problem (some kB) and whole numbers, the heights, and comes back as values
and reasons. A worker keeps the problems that it has met under the digest of their context. What is in that
context (sources, versions, processor) has to be the same there as here: a worker that would give other
numbers refuses.
"""

from __future__ import annotations

import math
import os
import pickle
import socket
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, wait
from contextlib import suppress
from functools import cached_property, lru_cache
from typing import Any, NamedTuple, cast

import numpy as np

from footopt.design.context import context, differences, digest, listed
from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.design.starting import end_fork_server, within
from footopt.errors import FootoptError
from footopt.walk.simulate import available_threads

OVERHEAD = 1e-3  # s that a chunk costs whoever hands it out, whatever it holds; an executor may know better
PAUSE = 0.5  # s, before another is made
#: Of a machine that has no memory, files, threads or fork server for a while.
PASSING = (OSError, MemoryError, EOFError, RuntimeError)
EACH = 32  # chunks that a worker gets of a large batch: what one is slower at, the others take
SHARE = 0.05  # of a batch's time that may go into such a balance
LARGEST = 4096  # designs in a chunk
KNOWN = 8  # problems that a worker keeps
CANNOT_START = (
    "a worker cannot start ({}). `ulimit -a` shows what is allowed. A script that searches has to do so "
    'below `if __name__ == "__main__":`, as workers import it.'
)
PATIENCE = (15.0, 15.0, 60.0)  # s, for a new executor's first worker, each time that one is made


class Walked(NamedTuple):
    """Designs that were walked: values (designs, record), reasons (designs,), and the time, s."""

    values: Array
    reasons: Words
    seconds: float = 0.0


class Failed(NamedTuple):
    """Designs of which at least one has broken the program, or whose worker has died."""

    message: str
    died: bool = False


class Refused(NamedTuple):
    """Designs that were not walked for a reason outside of them."""

    message: str


def attempt(problem: FootProblem, k: Ints) -> Walked | Failed:
    """Walk with designs (designs, n) in this process; raise what is no design's fault."""
    try:
        return Walked(*problem.walk(k))
    except FootoptError:
        raise
    except (OSError, MemoryError) as error:
        raise machine_failed(error, "during a walk") from error
    except Exception as error:
        return Failed(f"{type(error).__name__}: {error}")


def machine_failed(error: Exception, when: str) -> FootoptError:
    """What is said of too little memory, too few files or processes."""
    return FootoptError(
        f"The machine has failed {when} ({type(error).__name__}: {error}); no design is at fault. "
        "What was walked in finished generations is kept: mend it, and resume."
    )


handled = [0, 0]  # chunks that this process, a worker, has begun and ended


def walk_chunk(name: str, content: bytes, k: Ints) -> Walked | Failed | Refused:
    """What a worker does with a chunk: heights k, and the pickled problem, known by its context's digest.

    Errors are returned: not all of them survive being raised from one process to another.
    """
    handled[0] += 1
    try:
        problem = _loaded(name, content)
        started = time.perf_counter()
        outcome = attempt(problem, k)
    except FootoptError as error:
        return Refused(str(error))
    finally:
        handled[1] += 1
    return outcome._replace(seconds=time.perf_counter() - started) if isinstance(outcome, Walked) else outcome


@lru_cache(maxsize=KNOWN)
def _loaded(name: str, content: bytes) -> FootProblem:
    """A problem of that digest in a worker; `FootoptError` if it would give other numbers here."""
    where = f"The worker {socket.gethostname()}, process {os.getpid()},"
    try:
        problem, there = pickle.loads(content)
        here = context(problem)
    except Exception as error:
        raise FootoptError(
            f"{where} cannot load the problem ({type(error).__name__}: {error}). "
            "What defines it has to be in a module that a worker can import."
        ) from None
    if digest(here) != name:
        raise FootoptError(
            f"{where} would give other numbers: {listed(differences(here, there))} differ. "
            "Install the same versions on both, and use processors of one model."
        )
    problem.threads = 1
    return cast(FootProblem, problem)


class Chunks:
    """A problem's designs walked by an executor, chunk by chunk.

    The executor may have `workers` (chunks at a time), `overhead` (s a chunk) and `check()`, which is
    called every second while chunks are away. It says whether they are lost, and raises when nothing will
    ever come back.
    """

    def __init__(self, problem: FootProblem, executor: Executor) -> None:
        self.problem, self.executor = problem, executor
        self._cost = 0.0  # s a design, as the last batch took

    def __call__(self, k: Ints) -> list[tuple[Ints, Walked | Failed]]:
        """What became of which designs of a batch, by their places in it; raise if none is at fault.

        Those that were lost when an executor broke are one entry: which of them broke it is not known.
        """
        name, content = self._sent
        places = np.arange(len(k))
        overhead = getattr(self.executor, "overhead", OVERHEAD)
        parts = [places[part] for part in chunks(len(k), workers_of(self.executor), self._cost, overhead)]
        futures: list[Future[Any]] = []
        gone = False  # with the workers that had them
        try:
            for part in parts:  # one by one: what is under way is cancelled if another cannot be
                futures.append(self.executor.submit(walk_chunk, name, content, k[part]))  # noqa: PERF401
            while wait(futures, timeout=1.0).not_done:
                if gone := getattr(self.executor, "check", bool)():
                    break
            outcomes = [_outcome(future) if future.done() else None for future in futures]
        except FootoptError:
            raise
        except (OSError, MemoryError, EOFError) as error:
            raise machine_failed(error, "while work was handed out") from error
        except BrokenExecutor as error:
            raise FootoptError(
                f"The executor cannot be used any more: a worker has died ({error}). What was walked in "
                "finished generations is kept: resume. footopt.design.Renewing replaces such an executor."
            ) from None
        finally:
            for future in () if gone else futures:  # to a pool that ends, a cancelled one is an error
                future.cancel()
        done = [(part, o) for part, o in zip(parts, outcomes, strict=True) if o is not None]
        self._cost = sum(o.seconds for _, o in done if isinstance(o, Walked)) / len(k)
        lost = [part for part, o in zip(parts, outcomes, strict=True) if o is None]
        return [*done, (np.concatenate(lost), Failed("the worker has died", died=True))] if lost else done

    @cached_property
    def _sent(self) -> tuple[str, bytes]:
        """The digest of the problem's context, and both as bytes."""
        problem = self.problem
        # compiled once, here, and kept on disk, from where every worker loads it
        problem.walk(np.full((1, problem.space.n), problem.space.K))
        here = context(problem)
        try:
            return digest(here), pickle.dumps((problem, here))
        except Exception as error:
            raise FootoptError(
                f"The problem cannot be sent to other processes ({error}). What defines it has to be in a "
                "module, not in a function or typed into a session; or walk in this process, engine=local."
            ) from None


def _outcome(future: Future[Any]) -> Walked | Failed | None:
    """What a worker has returned, None if it has died; raise what is no design's fault."""
    try:
        outcome: Walked | Failed | Refused = future.result()
    except BrokenExecutor:
        return None
    except CancelledError:
        raise FootoptError(
            "The executor has dropped its work: the connection to the scheduler is lost. What was walked in "
            "finished generations is kept: start it again, and resume."
        ) from None
    except Exception as error:
        if type(error).__name__ == "KilledWorker":  # dask's
            return None
        raise FootoptError(
            f"The executor cannot walk ({type(error).__name__}: {error}). Is the same footopt there?"
        ) from None
    if isinstance(outcome, Refused):
        raise FootoptError(outcome.message)
    return outcome


def workers_of(executor: Executor) -> int:
    """How many chunks an executor works on at a time, as far as it says."""
    for name in ("workers", "_max_workers", "num_workers"):  # footopt's; threads and processes; MPI
        if isinstance(count := getattr(executor, name, None), int):
            return max(1, count)
    return available_threads()


def chunks(designs: int, workers: int, cost: float, overhead: float) -> list[slice]:
    """Cut a batch into equal chunks, so many that it is done soonest.

    C chunks on as many workers take C overhead + work / C, with work = designs * cost: shortest for
    C = sqrt(work / overhead), so that a small batch keeps a few workers busy only. If that is more than
    there are workers, further chunks even out what these are slower at, `EACH` a worker at most, as long
    as their overhead is a `SHARE` of the time, work / workers. The cost of a design and the overhead of a
    chunk are in s; a cost of 0 is not known yet.
    """
    work = designs * cost
    soonest = min(math.sqrt(work / overhead), workers) if cost > 0.0 else workers
    even = min(SHARE * work / (workers * overhead), EACH * workers)
    count = max(1, math.ceil(max(soonest, even)))
    size = min(math.ceil(designs / count), LARGEST)
    return [slice(i, i + size) for i in range(0, designs, size)]


class Renewing(Executor):
    """An executor that is made anew when one of its workers has died.

    Parameters
    ----------
    make : callable
        Makes an executor, e.g. ``lambda: ProcessPoolExecutor(8)``.
    overhead : float, s
        That a chunk costs it.

    Raises
    ------
    FootoptError
        A new executor's workers cannot start.
    """

    def __init__(self, make: Callable[[], Executor], overhead: float = OVERHEAD) -> None:
        self.overhead = overhead
        self._make = make
        self._executor: Executor | None = None

    @property
    def workers(self) -> int:
        """Chunks at a time."""
        return workers_of(self._started())

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a function called by a worker."""
        try:
            return self._started().submit(fn, *args, **kwargs)
        except (BrokenExecutor, *PASSING):
            self.shutdown(wait=False)
            return self._started().submit(fn, *args, **kwargs)

    def check(self) -> bool:
        """Whether what is under way is lost; the workers have been ended then."""
        if lost := getattr(self._executor, "check", bool)():
            self.shutdown(wait=False)
        return bool(lost)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers at once; the next `submit` starts new ones."""
        if self._executor is not None:
            ended, self._executor = self._executor, None
            for process in list((getattr(ended, "_processes", None) or {}).values()):
                process.kill()  # nothing else ends a walk that is under way, or a process that is stopped
            with suppress(*PASSING):
                within(PATIENCE[0], lambda: ended.shutdown(wait))

    def _started(self) -> Executor:
        why = ""
        for seconds in PATIENCE if self._executor is None else ():
            try:
                made = self._executor = self._make()
                within(seconds, lambda: made.submit(os.getpid).result())  # noqa: B023  called here
                break
            except BaseException as error:
                self.shutdown(wait=False)
                if not isinstance(error, (BrokenExecutor, *PASSING)):
                    raise
                why = f"{type(error).__name__}: {error}"
                if isinstance(error, TimeoutError):
                    end_fork_server()
                if isinstance(error, (BrokenExecutor, TimeoutError)):
                    dies = isinstance(error, BrokenExecutor)
                    why = "it dies at once" if dies else f"it takes over {seconds:g} s"
                time.sleep(PAUSE)
        if self._executor is None:
            raise FootoptError(f"engine=processes: {CANNOT_START.format(why)}")
        return self._executor
