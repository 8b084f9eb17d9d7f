"""What the sand under each plate remembers: the bristles of the effect `rest`.

A plate's direction h is bent by its motion over the length delta and stays in the unit disc. Over a time
c, from h_0 at its beginning (a return map, as in plasticity)::

    u = h_0 + c v / delta,   h = u / max(1, |u|)

Sliding turns h into v / |v|, as the plain law has it; at rest h is what balance needs, and nothing moves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.compiled import inlined, inlined_fast
from footopt.walk.contact import ankle_of, rsqrt, submerged

Array = NDArray[np.float64]


class Bristles(NamedTuple):
    """h of every plate, (2 feet, 2 components, padded plates) each; 0 in the air."""

    now: Array  # at the step's beginning
    middle: Array  # where its second stage begins
    end: Array  # at its end


class Stage(NamedTuple):
    """What an implicit stage bends."""

    before: Array
    after: Array
    share: float  # of the way from before to its end that after is to be; 1 is the end


@inlined
def bristles_at_start(rest, plates):
    """Under a walker that has sunk straight down to where it stands; None without bristles."""
    if rest is None:
        return None
    now = np.zeros((2, 2, plates))
    for i in range(plates):
        now[0, 1, i] = now[1, 1, i] = -1.0
    return Bristles(now, np.zeros((2, 2, plates)), np.zeros((2, 2, plates)))


@inlined
def stage_of(bristles):
    """An implicit stage that is the whole step."""
    if bristles is None:
        return None
    return Stage(bristles.now, bristles.end, 1.0)


@inlined
def first_stage(bristles, share):
    """The first of two stages; the second begins on its slope, a share of its way from the beginning."""
    if bristles is None:
        return None
    return Stage(bristles.now, bristles.middle, share)


@inlined
def second_stage(bristles):
    """The second of two stages, which ends with the step."""
    if bristles is None:
        return None
    return Stage(bristles.middle, bristles.end, 1.0)


@inlined
def next_step(bristles):
    """A step's end is the beginning of the next one."""
    if bristles is None:
        return None
    return Bristles(bristles.end, bristles.middle, bristles.now)


@inlined
def record(trace, row, bristles):
    """Write the bristles at a step's beginning into a row of their trace, where there is one.

    A trace of one row holds the last ones.
    """
    if bristles is not None:
        now, row = bristles.now, row % len(trace)
        for foot in range(2):  # loops: numba takes 20 s to compile an assignment of arrays
            for i in range(now.shape[2]):
                trace[row, foot, 0, i], trace[row, foot, 1, i] = now[foot, 0, i], now[foot, 1, i]


@inlined_fast
def bend(sole, poses, x, z, vx, vz, turn, stage):
    """Bend the bristles of both feet over a stage.

    x, z, vx, vz: the hip's place (m) and velocity (m/s) at its end. turn: the stage's time over delta, s/m.
    """
    before, after, share = stage.before, stage.after, stage.share
    for foot in range(2):
        ankle = ankle_of(poses, foot, x, z, vx, vz)
        first, last = submerged(sole, ankle)
        rate_cos, rate_sin = ankle.rate * ankle.cos, ankle.rate * ankle.sin
        for i in range(first):
            after[foot, 0, i] = after[foot, 1, i] = 0.0
        for i in range(last, len(sole.x)):
            after[foot, 0, i] = after[foot, 1, i] = 0.0
        px, pz = sole.x[first:last], sole.z[first:last]
        bx, bz = before[foot, 0, first:last], before[foot, 1, first:last]
        hx, hz = after[foot, 0, first:last], after[foot, 1, first:last]
        for i in range(len(px)):
            rz = ankle.sin * px[i] + ankle.cos * pz[i]
            ux = bx[i] + (ankle.vx - ankle.rate * rz) * turn
            uz = bz[i] + (ankle.vz + rate_cos * px[i] - rate_sin * pz[i]) * turn
            q = rsqrt(max(ux * ux + uz * uz, 1.0))
            in_sand = 1.0 if ankle.z + rz < 0.0 else 0.0
            hx[i] = in_sand * (bx[i] + share * (ux * q - bx[i]))
            hz[i] = in_sand * (bz[i] + share * (uz * q - bz[i]))
