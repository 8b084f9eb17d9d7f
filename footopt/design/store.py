"""`Store`: evaluated designs in an SQLite file, so that no walk is lost and none is done twice.

A design is kept under its heights and the digest of its context (`footopt.design.context`). A search
with the same seed asks for the same designs in the same order, so that a search is resumed by running
it again: what it had is read, what is missing is walked, and the result is that of a search never
stopped. Numbers are kept as JSON with all their digits, with a checksum of the row, because SQLite's
integrity check does not look at what a row holds. For each context a view, `designs_1` and so on, has
them in columns that any program reads.
"""

from __future__ import annotations

import json
import sqlite3
import time
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from footopt.design.context import CODE, canonical, context, differences, digest, listed
from footopt.design.problem import Array, FootProblem
from footopt.errors import FileError
from footopt.files.io import named
from footopt.walk.objectives import MEASURES

APPLICATION = int.from_bytes(b"foot")  # marks the file as ours (SQLite's application_id)
LAYOUT = 3  # of the tables below (SQLite's user_version)
PATIENCE = 30.0  # s, for another process that writes
ERROR = "error"  # the reason of a design that breaks the program

TABLES = """
CREATE TABLE context (id INTEGER PRIMARY KEY, digest TEXT NOT NULL UNIQUE, description TEXT NOT NULL);
CREATE TABLE design (
    context INTEGER NOT NULL,
    k TEXT NOT NULL,
    record TEXT NOT NULL,
    box_violation REAL,
    reason TEXT NOT NULL,
    message TEXT NOT NULL,
    seal INTEGER NOT NULL,
    PRIMARY KEY (context, k)
) WITHOUT ROWID;
"""

ADD = f"""
INSERT INTO design VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT (context, k) DO UPDATE
SET record = excluded.record, reason = excluded.reason, message = excluded.message, seal = excluded.seal
WHERE reason = '{ERROR}'
"""

#: What SQLite's errors mean to a user, and what to do about them, by their primary code.
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
    path : str or Path
        Of the file; made if it is not there.
    problem : FootProblem
        Whose designs are read and added.
    reuse : bool
        Whether to read designs of the same settings, too, that other sources, versions or machines have
        walked. Their values may differ from what would be walked here.

    Attributes
    ----------
    foreign : list of str
        What differs between this program and the one that walked the designs of the same settings; empty
        where there are none of others, or there are own ones.

    Raises
    ------
    FileError
        The file cannot be used: it is something else, damaged, of another version of footopt, locked, or
        cannot be written. It is left as it is.
    """

    def __init__(self, path: str | Path, problem: FootProblem, reuse: bool = False) -> None:
        self.path, self.problem = Path(path), problem
        self._context = context(problem)
        self._connection: sqlite3.Connection | None = None
        with self._explained():
            self._connection = sqlite3.connect(self.path, timeout=PATIENCE, isolation_level=None)
        try:
            with self._explained() as connection:
                self._identify(connection)
                _log_ahead(connection)
                self._id = self._enter_context(connection)
                _show(connection, f"designs_{self._id}", self._columns())
            others = self._of_other_code() if reuse or not len(self) else {}
            self.foreign = min(others.values(), key=len, default=[])
            self._read_from = (self._id, *(others if reuse else ()))
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
        marks = ", ".join("?" * len(self._read_from))
        query = f"SELECT k, record, reason, message, seal FROM design WHERE context IN ({marks}) "
        query += "AND k IN (SELECT value FROM json_each(?)) ORDER BY context = ?"  # its own last: they count
        keys = [canonical(heights) for heights in k]
        with self._explained() as connection:
            rows = connection.execute(query, (*self._read_from, canonical(keys), self._id))
            known = {row[0]: row for row in rows}
            return [self._read(*known[key]) if key in known else None for key in keys]

    def everything(self) -> tuple[list[list[int]], list[Evaluation]]:
        """All designs, in the order of their heights, and what is known of them."""
        marks = ", ".join("?" * len(self._read_from))
        query = f"SELECT DISTINCT k FROM design WHERE context IN ({marks}) ORDER BY k"
        with self._explained() as connection:
            k = [json.loads(key) for (key,) in connection.execute(query, self._read_from).fetchall()]
        return k, [known for known in self.get(k) if known is not None]

    def add(self, k: Sequence[Sequence[int]], evaluations: Sequence[Evaluation]) -> None:
        """Keep designs, all or none; what is known stays, unless it had broken the program.

        Raises
        ------
        FileError
            They cannot be kept; or the file has been deleted, into which SQLite would go on writing.
        """
        if not self.path.exists():
            why = "It was deleted or moved meanwhile: start the run again, or move it back and resume."
            raise self._error("is gone", why, "no such file")
        rows = []
        violations = self.problem.space.box_violation(np.asarray(k)).tolist()
        for heights, (values, reason, message), out in zip(k, evaluations, violations, strict=True):
            text = canonical(heights), _written(values)
            rows.append((self._id, *text, out, reason, message, _seal(*text, reason, message)))
        with self._explained() as connection, _transaction(connection):
            connection.executemany(ADD, rows)

    def describe(self) -> str:
        """What can be used of the file, in one line; if nothing, why; "" for a new one."""
        if known := len(self):
            return f"{known} designs of this search are known from {self.path}"
        if len(self._read_from) > 1:
            return f"Designs in {self.path} of other code are used again: {listed(self.foreign)} differ"
        found = [differences(there, self._context) for there in self._others().values()]
        if not found:
            return ""
        return f"No design in {self.path} can be used again: {listed(min(found, key=len))} differ"

    def _others(self) -> dict[int, Any]:
        """The other contexts that have designs, by their numbers."""
        query = (
            "SELECT id, description FROM context WHERE id != ? "
            "AND EXISTS (SELECT 1 FROM design WHERE context = context.id)"
        )
        with self._explained() as connection:
            rows = connection.execute(query, (self._id,)).fetchall()
        return {number: json.loads(text) for number, text in rows}

    def _of_other_code(self) -> dict[int, list[str]]:
        """What differs from the contexts of the same settings, by their numbers."""
        here = {name: value for name, value in self._context.items() if name not in CODE}
        return {
            number: differences(there, self._context)
            for number, there in self._others().items()
            if {name: value for name, value in there.items() if name not in CODE} == here
        }

    def close(self) -> None:
        """Let go of the file."""
        if self._connection is not None:
            self._connection.close()

    def _identify(self, connection: sqlite3.Connection) -> None:
        """Make the tables in an empty file; refuse any other that is not a sound store of this layout."""
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
            raise self._error(*MEANING[sqlite3.SQLITE_NOTADB], "SQLite file of another program")
        if layout != LAYOUT:
            raise self._error(
                "was made by another version of footopt",
                "Use that version, or choose another study.store.",
                f"its layout is {layout}, this version's {LAYOUT}",
            )
        problems = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
        if problems != "ok":
            raise self._damaged(str(problems))

    def _enter_context(self, connection: sqlite3.Connection) -> int:
        """The number of this problem's context in the file."""
        name = digest(self._context)
        query = "SELECT id FROM context WHERE digest = ?"
        if connection.execute(query, (name,)).fetchone() is None:
            insert = "INSERT INTO context (digest, description) VALUES (?, ?) ON CONFLICT DO NOTHING"
            connection.execute(insert, (name, canonical(self._context)))
        return int(connection.execute(query, (name,)).fetchone()[0])

    def _columns(self) -> str:
        """The columns of designs.csv that the problem's view has, in SQL: SI, natural signs.

        What is feasible, and why not, is what the box and the limits of the problem say that had the file
        open last.
        """
        p = self.problem
        value = {name: f"json_extract(record, '$[{i}]')" for i, name in enumerate(p.record)}
        verdict = "CASE WHEN reason != '' THEN reason"
        if np.isfinite(p.space.box_tolerance):
            verdict += f" WHEN box_violation / {p.space.H!r} - {p.space.box_tolerance!r} > 0 THEN 'box'"
        for name, limit in p.limits.items():
            kept = f"{value[name]} {'>=' if MEASURES[name].maximise else '<='} {float(limit)!r}"
            verdict += f" WHEN NOT coalesce({kept}, 0) THEN '{name}'"
        verdict += " ELSE '' END"
        heights = (f"json_extract(k, '$[{i}]') AS k{i + 1}" for i in range(p.space.n))
        recorded = (f'{found} AS "{name}"' for name, found in value.items())
        shown = (*heights, *recorded, "box_violation", f"{verdict} = '' AS feasible", f"{verdict} AS reason")
        return ", ".join((*shown, "message"))

    def _read(self, key: str, record: str, reason: str, message: str, seal: int) -> Evaluation:
        """A row as an evaluation."""
        if seal != _seal(key, record, reason, message):
            raise self._damaged(f"design {key} fails its checksum")
        values = np.array(json.loads(record), float)  # NaN of null
        return Evaluation(values, reason, message)

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

    def _damaged(self, detail: str) -> FileError:
        return self._error(*MEANING[sqlite3.SQLITE_CORRUPT], detail.replace("\n", " "))

    def _error(self, what: str, hint: str, detail: str) -> FileError:
        return FileError(f"{named(self.path, 'study.store')}: {what} ({detail}). {hint}")


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


def _show(connection: sqlite3.Connection, name: str, columns: str) -> None:
    """Make the view of a context's designs, or make it again if it has other columns."""
    view = f"CREATE VIEW {name} AS SELECT {columns} FROM design WHERE context = {name.rpartition('_')[2]}"
    known = connection.execute("SELECT sql FROM sqlite_master WHERE name = ?", (name,)).fetchone()
    if known != (view,):
        with _transaction(connection):
            connection.execute(f"DROP VIEW IF EXISTS {name}")
            connection.execute(view)


def _written(values: Array) -> str:
    """Numbers as JSON with all their digits, as SQLite reads it, too: null for NaN."""
    return canonical(np.asarray(values, float).tolist()).replace("NaN", "null").replace("Infinity", "9e999")


def _seal(*row: object) -> int:
    """A checksum that changes with any part of a row."""
    return zlib.crc32("|".join(map(str, row)).encode(errors="replace"))
