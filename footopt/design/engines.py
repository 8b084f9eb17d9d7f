"""Executors by the name of an engine: processes of this machine, or the workers of a dask scheduler."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import partial
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from footopt.design.executor import CANNOT_START, PASSING, PATIENCE, Renewing, handled
from footopt.design.starting import interrupt_held, within
from footopt.errors import FootoptError, SettingError, check
from footopt.walk.simulate import at_once

log = logging.getLogger("footopt")

SIGN = ("process", "beats", "begun", "ended")  # what a worker tells all the time
BEAT = 0.5  # s between two signs
SILENT = 20  # checks, a second each, until a worker that has fallen silent is ended
STARTING = 60  # the same, for one that has never been heard of
ENGINES = ("local", "processes", "dask")
#: Files that a process has open with workers of its own, and more for each of them.
FILES = {"dask": (40, 20), "processes": (32, 2)}
SCHEMES = ("tcp", "tls", "ucx", "ws", "wss")


def make_executor(
    name: str = "local", workers: int | None = None, address: str | None = None, timeout: float = 10.0
) -> AbstractContextManager[Executor | None]:
    """The executor of an engine, for a `with` statement; None for "local". See `processes` and `Dask`."""
    check(name in ENGINES, "engine", name, f"one of {', '.join(ENGINES)}")
    check(
        workers is None or (name != "local" and address is None),
        "engine.workers",
        workers,
        "null for engine=local and for a cluster that has its own",
        "engine.threads is the number of threads here.",
    )
    check(address is None or name == "dask", "engine.address", address, f"null for engine={name}")
    if name == "dask":
        return Dask(address, workers, timeout)
    return processes(workers) if name == "processes" else nullcontext()


def processes(workers: int | None = None) -> Renewing:
    """Processes of this machine, one thread each, that are replaced when one dies.

    Against the threads of this process they are worth it where a design may kill its process, or where
    many threads stand in each other's way.

    Parameters
    ----------
    workers : int, optional
        How many; by default as many as processors that this one may run on.
    """
    count = at_once(workers, "engine.workers")
    _check_files("processes", count)
    return Renewing(partial(_Pool, count), overhead=5e-4)


class _Pool(ProcessPoolExecutor):
    """Processes that do not hear Ctrl-C, end with their parent, however that ends, and give signs of life.

    Forked from a server that has imported footopt they start in half the time of spawned ones; forked
    from this process, after its threads have run, they could hang.
    """

    def __init__(self, workers: int) -> None:
        methods = multiprocessing.get_all_start_methods()
        start = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
        start.set_forkserver_preload([__name__])
        self._signs = start.RawArray("q", len(SIGN) * workers)
        self._seen: dict[int, tuple[list[int], int]] = {}  # a process's last sign, for how many checks
        self._idle = 0  # checks for which no worker has had anything to do
        super().__init__(
            workers, mp_context=start, initializer=_begin, initargs=(self._signs, start.Value("i", 0))
        )

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        with interrupt_held():  # processes are started here
            return super().submit(fn, *args, **kwargs)

    def check(self) -> bool:
        """End a worker that has fallen silent; say whether none of them knows of the work that is awaited.

        What counts is how many checks have passed: a terminal's Ctrl-Z stops this process, too.
        """
        signs = {pid: rest for pid, *rest in np.reshape(self._signs, (-1, len(SIGN))).tolist() if pid}
        working = False
        for pid, process in list((self._processes or {}).items()):
            sign = signs.get(pid, [])
            last, since = self._seen.get(pid, ([], 0))
            self._seen[pid] = (sign, since + 1 if sign == last else 0)
            working |= not sign or sign[1] != sign[2] or sign[1:] != last[1:]
            if self._seen[pid][1] == (SILENT if sign else STARTING):
                log.warning(
                    "worker process %d has been silent for %d s (stopped, or without memory?): it is "
                    "ended, and others do its work",
                    pid,
                    self._seen[pid][1],
                )
                process.kill()
        self._idle = 0 if working else self._idle + 1
        if self._idle >= SILENT:
            log.warning("the workers are idle, but their results are missing: new ones walk again")
        return self._idle >= SILENT


def _begin(signs: Any, count: Any) -> None:
    """The first thing in a worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with count.get_lock():
        place = len(SIGN) * count.value
        count.value += 1
    threading.Thread(target=_live, args=(signs, place), daemon=True).start()


def _live(signs: Any, place: int) -> None:
    """Give signs of life, and end with the parent."""
    parent = multiprocessing.parent_process()
    assert parent is not None, "this is a worker"
    beats = 0
    while parent.is_alive():
        beats += 1
        signs[place : place + len(SIGN)] = [os.getpid(), beats, *handled]
        with suppress(OSError, MemoryError):
            parent.join(BEAT)
    os._exit(1)


class Dask(Executor):
    """The workers of a dask scheduler, on as many machines as it has; needs footopt[dask].

    Parameters
    ----------
    address : str, optional
        Of the scheduler, "tcp://host:port"; by default one is started here, with workers.
    workers : int, optional
        Processes of a cluster that is started here; by default as many as processors.
    timeout : float, s
        For the scheduler to answer and to have a worker.

    Raises
    ------
    SettingError
        dask is not installed, or the address is none.
    FootoptError
        The scheduler does not answer, has no worker, or loses all of them for the timeout.
    """

    overhead = 2e-3

    def __init__(self, address: str | None = None, workers: int | None = None, timeout: float = 10.0) -> None:
        count = at_once(workers, "engine.workers")
        check(0 < timeout <= 1e5, "engine.timeout", timeout, "a time > 0 and <= 1e5, in s")
        try:
            if address is None:
                import cryptography  # noqa: F401  for the keys of the cluster
            import dask
            import distributed
        except ImportError as error:
            raise SettingError(
                "engine", "dask", f"installed ({error})", "pip install 'footopt[dask]', or engine=processes."
            ) from None
        if address is not None:
            check_address(address)
        else:
            _check_files("dask", count)
        logging.getLogger("distributed").setLevel(logging.WARNING)
        self._timeout, self._cluster = timeout, None
        self._lost_errors = (OSError, RuntimeError, distributed.client.FutureCancelledError)
        self._name = "engine=dask" if address is None else f"engine.address = {address!r}"
        self._seen: dict[str, tuple[Any, int]] = {}  # by worker: its last sign, and for how many checks
        self._busy_at = time.monotonic()  # when there was a worker
        self._idle = 0  # checks for which no worker has had anything to do
        if address is None:
            # a chunk whose worker dies is halved at once, not tried again as a whole; nothing is served
            dask.config.set(
                {
                    "distributed.scheduler.allowed-failures": 0,
                    "distributed.scheduler.http.routes": [],
                    "distributed.worker.http.routes": [],
                }
            )
            make = partial(
                distributed.LocalCluster,
                n_workers=count,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                security=distributed.Security.temporary(),  # who can reach the port cannot run code
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                memory_limit=0,
                silence_logs=logging.CRITICAL,  # of chunks that a Ctrl-C takes back, of a scheduler that ends
            )
            try:
                with interrupt_held():
                    self._cluster = within(PATIENCE[-1], make)
                # it opens a file in every garbage collection, and writes a traceback where it cannot
                distributed.gc.disable_gc_diagnosis(force=True)
            except PASSING as error:
                why = f"{type(error).__name__}: {error}".removesuffix(": ")
                raise FootoptError(f"engine=dask: {CANNOT_START.format(why)}") from None
        try:
            self._client = distributed.Client(self._cluster or address, timeout=timeout, set_as_default=False)
        except OSError:
            if self._cluster is not None:
                self._cluster.close()
            raise FootoptError(
                f"{self._name}: no scheduler answers within {timeout:g} s (engine.timeout). Is it running "
                "(`dask scheduler`), and can this machine reach it?"
            ) from None
        self._executor = self._client.get_executor(pure=False)
        try:
            self._client.wait_for_workers(1, timeout=timeout)
        except OSError:
            self.shutdown()
            raise FootoptError(
                f"{self._name}: the scheduler has no worker after {timeout:g} s (engine.timeout). Start some "
                "(`dask worker ADDRESS --nthreads 1`), or wait longer."
            ) from None

    @property
    def workers(self) -> int:
        """Threads of all workers."""
        return sum(worker["nthreads"] for worker in self._workers().values())

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a function called by a worker; by another one if that dies."""
        self._idle = 0
        future: Future[Any] = self._ask(partial(self._executor.submit, fn, *args, **kwargs))
        return future

    def check(self) -> bool:
        """Raise if the scheduler is lost, has no worker, or results do not come; leave out silent workers."""
        now, workers = time.monotonic(), self._workers()
        for address, worker in workers.items():
            last, since = self._seen.get(address, (None, 0))
            self._seen[address] = (worker["last_seen"], since + 1 if worker["last_seen"] == last else 0)
            if self._seen[address][1] == SILENT:
                log.warning(
                    "worker %s has been silent for %d s (stopped, or cut off?): others do its work",
                    address,
                    SILENT,
                )
                leave = partial(self._client.scheduler.unregister, address=address, stimulus_id="silent")
                self._told(leave)
        if workers:
            self._busy_at = now
        elif now - self._busy_at > self._timeout:
            raise FootoptError(
                f"{self._name}: no worker is left since {self._timeout:g} s (engine.timeout). "
                "What was walked in finished generations is kept: start workers, and resume."
            )
        asked = partial(self._client.scheduler.processing, workers=None)
        self._idle = 0 if any(self._told(asked).values()) else self._idle + 1
        if self._idle >= SILENT:
            raise FootoptError(
                f"{self._name}: the workers are idle, but their results do not come. Too few files? "
                "`ulimit -n` says how many. What was walked in finished generations is kept: resume."
            )
        return False

    def _workers(self) -> dict[str, Any]:
        """What the scheduler knows of its workers, by address."""
        return dict(self._told(self._client.scheduler.identity)["workers"])

    def _told(self, question: Callable[..., Any]) -> Any:
        """What the scheduler says; it has the timeout for it."""
        return self._ask(partial(self._client.sync, question, callback_timeout=self._timeout))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Leave the scheduler; end a cluster that was started here."""
        with suppress(Exception):
            self._client.close(timeout=5)
        self._client.status = "closed"  # else it tries again when it is collected, and says that it cannot
        if self._cluster is not None:
            self._cluster.close(timeout=10)

    def _ask(self, question: Callable[[], Any]) -> Any:
        """An answer of the scheduler."""
        try:
            return question()
        except TimeoutError:
            raise FootoptError(
                f"{self._name}: the scheduler has not answered for {self._timeout:g} s (engine.timeout). "
                "Is it stopped? What was walked in finished generations is kept: start it again, and resume."
            ) from None
        except self._lost_errors as error:
            own, why = self._cluster is not None, f" ({type(error).__name__}: {error})"
            cause = ". Too few files? `ulimit -n` says how many" if own else why
            raise FootoptError(
                f"{self._name}: the connection to the scheduler is lost{cause}. What was walked in finished "
                f"generations is kept: {'' if own else 'start it again, and '}resume."
            ) from None


def _check_files(engine: str, workers: int) -> None:
    """Raise where there are too few: dask then hangs, and either fails wherever the next one is opened."""
    if os.name == "posix":
        import resource

        own, each = FILES[engine]
        needed = own + each * workers
        if 0 <= (limit := resource.getrlimit(resource.RLIMIT_NOFILE)[0]) < needed:
            raise FootoptError(
                f"engine={engine}: `ulimit -n` allows {limit} open files; {needed} are needed for {workers} "
                "workers. Allow more, set engine.workers, or take engine=local."
            )


def check_address(address: str) -> None:
    """Raise unless it is one that dask can try: what it does with others takes long to say."""
    try:
        parts = urlsplit(address)
        known = parts.scheme in SCHEMES and parts.hostname and parts.port
    except ValueError:  # a port that is no number
        known = False
    check(known, "engine.address", address, f"{SCHEMES[0]}://host:port (or {', '.join(SCHEMES[1:])})")
