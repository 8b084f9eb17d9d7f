"""Paths and groups that Hydra composes settings of, and the settings of a run as plain data."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydra import compose
from hydra.core.config_store import ConfigStore
from omegaconf import OmegaConf, open_dict

from footopt.studies import GLOBAL_OPTIONS, GROUP_OPTIONS
from footopt.studies.runs import in_world_of_run
from footopt.studies.settings import Config

#: conf/ inside the installed package, or at the top of a checkout.
CONF = next(path / "conf" for path in Path(__file__).parents[1:3] if (path / "conf").is_dir())

STORE = ConfigStore.instance()
STORE.store(name="footopt_schema", node=Config)
for _choices, _package in ((GROUP_OPTIONS, None), (GLOBAL_OPTIONS, "_global_")):
    for _group, _nodes in _choices.items():
        for _name, _node in _nodes.items():
            STORE.store(group=_group, name=_name, node=_node, package=_package)


def groups() -> dict[str, list[str]]:
    """Names of the choices of every group: those of conf/ and those that the library knows."""
    found = {group: {*choices, *GLOBAL_OPTIONS.get(group, ())} for group, choices in GROUP_OPTIONS.items()}
    for path in CONF.glob("*/*.yaml"):
        found.setdefault(path.parent.name, set()).add(path.stem)
    return {group: sorted(found[group]) for group in sorted(found)}


def hydra_overrides(overrides: Sequence[str]) -> list[str]:
    """The overrides of a command line as Hydra takes them: run=, ~/ and YAML's .inf are written out."""
    full = [f"study.{one}" if one.startswith("run=") else one for one in overrides]
    at_home = [re.sub(r"([=,\[])~/", rf"\1{Path.home().as_posix()}/", one) for one in full]
    return [re.sub(r"([=,\[]-?)\.inf(?=[,\]]|$)", r"\1inf", one) for one in at_home]


def task_overrides(here: Any, kind: str = "task") -> list[str]:
    """The overrides of the command line as they were given; one may refer to another setting: ${foot.H}."""
    overrides: Any = OmegaConf.to_container(here.overrides[kind], resolve=False)
    return list(overrides)


def resolved(settings: Any, overrides: Sequence[str], config: str = "config") -> dict[str, Any]:
    """The settings that Hydra composed as plain data; with study=simulate run=FOLDER in that run's world.

    `overrides` are those of the command line, `config` is the file that they begin with.
    """
    with open_dict(settings):
        settings.pop("hydra", None)
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    if plain["study"]["name"] != "simulate" or plain["study"]["run"] is None:
        return dict(plain)
    default: Any = OmegaConf.to_container(compose(config, ["study=simulate"]), resolve=True)
    return in_world_of_run(plain, default, [one.lstrip("+").partition("=")[0] for one in overrides])
