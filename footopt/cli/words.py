"""The words of the command line that Hydra could not read: flags that are settings, files with odd names."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException

from footopt.cli.compose import groups
from footopt.cli.paths import PATHS
from footopt.errors import FootoptError

FOLDERS = ("hydra.run.dir", "hydra.sweep.dir")
#: Settings that name files or folders.
FILES = (*PATHS, "study.video", *FOLDERS)
LISTS = ("plugins", "study.runs")


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
        return f"study.run={','.join(map(quoted, value.split(',') if several else [value]))}"
    if name.lstrip("+") not in FILES or is_read(word):
        return word
    listed = value.startswith("[") and value.endswith("]")
    if name.lstrip("+") in LISTS and listed != value.startswith("[") | value.endswith("]"):
        return word  # half a list; quoted, it would be a file's name
    parts = (value[1:-1] if listed else value).split(",")  # jobs of a multirun, or a list
    inner = ",".join(quoted(os.path.expanduser(part.strip())) for part in parts)
    return f"{name}{equals}[{inner}]" if listed else f"{name}{equals}{inner}"


def is_read(word: str) -> bool:
    """Whether Hydra's grammar has the word."""
    try:
        OverridesParser.create().parse_override(word)
    except HydraException:
        return False
    return True


def quoted(text: str) -> str:
    """In quotes for Hydra, whatever is in it."""
    return "'{}'".format(text.replace("'", "\\'"))
