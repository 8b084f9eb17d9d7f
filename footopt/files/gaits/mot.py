"""Angles from OpenSim's MOT and STO files."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import Recording, recording
from footopt.files.gaits.markers import differing, to_numbers
from footopt.files.reading import Unusable

Array = NDArray[np.float64]


def read_mot(text: str, names: Mapping[str, str], side: str | None) -> Recording:
    """Read the columns pelvis_tilt, hip_flexion_r, knee_angle_r and ankle_angle_r.

    thigh = pelvis tilt + hip flexion, foot = thigh - knee + ankle. Models differ in the sign of the
    knee: it is taken so that the knee bends.
    """
    head, table, notes = _columns(text)

    def find(what: str, usual: str) -> Array | None:
        # OpenSim 4 writes whole paths: /jointset/knee_r/knee_angle_r/value
        own = names.get(what)
        return next((table[c] for c in table if (c == own if own else usual in c.lower().split("/"))), None)

    def need(what: str, usual: str) -> Array:
        if (column := find(what, usual)) is None:
            raise Unusable(
                f"no column for the {what}; looked for {names.get(what, usual)}, the file has "
                f"{', '.join(table)}. Name it with gait.names.{what}=..."
            )
        return column

    leg = side or next(
        (s for s in ("right", "left") if find("hip", f"hip_flexion_{s[0]}") is not None), "right"
    )
    time, hip = need("time", "time"), need("hip", f"hip_flexion_{leg[0]}")
    knee = need("knee", f"knee_angle_{leg[0]}")
    tilt, bend = find("pelvis", "pelvis_tilt"), find("ankle", f"ankle_angle_{leg[0]}")
    stated = re.search(r"indegrees\s*=\s*(\w+)", head)
    if stated and stated[1] not in ("yes", "no"):
        raise Unusable(f"cannot be read as MOT/STO (inDegrees must be yes or no, and is {stated[1]}).")
    radians = stated[1] == "no" if stated else bool(np.ptp(knee) < np.pi)
    to_deg = np.degrees(1.0) if radians else 1.0
    flexion = to_deg * knee * (1.0 if abs(np.max(knee)) >= abs(np.min(knee)) else -1.0)
    thigh = to_deg * (hip + (0.0 if tilt is None else tilt))
    foot = [] if bend is None else [thigh - flexion + to_deg * bend]
    notes += (f"the {leg} leg; angles in {'rad' if radians else 'deg'}",)
    if tilt is None:
        notes += ("no pelvis_tilt: the pelvis is taken to be level",)
    return recording(np.array([time, thigh, flexion, *foot]), notes)


def _columns(text: str) -> tuple[str, dict[str, Array], tuple[str, ...]]:
    """The header in lower case, the columns by name, and notes."""
    lines = text.splitlines()
    end = next((i for i, line in enumerate(lines) if line.strip().lower() == "endheader"), None)
    rows = [] if end is None else [(i, line.split()) for i, line in enumerate(lines, 1) if i > end + 1]
    rows = [(i, cells) for i, cells in rows if cells]
    if end is None or len(rows) < 2:
        raise Unusable("cannot be read as MOT/STO (no line says endheader, or nothing is after it).")
    (_, names), *rows = rows
    if len(set(names)) < len(names):
        raise Unusable("cannot be read as MOT/STO (two columns have the same name).")
    try:
        table = to_numbers(rows, len(names), gaps=False)
    except ValueError as error:
        raise Unusable(f"cannot be read as MOT/STO ({error}).") from None
    head = "\n".join(lines[:end]).lower()
    counts = {"nrows": len(rows), "ncolumns": len(names)}
    stated = {key: re.search(rf"^\s*{key}\s*=\s*(\S+)", head, re.M) for key in counts}
    notes = differing((key[1:], (found := stated[key]) and found[1], n) for key, n in counts.items())
    return head, dict(zip(names, table.T, strict=True)), notes
