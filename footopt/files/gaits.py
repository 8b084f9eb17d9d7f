"""Gaits from files of a leg's angles: CSV, and OpenSim's MOT and STO."""

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array
from footopt.errors import Unusable, check, check_whole, naming
from footopt.files import io
from footopt.files.strides import Strides, cut
from footopt.gait import HARMONICS, JOINTS, Fourier, Gait

#: Columns by part, in small letters without punctuation; the side may stand before or after.
COLUMNS = {
    "time": r"t|times?|seconds|timestamps?",
    "percent": r"percent|phase|%|%?(gait)?cycle%?",
    "thigh": r"thigh(angle)?",
    "hip": r"q?hip(flex(ion)?)?(angle)?",
    "knee": r"q?knee(flex(ion)?)?(angle)?",
    "foot": r"foot(angle|pitch)?",
    "ankle": r"q?ankle(flex(ion)?)?(angle)?",
    "pelvis": r"pelvistilt",
}
SIDES = ("right", "left")
UNIT = re.compile(r"(deg|(?<!g)rad)(rees|ians)?\W*$")  # at the end of a column's name
PHASE_PERIOD = 1.2  # s; of a stride whose table has its phase only


def read_gait(
    path: str | Path,
    harmonics: int | None = None,
    names: Mapping[str, str] | None = None,
    side: str | None = None,
    window: tuple[float, float] | None = None,
) -> Gait:
    """Read the gait in a file of a leg's angles (CSV, MOT, STO).

    Parameters
    ----------
    path : str or Path
        The file; its ending says which format it has.
    harmonics : int, optional
        Harmonics of the series; by default 6.
    names : mapping, optional
        The file's own names of columns (time, thigh, hip, knee, foot, ankle, pelvis).
    side : str, optional
        "right" or "left" leg; by default the right one, or the left one if it is the only one.
    window : (float, float), optional, s
        The stride, from a heel strike to the next of the same leg; by default the mean of all strides, of
        which the period is found.

    Raises
    ------
    FileError
        The file cannot be read, or does not hold a walk.
    SettingError
        Another argument cannot be used.
    """
    strides = read_strides(path, names, side, window)
    with naming(path, "gait.path"):
        return replace(_fit(strides, harmonics), name=Path(path).stem, source=str(path))


def fit_gait(
    times: ArrayLike,
    thigh: ArrayLike,
    knee: ArrayLike,
    foot: ArrayLike | None = None,
    harmonics: int | None = None,
) -> Gait:
    """Fit a gait to a leg's angles over time: one stride from heel strike to heel strike, or several.

    Parameters
    ----------
    times : (n,), s
        Increasing.
    thigh : (n,), deg
        From the vertical, + knee ahead of the hip.
    knee : (n,), deg
        Flexion.
    foot : (n,), deg, optional
        Pitch of the foot, + toe up.
    harmonics : int, optional
        Harmonics of the series; by default 6.

    Raises
    ------
    SettingError
        There are not as many angles as times.
    FileError
        They are no walk.
    """
    rows = [np.asarray(row, float) for row in (times, thigh, knee, *([] if foot is None else [foot]))]
    shapes = [row.shape for row in rows]
    check(shapes == [(rows[0].size or 1,)] * len(rows), "angles", shapes, "as many angles as times")
    with naming("angles", "gait"):
        strides = cut(rows[0], dict(zip(JOINTS, rows[1:], strict=False)))
        if _unit(*rows[1:3]) == "rad":
            raise Unusable("the leg hardly moves: angles are in degrees. Try np.degrees.")
        return _fit(strides, harmonics)


def read_strides(
    path: str | Path,
    names: Mapping[str, str] | None = None,
    side: str | None = None,
    window: tuple[float, float] | None = None,
) -> Strides:
    """Read the strides in a file of angles (CSV, MOT, STO); arguments and errors as of `read_gait`."""
    suffix = Path(path).suffix.lower()
    check(side in (None, *SIDES), "gait.side", side, "right, left or null")
    if window is not None:
        ordered = len(window) == 2 and window[0] < window[1]
        check(ordered, "gait.window", list(window), "two times in s, the second one after the first, or null")
    with naming(path, "gait.path"):
        allowed = "a file of joint angles, .csv, .mot or .sto; from markers inverse kinematics gives them"
        check(suffix in (".csv", ".mot", ".sto"), "gait.path", str(path), allowed)
        text = io.read_text(path, "gait.path")
        table = io.parse_table(text if suffix == ".csv" else text.partition("endheader")[2])
        t, angles, whole, notes = _leg(table, names or {}, side)
        check(window is None or whole is None, "gait.window", window, "null for a stride by its phase")
        return cut(t, angles, whole or window, notes)


def _fit(strides: Strides, harmonics: int | None) -> Gait:
    """The gait fitted to the mean of some strides; its residual is against that mean, as measured."""
    harmonics = HARMONICS if harmonics is None else harmonics
    check_whole("gait.harmonics", harmonics, 1, 1000)
    if len(strides.phase) < 2 * harmonics + 2:
        raise Unusable(f"needs at least {2 * harmonics + 2} rows of a stride for {harmonics} harmonics.")
    series: dict[str, Any] = {}
    residual = []
    for joint, mean in strides.mean().items():  # whose last point is the first one again
        series[joint] = Fourier.fit(strides.phase[:-1], mean[:-1], harmonics)
        misfit = np.degrees(series[joint].at(strides.phase)[0]) - strides.curves[joint].mean(axis=0)
        residual.append((joint, float(np.sqrt(np.mean(misfit**2)))))
    return Gait(**series, period=float(strides.periods.mean()), residual=tuple(residual))


def _leg(
    table: io.Table, names: Mapping[str, str], side: str | None
) -> tuple[Array, dict[str, Array], tuple[float, float] | None, tuple[str, ...]]:
    """Times (s), angles (deg) of a leg, the window of a stride that is given by its phase, and notes.

    thigh = hip flexion + pelvis tilt, foot = thigh - knee + ankle. Models differ in the sign of the knee:
    it is taken so that it bends.
    """

    def column(part: str, leg: str) -> str | None:
        if part in names:
            check(names[part] in table, f"gait.names.{part}", names[part], "the name of a column")
            return names[part]
        own, bare = f"({leg[0]}|{leg})", f"({COLUMNS[part]})"
        forms = own + bare, bare + own, bare
        return next((name for form in forms for name in table if re.fullmatch(form, _plain(name))), None)

    leg = side or next((s for s in SIDES if column("knee", s)), SIDES[0])
    sided = any(column(part, "left") != column(part, "right") for part in COLUMNS)
    check(sided or side is None, "gait.side", side, "null: no column names a side")
    found = {part: name for part in COLUMNS if (name := column(part, leg))}
    for part, also in (("time", "percent"), ("thigh", "hip"), ("knee", "knee")):
        if not {part, also} & found.keys():
            raise Unusable(
                f"no column for the {part}{f' or the {also}' if also != part else ''}; the file has "
                f"{', '.join(filter(None, table))[:200]}. Name it with gait.names.{part}=..."
            )
    read = {part: io.numbers(table, name) for part, name in found.items()}
    if len(read["knee"]) < 4:
        raise Unusable(f"has {len(read['knee'])} rows, and a stride needs more.")
    leading = "thigh" if "thigh" in read else "hip"
    units = {part: match[1] for part, name in found.items() if (match := UNIT.search(name.lower()))}
    unit = next(iter(units.values()), _unit(read[leading], read["knee"]))  # of columns that state none
    for part in found.keys() - {"time", "percent"}:
        read[part] = np.degrees(read[part]) if units.get(part, unit) == "rad" else read[part]
    if _unit(read[leading], read["knee"]) == "rad":
        raise Unusable(f"the leg hardly moves, with {found[leading]} and {found['knee']} in {unit}.")
    knee, notes = read["knee"], [f"the {leg} leg; angles in {unit}"]
    if abs(np.max(knee)) < abs(np.min(knee)):
        knee = -knee
        notes.append(f"{found['knee']} is below 0 where the knee bends, and is turned round")
    if "thigh" in read:
        angles = {"thigh": read["thigh"], "knee": knee} | ({"foot": read["foot"]} if "foot" in read else {})
    else:
        angles = {"thigh": read["hip"] + read.get("pelvis", 0.0), "knee": knee}
        if "ankle" in read:
            angles["foot"] = angles["thigh"] - knee + read["ankle"]
        tilt = f"{found['pelvis']} is added to it, + backwards as in OpenSim" if "pelvis" in read else "level"
        notes.append(f"the thigh is {found['hip']} from the pelvis; pelvis: {tilt}")
    if "time" in read:
        return read["time"], angles, None, tuple(notes)
    share = read["percent"] / (100.0 if read["percent"].max() > 2.0 else 1.0)
    if not share[0] + 1.0 - 2.0 * np.diff(share).max() <= share[-1] <= share[0] + 1.0 + 1e-6:
        low, high = read["percent"][[0, -1]]
        raise Unusable(f"is not one whole stride: its phase, in percent or to 1, is {low:g} to {high:g}.")
    t = PHASE_PERIOD * (share if -1e-6 < share[0] and share[-1] < 1.0 + 1e-6 else share - share[0])
    before = t[:1] > 1e-6 * PHASE_PERIOD  # the last row comes before the first one, too
    after = t[-1:] < (1.0 - 1e-6) * PHASE_PERIOD  # and the first one after the last
    t = np.concatenate([t[-1:][before] - PHASE_PERIOD, t, t[:1][after] + PHASE_PERIOD])
    angles = {joint: np.concatenate([v[-1:][before], v, v[:1][after]]) for joint, v in angles.items()}
    note = f"{found['percent']} is the phase of one stride, of {PHASE_PERIOD:g} s without gait.period"
    return t, angles, (0.0, PHASE_PERIOD), (*notes, note)


def _unit(*angles: Array) -> str:
    """Whether a leg's angles are in "rad" or "deg": in a walk some part turns by more than 3.1 degrees."""
    return "rad" if max(map(np.ptp, angles)) < np.pi else "deg"


def _plain(name: str) -> str:
    """A column's name in small letters, without punctuation, its unit, and the path of an OpenSim state."""
    parts = [part for part in name.lower().split("/") if part != "value"]
    plain = re.sub(r"\(.*?\)|\[.*?\]|[^a-z0-9%]", "", parts[-1] if parts else "")
    return re.sub(r"(ipsi(lateral)?)?((deg|rad)(rees|ians)?)?$", "", plain)
