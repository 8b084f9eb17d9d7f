"""The line in a CSV table: columns x and z (or y), or two columns without a header."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from footopt.files.reading import Unusable, number, read_table
from footopt.files.soles.lines import JOIN, Line, from_points, unit_of


def read(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield the line, scaled; `units` is one of its unit's names, or None for the header's."""
    rows = [row for row in read_table(path, "sole", "foot.path").splitlines() if row.strip()]
    rows = [row for row in rows if not row.startswith("#")]
    names = [] if not rows or _numbers(rows[0]) else [w.strip().lower() for w in re.split(r"[,;\t]", rows[0])]
    found = [re.fullmatch(r"([xzy])(?:[_ ]*[(\[]?([a-z]+)[)\]]?)?", name) for name in names]
    column = {match[1]: i for i, match in enumerate(found) if match}
    if names and not ("x" in column and column.keys() & {"z", "y"}):
        raise Unusable(
            f"the header lacks x or z; it holds {', '.join(names)}. "
            "Name the columns x_mm and z_mm (or _cm, _m, _in), from heel to toe."
        )
    own = {match[2] for match in found if match and match[2]}
    unit = scale * unit_of(units, own.pop() if len(own) == 1 else None)
    places = [column["x"], column.get("z", column.get("y", 1))] if names else [0, 1]
    points, wide = [], len(names)
    for i, row in enumerate(rows[1:] if names else rows, start=1):
        numbers = _numbers(row)
        wide = wide or len(numbers)
        if len(numbers) <= max(places) or len(numbers) != wide or not np.isfinite(numbers).all():
            raise Unusable(f"row {i} of the table is not numbers: {row.strip()[:60]!r}.")
        points.append([numbers[place] for place in places])
    yield from_points(unit * np.array(points).reshape(-1, 2), "", JOIN)


def _numbers(row: str) -> list[float]:
    """The numbers of a row, or none; a semicolon between them allows a decimal comma."""
    cells = row.replace(",", ".").split(";") if ";" in row else re.split(r"[,\s]+", row.strip().strip(","))
    try:
        return [number(cell) for cell in cells]
    except ValueError:
        return []
