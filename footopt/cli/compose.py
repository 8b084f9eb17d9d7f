"""Paths and groups that Hydra composes settings of, and the settings of a run as plain data."""

import re
from argparse import ArgumentParser
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from hydra import compose
from hydra.core.config_store import ConfigStore
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from omegaconf import ListConfig, OmegaConf, open_dict

from footopt.studies import choices
from footopt.studies.build import load_plugins
from footopt.studies.runs import in_world_of_run
from footopt.studies.settings import Config, check_complete, structured

#: conf/ inside the installed package, or at the top of a checkout.
CONF: Path = next(path / "conf" for path in Path(__file__).parents[1:3] if (path / "conf").is_dir())
_offered: dict[tuple[str, str], Any] = {}  # to Hydra, which takes a millisecond for each


def register(words: Sequence[str] = ()) -> None:
    """Load the plugins that a command line names, and offer Hydra all settings and choices of then.

    As plain data, which goes to other processes as it is; `structured` knows the kinds of values.
    """
    load_plugins(named_plugins(words))
    store = ConfigStore.instance()
    store.store(name="footopt_settings", node=asdict(Config()) | {"study": {}})
    for group, nodes in choices().items():
        for name, node in nodes.items():
            if _offered.get((group, name)) != node:
                store.store(name, node, group, "_global_" if "defaults" in node else None)
                _offered[group, name] = node


def named_plugins(words: Sequence[str]) -> list[str]:
    """The plugins that a command line names, or else the settings file that it begins with."""
    flags = ArgumentParser(add_help=False, allow_abbrev=False)
    flags.add_argument("--config-path", "-cp", default=str(CONF))
    flags.add_argument("--config-dir", "-cd", default=str(CONF))
    flags.add_argument("--config-name", "-cn", default="config")
    found, overrides = flags.parse_known_args(list(words))
    if given := [one for one in overrides if one.lstrip("+").startswith("plugins=")]:
        named: Any = None
        with suppress(HydraException):
            named = OverridesParser.create().parse_override(given[-1]).value()
    else:
        places = (Path(__file__).parent / found.config_path, found.config_dir)
        files = (Path(place, f"{found.config_name.removesuffix('.yaml')}.yaml") for place in places)
        file = next(filter(Path.is_file, files), None)
        named = file and OmegaConf.select(OmegaConf.load(file), "plugins")
    return list(named) if isinstance(named, list | ListConfig) else []  # Hydra says what else is wrong


def groups() -> dict[str, list[str]]:
    """Names of the choices of every group: those of conf/ and those that the library and plugins know."""
    found = {group: {*nodes} for group, nodes in choices().items()}
    for path in CONF.glob("*/*.yaml"):
        found.setdefault(path.parent.name, set()).add(path.stem)
    return {group: sorted(found[group]) for group in sorted(found)}


def hydra_overrides(overrides: Sequence[str]) -> list[str]:
    """The overrides of a command line as Hydra takes them: run=, objective=[, foot=[, ~/ and .inf in full."""
    short = {"run=": "study.run=", "objective=[": "objective.names=[", "foot=[": "foot.k=["}
    full = [re.sub(r"^(run=|objective=\[|foot=\[)", lambda found: short[found[0]], one) for one in overrides]
    path = r"(?<=[=,\[])~/[^,\]]*"
    at_home = (re.sub(path, lambda at: _quoted(Path(at[0]).expanduser().as_posix()), one) for one in full)
    quoted = (re.sub(r"(?<=^study\.run=)[^'\"\[,]+$", lambda at: _quoted(at[0]), one) for one in at_home)
    return [re.sub(r"([=,\[]-?)\.inf(?=[,\]]|$)", r"\1inf", one) for one in quoted]


def _quoted(path: str) -> str:
    """A path as Hydra's grammar takes it: in quotes where it has umlauts or parentheses, say."""
    with suppress(HydraException):
        OverridesParser.create().parse_override(f"path={path}")
        return path
    return "'" + re.sub(r"(\\*)('|$)", lambda at: 2 * at[1] + (at[2] and "\\'"), path) + "'"


def task_overrides(here: Any, kind: str = "task") -> list[str]:
    """The overrides of the command line as they were given; one may refer to another setting: ${foot.H}."""
    overrides: Any = OmegaConf.to_container(here.overrides[kind], resolve=False)
    return list(overrides)


def resolved(settings: Any, overrides: Sequence[str], config: str = "config") -> Any:
    """The settings that Hydra composed, `structured`; with study=simulate run=FOLDER in that run's world.

    `overrides` are those of the command line, `config` is the file that they begin with.
    """
    with open_dict(settings):
        settings.pop("hydra", None)
    check_complete(settings)
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    load_plugins(plain["plugins"])  # in a job's process, too
    if plain["study"]["name"] == "simulate" and plain["study"]["run"] is not None:
        default: Any = OmegaConf.to_container(compose(config, ["study=simulate"]), resolve=True)
        plain = in_world_of_run(plain, default, [one.lstrip("+").partition("=")[0] for one in overrides])
    return structured(plain)  # refuses what + has added
