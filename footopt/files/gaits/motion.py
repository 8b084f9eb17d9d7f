"""Files of motion laboratories: markers (TRC, C3D) and angles (OpenSim's MOT and STO)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, SettingError
from footopt.files.gaits.c3d import load
from footopt.files.gaits.strides import Recording, wrong
from footopt.files.reading import number, read_table

Array = NDArray[np.float64]

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "dm": 0.1, "in": 0.0254, "inch": 0.0254, "inches": 0.0254}
FAR = 1e4  # m; no laboratory is so large
RATE = 0.02  # relative, that a frame rate may differ from the times, which are rounded
UNITS |= {"millimeters": 1e-3, "centimeters": 1e-2, "meters": 1.0}


@dataclass(frozen=True, eq=False)
class Markers:
    """Markers over time: t (n,), s; places by name, each (n, 3), m, NaN where a marker is not seen.

    `notes` say in words what of the file is odd.
    """

    t: Array
    places: dict[str, Array]
    notes: tuple[str, ...] = ()


def read_trc(path: str | Path) -> Markers:
    """Markers from TRC (OpenSim; Motion Analysis' Cortex): tabs, three columns a marker, any units.

    The header's third line holds the units; names stand over the first of a marker's columns.
    A cell that is empty, or a marker at exactly 0, 0, 0, is a gap. Programs that cut a walk out of a
    longer one often leave the header as it was: what it says of the numbers of frames and markers is noted
    where it differs.
    """
    lines = read_table(path, "gait", "gait.path").splitlines()
    at = next((i for i, line in enumerate(lines[:12]) if re.match(r"\s*frame#?\b", line, re.I)), None)
    if at is None or at < 1:
        raise not_a(path, "TRC", "no line begins with Frame#")
    words = dict(zip(map(str.lower, _cells(lines[at - 2])), _cells(lines[at - 1]), strict=False))
    unit = length_of(path, words.get("units", ""))
    names = [cell for cell in _cells(lines[at])[2:] if cell]
    rows = []
    wide = 1 + 3 * len(names)
    for row_number, line in enumerate(lines[at + 2 :], start=at + 3):
        cells = _cells(line)
        if not any(cells):
            continue
        try:
            row = [number(cell) if cell else np.nan for cell in cells[1:]]
        except ValueError:
            raise not_a(path, "TRC", f"line {row_number} is not numbers: {line[:60]!r}") from None
        if len(row) > wide and not np.isnan(row[wide:]).all():
            raise not_a(
                path, "TRC", f"line {row_number} has numbers for more than the {len(names)} markers named"
            )
        rows.append((row + [np.nan] * wide)[:wide])
    if not rows or not names:
        raise not_a(path, "TRC", "it holds no markers")
    held = (("frames", words.get("numframes"), len(rows)), ("markers", words.get("nummarkers"), len(names)))
    table = np.array(rows, float)
    _check_rate(path, table[:, 0], words.get("datarate", ""))
    places = unit * table[:, 1:].reshape(len(rows), -1, 3)
    return to_markers(path, table[:, 0], names, places, _differs(held))


def read_c3d(path: str | Path) -> Markers:
    """Markers from C3D, with the library ezc3d; one whose residual is negative is not seen."""
    file = load(path)
    if not 0 < file.rate < np.inf:
        raise not_a(path, "C3D", f"it says {file.rate:g} frames a second")
    places = np.where((file.residuals >= 0)[..., None], file.places, np.nan)[:, : len(file.names)]
    times = (file.first + np.arange(len(places))) / file.rate
    return to_markers(path, times, file.names, length_of(path, file.unit) * places)


def read_mot(path: str | Path, names: Mapping[str, str], side: str | None) -> Recording:
    """Angles from OpenSim's MOT or STO: pelvis_tilt, hip_flexion_r, knee_angle_r, ankle_angle_r.

    thigh = pelvis tilt + hip flexion, foot = thigh - knee + ankle. Models differ in the sign of the
    knee: it is taken so that the knee bends.
    """
    lines = read_table(path, "gait", "gait.path").splitlines()
    end = next((i for i, line in enumerate(lines) if line.strip().lower() == "endheader"), None)
    if end is None or len(lines) < end + 3:
        raise not_a(path, "MOT/STO", "no line says endheader, or nothing is after it")
    head = "\n".join(lines[:end]).lower()
    rows = [line.split() for line in lines[end + 1 :] if line.strip()]
    counts = {"nrows": len(rows) - 1, "ncolumns": len(rows[0]) if rows else 0}
    held = [(key[1:], re.search(rf"^\s*{key}\s*=\s*(\S+)", head, re.M), n) for key, n in counts.items()]
    if rows and len(set(rows[0])) < len(rows[0]):
        raise not_a(path, "MOT/STO", "two columns have the same name")
    try:
        table = dict(zip(rows[0], np.array([list(map(number, row)) for row in rows[1:]]).T, strict=True))
    except ValueError as error:
        raise not_a(path, "MOT/STO", str(error)) from None

    def find(what: str, usual: str) -> str | None:
        # OpenSim 4 writes whole paths: /jointset/knee_r/knee_angle_r/value
        own = names.get(what)
        return next((c for c in table if (c == own if own else usual in c.lower().split("/"))), None)

    def need(what: str, usual: str) -> Array:
        name = find(what, usual)
        if name is None:
            raise wrong(
                path,
                f"no column for the {what}; looked for "
                f"{names.get(what, usual)}, the file has {', '.join(table)}. "
                f"Name it with gait.names.{what}=...",
            )
        return np.asarray(table[name])

    leg = side or next((s for s in ("right", "left") if find("hip", f"hip_flexion_{s[0]}")), "right")
    time, hip = need("time", "time"), need("hip", f"hip_flexion_{leg[0]}")
    knee = need("knee", f"knee_angle_{leg[0]}")
    tilt, bend = find("pelvis", "pelvis_tilt"), find("ankle", f"ankle_angle_{leg[0]}")
    said = re.search(r"indegrees\s*=\s*(\w+)", head)
    if said and said[1] not in ("yes", "no"):
        raise not_a(path, "MOT/STO", f"inDegrees must be yes or no, and is {said[1]}")
    radians = said[1] == "no" if said else bool(np.ptp(knee) < np.pi)
    to_deg = np.degrees(1.0) if radians else 1.0
    flexion = to_deg * knee * (1.0 if abs(np.max(knee)) >= abs(np.min(knee)) else -1.0)
    thigh = to_deg * (hip + (table[tilt] if tilt else 0.0))
    rows_out = [time, thigh, flexion]
    notes = [
        *_differs((things, found and found[1], n) for things, found, n in held),
        f"the {leg} leg; angles in {'rad' if radians else 'deg'}",
    ]
    if tilt is None:
        notes.append("no pelvis_tilt: the pelvis is taken to be level")
    if bend is not None:
        rows_out.append(thigh - flexion + to_deg * table[bend])
    return Recording.checked(path, np.array(rows_out), tuple(notes))


def _check_rate(path: str | Path, t: Array, said: str) -> None:
    """Raise unless the times are those of the frame rate that a header states."""
    try:
        rate, own = float(said), (len(t) - 1) / float(t[-1] - t[0])
    except (ValueError, ZeroDivisionError):  # not stated, or times that are refused later
        return
    if not (rate > 0 and abs(own / rate - 1.0) < RATE):
        raise not_a(
            path, "TRC", f"its header says {rate:g} frames a second, and its times {own:.4g}: must be in s"
        )


def _differs(held: Iterable[tuple[str, str | None, int]]) -> tuple[str, ...]:
    """A note for each count of things that a header states otherwise than it is."""
    return tuple(
        f"the header says {said} {things}, and there are {found}"
        for things, said, found in held
        if said not in (None, "", str(found))
    )


def to_markers(
    path: str | Path, t: Array, names: list[str], places: Array, notes: tuple[str, ...] = ()
) -> Markers:
    """Markers by name; at exactly 0, 0, 0 none is."""
    if twice := next((name for name in names if name and names.count(name) > 1), None):
        raise wrong(path, f"two markers are called {twice!r}. Which one is it?")
    if len(t) < 2 or not (np.isfinite(t).all() and (np.diff(t) > 0).all()):
        raise wrong(path, "needs several frames, with the time increasing.")
    if np.nanmax(abs(places), initial=0.0) > FAR:
        raise wrong(
            path, f"a marker lies {np.nanmax(abs(places)):.3g} m from the origin. Check it and the units."
        )
    places = np.where(np.all(places == 0.0, axis=-1, keepdims=True), np.nan, places)
    return Markers(t, {name: places[:, i] for i, name in enumerate(names[: places.shape[1]])}, notes)


def _cells(line: str) -> list[str]:
    """Cells of a line with tabs, or else spaces, between them."""
    return [cell.strip() for cell in line.rstrip("\t\r\n").split("\t")] if "\t" in line else line.split()


def length_of(path: str | Path, unit: str) -> float:
    """A unit of length that a file states, m."""
    if unit.strip().lower() not in UNITS:
        raise SettingError(
            "gait.path", str(path), f"a file whose units are one of {', '.join(UNITS)}", f"It says {unit!r}."
        )
    return UNITS[unit.strip().lower()]


def not_a(path: str | Path, kind: str, why: str) -> FileError:
    """What to say of a file that its ending promises something else of."""
    return wrong(path, f"cannot be read as {kind} ({why}).")
