"""The command `footopt`: Hydra composes the settings, a study is run with them, errors become one message."""

from __future__ import annotations

import logging
import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.compose import CONF, help_text, read, resolved, typed
from footopt.cli.job import STOPPED, walk
from footopt.cli.messages import explain
from footopt.cli.resume import resume
from footopt.cli.sweep import Summary
from footopt.errors import ERROR_FILE, FootoptError
from footopt.files.identity import Occupied
from footopt.files.io import write_text
from footopt.studies.runs import result_of

log = logging.getLogger("footopt")

LAUNCHERS = ("submitit", "joblib")  # what their errors come from

_wants_traceback = os.environ.get("HYDRA_FULL_ERROR") == "1"


def main() -> None:
    """Entry point. Errors that a user can mend end with one message and exit code 1."""
    os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra passes errors on instead of printing them itself
    given = sys.argv[1:]
    try:
        if any(word.startswith("resume=") for word in given):
            Summary.failed = resume(given)
        elif text := help_text(given):
            print(text, flush=True)
        else:
            # flags first: what parses them takes no settings on both sides of one
            sys.argv[1:] = sorted(read(given), key=lambda word: word not in ("-m", "--multirun"))
            _job()
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    except BrokenPipeError:  # `footopt --help | head` has seen enough, and Python must not write the rest
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(141)
    except Exception as error:
        if _wants_traceback:
            raise
        lost = Summary.folder and type(error).__module__.partition(".")[0] in LAUNCHERS
        sys.exit(f"footopt: error: {Summary.lost(error) if lost else explain(error, given)}")
    finally:
        Summary.held.close()
    if Summary.failed:
        sys.exit(f"footopt: error: {Summary.failed} of the jobs failed; see the table above.")


@hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")
def _job(settings: DictConfig) -> Any:
    """One job: a single run, or one of a multirun; its objectives go to Hydra's sweepers and callbacks."""
    here = HydraConfig.get()
    folder, words = Path(here.runtime.output_dir), typed(here)
    alone = here.mode != RunMode.MULTIRUN
    try:
        told = walk(resolved(settings, words, str(here.job.config_name)), folder, words)
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    except (FootoptError, OmegaConfBaseException, OSError, MemoryError) as error:
        if alone and _wants_traceback:
            raise
        said, own = explain(error, words), not isinstance(error, Occupied)  # the folder is another's then
        if alone:
            if own:
                Summary.tidy()
            sys.exit(f"footopt: error: {said}")
        # the other jobs go on; `Summary` reports this one at the end
        log.error("job %s failed: %s", here.job.num, said)
        if own:
            write_text(folder / ERROR_FILE, f"{said}\n")
        with suppress(FootoptError):  # an objective that is not known
            from footopt.studies.base import answer

            return answer(settings.objective.names, {})
        return None
    result = result_of(folder) if alone and settings.study.name == "simulate" else None
    if result and not result["feasible"]:
        sys.exit(f"footopt: error: the walk failed: {result['reason']}. {folder} has all about it.")
    return told
