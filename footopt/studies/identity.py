"""Whether a run may be in a folder: as a new one, or as the one that goes on there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from footopt.errors import ERROR_FILE, FileError
from footopt.files import identity
from footopt.files.identity import LOCK, Occupied, differing
from footopt.files.io import plain, read_json_file

#: What a run may change when it goes on: how long, where and with what it ends, not what is searched.
CHANGEABLE = (
    "solver.n_gen", "solver.walks", "solver.seconds", "engine", "report", "choose", "study.confirm",
    "study.finalists", "study.store", "study.certify", "study.reuse", "study.video", "foot.block", "plugins",
)  # fmt: skip

LOG = "footopt.log"  # Hydra's, of what is logged
THROUGH = ("designs.sqlite", "exact", "figures", LOG)  # what a run opens, and does not replace


def may_change(name: str) -> bool:
    """Whether a setting is one of `CHANGEABLE`, or of a group of them."""
    return any(name == other or name.startswith(f"{other}.") for other in CHANGEABLE)


def result_of(folder: Path) -> Mapping[str, Any] | None:
    """What result.json says of the run in a folder; None if there is none."""
    path = folder / "result.json"
    found = read_json_file(path, "resume") if path.exists() else None
    if found is not None and not (isinstance(found, dict) and "settings" in found):
        raise FileError(f"{path}: is not the result of a run. Move it away.")
    return found


def is_finished(folder: Path) -> bool:
    """Whether the run in a folder has a result, and was not stopped before its last generation."""
    return finished(result_of(folder))


def finished(result: Mapping[str, Any] | None) -> bool:
    """Whether a run with such a result has one, and was not stopped before its last generation."""
    return result is not None and not result.get("interrupted", False)


def check_links(folder: Path) -> None:
    """Raise where a run would write through a link that somebody has put into its folder.

    Raises
    ------
    Occupied
        It names the link. All other files are written beside and put in place, which follows no link.
    """
    for path in (folder / name for name in THROUGH):
        if path.is_symlink():
            raise Occupied(f"{path}: is a link, and a run writes into its own folder only. Remove it.")


def enter(folder: Path, settings: Mapping[str, Any], words: Sequence[str]) -> None:
    """Begin a run in a folder, or go on with the same one that was stopped there: leave what it is.

    Raises
    ------
    Occupied
        The folder holds a finished run, or what another one has left.
    """
    other = "Choose another hydra.run.dir."
    if is_finished(folder):
        raise Occupied(f"{folder}: holds a run that is finished; footopt resume=... extends it. {other}")
    begun = (folder / identity.FILE).exists()
    left = {path.name for path in folder.iterdir()} - {identity.FILE, LOCK, LOG, ERROR_FILE}
    if left & {"result.json", "designs.sqlite"} or (begun and left):
        there = identity.read(folder, "hydra.run.dir").settings if begun else {}
        if names := differing(settings, there):
            raise Occupied(
                f"{folder}: holds another run, which differs in {', '.join(names[:4])}. "
                f"footopt resume=... goes on with it. {other}"
            )
    identity.write(folder, settings, words)


def check_same(folder: Path, settings: Mapping[str, Any], found: Mapping[str, Any] | None) -> None:
    """Raise unless the settings of a run are those that its result was found with, but for `CHANGEABLE`.

    Raises
    ------
    FileError
        The result is that of another run.
    """
    if found is None:
        return
    names = [name for name in differing(plain(settings), found.get("settings")) if not may_change(name)]
    if names:
        raise FileError(
            f"resume = {str(folder)!r}: its result.json is that of another run: {', '.join(names[:4])} "
            f"differ from {identity.FILE}. Start a new run."
        )
