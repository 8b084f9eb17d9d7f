"""The walk: one compiled loop over the steps, for one foot with traces or for a whole population.

Both are the same function; without a trace the code that writes one is not compiled.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
from numba import njit

from footopt.compiled import cached_njit
from footopt.walker.kernels import CONTACT, FX, FZ, POWER, Sole, contact, deepest, static_height
from footopt.walker.steppers import (
    HEIGHT,
    IMPULSE_X,
    IMPULSE_Z,
    JOINT,
    JOINT_NET,
    WORK_L,
    WORK_R,
    advance,
)

OK, SUNK, BACKWARD, DIVERGED = range(4)

#: Columns of the raw result of a walk (natural signs).
RAW = (
    "distance",
    "mean_height",
    "work",
    "peak_power",
    "speed_loss",
    "positive_joint_work",
    "peak_vertical_force",
    "maximum_sinkage",
    "net_joint_work",
    "impulse_x",
    "impulse_z",
)

#: Columns of a trace: time, hip x, z, v_x, v_z, then for the left and the right foot f_x, f_z,
#: power and work.
TRACE = 13


@njit(error_model="numpy", forceinline=True)
def hermite_extreme(v0, v1, a0, a1, h):
    """The velocity's extreme inside a step whose end accelerations differ in sign (cubic Hermite)."""
    rise = v1 - v0
    p, q = h * a0, 3.0 * rise - h * (2.0 * a0 + a1)
    r = h * (a0 + a1) - 2.0 * rise
    root = np.sqrt(max(q * q - 3.0 * p * r, 0.0))  # p + 2 q s + 3 r s^2 = 0
    s = -p / (q + root) if a0 < 0.0 else -p / (q - root)
    s = min(max(s, 0.0), 1.0) if np.isfinite(s) else 0.0
    return v0 + s * (p + s * (q + s * r))


@njit(error_model="numpy", forceinline=True)
def hermite(v0, v1, a0, a1, h, s):
    """The velocity at the share s of a step."""
    rise = v1 - v0
    q, r = 3.0 * rise - h * (2.0 * a0 + a1), h * (a0 + a1) - 2.0 * rise
    return v0 + s * (h * a0 + s * (q + s * r))


def _source() -> str:
    """A digest of the compiled sources: cached code of older ones is not used again."""
    digest = hashlib.sha256()
    for name in ("kernels.py", "steppers.py", "loop.py"):
        digest.update((Path(__file__).parent / name).read_bytes())
    return digest.hexdigest()


def _compile(source: str):
    @cached_njit(nogil=True, error_model="numpy")
    def walk_range(
        stepper,
        plates,
        blocks,
        reach,
        world,
        pose0,
        poses,
        times,
        strike,
        begin,
        end,
        raw,
        status,
        tallies,
        trace,
        sink,
    ):
        """Walk the designs begin..end of a population.

        plates: five arrays (designs, padded plates), `foot.Plates`. blocks: three arrays (designs,
        blocks), `kernels.Sole`. reach: (designs,), m. times: (steps + 1,), s, the first
        is 0. pose0: (2, 7) at t = 0. poses: (steps, nodes, 2, 7). strike: first heel strike, s.
        Filled: raw (designs, len(RAW)), status (designs,), tallies (designs, 4), and trace
        (steps + 1, TRACE) or None, for one design: its row 0 is the start.
        sink: 1 to follow the maximum sinkage, None to leave that out.
        """
        source  # noqa: B018  a free variable is part of the cache's key
        steps = poses.shape[0]
        t_f = times[steps]
        y, quad = np.empty(4), np.empty(7)
        now, work = np.zeros((2, CONTACT)), np.zeros((2, CONTACT))
        peak = np.zeros((2, 3))  # |P| of each foot at the last three samples
        for d in range(begin, end):
            sole = Sole(
                plates[0][d],
                plates[1][d],
                plates[2][d],
                plates[3][d],
                plates[4][d],
                blocks[0][d],
                blocks[1][d],
                blocks[2][d],
                reach[d],
            )
            raw[d, :] = np.nan
            tally = tallies[d]
            tally[:] = 0
            status[d] = SUNK
            y[:] = 0.0
            y[1] = static_height(sole, world, pose0)
            if not np.isfinite(y[1]):
                continue
            z_start = y[1]
            quad[:] = 0.0
            contact(now, tally, sole, world, pose0, y[1], 0.0, 0.0, world.creep, None)
            if trace is not None:
                trace[0, :] = 0.0
                trace[0, 2] = z_start
            p_max = fall = f_max = sinkage = 0.0
            top = -np.inf
            status[d] = OK
            for n in range(steps):
                h = times[n + 1] - times[n]
                v0, a0 = y[2], (now[0, FX] + now[1, FX]) / world.mass
                solved = advance(stepper, y, now, quad, tally, h, poses[n], sole, world, work)
                speed = abs(y[2]) + abs(y[3])
                if not solved or not speed < 1e4:
                    status[d] = DIVERGED
                    break
                if y[1] <= 0.0:
                    status[d] = SUNK
                    break
                t = times[n + 1]
                f_max = max(f_max, now[0, FZ] + now[1, FZ])
                if sink is not None:
                    sinkage = max(sinkage, deepest(sole, poses[n, -1], y[1]))
                for foot in range(2):
                    peak[foot, 0], peak[foot, 1] = peak[foot, 1], peak[foot, 2]
                    peak[foot, 2] = abs(now[foot, POWER])
                if t > strike - 1e-9:  # objectives that begin with the first heel strike
                    v1, a1 = y[2], (now[0, FX] + now[1, FX]) / world.mass
                    if top == -np.inf:
                        top = hermite(v0, v1, a0, a1, h, min(max(1.0 - (t - strike) / h, 0.0), 1.0))
                    elif a0 * a1 < 0.0:
                        extreme = hermite_extreme(v0, v1, a0, a1, h)
                        top = max(top, extreme)
                        fall = max(fall, top - extreme)
                    top = max(top, v1)
                    fall = max(fall, top - v1)
                    for foot in range(2):
                        a, b, c = peak[foot]
                        p_max = max(p_max, c)
                        if b > a and b >= c and t - h > strike - 1e-9:  # a parabola's vertex
                            p_max = max(p_max, b - 0.125 * (c - a) ** 2 / (a - 2.0 * b + c))
                if trace is not None:
                    trace[n + 1, 0] = t
                    trace[n + 1, 1:5] = y
                    for foot in range(2):
                        trace[n + 1, 5 + 4 * foot] = now[foot, FX]
                        trace[n + 1, 6 + 4 * foot] = now[foot, FZ]
                        trace[n + 1, 7 + 4 * foot] = now[foot, POWER]
                        trace[n + 1, 8 + 4 * foot] = quad[WORK_L + foot]
            if status[d] != OK:
                continue
            if top == -np.inf:
                p_max = fall = np.nan
            if y[0] <= 0.0 and top > -np.inf:
                status[d] = BACKWARD
            raw[d, 0] = y[0]
            raw[d, 1] = quad[HEIGHT] / t_f
            raw[d, 2] = abs(quad[WORK_L] + quad[WORK_R])
            raw[d, 3] = p_max
            raw[d, 4] = fall
            raw[d, 5] = quad[JOINT]
            raw[d, 6] = f_max
            raw[d, 7] = sinkage
            raw[d, 8] = quad[JOINT_NET]
            raw[d, 9] = quad[IMPULSE_X]
            raw[d, 10] = quad[IMPULSE_Z]

    return walk_range


walk_range = _compile(_source())
