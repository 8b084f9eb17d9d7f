"""The walk: one compiled loop over the steps, for one foot with traces or for a whole population.

Both are the same compiled code, which asks once a step whether there is a trace to write.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from footopt.walk.bristles import beginning, bristles_at_start, record
from footopt.walk.cache_key import compiled
from footopt.walk.contact import contact
from footopt.walk.metrics import no_extremes, raw_of, sample_of, sinkage_of, step_error, updated
from footopt.walk.standing import static_height
from footopt.walk.state import Integrals, Sole, State, World, borrowed, sole_at, write
from footopt.walk.steppers import acceleration, advance, explicit_contact

NEAR = 0.9  # of the largest |P| of a foot so far: from there a step may hold the peak of the whole walk
PEAK = 0.1  # of its control is what such a step is held to: the peak follows the speed's error at one instant

OK, SUNK, BACKWARD, DIVERGED = range(4)


def walk_designs(
    method,
    soles,
    world,
    pose0,
    poses,
    times,
    control,
    strike,
    begin,
    end,
    raw,
    status,
    counts,
    trace,
    bristle_trace,
    sink,
):
    """Walk the designs begin..end of a population.

    soles: `Sole` of all designs. times: (steps + 1,), s, the first is 0. pose0: (2, 7) at t = 0.
    poses: a table for whole steps, (steps, nodes, 2, 7), then for halves, quarters, ... of them.
    control: the largest `step_error`, m/s, or None for steps that are never shortened.
    strike: first heel strike, s. sink: whether to follow the maximum sinkage.
    Filled: raw (designs, len(RAW)), status (designs,), counts (designs,) of `COUNTS`, and trace
    (shortest steps + 1, len(TRACE)) for one design: its row 0 is the start, rows inside longer steps
    are left as they were; without rows, nothing is traced. bristle_trace: the bristles of each row,
    (rows, 2 feet, 2, plates), or None.
    """
    steps = len(times) - 1
    finest, traced = len(poses) - 1, len(trace) > 0
    for d in range(begin, end):
        sole, count = sole_at(soles, d), counts[d]
        for column in range(raw.shape[1]):
            raw[d, column] = np.nan
        status[d] = SUNK
        bristles = bristles_at_start(world.bristle_length, len(sole.x))
        z = static_height(world, sole, pose0, beginning(bristles))
        if not np.isfinite(z):
            continue
        at = explicit_contact(world, sole, pose0, 0.0, z, 0.0, 0.0, bristles, 0.0, count)
        state = State(0.0, z, 0.0, 0.0, at, Integrals(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), bristles, True)
        extremes = no_extremes()
        if traced:
            write(trace[0], sample_of(0.0, state))
            record(bristle_trace, 0, state.bristles)
        status[d] = OK
        n = place = 0  # the step n is walked up to place / 2^finest of it
        level = finest  # it begins to sink: the first steps would be shortened as far
        while n < steps:
            stride = 1 << (finest - level)
            h = (times[n + 1] - times[n]) / (1 << level)
            index = (n << level) + place // stride
            after = advance(method, world, sole, borrowed(poses[level])[index], state, h, count)
            ax0, az0 = acceleration(world, state.contact)
            ax1, az1 = acceleration(world, after.contact)
            if control is not None:
                error = step_error(state.vx, after.vx, ax0, ax1, h)
                error += step_error(state.vz, after.vz, az0, az1, h)
                power = max(abs(after.contact.left.power), abs(after.contact.right.power))
                near = extremes.power > 0.0 and power >= NEAR * extremes.power
                allowed = PEAK * control if near else control
                if level < finest and not (after.solved and error <= allowed):
                    level += 1
                    count.shortened += 1
                    continue
            if not after.solved or not abs(after.vx) + abs(after.vz) < 1e4:
                status[d] = DIVERGED
                break
            if after.z <= 0.0:
                status[d] = SUNK
                break
            place += stride
            row = (n << finest) + place
            t = times[n] + place / (1 << finest) * (times[n + 1] - times[n])
            if place == 1 << finest:
                n, place = n + 1, 0
                t = times[n]
            depth = sinkage_of(sole, poses[level][index, -1], after.z) if sink else 0.0
            extremes = updated(extremes, state, after, ax0, ax1, t, h, strike, depth)
            state = after
            if traced:
                write(trace[row], sample_of(t, state))
                record(bristle_trace, row, state.bristles)
            if control is not None:  # noqa: SIM102  only such a test on its own is pruned
                if level > 0 and place % (2 * stride) == 0 and error < 0.1 * allowed:
                    level -= 1  # a step twice as long has 8 times the error, if of order 2
        if status[d] == OK:
            if state.x <= 0.0 and extremes.speed > -np.inf:
                status[d] = BACKWARD
            write(raw[d], raw_of(state, extremes, times[steps]))


def walk_range(stepper: Any, soles: Sole, world: World, *rest: Any) -> None:
    """`walk_designs`, compiled for the stepper and the effects of a scene."""
    compiled(walk_designs, world.effects.all, stepper)(stepper, soles, world, *rest)


def both_feet(world, sole, poses, x, z, vx, vz, creep, stage, counts):
    """`contact` without bristles, to be compiled for Python."""
    return contact(world, sole, poses, x, z, vx, vz, creep, stage, None, counts)
