"""`Dask`: an engine of the workers of a dask scheduler; needs the extra footopt[dask]."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

from footopt.design.processes import deaf
from footopt.design.workers import DIED, REFUSED, Reply, Spread, Task, work
from footopt.errors import FootoptError, SettingError, check
from footopt.walk.simulate import at_once

RETRIES = 2  # of a chunk that a worker cannot even begin
SCHEMES = ("tcp", "tls", "ucx", "ws", "wss")


class Dask(Spread):
    """The workers of a dask scheduler, on as many machines as it has.

    Parameters
    ----------
    address : of the scheduler, "tcp://host:port"; None starts one here, with workers.
    workers : processes of a cluster that is started here; by default as many as processors.
    timeout : for the scheduler to answer and to have a worker, s.

    Raises
    ------
    SettingError : dask is not installed, or the address is none.
    FootoptError : the scheduler does not answer, or has no worker.
    """

    toll = 2e-3

    def __init__(self, address: str | None = None, workers: int | None = None, timeout: float = 10.0) -> None:
        super().__init__()
        count = at_once(workers, "engine.workers")
        check(0 < timeout <= 1e5, "engine.timeout", timeout, "a time > 0 and <= 1e5, in s")
        try:
            import dask
            import distributed
        except ImportError as error:
            raise SettingError(
                "engine", "dask", f"installed ({error})", "pip install 'footopt[dask]', or engine=processes."
            ) from None
        if address is not None:
            check_address(address)
        logging.getLogger("distributed").setLevel(logging.WARNING)
        self._distributed, self._timeout = distributed, timeout
        self._cluster: Any = None
        self._name = "engine.address" if address is None else f"engine.address = {address!r}"
        # chunks of a large batch are sent at once, which dask takes for a mistake
        dask.config.set({"distributed.admin.large-graph-warning-threshold": "1GB"})
        if address is None:
            # a chunk whose worker dies is halved at once, not tried again as a whole
            dask.config.set({"distributed.scheduler.allowed-failures": 0})
            with deaf():
                self._cluster = distributed.LocalCluster(
                    n_workers=count,
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address=":0",
                    memory_limit=0,
                    silence_logs=logging.ERROR,  # it warns of every chunk that a Ctrl-C takes back
                )
        try:
            self._client = distributed.Client(self._cluster or address, timeout=timeout, set_as_default=False)
        except OSError:
            if self._cluster is not None:
                self._cluster.close()
            raise FootoptError(
                f"{self._name}: no scheduler answers within {timeout:g} s (engine.timeout). Is it running "
                "(`dask scheduler`), and can this machine reach it?"
            ) from None
        try:
            self._client.wait_for_workers(1, timeout=timeout)
        except (TimeoutError, OSError):
            self.close()
            raise FootoptError(
                f"{self._name}: the scheduler has no worker after {timeout:g} s (engine.timeout). Start some "
                "(`dask worker ADDRESS --nthreads 1`), or wait longer."
            ) from None

    @property
    def slots(self) -> int:
        """Threads of all workers."""
        threads: dict[str, int] = self._ask(self._client.nthreads)
        return max(1, sum(threads.values()))

    def run(self, tasks: Sequence[Task]) -> list[Reply]:
        """Have chunks walked; dask gives those of a worker that dies to others."""
        futures = self._ask(lambda: self._client.map(work, tasks, pure=False, retries=RETRIES))
        try:
            idle = 0.0
            while any(not future.done() for future in futures):
                try:
                    with self._client.as_current():
                        self._distributed.wait(futures, timeout=1.0)
                except TimeoutError:
                    idle = 0.0 if self._ask(self._client.nthreads) else idle + 1.0
                    if idle >= self._timeout:
                        raise FootoptError(
                            f"{self._name}: no worker is left since {self._timeout:g} s (engine.timeout). "
                            "What was walked in finished generations is kept: start workers, and resume."
                        ) from None
            failed = [i for i, future in enumerate(futures) if future.status != "finished"]
            whole = [future for future in futures if future.status == "finished"]
            replies = iter(self._ask(lambda: self._client.gather(whole)))
            return [self._failure(f) if i in failed else next(replies) for i, f in enumerate(futures)]
        finally:
            with suppress(Exception):
                self._client.cancel(futures, force=True)

    def close(self) -> None:
        """Leave the scheduler; end a cluster that was started here."""
        with suppress(Exception):
            self._client.close(timeout=5)
        if self._cluster is not None:
            self._cluster.close(timeout=10)

    def _ask(self, question: Callable[[], Any]) -> Any:
        """An answer of the scheduler."""
        try:
            return question()
        except (OSError, TimeoutError, RuntimeError, self._distributed.client.FutureCancelledError) as error:
            raise FootoptError(
                f"{self._name}: the connection to the scheduler is lost ({type(error).__name__}: {error}). "
                "What was walked in finished generations is kept: start it again, and resume."
            ) from None

    def _failure(self, future: Any) -> Reply:
        """Why dask has no reply: the death of one worker after the other, or it cannot run footopt."""
        error = future.exception() if future.status == "error" else RuntimeError(future.status)
        text = f"{type(error).__name__}: {error}"
        if isinstance(error, self._distributed.scheduler.KilledWorker):
            return Reply(DIED, "the worker has died, and others after it")
        return Reply(REFUSED, f"{self._name}: a worker cannot walk ({text}). Is the same footopt installed?")


def check_address(address: str) -> None:
    """Raise unless it is one that dask can try: what it does with others takes long to say."""
    try:
        parts = urlsplit(address)
        known = parts.scheme in SCHEMES and parts.hostname and parts.port
    except ValueError:  # a port that is no number
        known = False
    check(known, "engine.address", address, f"{SCHEMES[0]}://host:port (or {', '.join(SCHEMES[1:])})")
