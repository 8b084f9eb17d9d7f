"""Feet that walk in batches: a bounded number of soles at a time, by the compiled loop, on threads."""

import math
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from footopt.effects import base as effects
from footopt.effects.base import Effect
from footopt.errors import check_whole
from footopt.foot import Foot, Plates, as_plates
from footopt.foot.plates import RULES
from footopt.walk import discretize
from footopt.walk.accuracy import Accuracy
from footopt.walk.discretize import Path
from footopt.walk.loop import BACKWARD, DIVERGED, OK, SUNK, Course, Output, walk_range
from footopt.walk.metrics import COLUMNS, RAW
from footopt.walk.state import COUNTS, World
from footopt.walk.steppers import STEPPERS

#: Why a walk failed, by the loop's status.
REASONS = {OK: "", SUNK: "sunk", BACKWARD: "backward", DIVERGED: "diverged"}

MAX_REPEATS = 3  # of a walk that diverged, each with a quarter of the time step before
CHUNK = 4096  # designs whose plates are in memory at once
POINTS = 4_000_000  # along their soles, at most
MOST_BYTES = 4e9  # that the bristles of a traced walk may take: of a longer one fewer samples are kept
BLOCK = 16  # designs that a thread takes at a time


def available_threads() -> int:
    """How many processors this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def at_once(given: int | None, setting: str = "engine.threads") -> int:
    """How many threads or workers there are to be; None: as many as the process may run on."""
    if given is None:
        return available_threads()
    check_whole(given, setting, 1, 4096, "Or null: all.")
    return int(given)


def chunks(feet: Sequence[Foot], acting: Sequence[Effect], accuracy: Accuracy) -> Iterator[Plates]:
    """The feet's plates, a bounded number of designs at a time."""
    directed, fill = effects.laws(acting).directed, effects.reshaping(acting)
    size = max(1, min(CHUNK, POINTS // (accuracy.plates * RULES[accuracy.rule])))
    for i in range(0, len(feet), size):
        yield as_plates(feet[i : i + size], accuracy.plates, accuracy.rule, directed, fill)


def walk_batch(
    plates: Plates,
    path: Path,
    world: World,
    accuracy: Accuracy,
    sink: bool,
    threads: int | None,
    traced: bool = False,
) -> Output:
    """Run the compiled loop over a batch; with `sink` it follows the maximum sinkage.

    Walks that diverge are repeated with a quarter of the time step, `MAX_REPEATS` times at most.
    """
    walked = _walk_once(plates, path, world, accuracy, sink, threads, traced)
    for repeat in range(1, MAX_REPEATS + 1):
        again = np.flatnonzero(walked.status == DIVERGED)
        finer = replace(accuracy, dt=accuracy.dt / 4**repeat)
        if len(again) == 0 or discretize.too_many_poses(path, finer):
            break
        shorter = _walk_once(plates.take(again), path, world, finer, sink, threads, traced)
        walked.raw[again], walked.status[again] = shorter.raw, shorter.status
        for name in COUNTS.names or ():
            walked.counts[name][again] += shorter.counts[name]
        walked.counts["repeats"][again] = repeat
        walked = walked._replace(trace=shorter.trace, bristles=shorter.bristles)
    return walked


def _walk_once(
    plates: Plates,
    path: Path,
    world: World,
    accuracy: Accuracy,
    sink: bool,
    threads: int | None,
    traced: bool,
) -> Output:
    """Walk a batch once, with the given time step."""
    stepper, designs = STEPPERS[accuracy.stepper], len(plates.x)
    times, pose0, tables = discretize.poses(path, accuracy)
    soles = discretize.soles(plates)._replace(directed=True)
    rows, constants = len(tables[-1]) + 1 if traced else 0, discretize.compiled_once(world)
    finest, control = len(tables) - 1, math.inf if accuracy.control is None else accuracy.control
    # as many in any case: another number is compiled again
    tables += tables[:1] * (discretize.HALVINGS - finest)
    course = Course(times, pose0, tables, finest, control, path.gait.heel_strike, sink)
    out = Output(
        raw=np.empty((designs, len(RAW))),
        status=np.empty(designs, np.int64),
        counts=np.zeros(designs, COUNTS),
        trace=np.full((rows, COLUMNS), np.nan),
        bristles=None if world.bristle_length is None else _traced(rows, soles.plates.shape[2]),
    )

    def run(begin: int) -> None:
        end = min(begin + BLOCK, designs)
        walk_range(stepper.parameters, soles, constants, course, out, begin, end)

    blocks = range(0, designs, BLOCK)
    workers = min(at_once(threads), len(blocks))
    list((_pool(workers).map if workers > 1 else map)(run, blocks))
    return out


@lru_cache
def _pool(workers: int) -> ThreadPoolExecutor:
    """Threads, which are kept: to start them takes as long as ten walks."""
    return ThreadPoolExecutor(workers)


if hasattr(os, "register_at_fork"):  # a child has none of its parent's threads
    os.register_at_fork(after_in_child=_pool.cache_clear)


def _traced(rows: int, plates: int) -> Any:
    """The bristles of a trace, (rows or what there is room for, 2 feet, 2, plates), to be filled."""
    return np.zeros((min(rows, max(1, int(MOST_BYTES / (16 * plates)))), 2, 2, plates), np.float32)
