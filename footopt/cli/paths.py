"""Settings that name files: what a YAML file of the user names is found beside it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml
from hydra.core.global_hydra import GlobalHydra
from hydra.types import RunMode

#: Settings that name files or folders to read.
PATHS = ("foot.path", "gait.path", "sand.table", "study.store", "study.run", "study.runs",
         "study.tests", "plugins")  # fmt: skip


def absolute(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings with files where they are, whatever folder they are read from later."""
    return _changed(settings, lambda _, value: str(Path(value).expanduser().absolute()))


def beside_their_files(settings: Mapping[str, Any], here: Any) -> dict[str, Any]:
    """The settings with the files that a YAML file of the user names relative to that file.

    Parameters
    ----------
    settings : dict
        All settings, composed.
    here : HydraConfig
        Of what, and how.
    """
    given = {word.lstrip("+").partition("=")[0] for word in here.overrides.task}
    named = {name for name, value in _relative(settings) if name not in given}
    if not named:
        return dict(settings)
    # the last file that sets it counts; one of a packaged configuration may have no path
    folders: dict[tuple[str, str], Path] = {}
    for path, content in _files_of(here):
        folders |= {(name, value): path.parent for name, value in _relative(content) if name in named}
    return _changed(settings, lambda *found: str(folders[found] / found[1]) if found in folders else found[1])


def _files_of(here: Any) -> Iterator[tuple[Path, dict[str, Any]]]:
    """The YAML files that the settings are composed of, in order, each with what it sets by its own."""
    loader = GlobalHydra.instance().config_loader()
    words = [*here.overrides.hydra, *here.overrides.task]
    composed = loader.compute_defaults_list(here.job.config_name, words, RunMode.RUN)
    roots = [Path(s.path) for s in loader.get_sources() if s.scheme() == "file" and s.path]
    for part in composed.defaults:
        found = [root / f"{part.config_path}.yaml" for root in roots]
        if path := next(filter(Path.is_file, found), None):
            content = yaml.safe_load(path.read_bytes())
            for name in reversed(part.package.split(".")) if part.package else ():
                content = {name: content}
            yield path, content or {}


def _relative(settings: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and values of the settings that name files by a relative path."""
    for name in PATHS:
        value = _get(settings, name)
        for path in value if isinstance(value, list) else [value]:
            if _is_file(name, path) and not Path(path).expanduser().is_absolute():
                yield name, path


def _is_file(name: str, value: Any) -> bool:
    """Whether a value names a file: a plugin may be a module."""
    return isinstance(value, str) and bool(value) and (name != "plugins" or value.endswith(".py"))


def _get(settings: Mapping[str, Any], name: str) -> Any:
    value: Any = settings
    for key in name.split("."):
        value = value.get(key) if isinstance(value, Mapping) else None
    return value


def _changed(settings: Mapping[str, Any], change: Callable[[str, str], str]) -> dict[str, Any]:
    """A copy of the settings, with every name of a file changed."""
    copied = copy.deepcopy(dict(settings))
    for name in PATHS:
        *above, last = name.split(".")
        value = _get(copied, name)
        if value is None:
            continue
        whole = _get(copied, ".".join(above)) if above else copied
        if isinstance(value, list):
            whole[last] = [change(name, v) if _is_file(name, v) else v for v in value]
        elif _is_file(name, value):
            whole[last] = change(name, value)
    return copied
