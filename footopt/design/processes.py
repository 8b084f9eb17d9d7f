"""`Processes`: an engine of processes on this machine that outlives the death of any of them."""

from __future__ import annotations

import multiprocessing
import signal
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait

from footopt.design.workers import DIED, UNKNOWN, Reply, Spread, Task, work
from footopt.errors import FootoptError
from footopt.walk.simulate import at_once

PATIENCE = 60.0  # s, for a process to start


class _Worker:
    """A process of `Processes` and the pipe to it."""

    def __init__(self) -> None:
        spawn = multiprocessing.get_context("spawn")  # forked after threads have run, it could hang
        self.pipe, theirs = spawn.Pipe()
        self.process = spawn.Process(target=_serve, args=(theirs,), name="footopt worker", daemon=True)
        with deaf():
            self.process.start()
        theirs.close()

    def stop(self) -> None:
        """End it at once."""
        self.pipe.close()
        self.process.kill()
        self.process.join()
        self.process.close()


class Processes(Spread):
    """Processes of this machine, one thread each; one that dies is replaced.

    Against `Local`, with its threads, they are worth it where a design may kill its process, or where
    many threads stand in each other's way.

    Parameters
    ----------
    workers : processes; by default as many as processors that this one may run on.
    """

    toll = 5e-4

    def __init__(self, workers: int | None = None) -> None:
        super().__init__()
        self._slots = at_once(workers, "engine.workers")
        self._idle: list[_Worker] = []

    @property
    def slots(self) -> int:
        """Processes."""
        return self._slots

    def run(self, tasks: Sequence[Task]) -> list[Reply]:
        """Have chunks walked, each by the process that is free first."""
        replies = [Reply(UNKNOWN)] * len(tasks)
        waiting = deque(range(len(tasks)))
        busy: dict[Connection, tuple[_Worker, int]] = {}
        self._start()
        try:
            while waiting or busy:
                while waiting and self._idle:
                    worker, i = self._idle.pop(), waiting.popleft()
                    busy[worker.pipe] = worker, i
                    with suppress(OSError):  # it has died: `recv` will tell
                        worker.pipe.send(tasks[i])
                for pipe in wait(list(busy)):
                    assert isinstance(pipe, Connection), "nothing else is waited for"
                    worker, i = busy[pipe]
                    try:
                        replies[i] = pipe.recv()
                        self._idle.append(worker)
                    except (EOFError, OSError):
                        worker.process.join()
                        replies[i] = Reply(DIED, f"the worker has died ({_end(worker)})")
                        worker.stop()
                    del busy[pipe]
                if waiting:
                    self._start(len(busy))
        finally:
            for worker, _ in busy.values():  # interrupted: what they still do is of no use
                worker.stop()
        return replies

    def close(self) -> None:
        """End the processes; they are idle."""
        while self._idle:
            self._idle.pop().stop()

    def _start(self, busy: int = 0) -> None:
        """Start what is missing, all at a time, and wait for it."""
        for worker in [w for w in self._idle if not w.process.is_alive()]:
            self._idle.remove(worker)
            worker.stop()
        new = [_Worker() for _ in range(self._slots - len(self._idle) - busy)]
        try:
            for worker in new:
                try:
                    if not worker.pipe.poll(PATIENCE):
                        raise FootoptError(f"engine=processes: no worker has started within {PATIENCE:g} s.")
                    worker.pipe.recv()
                except (EOFError, OSError):
                    worker.process.join()
                    raise FootoptError(
                        f"engine=processes: a worker cannot start ({_end(worker)}). A script that searches "
                        'has to do so below `if __name__ == "__main__":`, as workers import it.'
                    ) from None
        except BaseException:
            for worker in new:
                worker.stop()
            raise
        self._idle += new


def _serve(pipe: Connection) -> None:
    """A worker's life: chunks, until the other end of the pipe is closed, however that process ends."""
    with suppress(EOFError, OSError):
        pipe.send(None)
        while True:
            pipe.send(work(pipe.recv()))


def _end(worker: _Worker) -> str:
    code = worker.process.exitcode or 0
    return f"exit code {code}" if code >= 0 else f"signal {signal.Signals(-code).name}"


@contextmanager
def deaf() -> Iterator[None]:
    """Processes and threads started in here do not hear Ctrl-C: a terminal sends it to all, but it is ours.

    Here it is held back until the end.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # which would lift the mask when it is started below
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
