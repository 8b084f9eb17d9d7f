"""Gaits from files, as plain data: coefficients (JSON), angles (CSV, MOT, STO) or markers (TRC, C3D, CSV)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from footopt.errors import SettingError, check
from footopt.files.gaits.angles import read_csv
from footopt.files.gaits.captures import holds_markers, read_capture
from footopt.files.gaits.coefficients import Coefficients, read_json
from footopt.files.gaits.markers import to_recording
from footopt.files.gaits.motion import read_c3d, read_mot, read_trc
from footopt.files.gaits.strides import Strides, average, check_angles, check_period, cut, wrong

__all__ = [
    "Coefficients",
    "Strides",
    "average",
    "check_angles",
    "check_period",
    "read_json",
    "read_strides",
    "wrong",
]

MARKERS = {".trc": read_trc, ".c3d": read_c3d, ".csv": read_capture}
ENDINGS = (".json", ".csv", ".trc", ".mot", ".sto", ".c3d")


def read_strides(
    path: str | Path,
    names: Mapping[str, str] | None = None,
    side: str | None = None,
    max_gap: float = 0.2,
) -> Strides:
    """The strides in a file of angles or markers.

    Parameters
    ----------
    names : the file's own names of markers (hip, knee, ankle, heel, toe) or of columns.
    side : "right" or "left" leg; None: the right one, or the left one if it is the only one.
    max_gap : longest gap of a marker that is filled, s.

    Raises
    ------
    FileError : the file cannot be read, or does not hold a walk.
    SettingError : one of the settings above cannot be used.
    """
    check(side in (None, "right", "left"), "gait.side", side, "right, left or null")
    check(max_gap >= 0, "gait.max_gap", max_gap, "a time >= 0, in s")
    names, suffix = names or {}, Path(path).suffix.lower()
    if suffix in (".mot", ".sto"):
        return cut(read_mot(path, names, side), path)
    if suffix == ".csv" and not holds_markers(path):
        return cut(read_csv(path, names), path)
    if suffix in MARKERS:
        return cut(to_recording(MARKERS[suffix](path), path, names, side, max_gap), path)
    raise SettingError(
        "gait.path", str(path), f"a file that ends in {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}"
    )
