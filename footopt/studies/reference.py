"""The reference of settings: ``python -m footopt.studies.reference > docs/reference.md`` writes the page.

Defaults and meanings are those of `footopt.studies.settings`, which has them of the library where it has the
setting. What is allowed is what a refusal says: each setting is given a value that cannot be.
"""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from collections.abc import Callable, Container
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import reduce
from typing import Any

from footopt.design import Solver
from footopt.design.result import check_finalists
from footopt.design.scenarios import check_measure
from footopt.effects import EFFECTS
from footopt.errors import SettingError
from footopt.report.terminal import described
from footopt.studies import ALWAYS, build, covers, studies_that_read
from footopt.studies.settings import (
    SETTING_OF_GROUP,
    AllEffects,
    Config,
    everything,
    known,
    leaves,
    study_kinds,
)
from footopt.walk import MEASURES, Walker

GROUPS = tuple(field.name for field in fields(Config))

#: Values that hardly any setting can have: those of a number first.
WRONG = (math.nan, -1e30, -1, "?", ["?"])


def _limits(config: Any) -> None:
    for name, limit in build.make_limits(config).items():
        MEASURES[name].check_limit(f"constraint.{name}", limit)


def _study(config: Any) -> None:
    if hasattr(config.study, "finalists"):
        check_finalists(config.study.finalists)
    if hasattr(config.study, "measure"):
        build.make_spread(config)
        check_measure(config.study.measure, config.study.tail)


#: What refuses the settings of a group: it is made of them.
MADE: dict[str, Callable[[Any], object]] = {
    "sand": lambda c: build.make_sand(c.sand),
    "gait": lambda c: build.make_gait(c.gait),
    "foot": lambda c: (build.make_space(c.foot), build.make_foot(c.foot)),
    "walker": lambda c: Walker(**vars(c.walker)),
    "effects": lambda c: [replace(e) for name, e in vars(c.effects).items() if name in EFFECTS],
    "scene": lambda c: build.make_scene(replace(c, effects=AllEffects())),
    "accuracy": lambda c: build.make_accuracy(c.accuracy),
    "choose": build.make_choice,
    "constraint": _limits,
    "solver": lambda c: Solver(**vars(c.solver)),
    "study": _study,
}


@dataclass(frozen=True)
class Setting:
    """A setting as the reference has it; `studies` are those that read it."""

    name: str
    default: Any
    kind: str
    meaning: str
    allowed: str
    studies: tuple[str, ...]


def settings(groups: Container[str] | None = None) -> list[Setting]:
    """All settings, or those of some groups, in the order of the groups."""
    return [
        _setting(name, value)
        for name, value in known().items()
        if (groups is None or name.partition(".")[0] in groups) and not is_dataclass(value)
    ]


def _owner(name: str) -> Any:
    """Settings of which `name` is one: those of the first study that has it."""
    own = next((kind() for kind in study_kinds() if name in dict(leaves(kind(), "study."))), None)
    return replace(everything(), study=own) if own else everything()


def _setting(name: str, value: Any) -> Setting:
    kind, meaning = _told(name)
    readers = () if covers(name, ALWAYS) else tuple(studies_that_read(name).split(", "))
    return Setting(name, value, kind, meaning, _allowed(name, value), readers)


def _told(name: str) -> tuple[str, str]:
    """Kind, with its unit, and meaning of a setting: its own, else that of its group."""
    told, owner, keys = ("", ""), _owner(name), name.split(".")
    for key in keys:
        meaning = next(f for f in fields(owner) if f.name == key).metadata.get("meaning")
        if isinstance(meaning, str):
            told = "", meaning
        elif meaning is not None:
            told = described(meaning).get(keys[-1], told)
        owner = getattr(owner, key)
    unit = MEASURES[keys[1]].unit if keys[0] == "constraint" and keys[1] in MEASURES else None
    return told if unit is None else (f"float, {unit}".removesuffix(", "), told[1])


def _allowed(name: str, default: Any) -> str:
    """What is allowed, as the refusal of a value that cannot be says it; "" where nothing refuses it."""
    *groups, last = name.split(".")
    for wrong in WRONG if groups and groups[0] in MADE else ():
        if isinstance(default, (int, float)) and not isinstance(wrong, (int, float)):
            continue
        config = _owner(name)
        try:
            object.__setattr__(reduce(getattr, groups, config), last, wrong)  # effects are frozen
            MADE[groups[0]](config)
        except SettingError as error:
            if error.setting in (name, name.removesuffix(".name")):
                return error.allowed
        except Exception:  # of another kind than any value that settings can have
            continue
    return ""


def text(groups: tuple[str, ...]) -> str:
    """The reference of some groups for a terminal."""
    lines: list[str] = []
    for group in groups:
        # what a group without settings of its own sets, another has
        found = list(settings((group,))) or [s for s in settings() if s.name == SETTING_OF_GROUP[group]]
        usual, many = Counter(s.studies for s in found).most_common(1)[0]
        usual = usual if many > len(found) / 2 else ()
        if usual:
            said = "" if all(s.studies == usual for s in found) else ", where nothing else is said"
            lines += [f"Read by study={', '.join(usual)}{said}."]
        for s in found:
            kind = f"  ({s.kind})" if s.kind else ""
            lines += [f"{s.name} = {_shown(s.default)}{kind}", f"    {s.meaning}"]
            lines += [f"    Allowed: {s.allowed}."] if s.allowed else []
            if s.studies != usual:
                lines += [f"    Read by {'study=' + ', '.join(s.studies) if s.studies else 'every study'}."]
    return "\n".join(textwrap.fill(line, 80, subsequent_indent="    ") for line in lines)


def page() -> str:
    """The reference as Markdown."""
    lines = [
        "# Reference of settings",
        "",
        "This page is made from the program (`footopt/studies/reference.py`), and a test holds it to that.",
        "`footopt --help sand` shows a group of it. A setting that names no study is read by all.",
    ]
    group = None
    for s in settings():
        if s.name.partition(".")[0] != group:
            group = s.name.partition(".")[0]
            head = "| setting | default | kind | meaning | allowed | read by study= |"
            lines += ["", f"## `{group}`", "", head, "| --- | --- | --- | --- | --- | --- |"]
        cells = (f"`{s.name}`", f"`{_shown(s.default)}`", s.kind, s.meaning, s.allowed, ", ".join(s.studies))
        lines.append("| " + " | ".join(cell.replace("|", "\\|").replace("*", "\\*") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _shown(value: Any) -> str:
    """A value as one writes it on the command line."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, float) and math.isinf(value):
        return ".inf"
    if isinstance(value, (list, tuple)):
        return f"[{','.join(map(_shown, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    print(page(), end="")
