"""The part of a short recording that is one stride: where it closes, or half of one, by symmetry."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import PERIODS, Recording

Array = NDArray[np.float64]

TIMES, SMOOTH = 300, 4.0  # times at which a closed part is looked for; width of their speeds' filter
CLOSED = 0.06  # of the motion that the ends of such a part may differ by
BOTH = 0.2  # of the other leg's motion, that its ends may differ by
EVEN = 0.1  # of a step that others may be longer
TWICE = 0.5  # of the motion; where the leg is nearer in the middle to where it began, there are two strides
STEADY, PACE, PART = 0.6, 0.3, 0.25  # of a hip's mean speed that it keeps; where it goes, m/s; in parts, s
MOST = 0.8  # of the range of thighs that such a part must hold


def closing(recording: Recording, halves: bool) -> tuple[float, float, float] | None:
    """Begin and end, s, of the part of a recording that closes best, and how much of the motion lies between.

    With `halves` it is half a stride, after which each leg is where the other one was. None if none closes.
    """
    other = recording.other if halves else recording
    if other is None:
        return None
    t = np.linspace(max(recording.t[0], other.t[0]), min(recording.t[-1], other.t[-1]), TIMES)
    least, most = (limit / (1 + halves) for limit in PERIODS)
    if t[-1] - t[0] < least:
        return None
    own, after = _state(t, recording), _state(t, other)
    scale = np.maximum(np.ptp(own, axis=1), np.ptp(after, axis=1))
    gap = np.maximum(_apart(own, after, scale), _apart(after, own, scale))
    lag = t - t[:, None]  # of an end (columns) after a begin (rows)
    if not halves:  # nor two strides
        begins, ends = np.indices(gap.shape)
        lag[gap[begins, (begins + ends) // 2] < TWICE] = np.inf
        if (leg := recording.other) is not None and leg.t[0] <= t[0] and t[-1] <= leg.t[-1]:
            second = _state(t, leg)
            gap[_apart(second, second, np.ptp(second, axis=1)) > BOTH] = np.inf
    gap[(lag < least) | (lag > most)] = np.inf
    for _ in range(TIMES):
        row, column = np.unravel_index(np.argmin(gap), gap.shape)
        if not gap[row, column] <= CLOSED:
            return None
        part = np.array([own[0, row : column + 1], after[0, row : column + 1]])
        # of one leg, or both together
        if np.ptp(part) > MOST * scale[0] and steady(recording, t[row], t[column]):
            # how far the end is from its time, of all pairs that are as far apart, by least squares
            later = slice(column - row, None)
            turn = after[2:, later] / scale[:2, None]
            left = (own[:2, : row - column] - after[:2, later]) / scale[:2, None]
            more = float(np.clip(np.sum(left * turn) / np.sum(turn**2), -1.0, 1.0)) * (t[1] - t[0])
            return float(t[row]), min(float(t[column]) + more, float(t[-1])), float(gap[row, column])
        gap[row] = np.inf
    return None


def steady(recording: Recording, begin: float, end: float) -> bool:
    """Whether the hip goes on from begin to end, s, in each of two to four parts: no start, stop or obstacle.

    In 22 steady walks and runs its mean speed in a quarter of a stride is at least 0.8 of the stride's, in
    unsteady ones below 0.4. On a treadmill, and without markers, nothing is known of it.
    """
    if recording.way is None:
        return True
    parts = int(np.clip(round((end - begin) / PART), 2, 4))
    gone = np.diff(np.interp(np.linspace(begin, end, parts + 1), recording.t, recording.way))
    return bool(gone.sum() < PACE * (end - begin) or gone.min() > STEADY * gone.mean())


def open_by(recording: Recording) -> float:
    """The part of the motion that the ends of a recording differ by."""
    state = _state(np.linspace(recording.t[0], recording.t[-1], TIMES), recording)
    return float(_apart(state[:, :1], state[:, -1:], np.ptp(state, axis=1))[0, 0])


def is_two(recording: Recording) -> bool:
    """Whether a leg is in the middle of a recording about where it was in the beginning: no one stride."""
    state = _state(np.linspace(recording.t[0], recording.t[-1], TIMES), recording)
    return bool(_apart(state[:, :1], state[:, TIMES // 2, None], np.ptp(state, axis=1))[0, 0] < TWICE)


def one_row_short(recording: Recording) -> float:
    """The part of the motion by which the first row is not the one that would come after the last.

    As in tables of a stride from 0 to 99 %. The step between is that of a parabola through the speeds of
    two steps before and two after; infinity where rows are few or not evenly spaced.
    """
    steps = np.diff(recording.t)
    if len(steps) < 8 or np.ptp(steps) > EVEN * np.mean(steps):
        return np.inf
    off = []
    for joint in ("thigh", "knee"):
        values = recording.angles[joint]
        turns = np.diff(values)
        step = (4.0 * (turns[0] + turns[-1]) - (turns[1] + turns[-2])) / 6.0
        off.append(abs(values[0] - values[-1] - step) / np.ptp(values))
    return float(max(off))


def _state(t: Array, recording: Recording) -> Array:
    """Thigh and knee, and their speeds, of a leg at times t (n,): (4, n)."""
    from scipy.interpolate import PchipInterpolator
    from scipy.ndimage import gaussian_filter1d

    curves = [PchipInterpolator(recording.t, recording.angles[j])(t) for j in ("thigh", "knee")]
    speeds = [gaussian_filter1d(np.gradient(curve), SMOOTH, mode="nearest") for curve in curves]
    return np.array([*curves, *speeds])


def _apart(begin: Array, end: Array, scale: Array) -> Array:
    """The largest difference of states (4, n), of their scale, a speed's for a quarter: (begins, ends)."""
    weights = np.array([1.0, 1.0, 0.25, 0.25]) / scale
    apart: Array = np.max(abs(end[:, None, :] - begin[:, :, None]) * weights[:, None, None], axis=0)
    return apart


def mirrored(recording: Recording, begin: float, end: float, phase: Array) -> dict[str, Array]:
    """A stride of which one half is that of a leg, and the other half that of the other leg, closed."""
    assert recording.other is not None
    curves = {}
    for joint in ("thigh", "knee"):
        s = 2.0 * phase[phase <= 0.5]
        first, second = (
            np.interp(begin + (end - begin) * s, leg.t, leg.angles[joint])
            for leg in (recording, recording.other)
        )
        back, on = first[0] - second[-1], second[0] - first[-1]
        first = first + 0.5 * (s * on - (1.0 - s) * back)
        second = second + 0.5 * (s * back - (1.0 - s) * on)
        curves[joint] = np.concatenate([first, second[1:]])
    return curves
