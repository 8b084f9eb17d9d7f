"""Markers as motion capture programs export them to CSV: Vicon Nexus and OptiTrack Motive."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.motion import Markers, length_of, not_a, to_markers
from footopt.files.reading import number, read_table

Array = NDArray[np.float64]

KIND = "markers in CSV (Vicon Nexus, OptiTrack Motive)"
AXES = re.compile(r"^[^\w\n]*frame\b.*,\W*x\W*,\W*y\W*,\W*z\b", re.I | re.M)


def holds_markers(path: str | Path) -> bool:
    """Whether a CSV file has a row Frame, ..., X, Y, Z, and so markers rather than angles."""
    return AXES.search(read_table(path, "gait", "gait.path")) is not None


def read_capture(path: str | Path) -> Markers:
    """Markers from CSV; an empty cell is a gap.

    Nexus writes sections; one is ``Trajectories``, then the rate, the names, ``Frame,Sub Frame,X,Y,Z,...``,
    the units, and a row a frame. Motive writes a line of settings (``Format Version``, the units among
    them), rows of types, names and IDs, and ``Frame,Time (Seconds),X,Y,Z,...``; of its columns those of
    type Marker are read, which were measured, and none of a solved rigid body.

    Raises
    ------
    FileError : it is neither.
    """
    text = read_table(path, "gait", "gait.path")
    try:
        rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines())]
        if ["Trajectories"] in (row[:1] for row in rows):
            return _of_nexus(path, rows)
        if rows[0][:1] == ["Format Version"]:
            return _of_motive(path, rows)
    except (IndexError, StopIteration):
        raise not_a(path, KIND, "its header is not whole") from None
    except (ValueError, csv.Error) as error:
        raise not_a(path, KIND, str(error)) from None
    raise not_a(path, KIND, "no line is Trajectories, and the first is not Format Version")


def _of_nexus(path: str | Path, rows: list[list[str]]) -> Markers:
    title = next(i for i, row in enumerate(rows) if row[:1] == ["Trajectories"])
    if len(rows) < title + 5:
        raise ValueError("its header is not whole")
    rate, names, axes, units = float(number(rows[title + 1][0])), *rows[title + 2 : title + 5]
    if not rate > 0:
        raise ValueError(f"it says {rate:g} frames a second")
    columns = _columns(axes)
    table = _table(rows, title + 5, columns)
    unit = length_of(path, units[columns[0]])
    if other := next((u for u in units[2:] if u and u != units[columns[0]]), None):
        raise ValueError(f"it has lengths in {units[columns[0]]} and in {other}")
    return to_markers(path, table[:, 0] / rate, [names[c] for c in columns], unit * _places(table))


def _of_motive(path: str | Path, rows: list[list[str]]) -> Markers:
    said = dict(zip(rows[0][::2], rows[0][1::2], strict=False))
    at = next(i for i, row in enumerate(rows) if row and row[0] == "Frame")
    types, names = next((rows[i], rows[i + 1]) for i in range(1, at) if "Marker" in rows[i])
    columns = [c for c in _columns(rows[at]) if types[c] == "Marker"]
    table = _table(rows, at + 1, columns)
    unit = length_of(path, said.get("Length Units", ""))
    return to_markers(path, table[:, 1], [names[c] for c in columns], unit * _places(table))


def _columns(axes: list[str]) -> list[int]:
    """Where the X of each marker is."""
    found = [i for i in range(2, len(axes) - 2) if [a.upper() for a in axes[i : i + 3]] == ["X", "Y", "Z"]]
    if not found:
        raise ValueError("no columns X, Y, Z")
    return found


def _table(rows: list[list[str]], begin: int, columns: list[int]) -> Array:
    """The first two columns and those of the markers, to the first empty line, NaN where a cell is empty."""
    wanted = [0, 1, *(c + axis for c in columns for axis in range(3))]
    found = []
    for line, row in enumerate(rows[begin:], start=begin + 1):
        if not any(row):
            break
        cells = row + [""] * (wanted[-1] + 1 - len(row))
        try:
            found.append([number(cells[c]) if cells[c] else np.nan for c in wanted])
        except ValueError as error:
            raise ValueError(f"line {line}: {error}") from None
    if not found:
        raise ValueError("it holds no frames")
    return np.array(found)


def _places(table: Array) -> Array:
    return table[:, 2:].reshape(len(table), -1, 3)
