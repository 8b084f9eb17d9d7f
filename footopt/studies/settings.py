"""The settings as plain dataclasses: the schemas of what the YAML files compose.

`footopt.studies.build` makes the library's own objects of them; this module imports nothing, so
that `footopt --help` is quick.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Optional  # OmegaConf resolves these annotations itself


@dataclass
class SpreadConfig:
    """How far the parameters of a scene lie apart: see `footopt.Spread`; null is measured from gait.path."""

    zeta: float = 0.3
    mass: float = 0.1
    period: Optional[float] = 0.05  # noqa: UP045
    stride: float = 0.05
    angles: Optional[float] = 2.0  # noqa: UP045
    ankle_x: float = 0.005
    ankle_z: float = 0.005


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
    confirm: Optional[str] = "fine"  # noqa: UP045
    finalists: int = 20
    store: Optional[str] = None  # noqa: UP045
    feet: int = 40
    quick: bool = False
    cases: Optional[list[str]] = None  # noqa: UP045
    methods: Optional[list[str]] = None  # noqa: UP045
    seeds: int = 5
    samples: int = 48
    shape_sand: str = "regular"
    mount: str = "centre"
    peak_power: str = "stance"
    speed_loss: str = "walk"
    leading_edge: bool = False
    solvers: Optional[list[str]] = None  # noqa: UP045
    budget: int = 3000
    scenarios: str = "sands"
    draws: int = 16
    measure: str = "worst"
    tail: float = 0.25
    spread: SpreadConfig = field(default_factory=SpreadConfig)
    foot_spread: FootSpreadConfig = field(default_factory=FootSpreadConfig)
    run: Optional[str] = None  # noqa: UP045
    runs: list[str] = field(default_factory=list)
    video: Optional[str] = None  # noqa: UP045


@dataclass
class CoefficientsConfig:
    """The nine Fourier coefficients of the stress map, N/cm^3: see `footopt.StressMap`."""

    A00: float = 0.206
    A10: float = 0.169
    B11: float = 0.212
    B01: float = 0.358
    Bm11: float = 0.055
    C11: float = -0.124
    C01: float = 0.253
    Cm11: float = 0.007
    D10: float = 0.088


@dataclass
class SandConfig:
    """The sand: zeta scales the generic stress map, or nine coefficients, or a table of stresses."""

    name: str = "custom"
    zeta: float = 1.0
    coefficients: CoefficientsConfig = field(default_factory=CoefficientsConfig)
    table: Optional[str] = None  # noqa: UP045


@dataclass
class NamesConfig:
    """A gait file's own names of markers and columns, where they are not usual."""

    hip: Optional[str] = None  # noqa: UP045
    knee: Optional[str] = None  # noqa: UP045
    ankle: Optional[str] = None  # noqa: UP045
    heel: Optional[str] = None  # noqa: UP045
    toe: Optional[str] = None  # noqa: UP045
    pelvis: Optional[str] = None  # noqa: UP045
    time: Optional[str] = None  # noqa: UP045
    thigh: Optional[str] = None  # noqa: UP045
    foot: Optional[str] = None  # noqa: UP045


@dataclass
class GaitConfig:
    """The gait: the built-in human walk or a file."""

    name: str = "human"
    path: Optional[str] = None  # noqa: UP045
    period: Optional[float] = None  # noqa: UP045
    harmonics: int = 6
    pitch: str = "shank"
    start: float = 0.5
    side: Optional[str] = None  # noqa: UP045
    max_gap: float = 0.2
    names: NamesConfig = field(default_factory=NamesConfig)


@dataclass
class FootConfig:
    """The foot: a space of waypoints (and one sole k in it, to simulate), a shape, or a drawing."""

    shape: str = "waypoints"
    width: float = 0.10
    ankle: list[float] = field(default_factory=lambda: [0.0, 0.0])
    n: int = 11
    K: int = 10
    L: float = 0.13
    H: float = 0.03
    box_tolerance: float = 0.05
    k: Optional[list[int]] = None  # noqa: UP045
    length: float = 0.26
    apex: str = "middle"
    upright: str = "toe"
    closed: bool = False
    top: float = 0.0
    path: Optional[str] = None  # noqa: UP045
    units: Optional[str] = None  # noqa: UP045
    scale: float = 1.0
    layer: Optional[str] = None  # noqa: UP045
    toe: str = "right"
    origin: str = "file"
    block: Optional[list[float]] = None  # noqa: UP045


@dataclass
class LeadingEdgeConfig:
    """Only faces that lead feel sand: see `footopt.LeadingEdge`."""


@dataclass
class InertiaConfig:
    """The grains' inertia: see `footopt.Inertia`."""

    factor: float = 1.1
    rho: float = 1600.0


@dataclass
class SlopeConfig:
    """An inclined plane, uphill positive: see `footopt.Slope`."""

    angle: float = 5.0


@dataclass
class LayersConfig:
    """Strength that changes with depth: see `footopt.Layers`."""

    depths: list[float] = field(default_factory=lambda: [0.03])
    factors: list[float] = field(default_factory=lambda: [0.3])


@dataclass
class PatchesConfig:
    """Strength that changes along the way: see `footopt.Patches`."""

    begins: list[float] = field(default_factory=lambda: [0.35])
    ends: list[float] = field(default_factory=lambda: [0.95])
    factors: list[float] = field(default_factory=lambda: [0.2])
    blur: float = 0.05


@dataclass
class EffectsConfig:
    """Effects beyond the plain law; null: not simulated. own: a plugin's effects with their parameters,
    by name. auto: those that matter at the accuracy.
    """

    layers: Optional[LayersConfig] = None  # noqa: UP045
    patches: Optional[PatchesConfig] = None  # noqa: UP045
    leading_edge: Optional[LeadingEdgeConfig] = None  # noqa: UP045
    inertia: Optional[InertiaConfig] = None  # noqa: UP045
    slope: Optional[SlopeConfig] = None  # noqa: UP045
    own: Any = None
    auto: bool = False
    tolerance: Optional[float] = None  # noqa: UP045


@dataclass
class WalkerConfig:
    """The walker: see `footopt.Walker`."""

    mass: float = 60.0
    l1: float = 0.47
    l2: float = 0.45
    g: float = 9.81


@dataclass
class SceneConfig:
    """How long the walk lasts; null is two strides after the start."""

    name: str = "walk"
    t_f: Optional[float] = None  # noqa: UP045


@dataclass
class AccuracyConfig:
    """How finely it is simulated: the cheapest setting within a tolerance, or parts of it by hand."""

    name: str = "custom"
    tolerance: Optional[float] = None  # noqa: UP045
    stepper: Optional[str] = None  # noqa: UP045
    dt: Optional[float] = None  # noqa: UP045
    plates: Optional[int] = None  # noqa: UP045
    creep: Optional[float] = None  # noqa: UP045
    rule: Optional[str] = None  # noqa: UP045
    control: Optional[float] = None  # noqa: UP045


@dataclass
class ObjectiveConfig:
    """What is optimised: names from the objectives."""

    names: list[str] = field(default_factory=lambda: ["efficiency"])


@dataclass
class SolverConfig:
    """Who searches, and for how long."""

    name: str = "memetic"
    pop_size: int = 100
    n_gen: int = 100
    seed: int = 1


@dataclass
class EngineConfig:
    """Where designs are evaluated: see `footopt.design.make_executor`; threads are of this process."""

    name: str = "local"
    threads: Optional[int] = None  # noqa: UP045
    workers: Optional[int] = None  # noqa: UP045
    address: Optional[str] = None  # noqa: UP045
    timeout: float = 10.0


@dataclass
class Config:
    """All settings of a run, one group each; plugins are files or modules of the user's own."""

    plugins: list[str] = field(default_factory=list)
    study: StudyConfig = field(default_factory=StudyConfig)
    sand: SandConfig = field(default_factory=SandConfig)
    gait: GaitConfig = field(default_factory=GaitConfig)
    foot: FootConfig = field(default_factory=FootConfig)
    walker: WalkerConfig = field(default_factory=WalkerConfig)
    effects: EffectsConfig = field(default_factory=EffectsConfig)
    scene: SceneConfig = field(default_factory=SceneConfig)
    accuracy: AccuracyConfig = field(default_factory=AccuracyConfig)
    objective: ObjectiveConfig = field(default_factory=ObjectiveConfig)
    solver: SolverConfig = field(default_factory=SolverConfig)
    engine: EngineConfig = field(default_factory=EngineConfig)
