"""The studies, a question each: their own settings, and which others each reads."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from importlib import import_module
from typing import Any, get_type_hints

from footopt.design import RobustProblem
from footopt.foot import Foot, Waypoints
from footopt.studies.settings import (
    GLOBAL_OPTIONS,
    GROUP_OPTIONS,
    STUDIES,
    SpreadConfig,
    StudySettings,
    default,
    setting,
)
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

FEET = "How many random soles are walked."
VIDEO = "Name of a film of the walk in the run's folder, .gif or .mp4 (needs ffmpeg); null: none."


@dataclass
class SearchSettings(StudySettings):
    """Settings of studies that search: they keep what they evaluate, and go on where they stopped."""

    confirm: str | None = setting(
        FINER, "Preset at which finalists are walked again: finer, the next; null: none, and no other law."
    )
    finalists: int = setting(20, "How many of the best are walked again, and by other laws; a front whole.")
    store: str | None = setting(None, "File of designs that runs may share; null: one in the folder.")
    reuse: bool = setting(False, "Whether to read what other code has walked from the store.")
    reads = (*SCENE, *ROBOT, *SPACE, "foot.shape", "foot.k", "accuracy", "objective", "solver", "engine")


@dataclass
class Optimize(SearchSettings):
    """Search the design space and leave the best foot in every form."""

    name: str = "optimize"
    certify: bool | None = setting(
        None, "Whether all soles near the best are walked; null: if they are fewer than the search walked."
    )
    details: bool = setting(False, "Whether the closing lines tell everything about the answer.")
    start: list[int] | None = setting(
        None, "Heights of the sole that a search begins with, or of several in a row."
    )
    video: str | None = setting(None, VIDEO)
    reads = (*SearchSettings.reads, "choose", "foot.block")


@dataclass
class Simulate(StudySettings):
    """Walk with one foot: foot.k, a shape, a drawing, that of a run, or else the flat sole."""

    name: str = "simulate"
    run: str | None = setting(None, "Folder of the run whose foot is meant, in whose world it walks.")
    video: str | None = setting(None, VIDEO)
    reads = (*SCENE, *ROBOT, "foot", "accuracy", "objective.names")


@dataclass
class Ladder(StudySettings):
    """The cost of accuracy in a scene: steppers, time steps, plates and presets."""

    name: str = "accuracy"
    feet: int = setting(40, FEET)
    reads = (*SCENE, *SPACE, "solver.seed")


@dataclass
class Stability(StudySettings):
    """Which stepper stays stable in which hard case; every case starts from the settings."""

    name: str = "stability"
    cases: list[str] | None = setting(None, "Names of the cases; null: all.")
    methods: list[str] | None = setting(None, "Names of the steppers that are tried; null: all.")
    reads = (*SCENE, *SPACE, *SHAPE, *OUTLINE, "foot.shape", "foot.k", "accuracy")


@dataclass
class Audit(StudySettings):
    """Which effects a scene calls for: each is turned on alone on random soles of the design space."""

    name: str = "effects"
    feet: int = setting(40, FEET)
    reads = (*SCENE, *SPACE, "accuracy", "solver.seed")


@dataclass
class Paper(StudySettings):
    """The paper's study from nothing: its figures, and its claims judged one by one."""

    name: str = "paper"
    cases: list[str] | None = setting(
        None, "Names of what the paper leaves open, such as foot.apex; null: all; []: none."
    )
    shape_sand: str = setting("regular", "Sand on which the paper's five shapes walk.")
    mount: str = setting("centre", "Where the shank meets a shape: its centre, or its top.")
    peak_power: str = setting(
        "stance", "When p_max is taken: stance, at any instant of it; single, while one foot stands."
    )
    speed_loss: str = setting(
        "walk", "When dV_x is taken: walk, all of it; window, narrow: 1/4, 1/8 stride about strikes."
    )
    confirm: str | None = setting("fine", "Accuracy of the walks that claims are measured on.")
    reads = (*WORLD, *SPACE, *SHAPE, "accuracy", "solver")


@dataclass
class Robust(SearchSettings):
    """One foot for three sands, several laws, or drawn scenes, against the specialist of each."""

    name: str = "robust"
    scenarios: str = setting("sands", "What one foot is for: sands, laws, or drawn about the scene.")
    draws: int = setting(16, "How many scenarios are drawn.")
    measure: str = setting(
        default(RobustProblem, "measure"),
        "What counts of the loss over the scenarios: worst, mean, or tail (of the worst share).",
    )
    tail: float = setting(default(RobustProblem, "tail"), "The share of study.measure=tail.")
    spread: Any = field(default_factory=lambda: SpreadConfig(zeta=None))


@dataclass
class Transfer(SearchSettings):
    """Feet designed on the walker and on a robot, each walked on both: which model is to be trusted?"""

    name: str = "transfer"
    sands: list[Any] = setting(["soft", "regular", "hard"], "The sands, by name or zeta.")
    walks: int = setting(10_000, "Designs that a search on the walker evaluates; solver.walks: on the robot.")
    soles: int = setting(200, "Random soles that both simulators rank.")
    brings = (("simulator", "biped"),)
    reads = (*WORLD, *ROBOT, *SPACE, "foot.shape", "foot.k", "accuracy", "objective", "solver", "engine")


@dataclass
class Export(StudySettings):
    """The foot of a run as files to make it from; foot.k chooses another of its soles."""

    name: str = "export"
    run: str | None = setting(None, "Folder of the run whose foot is meant.")
    reads = ("foot.k", "foot.block")


@dataclass
class Compare(StudySettings):
    """Earlier runs of optimize, simulate or robust, side by side."""

    name: str = "compare"
    runs: list[str] = setting([], "Folders of the runs that are compared; * and ** as in a shell.")


@dataclass
class Doctor(StudySettings):
    """Is the installation sound? Versions, processor, cache folder, and the published walks again."""

    name: str = "doctor"


@dataclass
class Validate(StudySettings):
    """Experiments on sand by other people, repeated: error, validation uncertainty, verdict."""

    name: str = "validate"
    cases: list[str] | None = setting(None, "Names of the experiments; null: all.")


@dataclass
class Calibrate(StudySettings):
    """zeta from tests with plates or a penetrometer, with its uncertainty, as a sand for other runs."""

    name: str = "calibrate"
    tests: str | None = setting(
        None, "CSV of tests: depth_mm, force_N, area_cm2; if known, angle_deg, direction_deg, repeat."
    )
    reads = ("sand.name", "sand.coefficients", "sand.table")


def searches(study: str) -> bool:
    """Whether a study keeps what it evaluates and can go on where it stopped."""
    return study in STUDIES and issubclass(STUDIES[study][0], SearchSettings)


def _add(kind: type[StudySettings]) -> str:
    """Add one of footopt's own studies: the module of its name is imported when it is run."""
    name = kind.name
    STUDIES[name] = kind, lambda study: import_module(f"footopt.studies.{name}").run(study)
    if kind.brings:
        brought = [{f"override /{group}": choice} for group, choice in kind.brings]
        GLOBAL_OPTIONS["study"][name] = {"defaults": brought, "study": kind()}
    else:
        GROUP_OPTIONS["study"][name] = kind
    return name


#: Names of footopt's own studies; a plugin adds its own to `STUDIES`.
BUILT_IN = tuple(map(_add, (Optimize, Simulate, Ladder, Stability, Audit, Paper, Robust, Transfer, Export,
                            Compare, Doctor, Validate, Calibrate)))  # fmt: skip
