"""Tables of numbers (CSV) by the names of their columns."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.files.reading import Unusable, naming, number, read_table

Array = NDArray[np.float64]

COUNTS = {3: "three", 4: "four"}


def read_columns(
    path: str | Path,
    kind: str,
    setting: str,
    wanted: Mapping[str, str],
    optional: Mapping[str, float] | None = None,
    label: str | None = None,
) -> tuple[dict[str, Array], list[str]]:
    """Read some columns of a table; others are ignored.

    Parameters
    ----------
    path : str or Path
        A CSV file with a header.
    kind : str
        What the file is for, in `footopt.files.reading.LIMITS`.
    setting : str
        The setting that names the file, for messages.
    wanted : dict
        The unit of each column that there must be.
    optional : dict, optional
        What each other column is where it is missing.
    label : str, optional
        A column of words, which may be missing.

    Returns
    -------
    columns : dict of (rows,)
        By their names; all values are finite.
    labels : (rows,)
        Of the column of words; empty words where it is missing.

    Raises
    ------
    FileError
        The file cannot be read, lacks a column or has it twice, or holds something that is not a number.
    """
    text = read_table(path, kind, setting)
    with naming(path, setting):
        reader = csv.DictReader(text.splitlines(), skipinitialspace=True)
        try:
            return _columns(reader, wanted, optional or {}, label)
        except csv.Error as error:
            raise Unusable(f"not a table ({error}).") from None


def _columns(
    reader: csv.DictReader[str], wanted: Mapping[str, str], optional: Mapping[str, float], label: str | None
) -> tuple[dict[str, Array], list[str]]:
    header = list(reader.fieldnames or [])
    if missing := [name for name in wanted if name not in header]:
        units = f" ({', '.join(wanted.values())})" if any(wanted.values()) else ""
        raise Unusable(
            f"the header lacks {', '.join(missing)}; the columns must be {', '.join(wanted)}{units}."
        )
    if twice := next((n for n in (*wanted, *optional, label) if header.count(n or "") > 1), None):
        raise Unusable(f"two columns are called {twice!r}. Which one is it?")
    names = [*wanted, *(name for name in optional if name in header)]
    rows, labels = [], []
    for line in reader:
        try:
            rows.append([number(line[name]) for name in names])
            labels.append((line[label] if label in header else "").strip())
            if None in line:  # more cells than the header has, as with decimal commas
                raise ValueError
        except (AttributeError, TypeError, ValueError):  # a line that is too short has None
            shown = [*(line[name] for name in names), *(line.get(None) or [])][:8]
            count = COUNTS.get(len(names), str(len(names)))
            raise Unusable(f"line {reader.line_num}: not {count} numbers: {shown}.") from None
    table = np.array(rows, float).reshape(-1, len(names))
    if not np.isfinite(table).all():
        raise Unusable("holds a value that is not finite.")
    found = dict(zip(names, table.T, strict=True))
    return {
        name: found.get(name, np.full(len(rows), value)) for name, value in optional.items()
    } | found, labels
