"""What runs left in their folders, read again to be compared: settings, objectives, sole and traces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.errors import ERROR_FILE, FileError, one_line
from footopt.files import identity
from footopt.files.drawings import MM
from footopt.files.io import read_json_file

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Run:
    """A run, or a job of a multirun.

    Parameters
    ----------
    name : str
        As tables call it: "job 3".
    key : str
        As summary.csv calls it.
    place : str
        Where it is, in words.
    folder : Path
        Where it left what it found.
    overrides : tuple of str
        What it was given on the command line.
    settings : mapping
        All its settings; none if it has not written them down.
    result : mapping, optional
        What its result.json says, if it is about one foot.
    note : str
        Why there are no objectives, or no better ones.
    failed : bool
        Whether it ended in an error, or died.
    """

    name: str
    key: str
    place: str
    folder: Path
    overrides: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    result: Mapping[str, Any] | None = None
    note: str = ""
    failed: bool = False

    @property
    def objectives(self) -> dict[str, float]:
        """Its objectives by name, NaN for those that it could not tell; empty if it left none."""
        found = self.result["objectives"] if self.result else {}
        return {name: math.nan if value is None else value for name, value in found.items()}

    @property
    def walk_failed(self) -> bool:
        """Whether it is one walk, which failed."""
        return bool(self.result and self.result.get("study") == "simulate" and self.result.get("reason"))

    @property
    def hollow(self) -> float:
        """Of its foot, mm; NaN if it left none."""
        return float(self.result["design"]["hollow_mm"]) if self.result else math.nan

    @property
    def k(self) -> list[int]:
        """Heights of its foot, if it is made of waypoints."""
        return (self.result["design"]["k"] if self.result else None) or []

    @cached_property
    def contour(self) -> Array:
        """Its sole, (m, 2), m."""
        points: Array = np.loadtxt(self.folder / "contour.csv", delimiter=",", skiprows=1, ndmin=2) / MM
        if points.shape[1:] != (2,) or not np.isfinite(points).all():
            raise ValueError("contour.csv holds no points")
        return points

    @cached_property
    def traces(self) -> dict[str, Array] | None:
        """Height, speed, power and work of both feet against time `t`, (T,) each; None if it left no walk."""
        from scipy.io import netcdf_file

        if not (self.folder / "walk.nc").is_file():  # a study of many scenarios
            return None
        with netcdf_file(self.folder / "walk.nc", mmap=False) as file:
            t, com, velocity, power, work = (
                np.array(file.variables[name][:]) for name in ("t", "com", "velocity", "power", "work")
            )
        return {
            "t": t,
            "height": com[:, 1],
            "speed": velocity[:, 0],
            "power": power.sum(axis=1),
            "work": work.sum(axis=1),
        }


def read_run(folder: Path, name: str, key: str, place: str = "") -> Run:
    """Read what a run left: its result.json, or an `ERROR_FILE` if it failed; one that has neither died.

    What is damaged is said in its note, and it has no result then.
    """
    try:
        settings, words, _ = identity.read(folder)
    except FileError:  # it has not said what it is
        settings, words = {}, ()
    own = (name, key, place, folder, words, settings)
    if (folder / ERROR_FILE).is_file():
        return Run(*own, note=(folder / ERROR_FILE).read_text(encoding="utf-8").strip(), failed=True)
    if not (folder / "result.json").is_file():
        return Run(*own, note="no result", failed=True)
    try:
        result = read_json_file(folder / "result.json", "study.runs")
        if not (isinstance(result.get("objectives"), dict) and (folder / "contour.csv").is_file()):
            # a study of many feet or of none
            return Run(*own, note=f"study={result['study']}: see its own folder")
        note = result.get("reason", "") or ("interrupted" if result.get("interrupted") else "")
        run = Run(*own, result=result, note=note)
        # read, to be sound
        _ = run.contour, run.traces, sum(run.objectives.values()), run.hollow, [*run.k], result["versions"]
        _ = run.walk_failed
        _ = result["settings"]["foot"]["top"], result["settings"]["foot"]["width"]
    except Exception as error:  # whatever can be wrong with files that have been damaged
        return Run(*own, note=f"damaged: {one_line(f'{type(error).__name__}: {error}')}", failed=True)
    return run
