"""Which stepper stays stable where? Hard cases, each walked with every stepper and judged by numbers.

The judge is physics, not looks: energy is accounted for, the sand gives none beyond what smoothing
lends, who stands still stays, and a converged walk says what the right answer is. A case that no
stepper enters (the stress law, reading a gait) has the same verdict for all of them.

Every limit is a constant below with its reason. None depends on the stepper.
"""

from __future__ import annotations

import csv
import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table
from rich.text import Text

from footopt.effects import base as effects
from footopt.errors import FileError, SettingError
from footopt.files import run as files
from footopt.foot import Foot
from footopt.gait import Fourier, Gait
from footopt.report import summary, terminal
from footopt.report.figures import save
from footopt.report.figures.stability import Cell, verdicts
from footopt.report.progress import progress
from footopt.sand import StressMap, affine, alpha
from footopt.studies import build
from footopt.studies.base import Study
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.settings import Config
from footopt.walk import FIVE, STEPPERS, Accuracy, Scene, Walk, simulate
from footopt.walk.contact import CONTACT, FX, FZ, TALLY, contact
from footopt.walk.objectives import FLOORS
from footopt.walk.prepare import sole, world

Array = NDArray[np.float64]

#: Steppers that evaluate no Jacobian and solve nothing take this share of the time step, which
#: gives Euler the effort of SDIRK2 (two stages of 1-2 evaluations, with derivatives), Heun twice
#: and RK4 four times as much.
EXPLICIT_SHARE = 0.2

#: A walk is compared with SDIRK2 at the settings' time step over this; its own error is below 1 %.
CONVERGED = 25.0

CHATTER = 1e-3  # of the weight: what a force plate resolves; the trapped state has none at all
YIELDING = 3.0  # in units of what the smoothed law itself yields (`yielding`), good to a factor for any sole
ENERGY = 0.05  # of |W|: half of the error that is allowed to results
ERROR = 0.1  # relative, of a result against the converged walk: beyond it the walk is another one
DRIFT = 1e-3  # relative: a periodic gait forgets its start in a few strides, then nothing changes
LAW = 1e-9  # relative: the fast form of the law against the angles; rounding is 1e-13
NUDGE, JUMP = 1e-6, 1e-5  # a change of speed in creep speeds, and of the force that it may cause:
# h changes by NUDGE, M h by less than NUDGE, and no stress is below a tenth of M's largest entry
CONTROL = 1e-3  # m/s, of the method under step control
LEAP = 30.0  # deg, the jump in the gait that must be refused
UNJUDGED = math.inf

JUDGING = 3.0  # s of walking that take as long as the rest of a verdict does
BURIED = 0.02  # m, mean depth of the sole where the law is asked without a walk


#: What is judged, by name: a stepper and its step control. Every stepper takes steps of one length,
#: and the default one is also judged under control, as the accuracies by name use it.
METHODS: dict[str, tuple[str, float | None]] = {
    **{name: (name, None) for name in STEPPERS},
    "sdirk2_control": ("sdirk2", CONTROL),
}


@dataclass(frozen=True)
class Setup:
    """What is walked: a foot through a scene at an accuracy."""

    foot: Foot
    scene: Scene
    accuracy: Accuracy


@dataclass(frozen=True)
class Measure:
    """One number about a trial; it is stable as far as this goes if the value is within the limit.

    An infinite limit: the number is recorded and not judged.
    """

    name: str
    value: float
    limit: float

    @property
    def ratio(self) -> float:
        """Value over limit; infinite for a value that is not a number."""
        if self.limit == UNJUDGED:
            return 0.0
        if not math.isfinite(self.value):
            return math.inf
        if self.limit == 0.0:
            return 0.0 if self.value == 0.0 else math.inf
        return self.value / self.limit


@dataclass(frozen=True)
class Trial:
    """One case with one stepper; walks are simulated when a judge asks for them."""

    setup: Setup
    converged: Callable[[], Walk]

    @cached_property
    def walk(self) -> Walk:
        """The walk by the trial's stepper."""
        return simulate(self.setup.foot, self.setup.scene, self.setup.accuracy)


@dataclass(frozen=True)
class Case:
    """A hard case.

    Parameters
    ----------
    name, asks : for tables: what it is, and what must hold.
    build : from the settings' setup to the case's own.
    judge : the numbers that decide.
    walks : whether a walker walks in it; otherwise it is the same for every stepper.
    """

    name: str
    asks: str
    build: Callable[[Setup], Setup]
    judge: Callable[[Trial], list[Measure]]
    walks: bool = True


@dataclass(frozen=True)
class Verdict:
    """A case with a method: stable or not, and by which measure."""

    case: Case
    method: str
    measures: tuple[Measure, ...]
    walk: Walk | None  # None where nothing is walked

    @property
    def decides(self) -> Measure:
        """The measure that comes closest to its limit, or is furthest beyond it."""
        return max(self.measures, key=lambda m: m.ratio)

    @property
    def stable(self) -> bool:
        """Whether every measure is within its limit."""
        return self.decides.ratio <= 1.0


# --- judges ---------------------------------------------------------------------------------------


def judge_walk(trial: Trial) -> list[Measure]:
    """A walk: right against the converged one, energy accounted for, none from the sand."""
    walk, truth = trial.walk, trial.converged()
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    errors = {}
    for name in FIVE:
        exact = truth.objectives[name]
        errors[name] = abs(walk.objectives[name] - exact) / max(abs(exact), FLOORS.get(name, 1e-3))
    peak = errors.pop("peak_power")  # on its own: an impact may be shorter than a step
    return [
        *_sound(walk),
        Measure("error", max(errors.values()), ERROR),
        Measure("peak", peak, ERROR),
    ]


def judge_set_down(trial: Trial) -> list[Measure]:
    """As `judge_walk`, with the speed at which feet are set down, m/s, as the case finds it."""
    return [*judge_walk(trial), Measure("set down", set_down_speed(trial.converged()), UNJUDGED)]


def judge_standing(trial: Trial) -> list[Measure]:
    """Standing still: in the second half nothing moves, and the sand carries exactly the weight.

    Where the converged walker sinks, the right answer is that he sinks.
    """
    walk, truth = trial.walk, trial.converged()
    if walk.reason or truth.reason:
        return [outcome(walk, truth.reason)]
    late = walk.t > 0.5 * walk.t[-1]
    weight = walk.scene.walker.mass * walk.scene.gravity[1]  # the part that presses on the sand
    speed = yielding(walk, 0.5 * walk.t[-1])
    crept = speed * 0.5 * walk.t[-1]
    force = walk.force[late, :, 1].sum(axis=1) / weight
    com, work = walk.com[late], walk.work[late].sum(axis=1)
    return [
        *_sound(walk),
        Measure("chatter", float(force.std()), CHATTER),
        Measure("load", float(abs(force.mean() - 1.0)), CHATTER),
        Measure("speed", float(np.hypot(*walk.velocity[late].T).max() / speed), YIELDING),
        Measure("drift", float(np.hypot(*(com[-1] - com[0])) / crept), YIELDING),
        Measure("work", float(abs(work[-1] - work[0]) / (weight * crept)), YIELDING),
    ]


def judge_long_walk(trial: Trial) -> list[Measure]:
    """Ten minutes: the last minute is as fast as the second, and energy is accounted for."""
    walk = trial.walk
    if walk.reason:
        return [outcome(walk, "")]
    x = np.interp([60.0, 120.0, walk.t[-1] - 60.0, walk.t[-1]], walk.t, walk.com[:, 0])
    second, last = (x[1] - x[0]) / 60.0, (x[3] - x[2]) / 60.0
    return [*_sound(walk), Measure("slowing", float(abs(last / second - 1.0)), DRIFT)]


def judge_sunk(trial: Trial) -> list[Measure]:
    """Sand that cannot carry the walker: the walk is infeasible, and the reason is that he sank."""
    return [outcome(trial.walk, "sunk")]


def judge_still_plate(trial: Trial) -> list[Measure]:
    """A foot that turns about each of its plates in turn: finite forces, without a jump.

    The plate at rest feels the law's bias; all others are compared with the readable affine form.
    """
    jump = error = 0.0
    bad = 0
    sole = trial.setup.foot.plates(trial.setup.accuracy.plates, "chord")
    eps = trial.setup.accuracy.creep
    for rate in (-5.0, 5.0):  # rad/s
        for x, z in zip(sole.x[0], sole.z[0], strict=True):
            motion = (rate * z, -rate * x, rate)  # hip's velocity that leaves this plate at rest
            here, size, expected = _by_both(trial.setup, motion, eps, _smoothed)
            bad += int((~np.isfinite(here)).sum())
            error = max(error, float(np.abs(here[[FX, FZ]] - expected).max()) / size)
            for nudge in NUDGE * eps * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]):
                moved = (motion[0] + nudge[0], motion[1] + nudge[1], rate)
                there = _by_both(trial.setup, moved, eps, _smoothed)[0]
                jump = max(jump, float(np.abs((there - here)[[FX, FZ]]).max()) / size)
    return [Measure("not finite", bad, 0.0), Measure("jump", jump, JUMP), Measure("law", error, LAW)]


def judge_direction(trial: Trial, directions: Sequence[tuple[float, float]]) -> list[Measure]:
    """A foot moved along an axis, fast and slowly: the forces of the law in its angles."""
    error, bad = 0.0, 0
    for vx, vz in directions:
        for speed in (1e-3, 1.0, 10.0):  # m/s; smoothing of 1e-9 m/s is below rounding in all of them
            found, size, expected = _by_both(trial.setup, (speed * vx, speed * vz, 0.0), 1e-9, _of_angles)
            bad += int((~np.isfinite(found)).sum())
            error = max(error, float(np.abs(found[[FX, FZ]] - expected).max()) / max(size, 1e-300))
    return [Measure("not finite", bad, 0.0), Measure("law", error, LAW)]


def judge_vertical(trial: Trial) -> list[Measure]:
    """Straight down and straight up."""
    return judge_direction(trial, [(0.0, -1.0), (0.0, 1.0)])


def judge_horizontal(trial: Trial) -> list[Measure]:
    """Straight forward and straight backward."""
    return judge_direction(trial, [(1.0, 0.0), (-1.0, 0.0)])


def judge_leap(trial: Trial) -> list[Measure]:
    """A gait file whose knee jumps: reading it must be refused."""
    phase = np.linspace(0.0, 1.0, 101)
    gait = trial.setup.scene.gait
    thigh, knee = np.degrees(gait.thigh.at(phase)[0]), np.degrees(gait.knee.at(phase)[0])
    knee += np.where(phase > 0.5, LEAP, 0.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "leap.csv"
        with open(path, "w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerow(["time", "thigh", "knee"])
            rows.writerows(np.stack([phase * gait.period, thigh, knee], axis=1).tolist())
        try:
            Gait.from_file(path)
        except FileError:
            return [Measure("refused", 0.0, 0.0)]
    return [Measure("accepted", 1.0, 0.0)]


def outcome(walk: Walk, expected: str) -> Measure:
    """0 if a walk ended as expected ("": well), 1 if not."""
    return Measure(walk.reason or "no failure", float(walk.reason != expected), 0.0)


def _sound(walk: Walk) -> list[Measure]:
    """What holds for every walk: all steps are finite, energy adds up, the sand gives none."""
    missing = 1.0 - walk.t[-1] / walk.scene.duration  # a trace ends where it is no longer finite
    return [
        Measure("not finite", float(missing) if missing > 1e-9 else 0.0, 0.0),
        Measure("energy", energy_gap(walk), ENERGY),
        Measure("power", power_from_sand(walk), lent(walk.scene.sand.stress_map)),
    ]


def energy_gap(walk: Walk) -> float:
    """|d(kinetic + potential) - work of the sand - net work of the joints| over |work of the sand|.

    Both works are the stepper's own quadrature.
    """
    walker = walk.scene.walker
    kinetic = 0.5 * walker.mass * float(np.sum(walk.velocity[-1] ** 2))
    tilt, g = walk.scene.gravity
    x, z = (walk.com[-1] - walk.start).tolist()
    potential = float(walker.mass * (g * z - (tilt or 0.0) * x))
    sand = float(walk.work[-1].sum())
    return abs(kinetic + potential - sand - walk.totals["net_joint_work"]) / max(abs(sand), 1e-300)


def power_from_sand(walk: Walk, samples: int = 64) -> float:
    """Largest power that a foot gets from the sand, over creep speed times its plates' forces."""
    found = 0.0
    for foot in range(2):
        power = walk.power[:, foot]
        largest = np.argsort(power)[-samples:]
        largest = largest[power[largest] > 0.0]
        if len(largest):
            sizes = np.linalg.norm(walk.plates(largest).force[:, foot], axis=-1).sum(axis=-1)
            found = max(found, float(np.max(power[largest] / sizes)) / walk.accuracy.creep)
    return found


@cache
def lent(stress_map: StressMap) -> float:
    """Bound of the power that smoothing lends, per creep speed and force: 1.1 for the generic map.

    A plate that moves at s along e feels a - q M e with q = s / sqrt(s^2 + eps^2), and gets power
    only while q < q0 = (a.e) / (e.M e): at speeds below eps q0 / sqrt(1 - q0^2). q0 < 1 wherever
    the law dissipates.
    """
    beta, angle = np.linspace(-np.pi / 2, np.pi / 2, 361), np.linspace(-np.pi, np.pi, 721)
    a, m = affine(beta, stress_map)
    e = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    q0 = float(np.max((a @ e.T) / np.einsum("ti,bij,tj->bt", e, m, e)))
    return q0 / math.sqrt(1.0 - q0 * q0) if q0 < 1.0 else UNJUDGED


def yielding(walk: Walk, t: float) -> float:
    """Speed at which smoothing lets a flat sole sink at a time t (s) of standing, m/s.

    The sand carries the weight at the depth d_0 with h = 1, and a little deeper, by a share s, with
    3/8 + 5/8 h = 1 / (1 + s): a speed eps (5 / 16 s)^(1/2) that falls as ds/dt = v / d_0 goes on, to
    eps (5 d_0 / (24 eps t))^(1/3). Where that is below eps, eps.
    """
    eps, depth = walk.accuracy.creep, walk.totals["maximum_sinkage"]
    return float(eps * max(1.0, (5.0 * depth / (24.0 * eps * t)) ** (1.0 / 3.0)))


def set_down_speed(walk: Walk) -> float:
    """Largest downward speed of a plate in the first sample after its foot enters the sand, m/s."""
    loaded = np.abs(walk.force).sum(axis=-1) > 0.0
    fastest = 0.0
    for sample, foot in np.argwhere(loaded[1:] & ~loaded[:-1]):
        states = walk.plates([sample + 1])
        wet = states.position[0, foot, :, 1] < 0.0
        fastest = max(fastest, float(-states.velocity[0, foot, wet, 1].min(initial=0.0)))
    return fastest


def _by_both(
    setup: Setup, motion: tuple[float, float, float], creep: float, law: Callable[..., Array]
) -> tuple[Array, float, Array]:
    """The compiled contact of one foot, level and buried, against a readable form of the law.

    Parameters
    ----------
    motion : the hip's velocity in x and z, m/s, and the foot's rate of turn, rad/s.

    Returns
    -------
    found : (7,), see `kernels.contact`. size : sum of the plates' forces, N.
    expected : (2,), force, N.
    """
    plates = setup.foot.plates(setup.accuracy.plates, "chord", directed=True)
    assert plates.tx is not None, "asked for"
    assert plates.tz is not None, "asked for"
    (vx, vz, rate), out, tally = motion, np.zeros((2, CONTACT)), np.zeros(TALLY, np.int64)
    pose = np.zeros((2, 7))
    pose[:, 4], pose[0, 6] = 1.0, rate
    pose[0, 1], pose[1, 1] = -1.0, 10.0  # the other foot is in the air
    z = 1.0 - float(np.mean(plates.z)) - BURIED
    laws = world(setup.scene, replace(setup.accuracy, creep=creep))
    contact(out, tally, sole(plates), laws, pose, 0.0, z, vx, vz, creep, 1e-3)
    x, depth = plates.x[0], np.maximum(-(z - 1.0 + plates.z[0]), 0.0)
    velocity = np.stack([vx - rate * plates.z[0], vz + rate * x], axis=-1)
    normal = np.stack([plates.tz[0], -plates.tx[0]], axis=-1)
    stress = law(np.arctan2(plates.tz[0], plates.tx[0]), velocity, creep, setup.scene.sand.stress_map)
    into = np.sum(normal * velocity, axis=-1)
    load, share, push = effects.readable(setup.scene.effects, depth, x, into, creep)
    forces = (setup.scene.sand.zeta * load * share)[:, None] * stress - push[:, None] * normal
    forces *= plates.area[0][:, None]
    return out[0], float(np.linalg.norm(forces, axis=-1).sum()), forces.sum(axis=0)


def _smoothed(beta: Array, velocity: Array, creep: float, stress_map: StressMap) -> Array:
    """Stresses per depth, (plates, 2), by the affine form with a smoothed direction."""
    a, m = affine(beta, stress_map)
    h = velocity / np.sqrt(np.sum(velocity**2, axis=-1, keepdims=True) + creep**2)
    return np.asarray(a - np.einsum("pij,pj->pi", m, h))


def _of_angles(beta: Array, velocity: Array, creep: float, stress_map: StressMap) -> Array:
    """Stresses per depth, (plates, 2), by the published form; `creep` is not in it."""
    ax, az = alpha(beta, np.arctan2(-velocity[:, 1], velocity[:, 0]), stress_map)
    return np.stack([-ax, az], axis=-1)


# --- cases ----------------------------------------------------------------------------------------


def standing(zeta: float, creep: float | None = None) -> Callable[[Setup], Setup]:
    """Still for 10 s on a sand."""

    def change(base: Setup) -> Setup:
        still = replace(base.scene.gait, start=math.inf)
        scene = replace(base.scene, sand=_sand(base, zeta), gait=still, t_f=10.0)
        return replace(base, scene=scene, accuracy=_finely(base, creep=creep))

    return change


def walking(
    zeta: float | None = None, mass: float | None = None, t_f: float | None = None, **finely: float | None
) -> Callable[[Setup], Setup]:
    """The settings' walk with another sand, walker, duration or accuracy."""

    def change(base: Setup) -> Setup:
        walker = base.scene.walker if mass is None else replace(base.scene.walker, mass=mass)
        scene = replace(base.scene, sand=_sand(base, zeta), walker=walker, t_f=t_f)
        return replace(base, scene=scene, accuracy=_finely(base, **finely))

    return change


def spiky(base: Setup) -> Setup:
    """A sole whose waypoints jump between the top and the bottom of the box."""
    spikes = Foot.from_waypoints([1, 10] * 5 + [1])
    return replace(base, foot=replace(spikes, name="spiky"), scene=replace(base.scene, t_f=None))


def stamping(base: Setup) -> Setup:
    """A march with bent knees and level feet that come down at about 3 m/s.

    Shanks mirror the thighs about the vertical, so that the ankle goes up and down below the hip;
    10 deg of swing carry the walker forward.
    """
    march = Gait(
        thigh=Fourier(35.0, (-10.0,), (20.0,)),
        knee=Fourier(70.0, (0.0,), (40.0,)),
        foot=Fourier(0.0, (0.0,), (0.0,)),
        period=0.7,
        pitch="measured",
        name="march",
    )
    return replace(base, scene=replace(base.scene, gait=march, t_f=None))


def unchanged(base: Setup) -> Setup:
    """The settings' own."""
    return base


def _sand(base: Setup, zeta: float | None) -> Any:
    return base.scene.sand if zeta is None else replace(base.scene.sand, zeta=zeta, name=f"zeta {zeta:g}")


def _finely(base: Setup, **changes: Any) -> Accuracy:
    """The settings' accuracy with changes that are given; `steps` multiplies the time step."""
    given = {name: value for name, value in changes.items() if value is not None}
    dt = base.accuracy.dt * given.pop("steps", 1.0)
    return replace(base.accuracy, dt=dt, name="custom", **given)


STANDS = "10 s: at rest, the weight carried without chatter, no drift, no work, energy adds up"
WALKS = "right within 10 % of the converged walk, energy adds up, none from the sand"
FAILS = "infeasible, because he sank"
IS_LAW = "finite, and the force of the published law"

CASES: tuple[Case, ...] = (
    *(
        Case(f"standing, zeta {zeta:g}", STANDS, standing(zeta), judge_standing)
        for zeta in (0.05, 0.2, 1.0, 5.0, 50.0, 500.0)
    ),
    Case("standing, creep 1e-9", STANDS, standing(5.0, creep=1e-9), judge_standing),
    Case("2 kg", WALKS, walking(mass=2.0), judge_walk),
    Case("500 kg", WALKS, walking(mass=500.0), judge_walk),
    Case("zeta 100 under 2 kg", WALKS, walking(zeta=100.0, mass=2.0), judge_walk),
    Case("a step ten times larger", WALKS, walking(steps=10.0), judge_walk),
    Case("a foot set down at 3 m/s", WALKS, stamping, judge_set_down),
    Case("spiky soles", WALKS, spiky, judge_walk),
    *(Case(f"{plates} plates", WALKS, walking(plates=plates), judge_walk) for plates in (5, 50, 500, 5000)),
    *(
        Case(f"creep {creep:.0e}".replace("e-0", "e-"), WALKS, walking(creep=creep), judge_walk)
        for creep in (1e-9, 1e-7, 1e-5, 1e-3, 1e-2)
    ),
    Case("creep 1e-9 on zeta 50", WALKS, walking(zeta=50.0, creep=1e-9), judge_walk),
    Case(
        "ten minutes of walking",
        "the last minute as fast as the second, energy adds up",
        walking(t_f=600.0),
        judge_long_walk,
    ),
    Case("sand that carries nobody", FAILS, walking(zeta=1e-3), judge_sunk),
    Case("sinking to the hip", FAILS, walking(zeta=0.02), judge_sunk),
    Case(
        "a plate at rest",
        "turning about any plate: finite, no jump, and the law's force",
        unchanged,
        judge_still_plate,
        walks=False,
    ),
    Case("vertical motion", IS_LAW, unchanged, judge_vertical, walks=False),
    Case("horizontal motion", IS_LAW, unchanged, judge_horizontal, walks=False),
    Case("a gait with a jump", f"a leap of {LEAP:g} deg is refused", unchanged, judge_leap, walks=False),
)


# --- the study ------------------------------------------------------------------------------------


def judge(
    case: Case, base: Setup, methods: Sequence[str], step: Callable[[float], None] = lambda work: None
) -> list[Verdict]:
    """One case with every method.

    Parameters
    ----------
    methods : names in `METHODS`.
    base : where the case starts from; its time step is that of the implicit steppers.
    step : called with its `effort` after every method.
    """
    setup = case.build(base)

    @cache
    def converged() -> Walk:
        fine = replace(setup.accuracy, stepper="sdirk2", control=None, dt=base.accuracy.dt / CONVERGED)
        return simulate(setup.foot, setup.scene, fine)

    if not case.walks:
        measures = tuple(case.judge(Trial(setup, converged)))
        for method in methods:
            step(effort(setup, method))
        return [Verdict(case, method, measures, None) for method in methods]
    found = []
    for method in methods:
        stepper, control = METHODS[method]
        dt = setup.accuracy.dt * (EXPLICIT_SHARE if not STEPPERS[stepper].implicit else 1.0)
        accuracy = replace(setup.accuracy, stepper=stepper, dt=dt, control=control)
        trial = Trial(replace(setup, accuracy=accuracy), converged)
        found.append(Verdict(case, method, tuple(case.judge(trial)), trial.walk))
        step(effort(setup, method))
    return found


def effort(setup: Setup, method: str) -> float:
    """About how long a verdict takes, as how many seconds of walking with an explicit stepper."""
    stepper, control = METHODS[method]
    share = 0.3 if STEPPERS[stepper].implicit else 1.0
    return JUDGING + setup.scene.duration * (share if control is None else 4.0)


def chosen(config: Config) -> tuple[list[Case], list[str]]:
    """The cases and methods that the settings name; null is all."""
    known = {case.name: case for case in CASES}
    names = list(known) if config.study.cases is None else config.study.cases
    methods = list(METHODS) if config.study.methods is None else config.study.methods
    for setting, given, allowed in (
        ("study.cases", names, known),
        ("study.methods", methods, METHODS),
    ):
        if not given:
            raise SettingError(setting, given, f"null for all, or some of: {'; '.join(allowed)}")
        for name in given:
            if name not in allowed:
                raise SettingError(setting, name, f"one of: {'; '.join(allowed)}")
    return [known[name] for name in names], methods


def run(study: Study) -> None:
    """Judge every case with every method and write the verdicts to `folder`."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    cases, methods = chosen(config)
    base = Setup(build.make_foot(config.foot), build.make_scene(config), build.make_accuracy(config.accuracy))
    found: list[Verdict] = []
    with terminal.told_if_slow(out, "Compiling every method; this is done once and kept on disk ..."):
        for method in methods:
            stepper, control = METHODS[method]
            simulate(base.foot, base.scene, replace(base.accuracy, stepper=stepper, control=control))
    work = sum(effort(case.build(base), method) for case in cases for method in methods)
    with progress(out, len(cases) * len(methods), "walk", work) as step:
        for case in cases:
            found += judge(case, base, methods, partial(step, news=case.name))
    write_csv(folder / "stability.csv", found)
    cells = {(v.case.name, v.method): Cell(v.stable, v.decides.name, v.decides.value) for v in found}
    save(verdicts([case.name for case in cases], methods, cells), folder / "figures", "stability")
    record = {
        "study": "stability",
        "design": foot_entry(base.foot),
        **scene_entry(base.scene, base.accuracy, ()),
        "limits": {
            "chatter": CHATTER,
            "yielding": YIELDING,
            "energy": ENERGY,
            "error": ERROR,
            "drift": DRIFT,
            "law": LAW,
            "jump": JUMP,
        },
        "explicit_share_of_dt": EXPLICIT_SHARE,
        "stable": {m: sum(v.stable for v in found if v.method == m) for m in methods},
        "cases": len(cases),
        "verdicts": [entry(v) for v in found],
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    said = [
        "Each cell: the measure nearest to its limit, or furthest beyond, and how often a stage was rescued "
        "(r) or the walk repeated with a shorter step (x). All the numbers: stability.csv, result.json."
    ]
    steps = ", ".join(m for m in methods if not STEPPERS[METHODS[m][0]].implicit)
    if steps:
        explicit = f"; {steps}: {1e3 * EXPLICIT_SHARE * base.accuracy.dt:g} ms, for Euler the same effort"
    else:
        explicit = ""
    said.append(f"Time step {1e3 * base.accuracy.dt:g} ms{explicit}.")
    shown = table(cases, methods, found)
    says = {
        "stability": "Which method is stable in which case, with the measure that decides; the table above "
        "has the same in words."
    }
    summary.conclude(folder, "What stays stable", said, says, [shown], record)


def entry(v: Verdict) -> dict[str, Any]:
    """A verdict in result.json."""
    return {
        "case": v.case.name,
        "asks": v.case.asks,
        "method": v.method,
        "stable": v.stable,
        "measure": v.decides.name,
        "measures": {
            m.name: {"value": m.value, "limit": None if m.limit == UNJUDGED else m.limit} for m in v.measures
        },
        **counts(v.walk),
    }


def counts(walk: Walk | None) -> dict[str, Any]:
    """What a walk took: step and simulated time (s), evaluations per step, rescues, repeats."""
    if walk is None:
        return dict.fromkeys(
            ("reason", "dt", "simulated", "evaluations_per_step", "rescues", "shortened", "repeats"), math.nan
        )
    return {
        "reason": walk.reason,
        "dt": walk.accuracy.dt,
        "simulated": float(walk.t[-1]) if len(walk.t) else 0.0,
        "evaluations_per_step": walk.evaluations / max(len(walk.t), 1),
        "rescues": walk.rescues,
        "shortened": walk.shortened,
        "repeats": walk.repeats,
    }


def write_csv(path: Path, found: Sequence[Verdict]) -> None:
    """A row for each case and stepper; a column for each measure, empty where it is not asked."""
    names = list(dict.fromkeys(m.name for v in found for m in v.measures))
    took = list(counts(None))
    rows = []
    for v in found:
        values = {m.name: m.value for m in v.measures}
        rows.append(
            [
                v.case.name,
                v.method,
                int(v.stable),
                v.decides.name,
                v.decides.value,
                v.decides.limit,
                *(counts(v.walk)[name] for name in took),
                *(values.get(name, math.nan) for name in names),
                v.case.asks,
            ]
        )
    header = ["case", "method", "stable", "measure", "value", "limit", *took, *names, "asks"]
    files.write_csv(path, header, rows)


def table(cases: Sequence[Case], methods: Sequence[str], found: Sequence[Verdict]) -> Table:
    """Cases (rows) and methods (columns) for the terminal."""
    by_name = {(v.case.name, v.method): v for v in found}
    good = {m: sum(v.stable for v in found if v.method == m) for m in methods}
    names = {method: method.replace("_", " ") for method in methods}
    shown = terminal.table(["case", *names.values()], words=["case", *names.values()])
    for case in cases:
        shown.add_row(case.name, *(_cell(by_name[case.name, method]) for method in methods))
    shown.add_section()
    shown.add_row("stable cases", *(f"{good[method]} of {len(cases)}" for method in methods))
    return shown


def _cell(v: Verdict) -> Text:
    words = ["ok" if v.stable else "NO", Cell(v.stable, v.decides.name, v.decides.value).text]
    if v.walk is not None and v.walk.rescues:
        words.append(f"r{v.walk.rescues}")
    if v.walk is not None and v.walk.repeats:
        words.append(f"x{v.walk.repeats}")
    return Text(" ".join(words), style="" if v.stable else "bold red")
