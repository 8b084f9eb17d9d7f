"""Angles over time from a table (CSV)."""

from __future__ import annotations

import csv
from collections.abc import Mapping

from footopt.files.gaits.angles import Recording, recording, to_degrees
from footopt.files.gaits.markers import to_numbers
from footopt.files.reading import Unusable


def read_csv(text: str, names: Mapping[str, str], units: str | None = None) -> Recording:
    """Read columns ``time`` (s), ``thigh``, ``knee`` and, optionally, ``foot`` (signs: `Recording`).

    Angles are in deg unless `units` is "rad".

    The table holds one stride from heel strike to heel strike, or several strides; `names` are its own names
    of these columns, where they differ.
    """
    reader = csv.reader(text.splitlines(), skipinitialspace=True)
    try:
        header = next(reader, [])
        rows = [(reader.line_num, row) for row in reader if row]
    except csv.Error:
        raise Unusable(f"not a table (line {reader.line_num}: a quote is not closed).") from None
    own = [names.get(column, column) for column in ("time", "thigh", "knee", "foot")]
    if missing := [name for name in own[:3] if name not in header]:
        raise Unusable(
            f"the header lacks {', '.join(missing)}; "
            "the columns must be time (s), thigh, knee and, optionally, foot (deg)."
        )
    if twice := next((name for name in own if header.count(name) > 1), None):
        raise Unusable(f"two columns are called {twice!r}. Which one is it?")
    wanted = [header.index(name) for name in own if name in header]
    for line, row in rows:
        if len(row) != len(header):  # as with decimal commas
            raise Unusable(
                f"not a table of numbers (line {line} has {len(row)} cells, the header {len(header)})."
            )
    try:
        table = to_numbers(((line, [row[c] for c in wanted]) for line, row in rows), len(wanted), gaps=False)
    except ValueError as error:
        raise Unusable(f"not a table of numbers ({error}).") from None
    table[:, 1:] *= to_degrees(units or "deg")
    return recording(table.T)
