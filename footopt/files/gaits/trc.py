"""Markers from TRC files (OpenSim; Motion Analysis' Cortex)."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from footopt.files.columns import to_numbers
from footopt.files.gaits.markers import Markers, differing, metres, to_markers
from footopt.files.io import Unusable

Array = NDArray[np.float64]

RATE = 0.02  # relative, by which a stated frame rate may differ from the times, which are rounded


def read_trc(text: str, units: str | None = None) -> Markers:
    """Read markers from TRC: tabs, three columns a marker, any units.

    The header's third line holds the units, unless `units` does; names stand over the first of a marker's
    columns. A cell that is empty, or a marker at exactly 0, 0, 0, is a gap. Programs that cut a walk out of a
    longer one often leave the header as it was: what it says of the numbers of frames and markers is noted
    where it differs.
    """
    lines = text.splitlines()
    at = next((i for i, line in enumerate(lines[:12]) if re.match(r"\s*frame#?\b", line, re.I)), None)
    if at is None or at < 1:
        raise Unusable("cannot be read as TRC (no line begins with Frame#).")
    stated = _stated(lines[at - 2], lines[at - 1])
    unit = metres(stated.get("units", ""), units)
    rows = [(i, cells_of(line)) for i, line in enumerate(lines[at + 2 :], start=at + 3) if line.strip()]
    header = cells_of(lines[at])
    words = [i for i, cell in enumerate(header) if cell]  # the first two are Frame# and Time
    if not rows or len(words) < 3:
        raise Unusable("cannot be read as TRC (it holds no markers).")
    widths = Counter(len(cells) for _, cells in rows)
    wide = max((width for width, many in widths.items() if many > 1), default=max(widths))
    names = _names(header[words[1] + 1 :], wide - 2)
    frames, markers, named = stated.get("numframes"), stated.get("nummarkers"), sum(map(bool, names))
    notes = differing([("frames", frames, len(rows)), ("markers", markers, named)])
    columns = max(1 + 3 * len(names), wide - 1)
    try:
        table = to_numbers(((i, cells[1:]) for i, cells in rows), columns, gaps=True)
        _check_rate(table[:, 0], stated.get("datarate", ""))
    except ValueError as error:
        raise Unusable(f"cannot be read as TRC ({error}).") from None
    if more := columns - 1 - 3 * named:
        notes += (f"{more} columns without a name are left out",)
    places = table[:, 1 : 1 + 3 * len(names)].reshape(len(rows), -1, 3)
    return to_markers(table[:, 0], names, unit * places, notes)


def _stated(keys: str, values: str) -> dict[str, str]:
    """What a header states, its keys in lower case; some programs write two tabs for one."""
    words, said = cells_of(keys), cells_of(values)
    some, found = ([cell for cell in cells if cell] for cells in (words, said))
    pairs = zip(some, found, strict=True) if len(some) == len(found) else zip(words, said, strict=False)
    return {key.lower(): value for key, value in pairs}


def _names(cells: Sequence[str], wide: int) -> list[str]:
    """The name over each three of `wide` columns; "" over a marker without one."""
    names = [cell for cell in cells if cell]
    stems = [re.sub(r"[_.: -]?[xyz]$", "", name, flags=re.I) for name in names]
    if wide <= len(names) and all(len(set(stems[i : i + 3])) == 1 for i in range(0, len(names), 3)):
        return stems[::3]  # a name over each column
    if wide <= 3 * len(names):  # whatever tabs are between them
        return names
    over = [i for i, cell in enumerate(cells) if cell]
    if any(i % 3 for i in over):
        raise Unusable(
            f"has {wide} columns of numbers and {len(names)} names of markers, which do not stand over every "
            "third column: which are whose?"
        )
    return [cells[i] for i in range(0, over[-1] + 1, 3)]


def cells_of(line: str) -> list[str]:
    """Cells of a line with tabs, or else spaces, between them."""
    return [cell.strip() for cell in line.rstrip("\t\r\n").split("\t")] if "\t" in line else line.split()


def _check_rate(t: Array, stated: str) -> None:
    """Raise unless the times are those of the frame rate that a header states; 0 states none."""
    try:
        rate, own = float(stated), (len(t) - 1) / float(t[-1] - t[0])
    except (ValueError, ZeroDivisionError):  # not stated, or times that are refused later
        return
    if rate != 0 and not abs(own / rate - 1.0) < RATE:
        raise ValueError(f"its header says {rate:g} frames a second, and its times {own:.4g}: must be in s")
