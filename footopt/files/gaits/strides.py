"""The strides of a recording: they are found, cut out, averaged and closed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import Recording
from footopt.files.reading import Unusable

Array = NDArray[np.float64]

ODD = 0.2  # a stride that is so much longer or shorter than the median is left out
POINTS = 100  # steps of a stride's phase
OPEN = 0.1  # of a joint's range that the ends of a single stride may differ by
BENT = 0.4  # of a joint's largest speed that its speeds at the ends of a single stride may differ by
LATE = 0.1  # of a single stride; a heel strike that is farther inside is where it ought to begin
ENDS = 0.05  # of a single stride over which these speeds are taken
L1, L2 = 0.47, 0.45  # leg, m; only the ankle's forward extreme is taken from it


class Strides(NamedTuple):
    """Strides of a recording over their phase, from heel strike to heel strike.

    Parameters
    ----------
    phase : (phases,) array
        Of a stride, from 0 to 1: 101 of a stride that was found, or as many as the file has rows.
    curves : dict of (strides, phases) array, deg
        By joint: thigh, knee and perhaps foot.
    periods : (strides,) array, s
        Duration of each stride.
    notes : tuple of str
        What was recognised, mended or assumed.
    source : str
        The file.
    """

    phase: Array
    curves: dict[str, Array]
    periods: Array
    notes: tuple[str, ...]
    source: str = ""

    @property
    def period(self) -> float:
        """The mean duration, s."""
        return float(self.periods.mean())

    def variation(self) -> tuple[float, float]:
        """How strides differ, one standard deviation: of the logarithm of the period, and of thigh and knee
        at a phase, rms over both and all phases, deg.
        """
        apart = [np.var(self.curves[joint], axis=0, ddof=1) for joint in ("thigh", "knee")]
        return float(np.std(np.log(self.periods), ddof=1)), float(np.sqrt(np.mean(apart)))


def cut(recording: Recording) -> Strides:
    """The strides of a recording; one without two heel strikes inside must be one whole stride.

    Raises
    ------
    Unusable
        It is less than one.
    """
    begins = heel_strikes(recording)
    return _single(recording) if len(begins) < 2 else _several(recording, begins)


def _single(recording: Recording) -> Strides:
    """A recording that is one stride; it begins where the heel strikes."""
    t, angles, notes = recording
    phase = (t - t[0]) / (t[-1] - t[0])
    for joint, angle in angles.items():
        if why := _open(phase, angle):
            raise Unusable(
                f"at the end of the stride the {joint} {why}: not one whole stride. Give one heel strike "
                "to the next, or several strides."
            )
    notes += ("one stride, from the first row to the last",)
    strike = int(np.argmax(_ankle_ahead(*(np.radians(angles[j][:-1]) for j in ("thigh", "knee")))))
    if LATE < phase[strike] < 1.0 - LATE:
        notes += (f"the heel strikes at {100 * phase[strike]:.0f} % of it, where it now begins",)
        phase = np.append(np.roll((phase[:-1] - phase[strike]) % 1.0, -strike), 1.0)
        angles = {j: np.append(np.roll(v[:-1], -strike), v[strike]) for j, v in angles.items()}
    return Strides(phase, {j: v[None] for j, v in angles.items()}, t[-1:] - t[0], notes)


def _several(recording: Recording, begins: Array) -> Strides:
    """The strides between heel strikes, s, without those of another length than usual."""
    lengths = np.diff(begins)
    good = abs(lengths / np.median(lengths) - 1.0) <= ODD
    kept, phase = lengths[good], np.arange(POINTS + 1) / POINTS
    times = begins[:-1][good][:, None] + kept[:, None] * phase
    curves = {joint: np.interp(times, recording.t, angle) for joint, angle in recording.angles.items()}
    note = f"{len(kept)} stride{'s' if len(kept) > 1 else ''} of {kept.mean():.3f} s"
    note += f", {kept.min():.3f} to {kept.max():.3f} s" if len(kept) > 1 else ""
    note += f"; {np.sum(~good)} of another length left out" if not good.all() else ""
    return Strides(phase, curves, kept, (*recording.notes, note))


def heel_strikes(recording: Recording) -> Array:
    """Times at which the ankle is farthest ahead of the hip (Zeni et al., Gait & Posture 27, 2008), s."""
    from scipy.signal import butter, correlate, find_peaks, sosfiltfilt

    t = np.linspace(recording.t[0], recording.t[-1], len(recording.t))
    rate = (len(t) - 1) / (t[-1] - t[0])
    thigh, knee = (np.radians(np.interp(t, recording.t, recording.angles[j])) for j in ("thigh", "knee"))
    ahead = _ankle_ahead(thigh, knee)
    if rate > 20.0 and len(t) > 30:  # noise has peaks of its own; walking is below 6 Hz
        ahead = sosfiltfilt(butter(2, min(6.0, 0.4 * rate), fs=rate, output="sos"), ahead)
    ahead = ahead - ahead.mean()
    again = correlate(ahead, ahead, "full", "fft")[len(t) - 1 :]
    first_low = int(np.argmax(again < 0)) or 1
    period = first_low + int(np.argmax(again[first_low:]))
    peaks, _ = find_peaks(ahead, distance=max(0.6 * period, 1), prominence=0.3 * np.ptp(ahead))
    before, at, after = ahead[peaks - 1], ahead[peaks], ahead[peaks + 1]
    between = 0.5 * (before - after) / (before - 2.0 * at + after)  # of the parabola through the three
    found: Array = t[peaks] + between / rate
    return found


def _ankle_ahead(thigh: Array, knee: Array) -> Array:
    """How far the ankle is ahead of the hip, m, of angles in rad."""
    ahead: Array = L1 * np.sin(thigh) + L2 * np.sin(thigh - knee)
    return ahead


def average(strides: Strides) -> dict[str, Array]:
    """The mean curve of each joint, closed: what its ends differ by is spread over the stride."""
    means = {joint: curve.mean(axis=0) for joint, curve in strides.curves.items()}
    return {j: mean - (strides.phase - 0.5) * (mean[-1] - mean[0]) for j, mean in means.items()}


def _open(phase: Array, curve: Array) -> str:
    """How the end of a joint's single stride differs from its begin, deg; "" if it is one period."""
    apart, moves = abs(curve[-1] - curve[0]), np.ptp(curve)
    if apart > max(OPEN * moves, 1.0):
        return f"is {apart:.1f} deg from where it began"
    if len(phase) * ENDS < 1:  # too few rows to tell speeds
        return ""
    at = np.linspace(0.0, 1.0, round(1 / ENDS) + 1)
    speeds = np.diff(np.interp(at, phase, curve)) / np.diff(at)
    begin, end = 1.5 * speeds[0] - 0.5 * speeds[1], 1.5 * speeds[-1] - 0.5 * speeds[-2]
    if abs(end - begin) > BENT * abs(speeds).max():
        return f"turns by {end:.0f} deg a stride, and at its begin by {begin:.0f}"
    return ""
