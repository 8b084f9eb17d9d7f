"""Angles over time from a table (CSV)."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.strides import Recording, wrong
from footopt.files.reading import number, read_table

Array = NDArray[np.float64]


def read_csv(path: str | Path, names: Mapping[str, str] | None = None) -> Recording:
    """Angles over time: columns ``time`` (s), ``thigh``, ``knee`` and, optionally, ``foot`` (degrees;
    signs as in `footopt.gait.gait`), one stride from heel strike to heel strike or several strides.

    Parameters
    ----------
    names : the file's own names of these columns, where they differ.
    """
    names = names or {}
    own = {joint: names.get(joint, joint) for joint in ("time", "thigh", "knee", "foot")}
    reader = csv.DictReader(read_table(path, "gait", "gait.path").splitlines(), skipinitialspace=True)
    try:
        header = list(reader.fieldnames or [])
    except csv.Error as error:
        raise wrong(path, f"not a table ({error}).") from None
    missing = [own[c] for c in ("time", "thigh", "knee") if own[c] not in header]
    if missing:
        raise wrong(
            path,
            f"the header lacks {', '.join(missing)}; "
            "the columns must be time (s), thigh, knee and, optionally, foot (deg).",
        )
    if twice := next((c for c in own.values() if header.count(c) > 1), None):
        raise wrong(path, f"two columns are called {twice!r}. Which one is it?")
    columns = [own["time"], own["thigh"], own["knee"]] + ([own["foot"]] if own["foot"] in header else [])
    try:
        table = np.array([_row(row, columns) for row in reader], float)
    except (TypeError, ValueError, csv.Error) as error:
        raise wrong(path, f"not a table of numbers ({error}).") from None
    return Recording.checked(path, table.reshape(-1, len(columns)).T)


def _row(row: dict[str | None, str], columns: list[str]) -> list[float]:
    """A row's numbers; one with more cells than the header has is read wrongly, as with decimal commas."""
    if None in row:
        raise ValueError(f"a row has more cells than the header: {row[None]} are left over")
    return [number(row[c]) for c in columns]
