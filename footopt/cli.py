"""The command line: Hydra composes the settings, this module checks them and runs one study."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from hydra.errors import HydraException
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt.config import Config
from footopt.errors import FileError, FootoptError, SettingError

log = logging.getLogger("footopt")

PACKAGE = Path(__file__).parent
#: conf/ inside the installed package, or at the top of a checkout.
CONF = PACKAGE / "conf" if (PACKAGE / "conf").is_dir() else PACKAGE.parent / "conf"

#: What a resumed run cannot change.
FIXED = ("study", "study.name", "hydra.run.dir", "hydra.mode", "hydra.sweep.dir")

_wants_traceback = os.environ.get("HYDRA_FULL_ERROR") == "1"

ERROR_FILE = "error.txt"  # left in the folder of a job of a multirun that failed
STOPPED = 130  # exit code after Ctrl-C, as of any program that a shell stops

ConfigStore.instance().store(name="footopt_schema", node=Config)


@hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")
def _job(settings: DictConfig) -> None:
    """One job: a single run, or one of a multirun."""
    from footopt import studies

    here = HydraConfig.get()
    folder = Path(here.runtime.output_dir)
    try:
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that is resumed
        config: Any = OmegaConf.to_object(settings)
        plain: Any = OmegaConf.to_container(settings, resolve=True)
        studies.run(config, folder, plain)
    except KeyboardInterrupt as stop:
        words = " ".join(["footopt: stopped", *map(str, stop.args)])
        again = f"; go on with: footopt resume={folder}" if settings.study.name in studies.RESUMABLE else ""
        print(words + again, file=sys.stderr)
        sys.exit(STOPPED)
    except (FootoptError, OmegaConfBaseException, OSError) as error:
        if here.mode != RunMode.MULTIRUN:
            Resume.undo()
            if _wants_traceback:
                raise
            sys.exit(f"footopt: error: {explain(error)}")
        # the other jobs go on; `Summary` reports this one at the end
        log.error("job %s failed: %s", here.job.num, explain(error))
        (folder / ERROR_FILE).write_text(f"{explain(error)}\n", encoding="utf-8")


class Resume:
    """`footopt resume=FOLDER ...`: the run that left the folder again, with what else is given.

    The search itself does the rest: what its store holds is not walked again.
    """

    before: dict[Path, bytes] = {}  # noqa: RUF012  what Hydra overwrites

    @staticmethod
    def arguments(given: Sequence[str]) -> list[str]:
        """The arguments without ``resume=``: those of the run in the folder, then the new ones."""
        from footopt.studies import RESUMABLE

        folders = [word.removeprefix("resume=") for word in given if word.startswith("resume=")]
        if not folders:
            return list(given)
        new = [word for word in given if not word.startswith("resume=")]
        folder = Path(folders[-1].strip("'\"")).absolute()
        if (folder / "multirun.yaml").is_file():
            jobs = sorted((p.name for p in folder.iterdir() if (p / ".hydra").is_dir()), key=int)
            left = [job for job in jobs if not (folder / job / "result.json").is_file()]
            raise SettingError(
                "resume",
                folders[-1],
                "the folder of one job of this multirun",
                f"Jobs without a result: {', '.join(left) or 'none'} (of {', '.join(jobs)}).",
            )
        for word in new:
            if word in ("-m", "--multirun") or word.partition("=")[0] in FIXED:
                raise SettingError("resume", folders[-1], f"given without {word}", "It goes on as it began.")
        try:
            files = {name: folder / ".hydra" / f"{name}.yaml" for name in ("overrides", "hydra", "config")}
            study = OmegaConf.load(files["config"]).study.name
            Resume.before = {path: path.read_bytes() for path in files.values()}
            # Hydra truncates its files before it writes them: one that was killed then is empty
            saved: Any = OmegaConf.to_container(OmegaConf.load(files["overrides"])) or OmegaConf.to_container(
                OmegaConf.load(files["hydra"]).hydra.overrides.task
            )
        except Exception as error:  # whatever can be wrong with a folder or its files
            raise FileError(
                f"resume = {folders[-1]!r}: not the folder of a run ({str(error).splitlines()[0]}). "
                "Give one with a .hydra folder in it, such as outputs/optimize/2026-01-31_12-00-00-000000."
            ) from None
        if study not in RESUMABLE:
            raise SettingError("resume", folders[-1], f"a run of study={', '.join(RESUMABLE)}, not {study}")
        place = str(folder).replace("'", "\\'").replace("${", "\\${")
        return [*saved, *new, f"hydra.run.dir='{place}'"]

    @staticmethod
    def undo() -> None:
        """Put back the settings of a run that could not go on with the new ones."""
        for path, text in Resume.before.items():
            path.write_bytes(text)


class Summary(Callback):
    """After a multirun: a table over all its jobs, on the terminal and as summary.csv."""

    failed = 0

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Read what the jobs left in their folders."""
        from footopt.report import summary

        Summary.failed = summary.report(Path(config.hydra.sweep.dir), ERROR_FILE)


def main() -> None:
    """Entry point. Errors a user can mend end with one message and exit code 1."""
    os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra passes errors on instead of printing them itself
    try:
        sys.argv[1:] = Resume.arguments(sys.argv[1:])
        _job()
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    except Exception as error:
        if _wants_traceback:
            raise
        sys.exit(f"footopt: error: {explain(error)}")
    if Summary.failed:
        sys.exit(f"footopt: error: {Summary.failed} of the jobs failed; see the table above.")


def explain(error: BaseException) -> str:
    """An error in the user's terms."""
    if isinstance(error, FootoptError):
        return str(error)
    if isinstance(error, OmegaConfBaseException):
        key = f"{error.full_key}: " if error.full_key else ""
        return f"{key}{str(error).splitlines()[0]}"
    if isinstance(error, HydraException):
        lines = [str(error).partition("\nConfig search path:")[0].strip()]
        cause = error.__cause__
        if cause is not None and str(cause).splitlines():
            lines.append(str(cause).splitlines()[0])
        return "\n  ".join(lines)
    if isinstance(error, OSError):
        return f"{error.strerror or error}: {error.filename or ''}".rstrip(": ")
    return (
        f"unexpected {type(error).__name__}: {error}\n"
        "This is a bug in footopt; HYDRA_FULL_ERROR=1 shows where."
    )
