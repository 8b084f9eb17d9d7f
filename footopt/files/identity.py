"""A run's folder: what run it is and what it is made with, and the lock that it holds while it is at work."""

from __future__ import annotations

import hashlib
import json
import platform
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from glob import escape, glob
from importlib.metadata import distribution, version
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import yaml

from footopt.compiled import processor
from footopt.errors import ERROR_FILE, FileError
from footopt.files.io import read_text, write_text

FILE, LOCK = "footopt.yaml", "footopt.lock"
HEAD = """\
# What this run is: its settings, resolved. `footopt resume=FOLDER` goes on with them.
# Changes made by hand are refused: other settings are a run of their own.
"""
DISTRIBUTIONS = (
    "footopt", "numpy", "scipy", "numba", "llvmlite", "pymoo", "moocore", "hydra-core", "matplotlib",
)  # fmt: skip
ROOT = Path(__file__).parents[2]  # of a checkout


class Identity(NamedTuple):
    """What a run is.

    Parameters
    ----------
    settings : dict
        All settings in YAML's types.
    overrides : tuple of str
        What was given on the command line, to tell runs apart in tables.
    version : str
        Of the footopt that has written it.
    """

    settings: Mapping[str, Any]
    overrides: tuple[str, ...]
    version: str


class Occupied(FileError):
    """Another run is at work in a folder, or has left what it found there."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Lock a folder for the block; it is made if it is not there.

    The system releases the lock of a process that dies, however that happens.

    Raises
    ------
    Occupied
        Another process holds the lock.
    FileError
        Something that is no file has the lock's name.
    """
    from filelock import FileLock, Timeout

    folder.mkdir(parents=True, exist_ok=True)
    path = folder.resolve() / LOCK
    if path.exists() and not path.is_file():
        raise FileError(
            f"{path}: is no file, and a run locks its folder by a file of this name. Move it away."
        )
    lock = FileLock(path, timeout=0, thread_local=False, is_singleton=True)  # a process may lock it twice
    try:
        lock.acquire()
    except Timeout:
        raise Occupied(
            f"{folder}: another run is at work in this folder. Wait until it has ended, or choose another."
        ) from None
    try:
        yield
    finally:
        if lock.lock_counter == 1:
            with suppress(OSError):  # Windows removes no open file
                path.unlink()
        lock.release()


def write(folder: Path, settings: Mapping[str, Any], overrides: Sequence[str]) -> None:
    """Write down what a run is."""
    content = {"footopt": version("footopt"), "overrides": list(overrides), "settings": dict(settings)}
    content["digest"] = _digest(content)
    write_text(folder / FILE, HEAD + yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=100))


def missing_file_error(folder: Path, file: str) -> str:
    """Why a folder without a file is none of a run."""
    return f"it has no {file}" if folder.is_dir() else "there is no such folder"


def read(folder: Path, setting: str = "resume") -> Identity:
    """What the run in a folder is.

    Raises
    ------
    FileError
        There is no run, or its file has been changed or damaged.
    """
    path = folder / FILE
    if not path.exists():
        raise FileError(
            f"{setting} = {str(folder)!r}: not the folder of a run ({missing_file_error(folder, FILE)}). "
            "Give one such as outputs/optimize/2026-01-31_12-00-00-000000."
        )
    try:
        content = yaml.safe_load(read_text(path, setting))
        sound = content.pop("digest") == _digest(content) and "${" not in json.dumps(content)
        found = Identity(
            dict(content["settings"]), tuple(map(str, content["overrides"])), str(content["footopt"])
        )
    except FileError:
        raise
    except Exception:  # whatever can be wrong with a file that somebody has changed
        sound = False
    if not sound:
        raise FileError(
            f"{setting} = {str(folder)!r}: {FILE} has been changed since the run began, or is damaged. "
            "Other settings are a run of their own: start a new run."
        )
    return found


def _digest(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def runs(pattern: str | Path) -> list[Path]:
    """Folders of all runs in or below the folders that a pattern names, in order."""
    roots = [Path(found) for found in glob(str(pattern), recursive=True)]
    left = (path for root in roots for file in (FILE, ERROR_FILE, "result.json") for path in root.rglob(file))
    return sorted({path.parent for path in left}, key=order)


def jobs(folder: Path) -> list[Path]:
    """Folders of the jobs of a multirun, in order, whatever hydra.sweep.subdir calls them."""
    numbered = {path for path in folder.iterdir() if path.name.isdecimal()}
    return sorted(numbered | {*runs(escape(str(folder)))} - {folder}, key=order)


def order(folder: Path) -> tuple[str, int, str]:
    """Sort key of a run's folder: job 10 of a multirun comes after job 9."""
    return str(folder.parent), int(folder.name) if folder.name.isdecimal() else -1, folder.name


def changed_settings(one: Any, other: Any, name: str = "") -> list[str]:
    """Full names of the settings in which two sets of them differ."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        names = dict.fromkeys([*one, *other])
        return [
            found
            for key in names
            for found in changed_settings(one.get(key), other.get(key), f"{name}.{key}" if name else str(key))
        ]
    return [] if one == other else [name]


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
        command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
        with suppress(OSError, subprocess.SubprocessError):
            found = subprocess.run(command, capture_output=True, text=True, timeout=5, check=True)
            return found.stdout.strip()
    origin = distribution("footopt").read_text("direct_url.json") or "{}"  # of one that pip took from git
    known: str | None = json.loads(origin).get("vcs_info", {}).get("commit_id")
    return known
