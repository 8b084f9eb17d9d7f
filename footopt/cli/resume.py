"""`footopt resume=FOLDER`: go on with a run, or with all jobs of a multirun."""

from __future__ import annotations

import logging
import math
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.compose import readable
from footopt.cli.job import walk
from footopt.cli.messages import explain
from footopt.design import AUTO, SOLVERS, Solver
from footopt.errors import ERROR_FILE, FileError, FootoptError, SettingError, check
from footopt.files import identity
from footopt.files.identity import Occupied, locked
from footopt.files.io import write_text
from footopt.studies.runs import CHANGEABLE, check_same, finished, may_change, result_of
from footopt.studies.settings import REPORTS, SEARCHES, Config

TRUST, FORCE = "--trust", "--force"
MULTIRUN = "multirun.yaml"
#: Settings by which a folder could have code run that nobody asked for, and files that a run writes.
CODE, WRITTEN = ("plugins", "engine.address"), ("study.store", "study.video")

#: Settings that may make a search longer.
BUDGETS = ("solver.walks", "solver.n_gen")

log = logging.getLogger("footopt")


def resume(given: Sequence[str]) -> int:
    """Go on with the run, or the multirun, that the words name.

    What is in the folder is read as data: none of its words is run, and it loads no code that is not
    named on the command line or trusted there. The search itself does the rest: what its store holds is
    not walked again.

    Parameters
    ----------
    given : sequence of str
        The words of the command line: resume=FOLDER, --trust (the folder may have code run, and files
        written elsewhere), --force (to go on with the run of another version), and settings that are
        `CHANGEABLE`.

    Returns
    -------
    int
        How many jobs of a multirun failed.

    Raises
    ------
    FootoptError
        The folder holds no run, or it cannot go on like that.
    """
    folders = [word.removeprefix("resume=") for word in given if word.startswith("resume=")]
    check(folders[-1] != "", "resume", "", "the folder of a run")
    new = [word for word in given if not word.startswith("resume=") and word not in (TRUST, FORCE)]
    new += ["study.reuse=true"] * (FORCE in given)
    folder, trusted = Path(folders[-1]).expanduser().absolute(), TRUST in given
    logging.basicConfig(level=logging.WARNING, stream=sys.stdout, format="[%(levelname)s] %(message)s")
    changes = [_change(readable(word)) for word in new]
    if (folder / MULTIRUN).is_file():
        return _resume_jobs(folder, changes, new, trusted)
    _resume_run(folder, result_of(folder), changes, new, trusted)
    return 0


def _change(word: str) -> tuple[str, Any]:
    """A setting that a run may change, and its value.

    Raises
    ------
    SettingError
        It is no such setting.
    """
    name, equals, _ = word.partition("=")
    if not equals or not may_change(name):
        raise SettingError(
            "resume",
            word,
            f"a setting that does not make another run ({', '.join(CHANGEABLE)})",
            "For anything else start a new run, without resume.",
        )
    parsed = OverridesParser.create().parse_override(word)
    if parsed.is_sweep_override():
        raise SettingError("resume", word, "one value", "A run goes on with one.")
    return name, parsed.value()


def _resume_run(
    folder: Path,
    found: Mapping[str, Any] | None,
    changes: Sequence[tuple[str, Any]],
    words: Sequence[str],
    trusted: bool,
) -> None:
    """Go on with one run, which has left such a result."""
    run, named = identity.read(folder), [name for name, _ in changes]
    if run.version != version("footopt") and ("study.reuse", True) not in changes:
        allowed = f"a run of footopt {version('footopt')}, which this is, not of {run.version}"
        hint = f"Start a new run; or add {FORCE}, if you know that the walks are the same."
        raise SettingError("resume", str(folder), allowed, hint)
    settings = _structured(folder, run.settings)
    study = settings.study.name
    if finished(found) and study not in SEARCHES:
        raise SettingError("resume", str(folder), f"a run of study={', '.join(SEARCHES)}, not {study}")
    check_same(folder, run.settings, found)
    for name in () if trusted else (*CODE, *WRITTEN):
        value, own = OmegaConf.select(settings, name), {name, name.partition(".")[0]} & {*named}
        if not value or own or (name in WRITTEN and (folder / value).resolve().parent == folder.resolve()):
            continue
        raise SettingError(
            name, value, f"trusted: it comes from {folder}", f"Add {TRUST} if you know it, or give your own."
        )
    for name, value in changes:
        if name == "engine":
            OmegaConf.update(settings, name, OmegaConf.structured(Config).engine, merge=False)
        OmegaConf.update(settings, "engine.name" if name == "engine" else name, value, merge=False)
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    _check_no_less(found or {}, plain)
    groups = tuple(f"{name}." for name in named)  # engine=... begins anew, without engine.timeout
    kept = [word for word in run.words if not f"{word.partition('=')[0]}.".startswith(groups)]
    walk(plain, folder, [*kept, *words], resumed=True)


def _structured(folder: Path, saved: Mapping[str, Any]) -> Any:
    """The settings of a run, checked: all that this version has, and no others."""
    try:
        settings = OmegaConf.merge(Config, saved)
        new = identity.differing(OmegaConf.to_container(settings), saved)
        why = ", ".join(new[:4])
    except OmegaConfBaseException as error:
        why = str(error).partition("\n")[0]
    if why:
        allowed = f"a run with the settings of this version of footopt ({why})"
        raise SettingError("resume", str(folder), allowed, "Start a new run.")
    return settings


def _check_no_less(found: Mapping[str, Any], settings: Mapping[str, Any]) -> None:
    """Raise a `SettingError` for a run that would not replace all that it has found and left before."""
    solver = _solver(settings["solver"])
    setting = "walks" if solver.walks or not solver.n_gen else "n_gen"
    before, most = found.get("designs" if setting == "walks" else "evaluations", 0), solver.designs
    check(
        solver.name == "exhaustive" or most >= before,
        f"solver.{setting}",
        getattr(solver, setting),
        f"enough for the {before} designs that the run has: this is at most {most:,.0f}",
        "A shorter search is a run of its own: leave out resume.",
    )
    if found:
        report, film = found["settings"]["report"], found["settings"]["study"]["video"]
        old = "files of the run as it was would stay beside the new result"
        less = settings["report"] in REPORTS[: REPORTS.index(report)]
        check(not less, "report", settings["report"], f"{report}, as before: {old}")
        new = settings["study"]["video"]
        check(film in (None, new), "study.video", new, f"{film}, as before: {old}")


def _resume_jobs(
    folder: Path, changes: Sequence[tuple[str, Any]], words: Sequence[str], trusted: bool
) -> int:
    """Go on with every job of a multirun that has no result, or a shorter one than is asked for."""
    from footopt.report import summary

    budget = {name.partition(".")[2]: value for name, value in changes if name in BUDGETS}
    busy = 0
    with locked(folder):
        for job in identity.jobs(folder):
            name, reason = job.relative_to(folder), job / ERROR_FILE
            if reason.is_file() and not (job / identity.FILE).exists():  # refused, before it had settings
                print(f"job {name}: {reason.read_text(encoding='utf-8').strip()}")
                continue
            try:
                found = result_of(job)
                if finished(found) and _asked(found) >= _asked(found, budget):
                    continue
                print(f"job {name}: {' '.join(identity.read(job).words)}", flush=True)
                _resume_run(job, found, changes, words, trusted)
            except Occupied as error:
                busy += not _stands(job)  # one that is finished is no failure below
                print(f"job {name}: {error}")
            except (FootoptError, OmegaConfBaseException, OSError) as error:
                log.error("job %s failed: %s", name, explain(error))
                if not _stands(job):
                    write_text(reason, f"{explain(error)}\n")
        return summary.of_multirun(folder) - busy


def _stands(job: Path) -> bool:
    """Whether a job has a result, whatever became of what was to go beyond it."""
    try:
        return finished(result_of(job))
    except FileError:  # it is damaged
        return False


def _asked(found: Mapping[str, Any] | None, budget: Mapping[str, Any] | None = None) -> float:
    """How many designs a job's search asks for, with another budget; any number for what is no search."""
    return _solver({**found["solver"], **(budget or {})}).designs if found and "solver" in found else math.inf


def _solver(saved: Mapping[str, Any]) -> Solver:
    """A saved solver; one of a plugin, which is not loaded yet, is taken for one that does not grow."""
    known = saved["name"] in (AUTO, *SOLVERS)
    return Solver(**{**saved, "name": saved["name"] if known else "ga"})
