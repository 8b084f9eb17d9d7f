"""A foot as files to make it from, in every format."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from footopt.errors import MissingError
from footopt.foot.foot import Foot

FORMATS = ("csv", "dxf", "svg", "stl", "step")


def write_all(foot: Foot, folder: Path, block: Sequence[float] | None = None) -> tuple[list[Path], list[str]]:
    """Write contour.csv, .dxf, .svg, .stl and .step to a folder (see `Foot.to_file`).

    Returns the files, and notes on what is left out because a library is missing.
    """
    written, notes = [], []
    for ending in FORMATS:
        path = folder / f"contour.{ending}"
        try:
            written.append(foot.to_file(path, block))
        except MissingError as error:
            path.unlink(missing_ok=True)  # of the same run, before
            notes.append(f"There is no {path.name}: {error}")
    return written, notes
