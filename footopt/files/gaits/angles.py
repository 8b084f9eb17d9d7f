"""Gaits as angles: Fourier coefficients (JSON), or a table over time (CSV)."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import check
from footopt.files.gaits.strides import Recording, check_angles, check_period, wrong
from footopt.files.reading import LARGEST, number, read_json_file, read_table
from footopt.gait.gait import Fourier, Gait

Array = NDArray[np.float64]

PHASES = 200  # of a stride at which the angles of a series are looked at

HUMAN = Path(__file__).parents[2] / "gait" / "data" / "human_walk.json"


def read_json(path: str | Path, harmonics: int = 6) -> Gait:
    """A gait from Fourier coefficients: ``thigh``, ``knee`` and, optionally, ``foot``, each with
    ``a0`` and lists ``a``, ``b`` in degrees, and ``period_s``; as in the package's human_walk.json.
    """
    data = read_json_file(path, "gait", "gait.path")
    try:
        joints = {
            name: Fourier(
                _finite(data[name]["a0"]),
                tuple(map(_finite, data[name]["a"])),
                tuple(map(_finite, data[name]["b"])),
            )
            for name in ("thigh", "knee", "foot")
            if name in data or name != "foot"
        }
        period = _finite(data["period_s"])
        fitted = data.get("rms_residual_deg_by_harmonics", {}).get(str(harmonics), {})
        residual = tuple((str(joint), float(rms)) for joint, rms in fitted.items())
        source = str(data.get("source", ""))
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise wrong(
            path,
            f"not a gait in JSON ({type(error).__name__}: {error}). It must hold "
            "period_s, and thigh and knee each with a0, a and b in degrees.",
        ) from None
    available = min(min(len(j.a), len(j.b)) for j in joints.values())
    check(
        1 <= harmonics <= available,
        "gait.harmonics",
        harmonics,
        f"a whole number from 1 to {available}, the harmonics in {Path(path).name}",
    )
    short = {name: joint.truncated(harmonics) for name, joint in joints.items()}
    phase = np.arange(PHASES) / PHASES
    check_angles(path, {name: np.degrees(joint.at(phase)[0]) for name, joint in short.items()})
    check_period(path, period)
    return Gait(
        thigh=short["thigh"],
        knee=short["knee"],
        foot=short.get("foot"),
        period=period,
        name=Path(path).stem,
        source=source,
        residual=residual,
    )


def read_csv(path: str | Path, names: Mapping[str, str] | None = None) -> Recording:
    """Angles over time: columns ``time`` (s), ``thigh``, ``knee`` and, optionally, ``foot`` (degrees;
    signs as in `footopt.gait.gait`), one stride from heel strike to heel strike or several strides.

    Parameters
    ----------
    names : the file's own names of these columns, where they differ.
    """
    names = names or {}
    own = {joint: names.get(joint, joint) for joint in ("time", "thigh", "knee", "foot")}
    reader = csv.DictReader(read_table(path, "gait", "gait.path").splitlines(), skipinitialspace=True)
    try:
        header = list(reader.fieldnames or [])
    except csv.Error as error:
        raise wrong(path, f"not a table ({error}).") from None
    missing = [own[c] for c in ("time", "thigh", "knee") if own[c] not in header]
    if missing:
        raise wrong(
            path,
            f"the header lacks {', '.join(missing)}; "
            "the columns must be time (s), thigh, knee and, optionally, foot (deg).",
        )
    if twice := next((c for c in own.values() if header.count(c) > 1), None):
        raise wrong(path, f"two columns are called {twice!r}. Which one is it?")
    columns = [own["time"], own["thigh"], own["knee"]] + ([own["foot"]] if own["foot"] in header else [])
    try:
        table = np.array([_row(row, columns) for row in reader], float)
    except (TypeError, ValueError, csv.Error) as error:
        raise wrong(path, f"not a table of numbers ({error}).") from None
    return Recording.checked(path, table.reshape(-1, len(columns)).T)


def _row(row: dict[str | None, str], columns: list[str]) -> list[float]:
    """A row's numbers; one with more cells than the header has is read wrongly, as with decimal commas."""
    if None in row:
        raise ValueError(f"a row has more cells than the header: {row[None]} are left over")
    return [number(row[c]) for c in columns]


def _finite(value: object) -> float:
    """A number of a JSON file."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < LARGEST:
        raise ValueError(f"{str(value)[:40]} is not a finite number")
    return float(value)
