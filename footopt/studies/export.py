"""How do I make this foot? The foot of a run that is over, as files for a workshop."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table
from shapely import Polygon

from footopt.errors import FileError, FootoptError, SettingError
from footopt.files.drawings import MM
from footopt.files.identity import lacking
from footopt.files.io import named, read_json_file
from footopt.files.mjcf import write_mjcf
from footopt.foot import Foot
from footopt.foot.export import write_all
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
    ".xml": "body of MuJoCo, its origin and site at the ankle",
    ".py": "ten lines that drop it on sand in MuJoCo",
}

#: What damaged settings raise, our own refusals among them.
DAMAGED = (FootoptError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


def run(study: Study) -> None:
    """Write the foot of the run `study.run` in every format."""
    config, folder = study.config, study.options.run
    if folder is None:
        advice = "Try footopt study=export run=outputs/optimize/..."
        raise SettingError("run", None, "the folder of a run", advice)
    foot, block = foot_of(Path(folder), config.foot.k), config.foot.block
    written, notes = write_all(foot, study.folder, block)
    if config.export.mujoco:
        written += write_mjcf(foot.contour, foot.ankle, foot.width, study.folder)
    outline, width = MM * foot.body_outline(block), MM * foot.width
    area = float(Polygon(outline).area)
    caption = "The outline of every file, with its sole (blue) and ankle (+), in mm."
    study.save("drawing", figures.drawing(foot, block), caption)
    study.conclude(
        "A foot to make",
        [table(written)],
        {
            "run": folder,
            "design": foot_entry(foot),
            "area_mm2": area,
            "volume_mm3": area * width,
            "size_mm": [*np.ptp(outline, axis=0).tolist(), width],
            "files": {path.name: {"bytes": path.stat().st_size} for path in written},
            "notes": notes,
        },
        said=[
            f"{terminal.describe_foot(foot)}: {area:.0f} mm^2, {width:g} mm wide, {area * width:.0f} mm^3",
            *notes,
        ],
    )


def table(written: Sequence[Path]) -> Table:
    """Files for the terminal and the page."""
    shown = terminal.table(("file", "holds", "kB"), ("file", "holds"))
    for path in written:
        shown.add_row(path.name, HOLDS[path.suffix], f"{1e-3 * path.stat().st_size:.1f}")
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
        result = read_json_file(folder / "result.json", "run")
        design, known = result["design"], {f.name for f in dataclasses.fields(FootConfig)}
        saved = FootConfig(**{key: v for key, v in result["settings"]["foot"].items() if key in known})
        own = design["k"]
        if k is None or saved.shape != "waypoints":
            found = _saved_foot(folder, design, saved)
    except DAMAGED as error:
        if os.path.isfile(folder / "multirun.yaml"):
            one = "the folder of one job of this multirun"
            raise SettingError("run", str(folder), one, f"Such as run={folder / '0'}") from None
        gone = not (folder / "result.json").exists()
        kind = "" if isinstance(error, FileError) else f"{type(error).__name__}: "
        why = lacking(folder, "result.json") if gone else f"{kind}{error}".rstrip(".")
        raise FileError(
            f"{named(folder, 'run')}: not the folder of a run with one foot ({why}). "
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
        foot = Foot.from_file(
            folder / "contour.csv", width=width, ankle=ankle, closed=saved.closed, top=saved.top
        )
    return dataclasses.replace(foot, name=str(design["name"]))
