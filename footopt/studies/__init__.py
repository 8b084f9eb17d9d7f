"""Studies: a module for each question, and what they share in `footopt.studies.base`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from footopt.errors import ERROR_FILE, SettingError
from footopt.files.identity import locked
from footopt.studies.settings import SEARCHES, Config

#: Studies by name: each is the function `run` of the module of that name. A plugin adds its own function.
STUDIES: dict[str, Callable[[Any], Any] | None] = dict.fromkeys(
    (
        "optimize", "simulate", "accuracy", "stability", "effects", "paper", "robust",
        "export", "compare", "doctor", "validate", "calibrate",
    )
)  # fmt: skip


def run(
    config: Config,
    folder: Path,
    settings: Mapping[str, Any],
    words: Sequence[str] = (),
    resumed: bool = False,
    files: Mapping[str, str] | None = None,
) -> Any:
    """Run the study that the settings name.

    Parameters
    ----------
    config : Config
        The settings.
    folder : Path
        Where the study leaves what it finds.
    settings : dict
        The same settings as plain data: what the run is.
    words : sequence of str
        What was given on the command line.
    resumed : bool
        Whether it goes on with what is in the folder.
    files : mapping of str to str, optional
        What YAML files of the user set, each with its file.

    Returns
    -------
    float or tuple, optional
        The objective of the foot that the study is about, or its objectives: natural signs.

    Raises
    ------
    Occupied
        Another run is at work in the folder, or has left what it found there.
    SettingError
        There is no such study, or it does not go with the other settings.
    """
    # what is imported here would slow `footopt --help` down
    from footopt.studies.base import Study
    from footopt.studies.build import check_lists, load_plugins, make_limits
    from footopt.studies.identity import check_links, enter
    from footopt.studies.reads import check_read

    check_lists(config)
    load_plugins(config.plugins)
    check_read(config, words, files)
    name = config.study.name
    if name not in STUDIES:
        raise SettingError("study.name", name, f"one of {', '.join(STUDIES)}")
    if config.engine.name != "local" and name not in SEARCHES:
        raise SettingError("engine", config.engine.name, f"local for study={name}")
    if name != "optimize" and (limits := make_limits(config)):
        raise SettingError("constraint", limits, f"left out for study={name}", "study=optimize keeps limits.")
    ask = STUDIES[name] or import_module(f"footopt.studies.{name}").run
    with locked(folder):
        check_links(folder)
        if not resumed:
            enter(folder, settings, words)
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that failed before
        return ask(Study(config, folder, settings, words))
