"""Studies: a module for each question; which settings each reads, and `run`, which asks one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any

from footopt.design import EXHAUSTIVE
from footopt.errors import ERROR_FILE, SettingError
from footopt.files.identity import locked
from footopt.foot import SHAPES, Waypoints
from footopt.studies.settings import SEARCHES, Config

#: Read for every study: how it is run, not what is asked. A constraint is refused elsewhere.
ALWAYS = ("study.name", "plugins", "report", "engine.name", "engine.threads", "constraint", "hydra")

WORLD = ("gait", "walker", "effects", "scene")
SCENE = (*WORLD, "sand")
SPACE = tuple(f"foot.{field.name}" for field in fields(Waypoints))
SHAPE = ("foot.width", "foot.ankle", "foot.closed", "foot.top")
ZETA = "study.spread.zeta"  # of the model's error, in whatever closes with objectives
OUTLINE = ("path", "units", "scale", "layer", "toe", "origin")
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
    "stability": (*SCENE, *SPACE, *FIVE, "foot.shape", "foot.k", *(f"foot.{n}" for n in OUTLINE), "accuracy",
                  "study.cases", "study.methods"),
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

#: What each kind of one foot reads.
FEET: dict[str, tuple[str, ...]] = {
    "waypoints": (*SPACE, "foot.k"),
    **dict.fromkeys(SHAPES, (*SHAPE, "foot.length")),
    "outline": (*SHAPE, *(f"foot.{n}" for n in OUTLINE)),
}
FEET["reversed_triangle"] += ("foot.apex",)
FEET["reversed_l"] += ("foot.upright",)

#: Settings that are read only where others have certain values: which, whether they have, and who reads them.
ONLY: tuple[tuple[tuple[str, ...], Callable[[Config], bool], str], ...] = (
    (("gait.names", "gait.side", "gait.units", "gait.window"),
     lambda c: c.gait.path is not None and not c.gait.path.lower().endswith(".json"),
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

#: The setting that the choice of a group sets, where it is not its name.
CHOICE = {"foot": "foot.shape", "objective": "objective.names", "planet": "walker.g", "effects": "effects"}

#: Studies by name: each is the function `run` of the module of that name. A plugin adds its own function.
STUDIES: dict[str, Callable[[Any], Any] | None] = dict.fromkeys(READS)


def check_read(config: Config, words: Iterable[str]) -> None:
    """Refuse settings that are given and have no effect.

    Parameters
    ----------
    config : Config
        All settings.
    words : iterable of str
        What was given on the command line: settings, and choices of groups.

    Raises
    ------
    SettingError
        The study or its foot does not read one; the message says what does.
    """
    study = config.study.name
    groups = {field.name for field in fields(Config)} | {*CHOICE}
    for word in words if study in READS else ():
        word = word.lstrip("+~/").partition("=")[0].partition("@")[0]
        group, dot, _ = word.partition(".")
        shape = config.foot.shape
        if group not in groups or (group == "foot" and study in SEARCHES and shape != "waypoints"):
            continue  # a group of the user's own; a foot that the study refuses
        name = word if dot else CHOICE.get(word, f"{word}.name")
        if group == "foot" and not dot and shape == "waypoints":
            name = "foot.n"  # a space, which its choice describes
        if not reads(name, (*ALWAYS, *READS[study])):
            by = ", ".join(other for other, names in READS.items() if reads(name, names))
            raise _unread(config, name, f"study={study} does not read it", f"study={by}" if by else "")
        if group == "foot" and name != "foot.block" and study in ("simulate", "stability", *SEARCHES):
            of_run = study == "simulate" and config.study.run is not None
            own = ("foot.k",) if of_run else (*FEET.get(shape, ()), "foot.shape")
            if not reads(name, own):
                what = "study=simulate run=..." if of_run else f"foot={shape}"
                by = ", ".join(kind for kind, names in FEET.items() if name in names)
                where = f"foot={by}" if by else "study=simulate without run"
                raise _unread(config, name, f"{what} does not read it", where)
        for names, holds, readers in ONLY:
            if any(f"{name}.".startswith(f"{n}.") for n in names) and not holds(config):
                raise _unread(config, name, "it has no effect here", readers)


def reads(name: str, names: Iterable[str]) -> bool:
    """Whether a setting is one of the names, in a group of them, or a group with some of them."""
    return any(f"{name}.".startswith(f"{n}.") or n.startswith(f"{name}.") for n in names)


def _unread(config: Config, name: str, why: str, readers: str) -> SettingError:
    value: Any = config
    for key in name.split("."):
        value = getattr(value, key, None)
    hint = f"It is read by {readers}." if readers else ""
    return SettingError(name, value, f"left out: {why}", hint)


def run(
    config: Config,
    folder: Path,
    settings: Mapping[str, Any],
    words: Sequence[str] = (),
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
    words : sequence of str
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
    # what is imported here would slow `footopt --help` down
    from footopt.studies.base import Study
    from footopt.studies.build import check_lists, load_plugins, make_limits
    from footopt.studies.runs import enter
    from footopt.walk.simulate import at_once

    check_lists(config)
    at_once(config.engine.threads)
    load_plugins(config.plugins)
    check_read(config, words)
    name = config.study.name
    if name not in STUDIES:
        raise SettingError("study.name", name, f"one of {', '.join(STUDIES)}")
    if config.engine.name != "local" and name not in SEARCHES:
        raise SettingError("engine", config.engine.name, f"local for study={name}")
    if name != "optimize" and (limits := make_limits(config)):
        raise SettingError("constraint", limits, f"left out for study={name}", "study=optimize keeps limits.")
    ask = STUDIES[name] or import_module(f"footopt.studies.{name}").run
    with locked(folder):
        if not resumed:
            enter(folder, settings, words)
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that failed before
        return ask(Study(config, folder, settings, words))
