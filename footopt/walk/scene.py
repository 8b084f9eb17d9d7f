"""`Walker` and `Scene`: what the paper's walker is, where it walks, and the simulator of it."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from footopt.arrays import Array
from footopt.effects import base as effects
from footopt.effects.base import Effect, ordered
from footopt.errors import TINY, check, check_kind, check_number
from footopt.foot import Foot, Soles, Waypoints, as_plates
from footopt.foot.plates import RULES
from footopt.gait import Gait
from footopt.sand import Sand
from footopt.sand.law import EARTH, PER_CM3, Law
from footopt.walk.accuracy import Accuracy, Tolerance
from footopt.walk.discretize import Path, too_many_poses
from footopt.walk.ladder import Found, climbed, numbers_at
from footopt.walk.loop import OK, REASONS, walk_batch
from footopt.walk.metrics import PARTS, RAW
from footopt.walk.newton import NEWTON, STICKING
from footopt.walk.results import Walk
from footopt.walk.simulator import Simulator, Walked
from footopt.walk.state import COUNTED, World
from footopt.walk.steppers import STEPPERS

CHUNK = 4096  # designs whose plates are in memory at once
POINTS = 4_000_000  # along their soles, at most
DAMPING = 2.0  # of bristles: critical for a mass that they hold by its weight

#: Units and ranges of a walker's numbers, from an insect to an excavator that walks.
WALKERS = {
    "mass": ("kg", 1e-9, 1e9),
    "l1": ("m", 1e-4, 10.0),
    "l2": ("m", 1e-4, 10.0),
    "g": ("m/s^2", 1e-6, 1e6),
}


@dataclass(frozen=True)
class Walker:
    """A biped with all its mass at the hip and massless legs (the paper's table 1).

    Parameters
    ----------
    mass : float, kg
        Mass of the whole walker, M.
    l1 : float, m
        Length of a thigh.
    l2 : float, m
        Length of a shank.
    g : float, m/s^2
        Gravity. The sand's strength is in proportion to it: see `Scene.zeta`.

    Raises
    ------
    SettingError
        A number is not in `WALKERS`' range.
    """

    mass: float = 60.0
    l1: float = 0.47
    l2: float = 0.45
    g: float = EARTH

    def __post_init__(self) -> None:
        for name, (unit, low, high) in WALKERS.items():
            value = getattr(self, name)
            allowed = f"a number > 0, from {low:g} to {high:g}, in {unit}"
            check_number(f"walker.{name}", value, low, high, allowed)

    @property
    def weight(self) -> float:
        """M g, N."""
        return self.mass * self.g


@dataclass(frozen=True)
class Scene(Simulator):
    """The physics of a walk: which sand, which gait, which walker, how long.

    Parameters
    ----------
    sand : Sand
        The hard one by default.
    gait : Gait
        Human walking by default.
    walker : Walker
        The paper's by default.
    t_f : float, s, optional
        End of the walk; by default two strides after the start (2.9 s for the paper's walk).
    effects : tuple of Effect
        Beyond the plain law (`footopt.effects`).

    Raises
    ------
    SettingError
        t_f is not allowed, or missing for a walker that stands still; two effects are of one kind.
    """

    sand: Sand = field(default_factory=lambda: Sand.named("hard"))
    gait: Gait = field(default_factory=Gait.human)
    walker: Walker = field(default_factory=Walker)
    t_f: float | None = None
    effects: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        check_kind("sand", self.sand, Sand, 'Try fo.Sand.named("hard")')
        check_kind("gait", self.gait, Gait, "Try fo.Gait.human() or fo.read_gait(path)")
        check_kind("walker", self.walker, Walker, "Try fo.Walker(mass=60)")
        object.__setattr__(self, "effects", ordered(self.effects))
        moves, hint = math.isfinite(self.gait.start), "Try scene.t_f=10, or a finite gait.start."
        allowed = "given, in s, for a walker that stands still"
        check(self.t_f is not None or moves, "scene.t_f", None, allowed, hint)
        if self.t_f is not None:
            check_number("scene.t_f", self.t_f, TINY, 1e5, "a time > 0 and <= 1e5, in s")

    @property
    def duration(self) -> float:
        """t_f, s."""
        return self.gait.start + 2.0 * self.gait.period if self.t_f is None else self.t_f

    #: Joints of massless legs spend what the sand takes.
    transport: ClassVar[str] = "work"
    quantities: ClassVar[tuple[str, ...]] = RAW

    @property
    def weight(self) -> float:
        """M g, N."""
        return self.walker.weight

    @property
    def legs(self) -> float:
        """l1 + l2, m."""
        return self.walker.l1 + self.walker.l2

    @property
    def title(self) -> str:
        """Its sand in a few words."""
        return self.sand.title

    @property
    def about(self) -> str:
        """The walker and its gait, in one line."""
        walker, gait = self.walker, self.gait
        return (
            f"Walker: {walker.mass:g} kg, legs {walker.l1:g} + {walker.l2:g} m, g {walker.g:g} m/s^2; "
            f"gait {gait.name}, stride {gait.period:.4g} s"
        )

    def entry(self) -> dict[str, Any]:
        """What it is, for result.json."""
        g = self.gait
        about = {"name": g.name, "period_s": g.period, "pitch": g.pitch, "source": g.source}
        gait = {**about, "fit_residual_deg": dict(g.residual)}
        return {"gait": gait, "walker": asdict(self.walker), "t_f_s": self.duration}

    @property
    def g(self) -> float:
        """Gravity, m/s^2."""
        return self.walker.g

    @property
    def stride(self) -> float:
        """Duration of a stride, s."""
        return self.gait.period

    @property
    def strikes(self) -> Array:
        """Times of all heel strikes, the right foot's first, s."""
        return self.gait.heel_strikes(self.duration)

    @property
    def holds(self) -> bool:
        """Whether its sand holds what stands, by bristles, in place of letting it creep."""
        return effects.bristle_length(self.effects) is not None

    @property
    def zeta(self) -> float:
        """The sand's zeta times g over the Earth's: its strength under the gravity of this scene.

        Dry grains resist by friction, under the pressure of the weight of those above them. Stress per
        depth is then in proportion to rho g: Slonaker et al., Physical Review E 95, 052901 (2017), from
        RFT, from plasticity with friction, and in discrete elements under several gravities. Bodies settle
        to the same depth at 0.4 to 1.2 g (Altshuler et al., Geophysical Research Letters 41, 2014).
        Cohesion does not scale with g and is not in the law.
        """
        return self.sand.zeta * (self.walker.g / EARTH)

    @property
    def gravity(self) -> tuple[float, float]:
        """Gravity along the surface (negative uphill, 0 if it is level) and against its normal, m/s^2."""
        return effects.gravity(self.effects, self.walker.g)

    @property
    def path(self) -> Path:
        """How feet move relative to the hip."""
        return Path(self.gait, self.walker.l1, self.walker.l2, self.duration)

    def constants(self, accuracy: Accuracy) -> World:
        """The constants of a compiled walk."""
        (tilt, g), length = self.gravity, effects.bristle_length(self.effects)
        # floats throughout: a whole number would be another type, and compile the loop again
        return World(
            law=Law(*(float(self.zeta * PER_CM3 * c) for c in self.sand.stress_map.law)),
            mass=float(self.walker.mass),
            g=float(g),
            tilt=float(tilt),
            creep=float(accuracy.creep),
            bristle_length=length,
            retardation=0.0 if length is None else DAMPING * float(np.sqrt(length / g)),
            tolerance=NEWTON if length is None else STICKING,
            effects=effects.laws(self.effects),
            given=0.0 if STEPPERS[accuracy.stepper].implicit else None,
        )

    def too_long(self, accuracy: Accuracy) -> bool:
        """Whether a walk needs more poses than are tabulated."""
        return too_many_poses(self.path, accuracy)

    def walk(
        self, feet: Sequence[Foot], accuracy: Accuracy, threads: int | None = None, names: Sequence[str] = ()
    ) -> Walked:
        """Walk with some feet by the compiled loop, which follows the sinkage where it is asked for."""
        sink, constants = "maximum_sinkage" in names, self.constants(accuracy)
        fill, parts = effects.reshaping(self.effects), []
        own = 0 if isinstance(feet, Soles) else max((len(foot.contour) for foot in feet), default=0)
        size = max(1, min(CHUNK, POINTS // (accuracy.plates * RULES[accuracy.rule] + own)))
        for i in range(0, len(feet), size):
            plates = as_plates(feet[i : i + size], accuracy.plates, accuracy.rule, fill)
            parts.append(walk_batch(plates, self.path, constants, accuracy, sink, threads)[:3])
        raw, status, counts = (np.concatenate(column) for column in zip(*parts, strict=True))
        raw[status != OK] = np.nan
        if not sink:
            raw[:, RAW.index("maximum_sinkage")] = np.nan
        reasons = np.array(REASONS)[status]
        return Walked(raw, reasons, counts["evaluations"], {name: counts[name] for name in COUNTED})

    def trace(self, foot: Foot, accuracy: Accuracy) -> Walk:
        """Walk with one foot, keeping full traces."""
        plates = foot.plates(accuracy.plates, accuracy.rule, effects.reshaping(self.effects))
        constants = self.constants(accuracy)
        walked = walk_batch(plates, self.path, constants, accuracy, sink=True, threads=1, traced=True)
        rows, h = 1 + np.flatnonzero(np.isfinite(walked.trace[1:]).all(axis=1)), walked.bristles
        parts = np.split(walked.trace[rows], PARTS, axis=1)
        t, com, velocity, force, power, work = map(np.ascontiguousarray, parts)
        return Walk(
            foot=foot,
            scene=self,
            accuracy=accuracy,
            t=t[:, 0],
            com=com,
            velocity=velocity,
            force=force.reshape(-1, 2, 2),
            power=power,
            work=work,
            bristles=None if h is None else np.moveaxis(h[rows][..., : plates.x.shape[1]], 2, 3),
            start=walked.trace[0, 1:3],
            reason=REASONS[int(walked.status[0])],
            totals=dict(zip(RAW, map(float, walked.raw[0]), strict=True)),
            evaluations=int(walked.counts["evaluations"][0]),
            counts={name: int(walked.counts[name][0]) for name in COUNTED},
        )

    def ladder(self, of: Tolerance, soles: Waypoints | tuple[Foot, ...]) -> tuple[Accuracy, Found]:
        """The numerical parameters for a tolerance, and how they were found."""
        found = climbed(of, self, self.path, soles)
        numbers = numbers_at(of, self.path, found.rung)
        return replace(numbers.refined(of.refinements), **of.by_hand) if of.refinements else numbers, found

    def check_comparable(self) -> None:
        """Raise unless the walk has a heel strike: without one p_max and dV_x are not defined."""
        start, strike = self.gait.start, self.gait.heel_strike
        hint = "It can be simulated (study=simulate), not searched over."
        allowed = "finite to compare feet: this walker stands still"
        check(math.isfinite(start), "gait.start", start, allowed, hint)
        allowed = f"later than the first heel strike at {strike:g} s to compare feet"
        check(self.duration > strike, "scene.t_f", self.duration, allowed, hint)
