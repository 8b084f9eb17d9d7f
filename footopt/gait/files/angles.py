"""Gaits as angles: Fourier coefficients (JSON), or a table over time (CSV)."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, check
from footopt.gait.cycle import Fourier, Gait
from footopt.gait.files.strides import Recording

Array = NDArray[np.float64]

HUMAN = Path(__file__).parents[1] / "data" / "human_walk.json"


def read_json(path: str | Path, harmonics: int = 6) -> Gait:
    """A gait from Fourier coefficients: ``thigh``, ``knee`` and, optionally, ``foot``, each with
    ``a0`` and lists ``a``, ``b`` in degrees, and ``period_s``; as in the package's human_walk.json.
    """
    try:
        data = json.loads(text_of(path))
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


def read_csv(path: str | Path, names: Mapping[str, str] | None = None) -> Recording:
    """Angles over time: columns ``time`` (s), ``thigh``, ``knee`` and, optionally, ``foot`` (degrees;
    signs as in `footopt.gait.cycle`), one stride from heel strike to heel strike or several strides.

    Parameters
    ----------
    names : the file's own names of these columns, where they differ.
    """
    names = names or {}
    own = {joint: names.get(joint, joint) for joint in ("time", "thigh", "knee", "foot")}
    reader = csv.DictReader(text_of(path).splitlines(), skipinitialspace=True)
    header = reader.fieldnames or []
    missing = [own[c] for c in ("time", "thigh", "knee") if own[c] not in header]
    if missing:
        raise FileError(
            f"gait.path = {str(path)!r}: the header lacks {', '.join(missing)}; "
            "the columns must be time (s), thigh, knee and, optionally, foot (deg)."
        )
    columns = [own["time"], own["thigh"], own["knee"]] + ([own["foot"]] if own["foot"] in header else [])
    try:
        table = np.array([[float(row[c]) for c in columns] for row in reader], float)
    except (TypeError, ValueError) as error:
        raise FileError(f"gait.path = {str(path)!r}: not a table of numbers ({error}).") from None
    return Recording.checked(path, table.reshape(-1, len(columns)).T)


def text_of(path: str | Path) -> str:
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(
            f"gait.path = {str(path)!r}: cannot be read ({error}). Use gait=human for the built-in walk."
        ) from None
