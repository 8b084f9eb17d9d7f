"""What Hydra composes the settings of, how the words of the command line are read, and `--help`."""

from __future__ import annotations

import copy
import os
import re
import string
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from hydra.core.config_store import ConfigStore
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
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
FOLDERS = ("hydra.run.dir", "hydra.sweep.dir")
#: Groups of settings that say in what world, and how finely, is walked.
WORLD = ("sand", "gait", "walker", "effects", "scene", "accuracy")

STORE = ConfigStore.instance()
STORE.store(name="footopt_schema", node=Config)
for _group, _choices in CHOICES.items():
    for _name, _node in _choices.items():
        STORE.store(group=_group, name=_name, node=_node)
for _group, _choices in GLOBAL_CHOICES.items():
    for _name, _node in _choices.items():
        STORE.store(group=_group, name=_name, node=_node, package="_global_")


def groups() -> dict[str, list[str]]:
    """Names of the choices of every group: those of conf/ and those that the library knows."""
    found = {group: {*choices, *GLOBAL_CHOICES.get(group, ())} for group, choices in CHOICES.items()}
    for path in CONF.glob("*/*.yaml"):
        found.setdefault(path.parent.name, set()).add(path.stem)
    return {group: sorted(found[group]) for group in sorted(found)}


def check_dashes(words: Sequence[str]) -> None:
    """Raise a `FootoptError` for a setting that is given as if it were a flag."""
    for word in words:
        name = word.lstrip("-")
        if word.startswith("-") and name.partition("=")[0].partition(".")[0] in groups():
            tried = name if "=" in name else f"{name}=..."
            raise FootoptError(f"{word}: settings have no dashes. Try {tried}")


def readable(word: str, several: bool = False) -> str:
    """A setting that names files or folders, with quotes about those names that Hydra could not read.

    ``run=FOLDER`` becomes the setting that it is short for, ``~`` the user's own folder, and ``.inf`` of
    YAML the ``inf`` of Hydra's grammar. In a multirun, `several`, a comma is between the names of jobs.
    """
    word = re.sub(r"([=,\[]-?)\.inf(?=[,\]]|$)", r"\1inf", word)
    name, equals, value = word.partition("=")
    if name in FOLDERS and not value:
        raise FootoptError(f"{word}: must be a folder, and is empty. {name}=. is the working folder.")
    if name == "run":
        return f"study.run={','.join(map(_quoted, value.split(',') if several else [value]))}"
    if name.lstrip("+") not in (*PATHS, *FOLDERS, "study.video") or _is_read(word):
        return word
    listed = value.startswith("[") and value.endswith("]")
    half = listed != value.startswith("[") | value.endswith("]")
    if half and name.lstrip("+") in ("plugins", "study.runs"):
        return word  # half a list; quoted, it would be a file's name
    parts = (value[1:-1] if listed else value).split(",")  # jobs of a multirun, or a list
    inner = ",".join(_quoted(os.path.expanduser(part.strip())) for part in parts)
    return f"{name}{equals}[{inner}]" if listed else f"{name}{equals}{inner}"


def _is_read(word: str) -> bool:
    """Whether Hydra's grammar has the word."""
    try:
        OverridesParser.create().parse_override(word)
    except HydraException:
        return False
    return True


def _quoted(text: str) -> str:
    """In quotes for Hydra, whatever is in it."""
    return "'{}'".format(text.replace("'", "\\'"))


def typed(here: Any, kind: str = "task") -> list[str]:
    """The words of the command line as they were given; one may refer to another setting: ${foot.H}."""
    words: Any = OmegaConf.to_container(here.overrides[kind], resolve=False)
    return list(words)


def absolute(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings with files where they are, whatever folder they are read from later."""

    def place(name: str, value: Any) -> Any:
        is_file = isinstance(value, str) and value and (name != "plugins" or value.endswith(".py"))
        return os.path.abspath(os.path.expanduser(value)) if is_file else value  # a plugin may be a module

    copied = copy.deepcopy(dict(settings))
    for name in PATHS:
        group, _, last = name.rpartition(".")
        part = copied[group] if group else copied
        value = part[last]
        part[last] = [place(name, v) for v in value] if isinstance(value, list) else place(name, value)
    return copied


def resolved(settings: Any, here: Any) -> dict[str, Any]:
    """The settings that Hydra composed as plain data; a run's foot walks in the run's world.

    What else is given is another, and it is walked as finely as the run's own numbers were. The foot's own
    are the run's in any case, so that this walk's folder knows its foot, too; but for another sole of its
    space, and a block for the workshop.

    Parameters
    ----------
    settings : DictConfig
        All settings, without Hydra's own.
    here : HydraConfig
        Of what, and how.

    Raises
    ------
    FileError
        study.run is not the folder of a run.
    """
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    study = plain["study"]
    if study["name"] != "simulate" or study["run"] is None:
        return dict(plain)
    run: Any = copy.deepcopy(identity.read(Path(study["run"]).expanduser(), "run").settings)
    if run["study"]["name"] != "simulate" and run["study"]["confirm"]:
        run["accuracy"] = dict.fromkeys(run["accuracy"]) | {"name": run["study"]["confirm"]}
    default = OmegaConf.to_container(compose(here.job.config_name, ["study=simulate"]), resolve=True)
    given = (word.lstrip("+").partition("=")[0] for word in typed(here))
    named = {name if name in WORLD else CHOICE.get(name, name) for name in given}  # planet: walker.g
    kept = {name: plain["foot"][name] for name in ("k", "block")}
    walked = plain | {group: run[group] for group in WORLD} | {"foot": run["foot"] | kept}
    for name in sorted({*identity.differing(plain, default), *named}):  # a group before what is in it
        *above, last = name.split(".")
        if (above or [last])[0] in WORLD:
            reduce(getitem, above, walked)[last] = reduce(getitem, above, plain)[last]
    return dict(walked)


def help_text(words: Sequence[str]) -> str:
    """What `footopt [settings] --help` says; "" where that is left to Hydra, which takes a second longer."""
    given = [word for word in words if word not in ("-h", "--help")]
    if (
        len(given) < len(words)
        and given
        and set(given) <= {*(field.name for field in fields(Config)), *groups()}
    ):
        from footopt.studies import reference

        return reference.text(tuple(given))
    if len(given) == len(words) or any(word.startswith("-") for word in given):
        return ""
    with initialize_config_dir(str(CONF), version_base="1.3"):
        settings = compose("config", given, return_hydra_config=True)
    template = string.Template(settings.hydra.help.template)
    with open_dict(settings):
        del settings["hydra"]
    choices = "".join(
        textwrap.fill(f"{group}: {', '.join(names)}", 80, subsequent_indent="  ") + "\n"
        for group, names in groups().items()
    )
    return template.substitute(APP_CONFIG_GROUPS=choices, CONFIG=OmegaConf.to_yaml(settings))
