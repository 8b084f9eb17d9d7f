"""A multirun: its jobs are written down before the first begins, and compared after the last."""

from __future__ import annotations

import copy
import os
import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from hydra._internal.config_loader_impl import get_overrides_dirname
from hydra._internal.core_plugins.basic_launcher import BasicLauncher
from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra.core.global_hydra import GlobalHydra
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hydra.experimental.callback import Callback
from omegaconf import DictConfig, OmegaConf, open_dict
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.job import resolved, tidier
from footopt.cli.paths import absolute, typed
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
        for place, settings, words in _jobs(config):
            path = folder / place
            path.mkdir(parents=True, exist_ok=True)
            if isinstance(settings, FootoptError):
                write_text(path / ERROR_FILE, f"{settings}\n")
            else:
                identity.write(path, settings, words)

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Read what the jobs left in their folders."""
        from footopt.report import summary

        Summary.failed = summary.of_multirun(Path(config.hydra.sweep.dir))

    @classmethod
    def close(cls) -> None:
        """Let go of the folder."""
        cls.held.close()

    @classmethod
    def lost(cls, error: Exception) -> str:
        """What a user is told when a launcher has lost a job."""
        return (
            f"a job of this multirun was lost ({str(error).partition(chr(10))[0]}). Others may still run. "
            f"`footopt resume={shlex.quote(cls.folder)}` finishes the jobs without a result."
        )


class Composer:
    """Composes jobs as Hydra's loader does, which takes 0.15 s: once for each combination of choices.

    What only sets values is set in a copy of what the choices have composed.

    Parameters
    ----------
    loader : ConfigLoader
        Hydra's.
    """

    def __init__(self, loader: Any) -> None:
        self.loader, self.compose = loader, loader.load_sweep_config
        self.known: dict[tuple[str, ...], DictConfig] = {}

    def __call__(self, master_config: DictConfig, sweep_overrides: list[str]) -> DictConfig:
        words = OverridesParser.create(config_loader=self.loader).parse_overrides(sweep_overrides)
        values = [w for w in words if "." in w.key_or_group and not w.is_hydra_override()]
        choices = tuple(str(w.input_line) for w in words if w not in values)
        if choices not in self.known:
            self.known[choices] = self.compose(master_config, list(choices))
        settings = copy.deepcopy(self.known[choices])
        self.loader._apply_overrides_to_config(values, settings)
        own, job = [w for w in words if not w.is_hydra_override()], settings.hydra.job
        with open_dict(settings):
            settings.hydra.overrides.task = [w.input_line for w in own]
            job.override_dirname = get_overrides_dirname(own, **job.config.override_dirname)
        return settings


def _jobs(config: DictConfig) -> Iterator[tuple[str, dict[str, Any] | FootoptError, list[str]]]:
    """Place, settings or what is wrong, and words of every job; none for a sweeper that goes by results."""
    if not config.hydra.sweeper._target_.endswith(f".{BasicSweeper.__name__}"):
        return
    loader: Any = GlobalHydra.instance().config_loader()
    composer = Composer(loader)
    if config.hydra.launcher._target_.endswith(f".{BasicLauncher.__name__}"):  # others send the loader away
        loader.load_sweep_config = composer
    own = [f"{name}={value}" for name, value in (config.hydra.sweeper.params or {}).items()]
    before = HydraConfig.instance().cfg
    try:
        words = OverridesParser.create(config_loader=loader).parse_overrides([*own, *typed(config.hydra)])
        for number, job in enumerate(BasicSweeper.split_arguments(words, None)[0]):
            settings = composer(config, list(job))
            with open_dict(settings):
                settings.hydra.job.num, settings.hydra.job.id = number, str(number)
                HydraConfig.instance().set_config(settings)
                here, place = settings.hydra, str(OmegaConf.select(settings, "hydra.sweep.subdir"))
                del settings["hydra"]
            try:
                yield place, absolute(resolved(settings, here)), list(job)
            except FootoptError as error:
                yield place, error, list(job)
    except (HydraException, OmegaConfBaseException):  # the sweeper says so
        return
    finally:
        HydraConfig.instance().cfg = before
