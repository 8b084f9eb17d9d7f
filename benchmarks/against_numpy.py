"""footopt against `numpy_walk`: time per design on one core, at equal or better accuracy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy_walk
from measure import error, interleaved
from numpy.typing import NDArray

import footopt as fo
from footopt.walk import PRESETS

Array = NDArray[np.float64]


class Comparison(NamedTuple):
    """Errors in %, times in s per design; `batch` is numpy_walk over a batch of feet at once."""

    preset: str
    numpy_error: float
    error: float
    numpy: float
    batch: float
    footopt: float


def twin(k: Array, scene: fo.Scene, dt: float = numpy_walk.DT) -> Array:
    """What `numpy_walk.walk` finds, (5,), by the same algorithm compiled; peaks read at steps too."""
    accuracy = fo.Accuracy("explicit_euler", dt, numpy_walk.PLATES, numpy_walk.CREEP, rule="chord")
    walk = fo.simulate(fo.Foot.from_waypoints(k), scene, accuracy)
    late = walk.t > scene.gait.heel_strike - 1e-9
    speed = walk.velocity[late, 0]
    return np.array(
        [
            *(walk.totals[name] for name in ("distance", "mean_height", "work")),
            np.abs(walk.power[late]).max(),
            (np.maximum.accumulate(speed) - speed).max(),
        ]
    )


def compare(
    k: Array, scene: fo.Scene, batch: int = 8, repeats: int = 3, dt: float = numpy_walk.DT
) -> Comparison:
    """Time both; footopt with its cheapest preset that is at least as accurate over the feet k."""
    exact = fo.evaluate(k, scene, "reference").values
    theirs = error(np.array([twin(heights, scene, dt) for heights in k]), exact)
    ours = {name: error(fo.evaluate(k, scene, name).values, exact) for name in PRESETS}
    preset = next(name for name in PRESETS if ours[name] <= theirs)  # from cheap to dear
    one = numpy_walk.chords(k[:1], fo.Waypoints())
    several = numpy_walk.chords(k[:batch], fo.Waypoints())
    times = interleaved(
        {
            "numpy": lambda: numpy_walk.walk(one, scene, dt),
            "batch": lambda: numpy_walk.walk(several, scene, dt),
            "footopt": lambda: fo.evaluate(k, scene, preset, threads=1),
        },
        repeats,
    )
    return Comparison(
        preset, theirs, ours[preset], times["numpy"], times["batch"] / batch, times["footopt"] / len(k)
    )
