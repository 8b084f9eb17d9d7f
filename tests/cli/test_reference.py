"""The reference of settings is made of the program, so that it cannot be of another one."""

import runpy
from pathlib import Path

from footopt.effects import EFFECTS
from footopt.studies.settings import known

DOCS = Path(__file__).parents[2] / "docs"
REFERENCE = runpy.run_path(str(DOCS / "reference.py"))


def test_the_page_is_that_of_the_program():
    again = "python docs/reference.py > docs/reference.md"
    assert (DOCS / "reference.md").read_text(encoding="utf-8") == REFERENCE["page"](), (
        f"write it again: {again}"
    )


def test_every_setting_has_a_meaning_but_effects_without_parameters():
    bare, page = {f"effects.{name}" for name in EFFECTS}, REFERENCE["page"]()
    assert [s.name for s in known().values() if not s.described[1] and s.name not in bare] == []
    assert all(f"`{name}`" in page for name in {*known()} - bare)
