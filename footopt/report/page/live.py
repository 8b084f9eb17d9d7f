"""A search watched while it runs: its page, served to a browser on this machine alone."""

from __future__ import annotations

import json
import secrets
import sqlite3
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.design import FootProblem
from footopt.design.context import context, digest
from footopt.design.fronts import Volume, nondominated
from footopt.files.run import plain
from footopt.foot import Foot
from footopt.report.numbers import title
from footopt.report.page.file import packed, text
from footopt.report.page.walks import DESIGNS, common, splines, traces_of_flat
from footopt.report.terminal import describe_scene
from footopt.walk import simulate

Array = NDArray[np.float64]

LOOPBACK = "127.0.0.1"
PATIENCE = 5.0  # s, for a browser to fetch the page of a search that has ended


class Growth:
    """The designs that a search has walked, in the order in which they were seen in its store.

    Parameters
    ----------
    path : Path
        Of the store, which is only read.
    problem : FootProblem
        What is searched.
    """

    def __init__(self, path: Path, problem: FootProblem) -> None:
        self._path, self._problem = path, problem
        self._digest, self._lock = digest(context(problem)), threading.Lock()
        self._rows: dict[tuple[int, ...], list[Any]] = {}
        self._box: tuple[Array, Array] | None = None
        self._volume, self._known = Volume(), 0

    def since(self, first: int) -> list[list[Any]]:
        """Rows of k, recorded values and why a design is not feasible, from the `first` one on."""
        with self._lock:
            for row in self._read():
                self._rows.setdefault(tuple(row[: self._problem.space.n]), row)
            return list(self._rows.values())[first:]

    def hypervolume(self) -> float | None:
        """That of the designs seen so far, in units of the box of the first; None before there is one."""
        with self._lock:
            rows, problem = list(self._rows.values()), self._problem
            values = np.array([row[problem.space.n : -1] for row in rows if not row[-1]], float)
            if problem.n_obj == 1 or not len(values):
                return None
            f = problem.minimised(values)
            if self._box is None and (np.ptp(f, axis=0) > 0.0).all():
                self._box = f.max(axis=0), np.ptp(f, axis=0)
            if self._box is None:
                return None
            best = nondominated(f)
            new, self._known = np.arange(len(f)) >= self._known, len(f)
            return self._volume((f[best] - self._box[0]) / self._box[1], new[best])

    def _read(self) -> list[list[Any]]:
        names = [*(f"k{i + 1}" for i in range(self._problem.space.n)), *self._problem.record, "reason"]
        columns = ", ".join(f'"{name}"' for name in names)
        place = f"{self._path.resolve().as_uri()}?mode=ro"
        with suppress(sqlite3.OperationalError), closing(sqlite3.connect(place, uri=True)) as store:
            query = "SELECT id FROM context WHERE digest = ?"
            for (number,) in store.execute(query, (self._digest,)):
                return [list(row) for row in store.execute(f"SELECT {columns} FROM designs_{number}")]
        return []  # before its first design, or while it is locked


def live_content(problem: FootProblem, most: int, entry: dict[str, Any]) -> dict[str, Any]:
    """The page of a search that runs, with room for its designs.

    Parameters
    ----------
    problem : FootProblem
        What is searched.
    most : int
        Designs that it walks at most.
    entry : dict
        What is known of the run, as in result.json.
    """
    space, room = problem.space, min(most, DESIGNS)
    flat = simulate(Foot.flat(space), problem.scene, problem.accuracy)
    entry = {**entry, "flat": flat.judged(problem.record)}
    return {
        **common(entry, problem.scene, problem.record, problem.accuracy, space),
        "title": f"A search on {describe_scene(problem.scene)}",
        "headline": [f"Soles for {', '.join(map(title, problem.names))}"],
        "live": {"most": most},
        "guide": problem.names[0],
        "objectives": list(problem.names),
        "designs": {
            "rows": packed(np.arange(room)),
            "values": packed(np.full((room, len(problem.record)), np.nan), exact=True),
            "k": packed(np.full((room, space.n), space.K)),
            "generation": packed(np.zeros(room, int)),
            "feasible": packed(np.zeros(room, int)),
            "reasons": ["not walked yet"],
            "reason": packed(np.zeros(room, int)),
        },
        "space": splines(space),
        "top": space.top,
        "width": space.width,
        "best": 0,
        "walks": [traces_of_flat(flat)],
        "lineage": [],
        "history": [{"evaluations": 0, "best": None, "median": None, "front": 0}],
    }


class Watched:
    """A server of two things: the page, and the designs that are new; to this machine, behind a token.

    Parameters
    ----------
    page : str
        The page while the search runs.
    growth : Growth
        Its designs.
    report : Path
        The page of the run, which takes its place once `end` was called.
    """

    def __init__(self, page: str, growth: Growth, report: Path) -> None:
        self._page, self._growth, self._report = page, growth, report
        self._ended, self._fetched, self._asked = False, threading.Event(), 0.0
        token, answer = secrets.token_urlsafe(16), self._answer

        class Handler(BaseHTTPRequestHandler):
            timeout = PATIENCE

            def handle(self) -> None:
                with suppress(ConnectionError, TimeoutError):  # a browser that looks no longer
                    super().handle()

            def do_GET(self) -> None:
                path, _, query = self.path.partition("?")
                # another name for this machine may be another site's, which would then read the page
                host = self.headers.get("Host", "") in (f"{LOOPBACK}:{port}", f"localhost:{port}")
                begin, given, what = (*path.split("/", 2), "", "")[:3]
                known = host and not begin and secrets.compare_digest(given.encode(), token.encode())
                kind, content = (known and answer(what, query)) or ("text/plain", None)
                self.send_response(404 if content is None else 200)
                for name, value in {
                    "Content-Type": f"{kind}; charset=utf-8", "Cache-Control": "no-store",
                    "Referrer-Policy": "no-referrer", "X-Content-Type-Options": "nosniff",
                }.items():  # fmt: skip
                    self.send_header(name, value)
                self.end_headers()
                self.wfile.write((content or "There is nothing here.").encode())

            def log_message(self, *said: object) -> None:
                """Say nothing: the terminal shows the search."""

        self._server = ThreadingHTTPServer((LOOPBACK, 0), Handler)
        self._server.daemon_threads = True
        port = self._server.server_port
        self.address = f"http://{LOOPBACK}:{port}/{token}/"
        threading.Thread(target=self._server.serve_forever, args=(0.1,), daemon=True).start()

    def _answer(self, what: str, query: str) -> tuple[str, str] | None:
        """The type and the text of what was asked for; None for anything but the two."""
        self._asked = time.monotonic()
        if what == "":
            if self._ended:
                self._fetched.set()
            return "text/html", self._report.read_text(encoding="utf-8") if self._ended else self._page
        first = query.removeprefix("from=")
        if what != "news" or not first.isdecimal() or len(first) > len(str(DESIGNS)):
            return None
        designs = self._growth.since(int(first))
        volume = self._growth.hypervolume() if designs else None
        news = {"designs": designs, "hypervolume": volume, "ended": self._ended}
        return "application/json", json.dumps(plain(news), allow_nan=False)

    def end(self) -> None:
        """The search has ended: let a browser that looks fetch its page, if it has one."""
        self._ended = self._report.is_file()
        if self._ended and time.monotonic() - self._asked < PATIENCE:
            self._fetched.wait(PATIENCE)

    def close(self) -> None:
        """Serve nothing more."""
        self._server.shutdown()
        self._server.server_close()


@contextmanager
def watched(
    folder: Path,
    store: Path,
    problem: FootProblem,
    most: int,
    entry: dict[str, Any],
    say: Callable[[str], None],
) -> Iterator[Watched]:
    """Serve the page of a search for the block, and open it in a browser.

    Parameters
    ----------
    folder : Path
        Of the run.
    store : Path
        Of its designs.
    problem, most, entry
        As in `live_content`.
    say : callable
        Told the address.
    """
    page = text(live_content(problem, most, entry))
    server = Watched(page, Growth(store, problem), folder / "report.html")
    try:
        say(f"Watch it at {server.address} (on this machine only; Ctrl-C ends it)")
        webbrowser.open(server.address)
        yield server
    finally:
        server.close()
