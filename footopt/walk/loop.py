"""The walk: one compiled loop over the steps, for batches of feet on threads.

One foot with traces and a whole population are walked by the same code, which asks once a step whether there
is a trace to write.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from footopt.arrays import Array
from footopt.compiled import inlined
from footopt.errors import check_whole
from footopt.foot import Plates
from footopt.walk import discretize
from footopt.walk.accuracy import Accuracy
from footopt.walk.bristles import Bristles, bent_down, record
from footopt.walk.contact import static_height
from footopt.walk.discretize import Path
from footopt.walk.metrics import (
    COLUMNS,
    NO_EXTREMES,
    RAW,
    hermite,
    raw_of,
    sample_of,
    sinkage_of,
    step_error,
    updated,
)
from footopt.walk.own_code import compiled_for
from footopt.walk.state import ALOFT, COUNTS, Integrals, Motion, State, World, borrowed, sole_at, write
from footopt.walk.steppers import STEPPERS, acceleration, advance, explicit_contact

NEAR_PEAK = 0.9  # of the largest |P| of a foot so far: from there a step may hold the peak of the whole walk
PEAK = 0.1  # share of the control that such a step must meet: the peak depends on the speed at one instant
LENGTHEN = 0.1  # share of the allowed error: below it the next step is twice as long, with 8 times the error
FASTEST = 1e4  # m/s: beyond it a walk has diverged

OK, SUNK, BACKWARD, DIVERGED = range(4)
REASONS = ("", "sunk", "backward", "diverged")  # why a walk failed

MAX_REPEATS = 3  # of a walk that diverged, each with a quarter of the previous time step
BLOCK = 16  # designs that a thread takes at a time, at most


class Course(NamedTuple):
    """How feet move, and how finely that is followed."""

    times: Array  # (steps + 1,), s, the first is 0
    start: Array  # (2, 7): both feet at t = 0
    poses: Any  # a table for whole steps, (steps, nodes, 2, 7), then for halves, quarters, ... of them
    nodes: Array  # where in a step these are, as shares of it
    tabled: int  # the last of these tables that is used
    traced: int  # a trace has rows for steps halved so often
    finest: int  # how often a step may be halved
    control: float  # m/s, the largest `step_error`; infinite for steps that are never shortened
    strike: float  # s, the first heel strike
    sink: bool  # whether to follow the maximum sinkage


class Output(NamedTuple):
    """The arrays that are filled; the traces are those of one design.

    Row 0 of the traces is the start, the next ones are the ends of steps halved `Course.traced` times: rows
    inside longer steps are left as they were.
    """

    raw: Array  # (designs, len(RAW))
    status: Any  # (designs,)
    counts: Any  # (designs,) of `COUNTS`
    trace: Array  # (shortest traced steps + 1, `metrics.COLUMNS`); without rows, nothing is traced
    bristles: Any  # (rows of the trace, 2 feet, 2, plates), or None


def walk_designs(method, soles, world, course, out, begin, end):
    """Walk the designs begin..end of a population; soles: `Sole` of all designs.

    A stage that Newton's method does not solve (`newton.solve_stage`) leaves the step unsolved, which is then
    halved as long as it can be, as one with too large an error is. Then the walk has diverged, and
    `walk_batch` repeats it with a quarter of the time step, three times at most.
    """
    times, control, tabled, finest = course.times, course.control, course.tabled, course.finest
    steps, row = len(times) - 1, 1 << (finest - course.traced)
    within = np.empty((len(course.nodes), 2, 7))
    for d in range(begin, end):
        sole, count = sole_at(soles, d), out.counts[d]
        state, extremes = _standing(world, sole, course.start, count), NO_EXTREMES
        status = OK if state.solved else SUNK
        if state.solved:
            _trace(out, 0, 0.0, state)
        n = place = 0  # the step n is walked up to place / 2^finest of it
        level = finest  # the shortest step first: sinking in needs it
        while status == OK and n < steps:
            stride = 1 << (finest - level)
            h = (times[n + 1] - times[n]) / (1 << level)
            index = (n << level) + place // stride
            if level <= tabled:
                poses = borrowed(course.poses[level])[index]
            else:
                parts, table = 1 << (level - tabled), borrowed(course.poses[tabled])
                _poses_between(within, table, course.start, index, parts, course.nodes, h * parts)
                poses = borrowed(within)
            new = advance(method, world, sole, poses, state, h, count)
            ax0, az0 = acceleration(world, state.contact)
            ax1, az1 = acceleration(world, new.contact)
            error = step_error(state.hip.vx, new.hip.vx, ax0, ax1, h)
            error += step_error(state.hip.vz, new.hip.vz, az0, az1, h)
            power = max(abs(new.contact.left.power), abs(new.contact.right.power))
            near = extremes.power > 0.0 and power >= NEAR_PEAK * extremes.power
            allowed = PEAK * control if near else control
            if level < finest and not (new.solved and error <= allowed):
                level += 1
                count.shortened += 1
                continue
            if not new.solved or not abs(new.hip.vx) + abs(new.hip.vz) < FASTEST:
                status = DIVERGED
                break
            if new.hip.z <= 0.0:
                status = SUNK
                break
            place += stride
            t = times[n] + place / (1 << finest) * (times[n + 1] - times[n])
            if place == 1 << finest:
                n, place = n + 1, 0
                t = times[n]
            depth = sinkage_of(sole, poses[-1], new.hip) if course.sink else 0.0
            extremes = updated(extremes, state, new, ax0, ax1, t, h, course.strike, depth)
            state = new
            if place % row == 0:
                _trace(out, (n << course.traced) + place // row, t, state)
            if level > 0 and place % (2 * stride) == 0 and error < LENGTHEN * allowed:
                level -= 1
        if status == OK:
            if state.hip.x <= 0.0 and extremes.speed > -np.inf:
                status = BACKWARD
            write(out.raw[d], raw_of(state, extremes, times[-1]))
        out.status[d] = status


@inlined
def _poses_between(out, table, start, index, parts, nodes, h):
    """Fill in the poses at the nodes of a step that is one of `parts` of a step in a table, h seconds long.

    They are on the cubic polynomials through both ends of that step with their rates.
    """
    whole, part = index // parts, index % parts
    first, last = (start if whole == 0 else table[whole - 1, -1]), table[whole, -1]
    for i in range(len(nodes)):
        share = (part + nodes[i]) / parts
        for foot in range(2):
            a, b, at = first[foot], last[foot], out[i, foot]
            at[0], at[2] = hermite(a[0], b[0], a[2], b[2], h, share)
            at[1], at[3] = hermite(a[1], b[1], a[3], b[3], h, share)
            at[4], cos_rate = hermite(a[4], b[4], -a[5] * a[6], -b[5] * b[6], h, share)
            at[5], sin_rate = hermite(a[5], b[5], a[4] * a[6], b[4] * b[6], h, share)
            at[6] = at[4] * sin_rate - at[5] * cos_rate


@inlined
def _standing(world, sole, poses, count):
    """The walker at rest where the sand carries it; not solved where it does not."""
    length, plates = world.bristle_length, sole.plates.shape[1]
    e_n = bent_down(length, 1.0, plates)
    bristles = Bristles(e_n, bent_down(length, 0.0, plates), bent_down(length, 0.0, plates))
    z = static_height(world, sole, poses, e_n)
    hip, none = Motion(0.0, z, 0.0, 0.0), Integrals(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if not np.isfinite(z):
        return State(hip, ALOFT, none, bristles, False)
    return State(hip, explicit_contact(world, sole, poses, hip, e_n, 0.0, count), none, bristles, True)


@inlined
def _trace(out, row, t, state):
    """Write a state into a row of the traces, where there are any."""
    if len(out.trace) > 0:
        write(out.trace[row], sample_of(t, state))
        record(out.bristles, row, state.bristles.e_n)


def at_once(given: int | None = None, setting: str = "engine.threads") -> int:
    """How many threads or workers to use, checked; None: as many as processors the process may run on."""
    if given is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    check_whole(setting, given, 1, 4096, "Or null: all.")
    return int(given)


def walk_batch(
    plates: Plates,
    path: Path,
    world: World,
    accuracy: Accuracy,
    sink: bool,
    threads: int | None,
    traced: bool = False,
    repeat: int = 0,
) -> Output:
    """Run the compiled loop over a batch; with `sink` it follows the maximum sinkage.

    Walks that diverge are repeated with a quarter of the time step, `MAX_REPEATS` times at most.
    """
    stepper, designs = STEPPERS[accuracy.stepper].parameters, len(plates.x)
    times, pose0, tables = discretize.poses(path, accuracy)
    soles, constants = discretize.soles(plates), discretize.with_bypassed_gates(world)
    tabled, control = len(tables) - 1, math.inf if accuracy.control is None else accuracy.control
    # always as many tables: the loop would be compiled again for another number of them
    tables += tables[:1] * (discretize.TABLED - tabled)
    nodes, strike = np.array(STEPPERS[accuracy.stepper].nodes), path.gait.heel_strike
    halved = (discretize.TRACED, discretize.HALVINGS) if tabled else (0, 0)
    course = Course(times, pose0, tables, nodes, tabled, *halved, control, strike, sink)
    rows, padded = ((len(times) - 1) << halved[0]) + 1 if traced else 0, soles.plates.shape[2]
    out = Output(
        raw=np.full((designs, len(RAW)), np.nan),
        status=np.empty(designs, np.int64),
        counts=np.zeros(designs, COUNTS),
        trace=np.full((rows, COLUMNS), np.nan),
        bristles=None if world.bristle_length is None else np.zeros((rows, 2, 2, padded), np.float32),
    )
    walk, workers = compiled_for(walk_designs, constants.effects.all, stepper), at_once(threads)
    size = min(BLOCK, 1 + designs // (4 * workers))
    blocks = range(0, designs, size)
    left = iter(blocks)  # a thread that is free takes the next one

    def run() -> None:
        for begin in left:
            walk(stepper, soles, constants, course, out, begin, min(begin + size, designs))

    try:
        others = [_pool(workers - 1).submit(run) for _ in range(min(workers, len(blocks)) - 1)]
        run()
        for other in others:
            other.result()
    except (
        BaseException
    ):  # an interrupt: no thread goes on, nor waits for work in a pool that lost sight of it
        _pool.cache_clear()
        for _ in left:
            pass
        raise
    again = np.flatnonzero(out.status == DIVERGED)
    if len(again) == 0 or repeat == MAX_REPEATS:
        return out
    finer = replace(accuracy, dt=accuracy.dt / 4)
    if discretize.too_many_poses(path, finer):
        return out
    some = Plates._make(np.ascontiguousarray(column[again]) for column in plates)
    shorter = walk_batch(some, path, world, finer, sink, threads, traced, repeat + 1)
    out.raw[again], out.status[again] = shorter.raw, shorter.status
    for name in COUNTS.names or ():
        out.counts[name][again] += shorter.counts[name]
    out.counts["repeats"][again] += 1
    return out._replace(trace=shorter.trace, bristles=shorter.bristles)


@lru_cache
def _pool(workers: int) -> ThreadPoolExecutor:
    """A pool of threads, which is kept: starting threads takes as long as ten walks."""
    return ThreadPoolExecutor(workers)


if hasattr(os, "register_at_fork"):  # a child has none of its parent's threads
    os.register_at_fork(after_in_child=_pool.cache_clear)
