"""Processes are started within a time and whole: Ctrl-C waits until they have been."""

from __future__ import annotations

import _thread
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from multiprocessing import forkserver, resource_tracker
from types import FrameType
from typing import Any, TypeVar

Result = TypeVar("Result")


def end_fork_server() -> None:
    """End the process that starts workers: if it is stopped, no worker ever starts; the next has another.

    To other executors of this process their workers have died then. Only where none has started.
    """
    server: Any = forkserver
    if pid := getattr(server._forkserver, "_forkserver_pid", None):  # the standard library has no name for it
        with suppress(OSError):
            os.kill(pid, signal.SIGKILL)


def within(seconds: float, function: Callable[[], Result]) -> Result:
    """What a function returns; `TimeoutError` if it does not in time.

    Without memory, the standard library may wait for ever for a thread that could not begin. So the
    thread of this one is a bare one, which nobody waits for.
    """
    outcome: list[Future[Result]] = []
    ended = _thread.allocate_lock()

    def call() -> None:
        future: Future[Result] = Future()
        try:
            future.set_result(function())
        except BaseException as error:
            future.set_exception(error)
        outcome.append(future)
        ended.release()

    ended.acquire()
    _thread.start_new_thread(call, ())
    if not ended.acquire(timeout=seconds):
        raise TimeoutError
    return outcome[0].result()


@contextmanager
def interrupt_held() -> Iterator[None]:
    """Ctrl-C waits until the end, a second one does not; processes and threads started in here never hear it.

    A terminal sends it to all of them, but it is the search that has to stop. To block the signal in this
    thread is not enough for that: a library's threads hear it too, and Python then interrupts the main one.
    A worker that is cut off while it starts is known to nobody, and cannot load what has gone meanwhile.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    heard, handler = [], signal.getsignal(signal.SIGINT)

    def hold(signum: int, frame: FrameType | None) -> None:
        heard.append(signum)
        if len(heard) > 1 and callable(handler):
            handler(signum, frame)

    holds = callable(handler) and threading.current_thread() is threading.main_thread()
    if holds:
        signal.signal(signal.SIGINT, hold)
    try:
        resource_tracker.ensure_running()  # it would lift the mask if it were started below
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    finally:
        if holds:
            signal.signal(signal.SIGINT, handler)
            if heard:
                signal.raise_signal(signal.SIGINT)
