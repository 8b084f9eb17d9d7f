"""The settings of a run: their names, their types, and where each default comes from.

What the library has a default for takes it from there, so that a default is written once; the other defaults
are written here. The YAML files of conf/ only name what differs. `footopt.studies.build` makes the library's
objects of the settings, `footopt.cli` composes them.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import MISSING, Field, dataclass, field, fields, make_dataclass
from typing import TYPE_CHECKING, Any, get_type_hints

from footopt.design import WAYS, Choice, RobustProblem, Solver, Stop, make_executor
from footopt.design.problem import SETS
from footopt.effects import EFFECTS
from footopt.files import soles
from footopt.foot import Foot, Waypoints, shapes
from footopt.gait import Gait
from footopt.sand import MEDIA, Sand, StressMap
from footopt.walk import MEASURES, PRESETS, Spread, Walker

#: How much a run leaves: result.json, contour.csv and what it is resumed from; all but figures; everything.
REPORTS = ("none", "light", "full")

#: Studies that search: they walk where engine says, keep what they evaluate, and go on where they stopped.
SEARCHES = ("optimize", "robust")


def default(function: Callable[..., Any], name: str) -> Any:
    """The default of a function's parameter."""
    return inspect.signature(function).parameters[name].default


def parameters(kind: type, null: tuple[str, ...] = ()) -> Any:
    """The fields and defaults of one of the library's dataclasses, which is frozen, as a dataclass to change.

    Parameters
    ----------
    kind : type
        A dataclass whose fields all have defaults.
    null : tuple of str
        Fields that may be null, too.
    """
    kinds = {name: t | None if name in null else t for name, t in get_type_hints(kind).items()}
    settings = [(f.name, kinds[f.name], _changeable(f)) for f in fields(kind)]
    return importable(make_dataclass(f"{kind.__name__}Settings", settings))


def importable(made: type) -> Any:
    """A class that was made here, found by its name in this module.

    A launcher sends settings to processes and gets them back. A class that cannot be imported is sent as a
    whole, and what comes back would overwrite the fields of the one that is here.
    """
    made.__module__ = __name__
    globals()[made.__name__] = made
    return made


def _changeable(given: Field[Any]) -> Any:
    """A field with the default of another; a tuple is a list, as OmegaConf has it."""
    value = given.default if given.default_factory is MISSING else given.default_factory()
    return (
        field(default_factory=lambda: list(value))
        if isinstance(value, tuple | list)
        else field(default=value)
    )


if TYPE_CHECKING:
    from footopt.design import Solver as SolverConfig
    from footopt.design import Stop as StopConfig
    from footopt.foot import Waypoints as SpaceConfig
    from footopt.sand import StressMap as CoefficientsConfig
    from footopt.walk import Spread as SpreadConfig
    from footopt.walk import Walker as WalkerConfig
else:
    SolverConfig, StopConfig, SpaceConfig, CoefficientsConfig, WalkerConfig = map(
        parameters, (Solver, Stop, Waypoints, StressMap, Walker)
    )
    SpreadConfig = parameters(
        Spread, null=("period", "angles")
    )  # null: measured from the strides of gait.path


@dataclass
class FootSpreadConfig:
    """How far feet lie apart that were to be the same: see `footopt.studies.sensitivity`."""

    waypoint: float = 0.001
    width: float = 0.05
    creep: float = 0.7


@dataclass
class StudyConfig:
    """Which question is asked, and what only one study or the other needs to know."""

    name: str = "optimize"
    confirm: str | None = "fine"
    finalists: int = 20
    store: str | None = None
    reuse: bool = False
    feet: int = 40
    quick: bool = False
    cases: list[str] | None = None
    methods: list[str] | None = None
    seeds: int = 5
    samples: int = 48
    shape_sand: str = "regular"
    mount: str = "centre"
    peak_power: str = "stance"
    speed_loss: str = "walk"
    leading_edge: bool = False
    shadowing: bool = False
    solvers: list[str] | None = None
    budget: int = 3000
    scenarios: str = "sands"
    draws: int = 16
    measure: str = default(RobustProblem, "measure")
    tail: float = default(RobustProblem, "tail")
    spread: SpreadConfig = field(default_factory=SpreadConfig)
    foot_spread: FootSpreadConfig = field(default_factory=FootSpreadConfig)
    run: str | None = None
    runs: list[str] = field(default_factory=list)
    video: str | None = None
    tests: str | None = None


@dataclass
class SandConfig:
    """The sand: zeta scales the generic stress map, or nine coefficients, or a table of stresses."""

    name: str = Sand.name
    zeta: float = Sand.zeta
    coefficients: CoefficientsConfig = field(default_factory=CoefficientsConfig)
    table: str | None = None


@dataclass
class NamesConfig:
    """A gait file's own names of markers and columns, where they are not usual."""

    hip: str | None = None
    knee: str | None = None
    ankle: str | None = None
    heel: str | None = None
    toe: str | None = None
    pelvis: str | None = None
    time: str | None = None
    thigh: str | None = None
    foot: str | None = None


@dataclass
class GaitConfig:
    """The gait: the built-in human walk, or a file, whose own period null is."""

    name: str = "human"
    path: str | None = None
    period: float | None = Gait.period
    harmonics: int = default(Gait.human, "harmonics")
    pitch: str = Gait.pitch
    start: float = Gait.start
    side: str | None = None
    max_gap: float = default(Gait.from_file, "max_gap")
    units: str | None = None
    names: NamesConfig = field(default_factory=NamesConfig)


@dataclass
class FootConfig(SpaceConfig):  # type: ignore[misc]  # made of Waypoints' fields as it runs
    """The foot: a space of `Waypoints` (and one sole k in it, to simulate), a shape, or a drawing."""

    shape: str = "waypoints"
    k: list[int] | None = None
    length: float = default(Foot.shape, "length")
    apex: str = default(shapes.reversed_triangle, "apex")
    upright: str = default(shapes.reversed_l, "upright")
    path: str | None = None
    units: str | None = None
    scale: float = default(soles.read, "scale")
    layer: str | None = None
    toe: str = default(soles.read, "toe")
    origin: str = default(soles.read, "origin")
    block: list[float] | None = None


@dataclass
class EffectsConfig:
    """Effects beyond the plain law, whichever there are.

    Attributes
    ----------
    own : dict
        Effects of a plugin, with their parameters, by name.
    auto : bool
        Whether to simulate those that matter at the accuracy.
    tolerance : float
        Relative change that matters to `auto`; null: the accuracy's own tolerance.
    """

    own: Any = None
    auto: bool = False
    tolerance: float | None = None


#: With a setting for each effect: its parameters, or null where it is not simulated.
AllEffects = importable(
    make_dataclass(
        "AllEffects",
        [(name, parameters(kind) | None, None) for name, kind in EFFECTS.items()],
        bases=(EffectsConfig,),
    )
)


@dataclass
class SceneConfig:
    """How long the walk lasts; null is two strides after the start."""

    name: str = "walk"
    t_f: float | None = None


@dataclass
class AccuracyConfig:
    """How finely it is simulated: a preset, the cheapest within a tolerance, or parts of it by hand."""

    name: str = "custom"
    tolerance: float | None = None
    stepper: str | None = None
    dt: float | None = None
    plates: int | None = None
    creep: float | None = None
    rule: str | None = None
    control: float | None = None


@dataclass
class ObjectiveConfig:
    """What is optimised: names from the objectives."""

    names: list[str] = field(default_factory=lambda: list(SETS["efficiency"]))


@dataclass
class ChooseConfig:
    """Which design of a front is the answer where there are several objectives: see `footopt.design.Choice`.

    Attributes
    ----------
    weights : dict
        Of objectives by name, for choose=weights.
    limits : dict
        Of objectives by name, for choose=limits.
    """

    name: str = Choice.by
    weights: Any = None
    limits: Any = None


@dataclass
class OwnConstraints:
    """Limits that a design must keep: see `footopt.design.FootProblem`.

    Attributes
    ----------
    own : dict
        Limits of a plugin's measures, by name.
    """

    own: Any = None


#: With a setting for each measure: its limit, or null for none.
ConstraintConfig = importable(
    make_dataclass(
        "ConstraintConfig", [(name, float | None, None) for name in MEASURES], bases=(OwnConstraints,)
    )
)


@dataclass
class EngineConfig:
    """Where designs are evaluated: see `footopt.design.make_executor`; threads are of this process."""

    name: str = default(make_executor, "name")
    threads: int | None = None
    workers: int | None = None
    address: str | None = None
    timeout: float = default(make_executor, "timeout")


@dataclass
class Config:
    """All settings of a run, one group each; plugins are files or modules of the user's own."""

    plugins: list[str] = field(default_factory=list)
    report: str = "full"
    study: StudyConfig = field(default_factory=StudyConfig)
    sand: SandConfig = field(default_factory=SandConfig)
    gait: GaitConfig = field(default_factory=GaitConfig)
    foot: FootConfig = field(default_factory=FootConfig)
    walker: WalkerConfig = field(default_factory=WalkerConfig)
    effects: EffectsConfig = field(default_factory=AllEffects)
    scene: SceneConfig = field(default_factory=SceneConfig)
    accuracy: AccuracyConfig = field(default_factory=AccuracyConfig)
    objective: ObjectiveConfig = field(default_factory=ObjectiveConfig)
    choose: ChooseConfig = field(default_factory=ChooseConfig)
    constraint: OwnConstraints = field(default_factory=ConstraintConfig)
    solver: SolverConfig = field(default_factory=SolverConfig)
    stop: StopConfig = field(default_factory=StopConfig)
    engine: EngineConfig = field(default_factory=EngineConfig)


#: Choices of groups that the library knows by name: what each sets. Those in conf/ join them.
CHOICES: dict[str, dict[str, dict[str, Any]]] = {
    "sand": {name: {"name": name, "zeta": zeta} for name, zeta in MEDIA.items()},
    "effects": {name: {name: {}} for name in EFFECTS},
    "accuracy": {name: {"name": name} for name in (*PRESETS, "custom")},
    "objective": {name: {"names": list(names)} for name, names in SETS.items()},
    "choose": {name: {"name": name} for name in WAYS},
}
