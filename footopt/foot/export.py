"""A foot as files to make it from, in every format."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from footopt.errors import MissingError
from footopt.foot.foot import Foot

FORMATS = ("csv", "dxf", "svg", "stl", "step")


def write_all(foot: Foot, folder: Path, block: Sequence[float] | None = None) -> tuple[list[Path], list[str]]:
    """Write contour.csv, .dxf, .svg, .stl and .step to a folder.

    Parameters
    ----------
    foot : Foot
        What is made.
    folder : Path
        Where the files go.
    block : (2,), m, optional
        Length and height of a mounting block (see `Foot.body_outline`).

    Returns
    -------
    written : list of Path
        The files.
    notes : list of str
        Which format is left out because a library is missing, and how to install it.

    Raises
    ------
    FileError, SettingError
        See `Foot.to_file`.
    """
    written, notes = [], []
    for ending in FORMATS:
        path = folder / f"contour.{ending}"
        try:
            written.append(foot.to_file(path, block))
        except MissingError as error:
            notes.append(f"There is no {path.name}: {error}")
    return written, notes
