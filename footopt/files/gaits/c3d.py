"""Markers from C3D files, with the library ezc3d."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from footopt.errors import needed
from footopt.files.gaits.markers import Markers, metres, to_markers
from footopt.files.reading import Unusable

BLOCK = 512  # bytes; what the header counts in
LONG = 0xFFFF  # frames; a longer recording says their number elsewhere
KEY = 0x50  # the second byte of every C3D file
BIG_ENDIAN = 86  # of the processors' codes, that of MIPS
SIGNS = {85: 13, BIG_ENDIAN: 12}  # the byte with the sign of the scale, by processor (85: DEC); else the 15th


def read_c3d(path: str | Path, content: bytes, units: str | None = None) -> Markers:
    """Read markers from C3D; one whose residual is negative is not seen.

    Parameters
    ----------
    path : str or Path
        The file.
    content : bytes
        What is in it.
    units : str, optional
        Its unit of length; by default what it says.
    """
    ezc3d = needed("ezc3d", "a gait in C3D", "c3d")
    check_whole(content)
    try:
        file = ezc3d.c3d(str(path))
        point = file["parameters"]["POINT"]
        # a list of labels has at most 255 of them
        lists = sorted((key for key in point if key.startswith("LABELS")), key=len)
        names = [str(name).strip() for key in lists for name in point[key]["value"]]
        unit, rate = (([*point[key]["value"], ""] if key in point else [""])[0] for key in ("UNITS", "RATE"))
        first = int(file["header"]["points"]["first_frame"])
        places = np.asarray(file["data"]["points"], np.float64)[:3].transpose(2, 1, 0)
        residuals = np.asarray(file["data"]["meta_points"]["residuals"], np.float64)[0].T
        places = np.where((residuals >= 0)[..., None], places, np.nan)[:, : len(names)]
    except Exception:  # the library's own words help nobody
        raise Unusable(
            "cannot be read as C3D (its parameters or its data are damaged). "
            "Export it again from the program that recorded it."
        ) from None
    if not names:
        raise Unusable("holds no markers (POINT:LABELS is empty).")
    if not (isinstance(rate, float) and 0 < rate < np.inf):
        raise Unusable(f"cannot be read as C3D (POINT:RATE is {rate}, and must be the frames a second).")
    times = (first + np.arange(len(places))) / rate
    return to_markers(times, names, metres(unit, units) * places)


def check_whole(content: bytes) -> None:
    """Raise `Unusable` unless a file begins as C3D and is as long as its own header says.

    ezc3d fills up a file that is cut off with zeros, or does not come to an end.
    """
    parameters = BLOCK * (content[0] - 1) if content else 0
    if len(content) < BLOCK or content[1] != KEY or parameters < 0:
        raise Unusable("cannot be read as C3D (it does not begin as one).")
    needs = parameters + BLOCK
    if needs <= len(content):
        processor = content[parameters + 3]
        words = np.frombuffer(content[:18], ">u2" if processor == BIG_ENDIAN else "<u2")
        points, analog, first, last, data = (int(words[i]) for i in (1, 2, 3, 4, 8))
        size = 4 if content[SIGNS.get(processor, 15)] & 0x80 else 2  # a negative scale means floats
        frames = 0 if last == LONG else last - first + 1
        needs = max(needs, BLOCK * (data - 1) + frames * (4 * points + analog) * size)
    if needs > len(content):
        raise Unusable(
            f"cannot be read as C3D (its header says {needs} bytes, it has {len(content)}: "
            "it is cut off or damaged)."
        )
