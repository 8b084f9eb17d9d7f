"""From a scene, an accuracy and feet to what the compiled loop takes: world, plates, times and poses."""

from __future__ import annotations

import math
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from footopt.effects import base as effects
from footopt.errors import SettingError
from footopt.foot import Plates
from footopt.walk.accuracy import Accuracy
from footopt.walk.contact import LANES, Sole, World
from footopt.walk.scene import Scene, Walker
from footopt.walk.steppers import STEPPERS

Array = NDArray[np.float64]

NEWTON = 3e-3  # last step of Newton's method over the plates' mean speed; the forces' error is the square
REST = 4  # longer steps while the walker stands
HALVINGS = 3  # of a step under control, at most
ROWS = 5_000_000  # poses of a walk that are tabulated, 112 bytes each; ten minutes take 2.6 million
POSES = 64  # motions whose poses are kept: about 1 MB each, and the time of a few dozen walks
LONG = ROWS // POSES  # poses of a motion of which only `LONG_ONES` are kept
LONG_ONES = 2


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


def blocks_of(plates: Plates) -> tuple[tuple[Array, ...], tuple[Array, ...], Array]:
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
    columns, circles, reach = blocks_of(plates)
    tangents = [None if column is None else column[0] for column in tangents_of(plates)]
    return Sole._make([*(c[0] for c in (*columns, *circles)), float(reach[0]), *tangents])


def _padded(column: Array, extra: int, value: float | None = None) -> Array:
    """A column with more plates at the end: the last one again, or a value."""
    last = column[:, -1:] if value is None else np.full((len(column), 1), value)
    return np.concatenate([column, np.repeat(last, extra, axis=1)], axis=1)


def tangents_of(plates: Plates) -> tuple[Array | None, Array | None]:
    """The plates' directions in whole blocks, where an effect needs them."""
    if plates.tx is None or plates.tz is None:
        return None, None
    extra = -plates.x.shape[1] % LANES
    return _padded(plates.tx, extra), _padded(plates.tz, extra)
