"""Angles from OpenSim's MOT and STO files."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import Recording, climbing, recording, to_degrees
from footopt.files.gaits.markers import differing, to_numbers
from footopt.files.gaits.trc import cells_of
from footopt.files.reading import Unusable

Array = NDArray[np.float64]

SIDES = ("right", "left")


def read_mot(text: str, names: Mapping[str, str], side: str | None, units: str | None = None) -> Recording:
    """Read the columns pelvis_tilt, hip_flexion_r, knee_angle_r and ankle_angle_r.

    thigh = pelvis tilt + hip flexion, foot = thigh - knee + ankle. Models differ in the sign of the
    knee: it is taken so that the knee bends. Of columns that have one name the first is read, unless they
    differ.
    """
    head, columns, notes = _columns(text)

    def find(what: str, usual: str) -> Array | None:
        # OpenSim 4 writes whole paths: /jointset/knee_r/knee_angle_r/value, and .../speed beside it
        own = names.get(what)
        found = {
            name: values
            for name, values in columns.items()
            if (name == own if own else usual in (parts := name.lower().split("/")) and parts[-1] != "speed")
        }
        name = next(iter(found), None)
        if name is not None and any(not np.array_equal(found[name][0], v) for v in found[name][1:]):
            raise Unusable(f"two columns are called {name!r}, with other values. Which one is it?")
        return None if name is None else found[name][0]

    def need(what: str, usual: str) -> Array:
        if (column := find(what, usual)) is None:
            raise Unusable(
                f"no column for the {what}; looked for {names.get(what, usual)}, the file has "
                f"{', '.join(columns)}. Name it with gait.names.{what}=..."
            )
        return column

    def rows_of(leg: str) -> Array:
        hip, knee = need("hip", f"hip_flexion_{leg[0]}"), need("knee", f"knee_angle_{leg[0]}")
        flexion = to_deg * knee * (1.0 if abs(np.max(knee)) >= abs(np.min(knee)) else -1.0)
        thigh = to_deg * (hip + (0.0 if tilt is None else tilt))
        bend = find("ankle", f"ankle_angle_{leg[0]}")
        return np.array([time, thigh, flexion, *([] if bend is None else [thigh - flexion + to_deg * bend])])

    leg = side or next((s for s in SIDES if find("hip", f"hip_flexion_{s[0]}") is not None), "right")
    time, tilt, height = need("time", "time"), find("pelvis", "pelvis_tilt"), find("height", "pelvis_ty")
    stated = re.search(r"indegrees\s*=\s*(\w+)", head)
    if stated and stated[1] not in ("yes", "no") and units is None:
        raise Unusable(f"cannot be read as MOT/STO (inDegrees must be yes or no, and is {stated[1]}).")
    need("hip", f"hip_flexion_{leg[0]}")
    radians = stated[1] == "no" if stated else np.ptp(need("knee", f"knee_angle_{leg[0]}")) < np.pi
    to_deg = to_degrees(units or ("rad" if radians else "deg"))
    notes += (f"the {leg} leg; angles in {'deg' if to_deg == 1.0 else 'rad'}",)
    if tilt is None:
        notes += ("no pelvis_tilt: the pelvis is taken to be level",)
    own = recording(rows_of(leg), notes + (() if height is None else climbing(height)))
    try:
        other = recording(rows_of(SIDES[leg == "right"])) if not names.keys() & {"hip", "knee"} else None
    except Unusable:  # it is wanted for a check only
        other = None
    return own._replace(other=other)


def _columns(text: str) -> tuple[str, dict[str, list[Array]], tuple[str, ...]]:
    """The header in lower case, the columns of each name, and notes."""
    lines = text.splitlines()
    end = next((i for i, line in enumerate(lines) if line.strip().lower() == "endheader"), None)
    rows = [] if end is None else [(i, cells_of(line)) for i, line in enumerate(lines, 1) if i > end + 1]
    rows = [(i, cells) for i, cells in rows if any(cells)]
    if end is None or len(rows) < 2:
        raise Unusable("cannot be read as MOT/STO (no line says endheader, or nothing is after it).")
    (_, names), *rows = rows
    try:
        # an empty cell matters only in a column that is read
        table = to_numbers(rows, len(names), gaps=any("" in cells for _, cells in rows))
    except ValueError as error:
        raise Unusable(f"cannot be read as MOT/STO ({error}).") from None
    head = "\n".join(lines[:end]).lower()
    counts = {"nrows": len(rows), "ncolumns": len(names)}
    stated = {key: re.search(rf"^\s*{key}\s*=\s*(\S+)", head, re.M) for key in counts}
    notes = differing((key[1:], (found := stated[key]) and found[1], n) for key, n in counts.items())
    columns: dict[str, list[Array]] = {}
    for name, values in zip(names, table.T, strict=True):
        columns.setdefault(name, []).append(values)
    return head, columns, notes
