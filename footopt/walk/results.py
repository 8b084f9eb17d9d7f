"""The results: `Table`, the objectives of many feet, and `Walk`, one foot with its traces and its stances."""

import math
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.arrays import Array, Bools, Ints, Words
from footopt.effects import reshaping
from footopt.foot import Foot, Plates
from footopt.gait import RIGHT, Pose
from footopt.walk.accuracy import Accuracy
from footopt.walk.bristles import transition_speed_of
from footopt.walk.objectives import MEASURES, OBJECTIVES, Objective, by_name, lookup, offered
from footopt.walk.plates import PlateStates, plate_states
from footopt.walk.simulator import Simulator


@dataclass(frozen=True, eq=False, repr=False)
class Table:
    """Objectives of many feet, in natural signs.

    Parameters
    ----------
    values : (designs, objectives)
        A row of NaN for a failed walk.
    names : tuple of str
        Of the objectives.
    feasible : (designs,), bool
        Whether the walk succeeded.
    reasons : (designs,), str
        "" or why it failed: sunk, backward, diverged.
    raw : (designs, quantities)
        Measured by the walks, columns ``scene.quantities``.
    evaluations : (designs,), int
        Of the contact.
    scene : Simulator
        Of the walks.
    counts : dict of str to (designs,), int
        Of the planar walker: evaluations of plates; implicit stages that Newton's method left unsolved; steps
        under control that were shortened to half their length, for these or for too large an error; repeats
        of the walk with a quarter of the time step, as a step could not be solved or a state was not finite.
    errors : (designs, objectives), optional
        Estimates of the values' errors, in their units; NaN where a finer walk ends otherwise or is too long.
        None unless `evaluate` was asked for them.
    """

    values: Array
    names: tuple[str, ...]
    feasible: Bools
    reasons: Words
    raw: Array
    evaluations: Ints
    scene: Simulator
    counts: Mapping[str, Ints]
    errors: Array | None = None

    def __repr__(self) -> str:
        title, walked = f"<Table of {len(self)} feet on {self.scene.title}", int(self.feasible.sum())
        return f"{title}: {walked} walked; {', '.join(self.names)}>"

    def __len__(self) -> int:
        return len(self.values)

    def column(self, name: str) -> Array:
        """An objective by name, (designs,), whether it is among `names` or not.

        Raises
        ------
        KeyError
            It is `maximum_sinkage` or measured in Python, and `evaluate` was not asked for it.
        """
        if name in self.names:
            return self.values[:, self.names.index(name)]
        there = [n for n in offered(self.scene) if n != "maximum_sinkage" and n in OBJECTIVES]
        if name not in there:
            raise KeyError(
                f"no {name!r} in this table: it has {', '.join(dict.fromkeys([*self.names, *there]))}"
            )
        return np.asarray(OBJECTIVES[name].value(by_name(self.raw, self.scene.quantities), self.scene))

    @property
    def efficiency(self) -> Array:
        """The paper's scalar J_W, (designs,); most negative is best."""
        return self.column("efficiency")

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row for each foot: its objectives, `feasible`, `reason`, and any errors.

        Units are in ``frame.attrs["units"]``.
        """
        import pandas

        columns = dict(zip(self.names, self.values.T, strict=True))
        frame = pandas.DataFrame(columns | {"feasible": self.feasible, "reason": self.reasons.astype(object)})
        if self.errors is not None:
            names = [f"{name}_error" for name in self.names]
            frame = frame.join(pandas.DataFrame(self.errors, columns=names))
        frame.attrs["units"] = {name: MEASURES[name].unit for name in self.names}
        return frame.rename_axis("foot")


LEAST_LOAD = 1.0 / 600.0  # of the weight: with more a foot stands on the sand

#: Names of one foot, and of two; more feet are numbered.
SIDES = {1: ("single",), 2: ("left", "right")}


@dataclass(frozen=True, eq=False, repr=False)
class Walk:
    """One simulated walk: traces at the end of every step, T of them, and what they add up to.

    Parameters
    ----------
    foot, scene, accuracy : Foot, Scene, Accuracy
        Of the walk.
    t : (T,), s
        The first is the end of the first step: exactly at rest the smoothed force is 3/8 of the one that
        carries the weight (all of it in a scene with bristles).
    com, velocity : (T, 2), m and m/s
        Of the hip, in x, z.
    force : (T, 2 feet, 2), N
        Of the sand on the left and the right foot.
    power, work : (T, 2 feet), W and J
        Negative where the sand takes energy.
    start : (2,), m
        Hip at t = 0.
    bristles : (T, 2 feet, N, 2), optional
        Memory of the sand under each plate (`footopt.walk.bristles`).
    reason : str
        "" or why the walk failed (then the traces end there).
    totals : dict
        The loop's own results by name (`RAW`), by the stepper's own quadrature.
    evaluations : int
        Of the contact.
    counts : dict of str to int
        See `Table`.
    """

    foot: Foot
    scene: Any
    accuracy: Accuracy
    t: Array
    com: Array
    velocity: Array
    force: Array
    power: Array
    work: Array
    start: Array
    bristles: NDArray[np.float32] | None
    reason: str
    totals: dict[str, float]
    evaluations: int
    counts: Mapping[str, int] = field(default_factory=dict)

    def __repr__(self) -> str:
        title = f"<Walk of {self.foot.name} on {self.scene.title}"
        if not self.feasible:
            return f"{title}: failed, {self.reason}>"
        values = (
            f"{name.replace('_', ' ')} {value:.4g} {OBJECTIVES[name].unit}".rstrip()
            for name, value in self.objectives.items()
            if np.isfinite(value)
        )
        return f"{title}: {'; '.join(values)}>"

    @property
    def feasible(self) -> bool:
        """Whether the walk succeeded."""
        return not self.reason

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of its feet."""
        count = self.force.shape[1]
        return SIDES.get(count, tuple(str(foot) for foot in range(count)))

    @property
    def objectives(self) -> dict[str, float]:
        """All objectives by name, in natural signs; NaN for a failed walk."""
        raw = {name: np.array([value if self.feasible else np.nan]) for name, value in self.totals.items()}
        names = [name for name in offered(self.scene) if name in OBJECTIVES]
        return {name: float(OBJECTIVES[name].value(raw, self.scene)[0]) for name in names}

    def measures(self, names: Sequence[str]) -> dict[str, float]:
        """Any measures by name (`footopt.walk.objectives.MEASURES`), natural signs; NaN for a failed walk."""
        raw = self.objectives
        return {m.name: raw[m.name] if m.of == "raw" else self.measured(m) for m in lookup(names, self.scene)}

    def measured(self, measure: Objective) -> float:
        """One that is measured in Python; NaN for a failed walk."""
        if not self.feasible:
            return math.nan
        return float(measure.value(self.foot if measure.of == "foot" else self))

    @property
    def variables(self) -> dict[str, tuple[tuple[str, ...], str, Array]]:
        """Everything traced, by the names that files give it: names of its dimensions, unit, values."""
        return {
            "t": (("time",), "s", self.t),
            "com": (("time", "axis"), "m", self.com),
            "velocity": (("time", "axis"), "m s-1", self.velocity),
            "force": (("time", "foot", "axis"), "N", self.force),
            "power": (("time", "foot"), "W", self.power),
            "work": (("time", "foot"), "J", self.work),
            "start": (("axis",), "m", self.start),
            "sole": (("point", "axis"), "m", self.foot.contour),
        }

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row for each sample of the traces, indexed by time, s.

        Columns are com_x, velocity_z, force_left_x, power_right and so on; units are in
        ``frame.attrs["units"]``.
        """
        import pandas

        columns, units, named = {}, {}, {"foot": self.sides, "axis": ("x", "z")}
        for name, (dimensions, unit, values) in self.variables.items():
            if dimensions[0] == "time" and name != "t":
                for place in np.ndindex(values.shape[1:]):
                    words = [named[d][i] for d, i in zip(dimensions[1:], place, strict=True)]
                    column = "_".join([name, *words])
                    columns[column], units[column] = values[(slice(None), *place)], unit
        frame = pandas.DataFrame(columns, index=pandas.Index(self.t, name="t"))
        frame.attrs["units"] = {"t": "s"} | units
        return frame

    def plates(self, index: ArrayLike) -> PlateStates:
        """Every plate's place, motion and force at some samples, by the walk's own law."""
        i = np.atleast_1d(index)
        bristles = None if self.bristles is None else self.bristles[i].astype(np.float64)
        constants = self.world.constants(self.accuracy)
        hip, speed = (self.com[i], self.velocity[i]), self.transition_speed
        return plate_states(self.sole, self.pose(i), *hip, constants, speed, bristles=bristles)

    @property
    def transition_speed(self) -> float:
        """The speed over which motion turns a plate's direction at an instant, m/s."""
        constants = self.world.constants(self.accuracy)
        return float(transition_speed_of(constants.bristle_length, constants, 0.0))

    @property
    def world(self) -> Any:
        """The `Scene` of the walk's sand, effects and gravity."""
        return self.scene

    def pose(self, index: ArrayLike) -> Pose:
        """Both feet from the COM at some samples."""
        path = self.world.path
        return path.gait.pose(self.t[np.asarray(index)], path.l1, path.l2)

    def camera(self) -> AbstractContextManager[Any]:
        """A context with a `footopt.mujoco.traces.Camera` of what walks, None where there is none."""
        return nullcontext()

    def legs(self, t: ArrayLike) -> Array:
        """Hip, knee and ankle of both legs at times (M,), linear between samples: (M, 2 feet, 3, 2), m."""
        t, walker = np.asarray(t, float), self.world.walker
        hip = np.stack([np.interp(t, self.t, self.com[:, axis]) for axis in range(2)], axis=-1)
        (thigh, _), (shank, _), _ = self.world.gait.angles(t)

        def segment(length: float, angle: Array) -> Array:  # hangs at an angle from the vertical, + forward
            return length * np.stack([np.sin(angle), -np.cos(angle)], axis=-1)

        top = np.broadcast_to(hip[:, None], (*thigh.shape, 2))
        knee = top + segment(walker.l1, thigh)
        return np.stack([top, knee, knee + segment(walker.l2, shank)], axis=2)

    def pitch(self, t: ArrayLike) -> Array:
        """Pitch of both feet at times (M,): (M, 2 feet), rad."""
        return self.world.gait.angles(np.asarray(t, float))[2][0]

    @property
    def sole(self) -> Plates:
        """The plates of its sole, as they were in the sand."""
        return self.foot.plates(self.accuracy.plates, self.accuracy.rule, reshaping(self.world.effects))


class Stance(NamedTuple):
    """A foot's contact at a heel strike, as samples of a walk."""

    first: int
    last: int
    dragged: bool  # the foot was in the sand long before, so that `first` is the heel strike


def stance(walk: Walk) -> Stance | None:
    """From touch-down to push-off of the right foot's first step; None if it never stood.

    The foot reaches the sand before the gait's nominal heel strike, so the contact is followed back
    from there. On soft sand, where a foot drags through its swing, there is no touch-down within a
    quarter of a stride, and the step begins at the heel strike.
    """
    if not len(walk.scene.strikes) or walk.force.shape[1] <= RIGHT:
        return None
    strike, quarter = walk.scene.strikes[0], walk.scene.stride / 4.0
    on = walk.force[:, RIGHT, 1] > LEAST_LOAD * walk.scene.weight
    after = np.flatnonzero(on & (walk.t >= strike - 1e-9))
    if len(after) == 0:
        return None
    at, off = int(after[0]), np.concatenate([[-1], np.flatnonzero(~on), [len(on)]])
    behind = int(np.searchsorted(off, at))
    first, last = int(off[behind - 1]) + 1, int(off[behind]) - 1
    dragged = bool(walk.t[first] < strike - quarter)
    return Stance(at if dragged else first, last, dragged)
