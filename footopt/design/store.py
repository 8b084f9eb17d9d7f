"""`Store`: evaluated designs in an SQLite file, so that no walk is lost and none is done twice.

A design is kept under its heights and its key: all that determines its values, to the last bit, which is a
row of the table `context`. A search with the same seed asks for the same designs in the same order, so that a
search is resumed by running it again: what it had is read, what is missing is walked.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import sqlite3
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from footopt.arrays import Array, Ints, Words
from footopt.compiled import sources, target
from footopt.design.problem import FootProblem, rows_as_bytes
from footopt.errors import FileError, named, shortened
from footopt.walk.objectives import MEASURES
from footopt.walk.own_code import fingerprint, is_own, own_code
from footopt.walk.steppers import STEPPERS

APPLICATION = int.from_bytes(b"foot")  # marks the file as ours (SQLite's application_id)
LAYOUT = 6  # of the tables below (SQLite's user_version)
PATIENCE = 30.0  # s, for another process that writes
ERROR = "error:"  # what the reason of a design begins with whose walk has raised an exception
#: Parts of a key that are no settings: the same settings may be evaluated by other code, on another machine.
CODE = ("own", "versions", "machine")
VALUE = "<f8"  # of values in its tables
ASKED = 1000  # designs at a time: SQLite takes 32,766 arguments
SHOWN = 4  # differences between two keys that a message names

TABLES = """
CREATE TABLE context (id INTEGER PRIMARY KEY, digest TEXT NOT NULL UNIQUE, description TEXT NOT NULL);
CREATE TABLE design (
    id INTEGER PRIMARY KEY, context INTEGER NOT NULL,
    k BLOB NOT NULL, record BLOB NOT NULL, reason TEXT NOT NULL
);
"""
WALKED = f"reason NOT LIKE '{ERROR}%'"  # rows whose walk has raised no exception


class Store(AbstractContextManager["Store"]):
    """The evaluations of one problem in an SQLite file that other problems and processes may share.

    Parameters
    ----------
    path : str or Path
        Of the file; made if it is not there.
    problem : FootProblem
        Whose designs are read and added.
    reuse : bool
        Whether to read designs of the same settings, too, that other versions or machines have walked. Their
        values may differ from what would be walked here.

    Attributes
    ----------
    foreign : list of str
        What differs between this program and the one that walked the designs of the same settings; empty
        where there are none of others, or there are own ones.
    nearest : list of str
        How this problem differs from the most similar one in the file; empty where it has designs itself.

    Raises
    ------
    FileError
        The file cannot be used: it is something else, damaged, of another version of footopt, locked, or
        cannot be written. It is left as it is.
    """

    def __init__(self, path: str | Path, problem: FootProblem, reuse: bool = False) -> None:
        self.path, self.problem = Path(path), problem
        self._key = key_of(problem)
        try:
            self._connection = sqlite3.connect(self.path, timeout=PATIENCE, isolation_level=None)
        except sqlite3.Error as error:
            raise self._error(error) from None
        try:
            with self._explained() as connection:
                self._make_or_check(connection)
                self._id = self._enter(connection)
            others = self._others()
            code = {i: names for i, names in others.items() if all(name.startswith(CODE) for name in names)}
            self.foreign = min(code.values(), key=len, default=[]) if reuse or not len(self) else []
            self.nearest = [] if len(self) else min(others.values(), key=len, default=[])
            self._read_from = (self._id, *(code if reuse else ()))
            # the rows of designs, of this problem and of others that it reads, as of the last look
            self._own, self._foreign = dict[bytes, int](), dict[bytes, int]()
            self._version, self._last = None, 0
        except BaseException:
            self.close()
            raise

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        self._connection.close()

    def __len__(self) -> int:
        """Designs of this problem that have been walked."""
        with self._explained() as connection:
            query = f"SELECT COUNT(*) FROM design WHERE context = ? AND {WALKED}"
            return int(connection.execute(query, (self._id,)).fetchone()[0])

    def get(self, k: Ints) -> tuple[Array, Words]:
        """Recorded values (designs, record) of designs (designs, n), and the reasons of failed walks.

        The reason of a design that is not known is `ERROR`.
        """
        width = len(self.problem.record)
        values, reasons = np.full((len(k), width), np.nan), np.full(len(k), ERROR, object)
        with self._explained() as connection:
            self._look(connection)
            rows = [self._own.get(key, self._foreign.get(key)) for key in rows_as_bytes(k)]
            there = [row for row in rows if row is not None]
            found: dict[int, Sequence[Any]] = {}
            for some in (there[i : i + ASKED] for i in range(0, len(there), ASKED)):
                query = f"SELECT id, record, reason FROM design WHERE id IN ({', '.join('?' * len(some))})"
                found |= {row: rest for row, *rest in connection.execute(query, some)}
        for i, row in enumerate(rows):
            if row is not None:
                record, reasons[i] = found[row]
                values[i] = np.frombuffer(record, VALUE)
        return values, reasons

    def add(self, k: Ints, values: Array, reasons: Words) -> None:
        """Keep designs, all or none; what is known stays, unless its walk had raised an exception."""
        columns = rows_as_bytes(k), rows_as_bytes(values, VALUE), reasons.tolist()
        with self._explained() as connection, _transaction(connection):
            self._look(connection)
            first = 1 + (connection.execute("SELECT MAX(id) FROM design").fetchone()[0] or 0)
            new = [one for one in zip(*columns, strict=True) if one[0] not in self._own]
            rows = [(i, self._id, *one) for i, one in enumerate(new, first)]
            connection.executemany("INSERT INTO design VALUES (?, ?, ?, ?, ?)", rows)
        self._own.update((key, i) for i, _, key, _, why in rows if not why.startswith(ERROR))

    def _look(self, connection: sqlite3.Connection) -> None:
        """Note the rows of designs that other connections have added since the last look."""
        version = connection.execute("PRAGMA data_version").fetchone()
        if version == self._version:
            return
        marks = ", ".join("?" * len(self._read_from))
        query = f"SELECT context, k, id FROM design WHERE context IN ({marks}) AND id > ? AND {WALKED}"
        for context, key, row in connection.execute(query, (*self._read_from, self._last)):
            (self._own if context == self._id else self._foreign)[key] = row
            self._last = max(self._last, row)
        self._version = version

    def describe(self) -> str:
        """One line about the designs that can be used, or those that other code evaluated; or ""."""
        if known := len(self):
            return f"{known} designs of this search are known from {self.path}"
        used = "used again" if len(self._read_from) > 1 else "not used"
        told = f"Designs in {self.path} of other code are {used}: {listed(self.foreign)} differ"
        return told if self.foreign else ""

    def _others(self) -> dict[int, list[str]]:
        """Other keys that have designs, and how they differ."""
        query = "SELECT id, description FROM context WHERE id != ? AND id IN (SELECT context FROM design)"
        with self._explained() as connection:
            rows = connection.execute(query, (self._id,)).fetchall()
        return {number: [*differences(json.loads(text), self._key).values()] for number, text in rows}

    def _make_or_check(self, connection: sqlite3.Connection) -> None:
        """Make the tables in an empty file; refuse any other that is not a store of this layout."""
        with _transaction(connection):
            queries = "PRAGMA application_id", "PRAGMA user_version", "SELECT COUNT(*) FROM sqlite_master"
            application, layout, tables = (connection.execute(one).fetchone()[0] for one in queries)
            if (application, layout, tables) == (0, 0, 0):
                for statement in TABLES.split(";"):
                    connection.execute(statement)
                connection.execute(f"PRAGMA application_id = {APPLICATION}")
                connection.execute(f"PRAGMA user_version = {LAYOUT}")
            elif application != APPLICATION:
                raise self._error("it is an SQLite file of another program")
            elif layout != LAYOUT:
                raise self._error(f"of another version of footopt: its layout is {layout}, not {LAYOUT}")
        _log_ahead(connection)

    def _enter(self, connection: sqlite3.Connection) -> int:
        """The number of this problem's key in the file."""
        name = digest(self._key)
        query = "SELECT id FROM context WHERE digest = ?"
        with _transaction(connection):
            if (row := connection.execute(query, (name,)).fetchone()) is not None:
                return int(row[0])
            insert = "INSERT INTO context (digest, description) VALUES (?, ?)"
            return int(connection.execute(insert, (name, canonical(self._key))).lastrowid or 0)

    @contextmanager
    def _explained(self) -> Iterator[sqlite3.Connection]:
        """The connection; SQLite's errors in the user's terms."""
        try:
            yield self._connection
        except sqlite3.Error as error:
            raise self._error(error) from None

    def _error(self, why: object) -> FileError:
        hint = "Choose another study.store, in a folder that can be written and has room."
        return FileError(f"{named(self.path, 'study.store')}: cannot be used ({why}). {hint}")


def _log_ahead(connection: sqlite3.Connection) -> None:
    """Turn on the write-ahead log: a transaction in it survives the death of the process without a sync."""
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
    with connection:
        connection.execute("BEGIN IMMEDIATE")
        yield


def key_of(problem: FootProblem) -> dict[str, Any]:
    """All that determines what is recorded of a design, in JSON's types; the box's tolerance does not."""
    space = typed_json(problem.space)
    del space["box_tolerance"]
    stepper = STEPPERS[problem.accuracy.stepper]
    scenes = [scenario.scene for scenario in getattr(problem, "scenarios", ())] or [problem.scene]
    judges = [MEASURES[name].value for name in problem.record if name in MEASURES]
    kinds = type(problem).__mro__
    own = [*judges, *own_code((), stepper.parameters), *kinds[: kinds.index(FootProblem)]]
    own += [each for scene in scenes for each in scene.own()]
    digests: dict[str, str] = {}
    for name, digest in map(fingerprint, filter(is_own, own)):
        digests[name] = digests.get(name, "") + digest * (digest not in digests.get(name, ""))
    return {
        "problem": type(problem).__name__,
        **{name: typed_json(value) for name, value in problem.conditions.items()},
        "accuracy": typed_json(problem.accuracy),
        "stepper": typed_json(stepper),  # a plugin may give a name to other parameters
        "space": space,
        "record": typed_json(problem.record),
        # the files of a user's own objectives, effects, stepper and problem
        "own": digests,
        "versions": _versions(),
        "machine": target(),
    }


@cache
def _versions() -> dict[str, str]:
    names = ("footopt", "numpy", "scipy", "numba", "llvmlite")
    made_of = [*sources(), Path(__file__).with_name("robust.py")]  # which makes values of several walks
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in made_of)).hexdigest()[:16]
    found = {name: version(name) for name in names} | {"python": "{}.{}".format(*sys.version_info)}
    return found | {"sources": digest}  # an edit of footopt's own does not change its version


def typed_json(value: Any) -> Any:
    """Frozen data in JSON's types: objects by their class and the fields they compare; arrays, scalars."""
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value) if field.compare]
        return {"class": type(value).__name__} | {name: typed_json(getattr(value, name)) for name in names}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return {"class": type(value).__name__} | typed_json(value._asdict())
    if isinstance(value, (list, tuple)):
        return [typed_json(item) for item in value]
    if isinstance(value, dict):
        return {str(key): typed_json(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        kind = f"ndarray {value.dtype}"
        return {"class": kind, "shape": list(value.shape), "items": value.ravel().tolist()}
    if isinstance(value, np.generic):
        return typed_json(value.item())
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"a {type(value).__name__} cannot be part of a store's key")


def canonical(content: Any) -> str:
    """The one JSON text of some content; floats by their shortest digits that read back exactly."""
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def digest(content: Any) -> str:
    """SHA-256 of the canonical JSON."""
    return hashlib.sha256(canonical(content).encode()).hexdigest()


def differences(there: Any, here: Any, name: str = "") -> dict[str, str]:
    """What differs between two keys, or the settings of two runs: both values in words, by full names."""
    if isinstance(there, list) and isinstance(here, list) and there and isinstance(there[0], Mapping):
        there, here = (dict(enumerate(each)) for each in (there, here))
    if isinstance(there, Mapping) and isinstance(here, Mapping):
        inner = (differences(there.get(n), here.get(n), f"{name}.{n}".lstrip(".")) for n in {**there, **here})
        return {full: told for part in inner for full, told in part.items()}
    one, other = (shortened(str(each), 20) for each in (there, here))
    return {} if there == here else {name: f"{name} ({one} there, {other} here)"}


def listed(found: Sequence[str]) -> str:
    """The first few of many differences."""
    more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
    return f"{', '.join(found[:SHOWN])}{more}"
