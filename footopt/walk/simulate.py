"""`simulate`, one foot with full traces, and `evaluate`, many feet with objectives only."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.effects import base as effects
from footopt.errors import SettingError, check, check_kind, needed
from footopt.foot import Foot, Plates, Waypoints, as_plates
from footopt.foot.plates import RULES
from footopt.sand import affine_direction
from footopt.walk.contact import EVALUATIONS, LANES, PLATES, REPEATS, RESCUES, SHORTENED, TALLY, Sole, World
from footopt.walk.loop import BACKWARD, DIVERGED, OK, RAW, SUNK, TRACE, walk_range
from footopt.walk.objectives import FIVE, OBJECTIVES, Raw, lookup
from footopt.walk.scene import MOST_PLATES, Accuracy, Scene, Walker
from footopt.walk.steppers import STEPPERS

Array = NDArray[np.float64]

#: Why a walk failed, by the loop's status.
REASONS = {OK: "", SUNK: "sunk", BACKWARD: "backward", DIVERGED: "diverged"}

NEWTON = 3e-3  # last step of Newton's method over the plates' mean speed; the forces' error is the square
REST = 4  # longer steps while the walker stands
HALVINGS = 3  # of a step under control, at most
MAX_REPEATS = 3  # of a walk that diverged, each with a quarter of the time step before
CHUNK = 4096  # designs whose plates are in memory at once
POINTS = 4_000_000  # along their soles, at most
ROWS = 5_000_000  # poses of a walk that are tabulated, 112 bytes each; ten minutes take 2.6 million
BLOCK = 16  # designs that a thread takes at a time
POSES = 64  # motions whose poses are kept: about 1 MB each, and the time of a few dozen walks
LONG = ROWS // POSES  # poses of a motion of which only `LONG_ONES` are kept
LONG_ONES = 2


@dataclass(frozen=True, eq=False, repr=False)
class Table:
    """Objectives of many feet, in natural signs.

    Parameters
    ----------
    values : (designs, objectives); a row of NaN for a failed walk.
    names : of the objectives.
    feasible : (designs,), whether the walk succeeded.
    reasons : (designs,), "" or why it failed: sunk, backward, diverged.
    raw : (designs, ...), the loop's own results.
    evaluations, plates : (designs,), of the contact, and plates in them.
    rescues : (designs,), implicit stages that Newton's method alone could not solve.
    shortened : (designs,), steps under control that were repeated with half their length.
    repeats : (designs,), how often the walk was repeated with a quarter of the time step because a
        step could not be solved or a state was not finite.
    scene : what was walked through.
    """

    values: Array
    names: tuple[str, ...]
    feasible: NDArray[np.bool_]
    reasons: NDArray[np.str_]
    raw: Array
    evaluations: NDArray[np.int64]
    plates: NDArray[np.int64]
    rescues: NDArray[np.int64]
    shortened: NDArray[np.int64]
    repeats: NDArray[np.int64]
    scene: Scene

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        title, walked = f"<Table of {len(self)} feet on {self.scene.sand.name} sand", int(self.feasible.sum())
        return f"{title}: {walked} walked; {', '.join(self.names)}>"

    def column(self, name: str) -> Array:
        """Any objective by name, (designs,), whether it is among `names` or not.

        `maximum_sinkage` must have been asked for in `evaluate`.
        """
        return OBJECTIVES[lookup([name])[0].name].value(Raw(self.raw), self.scene)

    @property
    def efficiency(self) -> Array:
        """The paper's scalar J_W, (designs,); most negative is best."""
        return self.column("efficiency")

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row for each foot: its objectives, `feasible` and `reason`.

        Units are in ``frame.attrs["units"]``. Needs pandas: ``pip install "footopt[pandas]"``.
        """
        pandas = needed("pandas", "Table.to_frame", "pandas")
        columns = dict(zip(self.names, self.values.T, strict=True))
        frame = pandas.DataFrame(columns | {"feasible": self.feasible, "reason": self.reasons.astype(object)})
        frame.attrs["units"] = {name: OBJECTIVES[name].unit for name in self.names}
        return frame.rename_axis("foot")


@dataclass(frozen=True, eq=False, repr=False)
class Walk:
    """One simulated walk: traces at the end of every step, T of them, and what they add up to.

    Parameters
    ----------
    t : (T,), s; the first is the end of the first step: exactly at rest the smoothed force is 3/8
        of the one that carries the weight.
    com, velocity : (T, 2), hip position (m) and velocity (m/s) in x, z.
    force : (T, 2 feet, 2), N, of the sand on the left and the right foot.
    power, work : (T, 2 feet), W and J; negative where the sand takes energy.
    start : (2,), hip at t = 0, m.
    reason : "" or why the walk failed (then the traces end there).
    totals : the loop's own results by name (`loop.RAW`), by the stepper's own quadrature.
    evaluations, rescues, shortened, repeats : what the walk took, see `Table`.
    """

    foot: Foot
    scene: Scene
    accuracy: Accuracy
    t: Array
    com: Array
    velocity: Array
    force: Array
    power: Array
    work: Array
    start: Array
    reason: str
    totals: dict[str, float]
    evaluations: int
    rescues: int
    shortened: int
    repeats: int

    def __repr__(self) -> str:
        title = f"<Walk of {self.foot.name} on {self.scene.sand.name} sand"
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
    def objectives(self) -> dict[str, float]:
        """All objectives by name, in natural signs; NaN for a failed walk."""
        raw = Raw(np.array([[self.totals[name] if self.feasible else np.nan for name in RAW]]))
        return {name: float(o.value(raw, self.scene)[0]) for name, o in OBJECTIVES.items()}

    @property
    def variables(self) -> dict[str, Variable]:
        """Everything traced, by the names that files give it."""
        return {
            "t": Variable(("time",), "s", self.t),
            "com": Variable(("time", "axis"), "m", self.com),
            "velocity": Variable(("time", "axis"), "m s-1", self.velocity),
            "force": Variable(("time", "foot", "axis"), "N", self.force),
            "power": Variable(("time", "foot"), "W", self.power),
            "work": Variable(("time", "foot"), "J", self.work),
            "start": Variable(("axis",), "m", self.start),
            "sole": Variable(("point", "axis"), "m", self.foot.contour),
        }

    def to_dataset(self) -> Any:
        """An xarray Dataset with the variables of walk.nc; times (s), feet and axes select by their names.

        Units are in each variable's attributes. Needs xarray: ``pip install "footopt[xarray]"``.
        """
        xarray = needed("xarray", "Walk.to_dataset", "xarray")
        parts = self.variables
        t = parts.pop("t")
        times = {name: ("time", t.values, {"units": t.unit}) for name in ("time", "t")}
        return xarray.Dataset(
            {name: (v.dimensions, v.values, {"units": v.unit}) for name, v in parts.items()},
            times | {name: list(places) for name, places in PLACES.items()},
            {"reason": self.reason},
        )

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row for each sample of the traces, indexed by time, s.

        Columns are com_x, velocity_z, force_left_x, power_right and so on; units are in
        ``frame.attrs["units"]``. Needs pandas: ``pip install "footopt[pandas]"``.
        """
        pandas = needed("pandas", "Walk.to_frame", "pandas")
        columns, units = {}, {}
        for name, (dimensions, unit, values) in self.variables.items():
            if dimensions[0] == "time" and name != "t":
                for place in np.ndindex(values.shape[1:]):
                    words = [PLACES[d][i] for d, i in zip(dimensions[1:], place, strict=True)]
                    column = "_".join([name, *words])
                    columns[column], units[column] = values[(slice(None), *place)], unit
        frame = pandas.DataFrame(columns, index=pandas.Index(self.t, name="t"))
        frame.attrs["units"] = {"t": "s"} | units
        return frame

    def plates(self, index: ArrayLike) -> PlateStates:
        """Every plate's place, motion and force at some samples, by the law in its readable form."""
        i = np.asarray(index)
        pose = self.scene.gait.pose(self.t[i], self.scene.walker.l1, self.scene.walker.l2)
        sole = self.foot.plates(self.accuracy.plates, self.accuracy.rule, directed=True)
        assert sole.tx is not None, "asked for"
        assert sole.tz is not None, "asked for"
        cos, sin = np.cos(pose.pitch)[..., None], np.sin(pose.pitch)[..., None]
        rx, rz = cos * sole.x[0] - sin * sole.z[0], sin * sole.x[0] + cos * sole.z[0]
        position = np.stack(
            [
                (self.com[i, 0, None] + pose.x)[..., None] + rx,
                (self.com[i, 1, None] + pose.z)[..., None] + rz,
            ],
            axis=-1,
        )
        velocity = np.stack(
            [
                (self.velocity[i, 0, None] + pose.vx)[..., None] - pose.rate[..., None] * rz,
                (self.velocity[i, 1, None] + pose.vz)[..., None] + pose.rate[..., None] * rx,
            ],
            axis=-1,
        )
        tx, tz = cos * sole.tx[0] - sin * sole.tz[0], sin * sole.tx[0] + cos * sole.tz[0]
        normal = np.stack([tz, -tx], axis=-1)
        c2p, s2p = np.cos(2.0 * pose.pitch)[..., None], np.sin(2.0 * pose.pitch)[..., None]
        c, s = sole.c2[0] * c2p - sole.s2[0] * s2p, sole.s2[0] * c2p + sole.c2[0] * s2p
        a, m = affine_direction(c, s, self.scene.sand.stress_map)
        speed = np.sqrt(np.sum(velocity**2, axis=-1) + self.accuracy.creep**2)
        h = velocity / speed[..., None]
        depth = np.maximum(-position[..., 1], 0.0)
        into = np.sum(normal * velocity, axis=-1)
        load, share, push = effects.readable(
            self.scene.effects, depth, position[..., 0], into, self.accuracy.creep
        )
        pull = self.scene.sand.zeta * load * share * sole.area[0]
        force = pull[..., None] * (a - np.einsum("...ij,...j->...i", m, h))
        force = force - (push * sole.area[0])[..., None] * normal
        return PlateStates(position, velocity, force, normal, sole.area[0])


class Variable(NamedTuple):
    """A traced quantity: the names of its dimensions, its unit, its values."""

    dimensions: tuple[str, ...]
    unit: str
    values: Array


#: What the places along a dimension are called.
PLACES = {"foot": ("left", "right"), "axis": ("x", "z")}


@dataclass(frozen=True, eq=False)
class PlateStates:
    """Plates of both feet at M samples; vectors are (M, 2 feet, N, 2), in x, z."""

    position: Array  # m
    velocity: Array  # m/s
    force: Array  # N
    normal: Array  # outward, into the sand
    area: Array  # (N,), m^2


def simulate(foot: Foot, scene: Scene | None = None, accuracy: Accuracy | str = "standard") -> Walk:
    """Walk through a scene with one foot, keeping full traces.

    Parameters
    ----------
    foot : the sole. scene : the paper's walk on hard sand by default.
    accuracy : an `Accuracy` or a preset's name.

    Returns
    -------
    Walk : also of a walk that failed; see its `reason`.
    """
    check_kind(foot, Foot, "foot", "Try fo.Foot.from_waypoints(heights)")
    scene, accuracy = _scene(scene), resolve(accuracy)
    directed = effects.laws(scene.effects).directed
    plates = foot.plates(accuracy.plates, accuracy.rule, directed)
    raw, status, tallies, trace = _walk(plates, scene, accuracy, sink=True, threads=1, traced=True)
    rows = trace[1:][np.isfinite(trace[1:]).all(axis=1)]
    force = np.stack([rows[:, 5:7], rows[:, 9:11]], axis=1)
    return Walk(
        foot=foot,
        scene=scene,
        accuracy=accuracy,
        t=rows[:, 0],
        com=rows[:, 1:3],
        velocity=rows[:, 3:5],
        force=force,
        power=rows[:, [7, 11]],
        work=rows[:, [8, 12]],
        start=trace[0, 1:3],
        reason=REASONS[int(status[0])],
        totals=dict(zip(RAW, map(float, raw[0]), strict=True)),
        evaluations=int(tallies[0, EVALUATIONS]),
        rescues=int(tallies[0, RESCUES]),
        shortened=int(tallies[0, SHORTENED]),
        repeats=int(tallies[0, REPEATS]),
    )


def evaluate(
    feet: Foot | Sequence[Foot] | Plates | ArrayLike,
    scene: Scene | None = None,
    accuracy: Accuracy | str = "standard",
    objectives: Sequence[str] = FIVE,
    space: Waypoints | None = None,
    threads: int | None = None,
) -> Table:
    """Walk through a scene with many feet, keeping objectives only: the fast path.

    A design's result does not depend on the others in the batch or on the number of threads.

    Parameters
    ----------
    feet : a `Foot` or a sequence of them; or waypoint heights (designs, n) in `space` (default: the
        paper's).
    scene, accuracy : as in `simulate`.
    objectives : names from `footopt.walk.objectives.OBJECTIVES`.
    threads : how many to use; by default as many as the process may run on.

    Returns
    -------
    Table : with ``values`` (designs, objectives) in natural signs.
    """
    scene, accuracy = _scene(scene), resolve(accuracy)
    if isinstance(feet, Foot):
        feet = [feet]
    scene.need_heel_strike()
    chosen = lookup(objectives)
    sink = "maximum_sinkage" in objectives
    chunks = _chunks(feet, scene, accuracy, space)
    parts = [_walk(plates, scene, accuracy, sink, threads)[:3] for plates in chunks]
    raw, status, tallies = (np.concatenate(column) for column in zip(*parts, strict=True))
    raw[status != OK] = np.nan
    if not sink:
        raw[:, RAW.index("maximum_sinkage")] = np.nan
    values = np.stack([o.value(Raw(raw), scene) for o in chosen], axis=1)
    reasons = np.array([REASONS[int(s)] for s in status], dtype=np.str_)
    return Table(
        values=values,
        names=tuple(objectives),
        feasible=status == OK,
        reasons=reasons,
        raw=raw,
        evaluations=tallies[:, EVALUATIONS],
        plates=tallies[:, PLATES],
        rescues=tallies[:, RESCUES],
        shortened=tallies[:, SHORTENED],
        repeats=tallies[:, REPEATS],
        scene=scene,
    )


def _scene(scene: Scene | None) -> Scene:
    """The paper's walk on hard sand where there is none."""
    found = Scene() if scene is None else scene
    check_kind(found, Scene, "scene", "Try fo.Scene(sand=...)")
    return found


def estimate_error(
    foot: Foot, scene: Scene | None = None, accuracy: Accuracy | str = "standard"
) -> dict[str, float]:
    """Error estimate of a walk's objectives by refinement, absolute, in their own units.

    The difference to the walk with half the time step (under control: an eighth of the error that a
    step may have), twice the plates and half the creep speed, times 4/3: what is left of an error that
    falls with the square of the first two. NaN where the walk or its refinement fails, and for a walk
    that is too long to be refined (`ROWS`).
    """
    scene, accuracy = scene or Scene(), resolve(accuracy)
    finer = replace(
        accuracy,
        dt=accuracy.dt / 2,
        control=None if accuracy.control is None else accuracy.control / 8,
        plates=min(2 * accuracy.plates, MOST_PLATES),
        creep=accuracy.creep / 2,
        name="refined",
    )
    if pose_rows(scene, finer) > ROWS:
        return dict.fromkeys(OBJECTIVES, math.nan)
    coarse, fine = (simulate(foot, scene, a).objectives for a in (accuracy, finer))
    return {name: 4.0 / 3.0 * abs(coarse[name] - fine[name]) for name in coarse}


def resolve(accuracy: Accuracy | str) -> Accuracy:
    """An accuracy, given itself or a preset's name."""
    return Accuracy.named(accuracy) if isinstance(accuracy, str) else accuracy


def world(scene: Scene, accuracy: Accuracy) -> World:
    """What the compiled loops need to know of a scene."""
    law = scene.sand.stress_map.law._asdict()
    tilt, g = scene.gravity
    laws = effects.laws(scene.effects)
    # floats throughout: a whole number would be another type, and compile the loop again
    return World(
        **{name: float(scene.sand.stiffness * c) for name, c in law.items()},
        mass=float(scene.walker.mass),
        g=float(g),
        tilt=None if tilt is None else float(tilt),
        creep=float(accuracy.creep),
        tolerance=NEWTON,
        loads=laws.loads,
        gates=laws.gates,
        pushes=laws.pushes,
    )


def time_grid(scene: Scene, accuracy: Accuracy) -> Array:
    """Ends of the time steps, (steps + 1,), s, from 0 to t_f.

    While the walker stands, before the gait starts, implicit steps are `REST` times as long: nothing
    happens that a longer one would miss. Each part is t0 + k (t1 - t0)/n: adding steps would drift.
    """
    start, t_f = scene.gait.start, scene.duration
    if not (STEPPERS[accuracy.stepper].implicit and 0.0 < start < t_f):
        steps = accuracy.steps(t_f)
        return t_f * np.arange(steps + 1) / steps
    standing = math.ceil(start / (REST * accuracy.dt) - 1e-9)
    walking = accuracy.steps(t_f - start)
    return np.concatenate(
        [
            start * np.arange(standing) / standing,
            start + (t_f - start) * np.arange(walking + 1) / walking,
        ]
    )


def pose_rows(scene: Scene, accuracy: Accuracy) -> float:
    """How many poses a walk needs (`poses`), about."""
    levels = 1 if accuracy.control is None else 2 ** (HALVINGS + 1) - 1
    return scene.duration / accuracy.dt * levels * len(STEPPERS[accuracy.stepper].nodes)


def poses(scene: Scene, accuracy: Accuracy) -> tuple[Array, Array, tuple[Array, ...]]:
    """Time grid, pose at t = 0, (2, 7), and at every step's nodes, (steps, nodes, 2, 7).

    Under control of the step there is a table more for each halving, with twice as many steps.
    """
    # the same for every sand, mass and effect
    if pose_rows(scene, accuracy) > ROWS:
        least = accuracy.dt * pose_rows(scene, accuracy) / ROWS
        raise SettingError(
            "accuracy.dt",
            accuracy.dt,
            f"at least {least:.2g} s for a walk of {scene.duration:g} s",
            "Or shorten the walk: scene.t_f, gait.period, gait.start.",
        )
    motion = Scene(gait=scene.gait, walker=Walker(l1=scene.walker.l1, l2=scene.walker.l2), t_f=scene.t_f)
    kept = long_pose_tables if pose_rows(scene, accuracy) > LONG else pose_tables
    return kept(motion, Accuracy(accuracy.stepper, accuracy.dt, control=accuracy.control))


def _pose_tables(scene: Scene, accuracy: Accuracy) -> tuple[Array, Array, tuple[Array, ...]]:
    times, nodes = time_grid(scene, accuracy), np.asarray(STEPPERS[accuracy.stepper].nodes)
    pose = partial(scene.gait.pose, l1=scene.walker.l1, l2=scene.walker.l2)
    tables = []
    for level in range(1 if accuracy.control is None else 1 + HALVINGS):
        parts = (np.arange(2**level)[:, None] + nodes) / 2**level
        t = (times[:-1, None, None] + np.diff(times)[:, None, None] * parts).ravel()
        tables.append(pose(t).table().reshape(-1, len(nodes), 2, 7))
    return times, pose(np.zeros(1)).table()[0], tuple(tables)


pose_tables = lru_cache(maxsize=POSES)(_pose_tables)
long_pose_tables = lru_cache(maxsize=LONG_ONES)(_pose_tables)


def available_threads() -> int:
    """How many processors this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def at_once(given: int | None, setting: str = "engine.threads") -> int:
    """How many threads or workers there are to be; None: as many as the process may run on."""
    check(given is None or 1 <= given <= 4096, setting, given, "a whole number >= 1 and <= 4096 (null: all)")
    return available_threads() if given is None else given


def _chunks(feet: Any, scene: Scene, accuracy: Accuracy, space: Waypoints | None) -> Iterator[Plates]:
    """The feet's plates, a bounded number of designs at a time."""
    directed = effects.laws(scene.effects).directed
    if isinstance(feet, Plates):
        if directed and feet.tx is None:
            raise SettingError("feet", "plates without directions", "plates made with directed=True")
        yield from (feet.take(slice(i, i + CHUNK)) for i in range(0, len(feet.x), CHUNK))
        return
    size = max(1, min(CHUNK, POINTS // (accuracy.plates * RULES[accuracy.rule])))
    if not isinstance(feet, Sequence):
        feet = np.atleast_2d(np.asarray(feet))
    if len(feet) == 0:
        raise SettingError("feet", "[]", "at least one foot")
    yield from (
        as_plates(feet[i : i + size], accuracy.plates, accuracy.rule, space, directed)
        for i in range(0, len(feet), size)
    )


def _walk(
    plates: Plates,
    scene: Scene,
    accuracy: Accuracy,
    sink: bool,
    threads: int | None,
    traced: bool = False,
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64], Array]:
    """Run the compiled loop over a batch: raw results, status, tallies, and the trace of one design.

    Walks that diverge are repeated with a quarter of the time step, `MAX_REPEATS` times at most.
    """
    raw, status, tallies, trace = _run(plates, scene, accuracy, sink, threads, traced)
    for repeat in range(1, MAX_REPEATS + 1):
        again = np.flatnonzero(status == DIVERGED)
        finer = replace(accuracy, dt=accuracy.dt / 4**repeat)
        if len(again) == 0 or pose_rows(scene, finer) > ROWS:
            break
        raw[again], status[again], more, trace = _run(plates.take(again), scene, finer, sink, threads, traced)
        tallies[again] += more
        tallies[again, REPEATS] = repeat
    return raw, status, tallies, trace


def _run(
    plates: Plates, scene: Scene, accuracy: Accuracy, sink: bool, threads: int | None, traced: bool
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64], Array]:
    """`_walk` once, with the given time step."""
    stepper, designs = STEPPERS[accuracy.stepper], len(plates.x)
    times, pose0, tables = poses(scene, accuracy)
    padded, circles, reach = _blocks(plates)
    tangents = _tangents(plates)
    raw = np.empty((designs, len(RAW)))
    status, tallies = np.empty(designs, np.int64), np.zeros((designs, TALLY), np.int64)
    trace = np.full((len(tables[-1]) + 1 if traced else 0, TRACE), np.nan)
    constants = world(scene, accuracy)

    def run(begin: int) -> None:
        end = min(begin + BLOCK, designs)
        walk_range(
            stepper.parameters, padded, circles, reach, tangents, constants, pose0, tables, times,
            accuracy.control, scene.gait.heel_strike, begin, end, raw, status, tallies, trace, sink,
        )  # fmt: skip

    workers = at_once(threads)
    blocks = range(0, designs, BLOCK)
    if workers == 1 or len(blocks) == 1:
        for begin in blocks:
            run(begin)
    else:
        with ThreadPoolExecutor(min(workers, len(blocks))) as pool:
            list(pool.map(run, blocks))
    return raw, status, tallies, trace


def _blocks(plates: Plates) -> tuple[tuple[Array, ...], tuple[Array, ...], Array]:
    """Plates in whole blocks (the last one repeated without area), a circle around each, the reach."""
    extra = -plates.x.shape[1] % LANES
    columns = [_padded(column, extra) for column in (plates.x, plates.z, plates.c2, plates.s2)]
    columns.append(_padded(plates.area, extra, 0.0))
    x, z = (column.reshape(len(column), -1, LANES) for column in columns[:2])
    centre_x, centre_z = (0.5 * (q.min(axis=2) + q.max(axis=2)) for q in (x, z))
    square = (x - centre_x[..., None]) ** 2 + (z - centre_z[..., None]) ** 2
    radius = np.sqrt(square.max(axis=2))
    reach = np.sqrt(np.max(plates.x**2 + plates.z**2, axis=1))
    return tuple(columns), (centre_x, centre_z, radius), reach


def sole(plates: Plates) -> Sole:
    """The first foot's plates as one contact takes them; the population's loop has its own."""
    columns, circles, reach = _blocks(plates)
    tangents = [None if column is None else column[0] for column in _tangents(plates)]
    return Sole._make([*(c[0] for c in (*columns, *circles)), float(reach[0]), *tangents])


def _padded(column: Array, extra: int, value: float | None = None) -> Array:
    """A column with more plates at the end: the last one again, or a value."""
    last = column[:, -1:] if value is None else np.full((len(column), 1), value)
    return np.concatenate([column, np.repeat(last, extra, axis=1)], axis=1)


def _tangents(plates: Plates) -> tuple[Array | None, Array | None]:
    """The plates' directions in whole blocks, where an effect needs them."""
    if plates.tx is None or plates.tz is None:
        return None, None
    extra = -plates.x.shape[1] % LANES
    return _padded(plates.tx, extra), _padded(plates.tz, extra)
