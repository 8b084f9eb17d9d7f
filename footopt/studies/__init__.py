"""The studies: their own settings, which other settings each reads, and the choices of all groups."""

import textwrap
from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from importlib import import_module
from typing import Any, ClassVar, get_type_hints

from footopt.design import AUTO, EXHAUSTIVE, FRONT_RULES, SINGLE, SOLVERS, RobustProblem, Spread
from footopt.design.problem import SETS
from footopt.effects import EFFECTS
from footopt.errors import SettingError
from footopt.foot import SHAPES, Foot, Waypoints
from footopt.sand import MEDIA
from footopt.studies.settings import (
    STUDIES,
    Config,
    SpreadConfig,
    StudySettings,
    default,
    known,
    leaves,
    setting,
    settings_class,
    shown,
)
from footopt.walk import MEASURES, PRESETS
from footopt.walk.accuracy import FINER

__all__ = ["STUDIES", "StudySettings"]

#: Settings, and groups of them, that studies read.
WORLD = ("gait", "walker", "effects", "scene")
SCENE = (*WORLD, "sand")
ROBOT = ("simulator", "robot")
SPACE = tuple(f"foot.{field.name}" for field in fields(Waypoints))
WORN = tuple(name for name in SPACE if name.partition(".")[2] in get_type_hints(Foot))  # of any foot
SHAPE = ("foot.length", "foot.apex", "foot.upright")
OUTLINE = tuple(f"foot.{name}" for name in ("path", "units", "scale", "layer", "toe", "origin"))

FEET = "How many random soles are evaluated."
VIDEO = "Name of a film of the walk in the run's folder, .gif or .mp4 (needs ffmpeg); null: none."


@dataclass
class SearchSettings(StudySettings):
    """Settings of studies that search: they store what they evaluate, and resume where they stopped."""

    confirm: str | None = setting(
        FINER, "Preset that evaluates finalists again; finer: the next one; null: none, and no other laws."
    )
    finalists: int = setting(20, "How many of the best are evaluated again; of a front, all.")
    store: str | None = setting(None, "File of evaluated designs, which runs may share; null: in the folder.")
    reuse: bool = setting(False, "Whether to use stored designs that other code or machines evaluated.")
    reads = (*SCENE, *ROBOT, *SPACE, "foot.shape", "foot.k", "accuracy", "objective", "solver", "engine")


@dataclass
class Optimize(SearchSettings):
    """Search the design space and leave the best foot in every form."""

    certify: bool | None = setting(
        None, "Whether to evaluate all neighbours of the best sole; null: if the search evaluated more soles."
    )
    details: bool = setting(False, "Whether to print the errors of all numbers and the validity, too.")
    laws: float | None = setting(
        0.05,
        "To find the foot to print, which loses least under the worst law: the share of the search's "
        "evaluations that is spent under each law; null: no such foot.",
    )
    start: list[int] | None = setting(None, "Heights of a sole to begin with, or of several in one list.")
    video: str | None = setting(None, VIDEO)
    reads = (*SearchSettings.reads, "choose", "foot.block")


@dataclass
class Simulate(StudySettings):
    """Walk with one foot: foot.k, a shape, a drawing, that of a run, or else the flat sole."""

    run: str | None = setting(None, "Folder of an earlier run, whose foot and scene are taken.")
    video: str | None = setting(None, VIDEO)
    reads = (*SCENE, *ROBOT, "foot", "accuracy", "objective.names")


@dataclass
class CostOfAccuracy(StudySettings):
    """The cost of accuracy in a scene: steppers, time steps, plates and presets."""

    feet: int = setting(40, FEET)
    reads = (*SCENE, *SPACE, "solver.seed")


@dataclass
class Stability(StudySettings):
    """Which stepper stays stable in which hard case; every case starts from the settings."""

    cases: list[str] | None = setting(None, "Names of the cases; null: all.")
    methods: list[str] | None = setting(None, "Names of the methods: steppers, sdirk2_control; null: all.")
    reads = (*SCENE, *SPACE, *SHAPE, *OUTLINE, "foot.shape", "foot.k", "accuracy")


@dataclass
class EffectAudit(StudySettings):
    """Which effects a scene calls for: each is turned on alone on random soles of the design space."""

    feet: int = setting(40, FEET)
    reads = (*SCENE, *SPACE, "accuracy", "solver.seed")


@dataclass
class Paper(StudySettings):
    """The paper's study from nothing: its figures, and its claims judged one by one."""

    cases: list[str] | None = setting(
        None, "Choices that the paper leaves open, such as foot.apex; null: all; []: none."
    )
    shape_sand: str = setting("regular", "Sand on which the paper's five shapes walk.")
    peak_power: str = setting(
        "stance", "When p_max counts: stance, at any time; single, only while one foot stands."
    )
    speed_loss: str = setting(
        "walk", "When dV_x counts: walk, always; window, narrow: up to 1/4, 1/8 stride from a heel strike."
    )
    confirm: str | None = setting("fine", "Accuracy of the walks on which claims are measured.")
    reads = (*WORLD, *SPACE, *SHAPE, "accuracy", "solver")


@dataclass
class Robust(SearchSettings):
    """One foot for three sands, several laws, or drawn scenes, against the specialist of each."""

    scenarios: str = setting("sands", "What one foot has to suit: sands, laws, or drawn scenes.")
    draws: int = setting(16, "How many scenarios are drawn.")
    measure: str = setting(
        default(RobustProblem, "measure"),
        "Which loss over the scenarios is minimised: worst, mean, or tail (the mean of the worst share).",
    )
    tail: float = setting(default(RobustProblem, "tail"), "Share of the scenarios in study.measure=tail.")
    spread: Any = field(default_factory=SpreadConfig)


@dataclass
class Transfer(SearchSettings):
    """Feet designed on the walker and on a robot, each walked on both: which model is to be trusted?"""

    sands: list[Any] = setting(["soft", "regular", "hard"], "The sands, by name or zeta.")
    walks: int = setting(10_000, "Designs that a search on the walker evaluates; solver.walks: on the robot.")
    soles: int = setting(200, "Random soles that both simulators rank.")
    brings: ClassVar = {"simulator": "biped"}
    reads = (*WORLD, *ROBOT, *SPACE, "foot.shape", "foot.k", "accuracy", "objective", "solver", "engine")


@dataclass
class Export(StudySettings):
    """The foot of a run as files to make it from; foot.k chooses another of its soles."""

    run: str | None = setting(None, "Folder of an earlier run, whose foot is exported.")
    foot: str = setting("best", "Which foot of the run: best, or to_print.")
    reads = ("foot.k", "foot.block")


@dataclass
class Compare(StudySettings):
    """Earlier runs of optimize, simulate or robust, side by side."""

    runs: list[str] = setting([], "Folders of the runs that are compared; * and ** as in a shell.")


@dataclass
class Validate(StudySettings):
    """Experiments on sand by other people, repeated: error, validation uncertainty, verdict."""

    cases: list[str] | None = setting(None, "Names of the experiments; null: all.")


@dataclass
class Calibrate(StudySettings):
    """zeta from tests with plates or a penetrometer, with its uncertainty, as a sand for other runs."""

    tests: str | None = setting(
        None, "CSV file of tests: depth_mm, force_N, area_cm2; optional: angle_deg, direction_deg, repeat."
    )
    reads = ("sand.name", "sand.coefficients", "sand.table")


def searches(study: str) -> bool:
    """Whether a study searches: it stores what it evaluates and can resume where it stopped."""
    return study in STUDIES and issubclass(STUDIES[study][0], SearchSettings)


#: The setting that the choice of a group sets, where it is not its name.
SETTING_OF_GROUP = {
    "foot": "foot.shape",
    "objective": "objective.names",
    "planet": "walker.g",
    "effects": "effects",
}


def _of_module(name: str) -> Callable[[Any], Any]:
    """The function `run` of a study's module, which is imported when it is called."""
    return lambda study: import_module(f"footopt.studies.{name}").run(study)


_BUILT_IN = {
    "optimize": Optimize, "simulate": Simulate, "accuracy": CostOfAccuracy, "stability": Stability,
    "effects": EffectAudit, "paper": Paper, "robust": Robust, "transfer": Transfer, "export": Export,
    "compare": Compare, "validate": Validate, "calibrate": Calibrate,
}  # fmt: skip
STUDIES.update({name: (kind, _of_module(name)) for name, kind in _BUILT_IN.items()})


def choices() -> dict[str, dict[str, Any]]:
    """Choices of groups that the library and plugins know, and what each sets; those in conf/ join them."""
    several = {name: {"objective": "pareto"} for name in SOLVERS if name not in (*SINGLE, EXHAUSTIVE)}
    robot, price = {"accuracy": "coarse"}, {"solver": {"walks": 1000}}  # hundreds of times the walker's
    return {
        "sand": {name: {"name": name, "zeta": zeta} for name, zeta in MEDIA.items()},
        "foot": {name: {"shape": name} for name in SHAPES},
        "effects": {name: {name: asdict(settings_class(kind)())} for name, kind in EFFECTS.items()},
        "accuracy": {name: {"name": name} for name in (*PRESETS, "custom")} | {"coarse": {"tolerance": 0.05}},
        "objective": {name: {"names": [name]} for name in MEASURES}
        | {name: {"names": list(names)} for name, names in SETS.items()},
        "choose": {name: {"name": name} for name in FRONT_RULES},
        "solver": {n: bringing("solver", {"name": n}, several.get(n, {})) for n in (AUTO, *SOLVERS)},
        "simulator": {n: bringing("simulator", {"name": n}, robot) | price for n in ("biped", "robot")}
        | {"walker": {"name": "walker"}},
        "study": {n: bringing("study", asdict(kind(n)), kind.brings) for n, (kind, _) in STUDIES.items()},
    }


def bringing(group: str, choice: Any, others: Mapping[str, str]) -> Any:
    """A choice of a group that also selects choices of other groups, unless the user selects other ones."""
    defaults = [{f"override /{name}": one} for name, one in others.items()]
    return {"defaults": defaults, group: choice} if others else choice


#: Settings that every study reads. (`checked` in build.py refuses a constraint where it has no effect.)
ALWAYS = ("study.name", "plugins", "report", "engine.threads", "constraint")


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
    (("foot.shape", *SPACE, *SHAPE, *OUTLINE), "study=simulate without run", lambda c: not _of_run(c)),
    (tuple({*SPACE} - {*WORN}), *_of("waypoints")),
    (("foot.k",), "foot=waypoints", lambda c: c.foot.shape == "waypoints" or _of_run(c)),
    (("foot.length",), *_of(*SHAPES)),
    (("foot.apex",), *_of("reversed_triangle")),
    (("foot.upright",), *_of("reversed_l")),
    (OUTLINE, *_of("outline")),
    (("gait.path",), "gait=file", lambda c: c.gait.name != "human"),
    (("gait.names", "gait.side", "gait.window"), "gait=file gait.path=walk.mot", lambda c: bool(c.gait.path)),
    (("accuracy.name",), "an accuracy without accuracy.tolerance",
     lambda c: c.accuracy.tolerance is None or c.accuracy.name == "custom"),
    (("robot",), "simulator=robot, biped", lambda c: c.simulator.name != "walker"),
    (("walker", "scene", "effects.auto", "study.spread.mass",
      *(f"accuracy.{name}" for name in ("stepper", "creep", "rule", "control"))), "simulator=walker",
     lambda c: c.simulator.name == "walker"),
    (("gait",), "a robot without robot.controller",
     lambda c: c.simulator.name == "walker" or not c.robot.controller),
    (("robot.joints",), "a robot without robot.controller", lambda c: not c.robot.controller),
    (("effects.tolerance",), "effects=auto", lambda c: c.effects.auto or c.study.name == "effects"),
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
    return ", ".join(study for study in STUDIES if covers(name, read_by(study)))


def not_read(name: str, value: object, study: str) -> SettingError:
    """The refusal of a setting that a study does not read, with the studies that do."""
    readers = studies_that_read(name)
    hint = f"It is read by study={readers}." if readers else ""
    return SettingError(name, value, f"left out: study={study} does not read it", hint)


def text(groups: Collection[str]) -> str:
    """The settings of some groups for a terminal."""
    names, lines = {SETTING_OF_GROUP.get(group) for group in groups}, []
    for each in known().values():
        if (each.group in groups or each.name in names) and not is_dataclass(each.default):
            kind, meaning = each.described
            lines += [f"{each.name} = {shown(each.default)}{kind and f'  ({kind})'}", f"    {meaning}"]
    return "\n".join(textwrap.fill(line, 80, subsequent_indent="    ") for line in lines)
