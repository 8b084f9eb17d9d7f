"""From a recording to its strides: they are found, cut out, averaged and closed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FileError
from footopt.files.reading import named

Array = NDArray[np.float64]

ODD = 0.2  # a stride that is so much longer or shorter than the median is left out
POINTS = 100  # steps of a stride's phase
OPEN = 0.1  # of a joint's range that the ends of a single stride may differ by
BENT = 0.4  # of a joint's largest speed that its speeds at the ends of a single stride may differ by
LATE = 0.1  # of a single stride; a heel strike that is farther inside is where it ought to begin
ENDS = 0.05  # of a single stride over which these speeds are taken
PERIODS = (0.2, 5.0)  # of a stride, s: a sprinter's is .45; anything else is a mistake in the units
#: What a joint of a walker can do, deg; a table in other units or with other columns leaves it.
LIMITS = {"thigh": (-90.0, 120.0), "knee": (-12.0, 170.0), "foot": (-120.0, 120.0)}
LEAST = 3.0  # range of the thigh in a walk, deg; in radians no walk reaches it
JUMP, RARE = 5.0, 12.0  # deg from the mean of its neighbours, and so many times what is usual: a wrong value
FREQUENT = 0.02  # s; between rows farther apart a joint may turn by as much
SKIP = 4.0  # a longer step of time than so many usual ones is a hole in a recording
L1, L2 = 0.47, 0.45  # leg, m; only the ankle's forward extreme is taken from it


@dataclass(frozen=True, eq=False)
class Recording:
    """Angles of one leg over time, with signs as in `footopt.gait.gait`.

    Parameters
    ----------
    t : (n,), s. angles : by joint (thigh, knee and perhaps foot), each (n,), deg.
    notes : what was recognised, mended or assumed, in words.
    """

    t: Array
    angles: dict[str, Array]
    notes: tuple[str, ...] = ()

    @classmethod
    def checked(cls, path: str | Path, rows: Array, notes: tuple[str, ...] = ()) -> Recording:
        """From rows of time, thigh, knee and perhaps foot, (3 or 4, n)."""
        t = rows[0]
        if len(t) < 4 or not np.isfinite(rows).all() or (np.diff(t) <= 0).any():
            raise wrong(path, "needs at least 4 rows, finite, with the time increasing.")
        steps = np.diff(t)
        longest, usual = int(np.argmax(steps)), float(np.median(steps))
        if steps[longest] > SKIP * usual:
            raise wrong(
                path,
                f"nothing is recorded from {t[longest]:.6g} to "
                f"{t[longest + 1]:.6g} s, where rows are usually {usual:.3g} s apart. Fill it, or cut there.",
            )
        angles = dict(zip(("thigh", "knee", "foot"), rows[1:], strict=False))
        check_angles(path, angles)
        for joint, values in angles.items():
            off = abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
            if usual <= FREQUENT and off.max() > max(JUMP, RARE * float(np.median(off))):
                at = 1 + int(np.argmax(off))
                raise wrong(
                    path,
                    f"the {joint} jumps at {t[at]:.6g} s: {values[at]:.4g} deg between "
                    f"{values[at - 1]:.4g} and {values[at + 1]:.4g} deg. Mend it, or cut the file there.",
                )
        return cls(t, angles, notes)


def wrong(path: str | Path, why: str) -> FileError:
    """What to say of a file that holds no gait."""
    return FileError(f"{named(path, 'gait.path')}: {why}")


def check_angles(path: str | Path, angles: dict[str, Array]) -> None:
    """Raise a `FileError` unless these are the angles of a walk, in degrees."""
    for joint, values in angles.items():
        least, most, (low, high) = values.min(), values.max(), LIMITS[joint]
        if not (low <= least and most <= high):
            raise wrong(
                path,
                f"the {joint} goes from {least:.4g} to {most:.4g} deg, beyond "
                f"{low:g} to {high:g} deg. Check the columns, their signs (a bent knee is +), and the units.",
            )
    moved = float(np.ptp(angles["thigh"]))
    if moved < LEAST:
        raise wrong(
            path,
            f"the thigh moves by {moved:.3g} deg only, which is no walk. "
            "Angles must be in degrees; of MOT and STO files, inDegrees says which.",
        )


def check_period(path: str | Path, period: float) -> None:
    """Raise a `FileError` unless a stride can take so long, s."""
    if not PERIODS[0] <= period <= PERIODS[1]:
        raise wrong(
            path,
            f"a stride would take {period:.4g} s, and must take {PERIODS[0]:g} to "
            f"{PERIODS[1]:g} s. Check that the time is in s; gait.period sets another one for the walk.",
        )


class Strides(NamedTuple):
    """Strides of a recording over their phase, from heel strike to heel strike."""

    phase: Array  # (POINTS + 1,) of a found stride, or as many as the file has
    curves: dict[str, Array]  # by joint, each (strides, phases), deg
    periods: Array  # (strides,), s
    notes: tuple[str, ...]
    source: str = ""  # the file

    @property
    def period(self) -> float:
        """The mean, s."""
        return float(self.periods.mean())

    def variation(self) -> tuple[float, float]:
        """How strides differ, one standard deviation: of the logarithm of the period, and of thigh and knee
        at a phase, rms over both and all phases, deg.
        """
        apart = [np.var(self.curves[joint], axis=0, ddof=1) for joint in ("thigh", "knee")]
        return float(np.std(np.log(self.periods), ddof=1)), float(np.sqrt(np.mean(apart)))


def cut(recording: Recording, path: str | Path) -> Strides:
    """The strides of a recording; one without two heel strikes inside must be one whole stride.

    Raises
    ------
    FileError : it is less than one.
    """
    t, notes = recording.t, list(recording.notes)
    begins = heel_strikes(recording)
    if len(begins) < 2:
        phase, angles = (t - t[0]) / (t[-1] - t[0]), recording.angles
        for joint, angle in angles.items():
            if why := _open(phase, angle):
                raise wrong(
                    path,
                    f"at the end of the stride the {joint} {why}: not one whole stride. Give one heel strike "
                    "to the next, or several strides.",
                )
        notes.append("one stride, from the first row to the last")
        strike = int(np.argmax(_ankle_ahead(*(np.radians(angles[j][:-1]) for j in ("thigh", "knee")))))
        if LATE < phase[strike] < 1.0 - LATE:
            notes.append(f"the heel strikes at {100 * phase[strike]:.0f} % of it, where it now begins")
            phase = np.append(np.roll((phase[:-1] - phase[strike]) % 1.0, -strike), 1.0)
            angles = {j: np.append(np.roll(v[:-1], -strike), v[strike]) for j, v in angles.items()}
        return Strides(phase, {j: v[None] for j, v in angles.items()}, t[-1:] - t[0], tuple(notes), str(path))
    lengths = np.diff(begins)
    good = abs(lengths / np.median(lengths) - 1.0) <= ODD
    phase = np.arange(POINTS + 1) / POINTS
    times = begins[:-1][good][:, None] + lengths[good][:, None] * phase
    curves = {joint: np.interp(times, t, angle) for joint, angle in recording.angles.items()}
    spread = f", {lengths[good].min():.3f} to {lengths[good].max():.3f} s" if good.sum() > 1 else ""
    left_out = f"; {np.sum(~good)} of another length left out" if not good.all() else ""
    many = "s" if good.sum() > 1 else ""
    notes.append(f"{good.sum()} stride{many} of {lengths[good].mean():.3f} s{spread}{left_out}")
    return Strides(phase, curves, lengths[good], tuple(notes), str(path))


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
