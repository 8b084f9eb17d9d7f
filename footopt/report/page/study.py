"""The page of a study of many walks: its figures and tables as they are."""

import base64
import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table as RichTable
from rich.text import Text

from footopt.report.page.file import packed, write

SCALE = 2.1  # pixels of the page for a point of a figure: a wide one then fills the page

NOTHING = {"values": packed(np.empty((0, 0))), "feasible": [], "reasons": []}  # of designs
#: Entries of result.json at the foot of a study's page.
FOOTER = (
    "seed", "wall_time_s", "accuracy", "evaluations", "designs", "versions", "error_estimate", "settings",
    "scene",
)  # fmt: skip


def write_study(
    folder: Path,
    title: str,
    headline: Sequence[str],
    figures: Mapping[str, str],
    tables: Sequence[RichTable],
    entry: Mapping[str, Any],
) -> Path:
    """Write the page of a study of many walks, report.html.

    The folder of the run has the `figures` (captions by name) as SVG in its folder "figures". `headline` are
    paragraphs, `tables` those of the terminal; a cell that is the name of a file in the folder is a link to
    it. `entry` is the run's result.json.
    """
    files = {path.name for path in folder.iterdir() if path.is_file()}
    content = {
        "title": title,
        "headline": headline,
        "figures": [
            {"says": says, **_inline(folder / "figures" / f"{name}.svg")} for name, says in figures.items()
        ],
        "tables": [_plain_table(table, files) for table in tables],
        "columns": [],
        "designs": NOTHING,
        "entry": {name: entry[name] for name in FOOTER if name in entry},
    }
    return write(folder / "report.html", content)


def _inline(path: Path) -> dict[str, Any]:
    """An SVG as the address of itself, and the width that gives the letters of all figures one size."""
    picture = path.read_bytes()
    points = re.search(rb'<svg [^>]*width="([0-9.]+)pt"', picture)
    data = base64.b64encode(picture).decode("ascii")
    width = round(float(points[1]) * SCALE) if points else None
    return {"source": f"data:image/svg+xml;base64,{data}", "width": width}


def _plain_table(table: RichTable, files: Collection[str]) -> dict[str, Any]:
    """A terminal's table as plain text; `bad`: which cells are bold there, `links`: which name a file."""
    rows = list(zip(*(column.cells for column in table.columns), strict=True))
    return {
        "title": table.title,
        "head": [str(column.header).replace("\n", " ") for column in table.columns],
        "words": [column.justify != "right" for column in table.columns],
        "rows": [[str(cell) for cell in row] for row in rows],
        "bad": [[isinstance(cell, Text) and "bold" in str(cell.style) for cell in row] for row in rows],
        "links": [[str(cell) in files for cell in row] for row in rows],
        "caption": table.caption,
    }
