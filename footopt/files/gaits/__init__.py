"""Gaits from files, as plain data: Fourier coefficients (JSON), or the strides in angles or markers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from footopt.errors import check
from footopt.files.gaits.angles import Recording, check_angles, check_period, recording
from footopt.files.gaits.c3d import read_c3d
from footopt.files.gaits.captures import holds_markers, read_capture
from footopt.files.gaits.coefficients import Coefficients, read_json, write_json
from footopt.files.gaits.leg import leg_angles
from footopt.files.gaits.markers import UNITS as LENGTHS
from footopt.files.gaits.strides import Strides, average, cut
from footopt.files.gaits.tables import read_csv, read_mot
from footopt.files.gaits.trc import read_trc
from footopt.files.io import Unusable, naming, read_bytes, read_text

__all__ = ["Coefficients", "Strides", "average", "check_angles", "check_period", "cut", "read_json",
           "read_strides", "recording", "write_json"]  # fmt: skip

ENDINGS = (".json", ".csv", ".trc", ".mot", ".sto", ".c3d")
UNITS = (None, *LENGTHS, "deg", "rad")  # of a file of markers, or of angles


def read_strides(
    path: str | Path,
    names: Mapping[str, str] | None = None,
    side: str | None = None,
    max_gap: float = 0.2,
    units: str | None = None,
) -> Strides:
    """The strides in a file of angles (CSV, MOT, STO) or markers (TRC, C3D, CSV).

    Its parameters and errors are those of `Gait.from_file`.
    """
    suffix = Path(path).suffix.lower()
    check(side in (None, "right", "left"), "gait.side", side, "right, left or null")
    check(max_gap >= 0, "gait.max_gap", max_gap, "a time >= 0, in s")
    check(units in UNITS, "gait.units", units, f"one of {', '.join(filter(None, UNITS))}, or null")
    allowed = f"a file that ends in {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}"
    check(suffix in ENDINGS[1:], "gait.path", str(path), allowed)
    with naming(path, "gait.path"):
        read = _reader(path, suffix, names or {}, max_gap, units)
        try:
            return cut(read(side))._replace(source=str(path))
        except Unusable as why:
            for other in {"right": ("left",), "left": ("right",)}.get(side or "", ("left", "right")):
                try:
                    cut(read(other))
                except Unusable:
                    continue
                raise Unusable(f"{why} The {other} leg can be read: set gait.side={other}.") from None
            raise


def _reader(
    path: str | Path, suffix: str, names: Mapping[str, str], max_gap: float, units: str | None
) -> Callable[[str | None], Recording]:
    """A function that gives a side's leg, of a file that is read once."""
    if suffix == ".c3d":
        markers = read_c3d(read_bytes(path, "gait.path"), units)
    else:
        text = read_text(path, "gait.path")
        if suffix in (".mot", ".sto"):
            return lambda side: read_mot(text, names, side, units)
        if suffix == ".csv" and not holds_markers(text):
            return lambda side: read_csv(text, names, side, units)
        markers = read_trc(text, units) if suffix == ".trc" else read_capture(text, units)
    return lambda side: leg_angles(markers, names, side, max_gap)
