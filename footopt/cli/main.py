"""The command `footopt`: Hydra composes the settings, a study is run with them, errors become one message."""

import logging
import math
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import hydra
from hydra import compose
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from hydra.utils import get_class
from omegaconf import DictConfig, OmegaConf, open_dict
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.compose import CONF, groups, hydra_overrides, register, resolved, task_overrides
from footopt.cli.messages import explain
from footopt.cli.run import execute, remove_empty_run, resume
from footopt.errors import ERROR_FILE, FootoptError
from footopt.files import identity
from footopt.files.identity import Occupied, result_of
from footopt.files.io import write_text
from footopt.studies import text
from footopt.studies.build import GROUPS, absolute
from footopt.walk.objectives import lookup

STOPPED = 130  # exit code after Ctrl-C, as of any program that a shell stops

_wants_traceback = os.environ.get("HYDRA_FULL_ERROR") == "1"


def main() -> None:
    """Entry point. Errors that a user can mend end with one message and exit code 1."""
    os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra passes errors on instead of printing them itself
    given = sys.argv[1:]
    topics = [one for one in given if one not in ("-h", "--help")]
    try:
        if any(one.startswith("resume=") for one in given):
            Multirun.failed = resume(given)
        elif topics and len(topics) < len(given) and {*topics} <= {*groups(), *GROUPS}:
            print(text(topics), flush=True)
        else:
            words = hydra_overrides(given)
            register(words)
            # flags first: what parses them takes no settings on both sides of one
            sys.argv[1:] = sorted(words, key=lambda one: one not in ("-m", "--multirun"))
            _job()
    except KeyboardInterrupt:
        sys.exit(STOPPED)
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
        found = execute(resolved(settings, overrides, str(here.job.config_name)), folder, overrides)
    except (FootoptError, OmegaConfBaseException, OSError, MemoryError) as error:
        if alone and _wants_traceback:
            raise
        message = explain(error, overrides)
        if alone:
            remove_empty_run(folder, task_overrides(here, "hydra"))
            sys.exit(f"footopt: error: {message}")
        logging.getLogger("footopt").error("job %s failed: %s", here.job.num, message)  # the other jobs go on
        if not isinstance(error, Occupied):  # the folder is another's then
            write_text(folder / ERROR_FILE, f"{message}\n")
        found = dict[str, float]()
    if alone and (result := result_of(folder)) and not result.get("feasible", True):
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
        with suppress(HydraException, OmegaConfBaseException):  # the sweeper, or the job, says so
            for name, settings, overrides in _jobs(config, begin):
                (folder / name).mkdir(parents=True, exist_ok=True)
                with suppress(FootoptError):
                    identity.write(folder / name, absolute(resolved(settings, overrides, begin)), overrides)

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Read what the jobs left in their folders."""
        from footopt.report import summary  # pandas and matplotlib take a second

        folder = Path(config.hydra.sweep.dir)
        Multirun.failed = summary.compare(folder, identity.jobs(folder))


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
