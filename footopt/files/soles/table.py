"""The line in a CSV table: columns x and z (or y), or two columns without a header."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from footopt.errors import Unusable
from footopt.files.io import Table, read_table
from footopt.files.soles.lines import JOIN, Line, from_points, unit_of


def read(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield the line, scaled; `units` is one of its unit's names, or None for the header's."""
    table = read_table(path, "foot.path")
    if re.match(r"[-+.]?\d", table.header[0]):
        cells = np.array([[cell.replace(",", ".") for cell in table.header], *table.cells.tolist()])
        table = Table(["x", "z", *map(str, range(2, len(table.header)))], cells)
    form = re.compile(r"([xzy])(?:[_ ]*[(\[]?([a-z]+)[)\]]?)?", re.IGNORECASE)
    named = {name: form.fullmatch(name) for name in table.header}
    column = {match[1].lower(): name for name, match in named.items() if match}
    if not ("x" in column and column.keys() & {"z", "y"}):
        raise Unusable(
            f"the header lacks x or z; it holds {', '.join(table.header)}. "
            "Name the columns x_mm and z_mm (or _cm, _m, _in), from heel to toe."
        )
    own = {match[2].lower() for match in named.values() if match and match[2]}
    unit = scale * unit_of(units, own.pop() if len(own) == 1 else None)
    points = [table.numbers(column["x"]), table.numbers(column.get("z", column.get("y", "")))]
    yield from_points(unit * np.stack(points, axis=1), "", JOIN)
