"""report.html: one self-contained file a run, to look at its walks and designs in a browser.

Its looks and its motion are plain HTML, CSS and JavaScript in this folder, without a library.
Arrays travel as base64, so that ten thousand designs stay below 5 MB.
"""

import base64
import html
import json
from importlib.resources import files as resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from footopt.files.io import plain, write_text
from footopt.report.numbers import title
from footopt.report.style import PALETTE

SCRIPTS = (  # in this order: each uses those before it
    "tools.js", "soles.js", "contact.js", "simulate.js", "stage.js", "walk.js", "columns.js",
    "explore.js", "draw.js", "main.js",
)  # fmt: skip


def write(path: Path, content: dict[str, Any]) -> Path:
    """Write a page of `search_content`, `walk_content` or `summary.runs_content`."""
    write_text(path, text(content))
    return path


def text(content: dict[str, Any]) -> str:
    """A page's own text; see `write`."""
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
    return page


def packed(values: ArrayLike, double: bool = False) -> dict[str, Any]:
    """An array as the page reads it: whole numbers of 32 bits, or floats of 32 or, with `double`, 64 bits."""
    array = np.asarray(values)
    kind = "int32" if np.issubdtype(array.dtype, np.integer) else "float64" if double else "float32"
    data = base64.b64encode(array.astype(np.dtype(kind).newbyteorder("<")).tobytes()).decode("ascii")
    return {"shape": array.shape, "type": kind, "data": data}


def column(name: str, unit: str, maximise: bool) -> dict[str, Any]:
    """An objective as the page knows it."""
    return {"name": name, "title": title(name), "unit": unit, "maximise": maximise}
