"""Tables of numbers: cells of any text, and CSV by the names of its columns."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.files.io import Unusable

Array = NDArray[np.float64]


def columns_of(
    text: str, wanted: Mapping[str, str], optional: Sequence[str] = (), label: str | None = None
) -> tuple[dict[str, Array], list[str]]:
    """The columns of a text that are there, and words.

    Raises
    ------
    Unusable
        It lacks a column or has it twice, or holds something that is not a number.
    """
    reader, mark = _reader(text)
    try:
        header: list[str] = next(reader, [])
        rows = [(reader.line_num, row) for row in reader if row]
    except csv.Error:
        raise Unusable(f"not a table (line {reader.line_num}: is a quote not closed?).") from None
    if missing := [name for name in wanted if name not in header]:
        units = f" ({', '.join(wanted.values())})" if any(wanted.values()) else ""
        raise Unusable(
            f"the header lacks {', '.join(missing)}; the columns must be {', '.join(wanted)}{units}, "
            "with commas, semicolons or tabs between them."
        )
    if twice := next((name for name in (*wanted, *optional, label) if header.count(name or "") > 1), None):
        raise Unusable(f"two columns are called {twice!r}. Which one is it?")
    names = [name for name in (*wanted, *optional) if name in header]
    places = [header.index(name) for name in names]
    words = header.index(label) if label in header else None
    needed = max([*places, words or 0])
    for line, row in rows:
        if not needed < len(row) <= len(header):  # more as with decimal commas
            raise Unusable(
                f"not a table of numbers (line {line} has {len(row)} cells, the header {len(header)})."
            )
    try:
        point = "," if mark == "," else "."
        cells = ((line, [row[c].replace(",", point) for c in places]) for line, row in rows)
        table = to_numbers(cells, len(places), gaps=False)
    except ValueError as error:
        raise Unusable(f"not a table of numbers ({error}).") from None
    labels = ["" if words is None else row[words].strip() for _, row in rows]
    return dict(zip(names, table.T, strict=True)), labels


def header_of(text: str) -> list[str]:
    """The names of a table's columns."""
    try:
        return next(_reader(text)[0], [])
    except csv.Error:
        return []


def _reader(text: str) -> tuple[Any, str]:
    """A reader of a table's rows, and what stands between its cells."""
    lines = text.splitlines()
    mark = next((mark for mark in (";", "\t") if lines and mark in lines[0]), ",")
    return csv.reader(lines, skipinitialspace=True, delimiter=mark), mark


def to_numbers(rows: Iterable[tuple[int, Sequence[str]]], wide: int, gaps: bool) -> Array:
    """The cells of numbered lines as numbers, (rows, wide); with `gaps`, an empty or missing one is NaN.

    Raises
    ------
    ValueError
        A cell is not a number, or a row has too many or too few.
    """
    found = []
    for line, cells in rows:
        more = [cell for cell in cells[wide:] if cell]
        if more or (len(cells) < wide and not gaps):
            raise ValueError(f"line {line} has {len(cells)} cells where the header has {wide}")
        try:
            row = [number(cell) if cell or not gaps else np.nan for cell in cells[:wide]]
        except ValueError as error:
            raise ValueError(f"line {line}: {error}") from None
        found.append(row + [np.nan] * (wide - len(row)))
    return np.array(found, float).reshape(-1, wide)


LARGEST = 1e12  # of a measured number, in any unit


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
