"""What Hydra composes the settings of, the words that it is given, and `--help`."""

from __future__ import annotations

import copy
import os
import re
import string
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from hydra.core.config_store import ConfigStore
from omegaconf import OmegaConf, open_dict

from footopt.errors import FootoptError
from footopt.files import identity
from footopt.studies import CHOICE
from footopt.studies.settings import CHOICES, GLOBAL_CHOICES, Config

PACKAGE = Path(__file__).parents[1]
#: conf/ inside the installed package, or at the top of a checkout.
CONF = PACKAGE / "conf" if (PACKAGE / "conf").is_dir() else PACKAGE.parent / "conf"

#: Settings that name files or folders to read.
PATHS = ("foot.path", "gait.path", "sand.table", "study.store", "study.run", "study.runs",
         "study.tests", "plugins")  # fmt: skip
#: Groups of settings that say in what world, and how finely, is walked.
WORLD = ("sand", "gait", "walker", "effects", "scene", "accuracy")

STORE = ConfigStore.instance()
STORE.store(name="footopt_schema", node=Config)
for _choices, _package in ((CHOICES, None), (GLOBAL_CHOICES, "_global_")):
    for _group, _nodes in _choices.items():
        for _name, _node in _nodes.items():
            STORE.store(group=_group, name=_name, node=_node, package=_package)


def groups() -> dict[str, list[str]]:
    """Names of the choices of every group: those of conf/ and those that the library knows."""
    found = {group: {*choices, *GLOBAL_CHOICES.get(group, ())} for group, choices in CHOICES.items()}
    for path in CONF.glob("*/*.yaml"):
        found.setdefault(path.parent.name, set()).add(path.stem)
    return {group: sorted(found[group]) for group in sorted(found)}


def read(words: Sequence[str]) -> list[str]:
    """The words of a command line as Hydra takes them.

    ``run=FOLDER`` becomes the setting that it is short for, ``~/`` the user's own folder, and ``.inf`` of
    YAML the ``inf`` of Hydra's grammar.

    Raises
    ------
    FootoptError
        A setting is given as if it were a flag.
    """
    for word in words:
        name = word.lstrip("-")
        if word.startswith("-") and re.split(r"[.=]", name)[0] in groups():
            tried = name if "=" in name else f"{name}=..."
            raise FootoptError(f"{word}: settings have no dashes. Try {tried}")
    full = [f"study.{word}" if word.startswith("run=") else word for word in words]
    at_home = [re.sub(r"([=,\[])~/", rf"\1{Path.home().as_posix()}/", word) for word in full]
    return [re.sub(r"([=,\[]-?)\.inf(?=[,\]]|$)", r"\1inf", word) for word in at_home]


def typed(here: Any, kind: str = "task") -> list[str]:
    """The words of the command line as they were given; one may refer to another setting: ${foot.H}."""
    words: Any = OmegaConf.to_container(here.overrides[kind], resolve=False)
    return list(words)


def absolute(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings with files where they are, whatever folder they are read from later."""

    def place(name: str, value: Any) -> Any:
        if isinstance(value, list):
            return [place(name, one) for one in value]
        is_file = value and (name != "plugins" or value.endswith(".py"))  # a plugin may be a module
        return os.path.abspath(os.path.expanduser(value)) if is_file else value

    copied = copy.deepcopy(dict(settings))
    for name in PATHS:
        group, _, last = name.rpartition(".")
        part = copied[group] if group else copied
        part[last] = place(name, part[last])
    return copied


def resolved(settings: Any, words: Sequence[str], config: str = "config") -> dict[str, Any]:
    """The settings that Hydra composed as plain data; a run's foot walks in the run's world.

    What is given besides is another, and it is walked as finely as the run's own numbers were. The foot's
    own settings are the run's in any case, but for another sole of its space.

    Parameters
    ----------
    settings : DictConfig
        All settings, without Hydra's own.
    words : sequence of str
        What was given on the command line.
    config : str
        The file that they begin with.

    Raises
    ------
    FileError
        study.run is not the folder of a run.
    """
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    if plain["study"]["name"] != "simulate" or plain["study"]["run"] is None:
        return dict(plain)
    run: Any = dict(identity.read(Path(plain["study"]["run"]).expanduser(), "run").settings)
    if run["study"]["name"] != "simulate" and run["study"]["confirm"]:
        run["accuracy"] = dict.fromkeys(run["accuracy"]) | {"name": run["study"]["confirm"]}
    default = OmegaConf.to_container(compose(config, ["study=simulate"]), resolve=True)
    typed = (word.lstrip("+").partition("=")[0] for word in words)
    given = {name if name in WORLD else CHOICE.get(name, name) for name in typed}  # planet: walker.g
    own = {name: plain["foot"][name] for name in ("k", "block")}
    walked = OmegaConf.create(plain | {group: run[group] for group in WORLD} | {"foot": run["foot"] | own})
    for name in sorted({*identity.changed_settings(plain, default), *given}):  # a group before what is in it
        if name.partition(".")[0] in WORLD:
            OmegaConf.update(walked, name, OmegaConf.select(OmegaConf.create(plain), name), merge=False)
    found: Any = OmegaConf.to_container(walked)
    return dict(found)


def help_text(words: Sequence[str]) -> str:
    """What `footopt [settings] --help` says; "" without it, and with other flags, which are Hydra's."""
    given = [word for word in words if word not in ("-h", "--help")]
    if len(given) == len(words) or any(word.startswith("-") for word in given):
        return ""
    if given and {*given} <= {*(field.name for field in fields(Config)), *groups()}:
        from footopt.studies import reference

        return reference.text(tuple(given))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        settings = compose("config", given, return_hydra_config=True)
    template = string.Template(settings.hydra.help.template)
    with open_dict(settings):
        del settings["hydra"]
    choices = "".join(f"{group}: {', '.join(names)}\n" for group, names in groups().items())
    return template.substitute(APP_CONFIG_GROUPS=choices, CONFIG=OmegaConf.to_yaml(settings))
