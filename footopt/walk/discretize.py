"""From sand, walker, gait and feet to what the compiled loop takes: world, plates, times and poses."""

from functools import lru_cache, partial, reduce
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from footopt.arrays import Array
from footopt.effects import base as effects
from footopt.errors import SettingError
from footopt.foot import Plates
from footopt.gait import Gait
from footopt.walk.accuracy import Accuracy
from footopt.walk.state import LANES, Sole, World, sole_at
from footopt.walk.steppers import STEPPERS

REST = 4  # times as long steps while the walker stands
HALVINGS = 6  # of a step under control, at most: a power that jumps has its peak at one end of the jump
TRACED = 3  # of these, those that a trace has rows for
TABLED = 2  # of these, those with tables of poses; the poses of shorter steps are between those
ROWS = 5_000_000  # most poses of a walk that are tabulated, 112 bytes each; ten minutes take 2.6 million
POSES = 64  # cached tables of poses: about half a MB each; making one takes as long as a few dozen walks
LONG = ROWS // POSES  # poses in a table above which only `LONG_ONES` are cached
LONG_ONES = 2


class Path(NamedTuple):
    """How a walk's feet move relative to the hip."""

    gait: Gait
    l1: float  # m, of a thigh
    l2: float  # m, of a shank
    t_f: float  # s, the walk's end


def with_bypassed_gates(world: World) -> World:
    """A world without gates, with those of the plausible effects, bypassed: one compiled walk serves both."""
    if world.effects.gates is not None:
        return world
    gates = _plausible_gates(tuple(effects.EFFECTS.values()))
    return world._replace(effects=world.effects._replace(gates=gates), bypass=True)


@lru_cache
def _plausible_gates(kinds: tuple[type[effects.Effect], ...]) -> tuple[Any, ...] | None:
    return effects.laws([kind() for kind in kinds if kind.plausible]).gates


def time_grid(path: Path, accuracy: Accuracy) -> Array:
    """Ends of the time steps, (steps + 1,), s, from 0 to t_f.

    While the walker stands, before the gait starts, implicit steps are `REST` times as long: nothing
    happens that a longer one would miss. Each part is t0 + k (t1 - t0)/n: adding steps would drift.
    """
    start, t_f, ends = path.gait.start, path.t_f, {0.0, path.t_f}
    if STEPPERS[accuracy.stepper].implicit and 0.0 < start < t_f:
        ends.add(start)
    parts = []
    for begin, end in pairwise(sorted(ends)):
        steps = accuracy.steps((end - begin) / (REST if start in ends and end <= start else 1))
        parts.append(begin + (end - begin) * np.arange(steps) / steps)
    return np.concatenate([*parts, [t_f]])


def pose_rows(path: Path, accuracy: Accuracy) -> float:
    """How many poses a walk needs (`poses`), about."""
    levels = 1 if accuracy.control is None else 2 ** (TABLED + 1) - 1
    return path.t_f / accuracy.dt * levels * len(STEPPERS[accuracy.stepper].nodes)


def too_many_poses(path: Path, accuracy: Accuracy) -> bool:
    """Whether a walk is too long for its poses."""
    return pose_rows(path, accuracy) > ROWS


def poses(path: Path, accuracy: Accuracy) -> tuple[Array, Array, tuple[Array, ...]]:
    """Time grid, pose at t = 0, (2, 7), and at every step's nodes, (steps, nodes, 2, 7).

    Under control of the step there is one more table for each of `TABLED` halvings, with twice as many steps.
    """
    if too_many_poses(path, accuracy):
        least = accuracy.dt * pose_rows(path, accuracy) / ROWS
        allowed = f"at least {least:.2g} s for a walk of {path.t_f:g} s"
        hint = "Or shorten the walk: scene.t_f, gait.period, gait.start."
        raise SettingError("accuracy.dt", accuracy.dt, allowed, hint)
    tables = long_pose_tables if pose_rows(path, accuracy) > LONG else pose_tables
    # the tables depend on whether there is a control, not on its value
    like = Accuracy(accuracy.stepper, accuracy.dt, control=accuracy.control and 1.0)
    return tables(path, like, STEPPERS[accuracy.stepper].nodes)


def _pose_tables(
    path: Path, accuracy: Accuracy, nodes: tuple[float, ...]
) -> tuple[Array, Array, tuple[Array, ...]]:
    times = time_grid(path, accuracy)
    pose = partial(path.gait.pose, l1=path.l1, l2=path.l2)
    tables = []
    for level in range(1 if accuracy.control is None else 1 + TABLED):
        parts = (np.arange(2**level)[:, None] + np.asarray(nodes)) / 2**level
        t = (times[:-1, None, None] + np.diff(times)[:, None, None] * parts).ravel()
        tables.append(pose(t).table().reshape(-1, len(nodes), 2, 7))
    return times, pose(np.zeros(1)).table()[0], tuple(tables)


pose_tables = lru_cache(maxsize=POSES)(_pose_tables)
long_pose_tables = lru_cache(maxsize=LONG_ONES)(_pose_tables)


def soles(plates: Plates) -> Sole:
    """Plates of all designs in whole blocks (the last one repeated without area), each in a rectangle."""
    count, rows = plates.x.shape[1], np.stack(plates[:-2], axis=1)
    if more := -count % LANES:
        rows = np.concatenate([rows, np.repeat(rows[:, :, -1:], more, axis=2)], axis=2)
        rows[:, 4, count:] = 0.0  # their area
    places = np.moveaxis(rows[:, :2].reshape(len(rows), 2, -1, LANES), 3, 0)
    low, high = reduce(np.minimum, places), reduce(np.maximum, places)  # numpy's own takes thrice the time
    return Sole(
        plates=rows,
        blocks=np.concatenate([0.5 * (low + high), 0.5 * (high - low)], axis=1),
        reach=np.sqrt(np.max(plates.x**2 + plates.z**2, axis=1)),
        span=plates.span,
        width=plates.width,
    )


def sole_of(plates: Plates) -> Sole:
    """The first foot's plates, as one contact takes them."""
    return sole_at(soles(plates), 0)
