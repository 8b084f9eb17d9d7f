"""A robot in MuJoCo as a simulator: `fo.simulate`, `fo.evaluate`, `fo.search` take it as a scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any, ClassVar, get_args

import numpy as np

from footopt.arrays import Array
from footopt.effects.base import Effect, ordered
from footopt.errors import TINY, SettingError, check, check_kind, check_number
from footopt.foot import Foot, Soles, Waypoints
from footopt.gait import Gait
from footopt.mujoco.controllers import Controller, FunctionController, Tracker
from footopt.mujoco.model import BIPED, Model
from footopt.mujoco.traces import RobotWalk, traced
from footopt.mujoco.walking import MEASURED, check_axes, quiet, walk
from footopt.sand import Sand
from footopt.walk import Accuracy, Scene, Simulator, Tolerance, Walker
from footopt.walk.ladder import PROBES, TOP, Found, Rung, climb, drawn, five, plates_at
from footopt.walk.loop import at_once
from footopt.walk.simulator import Walked

HALVINGS = 6  # of a model's time step, at most, for an accuracy
LADDER = 500.0  # walks of a search in whose time its numbers are found at most: half of one of 1,000
STEP_COST = 100.0  # plates along a sole that take as long as what else is in a step


@dataclass(frozen=True)
class Robot(Simulator):
    """A robot in MuJoCo, whose feet are designed.

    A designed sole replaces the part of each foot that touches the ground. Its `Foot.ankle` is the hinge of
    the foot's body, or the body's origin, with x forward and z up at the start.

    Parameters
    ----------
    model : str, Path or mujoco.MjSpec
        Its MJCF or URDF as a file (``pkg://PACKAGE/FILE`` for one in a package that is installed), MJCF as
        text, or a specification; by default a planar biped of 60 kg.
    feet : sequence of str
        Names of the bodies that are feet: of two, the left one first.
    controller : Tracker, Commands or callable
        Of its actuators. A function ``controller(model, data)`` sets ``data.ctrl`` once in every time
        step of the model, however short those of a walk are. It may use nothing but its arguments.
    sand : Sand
        The hard one by default.
    effects : sequence of Effect
        As in a `Scene`.
    duration : float, s, optional
        Duration of a walk; by default the controller's.
    after : float, s, optional
        Time from which on peak power and speed loss count; by default the first heel strike of its gait.
    key : str, optional
        Name of the keyframe that it starts from; by default the model's own pose, with the joints of a
        `Tracker` at the first angles of its gait. It starts at the height where the sand carries its weight.
    lowest : float
        The robot has fallen if its centre of mass is lower than this times its height at the start.
    tilt : float, rad
        The robot has also fallen if its root is inclined by more than this, compared with the start.
    density : float, kg/m^3, optional
        Of soles: mass and inertia of a sole with a flat top replace those of the foot; by default these stay.

    Raises
    ------
    SettingError
        MuJoCo does not compile the model, a name is not in it, or a number is not allowed.
    MissingError
        There is no MuJoCo: ``pip install "footopt[mujoco]"``.
    """

    model: Any = BIPED
    feet: Sequence[str] = ("left_foot", "right_foot")
    controller: Any = field(default_factory=Tracker)
    sand: Sand = field(default_factory=lambda: Sand.named("hard"))
    effects: Sequence[Effect] = ()
    duration: Any = None
    after: Any = None
    key: str | None = None
    lowest: float = 0.6
    tilt: float = 1.0
    density: float | None = None
    holds: ClassVar[bool] = True  # bristles are always on

    def __post_init__(self) -> None:
        put, feet = object.__setattr__, (self.feet,) if isinstance(self.feet, str) else tuple(self.feet)
        check(len(feet) > 0, "robot.feet", list(feet), "one body, or several")
        check_kind("sand", self.sand, Sand, 'Try fo.Sand.named("hard")')
        put(self, "feet", feet)
        put(self, "effects", ordered(self.effects))
        if not isinstance(self.model, Model) or self.model.feet != feet:
            check(not isinstance(self.model, Model), "robot.feet", list(feet), "those of its model")
            put(self, "model", Model.read(self.model, feet))
        if not isinstance(self.controller, get_args(Controller)):
            known = callable(self.controller)
            check(known, "robot.controller", self.controller, "a controller or a function")
            put(self, "controller", FunctionController(self.controller))
        if self.duration is None:
            put(self, "duration", self.controller.duration)
        if self.after is None:
            put(self, "after", self.gait.heel_strike if self.gait else 0.0)
        allowed = "a time > 0 and <= 300, in s"  # all steps are kept in memory
        check_number("robot.duration", self.duration, TINY, 300.0, allowed, "Are commands in s?")
        allowed = f"a time >= 0 and < {self.duration:g}, robot.duration, in s"
        most = np.nextafter(self.duration, 0.0)
        check_number("robot.after", self.after, 0.0, most, allowed, "Or lengthen robot.duration.")
        check_number("robot.lowest", self.lowest, TINY, np.nextafter(1.0, 0.0), "a number between 0 and 1")
        check_number("robot.tilt", self.tilt, TINY, math.pi, "an angle > 0 and <= pi, in rad")
        if self.density is not None:
            check_number("robot.density", self.density, TINY, 1e5, "a number > 0 and <= 1e5, in kg/m^3")
        if self.scripted:
            self.controller.commands(self.model.compiled, np.zeros(1))  # raises if it does not fit the model
        keys = [self.model.compiled.key(i).name for i in range(self.model.compiled.nkey)]
        known = self.key is None or self.key in keys
        check(known, "robot.key", self.key, f"a keyframe: {', '.join(keys) or 'it has none'}")

    @property
    def scripted(self) -> bool:
        """Whether its commands are known before it walks."""
        return not isinstance(self.controller, FunctionController)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of what its walks measure."""
        more = {"tracking_error": hasattr(self.controller, "targets"), "weight": self.density is not None}
        return (*MEASURED, *(name for name, measured in more.items() if measured))

    @property
    def weight(self) -> float:
        """Weight of its bodies, N."""
        return float(self.model.mass * self.g)

    @property
    def legs(self) -> float:
        """Height of its centre of mass over its feet, m."""
        return self.model.height

    @property
    def title(self) -> str:
        """Its sand and its mass, in a few words."""
        return f"{self.sand.title}, a robot of {self.weight / self.g:.3g} kg"

    @property
    def planar(self) -> Scene:
        """A `Scene` with its sand, effects and gravity."""
        walker = Walker(mass=self.weight / self.g, g=self.g)
        return Scene(self.sand, self.gait or Gait.human(), walker, self.duration, tuple(self.effects))

    @property
    def gait(self) -> Gait | None:
        """The gait that its servos track, if they do."""
        return self.controller.gait if isinstance(self.controller, Tracker) else None

    def tracking(self, gait: Gait) -> Robot:
        """A copy that tracks another gait; duration and `after`, unless they were set, follow that gait."""
        old, new = self.controller, replace(self.controller, gait=gait)
        duration = None if self.duration == old.duration else self.duration
        after = None if self.after == old.gait.heel_strike else self.after
        return replace(self, controller=new, duration=duration, after=after)

    @property
    def g(self) -> float:
        """Gravity, m/s^2."""
        return float(np.linalg.norm(self.model.compiled.opt.gravity))

    @property
    def strikes(self) -> Array:
        """Heel strikes of the gait that it tracks, s; none without one."""
        return self.gait.heel_strikes(self.duration) if self.gait else np.empty(0)

    @property
    def stride(self) -> float:
        """Duration of a stride of that gait, s; of the walk without one."""
        return self.gait.period if self.gait else self.duration

    @property
    def about(self) -> str:
        """The robot and its controller, in one line."""
        control = type(self.controller).__name__
        if self.gait:
            control = f"servos that track gait {self.gait.name}, stride {self.stride:.4g} s"
        return f"Robot: {self.model.mass:.3g} kg, feet {', '.join(self.feet)}; {control}"

    def entry(self) -> dict[str, Any]:
        """What it is, for result.json."""
        return {
            "simulator": "mujoco",
            "model": self.model.digest,
            "mass_kg": self.model.mass,
            "feet": list(self.feet),
            "controller": type(self.controller).__name__,
            "duration_s": self.duration,
            "sole_density_kg_m3": self.density,
        }

    def own(self) -> tuple[Any, ...]:
        """The controller, if it is a function."""
        return () if self.scripted else (self.controller.function,)

    @quiet()
    def check_comparable(self) -> None:
        """Raise unless its walks can be compared.

        The axes of its feet have to be those of a sole, and its first steps in the air stable: a later
        failure is then caused by the sand.
        """
        check_axes(self)
        dt, upright = self.model.compiled.opt.timestep, replace(self, lowest=1e-9, tilt=math.pi)
        try:
            found = walk(upright, None, Accuracy(dt=dt), min(200 * dt, self.duration))
        except Exception as error:
            if self.scripted:
                raise
            why = f"a function of (model, data) that does not fail ({type(error).__name__}: {error})"
            raise SettingError("robot.controller", self.controller.name, why) from error
        why = "a model that is stable in the air"
        check(found.reason != "diverged", "robot.model", self.title, why, "Try a shorter timestep.")

    def ladder(self, of: Tolerance, soles: Waypoints | tuple[Foot, ...]) -> tuple[Accuracy, Found]:
        """The time step, halved from the model's, and the plates that meet a tolerance (`walk.ladder`)."""
        own = float(self.model.compiled.opt.timestep)
        for _ in range(0 if of.dt else HALVINGS):  # a step at which soles diverge tells nothing of errors
            if np.sum(_probed(self, soles, own, plates_at(Rung())).reasons == "diverged") < 2:
                break
            own /= 2.0

        def at(rung: Rung) -> Accuracy:
            return Accuracy(dt=of.dt or own / 2**rung.time, plates=of.plates or plates_at(rung))

        def walked(rung: Rung) -> tuple[Array, float]:
            numbers = at(rung)
            found = _probed(self, soles, numbers.dt, numbers.plates)
            return five(self, found), (STEP_COST + numbers.plates) / numbers.dt

        top = Rung(0 if of.dt else HALVINGS, 0 if of.plates else TOP.plates)
        found = climb(walked, top, of.error, LADDER)
        numbers = at(found.rung)
        finer = 2**of.refinements
        dt, plates = of.dt or numbers.dt / finer, of.plates or numbers.plates * finer
        return replace(numbers, dt=dt, plates=plates), found

    @quiet()
    def walk(
        self, feet: Sequence[Foot], accuracy: Accuracy, threads: int | None = None, names: Sequence[str] = ()
    ) -> Walked:
        """Walk with some feet."""
        workers = min(at_once(threads), len(feet)) if self.scripted else 1
        one = partial(walk, self, accuracy=accuracy, end=self.duration)
        with ThreadPoolExecutor(workers) if workers > 1 else nullcontext() as pool:
            found = list((pool.map if pool else map)(one, feet))
        raw = np.array([[each.totals.get(name, np.nan) for name in self.quantities] for each in found])
        raw = raw.reshape(-1, len(self.quantities))
        reasons = np.array([each.reason for each in found], np.str_)
        return Walked(raw, reasons, np.array([each.evaluations for each in found], np.int64))

    @quiet()
    def trace(self, foot: Foot, accuracy: Accuracy) -> RobotWalk:
        """Walk with one foot, keeping full traces."""
        check_axes(self)
        return traced(self, foot, accuracy, walk(self, foot, accuracy, self.duration, traced=True))


@lru_cache(maxsize=64)
def _probed(robot: Robot, soles: Any, dt: float, plates: int) -> Walked:
    """Walks of the probes of a space, or of some feet, cached: every tolerance climbs the same rungs."""
    feet = Soles(drawn(soles).k[:PROBES], soles) if isinstance(soles, Waypoints) else soles
    return robot.walk(feet, Accuracy(dt=dt, plates=plates))
