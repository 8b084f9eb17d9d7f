"""The reference of settings is made of the program, so that it cannot be of another one."""

import runpy
from pathlib import Path

import pytest
from running import footopt

from footopt.cli.compose import groups
from footopt.effects import EFFECTS
from footopt.studies.meanings import settings
from footopt.studies.settings import known

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


@pytest.mark.parametrize(
    ("name", "allowed"),
    [
        ("walker.mass", "a number > 0, from 1e-09 to 1e+09, in kg"),
        ("foot.n", "a whole number from 4 to 200"),
        ("solver.pop_size", "null, or a whole number >= 4 and <= 100,000"),
        ("gait.pitch", "shank or measured"),
        ("effects.slope.angle", "an angle from -25 to 25, in deg"),
    ],
)
def test_what_is_allowed_is_what_a_refusal_says(name, allowed):
    (setting,) = (s for s in settings() if s.name == name)
    assert REFERENCE["allowed"](setting) == allowed


def test_help_shows_every_group(tmp_path):
    for group in groups():
        assert " = " in footopt("--help", group, cwd=tmp_path).stdout, group


def test_help_shows_the_settings_of_a_group(tmp_path):
    done = footopt("--help", "walker", "sand", "study", cwd=tmp_path)
    assert done.returncode == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "walker.g = 9.81  (float, m/s^2)\n    Gravity." in done.stdout
    assert "sand.zeta = 1\n    Scale of the stress map on the Earth" in done.stdout
    assert "foot.n" not in done.stdout
