"""A gait's Fourier coefficients from JSON, as in the package's own human_walk.json."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from footopt.files import io
from footopt.files.columns import LARGEST
from footopt.files.io import Unusable, naming, read_json_file

Series = tuple[float, tuple[float, ...], tuple[float, ...]]


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
    with naming(path, "gait.path"):
        try:
            residual = data.get("rms_residual_deg_by_harmonics", {})
            return Coefficients(
                {n: _series(data[n]) for n in ("thigh", "knee", "foot") if n in data or n != "foot"},
                _finite(data["period_s"]),
                str(data.get("source", "")),
                {many: {joint: _finite(rms) for joint, rms in fit.items()} for many, fit in residual.items()},
            )
        except KeyError as error:
            why = f"{error} is missing"
        except ValueError as error:
            why = str(error)
        except (AttributeError, TypeError):
            why = "a part of it has another form"
        raise Unusable(
            f"not a gait in JSON ({why}). It must hold period_s, and thigh and knee each with a0, a and b in "
            "degrees."
        )


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
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < LARGEST:
        raise ValueError(f"{str(value)[:40]} is not a finite number")
    return float(value)
