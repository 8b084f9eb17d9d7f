"""Markers from C3D files, as c3d.org's user guide (2021) has them, by processors of Intel, DEC and MIPS.

The libraries that read C3D end the whole process on damaged parameters, or refuse files in which header and
parameters differ in what is not needed here.
"""

from __future__ import annotations

import math
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.markers import Markers, metres, to_markers
from footopt.files.io import Unusable

Array = NDArray[np.float64]
Parameter = list[str] | NDArray[Any]

BLOCK = 512  # bytes; what the header counts in
LONG = 0xFFFF  # frames; a longer recording says their number elsewhere
KEY = 0x50  # the second byte of every C3D file
DEC, MIPS = 85, 86  # codes of processors; any other is Intel's
TEXT = -1
KINDS = {TEXT: "S1", 1: "i1", 2: "i2", 4: "f4"}  # of a parameter's values
DAMAGED = (
    "cannot be read as C3D (its parameters are damaged). Export it again from the program that recorded it."
)


def read_c3d(content: bytes, units: str | None = None) -> Markers:
    """Read markers from C3D; one whose residual is negative is not seen.

    Parameters
    ----------
    content : bytes
        What is in the file.
    units : str, optional
        Its unit of length; by default what it says.
    """
    begin = BLOCK * (content[0] - 1) if content else 0
    if len(content) < BLOCK or content[1] != KEY or begin < 0:
        raise Unusable("cannot be read as C3D (it does not begin as one).")
    _check_long(content, begin + BLOCK)
    processor = content[begin + 3]
    header = _numbers(content[:24], "u2", processor)
    many, analog, first, last, data = (int(header[i]) for i in (1, 2, 3, 4, 8))
    stated_scale, stated_rate = (_numbers(content[i : i + 4], "f4", processor)[0] for i in (12, 20))
    point = _parameters(content, begin + 4, processor)

    def number(name: str, stated: float) -> float:
        found = point.get(name, [])
        return float(found[0]) if len(found) and not isinstance(found, list) and found[0] else float(stated)

    def texts(name: str) -> list[str]:
        found = point.get(name, [])
        return found if isinstance(found, list) else []

    names = [name for key in sorted(point, key=len) if key.startswith("LABELS") for name in texts(key)]
    scale, rate = number("SCALE", stated_scale), number("RATE", stated_rate)
    if not 0 < rate < np.inf:
        raise Unusable(f"cannot be read as C3D (it says {rate:g} frames a second).")
    size, start = (4 if scale < 0 else 2), BLOCK * (data - 1)  # a negative scale means floats
    stride = (4 * many + analog) * size
    if not (many and any(names) and start >= BLOCK):
        raise Unusable("holds no markers, and forces or other signals alone are no gait.")
    _check_long(content, start + (0 if last == LONG else (last - first + 1) * stride))
    frames = (len(content) - start) // stride
    stated = last - first + 1 if last != LONG else int(number("LONG_FRAMES", number("FRAMES", frames)))
    frames = min(frames, stated)
    rows = np.frombuffer(content, np.uint8, frames * stride, start).reshape(frames, stride)
    values = _numbers(rows[:, : 4 * many * size].tobytes(), f"{'f' if size == 4 else 'i'}{size}", processor)
    values = values.astype(float).reshape(frames, many, 4)
    seen = (values[..., 3:] >= 0) & np.isfinite(values).all(axis=2, keepdims=True)
    places = np.where(seen, values[..., :3], np.nan) * (1.0 if size == 4 else scale)
    unit = metres(next(iter(texts("UNITS")), ""), units)
    angles = [name.endswith("Angles") for name in names] + [False] * many
    places *= np.where(angles[:many], 1.0, unit)[:, None]  # angles are in deg
    return to_markers((first - 1 + np.arange(frames)) / rate, names, places)


def _check_long(content: bytes, needs: int) -> None:
    """Raise `Unusable` unless a file is as long as its own header says."""
    if needs > len(content):
        raise Unusable(
            f"cannot be read as C3D (its header says {needs} bytes, it has {len(content)}: "
            "it is cut off or damaged)."
        )


def _parameters(content: bytes, at: int, processor: int) -> dict[str, Parameter]:
    """The parameters of the group POINT, by name: texts or numbers; a chain of groups and parameters begins
    at a byte.
    """
    groups: dict[int, str] = {}
    found: list[tuple[int, str, Parameter]] = []
    while at + 2 <= len(content):
        length, group = struct.unpack_from("bb", content, at)
        at += 2 + abs(length)
        if length == 0 or group == 0 or at + 5 > len(content):
            break
        name = content[at - abs(length) : at].decode("ascii", "replace").upper()
        step = int(_numbers(content[at : at + 2], "u2", processor)[0])
        if group < 0:
            groups[-group] = name
        else:
            kind, dimensions = struct.unpack_from("bB", content, at + 2)
            sizes = content[at + 4 : at + 4 + dimensions]
            long = abs(kind) * math.prod(sizes)
            values = content[at + 4 + dimensions :][:long]
            if kind not in KINDS or len(values) < long or 4 + dimensions + long > (step or len(content)):
                raise Unusable(DAMAGED)
            if kind == TEXT:
                whole, wide = values.decode("utf-8", "replace"), (*sizes, 1)[0]
                cells = [whole[i : i + wide].strip(" \0") for i in range(0, len(whole), max(wide, 1))]
            found.append((group, name, cells if kind == TEXT else _numbers(values, KINDS[kind], processor)))
        at += step
        if step == 0:
            break
    return {name: parameter for group, name, parameter in found if groups.get(group) == "POINT"}


def _numbers(content: bytes, kind: str, processor: int) -> NDArray[Any]:
    """Numbers of a kind of numpy, such as f4, as a processor writes them."""
    if kind == "f4" and processor == DEC:  # the halves change places, and the exponent is 2 higher
        words = np.frombuffer(content, "<u2").astype(np.uint32).reshape(-1, 2)
        return (words[:, 0] << 16 | words[:, 1]).view(np.float32) / 4
    return np.frombuffer(content, (">" if processor == MIPS else "<") + kind)
