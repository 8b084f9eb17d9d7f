"""The settings of a run: their names, their types, and where each default comes from.

A default of the library is taken from there. The YAML files of conf/ only name what differs.
`footopt.studies.build` makes the library's objects of the settings, `footopt.cli` composes them.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, make_dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, get_type_hints

from omegaconf import OmegaConf

from footopt.design import EXHAUSTIVE, FRONT_RULES, SINGLE, SOLVERS, Choice, Solver, Spread, make_executor
from footopt.design.problem import SETS
from footopt.design.solvers.registry import AUTO
from footopt.effects import EFFECTS
from footopt.files.soles import read_foot
from footopt.foot import SHAPES, Foot, Waypoints, shapes
from footopt.gait import Gait
from footopt.mujoco.robot import Robot
from footopt.sand import MEDIA, Sand, StressMap
from footopt.walk import MEASURES, PRESETS, Accuracy, Walker

#: How much a run leaves: result.json, contour.csv and what it is resumed from; all but figures; everything.
REPORTS = ("none", "light", "full", "print")

#: Solvers of several objectives.
SEVERAL = [name for name in SOLVERS if name not in (*SINGLE, EXHAUSTIVE)]


def default(function: Callable[..., Any], name: str) -> Any:
    """The default of a function's parameter."""
    return inspect.signature(function).parameters[name].default


def setting(value: Any, meaning: str | type) -> Any:
    """A field: its default (a class stands for an object of it) and its meaning (a class: its docstring)."""
    told = {"meaning": meaning}
    if isinstance(value, type):
        return field(default_factory=value, metadata=told)
    if isinstance(value, tuple | list):  # a list can be changed, as OmegaConf has it
        return field(default_factory=lambda: list(value), metadata=told)
    return field(default=value, metadata=told)


class Leaf(NamedTuple):
    """A setting of a group, and what is said of it."""

    name: str  # in full
    value: Any
    meaning: str | type  # a class: in its docstring
    of_group: str | type  # what is said of the group that it is in


def leaves(group: Any, name: str = "", of_group: str | type = "") -> Iterator[Leaf]:
    """All settings of a group, in their order; one without a meaning has that of its group."""
    for each in fields(group):
        value, path = getattr(group, each.name), f"{name}{each.name}"
        meaning = each.metadata.get("meaning", of_group)
        if is_dataclass(value) and fields(value):
            yield from leaves(value, f"{path}.", meaning)
        else:
            yield Leaf(path, value, meaning, of_group)


def settings_class(kind: type, null: tuple[str, ...] = ()) -> Any:
    """The fields and defaults of a frozen dataclass of the library, as one to change; `null` may be null."""
    kinds = {name: t | None if name in null else t for name, t in get_type_hints(kind).items()}
    given = ((f, f.default if f.default_factory is MISSING else f.default_factory()) for f in fields(kind))
    settings = [(f.name, kinds[f.name], setting(value, kind)) for f, value in given]
    return importable(make_dataclass(f"{kind.__name__}Settings", settings))


def importable(made: type) -> Any:
    """A class that was made here, found by its name in this module, as a launcher sends it to processes."""
    made.__module__ = __name__
    globals()[made.__name__] = made
    return made


if TYPE_CHECKING:
    from footopt.design import Solver as SolverConfig
    from footopt.foot import Waypoints as SpaceConfig
    from footopt.sand import StressMap as CoefficientsConfig
    from footopt.walk import Walker as WalkerConfig
else:
    SolverConfig, SpaceConfig, CoefficientsConfig, WalkerConfig = map(
        settings_class, (Solver, Waypoints, StressMap, Walker)
    )
SpreadConfig: Any = settings_class(Spread, null=("zeta", "period", "angles"))  # of the sand, or the strides


@dataclass
class StudySettings:
    """Settings of a study, a class of its own in its module, with the other settings that it reads."""

    name: str = setting("optimize", "The question; with study=own, of a plugin.")
    #: Groups and single settings that the study reads besides its own.
    reads: ClassVar[tuple[str, ...]] = ()
    #: Choices of other groups that come with it, unless others are made.
    brings: ClassVar[tuple[tuple[str, str], ...]] = ()


#: Studies by name: the settings of each, and the function that is called with a `Study`. Each module adds
#: its own, and so does a plugin.
STUDIES: dict[str, tuple[type[StudySettings], Callable[[Any], Any]]] = {}


@dataclass
class OwnSettings(StudySettings):
    """Settings of a study that a plugin brings."""

    name: str = ""
    own: Any = setting(None, "Settings of a plugin's study, by name.")


@dataclass
class SandConfig:
    """The sand: zeta scales the generic stress map, or nine coefficients, or a table of stresses."""

    name: str = setting(Sand.name, "For tables and legends.")
    zeta: float = setting(Sand.zeta, "Scale of the stress map on the Earth; 1 is the generic material.")
    spread: float = setting(Spread.zeta, "What is not known of zeta: a standard deviation of its logarithm.")
    coefficients: CoefficientsConfig = setting(
        CoefficientsConfig, "In N/cm^3; Bm11, Cm11: the (-1, 1) terms."
    )
    table: str | None = setting(None, "File of measured stresses, to which nine coefficients are fitted.")


@dataclass
class NamesConfig:
    """A gait file's own names of columns, where they are not usual."""

    time: str | None = None
    thigh: str | None = None
    hip: str | None = None
    knee: str | None = None
    foot: str | None = None
    ankle: str | None = None
    pelvis: str | None = None


@dataclass
class GaitConfig:
    """The gait: the built-in human walk, or a file, whose own period null is."""

    name: str = setting("human", "human, or file.")
    path: str | None = setting(None, "File of a leg's angles: CSV, MOT or STO.")
    period: float | None = setting(Gait.period, "Of a stride, s; null: the file's own.")
    harmonics: int = setting(default(Gait.human, "harmonics"), "Of the Fourier series of each joint.")
    pitch: str = setting(Gait.pitch, "How the foot turns: with the shank, or as measured.")
    start: float = setting(Gait.start, "When the walker begins to walk, s; .inf: never.")
    side: str | None = setting(None, "right or left; null: right, or left if it is the only one.")
    window: list[float] | None = setting(None, "Begin and end of a stride in the file, s; null: all strides.")
    names: NamesConfig = setting(NamesConfig, "The file's name of this column; null: a usual one.")


@dataclass
class FootConfig(SpaceConfig):  # type: ignore[misc]  # made of Waypoints' fields as it runs
    """The foot: a space of `Waypoints` (and one sole k in it, to simulate), a shape, or a drawing."""

    shape: str = setting("waypoints", "Which sole: waypoints, one of the five shapes, or outline, a drawing.")
    k: list[int] | None = setting(None, "Heights of one sole, to walk with it.")
    length: float = setting(default(Foot.shape, "length"), "Contact length of a shape, m.")
    apex: str = setting(
        default(shapes.reversed_triangle, "apex"), "Where the triangle's apex is: middle, toe."
    )
    upright: str = setting(default(shapes.reversed_l, "upright"), "Where the L's upright is: toe, heel.")
    path: str | None = setting(None, "File of a sole: DXF, SVG or CSV.")
    units: str | None = setting(None, "Of the file: mm, cm, m, in, pt or px; null: as the file says.")
    scale: float = setting(default(read_foot, "scale"), "Multiplies all lengths of the file.")
    layer: str | None = setting(None, "Of the file; null: SOLE if there is one, else all.")
    toe: str = setting(default(read_foot, "toe"), "Where the toe is in the file: right, or left.")
    origin: str = setting(default(read_foot, "origin"), "Of the foot frame: file, or centre of its box.")
    block: list[float] | None = setting(None, "Length and height of a mounting block on the body, m.")


@dataclass
class EffectsConfig:
    """Effects beyond the plain law, whichever there are."""

    own: Any = setting(None, "Effects of a plugin, by name, with their parameters.")
    auto: bool = setting(False, "Whether to simulate the effects that matter.")
    tolerance: float | None = setting(None, "Relative change that matters to auto; null: the accuracy's.")


#: With a setting for each effect: its parameters, or null where it is not simulated.
EACH = [(name, settings_class(kind) | None, setting(None, kind)) for name, kind in EFFECTS.items()]
AllEffects = importable(make_dataclass("AllEffects", EACH, bases=(EffectsConfig,)))


@dataclass
class SceneConfig:
    """How long the walk lasts; null is two strides after the start."""

    name: str = setting("walk", "For tables.")
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
    joints: Any = setting(None, "That track it: {JOINT: left_hip, OTHER: -right_knee}; null: by these names")
    duration: float | None = setting(None, Robot)
    after: float | None = setting(None, Robot)
    key: str | None = setting(None, Robot)
    lowest: float = setting(default(Robot, "lowest"), Robot)
    tilt: float = setting(default(Robot, "tilt"), Robot)
    density: float | None = setting(None, Robot)


@dataclass
class AccuracyConfig:
    """How finely it is simulated: a preset, the cheapest within a tolerance, or parts of it by hand."""

    name: str = setting("custom", Accuracy)
    tolerance: float | None = setting(None, "Takes the cheapest accuracy within this relative error.")
    stepper: str | None = setting(None, Accuracy)
    dt: float | None = setting(None, Accuracy)
    plates: int | None = setting(None, Accuracy)
    creep: float | None = setting(None, Accuracy)
    rule: str | None = setting(None, Accuracy)
    control: float | None = setting(None, Accuracy)


@dataclass
class ObjectiveConfig:
    """The objectives, by name."""

    names: list[str] = setting(SETS["efficiency"], "One objective to optimise, or several for a front.")


@dataclass
class ChooseConfig:
    """Which design of a front is the answer where there are several objectives."""

    name: str = setting(Choice.by, "Which design of a front is the answer.")
    weights: Any = setting(None, Choice)
    limits: Any = setting(None, Choice)


@dataclass
class OwnConstraints:
    """Limits that a design must keep: see `footopt.design.FootProblem`."""

    own: Any = setting(None, "Limits of a plugin's measures, by name.")


#: With a setting for each measure: its limit, or null for none.
LIMITS = [(name, float | None, None) for name in MEASURES]
ConstraintConfig = importable(make_dataclass("ConstraintConfig", LIMITS, bases=(OwnConstraints,)))


@dataclass
class EngineConfig:
    """Where designs are evaluated: see `footopt.design.make_executor`; threads are of this process."""

    name: str = setting(default(make_executor, "name"), "Where designs are walked: local, processes, dask.")
    threads: int | None = setting(None, "Threads of this process; null: all processors.")
    workers: int | None = setting(None, "Processes, with engine=processes; null: as many as processors.")
    address: str | None = setting(None, "Of the dask scheduler, with engine=dask.")
    timeout: float = setting(
        default(make_executor, "timeout"), "For a scheduler to answer and to have a worker, s."
    )


@dataclass
class Config:
    """All settings of a run, one group each; plugins are files or modules of the user's own."""

    plugins: list[str] = setting(
        [], "Files (.py) or modules that register your effects, objectives, solvers, studies."
    )
    report: str = setting(
        "full", "What a run leaves: full; print, figures as PDF, too; light, no figures; none, numbers only."
    )
    study: Any = field(default_factory=StudySettings)  # of the study that is chosen
    sand: SandConfig = field(default_factory=SandConfig)
    gait: GaitConfig = field(default_factory=GaitConfig)
    foot: FootConfig = field(default_factory=FootConfig)
    walker: WalkerConfig = field(default_factory=WalkerConfig)
    effects: EffectsConfig = field(default_factory=AllEffects)
    scene: SceneConfig = field(default_factory=SceneConfig)
    simulator: SimulatorConfig = field(default_factory=SimulatorConfig)
    robot: RobotConfig = field(default_factory=RobotConfig)
    accuracy: AccuracyConfig = field(default_factory=AccuracyConfig)
    objective: ObjectiveConfig = field(default_factory=ObjectiveConfig)
    choose: ChooseConfig = field(default_factory=ChooseConfig)
    constraint: OwnConstraints = setting(
        ConstraintConfig,
        "Limit: the largest of what is minimised, the smallest of what is maximised; null: none.",
    )
    solver: SolverConfig = field(default_factory=SolverConfig)
    engine: EngineConfig = field(default_factory=EngineConfig)


def structured(settings: Mapping[str, Any]) -> Any:
    """Settings with their types, as OmegaConf has them: other names and kinds are refused."""
    kind, _ = STUDIES.get(settings["study"]["name"], (OwnSettings, None))
    return OmegaConf.merge(OmegaConf.structured(Config(study=kind())), settings)


#: The setting that the choice of a group sets, where it is not its name.
SETTING_OF_GROUP = {
    "foot": "foot.shape",
    "objective": "objective.names",
    "planet": "walker.g",
    "effects": "effects",
}

#: Choices of groups that the library knows by name: what each sets. Those in conf/ join them.
GROUP_OPTIONS: dict[str, dict[str, Any]] = {
    "sand": {name: {"name": name, "zeta": zeta} for name, zeta in MEDIA.items()},
    "foot": {name: {"shape": name} for name in SHAPES},
    "effects": {name: {name: {}} for name in EFFECTS},
    "accuracy": {name: {"name": name} for name in (*PRESETS, "custom")} | {"coarse": {"tolerance": 0.05}},
    "objective": {name: {"names": list(names)} for name, names in SETS.items()},
    "choose": {name: {"name": name} for name in FRONT_RULES},
    "solver": {name: {"name": name} for name in (AUTO, *SOLVERS) if name not in SEVERAL},
    "simulator": {"walker": {"name": "walker"}},
    "study": {"own": OwnSettings},
}

#: Of robots, whose walks cost hundreds of times those of the walker.
OF_ROBOTS = {"defaults": [{"override /accuracy": "coarse"}], "solver": {"walks": 1000}}

#: Choices that change another group, too: a solver for several objectives searches the paper's five.
GLOBAL_OPTIONS: dict[str, dict[str, dict[str, Any]]] = {
    "study": {},
    "simulator": {name: {"simulator": {"name": name}, **OF_ROBOTS} for name in ("biped", "robot")},
    "solver": {
        name: {"defaults": [{"override /objective": "pareto"}], "solver": {"name": name}} for name in SEVERAL
    },
}
