"""Every setting: its kind and meaning, which studies read it, and where it has no effect and is refused."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Collection, Iterable
from dataclasses import fields, is_dataclass, replace
from typing import Any, NamedTuple

from footopt.design import EXHAUSTIVE, Spread
from footopt.effects import EFFECTS
from footopt.errors import SettingError, check
from footopt.foot import SHAPES
from footopt.report.terminal import described
from footopt.studies import BUILT_IN, OUTLINE, SPACE, WORN, SearchSettings
from footopt.studies.build import load_plugins, make_limits
from footopt.studies.settings import (
    SETTING_OF_GROUP,
    STUDIES,
    AllEffects,
    Config,
    OwnSettings,
    StudySettings,
    leaves,
)
from footopt.walk import MEASURES

GROUPS = tuple(field.name for field in fields(Config))

#: Read for every study: how it is run, not what is asked. A constraint is refused elsewhere.
ALWAYS = ("study.name", "study.own", "plugins", "report", "engine.name", "engine.threads", "constraint")


def _of_run(config: Config) -> bool:
    """Whether the foot is that of a run."""
    return config.study.name == "simulate" and config.study.run is not None


def _of(*shapes: str) -> tuple[str, Callable[[Config], bool]]:
    """Where a setting of some shapes counts; a study that reads no shape has soles of a space."""
    return (
        f"foot={', '.join(shapes)}",
        lambda c: not covers("foot.shape", c.study.reads) or (c.foot.shape in shapes and not _of_run(c)),
    )


#: Settings that count only where others have certain values: which, where that is, and whether it is so.
ONLY: tuple[tuple[tuple[str, ...], str, Callable[[Config], bool]], ...] = (
    (tuple({*SPACE} - {*WORN}), *_of("waypoints")),
    (("foot.k",), "foot=waypoints", lambda c: c.foot.shape == "waypoints" or _of_run(c)),
    (("foot.length",), *_of(*SHAPES)),
    (("foot.apex",), *_of("reversed_triangle")),
    (("foot.upright",), *_of("reversed_l")),
    (OUTLINE, *_of("outline")),
    (("foot.shape", *WORN), "study=simulate without run", lambda c: not _of_run(c)),
    (("gait.names", "gait.side", "gait.window"), "gait=file gait.path=walk.mot", lambda c: bool(c.gait.path)),
    (("robot",), "simulator=robot, biped", lambda c: c.simulator.name != "walker"),
    (("walker", "scene", "effects.auto", "study.spread.mass"), "simulator=walker",
     lambda c: c.simulator.name == "walker"),
    (("gait",), "a robot without robot.controller",
     lambda c: c.simulator.name == "walker" or not c.robot.controller),
    (("robot.joints",), "a robot without robot.controller", lambda c: not c.robot.controller),
    (("effects.tolerance",), "effects=auto", lambda c: c.effects.auto or c.study.name == "effects"),
    (("engine.timeout",), "engine=dask", lambda c: c.engine.name == "dask"),
    (("choose",), "objective=pareto, or a list of several", lambda c: len(c.objective.names) > 1),
    (("study.certify",), "a search for one objective", lambda c: len(c.objective.names) == 1),
    (("study.finalists",), "a search for one objective",
     lambda c: c.study.name != "robust" or len(c.objective.names) == 1),
    (("solver.n_gen", "solver.walks", "study.certify"), "solvers other than exhaustive",
     lambda c: c.solver.name != EXHAUSTIVE),
    (("study.tail",), "study.measure=tail", lambda c: c.study.measure == "tail"),
    (("study.draws", *(f"study.spread.{f.name}" for f in fields(Spread) if f.name != "zeta")),
     "study.scenarios=drawn", lambda c: c.study.scenarios == "drawn"),
    (("sand",), "study.scenarios=drawn, laws",
     lambda c: c.study.name != "robust" or c.study.scenarios != "sands"),
)  # fmt: skip


def everything() -> Config:
    """The default settings, with those of all effects."""
    effects = {each.name: EFFECTS[each.name]() for each in fields(AllEffects) if each.name in EFFECTS}
    return Config(effects=AllEffects(**effects))


def study_kinds() -> list[type[StudySettings]]:
    """The settings of all studies, a class each."""
    return [StudySettings, OwnSettings, *(kind for kind, _ in STUDIES.values())]


def known() -> dict[str, Any]:
    """All settings by their full names, with their defaults: those of every effect and every study."""
    study = [each for kind in study_kinds() for each in leaves(kind(), "study.")]
    found: dict[str, Any] = {}
    for setting in leaves(everything()):
        for each in study if setting.name == "study.name" else [setting]:
            found.setdefault(each.name, each)
    return found


def within(name: str, names: Collection[str]) -> bool:
    """Whether a setting is one of the names, or in a group of them."""
    return any(f"{name}.".startswith(f"{n}.") for n in names)


def covers(name: str, names: Collection[str]) -> bool:
    """Whether a setting is one of the names, in a group of them, or a group with some of them."""
    return within(name, names) or any(within(n, [name]) for n in names)


def read_by(study: str) -> tuple[str, ...]:
    """The settings, and groups of them, that a study reads."""
    kind, _ = STUDIES[study]
    return (*kind.reads, *(each.name for each in leaves(kind(), "study.")))


def studies_that_read(name: str) -> str:
    """The studies that read a setting, as they are chosen; "" if there is none."""
    return ", ".join(study for study in BUILT_IN if covers(name, read_by(study)))


def not_read(name: str, value: object, study: str) -> SettingError:
    """The refusal of a setting that a study does not read, with the studies that do."""
    readers = studies_that_read(name)
    hint = f"It is read by study={readers}." if readers else ""
    return SettingError(name, value, f"left out: study={study} does not read it", hint)


def check_read(config: Config, overrides: Iterable[str]) -> None:
    """Refuse settings that are given and have no effect.

    Parameters
    ----------
    config : Config
        All settings.
    overrides : iterable of str
        From the command line: settings, and choices of groups.

    Raises
    ------
    SettingError
        The study or its foot does not read one; the message says what does.
    """
    study, shape = config.study.name, config.foot.shape
    for override in overrides if study in BUILT_IN else ():
        given = override.lstrip("+~/").partition("=")[0].partition("@")[0]
        group, dot, _ = given.partition(".")
        if group not in (*GROUPS, *SETTING_OF_GROUP):
            continue  # of the user's own
        if group == "foot" and shape != "waypoints" and isinstance(config.study, SearchSettings):
            continue  # the study refuses that foot
        name = given if dot else SETTING_OF_GROUP.get(given, f"{given}.name")
        if given == "foot" and shape == "waypoints":
            name = "foot.n"  # a space, which its choice describes
        value: Any = config
        for key in name.split("."):
            value = getattr(value, key, None)
        if not covers(name, (*ALWAYS, *read_by(study))):
            raise not_read(name, value, study)
        for names, where, holds in ONLY:
            if within(name, names) and not holds(config):
                raise SettingError(name, value, "left out: it has no effect here", f"It is read by {where}.")


def check_values(config: Config) -> None:
    """Raise unless lists hold plain values, and no number is a NaN, be it read or not.

    OmegaConf lets lists in lists, interpolations and NaNs through.
    """
    for name, value, *_ in leaves(config):
        if isinstance(value, float):
            check(not math.isnan(value), name, value, "a number")
        elif isinstance(value, list):
            plain = all(isinstance(v, (int, float, str)) and v == v for v in value)
            check(plain, name, value, "a list of plain values")


def checked(config: Config, overrides: Iterable[str]) -> Config:
    """The settings, a plugin's study as the plugin has it; `SettingError` if they do not go together."""
    check_values(config)
    load_plugins(config.plugins)
    config = _chosen(config)
    check_read(config, overrides)
    name = config.study.name
    if config.engine.name != "local" and not isinstance(config.study, SearchSettings):
        raise SettingError("engine", config.engine.name, f"local for study={name}")
    reads, simulator = read_by(name), config.simulator.name
    if simulator != "walker" and covers("walker", reads) and not covers("simulator", reads):
        raise SettingError("simulator", simulator, f"walker for study={name}")
    if name != "optimize" and (limits := make_limits(config)):
        raise SettingError("constraint", limits, f"left out for study={name}", "study=optimize keeps limits.")
    return config


def _chosen(config: Config) -> Config:
    """The settings with a plugin's study as the plugin has it."""
    name = config.study.name
    if name not in STUDIES:
        hint = "A study of your own: plugins=[mine.py] study=own study.name=mine"
        raise SettingError("study.name", name, f"one of {', '.join(STUDIES)}", hint)
    kind, _ = STUDIES[name]
    if isinstance(config.study, OwnSettings):
        try:
            return replace(config, study=kind(name, **(config.study.own or {})))
        except TypeError as error:
            raise SettingError("study.own", config.study.own, f"settings that it has ({error})") from None
    if not isinstance(config.study, kind):
        raise SettingError("study.name", name, f"chosen as a group: study={name}")
    return config


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
    """All settings in the order of the groups, those of several studies once, without bare effects."""
    found = []
    for name, default, meaning, of_group in known().values():
        kind = ""
        if isinstance(meaning, type):
            kind, meaning = described(meaning).get(name.rpartition(".")[2], ("", str(of_group)))
        group, _, measure = name.partition(".")
        if group == "constraint" and measure in MEASURES:
            kind = f"float, {MEASURES[measure].unit}".removesuffix(", ")
        if not is_dataclass(default):
            found.append(Setting(name, default, kind, meaning))
    return found


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
