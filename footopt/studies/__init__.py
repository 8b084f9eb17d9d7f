"""One module per question; each is a function of the settings and the folder it may write to."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from footopt.errors import SettingError
from footopt.studies.settings import Config

#: Studies by name: each is the function `run` of the module of that name, imported when asked for.
STUDIES = (
    "optimize", "simulate", "accuracy", "stability", "effects", "shapes", "paper", "trust", "robust",
    "sensitivity", "export", "compare", "doctor",
)  # fmt: skip

#: Those that keep what they evaluate, so that `footopt resume=FOLDER` goes on where they stopped.
RESUMABLE = ("optimize", "robust")

#: Those that walk where `engine` says; the others do so in this process.
SPREAD = ("optimize", "robust")


def run(config: Config, folder: Path, settings: dict[str, Any]) -> None:
    """Run the study that the configuration names; `settings` is the configuration as plain data."""
    from footopt.studies.build import check_lists

    check_lists(config)
    name = config.study.name
    if name not in STUDIES:
        raise SettingError("study.name", name, f"one of {', '.join(STUDIES)}")
    if config.engine.name != "local" and name not in SPREAD:
        raise SettingError("engine.name", config.engine.name, f"local for study={name}")
    if config.plugins:
        import_module("footopt.studies.build").load_plugins(config.plugins)
    study: Callable[[Config, Path, dict[str, Any]], None] = import_module(f"footopt.studies.{name}").run
    study(config, folder, settings)
