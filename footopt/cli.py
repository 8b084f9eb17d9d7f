"""The command line: Hydra composes the settings, this module checks them and runs one study."""

from __future__ import annotations

import logging
import os
import sys
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
from footopt.errors import FootoptError

log = logging.getLogger("footopt")

PACKAGE = Path(__file__).parent
#: conf/ inside the installed package, or at the top of a checkout.
CONF = PACKAGE / "conf" if (PACKAGE / "conf").is_dir() else PACKAGE.parent / "conf"

_wants_traceback = os.environ.get("HYDRA_FULL_ERROR") == "1"

ERROR_FILE = "error.txt"  # left in the folder of a job of a multirun that failed

ConfigStore.instance().store(name="footopt_schema", node=Config)


@hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")
def _job(settings: DictConfig) -> None:
    """One job: a single run, or one of a multirun."""
    from footopt import studies

    here = HydraConfig.get()
    folder = Path(here.runtime.output_dir)
    try:
        config: Any = OmegaConf.to_object(settings)
        plain: Any = OmegaConf.to_container(settings, resolve=True)
        studies.run(config, folder, plain)
    except (FootoptError, OmegaConfBaseException, OSError) as error:
        if here.mode != RunMode.MULTIRUN:
            if _wants_traceback:
                raise
            sys.exit(f"footopt: error: {explain(error)}")
        # the other jobs go on; `Summary` reports this one at the end
        log.error("job %s failed: %s", here.job.num, explain(error))
        (folder / ERROR_FILE).write_text(f"{explain(error)}\n", encoding="utf-8")


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
        _job()
    except KeyboardInterrupt:
        sys.exit(130)
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
