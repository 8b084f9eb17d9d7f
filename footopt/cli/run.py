"""One run from its settings to its end: `execute`, `resume`, and from Python `run`."""

import logging
import os
import shlex
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.compose import CONF, groups, hydra_overrides, register, resolved
from footopt.cli.messages import explain, translate
from footopt.errors import ERROR_FILE, EngineError, FootoptError, check
from footopt.files import identity
from footopt.files.identity import Occupied, finished, result_of
from footopt.files.io import write_text
from footopt.studies import searches, within
from footopt.studies.build import absolute, check_trusted, load_plugins
from footopt.studies.runs import BUDGETS, Run, check_may_change, check_resumable, load, run_study
from footopt.studies.settings import CODE, WRITTEN, structured

TRUST, FORCE = "--trust", "--force"


def execute(settings: Mapping[str, Any], folder: Path, given: Sequence[str], resumed: bool = False) -> Any:
    """Run the study of some resolved settings in a folder: see `footopt.studies.run_study`.

    A run that is stopped, or loses its workers, says how to go on.
    """
    hint = f"; go on with: footopt resume={shlex.quote(str(folder))}"
    try:
        config: Any = OmegaConf.to_object(structured(settings))  # refuses what + has added
        return run_study(config, folder, absolute(settings), given, resumed)
    except EngineError as error:
        raise FootoptError(f"{error} All finished generations are in the store{hint}") from None
    except KeyboardInterrupt as stop:
        print(" ".join(["footopt: stopped", *map(str, stop.args)]) + hint, file=sys.stderr)
        raise


def remove_empty_run(folder: Path, overrides: Sequence[str]) -> None:
    """Remove the folder of a refused run, and those above it if they are empty, unless it was chosen."""
    if not any(one.startswith("hydra.run.dir") for one in overrides):
        with suppress(OSError):
            os.removedirs(os.path.relpath(folder))


def run(overrides: Sequence[str] = (), folder: str | Path | None = None) -> Run:
    """Run ``footopt OVERRIDES`` in this process.

    Parameters
    ----------
    overrides : sequence of str
        Settings as on the command line, such as ``["sand=soft", "solver=nsga2"]``; with ``resume=FOLDER``
        that run goes on.
    folder : str or Path, optional
        Where a new run leaves what it finds; by default as on the command line, below outputs/.

    Returns
    -------
    Run
        As `load` returns it.

    Raises
    ------
    FootoptError
        What the command line ends with: it names the setting and says what is allowed.
    """
    check(not isinstance(overrides, str), "overrides", overrides, f"a list, such as [{overrides!r}]")
    given = [str(one) for one in overrides]
    if resumed := [one.partition("=")[2] for one in given if one.startswith("resume=")]:
        check(folder is None, "folder", folder, "left out with resume=FOLDER, where the run goes on")
        resume(given)
        return load(resumed[-1])
    there: Path | None = None
    try:
        register(hydra_overrides(given))
        with initialize_config_dir(str(CONF), version_base="1.3"):
            settings = compose("config", hydra_overrides(given), return_hydra_config=True)
            there = Path(folder or settings.hydra.run.dir).expanduser().absolute()
            plain = resolved(settings, given)
        own = [one for one in hydra_overrides(given) if not one.startswith("hydra.")]
        execute(plain, there, own)
    except Exception as error:
        if there and not folder:
            remove_empty_run(there, given)
        raise translate(error, given) or error from None
    return load(there, trust=True)


def resume(given: Sequence[str]) -> int:
    """Go on with the run, or the multirun, that resume=FOLDER names; how many jobs of a multirun failed.

    A folder is read as data: code and files elsewhere that it names need --trust, a run of another version
    needs --force, and settings given besides are `CHANGEABLE`. Designs in its store are not walked again.
    """
    name = next(one for one in given if one.startswith("resume=")).removeprefix("resume=")
    check(name, "resume", name, "the folder of a run")
    folder = Path(name).expanduser().absolute()
    logging.basicConfig(level=logging.WARNING, stream=sys.stdout, format="[%(levelname)s] %(message)s")
    changes = _changes(given)
    if not (folder / "multirun.yaml").is_file():
        _resume_run(folder, changes, given)
        return 0
    from footopt.report import summary  # pandas and matplotlib take a second

    jobs = identity.jobs(folder)
    for job in jobs:
        if (job / identity.FILE).exists():  # not refused before it had settings
            _resume_job(job, changes, given)
    return summary.compare(folder, jobs)


def _changes(given: Sequence[str]) -> dict[str, Any]:
    """The settings that a run may change, and their values."""
    overrides = hydra_overrides([one for one in given if not one.startswith(("resume=", TRUST, FORCE))])
    for one in overrides:
        check_may_change(one)
    changes = OverridesParser.create().parse_overrides(overrides)
    for change in changes:
        check(not change.is_sweep_override(), "resume", change.input_line, "one value")
    values = {change.get_key_element(): change.value() for change in changes}
    return {f"{name}.name" if name in groups() else name: value for name, value in values.items()}


def _resume_job(job: Path, changes: Mapping[str, Any], given: Sequence[str]) -> None:
    """Go on with a job of a multirun, unless it has a result and no longer search is asked for."""
    found = result_of(job)
    longer = {*changes} & {f"solver.{name}" for name in BUDGETS}
    if found and finished(found) and not (longer and searches(found["study"])):
        return
    try:
        print(f"job {job.name}: {' '.join(identity.read(job).overrides)}", flush=True)
        _resume_run(job, changes, given)
    except Occupied as error:
        print(f"job {job.name}: {error}")
    except (FootoptError, OmegaConfBaseException, OSError) as error:
        logging.getLogger("footopt").error("job %s failed: %s", job.name, explain(error))
        if not finished(found):
            write_text(job / ERROR_FILE, f"{explain(error)}\n")


def _resume_run(folder: Path, changes: Mapping[str, Any], given: Sequence[str]) -> None:
    """Go on with one run."""
    run = identity.read(folder)
    allowed = f"a run of footopt {version('footopt')}, which this is, not of {run.version}"
    hint = f"Start a new run; or add {FORCE}, if you know that the walks are the same."
    check(run.version == version("footopt") or FORCE in given, "resume", str(folder), allowed, hint)
    check_trusted(folder, run.settings, () if TRUST in given else (*CODE, *WRITTEN), changes)
    load_plugins(changes.get("plugins", run.settings["plugins"]))
    settings = structured(run.settings)
    if FORCE in given and searches(run.settings["study"]["name"]):
        settings.study.reuse = True
    for name, value in changes.items():
        OmegaConf.update(settings, name, value, merge=False)
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    check_resumable(folder, run.settings, plain)
    overrides = [one for one in given if "=" in one and not one.startswith("resume=")]
    replaced = [one.partition("=")[0] for one in overrides]
    kept = [one for one in run.overrides if not within(one.partition("=")[0], replaced)]
    execute(plain, folder, [*kept, *overrides], resumed=True)
