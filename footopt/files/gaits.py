"""Gaits from files: a leg's angles (CSV, and OpenSim's MOT and STO), or Fourier series (JSON)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, check
from footopt.files import io
from footopt.files.io import Table, Unusable, naming, parse_table, read_json_file, read_text
from footopt.files.strides import Strides, cut

Array = NDArray[np.float64]
Series = tuple[float, tuple[float, ...], tuple[float, ...]]

MARKERS = (
    "holds markers, and footopt reads joint angles (CSV, MOT, STO), which inverse kinematics such as "
    "OpenSim's gives."
)
#: Columns by part, in small letters without punctuation; the side, right or r, may stand before or after.
COLUMNS = {
    "time": ("time", "t", "times", "seconds", "timestamp", "timestamps"),
    "percent": ("percent", "%", "phase", "cycle", "gaitcycle", "%gaitcycle", "gaitcycle%"),
    "thigh": ("thigh", "thighangle"),
    "hip": ("hipflexion", "hipflex", "hipangle", "hipflexionangle", "hip", "qhip"),
    "knee": ("kneeangle", "kneeflexion", "kneeflex", "kneeflexionangle", "knee", "qknee"),
    "foot": ("foot", "footangle", "footpitch"),
    "ankle": ("ankleangle", "ankleflexion", "ankleflex", "ankleflexionangle", "ankle", "qankle"),
    "pelvis": ("pelvistilt",),
}
SIDES = ("right", "left")
UNTIMED = 1.2  # s; of a stride whose table has its phase only


def read_strides(
    path: str | Path,
    names: Mapping[str, str] | None = None,
    side: str | None = None,
    units: str | None = None,
    window: tuple[float, float] | None = None,
) -> Strides:
    """The strides in a file of angles (CSV, MOT, STO).

    Its parameters and errors are those of `Gait.from_file`.
    """
    suffix = Path(path).suffix.lower()
    check(side in (None, *SIDES), "gait.side", side, "right, left or null")
    check(units in (None, "deg", "rad"), "gait.units", units, "deg, rad or null")
    if window is not None:
        ordered = len(window) == 2 and window[0] < window[1]
        check(ordered, "gait.window", list(window), "two times in s, the second one after the first, or null")
    with naming(path, "gait.path"):
        if suffix in (".trc", ".c3d"):
            raise Unusable(MARKERS)
        allowed = "a file that ends in .json, .csv, .mot or .sto"
        check(suffix in (".csv", ".mot", ".sto"), "gait.path", str(path), allowed)
        text, radians = read_text(path, "gait.path"), None
        if text.startswith(("Trajectories", "Format Version")):  # as Vicon Nexus and Motive begin
            raise Unusable(MARKERS)
        if suffix != ".csv":
            head, _, text = text.partition("endheader")
            stated = re.search(r"indegrees\s*=\s*(yes|no)", head, re.IGNORECASE)
            radians = stated[1].lower() == "no" if stated else None
        t, angles, whole, notes = _leg(parse_table(text), names or {}, side, units, radians)
        return cut(t, angles, whole or window, notes)._replace(source=str(path))


def _leg(
    table: Table, names: Mapping[str, str], side: str | None, units: str | None, radians: bool | None
) -> tuple[Array, dict[str, Array], tuple[float, float] | None, tuple[str, ...]]:
    """Times (s), angles (deg) of a leg, the window of a stride that is given by its phase, and notes.

    thigh = hip flexion + pelvis tilt, foot = thigh - knee + ankle. Models differ in the sign of the knee:
    it is taken so that it bends.
    """
    plain = {_plain(name): name for name in reversed(table.header)}

    def named(part: str, leg: str) -> str | None:
        if part in names:
            return names[part] if names[part] in table.header else None
        sides = ("",) if part in ("time", "percent", "pelvis") else (leg[0], leg, "")
        usual = (f"{a}{name}{b}" for s in sides for name in COLUMNS[part] for a, b in ((s, ""), ("", s)))
        return next((plain[name] for name in usual if name in plain), None)

    leg = side or next((s for s in SIDES if named("knee", s)), "right")
    found = {part: name for part in COLUMNS if (name := named(part, leg))}
    for part, also in (("time", "percent"), ("thigh", "hip"), ("knee", "knee")):
        if not {part, also} & found.keys():
            raise Unusable(
                f"no column for the {part}{f' or the {also}' if also != part else ''}; the file has "
                f"{', '.join(filter(None, table.header))[:200]}. Name it with gait.names.{part}=..."
            )
    read = {part: table.numbers(name) for part, name in found.items()}
    if len(read["knee"]) < 4:
        raise Unusable(f"has {len(read['knee'])} rows, and a stride needs more.")
    if radians is None:  # a knee that moves by less than pi degrees is in radians
        radians = "rad" in found["knee"].lower() or bool(np.ptp(read["knee"]) < np.pi)
    unit = units or ("rad" if radians else "deg")
    notes: tuple[str, ...] = (f"the {leg} leg; angles in {unit}",)
    knee = read["knee"]
    if abs(np.max(knee)) < abs(np.min(knee)):
        knee, notes = -knee, (*notes, f"{found['knee']} is below 0 where the knee bends, and is turned round")
    if "thigh" in read:
        angles = {"thigh": read["thigh"], "knee": knee} | ({"foot": read["foot"]} if "foot" in read else {})
    else:
        angles = {"thigh": read["hip"] + read.get("pelvis", 0.0), "knee": knee}
        if "ankle" in read:
            angles["foot"] = angles["thigh"] - knee + read["ankle"]
        tilt = f"{found['pelvis']} is added to it, + backwards as in OpenSim" if "pelvis" in read else "level"
        notes += (f"the thigh is {found['hip']} from the pelvis; pelvis: {tilt}",)
    if unit == "rad":
        angles = {joint: np.degrees(values) for joint, values in angles.items()}
    if "time" in read:
        return read["time"], angles, None, notes
    share = read["percent"] / (100.0 if read["percent"].max() > 2.0 else 1.0)
    t = UNTIMED * (share - share[0])
    if t[-1] < (1.0 - 1e-6) * UNTIMED:  # the first row comes again at 100 %
        t, angles = np.append(t, UNTIMED), {joint: np.append(v, v[0]) for joint, v in angles.items()}
    said = f"{found['percent']} is the phase of one stride, of {UNTIMED:g} s where gait.period is not given"
    return t, angles, (0.0, UNTIMED), (*notes, said)


def _plain(name: str) -> str:
    """A column's name in small letters, without punctuation, its unit, and the path of an OpenSim state."""
    parts = [part for part in name.lower().split("/") if part != "value"]
    plain = re.sub(r"\(.*?\)|\[.*?\]|[^a-z0-9%]", "", parts[-1] if parts else "")
    return re.sub(r"(ipsi(lateral)?)?((deg|rad)(rees|ians)?)?$", "", plain)


class Coefficients(NamedTuple):
    """A gait in a JSON file.

    Parameters
    ----------
    series : dict of (float, tuple, tuple), deg
        Fourier coefficients a0, a and b by joint (thigh, knee and perhaps foot).
    period : float, s
        Duration of a stride.
    source : str
        Where the data come from.
    residual : dict of dict, deg
        By number of harmonics, as text, and joint: the rms misfit against what was measured.
    """

    series: Mapping[str, Series]
    period: float
    source: str
    residual: dict[str, dict[str, float]]


def read_json(path: str | Path) -> Coefficients:
    """Read ``period_s``, ``thigh``, ``knee`` and, optionally, ``foot``: each joint has ``a0`` and the lists
    ``a`` and ``b`` in degrees.

    Raises
    ------
    FileError
        The file cannot be read, or holds something else.
    """
    data = read_json_file(path, "gait.path")
    try:
        residual = data.get("rms_residual_deg_by_harmonics", {})
        return Coefficients(
            {n: _series(data[n]) for n in ("thigh", "knee", "foot") if n in data or n != "foot"},
            _finite(data["period_s"]),
            str(data.get("source", "")),
            {many: {joint: _finite(rms) for joint, rms in fit.items()} for many, fit in residual.items()},
        )
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise FileError(
            f"{io.named(path, 'gait.path')}: not a gait in JSON ({type(error).__name__}: {error}). It must "
            "hold period_s, and thigh and knee each with a0, a and b in degrees."
        ) from None


def write_json(path: str | Path, gait: Coefficients) -> None:
    """Write what `read_json` reads."""
    joints = {name: {"a0": a0, "a": a, "b": b} for name, (a0, a, b) in gait.series.items()}
    residual = {"rms_residual_deg_by_harmonics": gait.residual}
    io.write_json(Path(path), {"source": gait.source, "period_s": gait.period, **joints, **residual})


def _series(joint: Any) -> Series:
    a, b = (tuple(map(_finite, joint[terms])) for terms in ("a", "b"))
    if len(a) != len(b):
        raise ValueError(f"it has {len(a)} terms a and {len(b)} terms b")
    return _finite(joint["a0"]), a, b


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e12:
        raise ValueError(f"{str(value)[:40]} is not a finite number")
    return float(value)
