"""How do I make this foot? The foot of a run that is over, as files for a workshop."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from footopt.errors import FileError, FootoptError, SettingError
from footopt.files.bodies import measure, write_all
from footopt.files.contours import AREA_TOLERANCE, MM, body_outline, compare
from footopt.files.polygon import enclosed_area
from footopt.files.reading import is_missing, named, read_json_file
from footopt.foot import Foot
from footopt.report import figures, terminal
from footopt.studies.base import Study
from footopt.studies.build import make_foot
from footopt.studies.record import foot_entry
from footopt.studies.settings import FootConfig

#: What each file holds.
HOLDS = {
    ".csv": "the sole, heel to toe",
    ".dxf": "outline and sole",
    ".svg": "outline and sole, full size",
    ".stl": "body of triangles",
    ".step": "body of plane faces",
}

#: What damaged settings raise, our own refusals among them.
DAMAGED = (FootoptError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


class Found(NamedTuple):
    """What a file holds, read back: area of the outline (mm^2), volume (mm^3; NaN of a drawing)."""

    path: Path
    area: float
    volume: float


def run(study: Study) -> None:
    """Write the foot of the run `study.run` in every format, each read back and checked."""
    config, folder = study.config, study.options.run
    if folder is None:
        advice = "Try footopt study=export run=outputs/optimize/..."
        raise SettingError("study.run", None, "the folder of a run", advice)
    foot, block = foot_of(Path(folder), config.foot.k), config.foot.block
    written = write_all(foot, study.folder, block)
    outline = MM * body_outline(foot, block)
    area, size = enclosed_area(outline), [*np.ptp(outline, axis=0).tolist(), MM * foot.width]
    volume = area * MM * foot.width
    found = [Found(path, *read_back(path, foot, block)) for path in written]
    caption = "The outline of every file, with its sole (blue) and ankle (+), in mm."
    study.save("drawing", figures.drawing(foot, block), caption)
    study.conclude(
        "A foot to make",
        [table(found, area, volume)],
        {
            "run": folder,
            "design": foot_entry(foot),
            "area_mm2": area,
            "volume_mm3": volume,
            "size_mm": size,
            "files": {
                f.path.name: {"bytes": f.path.stat().st_size, "area_mm2": f.area, "volume_mm3": f.volume}
                for f in found
            },
        },
        said=[
            f"{terminal.describe_foot(foot)}: {area:.0f} mm^2, {MM * foot.width:g} mm wide",
            f"{', '.join(path.name for path in written)}: each read back; area and volume agree",
        ],
    )


def read_back(path: Path, foot: Foot, block: Sequence[float] | None) -> tuple[float, float]:
    """`Found.area` and `Found.volume` of a file; the sole alone in a CSV file is closed as the others are."""
    if path.suffix != ".csv":
        return measure(path)
    sole = Foot.from_file(path, foot.width, foot.ankle, foot.closed, foot.top)
    area, expected = (MM * MM * enclosed_area(body_outline(each, block)) for each in (sole, foot))
    compare(path, "area", area, expected, AREA_TOLERANCE, "mm^2")
    return area, math.nan


def table(found: Sequence[Found], area: float, volume: float) -> Table:
    """Files for the terminal and the page; `area` and `volume` are those that were to be written."""
    words = ("file", "holds")
    shown = terminal.table((*words, "kB", "area (mm^2)", "volume (mm^3)", "difference"), words)
    for f in found:
        off = [abs(f.area / area - 1.0), 0.0 if math.isnan(f.volume) else abs(f.volume / volume - 1.0)]
        shown.add_row(
            f.path.name,
            HOLDS[f.path.suffix],
            f"{1e-3 * f.path.stat().st_size:.1f}",
            f"{f.area:.2f}",
            "" if math.isnan(f.volume) else f"{f.volume:.0f}",
            f"{100.0 * max(off):.1g} %",
        )
    shown.caption = "read back, the sole closed as the others; difference: the larger one, of area or volume"
    return shown


def foot_of(folder: Path, k: list[int] | None = None) -> Foot:
    """The foot of a run: its best sole, or another of its design space.

    Parameters
    ----------
    folder : of a run of optimize or simulate. k : heights of another sole, e.g. of its Pareto front.

    Raises
    ------
    FileError : the folder does not hold such a run.
    """
    try:
        result = read_json_file(folder / "result.json", "run", "study.run")
        design, known = result["design"], {f.name for f in dataclasses.fields(FootConfig)}
        saved = FootConfig(**{key: v for key, v in result["settings"]["foot"].items() if key in known})
        own = design["k"]
        if k is None or saved.shape != "waypoints":
            found = _saved_foot(folder, design, saved)
    except DAMAGED as error:
        if os.path.isfile(folder / "multirun.yaml"):
            one = "the folder of one job of this multirun"
            raise SettingError("study.run", str(folder), one, f"Such as run={folder / '0'}") from None
        gone = is_missing(folder / "result.json")
        why = "it has no result.json" if gone else f"{type(error).__name__}: {error}"
        raise FileError(
            f"{named(folder, 'study.run')}: not the folder of a run with one foot ({why}). "
            "Give one of study=optimize or simulate."
        ) from None
    if k is None:
        return found
    if saved.shape != "waypoints" or own is None:
        raise SettingError("foot.k", k, f"null: the run's foot is {saved.shape}")
    return make_foot(dataclasses.replace(saved, k=k))


def _saved_foot(folder: Path, design: dict[str, Any], saved: FootConfig) -> Foot:
    """The foot that a run has kept."""
    if design["k"] is not None:
        foot = make_foot(dataclasses.replace(saved, k=design["k"]))
    else:  # the contour itself: a drawing that it came from may have changed
        width, (x, z) = float(design["width_m"]), design["ankle_m"]
        ankle = float(x), float(z)
        foot = Foot.from_file(folder / "contour.csv", width, ankle, saved.closed, saved.top)
    return dataclasses.replace(foot, name=str(design["name"]))
