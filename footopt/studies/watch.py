"""How far is it? The page of a search that runs already, in a browser, until the search ends."""

from __future__ import annotations

import time
from pathlib import Path

from footopt.design import Solver
from footopt.errors import FileError, SettingError
from footopt.files import identity
from footopt.files.lock import Occupied, locked
from footopt.report.page.live import watched
from footopt.studies.base import Study
from footopt.studies.build import make_problem
from footopt.studies.load import load
from footopt.studies.record import scene_entry

POLL = 0.5  # s, between looks at whether the run has ended


def run(study: Study) -> None:
    """Serve the page of the run `study.run` until it ends, or until Ctrl-C; nothing is left behind."""
    (study.folder / identity.FILE).unlink(missing_ok=True)  # this is no run of its own
    if study.options.run is None:
        raise SettingError(
            "study.run", None, "the folder of a search that runs", "Such as run=outputs/optimize/2026..."
        )
    found = load(study.options.run)
    if found.config.study.name != "optimize":
        raise SettingError("study.run", study.options.run, "the folder of a run of study=optimize")
    if not at_work(found.folder):
        hint = (
            "footopt resume=FOLDER goes on with it."
            if not found.result
            else f"It has ended: open {found.folder / 'report.html'}."
        )
        raise FileError(f"{found.folder}: no run is at work here. {hint}")
    problem = make_problem(found.config, found.scene)
    solver = Solver(**vars(found.config.solver))
    store = Path(found.config.study.store or found.folder / "designs.sqlite")
    entry = {"settings": found.settings, **scene_entry(problem.scene, problem.accuracy, problem.record)}
    try:
        with watched(
            found.folder,
            store,
            problem,
            solver.generations(problem.space) * solver.pop_size,
            entry,
            study.say,
        ) as server:
            while at_work(found.folder):
                time.sleep(POLL)
            server.end()
        study.say(f"{found.folder} has ended")
    except KeyboardInterrupt:
        study.say("No longer watched; the run goes on")


def at_work(folder: Path) -> bool:
    """Whether a process has locked a folder."""
    try:
        with locked(folder):
            return False
    except Occupied:
        return True
