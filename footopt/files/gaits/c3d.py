"""Markers from C3D files, with the library ezc3d."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from footopt.errors import needed
from footopt.files.gaits.markers import Markers, metres, to_markers
from footopt.files.reading import Unusable

BLOCK = 512  # bytes; what the header counts in
LONG = 0xFFFF  # frames; a longer recording says their number elsewhere
BIG_ENDIAN = 86  # of the processors' codes, that of MIPS


def read_c3d(path: str | Path, content: bytes) -> Markers:
    """Read markers from C3D; one whose residual is negative is not seen.

    Parameters
    ----------
    path : str or Path
        The file.
    content : bytes
        What is in it: ezc3d reads a file that is cut off without a word.
    """
    ezc3d = needed("ezc3d", "a gait in C3D", "c3d")
    try:
        file = ezc3d.c3d(str(path))
        point = file["parameters"]["POINT"]
        names = [str(name).strip() for name in point["LABELS"]["value"]]
        unit, rate, scale = (point[key]["value"][0] for key in ("UNITS", "RATE", "SCALE"))
        first = int(file["header"]["points"]["first_frame"])
        places = np.asarray(file["data"]["points"], np.float64)[:3].transpose(2, 1, 0)
        residuals = np.asarray(file["data"]["meta_points"]["residuals"], np.float64)[0].T
        places = np.where((residuals >= 0)[..., None], places, np.nan)[:, : len(names)]
    except Exception as error:  # whatever the library finds
        raise Unusable(f"cannot be read as C3D ({' '.join(str(error).split())[:160]}).") from None
    needs = _bytes_needed(content, floats=scale < 0)
    if needs > len(content):
        raise Unusable(
            f"cannot be read as C3D (its header says {needs} bytes, it has {len(content)}: "
            "it is cut off or damaged)."
        )
    if not 0 < rate < np.inf:
        raise Unusable(f"cannot be read as C3D (it says {rate:g} frames a second).")
    times = (first + np.arange(len(places))) / rate
    return to_markers(times, names, metres(unit) * places)


def _bytes_needed(content: bytes, floats: bool) -> int:
    """Bytes that a file has by its own header."""
    big = content[BLOCK * (content[0] - 1) + 3] == BIG_ENDIAN
    _, points, analog, first, last, _, _, _, data = map(
        int, np.frombuffer(content[:18], ">u2" if big else "<u2")
    )
    if last == LONG:
        return 0
    return BLOCK * (data - 1) + (last - first + 1) * (4 * points + analog) * (4 if floats else 2)
