"""The walk: one compiled loop over the steps, for one foot with traces or for a whole population.

Both are the same compiled code, which asks once a step whether there is a trace to write.
"""

from __future__ import annotations

import hashlib
import inspect
import marshal
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from footopt.compiled import cached_njit
from footopt.effects import base as effects
from footopt.walk import contact as kernels
from footopt.walk import steppers
from footopt.walk.contact import CONTACT, FX, FZ, POWER, SHORTENED, Sole, contact, deepest, static_height
from footopt.walk.steppers import (
    HEIGHT,
    IMPULSE_X,
    IMPULSE_Z,
    JOINT,
    JOINT_NET,
    WORK_L,
    WORK_R,
    acceleration,
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


@njit(forceinline=True)
def of_design(column, d):
    """One design's row of a column that may not be there."""
    if column is None:
        return None
    return column[d]


@njit(forceinline=True)
def copy(values, to):
    """Copy a state (y, quad, now). By slices a walk takes a third longer to compile: numba's messages."""
    y, quad, now = values
    to_y, to_quad, to_now = to
    for i in range(len(y)):
        to_y[i] = y[i]
    for i in range(len(quad)):
        to_quad[i] = quad[i]
    for foot in range(2):
        for j in range(CONTACT):
            to_now[foot, j] = now[foot, j]


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


@njit(error_model="numpy", forceinline=True)
def vertex(a, b, c, before, after):
    """Height of the parabola through three samples, the middle one the highest, these times apart."""
    rise, fall = (b - a) / before, (c - b) / after
    slope = (rise * after + fall * before) / (before + after)  # at the middle sample
    return b - 0.25 * slope * slope * (before + after) / (fall - rise)


@njit(error_model="numpy", forceinline=True)
def embedded(v0, v1, a0, a1, h):
    """Error estimate of a step's velocity, m/s: against the trapezoidal rule through its own ends.

    Its acceleration at both ends is known, so that a second method of order 2 comes for nothing.
    """
    return abs(v1 - v0 - 0.5 * h * (a0 + a1))


@lru_cache(maxsize=8)
def _source(own: tuple[Any, ...]) -> str:
    """A digest of the compiled sources, with a user's own functions: code cached of others is not used."""
    digest = hashlib.sha256()
    for folder in (Path(str(effects.__file__)).parent, Path(__file__).parent):  # no file can be forgotten
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.read_bytes())
    for function in own:
        digest.update(text_of(function))
    return digest.hexdigest()


def text_of(function: Any) -> bytes:
    """The file that a function is in, with what it may call; its code if it was typed into a session."""
    try:
        return Path(inspect.getfile(function)).read_bytes()
    except OSError:
        return marshal.dumps(function.__code__)


@lru_cache(maxsize=8)
def _compile(source: str, compiler: Any):
    @compiler(nogil=True, error_model="numpy")
    def walk_range(
        stepper,
        plates,
        blocks,
        reach,
        tangents,
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
        tallies,
        trace,
        sink,
    ):
        """Walk the designs begin..end of a population.

        plates: five arrays (designs, padded plates), `foot.Plates`. blocks: three arrays (designs,
        blocks), `kernels.Sole`. reach: (designs,), m. tangents: two more of the first kind, or two
        None, where no effect needs a plate's normal. times: (steps + 1,), s, the first
        is 0. pose0: (2, 7) at t = 0. poses: a table for whole steps, (steps, nodes, 2, 7), then for
        halves, quarters, ... of them. control: the largest `embedded` error of a step, m/s, or None
        for steps that are never shortened. strike: first heel strike, s.
        Filled: raw (designs, len(RAW)), status (designs,), tallies (designs, TALLY), and trace
        (shortest steps + 1, TRACE) for one design: its row 0 is the start, rows inside longer steps
        are left as they were; without rows, nothing is traced.
        sink: whether to follow the maximum sinkage.
        """
        source  # noqa: B018  a free variable is part of the cache's key
        steps = len(times) - 1
        t_f = times[steps]
        finest, traced = len(poses) - 1, len(trace) > 0
        y, quad = np.empty(4), np.empty(7)
        now, work = np.zeros((2, CONTACT)), np.zeros((2, CONTACT))
        y_old, quad_old, now_old = np.empty(4), np.empty(7), np.zeros((2, CONTACT))
        peak, when = np.zeros((2, 3)), np.zeros(3)  # |P| of each foot at the last three samples
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
                of_design(tangents[0], d),
                of_design(tangents[1], d),
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
            contact(now, tally, sole, world, pose0, 0.0, y[1], 0.0, 0.0, world.creep, None)
            if traced:
                trace[0, :] = 0.0
                trace[0, 2] = z_start
            p_max = fall = f_max = sinkage = 0.0
            top = -np.inf
            status[d] = OK
            n = place = level = 0  # the step n is walked up to place / 2^finest of it
            while n < steps:
                stride = 1 << (finest - level)
                h = (times[n + 1] - times[n]) / (1 << level)
                index = (n << level) + place // stride
                if control is not None:
                    copy((y, quad, now), (y_old, quad_old, now_old))
                v0, w0 = y[2], y[3]
                a0, b0 = acceleration(now, world)
                solved = advance(stepper, y, now, quad, tally, h, poses[level][index], sole, world, work)
                v1 = y[2]
                a1, b1 = acceleration(now, world)
                if control is not None:
                    error = embedded(v0, v1, a0, a1, h) + embedded(w0, y[3], b0, b1, h)
                    if level < finest and not (solved and error <= control):
                        copy((y_old, quad_old, now_old), (y, quad, now))
                        level += 1
                        tally[SHORTENED] += 1
                        continue
                speed = abs(y[2]) + abs(y[3])
                if not solved or not speed < 1e4:
                    status[d] = DIVERGED
                    break
                if y[1] <= 0.0:
                    status[d] = SUNK
                    break
                place += stride
                row = (n << finest) + place
                t = times[n] + place / (1 << finest) * (times[n + 1] - times[n])
                if place == 1 << finest:
                    n, place = n + 1, 0
                    t = times[n]
                f_max = max(f_max, now[0, FZ] + now[1, FZ])
                if sink:
                    sinkage = max(sinkage, deepest(sole, poses[level][index, -1], y[1]))
                when[0], when[1], when[2] = when[1], when[2], t
                for foot in range(2):
                    peak[foot, 0], peak[foot, 1] = peak[foot, 1], peak[foot, 2]
                    peak[foot, 2] = abs(now[foot, POWER])
                if t > strike - 1e-9:  # objectives that begin with the first heel strike
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
                        if b > a and b >= c and t - h > strike - 1e-9:
                            p_max = max(p_max, vertex(a, b, c, when[1] - when[0], when[2] - when[1]))
                if traced:
                    trace[row, 0] = t
                    for j in range(4):
                        trace[row, 1 + j] = y[j]
                    for foot in range(2):
                        trace[row, 5 + 4 * foot] = now[foot, FX]
                        trace[row, 6 + 4 * foot] = now[foot, FZ]
                        trace[row, 7 + 4 * foot] = now[foot, POWER]
                        trace[row, 8 + 4 * foot] = quad[WORK_L + foot]
                if control is not None:  # noqa: SIM102  only such a test on its own is pruned
                    if level > 0 and place % (2 * stride) == 0 and error < 0.1 * control:
                        level -= 1  # a step twice as long has 8 times the error, if of order 2
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


#: Where types and functions come from that every process can import.
HOME = ("footopt.", __name__.rpartition(".")[0] + ".")


def is_own(thing: Any) -> bool:
    """Whether a type or function is a user's, not footopt's."""
    return not thing.__module__.startswith(HOME)


def _own(stepper: Any, laws: Sequence[Any]) -> tuple[Any, ...]:
    """A user's own types and functions among those that a walk needs."""
    hooks = [hooks[type(law)] for law in laws for hooks in effects.HOOKS if type(law) in hooks]
    needed = (type(stepper), steppers.STEPS[type(stepper)], *map(type, laws), *hooks)
    return tuple(filter(is_own, needed))


def source(stepper: Any, laws: Sequence[Any]) -> str:
    """A digest of all that is compiled into a walk with this stepper and these laws of effects."""
    functions = (thing for thing in _own(stepper, laws) if not isinstance(thing, type))
    return _source(tuple(functions))


def compiled(stepper: Any, laws: Sequence[Any] = ()) -> Any:
    """The loop as compiled code; with a user's own stepper or effect it is not kept on disk.

    What is kept there is read by every process, and not all of them can import a user's types.
    """
    return _compile(source(stepper, laws), njit if _own(stepper, laws) else cached_njit)


def walk_range(
    stepper: Any, plates: Any, blocks: Any, reach: Any, tangents: Any, world: kernels.World, *rest: Any
) -> None:
    """The compiled loop; see there for its arguments."""
    laws = [law for chosen in (world.loads, world.gates, world.pushes) for law in chosen or ()]
    compiled(stepper, laws)(stepper, plates, blocks, reach, tangents, world, *rest)
