"""The reference of settings is made of the program, so that it cannot be of another one."""

import runpy
from pathlib import Path

from footopt.effects import EFFECTS
from footopt.studies.meanings import known, settings

DOCS = Path(__file__).parents[2] / "docs"
REFERENCE = runpy.run_path(str(DOCS / "reference.py"))


def test_the_page_is_that_of_the_program():
    again = "python docs/reference.py > docs/reference.md"
    assert (DOCS / "reference.md").read_text(encoding="utf-8") == REFERENCE["page"](), (
        f"write it again: {again}"
    )


def test_it_has_every_setting_with_a_meaning_and_none_that_is_gone():
    bare = {f"effects.{name}" for name in EFFECTS}  # effects without parameters
    assert sorted(s.name for s in settings()) == sorted(set(known()) - bare)
    assert [s.name for s in settings() if not s.meaning] == []
