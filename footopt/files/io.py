"""Reading and writing of files: text, JSON and tables with errors that name the file; each written whole."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError, Unusable, named, naming

Array = NDArray[np.float64]
Variable = tuple[tuple[str, ...], str, Array]  # dimensions, unit, values

LARGEST = 50_000_000  # bytes of a file that is read; a front of 100,000 designs in result.json has as many


def read_bytes(path: str | Path, setting: str) -> bytes:
    """The content of a file, which `setting` names.

    Raises
    ------
    FileError
        There is no such file, it cannot be read, is empty, or larger than `LARGEST`.
    """
    try:
        if Path(path).is_fifo():
            raise OSError(0, "a pipe, and no file")  # to be waited for, perhaps for ever
        with open(path, "rb") as file:
            content = file.read(LARGEST + 1)
    except (OSError, ValueError) as error:  # a path with a NUL in it is a ValueError
        why = error.strerror if isinstance(error, OSError) else error
        raise FileError(f"{named(path, setting)}: cannot be read ({why}).") from None
    with naming(path, setting):
        if not content.strip():
            raise Unusable("is empty.")
        if len(content) > LARGEST:
            raise Unusable(f"is larger than {LARGEST / 1e6:g} MB. Leave out what is not needed of it.")
    return content


def read_text(path: str | Path, setting: str) -> str:
    """The text of a file in UTF-8, with or without a byte order mark; errors as of `read_bytes`."""
    content = read_bytes(path, setting)
    with naming(path, setting):
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = content.count(b"\n", 0, error.start) + 1
            raise Unusable(f"cannot be read: line {line} is no text in UTF-8. Save it as such.") from None
        if "\0" in text:
            raise Unusable("cannot be read: it holds NUL bytes, and no text. Save it as text in UTF-8.")
    return text


def read_json_file(path: str | Path, setting: str) -> Any:
    """What a JSON file holds; errors as of `read_text`."""
    text = read_text(path, setting)
    with naming(path, setting):
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as error:  # deep nesting; a number of thousands of digits
            raise Unusable(f"cannot be read as JSON ({' '.join(str(error).split())[:200]}).") from None


class Table(NamedTuple):
    """A table as text.

    Parameters
    ----------
    header : list of str
        The names of its columns.
    cells : (rows, columns) array of str
        What is below; decimal commas are points.
    """

    header: list[str]
    cells: NDArray[np.str_]

    def numbers(self, name: str) -> Array:
        """A column as numbers (rows,).

        Raises
        ------
        Unusable
            A cell holds none, or one that is not finite; or two columns have this name.
        """
        if self.header.count(name) > 1:
            raise Unusable(f"two columns are called {name!r}. Which one is it?")
        cells = self.cells[:, self.header.index(name)]
        found = np.array([_number(cell) for cell in cells], float)
        if not np.isfinite(found).all():
            row = int(np.argmin(np.isfinite(found)))
            raise Unusable(f"not a table of numbers (row {row + 1}: {name} is {cells[row][:40]!r}).")
        return found


def _number(cell: str) -> float:
    """A cell as a number, or NaN: none has underscores or is of other scripts, which Python would allow."""
    with suppress(ValueError):
        return math.nan if "_" in cell or not cell.isascii() else float(cell)
    return math.nan


def read_table(path: str | Path, setting: str) -> Table:
    """Read a CSV file with a header: commas, semicolons, tabs or spaces stand between its cells.

    With semicolons and tabs, numbers may have decimal commas. Lines that begin with # are left out.

    Raises
    ------
    FileError
        The file cannot be read, or a row has more or fewer cells than the header.
    """
    text = read_text(path, setting)
    with naming(path, setting):
        return parse_table(text)


def parse_table(text: str) -> Table:
    """The table in a text, as of `read_table`; raises `Unusable`."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and line[0] != "#"]
    mark = next((mark for mark in ";\t," if lines and mark in lines[0]), " ")
    reader = csv.reader(lines, skipinitialspace=True, delimiter=mark)
    try:
        header, *rows = [[cell.strip() for cell in row] for row in reader]
    except (csv.Error, ValueError):
        raise Unusable(f"not a table (line {reader.line_num}: is a quote not closed?).") from None
    for i, row in enumerate(rows, start=1):
        if len(row) != len(header):  # more as with decimal commas
            held = f"row {i} has {len(row)} cells, the header {len(header)}"
            raise Unusable(f"not a table of numbers ({held}).")
    cells = np.array(rows, str).reshape(len(rows), len(header))
    dots = mark == "," or not cells.size  # numpy replaces nothing in no cells
    return Table(header, cells if dots else np.char.replace(cells, ",", "."))


def read_columns(
    path: str | Path,
    setting: str,
    wanted: Mapping[str, str],
    optional: Mapping[str, float] | None = None,
    label: str | None = None,
) -> tuple[dict[str, Array], list[str]]:
    """Read some columns of a table; others are ignored.

    Parameters
    ----------
    path : str or Path
        A CSV file, as of `read_table`.
    setting : str
        The setting that names the file, for messages.
    wanted : dict
        The unit of each column that there must be.
    optional : dict, optional
        What each other column is where it is missing.
    label : str, optional
        A column of words, which may be missing.

    Returns
    -------
    columns : dict of (rows,)
        By their names; all values are finite.
    labels : (rows,)
        Of the column of words; empty words where it is missing.

    Raises
    ------
    FileError
        The file cannot be read, lacks a column or has it twice, or holds something that is not a number.
    """
    table = read_table(path, setting)
    header, rows = table.header, len(table.cells)
    with naming(path, setting):
        if missing := [name for name in wanted if name not in header]:
            raise Unusable(
                f"the header lacks {', '.join(missing)}; the columns must be {', '.join(wanted)} "
                f"({', '.join(wanted.values())}), with commas, semicolons or tabs between them."
            )
        found = {name: np.full(rows, value) for name, value in (optional or {}).items()}
        found |= {name: table.numbers(name) for name in (*wanted, *found) if name in header}
    labels = table.cells[:, header.index(label)].tolist() if label in header else [""] * rows
    return found, labels


@contextmanager
def write_whole(path: Path) -> Iterator[Path]:
    """A path to write to: it replaces the file at the end; what breaks off leaves the file as it was.

    Raises `FileError` if the file cannot be written.
    """
    new = path.with_name(f".{path.stem}.new{path.suffix}")  # what a killed run has left of it is replaced
    try:
        new.unlink(missing_ok=True)
        yield new
        os.replace(new, path)
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


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file as a whole, or not at all."""
    with write_whole(path) as new:
        new.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write a file as a whole, or not at all."""
    write_bytes(path, text.encode())


def json_text(content: dict[str, Any]) -> str:
    """JSON that any reader accepts: a value that is not finite becomes null."""
    return json.dumps(plain(content), indent=2, allow_nan=False) + "\n"


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write `json_text`."""
    write_text(path, json_text(content))


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
