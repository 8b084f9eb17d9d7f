"""The settings of a run: their names, types, defaults and meanings.

A default of the library is taken from there. The YAML files of conf/ only name what differs.
`build` makes the library's objects of the settings, `footopt.cli` composes them.
"""

import inspect
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import MISSING, asdict, dataclass, field, fields, is_dataclass, make_dataclass, replace
from functools import cache
from typing import Any, ClassVar, NamedTuple, get_type_hints

from omegaconf import OmegaConf

from footopt.design import Choice, Solver, Spread, make_executor
from footopt.design.problem import SETS
from footopt.effects import EFFECTS
from footopt.errors import SettingError, check
from footopt.files.gaits import COLUMNS
from footopt.files.soles import read_foot
from footopt.foot import Foot, Waypoints, shapes
from footopt.gait import Gait
from footopt.mujoco.robot import Robot
from footopt.report.terminal import described
from footopt.sand import Sand, StressMap
from footopt.walk import MEASURES, Accuracy, Walker

#: How much a run writes: from result.json, contour.csv and its store only, up to figures as PDF.
REPORTS = ("none", "light", "full", "print")


def default(function: Callable[..., Any], name: str) -> Any:
    """The default of a function's parameter."""
    return inspect.signature(function).parameters[name].default


def setting(value: Any, meaning: str | type) -> Any:
    """A field: its default (a class or function makes it) and its meaning (a class: its docstring)."""
    told = {"meaning": meaning}
    if callable(value):
        return field(default_factory=value, metadata=told)
    if isinstance(value, tuple | list):  # a list can be changed, as OmegaConf has it
        return field(default_factory=lambda: list(value), metadata=told)
    return field(default=value, metadata=told)


class Setting(NamedTuple):
    """A setting of a run, with its meaning and that of its group."""

    name: str  # in full
    default: Any
    meaning: str | type  # a class: its docstring has the meaning
    of_group: str | type

    @property
    def described(self) -> tuple[str, str]:
        """Its kind with the unit, and its meaning."""
        name = self.name.rpartition(".")[2]
        if isinstance(self.meaning, type):
            return described(self.meaning).get(name, ("", str(self.of_group)))
        limit = self.group == "constraint" and name in MEASURES
        return f"float, {MEASURES[name].unit}".removesuffix(", ") if limit else "", self.meaning

    @property
    def group(self) -> str:
        """The name of its group."""
        return self.name.partition(".")[0]


def leaves(group: Any, name: str = "", of_group: str | type = "") -> Iterator[Setting]:
    """All settings of a group, in order; a setting without a meaning gets that of its group."""
    for each in fields(group):
        value, path = getattr(group, each.name), f"{name}{each.name}"
        meaning = each.metadata.get("meaning", of_group)
        if is_dataclass(value) and fields(value):
            yield from leaves(value, f"{path}.", meaning)
        else:
            yield Setting(path, value, meaning, of_group)


def settings_class(kind: type, null: Collection[str] = (), given: Mapping[str, Any] | None = None) -> Any:
    """A dataclass with the fields and defaults of a frozen one of the library, which can be changed.

    `null` names fields that may be null; `given` has fields that are not as in the dataclass.
    """
    hints, made = get_type_hints(kind), []
    for f in fields(kind):
        value = f.default if f.default_factory is MISSING else f.default_factory()
        one = (given or {}).get(f.name) or setting(value, kind)
        made.append((f.name, hints[f.name] | None if f.name in null else hints[f.name], one))
    return make_dataclass(f"{kind.__name__}Settings", made)


SpaceConfig: Any = settings_class(Waypoints)
#: A null zeta means that of the sand.
SpreadConfig: Any = settings_class(Spread, ("zeta",), {"zeta": setting(None, Spread)})
BY_HAND = {f.name: setting(None, Accuracy) for f in fields(Accuracy) if f.name != "name"}
BY_HAND["tolerance"] = setting(None, "Takes the cheapest accuracy within this relative error.")
AccuracyConfig: Any = settings_class(Accuracy, BY_HAND, BY_HAND)


@dataclass
class StudySettings:
    """Settings of a study, a class of its own in its module, with the other settings that it reads."""

    name: str = setting("", "Name of the study.")
    #: Groups and single settings that the study reads besides its own.
    reads: ClassVar[tuple[str, ...]] = ()
    #: Choices of other groups that the study selects, unless the user selects other ones.
    brings: ClassVar[Mapping[str, str]] = {}

    def __post_init__(self) -> None:
        own = (name for name, (kind, _) in STUDIES.items() if kind is type(self))
        self.name = self.name or next(own, "optimize")


#: Studies by name: the settings of each, and the function that is called with a `Study`. Plugins add theirs.
STUDIES: dict[str, tuple[type[StudySettings], Callable[[Any], Any]]] = {}


@dataclass
class SandConfig:
    """The sand: zeta scales the generic stress map, or nine coefficients, or a table of stresses."""

    name: str = setting(Sand.name, "Name, for tables and legends.")
    zeta: float = setting(Sand.zeta, "Scale of the stress map on the Earth; 1 is the generic material.")
    spread: float = setting(Spread.zeta, "Uncertainty of zeta: the standard deviation of its logarithm.")
    coefficients: Any = setting(settings_class(StressMap), "In N/cm^3; Bm11, Cm11: the (-1, 1) terms.")
    table: str | None = setting(None, "File of measured stresses, to which nine coefficients are fitted.")


NamesConfig = make_dataclass("NamesConfig", [(name, str | None, None) for name in COLUMNS])


@dataclass
class GaitConfig:
    """The gait: the built-in human walk, or one from a file."""

    name: str = setting("human", "human, or file.")
    path: str | None = setting(None, "File of a leg's angles: CSV, MOT or STO.")
    period: float | None = setting(Gait.period, "Duration of a stride, s; null: that of the file.")
    harmonics: int = setting(default(Gait.human, "harmonics"), "Harmonics of each joint's Fourier series.")
    pitch: str = setting(Gait.pitch, "How the foot turns: with the shank, or as measured.")
    start: float = setting(Gait.start, "When the walker begins to walk, s; .inf: never.")
    side: str | None = setting(None, "Leg to read: right, left; null: right, or left if it is the only one.")
    window: list[float] | None = setting(None, "Begin and end of a stride in the file, s; null: all strides.")
    names: Any = setting(NamesConfig, "Name of this column in the file; null: one of the usual names.")


@dataclass
class FootConfig(SpaceConfig):
    """The foot: a space of `Waypoints` (and one sole k in it, to simulate), a shape, or a drawing."""

    shape: str = setting("waypoints", "Which sole: waypoints, one of the five shapes, or outline, a drawing.")
    k: list[int] | None = setting(None, "Heights of one sole, to simulate it.")
    length: float = setting(default(Foot.shape, "length"), "Contact length of a shape, m.")
    apex: str = setting(default(shapes.reversed_triangle, "apex"), "The triangle's apex: middle, toe.")
    upright: str = setting(default(shapes.reversed_l, "upright"), "Where the L's upright is: toe, heel.")
    path: str | None = setting(None, "File of a sole: DXF, SVG or CSV.")
    units: str | None = setting(None, "Unit of the file: mm, cm, m, in, ft, pt, px; null: as it says itself.")
    scale: float = setting(default(read_foot, "scale"), "Multiplies all lengths of the file.")
    layer: str | None = setting(None, "Layer or group that is read; null: SOLE if there is one, else all.")
    toe: str = setting(default(read_foot, "toe"), "Where the toe is in the file: right, or left.")
    origin: str = setting(default(read_foot, "origin"), "Foot frame's origin: file, or centre of its box.")
    block: list[float] | None = setting(None, "Length and height of a mounting block on the body, m.")


@dataclass
class EffectsConfig:
    """Effects beyond the plain law, whichever there are."""

    auto: bool = setting(False, "Whether to find and add the effects that matter.")
    tolerance: float | None = setting(None, "Relative change that matters to auto; null: the accuracy's.")


def no_effects() -> Any:
    """With a setting for each effect, of plugins too: its parameters, or null where it is not simulated."""
    return _effects_class(tuple(EFFECTS.items()))()


_dataclass = cache(make_dataclass)  # so that the settings of two runs compare
_typed: Any = cache(lambda study, *others: OmegaConf.structured(Config(study=study())))  # it takes long


@cache
def _effects_class(known: tuple[tuple[str, type], ...]) -> Any:
    each = [(name, settings_class(kind) | None, setting(None, kind)) for name, kind in known]
    return make_dataclass("AllEffects", each, bases=(EffectsConfig,))


@dataclass
class SceneConfig:
    """The scene: how long the walk lasts."""

    name: str = setting("walk", "Name of the scene.")
    t_f: float | None = setting(None, "End of the walk, s; null: two strides after the start.")


@dataclass
class SimulatorConfig:
    """What walks: the paper's walker, whose legs are massless, or a robot in MuJoCo."""

    name: str = setting("walker", "walker; biped, a robot of 60 kg; or robot, your own.")


@dataclass
class RobotConfig:
    """A robot in MuJoCo, with simulator=robot."""

    model: str | None = setting(None, "File of MJCF or URDF; null: that of simulator=biped.")
    feet: list[str] = setting(default(Robot, "feet"), Robot)
    controller: str | None = setting(None, "FILE.py:FUNCTION, or a CSV; null: servos track the gait.")
    joints: dict[str, str] | None = setting(
        None, "Joints that track the gait: {JOINT: left_hip, OTHER: -right_knee}; null: by these names."
    )
    duration: float | None = setting(None, Robot)
    after: float | None = setting(None, Robot)
    key: str | None = setting(None, Robot)
    lowest: float = setting(default(Robot, "lowest"), Robot)
    tilt: float = setting(default(Robot, "tilt"), Robot)
    density: float | None = setting(None, Robot)


@dataclass
class ObjectiveConfig:
    """The objectives, by name."""

    names: list[str] = setting(SETS["efficiency"], "One objective to optimise, or several for a front.")


@dataclass
class ChooseConfig:
    """Which design of a front is the answer where there are several objectives."""

    name: str = setting(Choice.by, "Which design of a front is the answer.")
    weights: dict[str, float] | None = setting(None, Choice)
    limits: dict[str, float] | None = setting(None, Choice)


def no_limits() -> Any:
    """With a setting for each measure, of plugins too: its limit, or null for none."""
    return _dataclass("ConstraintConfig", tuple((name, float | None, None) for name in MEASURES))()


@dataclass
class EngineConfig:
    """Where designs are evaluated: see `footopt.design.make_executor`."""

    name: str = setting(default(make_executor, "name"), "Where designs are evaluated: local, processes.")
    threads: int | None = setting(None, "Threads of this process; null: all processors.")
    workers: int | None = setting(None, "Processes, with engine=processes; null: as many as processors.")


@dataclass
class Config:
    """All settings of a run, one group each; plugins are files or modules of the user's own."""

    plugins: list[str] = setting(
        [], "Files (.py) or modules with effects, objectives, solvers, studies of yours."
    )
    report: str = setting(
        "full", "What a run leaves: full; print, figures as PDF, too; light, no figures; none, numbers only."
    )
    study: Any = field(default_factory=StudySettings)  # of the study that is chosen
    sand: SandConfig = field(default_factory=SandConfig)
    gait: GaitConfig = field(default_factory=GaitConfig)
    foot: FootConfig = field(default_factory=FootConfig)
    walker: Any = field(default_factory=settings_class(Walker))
    effects: EffectsConfig = field(default_factory=no_effects)
    scene: SceneConfig = field(default_factory=SceneConfig)
    simulator: SimulatorConfig = field(default_factory=SimulatorConfig)
    robot: RobotConfig = field(default_factory=RobotConfig)
    accuracy: Any = field(default_factory=AccuracyConfig)
    objective: ObjectiveConfig = field(default_factory=ObjectiveConfig)
    choose: ChooseConfig = field(default_factory=ChooseConfig)
    constraint: Any = setting(
        no_limits, "Largest value allowed, or smallest of what is maximised; null: no limit."
    )
    solver: Any = field(default_factory=settings_class(Solver))
    engine: EngineConfig = field(default_factory=EngineConfig)


#: Settings that name files or folders to read.
PATHS = ("foot.path", "gait.path", "robot.controller", "robot.model", "sand.table", "study.store",
         "study.run", "study.runs", "study.tests", "plugins")  # fmt: skip

#: Settings of a folder that may name code to run, and files to write: `check_trusted` refuses them.
CODE, WRITTEN = ("plugins", "robot.controller"), ("study.store", "study.video")

#: Settings that may change when a run is resumed: its budget, where it runs and what it writes.
CHANGEABLE = (
    "solver.n_gen", "solver.walks", "solver.seconds", "engine", "report", "choose", "study.confirm",
    "study.finalists", "study.store", "study.certify", "study.reuse", "study.video", "study.details",
    "study.laws", "foot.block", "plugins",
)  # fmt: skip


def check_complete(settings: Any) -> None:
    """Raise where settings as Hydra composes them leave a value open (???), or a group is null."""
    for name in sorted(OmegaConf.missing_keys(settings)):
        raise SettingError(name, "???", "given: the settings leave it open")
    groups = (name for name, of in asdict(Config()).items() if isinstance(of, dict))
    for name in (*groups, "sand.coefficients", "gait.names"):
        there = OmegaConf.select(settings, name) is not None
        check(there, name, None, "a group of settings", "Leave it out.")


def structured(settings: Mapping[str, Any]) -> Any:
    """Settings with their types, as OmegaConf has them: other names and kinds are refused."""
    kind, _ = STUDIES.get(str(settings["study"]["name"]), (StudySettings, None))
    return OmegaConf.merge(_typed(kind, type(no_effects()), type(no_limits())), settings)


def everything() -> Config:
    """The default settings, with all effects on, so that their parameters are among them."""
    return Config(effects=replace(no_effects(), **{n: each() for n, each in EFFECTS.items()}))


def known() -> dict[str, Setting]:
    """All settings by their full names, with their defaults: those of every effect and every study."""
    study = [*leaves(StudySettings(), "study.")]
    study += [each for kind, _ in STUDIES.values() for each in leaves(kind(), "study.")]
    found: dict[str, Setting] = {}
    for setting in leaves(everything()):
        for each in study if setting.name == "study.name" else [setting]:
            found.setdefault(each.name, each)
    return found


def chosen(group: str, choice: Any) -> dict[str, Any]:
    """The settings of a group with one of its choices, by their full names; the others are the defaults."""
    given = {name: setting.default for name, setting in known().items() if name.startswith(f"{group}.")}
    return given | {f"{group}.name": choice}


def shown(value: Any) -> str:
    """A value as it is written on the command line."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, (list, tuple)):
        return f"[{','.join(map(shown, value))}]"
    return ".inf" if value == math.inf else f"{value:g}" if isinstance(value, float) else str(value)
