"""The line in a CSV table: columns x and z (or y), or two columns without a header."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from footopt.errors import Unusable
from footopt.files.io import numbers, parse_table, read_text
from footopt.files.soles.lines import JOIN_DISTANCE, Line, from_points, unit_of

WITHOUT_HEADER = re.compile(r"(?:\s*#.*\n)*\s*[-+.]?\d[\d.,e+-]*([;,\t ])")  # and the mark between cells
COLUMN = re.compile(r"([xzy])(?:[_ ]*[(\[]?([a-z]+)[)\]]?)?", re.IGNORECASE)  # and its unit


def read(path: Path, units: str | None, scale: float) -> Iterator[Line]:
    """Yield the line, scaled; `units` is one of its unit's names, or None for the header's."""
    text = read_text(path, "foot.path")
    if match := WITHOUT_HEADER.match(text):
        text = f"x{match[1]}z\n{text}"
    table = parse_table(text)
    columns = {match[1].lower(): match for name in table if (match := COLUMN.fullmatch(name))}
    x, z = columns.get("x"), columns.get("z", columns.get("y"))
    if x is None or z is None:
        raise Unusable(
            f"the header lacks x or z; it holds {', '.join(table)[:200]}. "
            "Name the columns x_mm and z_mm (or _cm, _m, _in), from heel to toe."
        )
    own = {match[2].lower() for match in (x, z) if match[2]}
    unit = scale * unit_of(units, own.pop() if len(own) == 1 else None)
    yield from_points(
        unit * np.stack([numbers(table, x[0]), numbers(table, z[0])], axis=1), "", JOIN_DISTANCE
    )
