"""Markers from TRC files (OpenSim; Motion Analysis' Cortex)."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.markers import Markers, differing, metres, to_markers, to_numbers
from footopt.files.reading import Unusable

Array = NDArray[np.float64]

RATE = 0.02  # relative, by which a stated frame rate may differ from the times, which are rounded


def read_trc(text: str) -> Markers:
    """Read markers from TRC: tabs, three columns a marker, any units.

    The header's third line holds the units; names stand over the first of a marker's columns.
    A cell that is empty, or a marker at exactly 0, 0, 0, is a gap. Programs that cut a walk out of a
    longer one often leave the header as it was: what it says of the numbers of frames and markers is noted
    where it differs.
    """
    lines = text.splitlines()
    at = next((i for i, line in enumerate(lines[:12]) if re.match(r"\s*frame#?\b", line, re.I)), None)
    if at is None or at < 1:
        raise Unusable("cannot be read as TRC (no line begins with Frame#).")
    stated = dict(zip(map(str.lower, _cells(lines[at - 2])), _cells(lines[at - 1]), strict=False))
    unit = metres(stated.get("units", ""))
    names = [cell for cell in _cells(lines[at])[2:] if cell]
    rows = [(i, _cells(line)) for i, line in enumerate(lines[at + 2 :], start=at + 3) if line.strip()]
    if not rows or not names:
        raise Unusable("cannot be read as TRC (it holds no markers).")
    try:
        table = to_numbers(((i, cells[1:]) for i, cells in rows), 1 + 3 * len(names), gaps=True)
        _check_rate(table[:, 0], stated.get("datarate", ""))
    except ValueError as error:
        raise Unusable(f"cannot be read as TRC ({error}).") from None
    notes = differing(
        [("frames", stated.get("numframes"), len(rows)), ("markers", stated.get("nummarkers"), len(names))]
    )
    return to_markers(table[:, 0], names, unit * table[:, 1:].reshape(len(rows), -1, 3), notes)


def _cells(line: str) -> list[str]:
    """Cells of a line with tabs, or else spaces, between them."""
    return [cell.strip() for cell in line.rstrip("\t\r\n").split("\t")] if "\t" in line else line.split()


def _check_rate(t: Array, stated: str) -> None:
    """Raise unless the times are those of the frame rate that a header states."""
    try:
        rate, own = float(stated), (len(t) - 1) / float(t[-1] - t[0])
    except (ValueError, ZeroDivisionError):  # not stated, or times that are refused later
        return
    if not (rate > 0 and abs(own / rate - 1.0) < RATE):
        raise ValueError(f"its header says {rate:g} frames a second, and its times {own:.4g}: must be in s")
