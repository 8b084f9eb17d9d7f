"""YAML files of the user: what they set, and where the files are that they name."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import yaml
from hydra.core.global_hydra import GlobalHydra
from hydra.types import RunMode
from omegaconf import OmegaConf

from footopt.cli.compose import CONF
from footopt.files.identity import flat

#: Settings that name files or folders to read.
PATHS = ("foot.path", "gait.path", "sand.table", "study.store", "study.run", "study.runs",
         "study.tests", "plugins")  # fmt: skip


def typed(here: Any, kind: str = "task") -> list[str]:
    """The words of the command line as they were given; one may refer to another setting: ${foot.H}."""
    words: Any = OmegaConf.to_container(here.overrides[kind], resolve=False)
    return list(words)


def absolute(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings with files where they are, whatever folder they are read from later."""
    return _changed(settings, lambda _, value: _plain(Path(value).expanduser()))


def beside_their_files(settings: Mapping[str, Any], here: Any) -> dict[str, Any]:
    """The settings with the files that a YAML file of the user names relative to that file.

    Parameters
    ----------
    settings : dict
        All settings, composed.
    here : HydraConfig
        Of what, and how.
    """
    given = {word.lstrip("+").partition("=")[0] for word in typed(here)}
    named = {name for name, value in _relative(settings) if name not in given}
    if not named:
        return dict(settings)
    # the last file that sets it counts; one of a packaged configuration may have no path
    folders: dict[tuple[str, str], Path] = {}
    for path, content in _files_of(here):
        folders |= {(name, value): path.parent for name, value in _relative(content) if name in named}
    return _changed(
        settings, lambda *found: _plain(folders[found] / found[1]) if found in folders else found[1]
    )


def _plain(path: Path) -> str:
    """An absolute path without "..", whatever links are on the way."""
    return str(path.resolve() if ".." in path.parts else path.absolute())


def set_by_files(here: Any) -> dict[str, str]:
    """What YAML files of the user set, by the settings' full names, each with its file."""
    return {name: str(path) for path, content in _files_of(here) for name in flat(content)}


def _files_of(here: Any) -> Iterator[tuple[Path, dict[str, Any]]]:
    """The user's YAML files that the settings are composed of, in order, each with what it sets itself."""
    roots = [folder for source in here.runtime.config_sources if (folder := _folder(source))]
    own = CONF.resolve()
    if all(root.resolve() == own for root in roots):
        return
    loader = GlobalHydra.instance().config_loader()
    words = [*typed(here, "hydra"), *typed(here)]
    for part in loader.compute_defaults_list(here.job.config_name, words, RunMode.RUN).defaults:
        found = [root / f"{part.config_path}.yaml" for root in roots]
        path = next(filter(Path.is_file, found), None)
        if path is not None and not path.resolve().is_relative_to(own):
            content = yaml.safe_load(path.read_bytes()) or {}
            for name in reversed(part.package.split(".")) if part.package else ():
                content = {name: content}
            yield path, content


def _folder(source: Any) -> Path | None:
    """The folder of a source of settings that is not Hydra's own; None for what is no folder."""
    if source.schema == "pkg" and source.provider != "hydra":
        return Path(str(resources.files(source.path)))
    return Path(source.path) if source.schema == "file" and source.path else None


def _relative(settings: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and values of the settings that name files by a relative path."""
    for name, value in flat(settings).items():
        for path in value if isinstance(value, list) else [value]:
            if name in PATHS and _is_file(name, path) and not Path(path).expanduser().is_absolute():
                yield name, path


def _is_file(name: str, value: Any) -> bool:
    """Whether a value names a file: a plugin may be a module."""
    return isinstance(value, str) and bool(value) and (name != "plugins" or value.endswith(".py"))


def _changed(settings: Mapping[str, Any], change: Callable[[str, str], str]) -> dict[str, Any]:
    """A copy of the settings, with every name of a file changed."""
    copied = copy.deepcopy(dict(settings))
    for name in PATHS:
        *above, last = name.split(".")
        group = within(copied, above)
        if isinstance(value := group[last], list):
            group[last] = [change(name, v) if _is_file(name, v) else v for v in value]
        elif _is_file(name, value):
            group[last] = change(name, value)
    return copied


def within(settings: Any, names: Sequence[str]) -> Any:
    """The group of settings below some names."""
    for name in names:
        settings = settings[name]
    return settings
