"""The paper's claims one by one: ``python docs/claims.py`` writes claims.md in outputs/reference/paper.

claims.json there is the part of study=paper's result.json that has the claims and the feet.
"""

from __future__ import annotations

import json
from pathlib import Path

from footopt.studies.paper import summary, tables

FOLDER = Path(__file__).parents[1] / "outputs" / "reference" / "paper"


def markdown_rows(rows) -> str:
    """The rows of a Markdown table."""
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)


def page() -> str:
    """The claims as Markdown."""
    found = json.loads((FOLDER / "claims.json").read_text(encoding="utf-8"))
    text = (
        f"# The paper, claim by claim\n\n{summary(found)}. A margin is positive where a claim holds at the "
        "default settings. A claim depends on an open choice if making that choice differently reverses it. "
        "Choices are changed one at a time, and the feet are searched again for each. The paper's "
        "mistakes are in the [errata](../../../docs/evidence/errata.md).\n"
    )
    for title, head, rows in tables(found):
        text += f"\n## {title}\n\n{markdown_rows([head, ['---'] * len(head), *rows])}\n"
    return text


if __name__ == "__main__":
    (FOLDER / "claims.md").write_text(page(), encoding="utf-8")
