"""The default, kind and meaning of every setting, for `footopt --help sand` and docs/reference.md."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple

from footopt.report.terminal import described
from footopt.studies.settings import SETTING_OF_GROUP, Config, everything, study_kinds
from footopt.walk import MEASURES

GROUPS = tuple(field.name for field in fields(Config))


class Setting(NamedTuple):
    """A setting: its full name, its default, its kind with the unit, and its meaning."""

    name: str
    default: Any
    kind: str
    meaning: str

    @property
    def group(self) -> str:
        """The group that it is in."""
        return self.name.partition(".")[0]


def settings() -> list[Setting]:
    """All settings in the order of the groups, those of several studies once."""
    found: dict[str, Setting] = {}
    for setting in _inside(everything()):
        alternatives = [setting]
        if setting.group == "study":
            alternatives = [each for kind in study_kinds() for each in _inside(kind(), "study.")]
        for each in alternatives:
            found.setdefault(each.name, each)
    return list(found.values())


def _inside(group: Any, path: str = "", outer: Any = "") -> Iterator[Setting]:
    """The settings of a group; one without a meaning of its own has that of its group, `outer`."""
    for field in fields(group):
        value, name = getattr(group, field.name), f"{path}{field.name}"
        meaning = field.metadata.get("meaning", outer)
        if is_dataclass(value):
            yield from _inside(value, f"{name}.", meaning)
            continue
        kind = ""
        if isinstance(meaning, type):
            kind, meaning = described(meaning).get(field.name, ("", outer))
        if path == "constraint." and field.name in MEASURES:
            kind = f"float, {MEASURES[field.name].unit}".removesuffix(", ")
        yield Setting(name, value, kind, meaning)


def text(groups: Collection[str]) -> str:
    """The settings of some groups for a terminal."""
    names = {SETTING_OF_GROUP.get(group) for group in groups}
    lines: list[str] = []
    for setting in settings():
        if setting.group in groups or setting.name in names:
            kind = f"  ({setting.kind})" if setting.kind else ""
            lines += [f"{setting.name} = {shown(setting.default)}{kind}", f"    {setting.meaning}"]
    return "\n".join(textwrap.fill(line, 80, subsequent_indent="    ") for line in lines)


def shown(value: Any) -> str:
    """A value as it is written on the command line."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, (list, tuple)):
        return f"[{','.join(map(shown, value))}]"
    return ".inf" if value == math.inf else f"{value:g}" if isinstance(value, float) else str(value)
