"""Gaits from files, as plain data: Fourier coefficients (JSON), or the strides in angles or markers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from footopt.errors import check
from footopt.files.gaits.angles import Recording, check_angles, check_period, recording
from footopt.files.gaits.c3d import read_c3d
from footopt.files.gaits.captures import holds_markers, read_capture
from footopt.files.gaits.coefficients import Coefficients, read_json, write_json
from footopt.files.gaits.leg import leg_angles
from footopt.files.gaits.mot import read_mot
from footopt.files.gaits.strides import Strides, average, cut
from footopt.files.gaits.table import read_csv
from footopt.files.gaits.trc import read_trc
from footopt.files.reading import naming, read_bytes, read_table

__all__ = [
    "Coefficients",
    "Strides",
    "average",
    "check_angles",
    "check_period",
    "cut",
    "read_json",
    "read_strides",
    "recording",
    "write_json",
]

ENDINGS = (".json", ".csv", ".trc", ".mot", ".sto", ".c3d")


def read_strides(
    path: str | Path,
    names: Mapping[str, str] | None = None,
    side: str | None = None,
    max_gap: float = 0.2,
) -> Strides:
    """The strides in a file of angles (CSV, MOT, STO) or markers (TRC, C3D, CSV).

    Its parameters and errors are those of `Gait.from_file`.
    """
    suffix = Path(path).suffix.lower()
    check(side in (None, "right", "left"), "gait.side", side, "right, left or null")
    check(max_gap >= 0, "gait.max_gap", max_gap, "a time >= 0, in s")
    allowed = f"a file that ends in {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}"
    check(suffix in ENDINGS[1:], "gait.path", str(path), allowed)

    def read(names: Mapping[str, str]) -> Recording:
        if suffix == ".c3d":
            content = read_bytes(path, "gait", "gait.path")
            return leg_angles(read_c3d(path, content), names, side, max_gap)
        text = read_table(path, "gait", "gait.path")
        if suffix in (".mot", ".sto"):
            return read_mot(text, names, side)
        if suffix == ".csv" and not holds_markers(text):
            return read_csv(text, names)
        return leg_angles(read_trc(text) if suffix == ".trc" else read_capture(text), names, side, max_gap)

    with naming(path, "gait.path"):
        return cut(read(names or {}))._replace(source=str(path))
