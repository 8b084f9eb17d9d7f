"""Sphinx: `sphinx-build -W -c docs . build/site` makes the documentation as a site.

The source folder is the repository, so that links to the README, the examples and the reference figures
work here as they do on the hosting site. Equations are drawn by a copy of MathJax in the site: nothing is
loaded from elsewhere.
"""

from __future__ import annotations

import re
from typing import Any

import footopt

project = "footopt"
author = "the footopt developers"
version = release = footopt.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "sphinx-mathjax-offline"]
root_doc = "README"
include_patterns = [
    "*.md",
    "docs/**",
    "examples/*.md",
    "outputs/reference/paper/claims.md",
]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
default_role = "literal"
html_theme = "furo"
html_title = f"footopt {version}"
html_copy_source = False

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "none"  # types stand in the docstrings
numpydoc_show_class_members = False

EVIDENCE = (
    "accuracy",
    "search",
    "print",
    "fronts",
    "rest",
    "gaits",
    "calibration",
    "validation",
    "mujoco",
    "transfer",
    "speed",
    "tests",
    "errata",
)

#: The pages in the order of reading; the README is the first page and stays free of it.
CONTENTS = {
    "Start": ("docs/getting-started", "docs/pymoo", "docs/hydra", "docs/python", "examples/README",
              "docs/troubleshooting"),
    "Your own": ("docs/files", "docs/mujoco", "docs/extending"),
    "Choose": ("docs/accuracy", "docs/effects", "docs/solvers"),
    "Believe": ("docs/physics", "docs/validation", "docs/stability", "outputs/reference/paper/claims",
                *(f"docs/evidence/{name}" for name in EVIDENCE)),
    "Look up": ("docs/reference", "docs/api"),
    "Develop": ("CONTRIBUTING", "VISION", "CHANGELOG"),
}  # fmt: skip


def add_contents(app: Any, page: str, source: list[str]) -> None:
    """Append the tables of contents to the first page."""
    if page == root_doc:
        for caption, pages in CONTENTS.items():
            listed = "\n".join(f"/{name}" for name in pages)
            source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{listed}\n```\n"


def keep_magnitudes(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Let docstrings write |z| for a magnitude, which reStructuredText would take for a substitution."""
    lines[:] = [re.sub(r"(?<!`)\|([^|`\s][^|`]*)\|", r"\\|\1\\|", line) for line in lines]


def setup(app: Any) -> None:
    """Connect the two functions above."""
    app.connect("source-read", add_contents)
    app.connect("autodoc-process-docstring", keep_magnitudes)
