"""Gaits from files: Fourier coefficients (JSON) or one stride of angles (CSV)."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, SettingError, check
from footopt.gait.cycle import Fourier, Gait

Array = NDArray[np.float64]

HUMAN = Path(__file__).parent / "data" / "human_walk.json"
MISFIT = 10.0  # deg; a larger one anywhere means a jump, or not one period


def read(path: str | Path, harmonics: int = 6) -> Gait:
    """Read a gait by its file's ending: .json (`read_json`) or .csv (`read_csv`)."""
    readers = {".json": read_json, ".csv": read_csv}
    suffix = Path(path).suffix.lower()
    if suffix not in readers:
        raise SettingError("gait.path", str(path), f"a file that ends in {' or '.join(readers)}")
    return readers[suffix](path, harmonics)


def read_json(path: str | Path, harmonics: int = 6) -> Gait:
    """A gait from Fourier coefficients: ``thigh``, ``knee`` and, optionally, ``foot``, each with
    ``a0`` and lists ``a``, ``b`` in degrees, and ``period_s``; as in the package's human_walk.json.
    """
    try:
        data = json.loads(_text(path))
        joints = {
            name: Fourier(
                float(data[name]["a0"]),
                tuple(map(float, data[name]["a"])),
                tuple(map(float, data[name]["b"])),
            )
            for name in ("thigh", "knee", "foot")
            if name in data or name != "foot"
        }
        period = float(data["period_s"])
    except (KeyError, TypeError, ValueError) as error:
        raise FileError(
            f"gait.path = {str(path)!r}: not a gait in JSON ({type(error).__name__}: {error}). It must hold "
            "period_s, and thigh and knee each with a0, a and b in degrees."
        ) from None
    available = min(min(len(j.a), len(j.b)) for j in joints.values())
    check(
        1 <= harmonics <= available,
        "gait.harmonics",
        harmonics,
        f"a whole number from 1 to {available}, the harmonics in {Path(path).name}",
    )
    fitted = data.get("rms_residual_deg_by_harmonics", {}).get(str(harmonics), {})
    short = {name: joint.truncated(harmonics) for name, joint in joints.items()}
    return Gait(
        thigh=short["thigh"],
        knee=short["knee"],
        foot=short.get("foot"),
        period=period,
        name=Path(path).stem,
        source=str(data.get("source", "")),
        residual=tuple((joint, float(rms)) for joint, rms in fitted.items()),
    )


def read_csv(path: str | Path, harmonics: int = 6) -> Gait:
    """A gait from one stride of angles: columns ``time`` (s), ``thigh``, ``knee`` and, optionally,
    ``foot`` (degrees; signs as in `footopt.gait.cycle`), from one heel strike to the next of the
    same leg. The stride's length in time is the period; series are fitted by least squares.
    """
    reader = csv.DictReader(_text(path).splitlines(), skipinitialspace=True)
    names = reader.fieldnames or []
    missing = [c for c in ("time", "thigh", "knee") if c not in names]
    if missing:
        raise FileError(
            f"gait.path = {str(path)!r}: the header lacks {', '.join(missing)}; "
            "the columns must be time (s), thigh, knee and, optionally, foot (deg)."
        )
    check(harmonics >= 1, "gait.harmonics", harmonics, "a whole number >= 1")
    joints = ["thigh", "knee"] + (["foot"] if "foot" in names else [])
    try:
        table = np.array([[float(row[c]) for c in ["time", *joints]] for row in reader], float)
    except (TypeError, ValueError) as error:
        raise FileError(f"gait.path = {str(path)!r}: not a table of numbers ({error}).") from None
    rows_needed = 2 * harmonics + 2
    if len(table) < rows_needed or not np.isfinite(table).all() or (np.diff(table[:, 0]) <= 0).any():
        raise FileError(
            f"gait.path = {str(path)!r}: needs at least {rows_needed} rows for {harmonics} harmonics, "
            "finite, with the time increasing from one heel strike to the next."
        )
    period = float(table[-1, 0] - table[0, 0])
    phase = (table[:, 0] - table[0, 0]) / period
    fits, residual = {}, []
    for column, joint in enumerate(joints, start=1):
        series, rms, worst = fit(phase, table[:, column], harmonics)
        if worst > MISFIT:
            raise FileError(
                f"gait.path = {str(path)!r}: {joint} misses its periodic fit by up to {worst:.0f} deg. "
                "The curve jumps or is not one whole stride; give one heel strike to the next of one leg."
            )
        fits[joint] = series
        residual.append((joint, rms))
    return Gait(
        thigh=fits["thigh"],
        knee=fits["knee"],
        foot=fits.get("foot"),
        period=period,
        name=Path(path).stem,
        source=str(path),
        residual=tuple(residual),
    )


def fit(phase: Array, degrees: Array, harmonics: int) -> tuple[Fourier, float, float]:
    """Least-squares series through a curve: the series, rms and largest misfit in degrees."""
    w = 2.0 * np.pi * np.outer(phase, np.arange(1, harmonics + 1))
    design = np.concatenate([np.ones((len(phase), 1)), np.cos(w), np.sin(w)], axis=1)
    solution, *_ = np.linalg.lstsq(design, degrees, rcond=None)
    misfit = design @ solution - degrees
    series = Fourier(
        float(solution[0]),
        tuple(map(float, solution[1 : harmonics + 1])),
        tuple(map(float, solution[harmonics + 1 :])),
    )
    return series, float(np.sqrt(np.mean(misfit**2))), float(np.max(np.abs(misfit)))


def _text(path: str | Path) -> str:
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(
            f"gait.path = {str(path)!r}: cannot be read ({error}). Use gait=human for the built-in walk."
        ) from None
