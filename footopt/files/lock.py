"""A lock a folder: one run at a time, and who it is."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from footopt.errors import FileError

try:
    import fcntl
except ImportError:  # Windows has no such locks: there, folders are not guarded
    fcntl = None  # type: ignore[assignment]  # a module, or none

LOCK = "footopt.lock"

_held: set[Path] = set()  # folders that this process has locked


class Occupied(FileError):
    """Another run is at work in a folder, or has left what it found there."""


@contextmanager
def locked(folder: Path, shared: bool = False) -> Iterator[None]:
    """Lock a folder for the block.

    The system lets go of a lock when its process dies, however that happens: what is left of it is taken
    over. Where a disk knows no locks the folder is not guarded.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    shared : bool
        Whether others that share it may work there, too.

    Raises
    ------
    Occupied
        Another process holds the lock; the message names it.
    """
    place = folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    if fcntl is None or place in _held:
        yield
        return
    path = place / LOCK
    with _acquire(path, shared) as file:
        _held.add(place)
        try:
            yield
        finally:
            _held.remove(place)
            if _alone(file):  # who shares the lock may still be at work
                path.unlink(missing_ok=True)


def _itself(path: str, flags: int) -> int:
    """Open a file, and not what a link of its name leads to."""
    return os.open(path, flags | os.O_NOFOLLOW, 0o666)


def _alone(file: IO[str]) -> bool:
    """Whether nobody else holds the lock that this process has."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _acquire(path: Path, shared: bool) -> IO[str]:
    """The open file that is the lock."""
    while True:
        if path.is_symlink():  # somebody has put it there: what it leads to is not ours to write
            path.unlink(missing_ok=True)
        file = open(path, "a+", encoding="utf-8", opener=_itself)  # noqa: SIM115  closed by the caller
        try:
            fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            who = file.read().strip() or "another process"
            file.close()
            raise Occupied(
                f"{path.parent}: {who} is at work in this folder. Wait until it has ended, or choose another."
            ) from None
        except OSError:  # a disk without locks
            return file
        if path.exists() and os.path.samestat(os.fstat(file.fileno()), path.stat()):
            file.truncate(0)
            file.write(f"process {os.getpid()} on {socket.gethostname()}")
            file.flush()
            return file
        file.close()  # its holder has just ended and removed it
