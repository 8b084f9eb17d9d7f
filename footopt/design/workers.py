"""What engines with workers share: chunks of a batch out and back, and the problem once to a worker.

A chunk goes out as whole numbers, the heights, and comes back as values and reasons. A worker that does
not know the problem says so, is sent it, and keeps it under the digest of the store's context. What is
in that context (sources, versions, processor) has to be the same there as here: a worker that would give
other numbers is refused.
"""

from __future__ import annotations

import math
import os
import pickle
import socket
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.design.problem import FootProblem
from footopt.design.store import context, differences, digest, listed
from footopt.errors import FootoptError

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Walked = tuple[Array, NDArray[np.str_]]

EACH = 32  # chunks that a worker gets of a large batch: what one is slower at, the others take
SHARE = 0.05  # of a batch's time that may go into such a balance
LARGEST = 4096  # designs in a chunk
KNOWN = 8  # problems that a worker keeps

WALKED, UNKNOWN, RAISED, REFUSED, OTHER, DIED = "walked", "unknown", "raised", "refused", "other", "died"


class Task(NamedTuple):
    """A chunk on its way out: digest of the problem, the problem itself or None, heights (designs, n)."""

    digest: str
    problem: bytes | None
    k: Ints


class Reply(NamedTuple):
    """A chunk on its way back: what became of it, values and reasons or else why, and the time, s."""

    kind: str
    content: Any = None
    seconds: float = 0.0


_problems: dict[str, FootProblem] = {}  # that this process, a worker, knows, by digest


def work(task: Task) -> Reply:
    """What a worker does with a chunk. Errors are replies: not all of them survive being sent."""
    problem = _problems.get(task.digest)
    if problem is None:
        if task.problem is None:
            return Reply(UNKNOWN)
        where = f"The worker {socket.gethostname()}, process {os.getpid()},"
        try:
            problem = pickle.loads(task.problem)
            here = context(problem)
        except Exception as error:
            why = f"{where} cannot load the problem ({type(error).__name__}: {error})"
            return Reply(REFUSED, f"{why}. What defines it has to be in a module that a worker can import.")
        if digest(here) != task.digest:
            return Reply(OTHER, (where, here))
        problem.threads = 1
        while len(_problems) >= KNOWN:
            with suppress(KeyError, StopIteration):  # another thread may be quicker
                del _problems[next(iter(_problems))]
        _problems[task.digest] = problem
    started = time.perf_counter()
    try:
        return Reply(WALKED, problem.walk(task.k), time.perf_counter() - started)
    except FootoptError as error:
        return Reply(REFUSED, str(error))
    except Exception as error:
        return Reply(RAISED, f"{type(error).__name__}: {error}")


class WorkerError(Exception):
    """A design has broken the program in a worker, or the worker itself."""


class Engine(ABC):
    """A place to walk; a context manager that leaves no process behind."""

    @abstractmethod
    def walk(self, problem: FootProblem, k: Ints) -> Walked:
        """`FootProblem.walk` there: values (designs, record) and reasons of designs (designs, n).

        Raises
        ------
        FootoptError : not a design's fault. WorkerError : one of the designs'; the engine can go on.
        """

    def close(self) -> None:  # noqa: B027  most have nothing to do
        """Let go of what was started."""

    def __enter__(self) -> Engine:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


class Spread(Engine):
    """What engines with workers have in common: chunks, and the problem once a worker."""

    toll = 1e-3  # s that a chunk costs this process or the scheduler, whatever it holds: see `chunks`

    def __init__(self) -> None:
        self._problem: FootProblem | None = None
        self._task = Task("", None, np.empty((0, 0), np.int64))
        self._cost = 0.0  # s a design, as the last batch took

    @property
    @abstractmethod
    def slots(self) -> int:
        """Chunks that are walked at a time."""

    @abstractmethod
    def run(self, tasks: Sequence[Task]) -> list[Reply]:
        """Have chunks walked: a reply each, in their order."""

    def walk(self, problem: FootProblem, k: Ints) -> Walked:
        """Walk there."""
        if problem is not self._problem:
            self._prepare(problem)
        parts = chunks(len(k), self.slots, self._cost, self.toll)
        replies = self._run([self._task._replace(problem=None, k=k[part]) for part in parts])
        if len(k) == 1 and replies[0].kind == DIED:  # that need not have been the design's doing
            replies = self._run([self._task._replace(k=k)])
        for reply in replies:
            if reply.kind == OTHER:
                raise FootoptError(self._told(*reply.content))
            if reply.kind == REFUSED:
                raise FootoptError(reply.content)
        for reply in replies:
            if reply.kind != WALKED:
                raise WorkerError(reply.content)
        self._cost = sum(reply.seconds for reply in replies) / len(k)
        values, reasons = zip(*(reply.content for reply in replies), strict=True)
        return np.concatenate(values), np.concatenate(reasons)

    def _run(self, tasks: Sequence[Task]) -> list[Reply]:
        """`run`, and again, with the problem, what a worker could not do without it."""
        replies = self.run(tasks)
        unknown = [i for i, reply in enumerate(replies) if reply.kind == UNKNOWN]
        if unknown:
            again = self.run([tasks[i]._replace(problem=self._task.problem) for i in unknown])
            for i, reply in zip(unknown, again, strict=True):
                replies[i] = reply
        return replies

    def _prepare(self, problem: FootProblem) -> None:
        # compiled once, here, and kept on disk, from where every worker loads it
        problem.walk(np.asarray(problem.xu, np.int64)[None])
        try:
            content = pickle.dumps(problem)
        except Exception as error:
            raise FootoptError(
                f"The problem cannot be sent to other processes ({error}). What defines it has to be in a "
                "module, not in a function or typed into a session; or use engine=local."
            ) from None
        self._task = Task(digest(context(problem)), content, self._task.k)
        self._problem = problem

    def _told(self, where: str, there: dict[str, Any]) -> str:
        assert self._problem is not None, "it was sent"
        found = listed(differences(there, context(self._problem)))
        return (
            f"{where} would give other numbers than this process: {found} differ. "
            "Install the same versions on both, and use processors of one model."
        )


def chunks(designs: int, slots: int, cost: float, toll: float) -> list[slice]:
    """Cut a batch into equal chunks, so many that it is done soonest.

    C chunks on as many workers take C toll + work / C, with work = designs * cost: shortest for
    C = sqrt(work / toll), so that a small batch keeps a few workers busy only. If that is more than
    there are workers, further chunks even out what these are slower at, `EACH` a worker at most, as
    long as their toll is a `SHARE` of the time, work / slots.

    Parameters
    ----------
    slots : workers. cost : of a design, s; 0 if it is not known yet. toll : of a chunk, s, paid in turn.
    """
    work = designs * cost
    soonest = min(math.sqrt(work / toll), slots) if cost > 0.0 else slots
    even = min(SHARE * work / (slots * toll), EACH * slots)
    count = max(1, math.ceil(max(soonest, even)))
    size = min(math.ceil(designs / count), LARGEST)
    return [slice(i, i + size) for i in range(0, designs, size)]
