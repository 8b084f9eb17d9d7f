"""Which settings a study reads; one that is given and not read has no effect, and is refused by its name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from footopt.design import EXHAUSTIVE
from footopt.errors import SettingError
from footopt.foot import SHAPES, Waypoints
from footopt.studies.settings import SEARCHES, Config
from footopt.walk import Spread

#: Read for every study: how it is run, not what is asked. A constraint is refused elsewhere.
ALWAYS = ("study.name", "plugins", "report", "engine.name", "engine.threads", "constraint", "hydra")

WORLD = ("gait", "walker", "effects", "scene")
SCENE = (*WORLD, "sand")
SPACE = tuple(f"foot.{field.name}" for field in fields(Waypoints))
SHAPE = ("foot.width", "foot.ankle", "foot.closed", "foot.top")
ZETA = "study.spread.zeta"  # of the model's error, in whatever closes with objectives
FIVE = (*SHAPE, "foot.length", "foot.apex", "foot.upright")
SEARCH = (*SPACE, "foot.shape", "foot.k", "accuracy", "objective", "solver", "engine", "study.confirm",
          "study.finalists", "study.store", "study.reuse")  # fmt: skip

#: What each study reads of the settings, a name or a group each. A plugin's study reads what it likes.
READS: dict[str, tuple[str, ...]] = {
    "optimize": (
        *SCENE, *SEARCH, "choose", "foot.block",
        *(f"study.{n}" for n in ("video", "start", "certify", "spread.zeta")),
    ),
    "simulate": (*SCENE, "foot", "accuracy", "objective.names", "study.run", "study.video", ZETA),
    "accuracy": (*WORLD, *SPACE, "solver.seed", "study.feet", "study.quick", ZETA),
    "stability": (*SCENE, "foot", "accuracy", "study.cases", "study.methods"),
    "effects": (*SCENE, *SPACE, "accuracy", "solver.seed", "study.feet"),
    "paper": (
        *WORLD, *SPACE, *FIVE, "foot.shape", "foot.k", "accuracy", "solver",
        *(f"study.{n}" for n in ("cases", "shape_sand", "mount", "peak_power", "speed_loss", "confirm")),
    ),
    "robust": (
        *SCENE, *SEARCH,
        *(f"study.{n}" for n in ("scenarios", "draws", "measure", "tail", "spread", "quick")),
    ),
    "export": ("foot.k", "foot.block", "study.run", "export.mujoco"),
    "compare": ("study.runs",),
    "doctor": (),
    "validate": ("study.cases",),
    "calibrate": ("study.tests", "sand.name", "sand.coefficients", "sand.table"),
}  # fmt: skip

#: Studies that walk with one foot, of any shape.
ONE_FOOT = ("simulate", "stability")
#: Those that leave it for the workshop.
MAKES = ("simulate",)

OUTLINE = ("path", "units", "scale", "layer", "toe", "origin")
#: What each kind of one foot reads.
FEET: dict[str, tuple[str, ...]] = {
    "waypoints": (*SPACE, "foot.k"),
    **dict.fromkeys(SHAPES, (*SHAPE, "foot.length")),
    "outline": (*SHAPE, *(f"foot.{name}" for name in OUTLINE)),
}
FEET["reversed_triangle"] += ("foot.apex",)
FEET["reversed_l"] += ("foot.upright",)

RECORDED = ("gait.names", "gait.side", "gait.max_gap", "gait.units")

#: The setting that the choice of a group sets, where it is not its name.
CHOICE = {"foot": "foot.shape", "objective": "objective.names", "planet": "walker.g", "effects": "effects"}


def check_read(config: Config, words: Iterable[str], files: Mapping[str, str] | None = None) -> None:
    """Refuse settings that are given and have no effect.

    A file of settings is for several studies: what only another study reads of it is no mistake.

    Parameters
    ----------
    config : Config
        All settings.
    words : iterable of str
        What was given on the command line: settings, and choices of groups.
    files : mapping of str to str, optional
        The same of YAML files of the user, each with its file.

    Raises
    ------
    SettingError
        The study, its foot, gait or solver does not read one; the message says what does.
    """
    study, files = config.study.name, files or {}
    for word in (*words, *files) if study in READS else ():
        given, word = word, word.lstrip("+~/").partition("=")[0].partition("@")[0]
        group, dot, _ = word.partition(".")
        if group not in {field.name for field in fields(Config)} and group not in CHOICE:
            continue  # a group of the user's own
        if group == "foot" and study in SEARCHES and config.foot.shape != "waypoints":
            continue  # refused by the study
        name = word if dot else CHOICE.get(word, f"{word}.name")
        if group == "foot" and not dot and config.foot.shape == "waypoints":
            name = "foot.n"  # a space, which its choice describes
        file = files.get(given, "")
        if not (file or _in(name, (*ALWAYS, *READS[study]))):
            by = ", ".join(other for other, names in READS.items() if _in(name, names))
            raise _unread(config, name, f"study={study}", f"study={by}" if by else "")
        for names, who, readers in _conditions(config):
            other = file and who.startswith("study=")
            if not other and any(f"{name}.".startswith(f"{n}.") for n in names):
                raise _unread(config, name, who, readers, file)


def _conditions(config: Config) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """Settings that this study reads only where others have certain values; who does not, and who does."""
    study, foot, gait = config.study, config.foot, config.gait
    every = tuple(dict.fromkeys(name for names in FEET.values() for name in names))
    if study.name in (*ONE_FOOT, *SEARCHES):
        of_run = study.name == "simulate" and study.run is not None
        own = ("foot.k",) if of_run else (*FEET.get(foot.shape, every), "foot.shape")
        for name in (*every, "foot.shape"):
            if not _in(name, own):
                by = [shape for shape, names in FEET.items() if name in names]
                who = "study=simulate run=..." if of_run else f"foot={foot.shape}"
                yield (name,), who, f"foot={', '.join(by)}" if by else "study=simulate without run"
        if study.name in ONE_FOOT and study.name not in MAKES:
            yield ("foot.block",), f"study={study.name}", "study=optimize, simulate, export"
    if gait.path is None or Path(gait.path).suffix.lower() == ".json":
        yield RECORDED, "a gait without recorded strides", "gait=file gait.path=walk.trc"
    if not config.effects.auto and study.name != "effects":
        yield ("effects.tolerance",), "effects that are named", "effects=auto"
    if config.solver.name == EXHAUSTIVE and study.name in SEARCHES:
        yield ("solver.n_gen", "solver.walks"), "solver=exhaustive", "the other solvers"
        yield ("study.certify",), "solver=exhaustive, whose best is that of all soles,", "the other solvers"
        if not (config.effects.auto or study.scenarios == "drawn"):
            yield ("solver.seed",), "solver=exhaustive", "the other solvers"
    if len(config.objective.names) == 1:
        yield ("choose",), "a search for one objective", "objective=pareto, or a list of several"
    else:
        yield ("study.certify",), "a search for several objectives", "a search for one objective"
    if config.engine.name != "dask":
        yield ("engine.timeout",), f"engine={config.engine.name}", "engine=dask"
    if study.name == "robust":
        if len(config.objective.names) > 1:
            several = "a search for several objectives, which confirms its front,"
            yield ("study.finalists",), several, "a search for one objective"
        source = f"study.scenarios={study.scenarios}"
        if study.scenarios != "drawn":
            drawn = [f"study.spread.{field.name}" for field in fields(Spread)]
            yield ("study.draws", *(n for n in drawn if n != ZETA)), source, "study.scenarios=drawn"
        if study.scenarios == "sands":
            yield ("sand",), source, "study.scenarios=drawn, laws"
        if study.measure != "tail":
            yield ("study.tail",), f"study.measure={study.measure}", "study.measure=tail"


def _in(name: str, names: Iterable[str]) -> bool:
    """Whether a setting is one of the names, in a group of them, or a group with some of them."""
    return any(f"{name}.".startswith(f"{n}.") or n.startswith(f"{name}.") for n in names)


def _unread(config: Config, name: str, who: str, readers: str, file: str = "") -> SettingError:
    value: Any = config
    for key in name.split("."):
        value = getattr(value, key, None)
    hint = f"It is read by {readers}." if readers else ""
    where = f" of {file}" if file else ""
    group = name.partition(".")[0]
    hint += f" What only one choice reads is best set in {group}/NAME.yaml, for {group}=NAME." if file else ""
    return SettingError(name, value, f"left out{where}: {who} does not read it", hint)
