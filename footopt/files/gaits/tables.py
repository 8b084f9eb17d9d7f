"""Angles over time from tables: OpenSim's MOT and STO files, and CSV."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.columns import columns_of, to_numbers
from footopt.files.gaits.angles import Recording, climbing, recording, to_degrees
from footopt.files.gaits.markers import differing
from footopt.files.gaits.trc import cells_of
from footopt.files.reading import Unusable

Array = NDArray[np.float64]

SIDES = ("right", "left")
#: Columns of OpenSim's models before the side, of gait2392 first, then of Lenhart's and others.
USUAL = {
    "hip": ("hip_flexion", "hip_flex"),
    "knee": ("knee_angle", "knee_flexion", "knee_flex"),
    "ankle": ("ankle_angle", "ankle_flexion", "ankle_flex"),
}


def read_csv(text: str, names: Mapping[str, str], units: str | None = None) -> Recording:
    """Read columns ``time`` (s), ``thigh``, ``knee`` and, optionally, ``foot`` (signs: `Recording`).

    Angles are in deg unless `units` is "rad".

    The table holds one stride from heel strike to heel strike, or several strides; `names` are its own names
    of these columns, where they differ.
    """
    own = [names.get(column, column) for column in ("time", "thigh", "knee", "foot")]
    found, _ = columns_of(text, dict(zip(own, ("s", "deg", "deg"), strict=False)), own[3:])
    rows = np.array([found[name] for name in own if name in found])
    rows[1:] *= to_degrees(units or "deg")
    return recording(rows)


def read_mot(text: str, names: Mapping[str, str], side: str | None, units: str | None = None) -> Recording:
    """Read the columns pelvis_tilt, hip_flexion_r, knee_angle_r and ankle_angle_r.

    thigh = pelvis tilt + hip flexion, foot = thigh - knee + ankle. Models differ in the sign of the
    knee: it is taken so that the knee bends. Of columns that have one name the first is read, unless they
    differ.
    """
    head, columns, notes = _columns(text)

    def find(what: str, *usual: str) -> Array | None:
        # OpenSim 4 writes whole paths: /jointset/knee_r/knee_angle_r/value, and .../speed beside it
        own = names.get(what)
        found = [
            (name, values)
            for name, values in columns
            if (
                name == own
                if own
                else {*usual} & {*(parts := name.lower().split("/"))} and parts[-1] != "speed"
            )
        ]
        same = [values for name, values in found if name == found[0][0]]
        if any(not np.array_equal(same[0], values) for values in same[1:]):
            raise Unusable(f"two columns are called {found[0][0]!r}, with other values. Which one is it?")
        return same[0] if same else None

    def need(what: str, *usual: str) -> Array:
        if (column := find(what, *usual)) is None:
            if all(re.search("time|force|torque|moment", name) for name, _ in columns):
                raise Unusable("holds no angles, and forces alone are no gait.")
            raise Unusable(
                f"no column for the {what}; looked for {names.get(what, ', '.join(usual))}, the file has "
                f"{', '.join(name for name, _ in columns)}. Name it with gait.names.{what}=..."
            )
        return column

    time, tilt, height = need("time", "time"), find("pelvis", "pelvis_tilt"), find("height", "pelvis_ty")

    def usual_of(part: str, leg: str) -> list[str]:
        return [f"{name}_{leg[0]}" for name in USUAL[part]]

    def angles_of(leg: str) -> Array:
        hip, knee = (need(part, *usual_of(part, leg)) for part in ("hip", "knee"))
        flexion = knee if abs(np.max(knee)) >= abs(np.min(knee)) else -knee
        thigh, bend = hip + (0.0 if tilt is None else tilt), find("ankle", *usual_of("ankle", leg))
        return np.array([thigh, flexion, *([] if bend is None else [thigh - flexion + bend])])

    leg = side or next((s for s in SIDES if find("hip", *usual_of("hip", s)) is not None), "right")
    angles, stated = angles_of(leg), re.search(r"indegrees\s*=\s*(\w+)", head)
    if stated and stated[1] not in ("yes", "no") and units is None:
        raise Unusable(f"cannot be read as MOT/STO (inDegrees must be yes or no, and is {stated[1]}).")
    radians = stated[1] == "no" if stated else np.ptp(angles[1]) < np.pi
    to_deg = to_degrees(units or ("rad" if radians else "deg"))
    notes += (f"the {leg} leg; angles in {'deg' if to_deg == 1.0 else 'rad'}",)
    if tilt is None:
        notes += ("no pelvis_tilt: the pelvis is taken to be level",)
    own = recording(np.array([time, *to_deg * angles]), notes + (() if height is None else climbing(height)))
    try:
        other = angles_of(SIDES[leg == "right"]) if not names.keys() & {"hip", "knee"} else None
        return own if other is None else own._replace(other=recording(np.array([time, *to_deg * other])))
    except Unusable:  # it is wanted for a check only
        return own


def _columns(text: str) -> tuple[str, list[tuple[str, Array]], tuple[str, ...]]:
    """The header in lower case, the columns with their names, and notes."""
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
    return head, list(zip(names, table.T, strict=True)), notes
