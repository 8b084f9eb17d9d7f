"""The reference of settings: ``python docs/reference.py > docs/reference.md`` writes the page.

Allowed values are read from refusals: each setting is given values that cannot be.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import is_dataclass, replace
from functools import reduce
from itertools import groupby
from typing import Any

from footopt.design import Solver
from footopt.design.result import check_finalists
from footopt.design.robust import check_measure
from footopt.effects import EFFECTS
from footopt.errors import SettingError
from footopt.studies import ALWAYS, build, covers, robust, studies_that_read
from footopt.studies.settings import STUDIES, Setting, everything, known, leaves, no_effects, shown
from footopt.walk import MEASURES, Walker

HEAD = """# Reference of settings

This page is made from the program (`docs/reference.py`), and a test holds it to that.
`footopt --help sand` shows a group of it. A setting that names no study is read by all.
Defaults are those without an option of a group; `sand=hard` and `accuracy=standard`, which a run
selects, set others.
"""
COLUMNS = ("setting", "default", "kind", "meaning", "allowed", "read by study=")

#: Values that hardly any setting can have: those of a number first.
WRONG = (math.nan, -1e30, -1, "?", ["?"])


def _limits(config: Any) -> None:
    for name, limit in build.make_limits(config).items():
        MEASURES[name].check_limit(f"constraint.{name}", limit)


def _study(config: Any) -> None:
    if hasattr(config.study, "finalists"):
        check_finalists(config.study.finalists)
    if hasattr(config.study, "measure"):
        robust.make_spread(config)
        check_measure(config.study.measure, config.study.tail)


#: The functions that make something of the settings of a group, and refuse wrong ones.
MADE: dict[str, Callable[[Any], object]] = {
    "sand": lambda c: build.make_sand(c.sand),
    "gait": lambda c: build.make_gait(c.gait),
    "foot": lambda c: (build.make_space(c.foot), build.make_foot(c.foot)),
    "walker": lambda c: Walker(**vars(c.walker)),
    "effects": lambda c: [replace(e) for name, e in vars(c.effects).items() if name in EFFECTS],
    "scene": lambda c: build.make_scene(replace(c, effects=no_effects())),
    "accuracy": lambda c: build.make_accuracy(c.accuracy),
    "choose": build.make_choice,
    "constraint": _limits,
    "solver": lambda c: Solver(**vars(c.solver)),
    "study": _study,
}


def allowed(setting: Setting) -> str:
    """The allowed values, as the refusal of a wrong one says them; "" where nothing refuses it."""
    *groups, last = setting.name.split(".")
    for wrong in WRONG if setting.group in MADE and groups else ():
        if isinstance(setting.default, (int, float)) and not isinstance(wrong, (int, float)):
            continue
        config = everything()
        for kind, _ in STUDIES.values():
            if setting.name in {each.name for each in leaves(kind(), "study.")}:
                config = replace(config, study=kind())
                break
        try:
            object.__setattr__(reduce(getattr, groups, config), last, wrong)  # effects are frozen
            MADE[setting.group](config)
        except SettingError as error:
            if error.setting in (setting.name, setting.name.removesuffix(".name")):
                return error.allowed
        except Exception:  # of another kind than any value that settings can have
            continue
    return ""


def cells(setting: Setting) -> tuple[str, ...]:
    """The row of a setting."""
    readers = "" if covers(setting.name, ALWAYS) else studies_that_read(setting.name)
    shows = f"`{shown(setting.default)}`"
    return f"`{setting.name}`", shows, *setting.described, allowed(setting), readers


def rows(*table: tuple[str, ...]) -> str:
    """A table's rows in Markdown."""
    escaped = ((cell.replace("|", "\\|").replace("*", "\\*") for cell in row) for row in table)
    return "".join(f"| {' | '.join(row)} |\n" for row in escaped)


def page() -> str:
    """The reference as Markdown."""
    found = HEAD
    told = (setting for setting in known().values() if not is_dataclass(setting.default))
    for group, members in groupby(told, lambda setting: setting.group):
        found += f"\n## `{group}`\n\n{rows(COLUMNS, ('---',) * len(COLUMNS), *map(cells, members))}"
    return found


if __name__ == "__main__":
    print(page(), end="")
