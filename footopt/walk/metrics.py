"""Peaks, falls and sums of a walk, followed while it is made and between steps, too, and its raw result."""

from typing import NamedTuple

import numpy as np

from footopt.compiled import inlined
from footopt.walk.state import ankle_of, in_world


class Raw(NamedTuple):
    """The raw result of a walk, in natural signs; what objectives are made of."""

    distance: float  # m
    mean_height: float  # m
    work: float  # J
    peak_power: float  # W
    speed_loss: float  # m/s
    joint_work: float  # J
    peak_vertical_force: float  # N
    maximum_sinkage: float  # m
    net_joint_work: float  # J
    impulse_x: float  # N s
    impulse_z: float


RAW = Raw._fields
JUMP = 8.0  # how many times as much as another a parabola is bent that leads through a jump
#: Columns of a trace: time, place, velocity, forces, powers and works, and where each but the first begins.
COLUMNS, PARTS = 13, (1, 3, 5, 9, 11)


class Four(NamedTuple):
    """A quantity at the ends of the last four steps."""

    first: float
    second: float
    third: float
    last: float


class Extremes(NamedTuple):
    """The extremes of a walk so far; all but force and sinkage since the first heel strike."""

    speed: float  # largest forward speed, m/s; -inf before the heel strike
    fall: float  # largest fall of the forward speed below it, m/s
    power: float  # largest |P| of a foot, W
    force: float  # largest vertical force of both feet, N
    sinkage: float  # m
    left: Four  # |P| of the left foot, W
    right: Four
    both: Four  # vertical force of both feet, N
    times: Four  # s


#: Of a walk that has not begun.
NO_EXTREMES = Extremes(-np.inf, 0.0, 0.0, 0.0, 0.0, *[Four(0.0, 0.0, 0.0, 0.0)] * 4)


@inlined
def updated(extremes, before, after, a0, a1, t, h, strike, sinkage):
    """The extremes with one step more, which ends at t and is h long, s.

    before, after: states at its ends. a0, a1: forward accelerations there, m/s^2. strike: first heel
    strike, s. sinkage: of the deepest plate at its end, m.
    """
    now, v0, v1 = after.contact, before.hip.vx, after.hip.vx
    speed, fall, power = extremes.speed, extremes.fall, extremes.power
    left, right = _next(extremes.left, abs(now.left.power)), _next(extremes.right, abs(now.right.power))
    both, times = _next(extremes.both, now.left.z + now.right.z), _next(extremes.times, t)
    if t > strike - 1e-9:  # objectives that begin with the first heel strike
        if speed == -np.inf:
            share = min(max(1.0 - (t - strike) / h, 0.0), 1.0)
            speed, _ = hermite(v0, v1, a0, a1, h, share)
            power = max(_between(left, share), _between(right, share))
        elif a0 * a1 < 0.0:
            extreme = hermite_extreme(v0, v1, a0, a1, h)
            speed = max(speed, extreme)
            fall = max(fall, speed - extreme)
        speed = max(speed, v1)
        fall = max(fall, speed - v1)
        power = max(power, max(left.last, right.last))
        if times.second > strike - 1e-9:
            power = max(power, max(peak(left, times), peak(right, times)))
    force = max(extremes.force, both.last)
    if times.first > 0.0:  # four steps
        force = max(force, peak(both, times))
    return Extremes(speed, fall, power, force, max(extremes.sinkage, sinkage), left, right, both, times)


@inlined
def _next(sample, last):
    """The last four steps with one step more."""
    return Four(sample.second, sample.third, sample.last, last)


@inlined
def _between(sample, share):
    """Linear between the ends of the last step, at a share of it."""
    return sample.third + share * (sample.last - sample.third)


@inlined
def hermite_extreme(v0, v1, a0, a1, h):
    """The velocity's extreme inside a step whose end accelerations differ in sign (cubic Hermite)."""
    rise = v1 - v0
    p, q = h * a0, 3.0 * rise - h * (2.0 * a0 + a1)
    r = h * (a0 + a1) - 2.0 * rise
    root = np.sqrt(max(q * q - 3.0 * p * r, 0.0))  # p + 2 q s + 3 r s^2 = 0
    s = -p / (q + root) if a0 < 0.0 else -p / (q - root)
    return hermite(v0, v1, a0, a1, h, min(max(s, 0.0), 1.0) if np.isfinite(s) else 0.0)[0]


@inlined
def hermite(v0, v1, a0, a1, h, s):
    """A quantity and its rate at the share s of a step, from both at the step's ends."""
    rise = v1 - v0
    q, r = 3.0 * rise - h * (2.0 * a0 + a1), h * (a0 + a1) - 2.0 * rise
    return v0 + s * (h * a0 + s * (q + s * r)), a0 + s * (2.0 * q + 3.0 * s * r) / h


@inlined
def peak(sample, times):
    """The largest of a quantity between the second and the third of four samples.

    Where it is smooth, the parabolas through the first three and through the last three have their vertices
    there, at nearly one height. Behind a jump one of them has not, and no sample is exceeded, or it is bent
    `JUMP` times as much as the other, which then counts alone.
    """
    before, within, after = times.second - times.first, times.third - times.second, times.last - times.third
    rise, slope = (sample.second - sample.first) / before, (sample.third - sample.second) / within
    left = (slope - rise) / (before + within)  # half the second derivatives
    right = ((sample.last - sample.third) / after - slope) / (within + after)
    begins, ends = slope - left * within, slope + right * within
    if begins > 0.0 and slope + left * within < 0.0 and slope - right * within > 0.0 and ends < 0.0:
        a, b = sample.second - 0.25 * begins * begins / left, sample.third - 0.25 * ends * ends / right
        return a if right < JUMP * left else b if left < JUMP * right else 0.5 * (a + b)
    return max(sample.second, sample.third)


@inlined
def step_error(v0, v1, a0, a1, h):
    """Error estimate of a step's velocity, m/s: against the trapezoidal rule through its own ends.

    Its acceleration at both ends is known, so that a second method of order 2 comes for nothing.
    """
    return abs(v1 - v0 - 0.5 * h * (a0 + a1))


@inlined
def sinkage_of(sole, poses, hip):
    """Depth of the lowest end of a plate of both feet below the surface, m; 0 when both are above."""
    depth, rows = 0.0, sole.plates
    x, z, area, tx, tz = rows[0], rows[1], rows[4], rows[5], rows[6]
    for foot in range(2):
        ankle = in_world(ankle_of(poses, foot), hip)
        if ankle.z <= sole.reach:
            for i in range(len(x)):
                middle = ankle.z + ankle.sin * x[i] + ankle.cos * z[i]
                rise = area[i] / sole.width * abs(ankle.sin * tx[i] + ankle.cos * tz[i])
                depth = max(depth, 0.5 * rise - middle)
    return depth


@inlined
def sample_of(t, state):
    """A row of a trace, as in `PARTS`: of the hip at a time t, s, and of the left and the right foot."""
    hip, left, right, sums = state.hip, state.contact.left, state.contact.right, state.integrals
    powers_and_works = left.power, right.power, sums.work_left, sums.work_right
    return (t, hip.x, hip.z, hip.vx, hip.vz, left.x, left.z, right.x, right.z, *powers_and_works)


@inlined
def raw_of(state, extremes, t_f):
    """The raw result of a walk that has come to its end at t_f, s."""
    sums, power, fall = state.integrals, extremes.power, extremes.fall
    if extremes.speed == -np.inf:  # no heel strike
        power = fall = np.nan
    return Raw(
        distance=state.hip.x,
        mean_height=sums.height / t_f,
        work=abs(sums.work_left + sums.work_right),
        peak_power=power,
        speed_loss=fall,
        joint_work=sums.joint,
        peak_vertical_force=extremes.force,
        maximum_sinkage=extremes.sinkage,
        net_joint_work=sums.joint_net,
        impulse_x=sums.impulse_x,
        impulse_z=sums.impulse_z,
    )
