"""The files that a run leaves: result.json, designs.csv, the walk as NetCDF, each written as a whole."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import platform
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import distribution, version
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.compiled import processor
from footopt.errors import FileError

Variable = tuple[tuple[str, ...], str, NDArray[np.float64]]  # dimensions, unit, values

DISTRIBUTIONS = (
    "footopt", "numpy", "scipy", "numba", "llvmlite", "pymoo", "moocore", "hydra-core", "matplotlib",
)  # fmt: skip
ROOT = Path(__file__).parents[2]  # of a checkout


@cache
def versions() -> Mapping[str, str]:
    """Versions of everything that a result depends on."""
    found = {name: version(name) for name in DISTRIBUTIONS} | {"python": platform.python_version()}
    return MappingProxyType(found)


def machine() -> dict[str, Any]:
    """The processor that walks are compiled for, and the operating system."""
    name, bits = processor()
    return {"processor": name, "vector_bits": bits, "system": platform.platform()}


@cache
def commit() -> str | None:
    """The commit that footopt's sources are of, with "-dirty" where they were changed; None if not known."""
    if (ROOT / ".git").exists():
        words = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
        with suppress(OSError, subprocess.SubprocessError):
            found = subprocess.run(words, capture_output=True, text=True, timeout=5, check=True)
            return found.stdout.strip()
    origin = distribution("footopt").read_text("direct_url.json") or "{}"  # of one that pip took from git
    known: str | None = json.loads(origin).get("vcs_info", {}).get("commit_id")
    return known


def json_text(content: dict[str, Any]) -> str:
    """JSON that any reader accepts: a value that is not finite becomes null."""
    return json.dumps(plain(content), indent=2, allow_nan=False) + "\n"


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write `json_text`."""
    write_text(path, json_text(content))


@contextmanager
def write_whole(path: Path) -> Iterator[Path]:
    """A path to write to: it replaces the file at the end; what breaks off leaves the file as it was.

    What was written is on the disk before it replaces anything, so that a loss of power leaves one of both.
    The path is of a new file beside, of the same ending: what a killed run has left of it is replaced.

    Raises `FileError` if the file cannot be written.
    """
    new = path.with_name(f".{path.stem}.new{path.suffix}")
    try:
        new.unlink(missing_ok=True)
        yield new
        _sync(new, os.O_RDWR)
        os.replace(new, path)
        if os.name == "posix":
            with suppress(OSError):  # not every file system has it for folders
                _sync(path.parent, os.O_RDONLY)
    except FileError:
        raise
    except OSError as error:
        why = error.strerror or error
        raise FileError(
            f"cannot write {path} ({why}). Choose a folder that exists, may be written to and has room."
        ) from None
    finally:
        with suppress(OSError):
            new.unlink(missing_ok=True)


def _sync(path: Path, flags: int) -> None:
    """Have a file, or a folder's names, on the disk."""
    number = os.open(path, flags)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file as a whole, or not at all."""
    with write_whole(path) as new:
        new.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write a file as a whole, or not at all."""
    write_bytes(path, text.encode())


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a table; a NaN becomes an empty cell."""
    with write_whole(path) as new, open(new, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row in rows:
            writer.writerow(["" if isinstance(v, float) and math.isnan(v) else v for v in row])


def write_designs(path: Path, columns: Mapping[str, NDArray[Any]]) -> None:
    """Write a table of designs from its columns (designs,) by name; truth values become 0 and 1."""
    numbers = [v.astype(int) if v.dtype == bool else v for v in columns.values()]
    parts = (slice(i, i + 10_000) for i in range(0, len(numbers[0]), 10_000))  # lists take much memory
    rows = (row for part in parts for row in zip(*(v[part].tolist() for v in numbers), strict=True))
    write_csv(path, list(columns), rows)


def write_walk(path: Path, variables: Mapping[str, Variable], attributes: Mapping[str, str]) -> None:
    """Write the traces of a walk as NetCDF 3, which xarray, MATLAB and ncdump read, in SI units.

    `attributes` say something of the whole walk, such as the reason of its failure.
    """
    from scipy.io import netcdf_file

    content = io.BytesIO()  # on a disk that is full, scipy would try again and again
    with netcdf_file(content, "w", version=2) as file:
        order = {"foot_order": "left, right", "axis_order": "x (forward), z (up)"}
        for name, text in {"footopt": version("footopt"), **order, **attributes}.items():
            setattr(file, name, text)
        for dimensions, _, values in variables.values():
            for name, size in zip(dimensions, values.shape, strict=True):
                if name not in file.dimensions:
                    file.createDimension(name, size)
        for name, (dimensions, unit, values) in variables.items():
            variable = file.createVariable(name, "d", dimensions)
            if len(values):  # a walk that sank at once has no samples
                variable[...] = values
            variable.units = unit
        file.flush()
        written = content.getvalue()
    write_bytes(path, written)


def plain(value: Any) -> Any:
    """JSON's own types from numpy's, tuples and paths; null for what is not finite."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(item) for item in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return value if value is None else str(value)
