"""Reading and writing of files: text, JSON, tables, code; errors name the file, each is written whole."""

import csv
import json
import math
import os
import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module, invalidate_caches
from importlib.metadata import version
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from footopt.arrays import Array
from footopt.errors import FileError, SettingError, Unusable, check, named, naming
from footopt.walk.own_code import sources

Variable = tuple[tuple[str, ...], str, Array]  # dimensions, unit, values
Table = dict[str, list[str]]  # cells of a table by its columns
_loaded: dict[str, tuple[ModuleType, str]] = {}  # the user's files, and the settings that named them


def read_bytes(path: str | Path, setting: str) -> bytes:
    """The content of a file that `setting` names; `FileError` if it cannot be read, or is empty."""
    try:
        content = Path(path).read_bytes()
    except (OSError, ValueError) as error:  # a path with a NUL in it is a ValueError
        why = getattr(error, "strerror", error)
        raise FileError(f"{named(path, setting)}: cannot be read ({why}).") from None
    if not content.strip():
        raise FileError(f"{named(path, setting)}: is empty.")
    return content


def read_text(path: str | Path, setting: str) -> str:
    """The text of a file in UTF-8, with or without a byte order mark; errors as of `read_bytes`."""
    try:
        return read_bytes(path, setting).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(f"{named(path, setting)}: is no text in UTF-8. Save it as such.") from None


def read_json_file(path: str | Path, setting: str) -> Any:
    """The content of a JSON file; errors as of `read_text`."""
    try:
        return json.loads(read_text(path, setting))
    except ValueError as error:
        raise FileError(f"{named(path, setting)}: cannot be read as JSON ({error}).") from None


def parse_table(text: str) -> Table:
    """The table in a text with a header, whose cells are separated by commas, semicolons, tabs or spaces.

    Lines that begin with # are left out. Raises `Unusable` if a row has more or fewer cells than the header.
    """
    lines = [line.strip() for line in text.splitlines() if line.strip() and line[0] != "#"]
    mark = next((mark for mark in ";\t," if lines and mark in lines[0]), " ")
    reader = csv.reader(lines, skipinitialspace=True, delimiter=mark)
    header, *rows = [[cell.strip() for cell in row] for row in reader] or [[]]
    if mark != ",":
        rows = [[re.sub(r"^([-+]?\d*),(\d+)", r"\1.\2", cell) for cell in row] for row in rows]
    if twice := [name for name, count in Counter(header).items() if name and count > 1]:
        raise Unusable(f"two columns are called {twice[0]}.")
    for i, row in enumerate(rows, start=1):
        if len(row) != len(header):  # more as with decimal commas
            raise Unusable(f"not a table: row {i} has {len(row)} cells, the header {len(header)}.")
    return {name: [row[i] for row in rows] for i, name in enumerate(header)}


def numbers(table: Table, name: str) -> Array:
    """A column as numbers (rows,); raises `Unusable` if a cell is not a number."""
    found = np.empty(len(table[name]))
    for i, cell in enumerate(table[name]):
        try:
            found[i] = float(cell)
        except ValueError:
            found[i] = math.nan
        if not math.isfinite(found[i]):
            raise Unusable(f"not a table of numbers (row {i + 1}: {name} is {cell[:40]!r}).")
    return found


def read_columns(
    path: str | Path,
    setting: str,
    units: Mapping[str, str],
    optional: Mapping[str, float] | None = None,
    label: str = "",
) -> tuple[dict[str, Array], list[str], list[str]]:
    """Columns of a CSV file (see `parse_table`): numbers (rows,) by name; one of words; names of the others.

    `units` has the required columns with their units, `optional` further ones with the values that they have
    if they are missing, and `label` is the column of words, which are empty if it is missing. Names may be
    written as in "Depth [mm]" or "Force (N)". Raises `FileError` if the file cannot be read, lacks a column,
    or has a cell that is not a number.
    """
    text = read_text(path, setting)
    with naming(path, setting):
        known = {_plain(name): name for name in (*units, *(optional or {}), label)}
        cells = parse_table(text)
        meant = [known.get(_plain(name), name) for name in cells]
        if twice := [name for name, count in Counter(meant).items() if count > 1]:
            raise Unusable(f"two columns are {twice[0]}.")
        table = dict(zip(meant, cells.values(), strict=True))
        if missing := [name for name in units if name not in table]:
            wanted = ", ".join(f"{name} ({unit})" if unit else name for name, unit in units.items())
            raise Unusable(
                f"the header lacks {', '.join(missing)}; the columns must be {wanted}, with commas, "
                f"semicolons or tabs between them, and are {', '.join(table)[:200]}."
            )
        rows = len(next(iter(table.values())))
        found = {name: np.full(rows, value) for name, value in (optional or {}).items()}
        found |= {name: numbers(table, name) for name in (*units, *found) if name in table}
        return found, table.get(label, [""] * rows), [name for name in table if name not in (*found, label)]


def _plain(name: str) -> str:
    """The name of a column without what differs between files: depth_mm of "Depth [mm]"."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower().replace("²", "2").replace("^", "")).strip("_")


def relative(path: str | Path, base: str | Path = ".") -> str:
    """The way from a folder to a path; all of the path where it is on another drive, as on Windows."""
    try:
        return os.path.relpath(path, base)
    except ValueError:
        return os.path.abspath(path)


def load_module(name: str, setting: str) -> ModuleType:
    """Import a module, or a Python file, whose folder is added to the module path, in worker processes too.

    Raises a `SettingError` if it is not there, fails, or has the name of another module.
    """
    path = Path(name).absolute()
    is_file = path.suffix == ".py"
    if is_file:
        check(path.is_file(), setting, name, "a file that is there, or an importable module")
        if str(path.parent) not in sys.path:
            sys.path.append(str(path.parent))
    try:
        module = import_module(path.stem if is_file else name)
    except (Exception, SystemExit) as error:  # a script without a main guard
        why = f"something that can be imported ({type(error).__name__}: {error})"
        raise SettingError(setting, name, why) from error
    own = not is_file or (module.__file__ is not None and path.samefile(module.__file__))
    check(own, setting, name, "a file whose name is not that of another module", f"Rename {path.name}.")
    if is_file:  # before it is edited, or has computed anything
        sources(vars(module), str(module.__file__))
        _loaded[str(module.__file__)] = module, setting
    return module


def reload_edited() -> None:
    """Import files that `load_module` has imported again, if they or what they import was edited since."""
    for file, (module, setting) in list(_loaded.items()):
        known = sources(vars(module), file)
        if any(Path(path).is_file() and Path(path).read_bytes() != text for path, text in known.items()):
            for name in [name for name, one in sys.modules.items() if getattr(one, "__file__", "") in known]:
                del sys.modules[name]
            invalidate_caches()
            load_module(file, setting)


@contextmanager
def write_whole(path: Path) -> Iterator[Path]:
    """A path to write to, which replaces the file at the end; an error leaves the file as it was.

    Its folder is made if it is not there.
    """
    new = path.with_name(f".{path.stem}.new{path.suffix}")  # that of a killed run is replaced
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield new
        os.replace(new, path)
    except FileError:
        raise
    except OSError as error:
        why = error.strerror or error
        raise FileError(f"cannot write {path} ({why}). Choose a folder that may be written to.") from None
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


def write_csv(path: Path, table: Any) -> None:
    """Write a pandas DataFrame, or columns by name; truth values become 0 and 1, a NaN an empty cell."""
    columns = [_cells(table[name]) for name in table]
    with write_whole(path) as new, open(new, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        writer.writerows(zip(*columns, strict=True))


def _cells(column: Any) -> list[Any]:
    """A column as it is written."""
    if isinstance(column, np.ndarray) and column.dtype.kind in "iufU" and (column == column).all():
        return list(column.tolist())  # in a tenth of the time
    cells = ("" if v is None or v != v else v for v in np.asarray(column, dtype=object).tolist())
    return [int(v) if isinstance(v, (bool, np.bool_)) else v for v in cells]


def write_walk(path: Path, variables: Mapping[str, Variable], attributes: Mapping[str, str]) -> None:
    """Write the traces of a walk as NetCDF 3, which xarray, MATLAB and ncdump read, in SI units.

    `attributes` say something of the whole walk, such as the reason of its failure.
    """
    from scipy.io import netcdf_file

    with write_whole(path) as new, netcdf_file(new, "w", version=2) as file:
        order = {"axis_order": "x (forward), z (up)"}
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


def plain(value: Any) -> Any:
    """JSON's own types from numpy's, tuples and paths; null for a number that is not finite."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int)) else str(value)
