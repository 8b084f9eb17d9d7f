"""From a leg's angles over time to its strides: a window that is given, or the period that repeats."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from footopt.arrays import Array
from footopt.errors import Unusable
from footopt.gait import HARMONICS, Fourier

PERIOD_RANGE = (0.02, 5.0)  # of a stride, s: a sprinter's is 0.45, that of a robot of 1 g 0.1
MIN_AUTOCORRELATION = 0.8  # least autocorrelation that is a period
PEAK_MARGIN = 0.1  # below the largest autocorrelation; the first lag that has as much is one stride, not two
MOST_OF_WINDOW = 0.6  # share of a window for one stride; with a shorter period, the window holds several
WIDEST = 0.26  # share of a stride: largest gap between two rows
MAX_GAP = 5.0  # deg by which thigh and knee may differ at the ends of a stride
MAX_DEVIATION = 6.0  # deg rms by which a stride may differ from the mean of all
MAX_STRIKE_PHASE = 0.1  # of a stride: where the heel strikes later, the stride is shifted to begin there
LEAST_LOOP = -0.15  # of the ranges of thigh and knee, what their loop encloses; in walks it is 0.3 to 0.75
MOST_ANKLE = 2.0  # times what the ankle would turn if the foot's pitch had the other sign; a level foot: 1
ANGLES = ("thigh", "knee")
#: The range of a walker's joints, deg; a table in other units or with other columns leaves it.
ANGLE_RANGES = {"thigh": (-90.0, 120.0), "knee": (-12.0, 170.0), "foot": (-120.0, 120.0)}
WINDOW_HINT = "Set gait.window=[t0,t1] to one stride, in s, from one heel strike to the next of the same leg."


class Strides(NamedTuple):
    """Strides of a recording over their phase, from heel strike to heel strike."""

    phase: Array  # (phases,), from 0 to 1
    #: (strides, phases), deg, by joint: thigh (from the vertical, + knee ahead of the hip), knee (+ flexion)
    #: and perhaps foot (pitch, + toe up)
    curves: dict[str, Array]
    periods: Array  # (strides,), s
    notes: tuple[str, ...]  # properties that were recognised or assumed

    def mean(self) -> dict[str, Array]:
        """The mean curve of each joint, closed: the gap between its ends is spread over the stride."""
        means = {joint: curves.mean(axis=0) for joint, curves in self.curves.items()}
        return {j: mean - (self.phase - 0.5) * (mean[-1] - mean[0]) for j, mean in means.items()}


def cut(
    t: Array, angles: dict[str, Array], window: tuple[float, float] | None = None, notes: tuple[str, ...] = ()
) -> Strides:
    """The strides of a leg from its angles (n,), deg, by joint, at times t (n,), s, which increase.

    A window (s) is one stride. By default all whole strides of the period of thigh and knee are taken; if
    they have none, the recording is one stride. `notes` are on the file. Raises `Unusable` if a stride does
    not close, strides differ too much, or they are no walk.
    """
    from scipy.interpolate import CubicSpline

    if not (np.diff(t) > 0).all():
        row = int(np.argmin(np.diff(t) > 0))
        raise Unusable(f"the time must increase, and goes from {t[row]:.6g} to {t[row + 1]:.6g} s.")
    for joint, values in angles.items():
        (low, high), least, largest = ANGLE_RANGES[joint], values.min(), values.max()
        if not low <= least <= largest <= high:
            raise Unusable(
                f"the {joint} reaches from {least:.4g} to {largest:.4g} deg, and may from {low:g} to "
                f"{high:g}. Check the columns, signs and units."
            )
    if window and not t[0] - 1e-9 <= window[0] < window[1] <= t[-1] + 1e-9:
        raise Unusable(f"gait.window = {list(window)} is not in the file, from {t[0]:g} to {t[-1]:g} s.")
    period = None if window else _period(t, angles)
    phase = np.linspace(0.0, 1.0, 101)
    if period is not None:
        bounds = _bounds(t, angles, period)
        notes += (f"{len(bounds) - 1} strides of {np.diff(bounds).mean():.3f} s, found by autocorrelation",)
    elif window:
        bounds = np.array(window, float)
    else:
        bounds, phase = t[[0, -1]], (t - t[0]) / (t[-1] - t[0])
        notes += (f"one stride of {t[-1] - t[0]:.4g} s, from the first row to the last",)
    used = (t[1:] > bounds[0]) & (t[:-1] < bounds[-1])
    missing = np.where(used, np.diff(t), 0.0)
    if missing.max() > WIDEST * np.diff(bounds).mean():
        begin = t[missing.argmax()]
        raise Unusable(f"no rows from {begin:.4g} to {begin + missing.max():.4g} s. {WINDOW_HINT}")
    if window:
        inside = (t >= window[0]) & (t <= window[1])
        again = _period(t[inside], {joint: values[inside] for joint, values in angles.items()})
        if again is not None and again < MOST_OF_WINDOW * (window[1] - window[0]):
            raise Unusable(f"gait.window = {list(window)} holds more than one stride, of {again:.3g} s.")
    times = np.array([np.clip(a + (b - a) * phase, t[0], t[-1]) for a, b in pairwise(bounds)])
    curves = {joint: CubicSpline(t, values)(times) for joint, values in angles.items()}
    strides = Strides(phase, curves, np.diff(bounds), notes)
    _check(strides, bounds)
    return _from_strike(strides, always=period is not None)


def _period(t: Array, angles: dict[str, Array]) -> float | None:
    """The least lag, s, at which thigh and knee are most like themselves; None if they never are."""
    from scipy.signal import find_peaks

    step = float(np.median(np.diff(t)))
    even = np.arange(t[0], t[-1], step)
    rows = np.array([np.interp(even, t, angles[joint]) for joint in ANGLES])
    power = np.var(rows, axis=1)
    low, high = round(PERIOD_RANGE[0] / step), min(round(PERIOD_RANGE[1] / step), int(0.53 * len(even)) + 1)
    lags = np.arange(max(low, 2), high + 1)
    if len(lags) < 3 or not power.all():
        return None
    off = [np.mean(np.square(rows[:, lag:] - rows[:, :-lag]), axis=1) / (2.0 * power) for lag in lags]
    alike = 1.0 - np.mean(off, axis=1)
    peaks, _ = find_peaks(alike, MIN_AUTOCORRELATION)
    peaks = peaks[peaks > np.argmax(alike < MIN_AUTOCORRELATION)]  # before that, it is like itself at rest
    if not len(peaks):
        return None
    first = peaks[alike[peaks] > alike[peaks].max() - PEAK_MARGIN][0]
    before, here, after = alike[first - 1 : first + 2]  # a parabola has its top between lags
    return step * float(lags[first] + 0.5 * (before - after) / (before - 2.0 * here + after))


def _bounds(t: Array, angles: dict[str, Array], period: float) -> Array:
    """Where strides begin and end, (strides + 1,), s: each where those about it are most like their mean."""
    count = max(int((t[-1] - t[0]) / period + 1e-3), 1)
    bounds: Array = t[0] + period * np.arange(count + 1)
    rows = np.radians([angles[joint] for joint in ANGLES])
    for _ in range(5):
        extended = np.concatenate([[2 * bounds[0] - bounds[1]], bounds, [2 * bounds[-1] - bounds[-2]]])
        phase = np.interp(t, extended, np.arange(-1, len(bounds) + 1))
        mean, rate = zip(*(Fourier.fit(phase, angles[j], HARMONICS).at(phase) for j in ANGLES), strict=True)
        left, slope = rows - np.array(mean), np.array(rate)
        for k, bound in enumerate(bounds):
            near = abs(t - bound) < 0.5 * period
            bounds[k] -= period * np.sum((left * slope)[:, near]) / np.sum(slope[:, near] ** 2)
    return bounds


def _check(strides: Strides, bounds: Array) -> None:
    """Raise `Unusable` unless the mean stride closes, all are like it, and go forwards."""
    for joint in ANGLES:
        curves = strides.curves[joint]
        gap = float(abs(np.mean(curves[:, -1] - curves[:, 0])))
        if gap > MAX_GAP:
            raise Unusable(
                f"no stride closes from {bounds[0]:.4g} to {bounds[-1]:.4g} s: the {joint} differs by "
                f"{gap:.1f} deg at its ends, and may by {MAX_GAP:g}. {WINDOW_HINT}"
            )
        apart = np.sqrt(np.mean(np.square(curves - curves.mean(axis=0)), axis=1))
        worst = int(np.argmax(apart))
        if apart[worst] > MAX_DEVIATION:
            raise Unusable(
                f"the stride from {bounds[worst]:.4g} to {bounds[worst + 1]:.4g} s differs from the mean by "
                f"{apart[worst]:.1f} deg rms in the {joint}: no steady walk. {WINDOW_HINT}"
            )
    period, (least, largest) = strides.periods.mean(), PERIOD_RANGE
    if not least <= period <= largest:
        why = f"a stride of {period:.4g} s is no walk: those take {least:g} to {largest:g} s"
        raise Unusable(f"{why}. Is the time in s? Or no period was found. {WINDOW_HINT}")
    mean = strides.mean()
    thigh, knee = (mean[joint] for joint in ANGLES)
    loop = 0.5 * np.sum(thigh[1:] * knee[:-1] - thigh[:-1] * knee[1:])
    if loop < LEAST_LOOP * np.ptp(thigh) * np.ptp(knee):
        raise Unusable("the knee bends as in a walk backwards. Is thigh or hip + where the knee is ahead?")
    pitch, shank = mean.get("foot", thigh - knee), thigh - knee
    if np.ptp(pitch - shank) > MOST_ANKLE * np.ptp(pitch + shank):
        raise Unusable("the foot turns against the shank. Is its pitch + where the toes are up?")


def _from_strike(strides: Strides, always: bool) -> Strides:
    """The strides from the heel strike on, where the ankle is farthest ahead of the hip.

    One that begins within `MAX_STRIKE_PHASE` of it stays as it is, unless `always`.
    """
    from scipy.interpolate import CubicSpline

    phase, mean, fine = strides.phase, strides.mean(), np.linspace(0.0, 1.0, 10_001)
    thigh, knee = (Fourier.fit(phase[:-1], mean[j][:-1], HARMONICS).at(fine)[0] for j in ANGLES)
    ahead = np.sin(thigh) + np.sin(thigh - knee)  # thigh and shank are as long
    strike = fine[np.argmax(ahead[:-1])]
    if not always and not MAX_STRIKE_PHASE < strike < 1.0 - MAX_STRIKE_PHASE:
        return strides
    curves = {j: CubicSpline(phase, c, axis=1)((phase + strike) % 1.0) for j, c in strides.curves.items()}
    note = f"the heel strikes at {100 * strike:.0f} % of the stride, where it now begins"
    return Strides(phase, curves, strides.periods, strides.notes + (() if always else (note,)))
