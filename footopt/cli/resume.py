"""`footopt resume=FOLDER`: go on with a run, or with all jobs of a multirun."""

from __future__ import annotations

import logging
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.compose import read
from footopt.cli.job import walk
from footopt.cli.messages import explain
from footopt.errors import ERROR_FILE, FootoptError, SettingError, check
from footopt.files import identity
from footopt.files.identity import Occupied, locked
from footopt.files.io import write_text
from footopt.studies.runs import CHANGEABLE, check_same, finished, may_change, result_of
from footopt.studies.settings import REPORTS, SEARCHES, Config

TRUST, FORCE = "--trust", "--force"
#: Settings by which a folder could have code run that nobody asked for, and files that a run writes.
CODE, WRITTEN = ("plugins", "engine.address"), ("study.store", "study.video")
BUDGETS = ("solver.walks", "solver.n_gen")  # may make a search longer

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
    name = next(word.removeprefix("resume=") for word in given if word.startswith("resume="))
    check(name != "", "resume", name, "the folder of a run")
    folder, trusted = Path(name).expanduser().absolute(), TRUST in given
    words = [word for word in given if not word.startswith("resume=") and word not in (TRUST, FORCE)]
    words += ["study.reuse=true"] * (FORCE in given)
    changes = dict(map(_change, read(words)))
    logging.basicConfig(level=logging.WARNING, stream=sys.stdout, format="[%(levelname)s] %(message)s")
    if not (folder / "multirun.yaml").is_file():
        _resume_run(folder, changes, words, trusted)
        return 0

    from footopt.report import summary

    with locked(folder):
        for job in identity.jobs(folder):
            _resume_job(job, changes, words, trusted)
        return summary.of_multirun(folder)


def _change(word: str) -> tuple[str, Any]:
    """A setting that a run may change, and its value."""
    name, equals, _ = word.partition("=")
    if not equals or not may_change(name):
        allowed = f"a setting that does not make another run ({', '.join(CHANGEABLE)})"
        raise SettingError("resume", word, allowed, "For anything else start a new run, without resume.")
    parsed = OverridesParser.create().parse_override(word)
    check(not parsed.is_sweep_override(), "resume", word, "one value", "A run goes on with one.")
    return name, parsed.value()


def _resume_job(job: Path, changes: Mapping[str, Any], words: Sequence[str], trusted: bool) -> None:
    """Go on with a job of a multirun, unless it has a result and no longer search is asked for."""
    reason, found = job / ERROR_FILE, result_of(job)
    longer = found and found["study"] in SEARCHES and {*changes} & {*BUDGETS}
    if finished(found) and not longer:
        return
    if reason.is_file() and not (job / identity.FILE).exists():  # refused, before it had settings
        print(f"job {job.name}: {reason.read_text(encoding='utf-8').strip()}")
        return
    try:
        print(f"job {job.name}: {' '.join(identity.read(job).words)}", flush=True)
        _resume_run(job, changes, words, trusted)
    except Occupied as error:
        print(f"job {job.name}: {error}")
    except (FootoptError, OmegaConfBaseException, OSError) as error:
        log.error("job %s failed: %s", job.name, explain(error))
        if not finished(found):
            write_text(reason, f"{explain(error)}\n")


def _resume_run(folder: Path, changes: Mapping[str, Any], words: Sequence[str], trusted: bool) -> None:
    """Go on with one run."""
    run, found = identity.read(folder), result_of(folder)
    if run.version != version("footopt") and not changes.get("study.reuse"):
        allowed = f"a run of footopt {version('footopt')}, which this is, not of {run.version}"
        hint = f"Start a new run; or add {FORCE}, if you know that the walks are the same."
        raise SettingError("resume", str(folder), allowed, hint)
    settings = OmegaConf.merge(Config, run.settings)
    study = settings.study.name
    if finished(found) and study not in SEARCHES:
        raise SettingError("resume", str(folder), f"a run of study={', '.join(SEARCHES)}, not {study}")
    check_same(folder, run.settings, found)
    for name in () if trusted else (*CODE, *WRITTEN):
        value, own = OmegaConf.select(settings, name), {name, name.partition(".")[0]} & {*changes}
        inside = name in WRITTEN and (folder / str(value)).resolve().parent == folder.resolve()
        hint = f"Add {TRUST} if you know it, or give your own."
        check(not value or own or inside, name, value, f"trusted: it comes from {folder}", hint)
    for name, value in changes.items():
        if name == "engine":  # begins anew, without engine.timeout
            OmegaConf.update(settings, name, OmegaConf.structured(Config).engine, merge=False)
        OmegaConf.update(settings, "engine.name" if name == "engine" else name, value, merge=False)
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    if found and finished(found):
        _check_no_less(found["settings"], plain)
    groups = tuple(f"{name}." for name in changes)
    kept = [word for word in run.words if not f"{word.partition('=')[0]}.".startswith(groups)]
    walk(plain, folder, [*kept, *words], resumed=True)


def _check_no_less(before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Raise a `SettingError` for a run that would not replace all that it has found and left before."""
    for name in BUDGETS:
        _, _, last = name.partition(".")
        old, new = before["solver"][last], after["solver"][last]
        hint = "A shorter search is a run of its own: leave out resume."
        check(new is None or old is None or new >= old, name, new, f"at least {old}, as before", hint)
    old, new = before["report"], after["report"]
    check(REPORTS.index(new) >= REPORTS.index(old), "report", new, f"{old} or more, as before")
