"""What is read off a walk while it is made: its peaks and falls between steps, too, and its raw result."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined
from footopt.walk.state import pose_of


class Raw(NamedTuple):
    """The raw result of a walk, in natural signs; what objectives are made of."""

    distance: float  # m
    mean_height: float  # m
    work: float  # J
    peak_power: float  # W
    speed_loss: float  # m/s
    positive_joint_work: float  # J
    peak_vertical_force: float  # N
    maximum_sinkage: float  # m
    net_joint_work: float  # J
    impulse_x: float  # N s
    impulse_z: float


class Sample(NamedTuple):
    """A row of a trace: the walker at the end of a step."""

    t: float  # s
    x: float  # hip, m
    z: float
    vx: float  # m/s
    vz: float
    fx_left: float  # N
    fz_left: float
    power_left: float  # W
    work_left: float  # J
    fx_right: float
    fz_right: float
    power_right: float
    work_right: float


RAW, TRACE = Raw._fields, Sample._fields


class Three(NamedTuple):
    """A quantity at the ends of the last three steps."""

    first: float
    middle: float
    last: float


class Extremes(NamedTuple):
    """What a walk has reached so far; all but force and sinkage since the first heel strike."""

    speed: float  # largest forward speed, m/s; -inf before the heel strike
    fall: float  # largest fall of the forward speed below it, m/s
    power: float  # largest |P| of a foot, W
    force: float  # largest vertical force of both feet, N
    sinkage: float  # m
    left: Three  # |P| of the left foot, W
    right: Three
    times: Three  # s


@inlined
def no_extremes():
    """The extremes of a walk that has not begun."""
    none = Three(0.0, 0.0, 0.0)
    return Extremes(-np.inf, 0.0, 0.0, 0.0, 0.0, none, none, none)


@inlined
def updated(extremes, before, after, a0, a1, t, h, strike, sinkage):
    """The extremes with one step more, which ends at t and is h long, s.

    before, after: states at its ends. a0, a1: forward accelerations there, m/s^2. strike: first heel
    strike, s. sinkage: of the deepest plate at its end, m.
    """
    now, v0, v1 = after.contact, before.vx, after.vx
    speed, fall, power = extremes.speed, extremes.fall, extremes.power
    left = Three(extremes.left.middle, extremes.left.last, abs(now.left.power))
    right = Three(extremes.right.middle, extremes.right.last, abs(now.right.power))
    times = Three(extremes.times.middle, extremes.times.last, t)
    if t > strike - 1e-9:  # objectives that begin with the first heel strike
        if speed == -np.inf:
            speed = hermite(v0, v1, a0, a1, h, min(max(1.0 - (t - strike) / h, 0.0), 1.0))
        elif a0 * a1 < 0.0:
            extreme = hermite_extreme(v0, v1, a0, a1, h)
            speed = max(speed, extreme)
            fall = max(fall, speed - extreme)
        speed = max(speed, v1)
        fall = max(fall, speed - v1)
        late = t - h > strike - 1e-9
        power = _highest(_highest(power, left, times, late), right, times, late)
    force = max(extremes.force, now.left.z + now.right.z)
    return Extremes(speed, fall, power, force, max(extremes.sinkage, sinkage), left, right, times)


@inlined
def _highest(power, sample, times, late):
    """The largest |P| so far, with the peak between three samples if all are late enough, W."""
    power = max(power, sample.last)
    if sample.middle > sample.first and sample.middle >= sample.last and late:
        before, after = times.middle - times.first, times.last - times.middle
        power = max(power, vertex(sample.first, sample.middle, sample.last, before, after))
    return power


@inlined
def hermite_extreme(v0, v1, a0, a1, h):
    """The velocity's extreme inside a step whose end accelerations differ in sign (cubic Hermite)."""
    rise = v1 - v0
    p, q = h * a0, 3.0 * rise - h * (2.0 * a0 + a1)
    r = h * (a0 + a1) - 2.0 * rise
    root = np.sqrt(max(q * q - 3.0 * p * r, 0.0))  # p + 2 q s + 3 r s^2 = 0
    s = -p / (q + root) if a0 < 0.0 else -p / (q - root)
    s = min(max(s, 0.0), 1.0) if np.isfinite(s) else 0.0
    return v0 + s * (p + s * (q + s * r))


@inlined
def hermite(v0, v1, a0, a1, h, s):
    """The velocity at the share s of a step."""
    rise = v1 - v0
    q, r = 3.0 * rise - h * (2.0 * a0 + a1), h * (a0 + a1) - 2.0 * rise
    return v0 + s * (h * a0 + s * (q + s * r))


@inlined
def vertex(a, b, c, before, after):
    """Height of the parabola through three samples, the middle one the highest, these times apart."""
    rise, fall = (b - a) / before, (c - b) / after
    slope = (rise * after + fall * before) / (before + after)  # at the middle sample
    return b - 0.25 * slope * slope * (before + after) / (fall - rise)


@inlined
def step_error(v0, v1, a0, a1, h):
    """Error estimate of a step's velocity, m/s: against the trapezoidal rule through its own ends.

    Its acceleration at both ends is known, so that a second method of order 2 comes for nothing.
    """
    return abs(v1 - v0 - 0.5 * h * (a0 + a1))


@inlined
def sinkage_of(sole, poses, z):
    """Depth of the lowest plate of both feet below the surface, m; 0 when both are above."""
    depth = 0.0
    for foot in range(2):
        pose = pose_of(poses, foot)
        za = z + pose.z
        if za <= sole.reach:
            for i in range(len(sole.x)):
                depth = max(depth, -(za + pose.sin * sole.x[i] + pose.cos * sole.z[i]))
    return depth


@inlined
def sample_of(t, state):
    """A row of the trace."""
    left, right, sums = state.contact.left, state.contact.right, state.integrals
    return Sample(
        t, state.x, state.z, state.vx, state.vz, left.x, left.z, left.power, sums.work_left, right.x, right.z,
        right.power, sums.work_right,
    )  # fmt: skip


@inlined
def raw_of(state, extremes, t_f):
    """The raw result of a walk that has come to its end at t_f, s."""
    sums, power, fall = state.integrals, extremes.power, extremes.fall
    if extremes.speed == -np.inf:  # no heel strike
        power = fall = np.nan
    return Raw(
        distance=state.x,
        mean_height=sums.height / t_f,
        work=abs(sums.work_left + sums.work_right),
        peak_power=power,
        speed_loss=fall,
        positive_joint_work=sums.joint,
        peak_vertical_force=extremes.force,
        maximum_sinkage=extremes.sinkage,
        net_joint_work=sums.joint_net,
        impulse_x=sums.impulse_x,
        impulse_z=sums.impulse_z,
    )
