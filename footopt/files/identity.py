"""A run's folder: its identity, its lock while the run is at work, and the versions that it is made with."""

import platform
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from glob import glob
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from footopt.design.store import differences
from footopt.errors import ERROR_FILE, FileError
from footopt.files.io import read_json_file, read_text, write_text

FILE, LOCK = "footopt.yaml", "footopt.lock"
LOG = "footopt.log"  # Hydra's, of what is logged
HEAD = "# This run's settings, resolved: footopt resume=FOLDER goes on with them; others are another run.\n"
DISTRIBUTIONS = (
    "footopt", "numpy", "scipy", "numba", "llvmlite", "pymoo", "moocore", "hydra-core", "matplotlib",
)  # fmt: skip


class Identity(NamedTuple):
    """A run."""

    settings: Mapping[str, Any]  # all of them, in YAML's types
    overrides: tuple[str, ...]  # of the command line, to tell runs apart in tables
    version: str  # of the footopt that has written it


class Occupied(FileError):
    """Another run is at work in a folder, or has left files there."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Lock a folder, which is made if it is not there, for the block; `Occupied` if another process does.

    The system releases the lock of a process that dies, however that happens.
    """
    from filelock import FileLock, Timeout

    folder.mkdir(parents=True, exist_ok=True)
    path = folder.resolve() / LOCK
    lock = FileLock(path, timeout=0, thread_local=False, is_singleton=True)  # a process may lock it twice
    try:
        lock.acquire()
    except Timeout:
        raise Occupied(f"{folder}: another run is at work in this folder. Choose another.") from None
    except OSError as error:  # some network drives lock nothing
        raise FileError(f"{folder}: cannot be locked ({error}). Choose a folder elsewhere.") from None
    try:
        yield
    finally:
        if lock.lock_counter == 1:
            with suppress(OSError):  # Windows removes no open file
                path.unlink()
        lock.release()


def write(folder: Path, settings: Mapping[str, Any], overrides: Sequence[str]) -> None:
    """Write the identity of a run to its folder."""
    content = {"footopt": version("footopt"), "overrides": list(overrides), "settings": dict(settings)}
    write_text(folder / FILE, HEAD + yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=100))


def missing_file_error(folder: Path, file: str) -> str:
    """Why a folder is not that of a run: a file is missing, or the folder itself."""
    return f"it has no {file}" if folder.is_dir() else "there is no such folder"


def read(folder: Path, setting: str = "resume") -> Identity:
    """The run in a folder; `FileError` if there is none, or if its file is damaged."""
    path, named = folder / FILE, f"{setting} = {str(folder)!r}"
    if not path.exists():
        raise FileError(
            f"{named}: not the folder of a run ({missing_file_error(folder, FILE)}). "
            "Give one such as outputs/optimize/2026-01-31_12-00-00-000000."
        )
    text = read_text(path, setting)
    with suppress(yaml.YAMLError, AttributeError, KeyError, TypeError, ValueError):  # changed by hand
        content = yaml.safe_load(text)
        if "${" not in text:  # settings are resolved
            return Identity(content["settings"], tuple(content["overrides"]), content["footopt"])
    raise FileError(f"{named}: {FILE} is damaged. Start a new run.")


def result_of(folder: Path) -> Mapping[str, Any] | None:
    """The result.json of the run in a folder; None if there is none."""
    path = folder / "result.json"
    found = read_json_file(path, "resume") if path.exists() else None
    if found is not None and not (isinstance(found, dict) and "settings" in found):
        raise FileError(f"{path}: is not the result of a run. Move it away.")
    return found


def finished(result: Mapping[str, Any] | None) -> bool:
    """Whether a run has a result, and was not interrupted before its last generation."""
    return result is not None and not result.get("interrupted", False)


def runs(pattern: str | Path) -> list[Path]:
    """Folders of all runs in or below the folders that a pattern names, in order."""
    roots = [pattern] if Path(pattern).is_dir() else glob(str(pattern), recursive=True)
    names = (FILE, ERROR_FILE, "result.json")
    left = (path for root in roots for name in names for path in Path(root).rglob(name))
    return sorted({path.parent for path in left}, key=order)


def jobs(folder: Path) -> list[Path]:
    """Folders of the jobs of a multirun, in order, whatever hydra.sweep.subdir calls them."""
    numbered = {path for path in folder.iterdir() if path.name.isdecimal()}
    return sorted(numbered | {*runs(folder)} - {folder}, key=order)


def order(folder: Path) -> tuple[str, int, str]:
    """Sort key of a run's folder: job 10 of a multirun comes after job 9."""
    return str(folder.parent), int(folder.name) if folder.name.isdecimal() else -1, folder.name


def claim_folder(folder: Path, settings: Mapping[str, Any], overrides: Sequence[str]) -> None:
    """Write a run's identity to its folder; `Occupied` if a finished run, or another's files, are there."""
    other = "Choose another hydra.run.dir."
    if finished(result_of(folder)):
        raise Occupied(f"{folder}: holds a run that is finished; footopt resume=... extends it. {other}")
    begun = (folder / FILE).exists()
    left = {path.name for path in folder.iterdir()} - {FILE, LOCK, LOG, ERROR_FILE}
    if left & {"result.json", "designs.sqlite"} or (begun and left):
        if not begun:
            raise Occupied(f"{folder}: holds files of a run, and no {FILE} that says of which. {other}")
        if names := [*differences(settings, read(folder, "hydra.run.dir").settings)]:
            raise Occupied(
                f"{folder}: holds another run, which differs in {', '.join(names[:4])}. "
                f"footopt resume=... goes on with it. {other}"
            )
    write(folder, settings, overrides)


@cache
def versions() -> dict[str, str]:
    """Versions of everything that a result depends on."""
    return {name: version(name) for name in DISTRIBUTIONS} | {"python": platform.python_version()}
