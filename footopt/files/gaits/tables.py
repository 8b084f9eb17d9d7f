"""Angles over time from tables: OpenSim's MOT and STO files, and CSV."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.columns import columns_of, header_of, to_numbers
from footopt.files.gaits.angles import LIMITS, Recording, climbing, recording
from footopt.files.gaits.markers import differing
from footopt.files.gaits.trc import cells_of
from footopt.files.io import Unusable

Array = NDArray[np.float64]

SIDES = ("right", "left")
#: Columns of OpenSim's models before the side, of gait2392 first, then of Lenhart's and others.
USUAL = {
    "hip": ("hip_flexion", "hip_flex"),
    "knee": ("knee_angle", "knee_flexion", "knee_flex"),
    "ankle": ("ankle_angle", "ankle_flexion", "ankle_flex"),
}
#: Columns of CSV files by part, as `_plain` has them; the side, right or r, may stand before or after.
CSV = {
    "time": ("time", "t", "times", "timesec", "seconds", "timestamp", "timestamps"),
    "percent": ("percent", "%", "phase", "cycle", "gaitcycle", "%gaitcycle", "gaitcycle%"),
    "thigh": ("thigh", "thighangle"),
    "hip": ("hipflexion", "hipflex", "hipangle", "hipflexionangle", "hip", "qhip"),
    "knee": ("knee", "kneeangle", "kneeflexion", "kneeflex", "kneeflexionangle", "qknee"),
    "foot": ("foot", "footangle", "footpitch"),
    "ankle": ("ankleangle", "ankleflexion", "ankleflex", "ankleflexionangle", "ankle", "qankle"),
    "pelvis": ("pelvistilt",),
}
SHOWN = {  # in a message
    "time": "time, or a phase in percent",
    "thigh": "thigh, or hip_flexion and hip_angle from the pelvis",
    "knee": "knee, knee_angle, knee_flexion",
}
LEVEL = "no pelvis_tilt: the pelvis is taken to be level"
TILTED = "{} is added to it, positive backwards as in OpenSim (forwards in Plug-in Gait)"
UNTIMED = 1.2  # s; of a stride whose table has its phase only, as of the paper's


def read_csv(
    text: str, names: Mapping[str, str], side: str | None = None, units: str | None = None
) -> Recording:
    """Read the angles of a leg (`CSV`, signs: `Recording`), in s and deg unless a column's name says rad.

    A thigh is from the vertical; of a hip's flexion it is found as in a MOT file. The time may be in % of a
    stride. The table holds one stride from heel strike to heel strike, or several strides; `names` are its
    own names of these columns, where they differ.
    """
    header = header_of(text)
    plain = {_plain(name): name for name in reversed(header)}

    def named(part: str, leg: str) -> str | None:
        if own := names.get(part):
            return own if own in header else None
        sides = (leg[0], leg, "") if part in (*LIMITS, *USUAL) else ("",)
        usual = (f"{a}{name}{b}" for s in sides for name in CSV[part] for a, b in ((s, ""), ("", s)))
        return next((plain[name] for name in usual if name in plain), None)

    def leg_of(leg: str) -> Recording:
        found = {part: name for part in CSV if (name := named(part, leg))}
        for part, also in (("time", "percent"), ("thigh", "hip"), ("knee", "knee")):
            if not {part, also} & found.keys():
                raise Unusable(_lacks(header, part, names.get(part, SHOWN[part])))
        columns, _ = columns_of(text, dict.fromkeys(found.values(), ""))
        read = {part: columns[name] for part, name in found.items()}
        if not len(read["knee"]):
            raise Unusable("there is no row of numbers below the names of its columns.")
        knee, notes = _bent(read["knee"]), tuple[str, ...]()
        if knee is not read["knee"]:
            notes += (f"{found['knee']} is below 0 where the knee bends, and is turned round",)
        if "thigh" in read:
            angles = [read["thigh"], knee, *([read["foot"]] if "foot" in read else [])]
        else:
            angles = _put_together(read["hip"], knee, read.get("pelvis"), read.get("ankle"))
            tilt = TILTED.format(found["pelvis"]) if "pelvis" in read else LEVEL
            notes += (f"the thigh is {found['hip']} from the pelvis", tilt)
        stride = None
        if "time" in read:
            time = read["time"]
        else:
            time, more = _of_percent(read["percent"], found["percent"])
            stride, notes = UNTIMED if np.ptp(time) < 1.1 * UNTIMED else None, (*notes, more)
        unit = units or ("rad" if "rad" in found["knee"].lower() else "deg")
        rows = np.array([time, *angles])
        # at 100 % the stride is where it was at 0 %
        whole = stride is not None and np.ptp(time) > (1.0 - 1e-6) * UNTIMED
        rows = rows[:, time < time[0] + (1.0 - 1e-6) * UNTIMED] if whole else rows
        return recording(rows, notes, unit)._replace(stride=stride)

    leg = side or next((s for s in SIDES if named("knee", s)), "right")
    own, second = leg_of(leg), SIDES[leg == "right"]
    if names.keys() & {"hip", "knee", "thigh"} or named("knee", second) == named("knee", leg):
        return own
    try:
        return own._replace(other=leg_of(second))
    except Unusable:  # it is wanted for a check only
        return own


def _lacks(header: list[str], part: str, usual: str) -> str:
    """What is said of a table whose header has no column for a part."""
    if any(re.fullmatch(r"[-+\d.e]+", name) for name in header):
        return (
            "the first line must name the columns, such as time, thigh, knee (s, deg, deg), and has numbers."
        )
    said = f"no column for the {part}; looked for {usual}; the file has {', '.join(filter(None, header))}. "
    if sum(_plain(name)[-1:] in ("x", "y", "z") for name in header) > 2:
        return said + "Markers are read from TRC and C3D files, and CSV as Nexus and Motive write them."
    also = " (or gait.names.hip, if it is from the pelvis)" if part == "thigh" else ""
    return said + f"Name it with gait.names.{part}=...{also}"


def _plain(name: str) -> str:
    """A column's name in small letters, without its unit and punctuation, or that it is of this leg."""
    plain = re.sub(r"\(.*?\)|\[.*?\]|[^a-z0-9%]", "", name.lower())
    return re.sub(r"(ipsi(lateral)?)?((deg|rad)(rees|ians)?)?$", "", plain)


def _of_percent(share: Array, name: str) -> tuple[Array, str]:
    """Times, s, of a column in % of a stride, or in parts of one, and a note."""
    if len(share) > 1 and not (np.diff(share) > 0).all():
        row = int(np.argmin(np.diff(share) > 0)) + 1
        raise Unusable(f"{name} begins again after row {row} of the data: give one stride, of one subject.")
    whole, unit = (100.0, "%") if share.max() > 2.0 else (1.0, "part")
    note = f"{name} is taken for the {unit} of a stride, of {UNTIMED:g} s where gait.period is not given"
    return UNTIMED / whole * share, note


def _bent(knee: Array) -> Array:
    """A knee that bends above zero, because models differ in its sign."""
    return knee if abs(np.max(knee)) >= abs(np.min(knee)) else -knee


def _put_together(hip: Array, knee: Array, tilt: Array | None, ankle: Array | None) -> list[Array]:
    """Thigh, knee and perhaps the foot's pitch, of the angles between pelvis, thigh, shank and foot."""
    thigh = hip + (0.0 if tilt is None else tilt)
    return [thigh, knee, *([] if ankle is None else [thigh - knee + ankle])]


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
                f"{', '.join(name for name, _ in columns if name)}. Name it with gait.names.{what}=..."
            )
        return column

    time, tilt, height = need("time", "time"), find("pelvis", "pelvis_tilt"), find("height", "pelvis_ty")

    def usual_of(part: str, leg: str) -> list[str]:
        return [f"{name}_{leg[0]}" for name in USUAL[part]]

    def angles_of(leg: str) -> Array:
        hip, knee = (need(part, *usual_of(part, leg)) for part in ("hip", "knee"))
        return np.array(_put_together(hip, _bent(knee), tilt, find("ankle", *usual_of("ankle", leg))))

    leg = side or next((s for s in SIDES if find("hip", *usual_of("hip", s)) is not None), "right")
    angles, stated = angles_of(leg), re.search(r"indegrees\s*=\s*(\w+)", head)
    if stated and stated[1] not in ("yes", "no") and units is None:
        raise Unusable(f"cannot be read as MOT/STO (inDegrees must be yes or no, and is {stated[1]}).")
    radians = stated[1] == "no" if stated else np.ptp(angles[1]) < np.pi
    unit = units or ("rad" if radians else "deg")
    notes += (f"the {leg} leg; angles in {unit}",)
    if tilt is None:
        notes += (LEVEL,)
    notes += () if height is None else climbing(height)
    own = recording(np.array([time, *angles]), notes, unit)
    try:
        other = angles_of(SIDES[leg == "right"]) if not names.keys() & {"hip", "knee"} else None
        return own if other is None else own._replace(other=recording(np.array([time, *other]), (), unit))
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
