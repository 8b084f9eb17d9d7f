"""What Hydra composes the settings of: the schema, the groups and their choices; and the text of `--help`."""

from __future__ import annotations

import string
import textwrap
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from hydra import compose, initialize_config_dir
from hydra.core.config_store import ConfigStore
from omegaconf import OmegaConf, open_dict

from footopt.studies.settings import CHOICES, GLOBAL_CHOICES, Config

PACKAGE = Path(__file__).parents[1]
#: conf/ inside the installed package, or at the top of a checkout.
CONF = PACKAGE / "conf" if (PACKAGE / "conf").is_dir() else PACKAGE.parent / "conf"

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
