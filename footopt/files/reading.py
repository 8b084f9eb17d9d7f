"""Files that a user gives: opened only if they are files, read only up to a size, decoded or refused.

Nothing that is read here or after it is ever run: text, numbers and XML's tree, no pickle, no tags of YAML.
"""

from __future__ import annotations

import json
import os
import re
import stat
from pathlib import Path
from typing import Any

from footopt.errors import FileError

MB = 1_000_000
#: The largest file of each kind, bytes. All are read at once; each is many times what its use needs.
LIMITS = {
    "gait": 40 * MB,  # three minutes of 40 markers at 200 Hz as TRC; a table of that size takes 4 to 7 s
    "sole": 5 * MB,  # ten times what a drawing of as many points as `foot.outline` takes has as DXF
    "sand": 5 * MB,  # 100,000 rows of four numbers
    "run": 50 * MB,  # result.json with a front of 100,000 designs
    "settings": 1 * MB,  # YAML: all settings of footopt are 5 kB
}
LARGEST = 1e12  # of a cell of a table, in any unit
DEPTH = 50  # of nested lists and maps in YAML; settings have three levels
NODES = 10_000  # values in YAML once its aliases are followed: nine short lines can mean 1e9

HINTS = {"gait": " Use gait=human for the built-in walk."}  # where there is no such file

#: How files begin that are often given an ending that is not theirs.
FOREIGN = {
    b"\x1f\x8b": "compressed by gzip: unpack it first",
    b"PK\x03\x04": "a zip archive, such as a spreadsheet: save it as text (CSV)",
    b"%PDF": "PDF",
    b"\x89PNG": "a picture (PNG)",
    b"SQLite format 3": "an SQLite database",
    b"\xff\xfe": "text in UTF-16: save it as UTF-8",
    b"\xfe\xff": "text in UTF-16: save it as UTF-8",
    b"\x00\x00\xfe\xff": "text in UTF-32: save it as UTF-8",
}


def is_missing(path: Path) -> bool:
    """Whether there is no such file; one that may not be seen is there."""
    try:
        path.stat()
    except OSError as error:
        return isinstance(error, (FileNotFoundError, NotADirectoryError))
    return False


def read_bytes(path: str | Path, kind: str, setting: str) -> bytes:
    """The content of a file.

    Parameters
    ----------
    kind : in `LIMITS`. setting : that names the file, for the message.

    Raises
    ------
    FileError : there is no such file, it is a folder or a device, cannot be read, or is too large.
    """
    try:
        found = os.stat(path)
        if not stat.S_ISREG(found.st_mode):  # opening a pipe would wait for its other end
            what = _what(found.st_mode)
            raise FileError(f"{named(path, setting)}: cannot be read: it is {what}, not a file.")
        with open(path, "rb") as file:
            content = file.read(LIMITS[kind] + 1)
    except FileError:
        raise
    except (OSError, ValueError) as error:  # a path with a NUL in it is a ValueError
        why = error.strerror if isinstance(error, OSError) else error
        hint = HINTS.get(kind, "")
        raise FileError(f"{named(path, setting)}: cannot be read ({why}).{hint}") from None
    if len(content) > LIMITS[kind]:
        raise FileError(
            f"{named(path, setting)}: is larger than {LIMITS[kind] / MB:g} MB, the most for a {kind} file. "
            "Leave out what is not needed of it."
        )
    return content


def read_text(path: str | Path, kind: str, setting: str) -> str:
    """The text of a file in UTF-8, with or without a byte order mark; errors also as `read_bytes`.

    Raises
    ------
    FileError : it is not text, or in another encoding.
    """
    content = read_bytes(path, kind, setting)
    what = next((what for begin, what in FOREIGN.items() if content.startswith(begin)), None)
    if what is None and b"\0" in content:
        what = "no text: it holds NUL bytes"
    if what is not None:
        raise FileError(f"{named(path, setting)}: cannot be read as text: it is {what}.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise FileError(
            f"{named(path, setting)}: cannot be read as text: line {line} is not UTF-8. Save it as UTF-8."
        ) from None


def read_table(path: str | Path, kind: str, setting: str) -> str:
    """The text of a table; also refused if its last number is cut off, as by a copy that broke off.

    That is so where no line break ends the file, and its last cell has fewer decimals than any above it in
    the file's second half.
    """
    text = read_text(path, kind, setting)
    decimals = [_decimals(line) for line in text.splitlines() if line.strip() and not line.startswith("#")]
    above = decimals[max(len(decimals) // 2, 1) : -1]
    if not text.endswith(("\n", "\r")) and len(decimals) > 3 and decimals[-1] < min(above):
        raise FileError(
            f"{named(path, setting)}: may be cut off: its last number has fewer decimals than all above it, "
            "and no line break ends it. Add one if the file is whole."
        )
    return text


def read_json_file(path: str | Path, kind: str, setting: str) -> Any:
    """What a JSON file holds; raises `FileError` also for what is no JSON."""
    text = read_text(path, kind, setting)
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:  # deep nesting; a number of thousands of digits
        raise FileError(f"{named(path, setting)}: cannot be read as JSON ({_brief(error)}).") from None


def read_yaml(path: str | Path, setting: str) -> str:
    """The text of a YAML file that OmegaConf can load in no time.

    Raises
    ------
    FileError : it is no YAML, nests deeper than `DEPTH`, or its aliases make more than `NODES` of it.
    """
    import yaml

    text = read_text(path, "settings", setting)
    try:
        depth = 0
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > DEPTH:
                raise FileError(f"{named(path, setting)}: its YAML nests deeper than {DEPTH} levels.")
        sizes: dict[int, int] = {}
        if _size(yaml.compose(text, Loader=yaml.SafeLoader), sizes) > NODES:
            raise FileError(f"{named(path, setting)}: its YAML means more than {NODES} values.")
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise FileError(f"{named(path, setting)}: cannot be read as YAML ({_brief(error)}).") from None
    return text


def number(cell: str) -> float:
    """A cell of a table as a number; not underscores and other scripts, which Python allows."""
    if "_" in cell or not cell.isascii():
        raise ValueError(f"could not convert string to float: {cell[:40]!r}")
    value = float(cell)
    if abs(value) > LARGEST:
        raise ValueError(f"{cell[:40]!r} is no measured number")
    return value


def named(path: str | Path, setting: str) -> str:
    """How a message begins: the setting and the file, of a long path its end."""
    text = str(path)
    return f"{setting} = {text if len(text) <= 160 else '...' + text[-157:]!r}"


def _size(node: Any, sizes: dict[int, int]) -> int:
    """Values in a YAML node once aliases are followed; each node is counted once."""
    if node is None or isinstance(node.value, str):
        return 1
    if id(node) not in sizes:
        sizes[id(node)] = NODES + 1  # what holds itself has no end
        parts = [part for item in node.value for part in (item if isinstance(item, tuple) else (item,))]
        sizes[id(node)] = 1 + sum(_size(part, sizes) for part in parts)
    return sizes[id(node)]


def _decimals(line: str) -> int:
    """Digits behind the point of a line's last number; a comma may be one's point only before a semicolon."""
    point = "[.,]" if ";" in line else r"\."
    found = re.search(rf"{point}(\d*)\s*$", line)
    return len(found[1]) if found else 0


def _what(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a pipe" if stat.S_ISFIFO(mode) else "a device or a socket"


def _brief(error: Exception) -> str:
    """An error in one line of at most 200 characters."""
    if isinstance(error, RecursionError):
        return "it nests too deeply"
    return " ".join(str(error).split())[:200]
