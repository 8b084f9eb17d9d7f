"""Markers as motion capture programs export them to CSV: Vicon Nexus and OptiTrack Motive."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from footopt.files.columns import number, to_numbers
from footopt.files.gaits.markers import Markers, metres, to_markers
from footopt.files.io import Unusable

Array = NDArray[np.float64]
Rows = list[list[str]]

AXES = re.compile(r"^[^\w\n]*frame\b.*,\W*x\W*,\W*y\W*,\W*z\b", re.I | re.M)


def holds_markers(text: str) -> bool:
    """Whether a CSV file has a row Frame, ..., X, Y, Z, and so markers rather than angles."""
    return AXES.search(text) is not None


def read_capture(text: str, units: str | None = None) -> Markers:
    """Read markers from CSV; an empty cell is a gap.

    Nexus writes sections; one is ``Trajectories``, then the rate, the names, ``Frame,Sub Frame,X,Y,Z,...``,
    the units, and a row a frame. Motive writes a line of settings (``Format Version``, the units among
    them), rows of types, names and IDs, and ``Frame,Time (Seconds),X,Y,Z,...``; of its columns those of
    type Marker are read, which were measured, and none of a solved rigid body. `units` is the unit of
    length, by default what the file says.
    """
    try:
        rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines())]
        if ["Trajectories"] in (row[:1] for row in rows):
            return _of_nexus(rows, units)
        if rows[0][:1] == ["Format Version"]:
            return _of_motive(rows, units)
        why = "no line is Trajectories, and the first is not Format Version"
    except (IndexError, StopIteration):
        why = "its header is not whole"
    except Unusable:
        raise
    except csv.Error:
        why = "a quote is not closed"
    except ValueError as error:
        why = str(error)
    raise Unusable(f"cannot be read as markers in CSV (Vicon Nexus, OptiTrack Motive) ({why}).")


def _of_nexus(rows: Rows, setting: str | None) -> Markers:
    title = next(i for i, row in enumerate(rows) if row[:1] == ["Trajectories"])
    rate, (names, axes, units) = number(rows[title + 1][0]), (rows[title + i] for i in (2, 3, 4))
    if not rate > 0:
        raise ValueError(f"it says {rate:g} frames a second")
    columns = _columns(axes)
    t, places = _table(rows, title + 5, columns)
    unit = metres(units[columns[0]], setting)
    if setting is None and (other := next((u for u in units[2:] if u and u != units[columns[0]]), None)):
        raise ValueError(f"it has lengths in {units[columns[0]]} and in {other}")
    return to_markers(t[:, 0] / rate, [names[c] for c in columns], unit * places)


def _of_motive(rows: Rows, setting: str | None) -> Markers:
    stated = dict(zip(rows[0][::2], rows[0][1::2], strict=False))
    at = next(i for i, row in enumerate(rows) if row and row[0] == "Frame")
    types, names = next((rows[i], rows[i + 1]) for i in range(1, at) if "Marker" in rows[i])
    columns = [c for c in _columns(rows[at]) if types[c] == "Marker"]
    t, places = _table(rows, at + 1, columns)
    unit = metres(stated.get("Length Units", ""), setting)
    return to_markers(t[:, 1], [names[c] for c in columns], unit * places)


def _columns(axes: Sequence[str]) -> list[int]:
    """Where the X of each marker is."""
    found = [i for i in range(2, len(axes) - 2) if [a.upper() for a in axes[i : i + 3]] == ["X", "Y", "Z"]]
    if not found:
        raise ValueError("no columns X, Y, Z")
    return found


def _table(rows: Rows, begin: int, columns: list[int]) -> tuple[Array, Array]:
    """The first two columns and the markers' places (n, markers, 3), to the first empty line."""
    end = next((i for i, row in enumerate(rows[begin:], begin) if not any(row)), len(rows))
    if end == begin:
        raise ValueError("it holds no frames")
    wanted = [0, 1, *(c + axis for c in columns for axis in range(3))]
    padded = ((i, [*row, *[""] * wanted[-1]]) for i, row in enumerate(rows[begin:end], begin + 1))
    table = to_numbers(((i, [row[c] for c in wanted]) for i, row in padded), len(wanted), gaps=True)
    return table[:, :2], table[:, 2:].reshape(len(table), -1, 3)
