"""report.html: one self-contained file a run, to look at its walks and designs, or figures, in a browser.

Its looks and its motion are plain HTML, CSS and JavaScript in this folder, without a library.
Arrays travel as base64, so that ten thousand designs stay below 5 MB.
"""

import base64
import html
import json
import re
from collections.abc import Collection, Mapping, Sequence
from importlib.resources import files as resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from rich.table import Table as RichTable
from rich.text import Text

from footopt.files.io import plain, write_text
from footopt.report.numbers import title
from footopt.report.style import PALETTE

SCRIPTS = (  # in this order: each uses those before it
    "tools.js", "soles.js", "contact.js", "simulate.js", "stage.js", "walk.js", "columns.js",
    "explore.js", "draw.js", "main.js",
)  # fmt: skip
SCALE = 2.1  # pixels of the page for a point of a figure: a wide one then fills the page
#: Entries of result.json at the foot of a study's page.
FOOTER = (
    "seed", "wall_time_s", "accuracy", "evaluations", "designs", "versions", "error_estimate", "settings",
    "scene",
)  # fmt: skip


def write(path: Path, content: dict[str, Any]) -> Path:
    """Write a page of `search_content`, `walk_content` or `summary.runs_content`."""
    parts = resources("footopt.report.page")

    def read(name: str) -> str:
        return (parts / name).read_text(encoding="utf-8")

    data = json.dumps(plain(content), separators=(",", ":"), allow_nan=False)
    roles = " ".join(f"--{role}: {colour};" for role, colour in PALETTE.items())  # of the figures
    filled = {
        "TITLE": html.escape(content["title"]),
        "STYLE": f":root {{ {roles} }}\n{read('page.css')}",
        # "</script>" in a name would end the element
        "DATA": data.replace("<", "\\u003c"),
        "SCRIPT": "\n".join(map(read, SCRIPTS)),
    }
    page = read("template.html")
    for name, value in filled.items():
        page = page.replace(f"<!--{name}-->", value)
    write_text(path, page)
    return path


def packed(values: ArrayLike, double: bool = False) -> dict[str, Any]:
    """An array as the page reads it: whole numbers of 32 bits, or floats of 32 or, with `double`, 64 bits."""
    array = np.asarray(values)
    kind = "int32" if np.issubdtype(array.dtype, np.integer) else "float64" if double else "float32"
    data = base64.b64encode(array.astype(np.dtype(kind).newbyteorder("<")).tobytes()).decode("ascii")
    return {"shape": array.shape, "type": kind, "data": data}


def column(name: str, unit: str, maximise: bool) -> dict[str, Any]:
    """An objective as the page knows it."""
    return {"name": name, "title": title(name), "unit": unit, "maximise": maximise}


NOTHING = {"values": packed(np.empty((0, 0))), "feasible": [], "reasons": []}  # of designs


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
