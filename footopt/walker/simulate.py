"""`simulate`, one foot with full traces, and `evaluate`, many feet with objectives only."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.errors import SettingError, check
from footopt.foot import Foot, Plates, Waypoints, as_plates
from footopt.sand import affine_direction
from footopt.walker.kernels import EVALUATIONS, LANES, PLATES, REPEATS, RESCUES, World
from footopt.walker.loop import BACKWARD, DIVERGED, OK, RAW, SUNK, TRACE, walk_range
from footopt.walker.objectives import FIVE, OBJECTIVES, Raw, lookup
from footopt.walker.scene import Accuracy, Scene
from footopt.walker.steppers import STEPPERS

Array = NDArray[np.float64]

#: Why a walk failed, by the loop's status.
REASONS = {OK: "", SUNK: "sunk", BACKWARD: "backward", DIVERGED: "diverged"}

NEWTON = 3e-3  # last step of Newton's method over the plates' mean speed; the forces' error is the square
REST = 4  # longer steps while the walker stands
MAX_REPEATS = 3  # of a walk that diverged, each with a quarter of the time step before
CHUNK = 4096  # designs whose plates are in memory at once
BLOCK = 16  # designs that a thread takes at a time


@dataclass(frozen=True)
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
    repeats: NDArray[np.int64]
    scene: Scene

    def __len__(self) -> int:
        return len(self.values)

    def column(self, name: str) -> Array:
        """Any objective by name, (designs,), whether it is among `names` or not.

        `maximum_sinkage` must have been asked for in `evaluate`.
        """
        return OBJECTIVES[lookup([name])[0].name].value(Raw(self.raw), self.scene)

    @property
    def efficiency(self) -> Array:
        """The paper's scalar J_W, (designs,); most negative is best."""
        return self.column("efficiency")


@dataclass(frozen=True, eq=False)
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
    evaluations : of the contact. rescues : stages that Newton's method alone could not solve.
    repeats : how often the walk was repeated with a quarter of the time step, see `Table`.
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
    repeats: int

    @property
    def feasible(self) -> bool:
        """Whether the walk succeeded."""
        return not self.reason

    @property
    def objectives(self) -> dict[str, float]:
        """All objectives by name, in natural signs; NaN for a failed walk."""
        raw = Raw(np.array([[self.totals[name] if self.feasible else np.nan for name in RAW]]))
        return {name: float(o.value(raw, self.scene)[0]) for name, o in OBJECTIVES.items()}

    def plates(self, index: ArrayLike) -> PlateStates:
        """Every plate's place, motion and force at some samples, by the law in its readable form."""
        i = np.asarray(index)
        pose = self.scene.gait.pose(self.t[i], self.scene.walker.l1, self.scene.walker.l2)
        sole = self.foot.plates(self.accuracy.plates, self.accuracy.rule)
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
        chord = np.diff(self.foot.points(self.accuracy.plates), axis=0)
        beta = np.arctan2(chord[:, 1], chord[:, 0]) + pose.pitch[..., None]
        c2p, s2p = np.cos(2.0 * pose.pitch)[..., None], np.sin(2.0 * pose.pitch)[..., None]
        c, s = sole.c2[0] * c2p - sole.s2[0] * s2p, sole.s2[0] * c2p + sole.c2[0] * s2p
        a, m = affine_direction(c, s, self.scene.sand.stress_map)
        speed = np.sqrt(np.sum(velocity**2, axis=-1) + self.accuracy.creep**2)
        h = velocity / speed[..., None]
        pull = self.scene.sand.zeta * np.maximum(-position[..., 1], 0.0) * sole.area[0]
        force = pull[..., None] * (a - np.einsum("...ij,...j->...i", m, h))
        normal = np.stack([np.sin(beta), -np.cos(beta)], axis=-1)
        return PlateStates(position, velocity, force, normal, sole.area[0])


@dataclass(frozen=True)
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
    scene, accuracy = scene or Scene(), resolve(accuracy)
    plates = foot.plates(accuracy.plates, accuracy.rule)
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
        repeats=int(tallies[0, REPEATS]),
    )


def evaluate(
    feet: Sequence[Foot] | Plates | ArrayLike,
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
    feet : a sequence of `Foot`; or waypoint heights (designs, n) in `space` (default: the paper's).
    scene, accuracy : as in `simulate`.
    objectives : names from `footopt.walker.objectives.OBJECTIVES`.
    threads : how many to use; by default as many as the process may run on.

    Returns
    -------
    Table : with ``values`` (designs, objectives) in natural signs.
    """
    scene, accuracy = scene or Scene(), resolve(accuracy)
    scene.need_heel_strike()
    chosen = lookup(objectives)
    sink = "maximum_sinkage" in objectives
    parts = [_walk(plates, scene, accuracy, sink, threads)[:3] for plates in _chunks(feet, accuracy, space)]
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
        repeats=tallies[:, REPEATS],
        scene=scene,
    )


def estimate_error(
    foot: Foot, scene: Scene | None = None, accuracy: Accuracy | str = "standard"
) -> dict[str, float]:
    """Error estimate of a walk's objectives by refinement, absolute, in their own units.

    The difference to the walk with half the time step, twice the plates and half the creep speed,
    times 4/3: what is left of an error that falls with the square of the first two. NaN where the
    walk or its refinement fails.
    """
    scene, accuracy = scene or Scene(), resolve(accuracy)
    finer = replace(
        accuracy, dt=accuracy.dt / 2, plates=2 * accuracy.plates, creep=accuracy.creep / 2, name="refined"
    )
    coarse, fine = (simulate(foot, scene, a).objectives for a in (accuracy, finer))
    return {name: 4.0 / 3.0 * abs(coarse[name] - fine[name]) for name in coarse}


def resolve(accuracy: Accuracy | str) -> Accuracy:
    """An accuracy, given itself or a preset's name."""
    return Accuracy.named(accuracy) if isinstance(accuracy, str) else accuracy


def world(scene: Scene, accuracy: Accuracy) -> World:
    """What the compiled loops need to know of a scene."""
    law = (scene.sand.stiffness * c for c in scene.sand.stress_map.law)
    # floats throughout: a whole number would be another type, and compile the loop again
    return World._make(map(float, (*law, scene.walker.mass, scene.walker.g, accuracy.creep, NEWTON)))


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


@lru_cache(maxsize=16)
def poses(scene: Scene, accuracy: Accuracy) -> tuple[Array, Array, Array]:
    """Time grid, pose at t = 0, (2, 7), and at every step's nodes, (steps, nodes, 2, 7)."""
    times, nodes = time_grid(scene, accuracy), np.asarray(STEPPERS[accuracy.stepper].nodes)
    t = times[:-1, None] + np.diff(times)[:, None] * nodes
    pose = partial(scene.gait.pose, l1=scene.walker.l1, l2=scene.walker.l2)
    return times, pose(np.zeros(1)).table()[0], pose(t.ravel()).table().reshape(*t.shape, 2, 7)


def available_threads() -> int:
    """How many processors this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _chunks(feet: Any, accuracy: Accuracy, space: Waypoints | None) -> Iterator[Plates]:
    """The feet's plates, a bounded number of designs at a time."""
    if isinstance(feet, Plates):
        yield from (feet.take(slice(i, i + CHUNK)) for i in range(0, len(feet.x), CHUNK))
        return
    if not isinstance(feet, Sequence):
        feet = np.atleast_2d(np.asarray(feet))
    if len(feet) == 0:
        raise SettingError("feet", "[]", "at least one foot")
    yield from (
        as_plates(feet[i : i + CHUNK], accuracy.plates, accuracy.rule, space)
        for i in range(0, len(feet), CHUNK)
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
        if len(again) == 0:
            break
        finer = replace(accuracy, dt=accuracy.dt / 4**repeat)
        raw[again], status[again], more, trace = _run(plates.take(again), scene, finer, sink, threads, traced)
        tallies[again] += more
        tallies[again, REPEATS] = repeat
    return raw, status, tallies, trace


def _run(
    plates: Plates, scene: Scene, accuracy: Accuracy, sink: bool, threads: int | None, traced: bool
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64], Array]:
    """`_walk` once, with the given time step."""
    stepper, designs = STEPPERS[accuracy.stepper], len(plates.x)
    times, pose0, table = poses(scene, accuracy)
    padded, circles, reach = _blocks(plates)
    raw = np.empty((designs, len(RAW)))
    status, tallies = np.empty(designs, np.int64), np.zeros((designs, 4), np.int64)
    trace = np.full((len(table) + 1, TRACE), np.nan) if traced else None
    constants = world(scene, accuracy)

    def run(begin: int) -> None:
        end = min(begin + BLOCK, designs)
        walk_range(
            stepper.parameters, padded, circles, reach, constants, pose0, table, times,
            scene.gait.heel_strike, begin, end, raw, status, tallies, trace, 1 if sink else None,
        )  # fmt: skip

    workers = available_threads() if threads is None else threads
    check(workers >= 1, "engine.threads", threads, "a whole number >= 1 (null: all)")
    blocks = range(0, designs, BLOCK)
    if workers == 1 or len(blocks) == 1:
        for begin in blocks:
            run(begin)
    else:
        with ThreadPoolExecutor(min(workers, len(blocks))) as pool:
            list(pool.map(run, blocks))
    return raw, status, tallies, np.empty(0) if trace is None else trace


def _blocks(plates: Plates) -> tuple[tuple[Array, ...], tuple[Array, ...], Array]:
    """Plates in whole blocks (the last one repeated without area), a circle around each, the reach."""
    designs, count = plates.x.shape
    extra = -count % LANES
    columns = [np.pad(column, ((0, 0), (0, extra)), mode="edge") for column in plates]
    if extra:
        columns[-1][:, -extra:] = 0.0
    x, z = (column.reshape(designs, -1, LANES) for column in columns[:2])
    centre_x, centre_z = (0.5 * (q.min(axis=2) + q.max(axis=2)) for q in (x, z))
    square = (x - centre_x[..., None]) ** 2 + (z - centre_z[..., None]) ** 2
    radius = np.sqrt(square.max(axis=2))
    reach = np.sqrt(np.max(plates.x**2 + plates.z**2, axis=1))
    return tuple(map(np.ascontiguousarray, columns)), (centre_x, centre_z, radius), reach
