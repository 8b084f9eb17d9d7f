"""A foot as files to make it from: its sole, its outline, its body."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from footopt.errors import MissingError, check
from footopt.files import bodies, drawings
from footopt.files.outline import body_outline
from footopt.foot import Foot

FORMATS = ("csv", "dxf", "svg", "stl", "step")


def write_foot(foot: Foot, path: str | Path, block: Sequence[float] | None = None) -> Path:
    """Write a foot in millimetres, in the format of the file's ending.

    Parameters
    ----------
    foot : Foot
        The foot to write.
    path : str or Path
        Ends in .csv (the sole alone), .dxf or .svg (its outline, too), .stl or .step (the body).
    block : (2,), m, optional
        Length and height of a mounting block (see `footopt.files.outline.body_outline`).

    Returns
    -------
    path : Path
        The file.

    Raises
    ------
    FileError
        The file cannot be written.
    SettingError
        The ending is another, or see `body_outline`.
    MissingError
        STEP needs OpenCASCADE: ``pip install "footopt[cad]"``.
    """
    path = Path(path)
    writers: dict[str, Callable[[], Path]] = {
        ".csv": lambda: drawings.write_csv(path, foot.contour),
        ".dxf": lambda: drawings.write_dxf(path, foot.contour, body_outline(foot, block)),
        ".svg": lambda: drawings.write_svg(path, foot.contour, body_outline(foot, block)),
        ".stl": lambda: bodies.write_stl(path, body_outline(foot, block), foot.width),
        ".step": lambda: bodies.write_step(path, body_outline(foot, block), foot.width),
    }
    suffix = path.suffix.lower()
    check(suffix in writers, "path", str(path), f"a file that ends in {', '.join(writers)}")
    return writers[suffix]()


def write_all(foot: Foot, folder: Path, block: Sequence[float] | None = None) -> tuple[list[Path], list[str]]:
    """Write contour.csv, .dxf, .svg, .stl and .step to a folder (see `write_foot`).

    Returns the files, and notes on what is left out because a library is missing.
    """
    written, notes = [], []
    for ending in FORMATS:
        path = folder / f"contour.{ending}"
        try:
            written.append(write_foot(foot, path, block))
        except MissingError as error:
            path.unlink(missing_ok=True)  # of the same run, before
            notes.append(f"There is no {path.name}: {error}")
    return written, notes
