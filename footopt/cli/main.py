"""The command `footopt`, and `fo.run`: Hydra composes settings, a study is run, errors become one message."""

import io
import logging
import math
import os
import shlex
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

import hydra
from hydra import compose, initialize_config_dir
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from hydra.utils import get_class
from omegaconf import DictConfig, OmegaConf, open_dict
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.compose import CONF, groups, hydra_overrides, register, resolved, task_overrides
from footopt.cli.messages import explain, translate
from footopt.errors import ERROR_FILE, EngineError, FootoptError, check
from footopt.files import identity
from footopt.files.io import reload_edited, write_text
from footopt.studies import searches, text, within
from footopt.studies.build import GROUPS, absolute, check_trusted, load_plugins
from footopt.studies.load import Run, load
from footopt.studies.runs import BUDGETS, check_resumable, run_study
from footopt.studies.settings import CHANGEABLE, CODE, WRITTEN, chosen, structured
from footopt.walk.objectives import lookup

TRUST, FORCE = "--trust", "--force"

_composing = threading.Lock()  # Hydra has one configuration at a time
_wants_traceback = os.environ.get("HYDRA_FULL_ERROR") == "1"


def main() -> None:
    """Entry point. Errors that a user can mend end with one message and exit code 1."""
    os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra passes errors on instead of printing them itself
    given = sys.argv[1:]
    for stream in (sys.stdout, sys.stderr):  # of a pipe, perhaps, whose encoding has no cm² or no Łódź
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    topics = [one for one in given if one not in ("-h", "--help")]
    try:
        if any(one.startswith("resume=") for one in given):
            Multirun.failed = resume(given)
        elif topics and len(topics) < len(given) and {*topics} <= {*groups(), *GROUPS}:
            print(text(topics), flush=True)
        else:
            register(words := hydra_overrides(given))
            # flags first: what parses them takes no settings on both sides of one
            sys.argv[1:] = sorted(words, key=lambda one: one not in ("-m", "--multirun"))
            _job()
    except KeyboardInterrupt:
        sys.exit(130)  # as of any program that a shell stops
    except BrokenPipeError:  # `footopt --help | head` has seen enough, and Python must not write the rest
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(141)
    except Exception as error:
        if _wants_traceback:
            raise
        sys.exit(f"footopt: error: {explain(error, given)}")
    if Multirun.failed:
        sys.exit(f"footopt: error: {Multirun.failed} of the jobs failed; see the table above.")


@hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")
def _job(settings: DictConfig) -> Any:
    """One job: a single run, or one of a multirun; its objectives go to Hydra's sweepers and callbacks."""
    here = HydraConfig.get()
    folder, overrides = Path(here.runtime.output_dir), task_overrides(here)
    alone = here.mode != RunMode.MULTIRUN
    try:
        allowed = "false: paths are relative to the folder of the command"
        os.chdir(here.runtime.cwd)
        check(not here.job.chdir, "hydra.job.chdir", True, allowed)
        found = execute(resolved(settings, overrides, str(here.job.config_name)), folder, overrides)
    except (FootoptError, OmegaConfBaseException, OSError, MemoryError) as error:
        if alone and _wants_traceback:
            raise
        message = explain(error, overrides)
        if alone:
            remove_empty_run(folder, task_overrides(here, "hydra"))
            sys.exit(f"footopt: error: {message}")
        logging.getLogger("footopt").error("job %s failed: %s", here.job.num, message)  # the other jobs go on
        if not isinstance(error, identity.Occupied):  # the folder is another's then
            write_text(folder / ERROR_FILE, f"{message}\n")
        found = dict[str, float]()
    if alone and (result := identity.result_of(folder)) and not result.get("feasible", True):
        sys.exit(f"footopt: error: the walk failed: {result['reason']}. {folder} has all about it.")
    if not isinstance(found, Mapping):
        return found
    with suppress(FootoptError):  # an objective that is not known
        # natural signs; without a value, because a walk or the job failed, the worst: a sweeper then goes on
        given = [(found.get(o.name, math.nan), o.worst) for o in lookup(settings.objective.names)]
        values = tuple(value if math.isfinite(value) else worst for value, worst in given)
        return values[0] if len(values) == 1 else values


class Multirun(Callback):
    """Writes down the jobs of a multirun, and after it a table on the terminal and as summary.csv."""

    failed = 0

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Refuse the folder of another multirun; leave in each job's folder what the job is."""
        folder, begin = Path(config.hydra.sweep.dir), kwargs["config_name"]
        if os.path.lexists(folder / "multirun.yaml"):  # a link, too: Hydra would write where it leads to
            hint = f"footopt resume={folder} goes on with it; or choose another hydra.sweep.dir."
            sys.exit(f"footopt: error: {folder}: holds a multirun. {hint}")  # Hydra passes nothing else on
        with suppress(HydraException, OmegaConfBaseException, TypeError, ValueError):  # the job says so
            for name, settings, overrides in _jobs(config, begin):
                (folder / name).mkdir(parents=True, exist_ok=True)
                with suppress(FootoptError):
                    identity.write(folder / name, absolute(resolved(settings, overrides, begin)), overrides)

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Read what the jobs left in their folders."""
        from footopt.report import summary  # pandas and matplotlib take a second

        Multirun.failed = summary.compare(folder := Path(config.hydra.sweep.dir), identity.jobs(folder))


def _jobs(config: DictConfig, name: str) -> Iterator[tuple[str, DictConfig, list[str]]]:
    """Folder, settings and overrides of every job; none for a sweeper that goes by results."""
    split = getattr(get_class(config.hydra.sweeper._target_), "split_arguments", None)
    if split is None:
        return
    own = [f"{name}={value}" for name, value in (config.hydra.sweeper.params or {}).items()]
    parsed = OverridesParser.create().parse_overrides([*own, *task_overrides(config.hydra)])
    (jobs,) = split(parsed, None)  # in batches of any size
    for number, overrides in enumerate(jobs):
        every = [*task_overrides(config.hydra, "hydra"), *overrides]
        settings = compose(name, every, return_hydra_config=True)
        with open_dict(settings):
            settings.hydra.job.num, settings.hydra.job.id = number, str(number)
        yield str(OmegaConf.select(settings, "hydra.sweep.subdir")), settings, overrides


def execute(settings: DictConfig, folder: Path, given: Sequence[str], resumed: bool = False) -> Any:
    """Run the study of structured settings in a folder: see `footopt.studies.run_study`.

    A run that is stopped, or loses its workers, says how to go on.
    """
    hint = f"; go on with: footopt resume={shlex.quote(str(folder))}"
    try:
        config: Any = OmegaConf.to_object(settings)
        return run_study(config, folder, absolute(settings), given, resumed)
    except EngineError as error:
        raise FootoptError(f"{error} All finished generations are in the store{hint}") from None
    except KeyboardInterrupt as stop:
        print(" ".join(["footopt: stopped", *map(str, stop.args)]) + hint, file=sys.stderr)
        raise


def remove_empty_run(folder: Path, overrides: Sequence[str]) -> None:
    """Remove the folder of a refused run, and those above it if they are empty, unless it was chosen."""
    if not any(one.startswith("hydra.run.dir") for one in overrides):
        with suppress(OSError, ValueError):  # not found, not empty, or on another drive of Windows
            os.removedirs(os.path.relpath(folder))


def run(overrides: Sequence[str] = (), folder: str | Path | None = None) -> Run:
    """Run ``footopt OVERRIDES`` in this process.

    Parameters
    ----------
    overrides : sequence of str
        Settings as on the command line, such as ``["sand=soft", "solver=nsga2"]``; with ``resume=FOLDER``
        that run goes on, and ``hydra.searchpath=[FOLDER]`` stands for ``--config-dir FOLDER``.
    folder : str or Path, optional
        Where a new run leaves what it finds; by default as on the command line, below outputs/.

    Returns
    -------
    Run
        As `load` returns it.

    Raises
    ------
    FootoptError
        The message with which the command line ends; it names the setting and says what is allowed.
    """
    check(not isinstance(overrides, str), "overrides", overrides, f"a list, such as [{overrides!r}]")
    given = [str(one) for one in overrides]
    reload_edited()
    if resumed := [one.partition("=")[2] for one in given if one.startswith("resume=")]:
        check(folder is None, "folder", folder, "left out with resume=FOLDER, where the run goes on")
        resume(given)
        return load(resumed[-1].strip("'\""))
    there: Path | None = None
    try:
        with _composing, initialize_config_dir(str(CONF), version_base="1.3"):
            register(words := hydra_overrides(given))
            settings = compose("config", words, return_hydra_config=True)
            there = Path(folder or settings.hydra.run.dir).expanduser().absolute()
            found = resolved(settings, given)
        execute(found, there, [one for one in words if not one.startswith("hydra.")])
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
    names = [one.removeprefix("resume=") for one in given if one.startswith("resume=")]
    name = names[0].strip("'\"")
    check(name and len(names) == 1, "resume", ", ".join(names), "the folder of one run")
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
    allowed = f"a setting that does not make another run ({', '.join(CHANGEABLE)})"
    for one in overrides:
        good = "=" in one and within(one.partition("=")[0], CHANGEABLE)
        check(good, "resume", one, allowed, "For anything else start a new run, without resume.")
    changes = OverridesParser.create().parse_overrides(overrides)
    for change in changes:
        check(not change.is_sweep_override(), "resume", change.input_line, "one value")
    values = {change.get_key_element(): change.value() for change in changes}
    choices = [chosen(name, values.pop(name)) for name in [*values] if name in groups()]
    return {name: value for part in (*choices, values) for name, value in part.items()}


def _resume_job(job: Path, changes: Mapping[str, Any], given: Sequence[str]) -> None:
    """Go on with a job of a multirun, unless it has a result and no more is wanted."""
    found = identity.result_of(job)
    budgets = set() if found and searches(found["study"]) else {f"solver.{name}" for name in BUDGETS}
    if identity.finished(found) and not {*changes} - budgets:
        return
    try:
        print(f"job {job.name}: {' '.join(identity.read(job).overrides)}", flush=True)
        _resume_run(job, changes, given)
    except identity.Occupied as error:
        print(f"job {job.name}: {error}")
    except (FootoptError, OmegaConfBaseException, OSError) as error:
        logging.getLogger("footopt").error("job %s failed: %s", job.name, explain(error))
        if not identity.finished(found):
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
        parent, _, key = name.rpartition(".")
        absent = OmegaConf.select(settings, parent) is None  # choose.weights of a run that had none
        OmegaConf.update(settings, *((parent, {key: value}) if absent else (name, value)), merge=False)
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    check_resumable(folder, run.settings, plain)
    overrides = [one for one in given if "=" in one and not one.startswith("resume=")]
    replaced = [one.partition("=")[0] for one in overrides]
    kept = [one for one in run.overrides if not within(one.partition("=")[0], replaced)]
    execute(settings, folder, [*kept, *overrides], resumed=True)
