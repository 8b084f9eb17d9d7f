"""Files that a user gives: read up to a size, decoded, or refused with a message that names the cause."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from footopt.errors import FileError

MB = 1_000_000
#: The largest file of each kind, in bytes; each is many times what its use needs.
LIMITS = {
    "gait": 40 * MB,  # three minutes of 40 markers at 200 Hz as TRC
    "sole": 5 * MB,
    "sand": 5 * MB,
    "run": 50 * MB,  # result.json with a front of 100,000 designs
    "settings": 1 * MB,
}
LARGEST = 1e12  # of a measured number, in any unit

#: How files begin that are often given an ending that is not theirs.
FOREIGN = {
    b"\x1f\x8b": "compressed by gzip: unpack it first",
    b"PK\x03\x04": "a zip archive, such as a spreadsheet: save it as text (CSV)",
    b"%PDF": "PDF",
    b"\xff\xfe": "text in UTF-16: save it as UTF-8",
    b"\xfe\xff": "text in UTF-16: save it as UTF-8",
}


class Unusable(ValueError):
    """Why the content of a file cannot be used; `naming` says of which file."""


@contextmanager
def naming(path: str | Path, setting: str) -> Iterator[None]:
    """Within it, an `Unusable` becomes a `FileError` that names the setting and the file."""
    try:
        yield
    except Unusable as why:
        raise FileError(f"{named(path, setting)}: {why}") from None


def named(path: str | Path, setting: str) -> str:
    """How a message begins: the setting and the file, of a long path its end."""
    text = str(path)
    return f"{setting} = {text if len(text) <= 160 else '...' + text[-157:]!r}"


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
    path : str or Path
        The file.
    kind : str
        What the file is for, in `LIMITS`.
    setting : str
        The setting that names the file, for the message.

    Raises
    ------
    FileError
        There is no such file, it cannot be read, is empty, or too large.
    """
    try:
        if Path(path).is_fifo():
            raise OSError(0, "a pipe, and no file")  # to be waited for, perhaps for ever
        with open(path, "rb") as file:
            content = file.read(LIMITS[kind] + 1)
    except (OSError, ValueError) as error:  # a path with a NUL in it is a ValueError
        why = error.strerror if isinstance(error, OSError) else error
        hint = " Use gait=human for the built-in walk." if kind == "gait" else ""
        raise FileError(f"{named(path, setting)}: cannot be read ({why}).{hint}") from None
    if not content.strip():
        raise FileError(f"{named(path, setting)}: is empty.")
    if len(content) > LIMITS[kind]:
        raise FileError(
            f"{named(path, setting)}: is larger than {LIMITS[kind] / MB:g} MB, the most for a {kind} file. "
            "Leave out what is not needed of it."
        )
    return content


def read_text(path: str | Path, kind: str, setting: str) -> str:
    """The text of a file in UTF-8, with or without a byte order mark; parameters and errors as `read_bytes`.

    Raises
    ------
    FileError
        The file is not text, or in another encoding.
    """
    content = read_bytes(path, kind, setting)
    with naming(path, setting):
        what = next((what for begin, what in FOREIGN.items() if content.startswith(begin)), None)
        if what is None and b"\0" in content:
            what = "no text: it holds NUL bytes"
        if what is not None:
            raise Unusable(f"cannot be read as text: it is {what}.")
        try:
            return content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = content.count(b"\n", 0, error.start) + 1
            raise Unusable(f"cannot be read as text: line {line} is not UTF-8. Save it as UTF-8.") from None


def read_table(path: str | Path, kind: str, setting: str) -> str:
    """The text of a table; parameters and errors as `read_text`.

    Raises
    ------
    FileError
        Its last number is cut off, as by a copy that broke off: no line break ends the file, and its last
        number has fewer decimals than that of any other line in the file's second half.
    """
    text = read_text(path, kind, setting)
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not text.endswith(("\n", "\r")) and len(lines) > 3:
        last, *above = map(_decimals, reversed(lines[len(lines) // 2 :]))
        if last < min(above):
            raise FileError(
                f"{named(path, setting)}: may be cut off: its last number has fewer decimals than all above "
                "it, and no line break ends it. Add one if the file is whole."
            )
    return text


def read_json_file(path: str | Path, kind: str, setting: str) -> Any:
    """What a JSON file holds; parameters and errors as `read_text`.

    Raises
    ------
    FileError
        It is not JSON.
    """
    text = read_text(path, kind, setting)
    with naming(path, setting):
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as error:  # deep nesting; a number of thousands of digits
            raise Unusable(f"cannot be read as JSON ({_brief(error)}).") from None


def number(cell: str) -> float:
    """A cell of a table as a number: none with underscores or of other scripts, which Python would allow.

    Raises
    ------
    ValueError
        The cell holds something else.
    """
    if "_" in cell or not cell.isascii():
        raise ValueError(f"{cell[:40]!r} is no number")
    try:
        value = float(cell)
    except ValueError:
        raise ValueError(f"{cell[:40]!r} is no number") from None
    if abs(value) > LARGEST:
        raise ValueError(f"{cell[:40]!r} is no measured number")
    return value


def _decimals(line: str) -> int:
    """Digits behind the point of a line's last number; a comma may be one's point only before a semicolon."""
    point = "[.,]" if ";" in line else r"\."
    found = re.search(rf"{point}(\d*)\s*$", line)
    return len(found[1]) if found else 0


def _brief(error: Exception) -> str:
    """An error in one line of at most 200 characters."""
    return "it nests too deeply" if isinstance(error, RecursionError) else " ".join(str(error).split())[:200]
