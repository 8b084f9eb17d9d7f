"""A multirun: its jobs are written down before the first begins, and compared after the last."""

from __future__ import annotations

import itertools
import os
import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from hydra import compose
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hydra.experimental.callback import Callback
from omegaconf import DictConfig, OmegaConf, open_dict
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.compose import absolute, resolved, typed
from footopt.cli.job import tidier
from footopt.errors import ERROR_FILE, FootoptError
from footopt.files import identity
from footopt.files.identity import Occupied, locked
from footopt.files.io import write_text


class Summary(Callback):
    """Writes down the jobs of a multirun, and after it a table on the terminal and as summary.csv."""

    failed = 0
    folder = ""  # of the multirun
    held = ExitStack()  # its lock
    tidy: Callable[[], None] = staticmethod(lambda: None)  # after a single run that was refused

    def on_run_start(self, config: DictConfig, **kwargs: Any) -> None:
        """See what is there before Hydra makes a folder: no other one is removed if the run is refused."""
        Summary.tidy = staticmethod(tidier(Path(config.hydra.run.dir)))

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Refuse the folder of another multirun; leave in each job's folder what the job is."""
        folder = Path(config.hydra.sweep.dir)
        try:
            Summary.held.enter_context(locked(folder))
            if os.path.lexists(folder / "multirun.yaml"):  # a link, too: Hydra would write where it leads to
                raise Occupied(
                    f"{folder}: holds a multirun. footopt resume={folder} goes on with it; or choose another "
                    "hydra.sweep.dir."
                )
        except OSError as error:  # Hydra makes a warning of any other exception
            sys.exit(f"footopt: error: {error}")
        Summary.folder = str(folder)
        for place, settings, words in _jobs(config, kwargs["config_name"]):
            (folder / place).mkdir(parents=True, exist_ok=True)
            if isinstance(settings, FootoptError):
                write_text(folder / place / ERROR_FILE, f"{settings}\n")
            else:
                identity.write(folder / place, settings, words)

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Read what the jobs left in their folders."""
        from footopt.report import summary

        Summary.failed = summary.of_multirun(Path(config.hydra.sweep.dir))

    @classmethod
    def lost(cls, error: Exception) -> str:
        """What a user is told when a launcher has lost a job."""
        return (
            f"a job of this multirun was lost ({str(error).partition(chr(10))[0]}). Others may still run. "
            f"`footopt resume={shlex.quote(cls.folder)}` finishes the jobs without a result."
        )


def _jobs(config: DictConfig, name: str) -> Iterator[tuple[str, dict[str, Any] | FootoptError, list[str]]]:
    """Place, settings or what is wrong, and words of every job; none for a sweeper that goes by results."""
    if not config.hydra.sweeper._target_.endswith(".BasicSweeper"):
        return
    own = [f"{name}={value}" for name, value in (config.hydra.sweeper.params or {}).items()]
    try:
        values = [
            [f"{word.get_key_element()}={value}" for value in word.sweep_string_iterator()]
            if word.is_sweep_override()
            else [str(word.input_line)]
            for word in OverridesParser.create().parse_overrides([*own, *typed(config.hydra)])
        ]
        for number, words in enumerate(map(list, itertools.product(*values))):
            settings = compose(name, [*typed(config.hydra, "hydra"), *words], return_hydra_config=True)
            with open_dict(settings):
                settings.hydra.job.num, settings.hydra.job.id = number, str(number)
                place = str(OmegaConf.select(settings, "hydra.sweep.subdir"))
                del settings["hydra"]
            try:
                yield place, absolute(resolved(settings, words, name)), words
            except FootoptError as error:
                yield place, error, words
    except (HydraException, OmegaConfBaseException):  # the sweeper says so
        return
