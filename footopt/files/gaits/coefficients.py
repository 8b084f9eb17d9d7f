"""A gait's Fourier coefficients from JSON, as in the package's own human_walk.json."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from footopt.files.reading import LARGEST, Unusable, naming, read_json_file

Series = tuple[float, tuple[float, ...], tuple[float, ...]]


class Coefficients(NamedTuple):
    """A gait in a JSON file.

    Parameters
    ----------
    series : dict of (a0, a, b)
        Fourier coefficients by joint (thigh, knee and perhaps foot), in degrees.
    period : float, s
        Duration of a stride.
    source : str
        Where the data come from.
    residual : dict
        By number of harmonics (as text), the rms misfit of each joint, in degrees.
    """

    series: dict[str, Series]
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
    data = read_json_file(path, "gait", "gait.path")
    with naming(path, "gait.path"):
        try:
            series = {
                name: (
                    _finite(data[name]["a0"]),
                    tuple(map(_finite, data[name]["a"])),
                    tuple(map(_finite, data[name]["b"])),
                )
                for name in ("thigh", "knee", "foot")
                if name in data or name != "foot"
            }
            residual = {
                str(harmonics): {str(joint): float(rms) for joint, rms in by_joint.items()}
                for harmonics, by_joint in data.get("rms_residual_deg_by_harmonics", {}).items()
            }
            return Coefficients(series, _finite(data["period_s"]), str(data.get("source", "")), residual)
        except (AttributeError, KeyError, OverflowError, TypeError, ValueError) as error:
            raise Unusable(
                f"not a gait in JSON ({type(error).__name__}: {error}). It must hold "
                "period_s, and thigh and knee each with a0, a and b in degrees."
            ) from None


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < LARGEST:
        raise ValueError(f"{str(value)[:40]} is not a finite number")
    return float(value)
