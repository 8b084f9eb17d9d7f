"""`Store`: evaluated designs in an SQLite file, so that no walk is lost and none is done twice.

A design is kept under its heights and its context, a digest of all that determines the result to the
last bit: scene, accuracy, the space's geometry, the names recorded, the sources of the walk, the
versions of the libraries, and the processor that it is compiled for. A search with the same seed
asks for the same designs in the same order, so that a search is resumed by running it again: what
it had is read, what is missing is walked, and the result is that of a search never stopped.
Nothing is pickled: numbers are kept as the bytes of their doubles.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import sqlite3
import stat
import time
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.design.problem import FootProblem
from footopt.errors import FileError
from footopt.files.reading import named
from footopt.walk.objectives import OBJECTIVES
from footopt.walk.sources import is_own, source, text_of
from footopt.walk.steppers import STEPPERS

Array = NDArray[np.float64]

PACKAGE = Path(__file__).parent.parent
APPLICATION = int.from_bytes(b"foot")  # marks the file as ours (SQLite's application_id)
LAYOUT = 1  # of the tables below (SQLite's user_version)
PATIENCE = 30.0  # s, for another process that writes
SHOWN = 4  # differences between two contexts that a message names

TABLES = """
CREATE TABLE context (id INTEGER PRIMARY KEY, digest TEXT NOT NULL UNIQUE, description TEXT NOT NULL);
CREATE TABLE design (
    context INTEGER NOT NULL,
    k TEXT NOT NULL,
    record BLOB NOT NULL,
    reason TEXT NOT NULL,
    message TEXT NOT NULL,
    checksum INTEGER NOT NULL,
    PRIMARY KEY (context, k)
) WITHOUT ROWID;
"""

#: What SQLite's errors mean to a user, and what he can do, by their primary code.
MEANING = {
    sqlite3.SQLITE_NOTADB: ("is not a store of footopt", "Choose another study.store."),
    sqlite3.SQLITE_CORRUPT: ("is damaged", "Move it away, or choose another study.store."),
    sqlite3.SQLITE_FULL: ("cannot grow", "Make room on the disk; what is in it is safe. Then resume."),
    sqlite3.SQLITE_IOERR: ("cannot be written", "Is the disk full? What is in it is safe. Then resume."),
    sqlite3.SQLITE_READONLY: ("cannot be written", "Choose a study.store in a folder that can."),
    sqlite3.SQLITE_CANTOPEN: ("cannot be opened", "Choose a study.store in a folder that can be written."),
    sqlite3.SQLITE_BUSY: (f"has been locked for {PATIENCE:g} s", "Does another program hold it?"),
}


class Evaluation(NamedTuple):
    """What is kept of a design: recorded values (record,), why its walk failed, what it raised."""

    values: Array
    reason: str
    message: str = ""


class Store:
    """The evaluations of one problem in an SQLite file that other problems and processes may share.

    Parameters
    ----------
    path : of the file; made if it is not there.
    problem : whose designs are read and added.

    Raises
    ------
    FileError : the file cannot be used: it is something else, damaged, of another version of
        footopt, locked, or cannot be written. It is left as it is.
    """

    def __init__(self, path: str | Path, problem: FootProblem) -> None:
        self.path, self.problem = Path(path), problem
        self._columns = len(problem.record)
        self._context = context(problem)
        self._digest = digest(self._context)
        self._connection: sqlite3.Connection | None = None
        self._check_place()
        with self._explained():
            self._connection = sqlite3.connect(self.path, timeout=PATIENCE, isolation_level=None)
        try:
            with self._explained() as connection:
                self._identify(connection)
                _log_ahead(connection)
                self._id = self._enter_context(connection)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __len__(self) -> int:
        """Designs of this problem."""
        with self._explained() as connection:
            query = "SELECT COUNT(*) FROM design WHERE context = ?"
            return int(connection.execute(query, (self._id,)).fetchone()[0])

    def get(self, k: Sequence[Sequence[int]]) -> list[Evaluation | None]:
        """What is known of each design."""
        query = "SELECT record, reason, message, checksum FROM design WHERE context = ? AND k = ?"
        with self._explained() as connection:
            keys = [_key(heights) for heights in k]
            rows = [connection.execute(query, (self._id, key)).fetchone() for key in keys]
        return [None if row is None else self._read(key, *row) for key, row in zip(keys, rows, strict=True)]

    def add(self, k: Sequence[Sequence[int]], evaluations: Sequence[Evaluation]) -> None:
        """Keep designs, all or none; one that another process has added meanwhile is the same."""
        rows = []
        for heights, (values, reason, message) in zip(k, evaluations, strict=True):
            key, record = _key(heights), np.asarray(values, "<f8").tobytes()
            checksum = self._checksum(key, record, reason, message)
            rows.append((self._id, key, record, reason, message, checksum))
        with self._explained() as connection, _transaction(connection):
            insert = "INSERT INTO design VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (context, k) DO NOTHING"
            connection.executemany(insert, rows)

    def describe(self) -> str:
        """What can be used of the file, in one line; if nothing, why; "" for a new one."""
        if known := len(self):
            return f"{known} designs of this search are known from {self.path}"
        with self._explained() as connection:
            others = connection.execute(
                "SELECT description, digest FROM context WHERE id != ? "
                "AND EXISTS (SELECT 1 FROM design WHERE context = context.id)",
                (self._id,),
            ).fetchall()
        found = [
            differences(json.loads(text), self._context)
            for text, expected in others
            if hashlib.sha256(str(text).encode()).hexdigest() == expected
        ]
        if not found:
            return ""
        nearest = min(found, key=len)
        return f"No design in {self.path} can be used again: {listed(nearest)} differ"

    def close(self) -> None:
        """Let go of the file."""
        if self._connection is not None:
            self._connection.close()

    def _check_place(self) -> None:
        """Raise where no store can be; of a pipe, SQLite would wait for the other end."""
        try:
            mode = os.stat(self.path).st_mode
        except FileNotFoundError:
            return
        except (OSError, ValueError) as error:  # a name that is too long, or has a NUL in it
            raise self._error(*MEANING[sqlite3.SQLITE_CANTOPEN], str(error)) from None
        if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
            raise self._error(*MEANING[sqlite3.SQLITE_NOTADB], "no file")

    def _identify(self, connection: sqlite3.Connection) -> None:
        """Make the tables in an empty file; refuse any other that is not a store of this layout."""
        with _transaction(connection):
            application, layout = (
                connection.execute(f"PRAGMA {name}").fetchone()[0]
                for name in ("application_id", "user_version")
            )
            tables = connection.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()[0]
            if (application, layout, tables) == (0, 0, 0):
                for statement in TABLES.split(";"):
                    connection.execute(statement)
                connection.execute(f"PRAGMA application_id = {APPLICATION}")
                connection.execute(f"PRAGMA user_version = {LAYOUT}")
                return
        if application != APPLICATION:
            raise self._error(*MEANING[sqlite3.SQLITE_NOTADB], "an SQLite file of another program")
        if layout != LAYOUT:
            raise self._error(
                "was made by another version of footopt",
                "Use that version, or choose another study.store.",
                f"its layout is {layout}, this version's {LAYOUT}",
            )
        problems = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
        if problems != "ok":
            raise self._error(*MEANING[sqlite3.SQLITE_CORRUPT], str(problems).replace("\n", " "))

    def _enter_context(self, connection: sqlite3.Connection) -> int:
        query = "SELECT id FROM context WHERE digest = ?"
        found = connection.execute(query, (self._digest,)).fetchone()
        if found is None:
            with _transaction(connection):
                connection.execute(
                    "INSERT INTO context (digest, description) VALUES (?, ?) ON CONFLICT DO NOTHING",
                    (self._digest, canonical(self._context)),
                )
                found = connection.execute(query, (self._digest,)).fetchone()
        if found is None or not isinstance(found[0], int):
            raise self._error(*MEANING[sqlite3.SQLITE_CORRUPT], "its table of contexts")
        return found[0]

    def _read(self, key: str, record: Any, reason: Any, message: Any, checksum: Any) -> Evaluation:
        """A row as an evaluation; SQLite itself does not notice a number that has changed on disk."""
        if not isinstance(record, bytes) or self._checksum(key, record, reason, message) != checksum:
            raise self._error(*MEANING[sqlite3.SQLITE_CORRUPT], f"design {key} fails its checksum")
        return Evaluation(np.frombuffer(record, "<f8").astype(np.float64), reason, message)

    def _checksum(self, key: str, record: bytes, reason: object, message: object) -> int:
        text = f"{self._digest} {key} {reason} {message} {self._columns}"
        return zlib.crc32(record, zlib.crc32(text.encode(errors="replace")))

    @contextmanager
    def _explained(self) -> Iterator[sqlite3.Connection]:
        """The connection; SQLite's errors in the user's terms."""
        try:
            yield self._connection  # type: ignore[misc]
        except sqlite3.ProgrammingError:  # a store that has been closed
            raise
        except (sqlite3.Error, UnicodeDecodeError) as error:  # damage can be in the error's own words
            code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF
            meaning = MEANING.get(code, MEANING[sqlite3.SQLITE_CORRUPT])
            raise self._error(*meaning, str(error)) from None

    def _error(self, what: str, hint: str, detail: str) -> FileError:
        return FileError(f"{named(self.path, 'study.store')}: {what} ({detail}). {hint}")


def context(problem: FootProblem) -> dict[str, Any]:
    """All that determines what is recorded of a design, in JSON's types.

    The box's tolerance and the choice of objectives are not in it: they judge what is recorded.
    """
    space = plain(problem.space)
    del space["box_tolerance"]
    stepper = STEPPERS[problem.accuracy.stepper].parameters
    laws = [effect.law for effect in problem.scene.effects if effect.law is not None]
    return {
        "problem": type(problem).__name__,
        **{name: plain(value) for name, value in problem.conditions.items()},
        "accuracy": plain(problem.accuracy),
        "space": space,
        "record": plain(problem.record),
        "judges": {  # a user's own objectives
            name: hashlib.sha256(text_of(OBJECTIVES[name].value)).hexdigest()
            for name in problem.record
            if name in OBJECTIVES and is_own(OBJECTIVES[name].value)
        },
        "sources": _sources(),
        "compiled": source(stepper, laws),  # with a user's own stepper and effects
        "versions": {name: version(name) for name in ("numpy", "scipy", "numba", "llvmlite")},
        "machine": machine(),
    }


@cache
def machine() -> dict[str, str]:
    """What numba compiles for: results are the same, bit for bit, only where this is."""
    from numba.core.registry import cpu_target

    system, processor, features = cpu_target.target_context.codegen().magic_tuple()
    return {
        "system": system,
        "processor": processor,
        "features": hashlib.sha256(features.encode()).hexdigest(),
    }


@cache
def _sources() -> str:
    """A digest of every source that a walk goes through."""
    found = hashlib.sha256((PACKAGE / "compiled.py").read_bytes())
    for package in ("sand", "effects", "foot", "gait", "walk"):
        for path in sorted((PACKAGE / package).rglob("*.py")):
            found.update(path.read_bytes())
    return found.hexdigest()


def plain(value: Any) -> Any:
    """Frozen data in JSON's types, with its class, by the fields that it is compared by; arrays, scalars."""
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value) if field.compare]
        return {"class": type(value).__name__} | {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        named = zip(value._fields, value, strict=True)
        return {"class": type(value).__name__} | {name: plain(item) for name, item in named}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return {
            "class": f"ndarray {value.dtype}",
            "shape": list(value.shape),
            "items": value.ravel().tolist(),
        }
    if isinstance(value, np.generic):
        return plain(value.item())
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"a {type(value).__name__} cannot be part of a store's context")


def canonical(content: Any) -> str:
    """The one JSON text of some content; floats by their shortest digits that read back exactly."""
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def digest(content: Any) -> str:
    """SHA-256 of the canonical JSON."""
    return hashlib.sha256(canonical(content).encode()).hexdigest()


def differences(there: Any, here: Any) -> list[str]:
    """What differs between two contexts, each with both values."""
    one, other = _flat(there), _flat(here)
    names = [name for name in sorted(one | other) if one.get(name) != other.get(name)]
    return [f"{n} ({_short(one.get(n))} there, {_short(other.get(n))} here)" for n in names]


def listed(found: Sequence[str]) -> str:
    """The first few of many differences."""
    more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
    return f"{', '.join(found[:SHOWN])}{more}"


def _log_ahead(connection: sqlite3.Connection) -> None:
    """A transaction then survives the death of the process as soon as it is in the log, without a sync."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL").fetchall()
            break
        except sqlite3.OperationalError as error:  # the one lock for which SQLite itself does not wait
            if error.sqlite_errorcode != sqlite3.SQLITE_BUSY or time.monotonic() > deadline:
                raise
            time.sleep(0.01)
    connection.execute("PRAGMA synchronous = NORMAL")


@contextmanager
def _transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """All or nothing, also when it is interrupted."""
    try:
        connection.execute("BEGIN IMMEDIATE")
        yield
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:  # SQLite itself rolls back when a disk is full
            connection.execute("ROLLBACK")
        raise


def _key(heights: Sequence[int]) -> str:
    return ",".join(map(str, heights))


def _flat(content: Any, name: str = "") -> dict[str, Any]:
    """Nested content as one level: {"scene.sand.zeta": 5.0, ...}."""
    if isinstance(content, dict):
        items: Any = content.items()
    elif isinstance(content, list):
        items = enumerate(content)
    else:
        return {name: content}
    flat: dict[str, Any] = {}
    for key, item in items:
        flat |= _flat(item, f"{name}.{key}" if name else str(key))
    return flat


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= 20 else text[:8] + "..."
