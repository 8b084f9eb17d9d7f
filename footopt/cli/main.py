"""The command `footopt`: Hydra composes the settings, a study is run with them, errors become one message."""

from __future__ import annotations

import logging
import os
import shlex
import shutil
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt import __version__, studies
from footopt.cli.compose import CONF, help_text
from footopt.cli.messages import explain
from footopt.cli.resume import resumed, settings_kept
from footopt.cli.words import check_dashes, readable
from footopt.errors import ERROR_FILE, FootoptError
from footopt.files.run import write_text
from footopt.studies.settings import Config

log = logging.getLogger("footopt")

STOPPED = 130  # exit code after Ctrl-C, as of any program that a shell stops
LAUNCHERS = ("submitit", "joblib")  # what their errors come from

_wants_traceback = os.environ.get("HYDRA_FULL_ERROR") == "1"


def main() -> None:
    """Entry point. Errors that a user can mend end with one message and exit code 1."""
    os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra passes errors on instead of printing them itself
    given = sys.argv[1:]
    if "--version" in given:
        return print(f"footopt {__version__}")
    try:
        check_dashes(given)
        sys.argv[1:] = given = [readable(word) for word in resumed(given)]
        if text := help_text(given):
            return print(text)
        _job()
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    except Exception as error:
        if _wants_traceback:
            raise
        lost = Summary.folder and type(error).__module__.partition(".")[0] in LAUNCHERS
        sys.exit(f"footopt: error: {Summary.lost(error) if lost else explain(error, given)}")
    if Summary.failed:
        sys.exit(f"footopt: error: {Summary.failed} of the jobs failed; see the table above.")


@hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")
def _job(settings: DictConfig) -> Any:
    """One job: a single run, or one of a multirun; its objectives go to Hydra's sweepers and callbacks."""
    here = HydraConfig.get()
    folder = Path(here.runtime.output_dir)
    resume = f"footopt resume={shlex.quote(str(folder))}"
    hint = f"; go on with: {resume}" if settings.study.name in studies.RESUMABLE else ""
    try:
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that is resumed
        plain: Any = OmegaConf.to_container(settings, resolve=True)
        config: Any = OmegaConf.to_object(OmegaConf.merge(Config, plain))  # refuses what + has added
        with settings_kept(settings, folder), one_ctrl_c(f"footopt: stopped{hint}"):
            return studies.run(config, folder, plain)
    except KeyboardInterrupt as stop:
        print(" ".join(["footopt: stopped", *map(str, stop.args)]) + hint, file=sys.stderr)
        sys.exit(STOPPED)
    except (FootoptError, OmegaConfBaseException, OSError) as error:
        if here.mode != RunMode.MULTIRUN:
            if _wants_traceback:
                raise
            tidied(folder)
            sys.exit(f"footopt: error: {explain(error)}")
        # the other jobs go on; `Summary` reports this one at the end
        log.error("job %s failed: %s", here.job.num, explain(error))
        write_text(folder / ERROR_FILE, f"{explain(error)}\n")
        with suppress(FootoptError):  # an objective that is not known
            from footopt.studies.record import answer

            return answer(settings.objective.names, {})
    return None


class Summary(Callback):
    """After a multirun: a table over all its jobs, on the terminal and as summary.csv."""

    failed = 0
    folder = ""  # of the multirun

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Remember where the jobs leave what they find."""
        Summary.folder = config.hydra.sweep.dir

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Read what the jobs left in their folders."""
        from footopt.report import summary

        Summary.failed = summary.of_multirun(Path(config.hydra.sweep.dir))

    @classmethod
    def lost(cls, error: Exception) -> str:
        """What a user is told when a launcher has lost a job."""
        folder = shlex.quote(cls.folder)
        return (
            f"a job of this multirun was lost ({str(error).partition(chr(10))[0]}). Others may still run. "
            f"`footopt resume={folder}` lists the jobs without a result, `footopt resume={folder}/NUMBER` "
            "goes on with one."
        )


def tidied(folder: Path) -> None:
    """Remove the folder of a run that was refused, if it holds nothing but what Hydra wrote before it."""
    left = [path for path in folder.rglob("*") if path.is_file()]
    logs = [path for path in left if path.suffix == ".log"]
    own = {folder / ".hydra" / f"{name}.yaml" for name in ("config", "hydra", "overrides")}
    if folder != Path.cwd() and own == {*left} - {*logs} and not any(path.stat().st_size for path in logs):
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def one_ctrl_c(last_words: str) -> Iterator[None]:
    """The first Ctrl-C ends a search with its report; the second ends the process, wherever it is.

    A second `KeyboardInterrupt` would break into what cleans up after the first, and could be lost or
    leave a lock behind. All that is known is in the store by then, and workers end with their parent.
    """
    heard = False

    def handle(signum: int, frame: FrameType | None) -> None:
        nonlocal heard
        if heard:
            os.write(2, f"{last_words}\n".encode())
            os._exit(STOPPED)
        heard = True
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():  # a launcher's: signals are not for it
        yield
        return
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # not where whoever started this wants it ignored
        signal.signal(signal.SIGINT, handle)
    try:
        yield
    finally:
        if not heard and before is signal.default_int_handler:
            signal.signal(signal.SIGINT, before)
