"""report.html: one self-contained file a run, to look at its walks and designs in a browser.

What the page looks like and how it moves is plain HTML, CSS and JavaScript without a library, in this
folder. Arrays travel as base64 of whole numbers of 8 or 16 bits or of 32-bit floats, so that seventy thousand
designs, or two hundred walks, stay below 5 MB.
"""

from __future__ import annotations

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

STYLES = ("page.css",)
SCRIPTS = (  # in this order: each uses those before it
    "tools.js", "soles.js", "contact.js", "simulate.js", "stage.js", "walk.js", "explore.js",
    "draw.js", "main.js",
)  # fmt: skip


def write(path: Path, content: dict[str, Any]) -> Path:
    """Write a page.

    Parameters
    ----------
    path : Path
        Of the file.
    content : dict
        Of `search_content`, `walk_content` or `jobs_content`; `write_study` makes its own.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    write_text(path, text(content))
    return path


def text(content: dict[str, Any]) -> str:
    """A page's own text; see `write`."""
    parts = resources("footopt.report.page")

    def read(name: str) -> str:
        return (parts / name).read_text(encoding="utf-8")

    data = json.dumps(plain(content), separators=(",", ":"), allow_nan=False)
    filled = {
        "TITLE": html.escape(content["title"]),
        "STYLE": "\n".join([_roles(), *map(read, STYLES)]),
        # "</script>" in a name would end the element
        "DATA": data.replace("<", "\\u003c"),
        "SCRIPT": "\n".join(map(read, SCRIPTS)),
    }
    page = read("template.html")
    for name, value in filled.items():
        page = page.replace(f"<!--{name}-->", value)
    return page


def _roles() -> str:
    """The figures' colours of roles, which the page's style and scripts use."""
    return f":root {{ {' '.join(f'--{role}: {colour};' for role, colour in PALETTE.items())} }}"


def packed(values: ArrayLike, exact: bool = False, double: bool = False) -> dict[str, Any]:
    """An array as the page reads it.

    Whole numbers stay exact up to 2^24; other values are rounded to 1/65535 of their range, or, with
    `exact`, to 32-bit floats (which keep a NaN). With `double`, nothing is rounded.
    """
    array = np.asarray(values)
    large = array.size and np.issubdtype(array.dtype, np.integer) and np.ptp(array) > 65535
    if double:
        whole, low, step = array.astype("<f8"), 0.0, -1.0
    elif exact or large:
        whole, low, step = array.astype("<f4"), 0.0, 0.0
    else:
        low, high = (float(array.min()), float(array.max())) if array.size else (0.0, 0.0)
        fits = np.issubdtype(array.dtype, np.integer) or high == low
        step = 1.0 if fits else (high - low) / 65535
        whole = np.round((array - low) / step).astype("u1" if fits and high - low < 256 else "<u2")
    data = base64.b64encode(whole.tobytes()).decode("ascii")
    return {"shape": array.shape, "low": low, "step": step, "data": data}


def column(name: str, unit: str, maximise: bool) -> dict[str, Any]:
    """An objective as the page knows it."""
    return {"name": name, "title": title(name), "unit": unit, "maximise": maximise}
