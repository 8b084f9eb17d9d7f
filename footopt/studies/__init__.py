"""Studies, a module for each question; `check_read`, which settings count; `run_study`, which asks one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from footopt.design import EXHAUSTIVE
from footopt.errors import ERROR_FILE, FootoptError, SettingError
from footopt.files.identity import FILE, locked
from footopt.foot import SHAPES
from footopt.studies.base import Study
from footopt.studies.build import check_values, load_plugins, make_limits
from footopt.studies.runs import claim_folder
from footopt.studies.settings import (
    GROUP_OPTIONS,
    OUTLINE,
    SETTING_OF_GROUP,
    SHAPE,
    SPACE,
    STUDIES,
    Config,
    OwnSettings,
    SearchSettings,
    StudySettings,
    leaves,
)
from footopt.walk.batch import at_once

__all__ = ["STUDIES", "StudySettings", "check_read", "run_study", "studies_that_read"]

#: footopt's own studies, each the class `Settings` and the function `run` of a module.
BUILT_IN = ("optimize", "simulate", "accuracy", "stability", "effects", "paper", "robust", "export",
            "compare", "doctor", "validate", "calibrate")  # fmt: skip
for _name in BUILT_IN:
    _module = import_module(f"footopt.studies.{_name}")
    STUDIES[_name] = _module.Settings, _module.run
    GROUP_OPTIONS["study"][_name] = _module.Settings

#: Read for every study: how it is run, not what is asked. A constraint is refused elsewhere.
ALWAYS = (
    "study.name",
    "study.own",
    "plugins",
    "report",
    "engine.name",
    "engine.threads",
    "constraint",
    "hydra",
)

#: Settings that each kind of one foot reads.
READ_BY_FOOT: dict[str, tuple[str, ...]] = {
    "waypoints": (*SPACE, "foot.k"),
    **dict.fromkeys(SHAPES, (*SHAPE, "foot.length")),
    "outline": (*SHAPE, *OUTLINE),
}
READ_BY_FOOT["reversed_triangle"] += ("foot.apex",)
READ_BY_FOOT["reversed_l"] += ("foot.upright",)

#: Settings that are read only where others have certain values: which, whether they have, and the readers.
ONLY: tuple[tuple[tuple[str, ...], Callable[[Config], bool], str], ...] = (
    (("gait.names", "gait.side", "gait.window"),
     lambda c: c.gait.path is not None,
     "gait=file gait.path=walk.mot"),
    (("effects.tolerance",), lambda c: c.effects.auto or c.study.name == "effects", "effects=auto"),
    (("engine.timeout",), lambda c: c.engine.name == "dask", "engine=dask"),
    (("choose",), lambda c: len(c.objective.names) > 1, "objective=pareto, or a list of several"),
    (("study.certify",), lambda c: len(c.objective.names) == 1, "a search for one objective"),
    (("study.finalists",), lambda c: c.study.name != "robust" or len(c.objective.names) == 1,
     "a search for one objective"),
    (("solver.n_gen", "solver.walks", "study.certify"), lambda c: c.solver.name != EXHAUSTIVE,
     "solvers other than exhaustive"),
    (("study.tail",), lambda c: c.study.measure == "tail", "study.measure=tail"),
    (("study.draws", "study.spread.mass", "study.spread.period", "study.spread.stride", "study.spread.angles",
      "study.spread.ankle_x", "study.spread.ankle_z"), lambda c: c.study.scenarios == "drawn",
     "study.scenarios=drawn"),
    (("sand",), lambda c: c.study.name != "robust" or c.study.scenarios != "sands",
     "study.scenarios=drawn, laws"),
)  # fmt: skip


def studies_that_read(name: str) -> str:
    """The studies that read a setting, as they are chosen; "" if there is none."""
    return ", ".join(study for study in BUILT_IN if covers(name, settings_of(study)))


def settings_of(study: str) -> tuple[str, ...]:
    kind, _ = STUDIES[study]
    return (*kind.reads, *dict(leaves(kind(), "study.")))


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
    searched = isinstance(config.study, SearchSettings)
    groups = {field.name for field in fields(Config)} | {*SETTING_OF_GROUP}
    for override in overrides if config.study.name in BUILT_IN else ():
        given = override.lstrip("+~/").partition("=")[0].partition("@")[0]
        group, dot, _ = given.partition(".")
        if group not in groups or (group == "foot" and searched and config.foot.shape != "waypoints"):
            continue  # a group of the user's own; a foot that the study refuses
        name = given if dot else SETTING_OF_GROUP.get(given, f"{given}.name")
        if given == "foot" and config.foot.shape == "waypoints":
            name = "foot.n"  # a space, which its choice describes
        _check_study_reads(config, name)
        _check_foot_reads(config, name)
        for names, holds, readers in ONLY:
            if any(f"{name}.".startswith(f"{n}.") for n in names) and not holds(config):
                raise _unread(config, name, "it has no effect here", readers)


def _check_study_reads(config: Config, name: str) -> None:
    study = config.study.name
    if not covers(name, (*ALWAYS, *settings_of(study))):
        readers = studies_that_read(name)
        raise _unread(config, name, f"study={study} does not read it", f"study={readers}" if readers else "")


def _check_foot_reads(config: Config, name: str) -> None:
    """Refuse a setting of the foot that its shape does not have."""
    study, shape = config.study, config.foot.shape
    if name == "foot.block" or not name.startswith("foot."):
        return
    if not (isinstance(study, SearchSettings) or study.name in ("simulate", "stability")):
        return  # whatever the study reads of it
    of_run = study.name == "simulate" and getattr(study, "run", None) is not None
    if not covers(name, ("foot.k",) if of_run else (*READ_BY_FOOT.get(shape, ()), "foot.shape")):
        readers = ", ".join(kind for kind, names in READ_BY_FOOT.items() if name in names)
        where = f"foot={readers}" if readers else "study=simulate without run"
        what = "study=simulate run=..." if of_run else f"foot={shape}"
        raise _unread(config, name, f"{what} does not read it", where)


def covers(name: str, names: Iterable[str]) -> bool:
    """Whether a setting is one of the names, in a group of them, or a group with some of them."""
    return any(f"{name}.".startswith(f"{n}.") or n.startswith(f"{name}.") for n in names)


def _unread(config: Config, name: str, why: str, readers: str) -> SettingError:
    value: Any = config
    for key in name.split("."):
        value = getattr(value, key, None)
    hint = f"It is read by {readers}." if readers else ""
    return SettingError(name, value, f"left out: {why}", hint)


def run_study(
    config: Config,
    folder: Path,
    settings: Mapping[str, Any],
    overrides: Sequence[str] = (),
    resumed: bool = False,
) -> Any:
    """Run the study that the settings name.

    Parameters
    ----------
    config : Config
        The settings.
    folder : Path
        Where the study leaves what it finds.
    settings : dict
        The same settings as plain data: what the run is.
    overrides : sequence of str
        What was given on the command line.
    resumed : bool
        Whether it goes on with what is in the folder.

    Returns
    -------
    float or tuple, optional
        The objective of the foot that the study is about, or its objectives: natural signs.

    Raises
    ------
    Occupied
        Another run is at work in the folder, or has left what it found there.
    SettingError
        There is no such study, or it does not go with the other settings.
    """
    check_values(config)
    at_once(config.engine.threads)
    load_plugins(config.plugins)
    config = _chosen(config)
    check_read(config, overrides)
    name, searches = config.study.name, isinstance(config.study, SearchSettings)
    if config.engine.name != "local" and not searches:
        raise SettingError("engine", config.engine.name, f"local for study={name}")
    if name != "optimize" and (limits := make_limits(config)):
        raise SettingError("constraint", limits, f"left out for study={name}", "study=optimize keeps limits.")
    with locked(folder):
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that failed before
        before = {*folder.iterdir()}
        if not resumed:
            claim_folder(folder, settings, overrides)
        try:
            return STUDIES[name][1](Study(config, folder, settings, overrides))
        except FootoptError:
            if {*folder.iterdir()} - before == {folder / FILE}:  # it was refused: there is no run
                (folder / FILE).unlink()
            raise


def _chosen(config: Config) -> Config:
    """The settings with those of a plugin's study as what the plugin has them."""
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
