"""C3D through the library ezc3d, in a process of its own: a damaged file can crash it, or never end.

`python -m footopt.files.gaits.c3d FILE` writes one line of JSON, then places (3, markers, frames) and
residuals (markers, frames) as doubles.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError
from footopt.files.gaits.strides import wrong
from footopt.files.reading import read_bytes

Array = NDArray[np.float64]

PATIENCE = 8.0  # s, for the largest file that is read
MEMORY = 4 << 30  # bytes of addresses that reading may take
BLOCK = 512  # bytes; what the header counts in
MISSING = 3  # exit code: ezc3d is not installed


class Contents(NamedTuple):
    """What a C3D file holds: names; unit; rate, 1/s; first frame; places (frames, markers, 3); residuals."""

    names: list[str]
    unit: str
    rate: float
    first: int
    places: Array
    residuals: Array


def load(path: str | Path) -> Contents:
    """The points of a C3D file.

    Raises
    ------
    FileError : it is no whole C3D file, or ezc3d is missing.
    """
    _check_header(path, read_bytes(path, "gait", "gait.path"))
    # modules from where this process has them, and none from the folder it happens to be in
    command = [sys.executable, "-P", "-m", __name__, str(Path(path).absolute())]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    try:
        done = subprocess.run(command, capture_output=True, timeout=PATIENCE, env=environment)
    except subprocess.TimeoutExpired:
        raise not_c3d(path, f"that takes longer than {PATIENCE:g} s: it is damaged") from None
    if done.returncode == MISSING:
        raise wrong(path, "C3D files need ezc3d: pip install footopt[c3d].")
    if done.returncode != 0:
        said = done.stderr.decode(errors="replace").strip().splitlines() if done.returncode == 1 else []
        raise not_c3d(path, said[-1][:160] if said else "it is damaged")
    head, _, body = done.stdout.partition(b"\n")
    facts = json.loads(head)
    numbers = np.frombuffer(body, np.float64)
    markers, frames = facts["shape"]
    places = numbers[: 3 * markers * frames].reshape(3, markers, frames)
    residuals = numbers[3 * markers * frames :].reshape(markers, frames)
    return Contents(
        facts["names"], facts["unit"], facts["rate"], facts["first"], places.transpose(2, 1, 0), residuals.T
    )


def _check_header(path: str | Path, content: bytes) -> None:
    """Raise unless a file is as long as its own header says."""
    if len(content) < BLOCK or content[1] != 0x50:
        raise not_c3d(path, "it does not begin as one")
    processor = content[(at := BLOCK * (content[0] - 1)) + 3] if 0 < BLOCK * content[0] < len(content) else 0
    if processor not in (84, 85, 86):
        raise not_c3d(path, "its parameters are not where the header says")
    order = ">" if processor == 86 else "<"
    points, analog, first, last = (int(v) for v in np.frombuffer(content[2:10], order + "u2"))
    data = int(np.frombuffer(content[16:18], order + "u2")[0])
    # words 7 and 8: a scale below 0 says that the data are floats; DEC's floats have the halves swapped
    negative = content[15 if processor != 86 else 12] & 0x80 if processor != 85 else content[13] & 0x80
    frames, size = last - first + 1, 4 if negative else 2
    if points < 1 or frames < 1 or not at < BLOCK * (data - 1) < len(content):
        raise not_c3d(path, f"its header says {max(frames, 0)} frames of {points} markers")
    needed = BLOCK * (data - 1) + frames * (4 * points + analog) * size
    if needed > len(content) and last < 0xFFFF:  # a longer recording says its frames elsewhere
        raise not_c3d(
            path,
            f"its header says {frames} frames of {points} markers in {needed} bytes, it has {len(content)}: "
            "it is cut off or damaged",
        )


def not_c3d(path: str | Path, why: str) -> FileError:
    """What to say of a file that is no C3D file."""
    return wrong(path, f"cannot be read as C3D ({why}).")


def main(path: str) -> int:
    """Read a file with ezc3d and write what `load` needs to standard output."""
    try:
        import ezc3d
    except ImportError:
        return MISSING
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    except (ImportError, ValueError, OSError):  # not on this system
        pass
    try:
        file = ezc3d.c3d(path)
        point = file["parameters"]["POINT"]
        places = np.asarray(file["data"]["points"], np.float64)[:3]
        residuals = np.asarray(file["data"]["meta_points"]["residuals"], np.float64)[0]
        facts = {
            "names": [str(name).strip() for name in point["LABELS"]["value"]],
            "unit": str(point["UNITS"]["value"][0]),
            "rate": float(point["RATE"]["value"][0]),
            "first": int(file["header"]["points"]["first_frame"]),
            "shape": places.shape[1:],
        }
        if residuals.shape != places.shape[1:]:
            raise ValueError("its residuals do not belong to its points")
    except Exception as error:  # whatever the library finds
        print(" ".join(f"{error}".split()) or type(error).__name__, file=sys.stderr)
        return 1
    sys.stdout.buffer.write(json.dumps(facts).encode() + b"\n" + places.tobytes() + residuals.tobytes())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
