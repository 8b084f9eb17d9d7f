"""How far is it? The page of a search that runs already, in a browser, until the search ends."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from footopt.design import Solver
from footopt.errors import FileError, SettingError
from footopt.files import identity
from footopt.files.lock import LOCK, Occupied, locked
from footopt.report.page.live import watched
from footopt.studies.base import Study
from footopt.studies.build import make_problem
from footopt.studies.load import read
from footopt.studies.record import scene_entry

POLL = 0.5  # s, between looks at whether the run has ended


def run(study: Study) -> None:
    """Serve the page of the run `study.run` until it ends, or until Ctrl-C; nothing is left behind."""
    if study.options.run is None:
        raise SettingError(
            "run", None, "the folder of a search that runs", "Such as run=outputs/optimize/2026..."
        )
    found = read(study.options.run, "run")
    if found.config.study.name != "optimize":
        raise SettingError("run", study.options.run, "the folder of a run of study=optimize")
    if not at_work(found.folder):
        hint = (
            "footopt resume=FOLDER goes on with it."
            if not found.result
            else f"It has ended: open {found.folder / 'report.html'}."
        )
        raise FileError(f"{found.folder}: no run is at work here. {hint}")
    problem = make_problem(found.config, found.scene)
    solver = Solver(**vars(found.config.solver)).fitting(problem.n_obj)
    store = Path(found.config.study.store or found.folder / "designs.sqlite")
    entry = {"settings": found.settings, **scene_entry(problem.scene, problem.accuracy, problem.record)}
    most = int(min(solver.designs, problem.space.K**problem.space.n))
    with _stop() as stop, watched(found.folder, store, problem, most, entry, study.say) as server:
        while at_work(found.folder) and not stop.wait(POLL):
            pass
        if not stop.is_set():
            server.end()
    study.say("No longer watched; the run goes on" if stop.is_set() else f"{found.folder} has ended")
    for name in (identity.FILE, LOCK):  # this is no run of its own
        (study.folder / name).unlink(missing_ok=True)
    with suppress(OSError):
        study.folder.rmdir()


@contextmanager
def _stop() -> Iterator[threading.Event]:
    """What Ctrl-C sets: it ends the watching, and there is nothing to go on with."""
    stop = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield stop
        return
    before = signal.signal(signal.SIGINT, lambda *_: stop.set())
    try:
        yield stop
    finally:
        signal.signal(signal.SIGINT, before)


def at_work(folder: Path) -> bool:
    """Whether a process has locked a folder."""
    try:
        with locked(folder):
            return False
    except Occupied:
        return True
