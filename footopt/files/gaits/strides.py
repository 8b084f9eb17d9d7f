"""The strides of a recording: they are found, cut out, averaged and closed."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import PERIODS, Recording
from footopt.files.gaits.windows import BOTH, TIMES, closing, is_two, mirrored, one_row_short, open_by, steady
from footopt.files.io import Unusable

Array = NDArray[np.float64]

ODD = 0.2  # a stride that is so much longer or shorter than the median is left out
POINTS = 100  # steps of a stride's phase
OPEN = 0.1  # of the motion that the ends of a single stride may differ by ...
MOST_OPEN = 0.15  # ... or, with a note, where no part of it closes better: as children's strides
UNCLEAR, COARSE = 3.0, 1.025  # where a row more makes a table close no more times better or worse, and the
# stride so many times as long, both are said: children's strides close by a tenth either way
LATE = 0.1  # of a single stride; a heel strike that is farther inside is where it ought to begin
L1, L2 = 0.47, 0.45  # leg, m; only the ankle's forward extreme is taken from it
PROMINENT = 0.3  # of the ankle's whole way that it goes back between two heel strikes
UNEVEN = 0.3  # of a stride that the other foot's strike may be before or after its middle
TOGETHER = 0.0  # correlation of both ankles' ways; in walks, runs and on stairs it is below -0.7, in squats 1
SWING = 0.25  # of the way of a straight leg that turns with the thigh; in squats the ankle stays where it is
SLOW, LONG = 0.15, 0.3  # of the ankle's largest speed, below which it rests; of half a stride, as in no walk
BENDS, TIED, LOOP = 25.0, 0.95, 0.15  # deg of a knee; its correlation with the thigh in squats, in walks up
# to 0.88; what their loop encloses of their ranges: 0.3 to 0.75 in walks and runs, nothing in squats
PART = 0.1  # of a stride that a table over its phase may lack, or have more
BEHIND = 40.0  # deg that the ankle may be behind the hip on average; of a crouched leg it is 22
NEAR = 0.3  # of the motion that the first row of such a table may be off where it comes again
REST, RESTING = 15.0, 0.3  # deg/s of thigh and knee below which a leg rests; share of time: no stride has it


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
    """The strides of a recording; one without two heel strikes inside must hold one whole stride.

    Raises
    ------
    Unusable
        It is less than one, or no walk.
    """
    check_walk(recording)
    if recording.stride is not None:
        strides = _of_phase(recording, recording.stride)
    else:
        begins = heel_strikes(recording)
        strides = _single(recording) if len(begins) < 2 else _several(recording, begins)
    _check_way(strides)
    return strides


def check_walk(recording: Recording) -> None:
    """Raise `Unusable` where a leg moves as in no walk."""
    t, ahead = _swing(recording)
    reach, turn = float(np.ptp(ahead)), float(np.ptp(recording.angles["thigh"]))
    if reach < SWING * (L1 + L2) * np.radians(turn):
        raise Unusable(
            f"the thigh turns by {turn:.0f} deg while the ankle moves by {reach:.2f} m only, below the "
            "hip: squats or sitting down, and no walk."
        )
    if recording.other is None:
        return
    now, other = _swing(recording.other)
    both = (t >= now[0]) & (t <= now[-1])
    own, other = ahead[both], np.interp(t[both], now, other)
    if both.sum() < 4 or not (np.ptp(own) and np.ptp(other)):
        return
    alike = float(np.corrcoef(own, other)[0, 1])
    if alike > TOGETHER:
        raise Unusable(
            f"both legs swing together (their ankles' ways correlate at {alike:+.2f}, in a walk at -0.7 "
            "to -1): squats, jumps or sitting down, and no walk."
        )


def _check_way(strides: Strides) -> None:
    """Raise `Unusable` where a leg goes back as it came, or round as in a walk backwards, or stays behind."""
    thigh, knee = (average(strides)[joint] for joint in ("thigh", "knee"))
    upper, lower = np.radians(thigh), np.radians(thigh - knee)
    below = np.mean(L1 * np.cos(upper) + L2 * np.cos(lower))
    behind = -np.degrees(np.arctan2(np.mean(_ankle_ahead(upper, upper - lower)), below))
    if behind > BEHIND:
        raise Unusable(
            f"the ankle lies {behind:.0f} deg behind the hip on average, and in a walk below it: the sign of "
            "thigh or hip is the other one (the knee ahead of the hip is +), or a column is another joint's."
        )
    if np.ptp(knee) < BENDS:  # a stiff knee says nothing
        return
    loop = 0.5 * np.sum(thigh[1:] * knee[:-1] - thigh[:-1] * knee[1:]) / (np.ptp(thigh) * np.ptp(knee))
    tied = np.corrcoef(thigh, knee)[0, 1]
    if abs(loop) < LOOP and tied > TIED:
        raise Unusable(
            f"thigh and knee bend and stretch together (they correlate at {tied:.2f}), and go back as they "
            "came: a squat or sitting down, and no walk."
        )
    if loop < -LOOP:
        raise Unusable(
            "the knee bends while the thigh goes back, as in a walk backwards. If it is none, the sign of "
            "thigh or hip is the other one (the knee ahead of the hip is +), or a column is another joint's."
        )


def _of_phase(recording: Recording, stride: float) -> Strides:
    """A table over the phase of one stride, s, which says how long it is, wherever its rows begin and end."""
    t, angles, notes = recording.t, recording.angles, recording.notes
    held = (t[-1] - t[0] + float(np.median(np.diff(t)))) / stride
    gap = min(open_by(recording), one_row_short(recording))
    if held < 1.0 - PART or gap > NEAR:
        off = f", and its ends differ by {100 * gap:.0f} % of the motion" if gap > NEAR else ""
        raise Unusable(f"not one whole stride: the phase covers {100 * held:.0f} % of one{off}.")
    what = "one stride by its phase, after which the first row comes again"
    if gap > OPEN:
        what += f", though it is {100 * gap:.0f} % of the motion off"
    phase = np.append((t - t[0]) / stride, 1.0)
    closed = {joint: np.append(values, values[0]) for joint, values in angles.items()}
    phase, curves, more = _from_strike(phase, closed, LATE)
    return Strides(phase, curves, np.array([stride]), (*notes, what, *more))


def _single(recording: Recording) -> Strides:
    """A recording that is one stride, or holds one; it begins where the heel strikes."""
    t, angles, notes = recording.t, recording.angles, recording.notes
    _check_moving(recording)
    whole, apart = _closed(recording)
    two = apart <= MOST_OPEN and is_two(recording)
    off = f"its ends differ by {100 * apart:.0f} % of the motion"
    other = recording.other if apart <= MOST_OPEN else None
    if other is not None and min(open_by(other), one_row_short(other)) > BOTH:
        apart, off = np.inf, "the other leg does not end as it began"  # and this one by chance
    inside = closing(recording, False)
    longer = inside is not None and UNCLEAR * inside[2] < apart  # than one stride
    if apart <= OPEN and not (two or longer):
        return whole
    for halves in (False, True):
        window = closing(recording, True) if halves else inside
        if window is None:
            continue
        begin, end, gap = window
        phase = np.arange(POINTS + 1) / POINTS
        if halves:
            curves, period = mirrored(recording, begin, end, phase), 2.0 * (end - begin)
            what = f"half a stride of each leg: {period:.3f} s, some 5 % off if steps differ (gait.period)"
        else:
            curves = {j: np.interp(begin + (end - begin) * phase, t, a) for j, a in angles.items()}
            what, period = f"one stride of {end - begin:.3f} s", end - begin
        ends = f"its ends differ by {100 * gap:.1f} % of the motion"
        notes += (f"{what}, from {begin:.3f} to {end:.3f} s: {ends}",)
        phase, curves, _ = _from_strike(phase, curves, 0.0)
        return Strides(phase, curves, np.array([period]), notes)
    if apart <= MOST_OPEN and not two:
        return whole
    raise Unusable(
        f"not one whole stride: in {t[-1] - t[0]:.3g} s no stride ends as it began, and "
        f"{'in its middle the leg is where it began' if two else off}. Give one heel strike to the next, or "
        "several strides."
    )


def _closed(recording: Recording) -> tuple[Strides, float]:
    """A whole recording as one stride, and the part of the motion that its ends differ by."""
    t, angles = recording.t, recording.angles
    # both legs of a table take as long
    legs = [leg for leg in (recording, recording.other) if leg is not None and len(leg.t) == len(t)]
    whole, again = (float(np.mean([gap(leg) for leg in legs])) for gap in (open_by, one_row_short))
    periods = [t[-1] - t[0], 2.0 * t[-1] - t[-2] - t[0]]
    unclear = periods[1] > COARSE * periods[0] and max(whole, again) < UNCLEAR * min(whole, again)
    apart, what = open_by(recording), "one stride, from the first row to the last"
    if again < whole:
        t = np.append(t, 2.0 * t[-1] - t[-2])
        angles = {joint: np.append(values, values[0]) for joint, values in angles.items()}
        apart, what = one_row_short(recording), "one stride, after whose last row the first one comes again"
        periods.reverse()
    if apart > OPEN:
        what += f", though they differ by {100 * apart:.0f} % of the motion"
    if unclear:
        what += f"; it takes {periods[0]:.4g} s, or else {periods[1]:.4g} s: gait.period sets it"
    phase, curves, more = _from_strike((t - t[0]) / (t[-1] - t[0]), angles, LATE)
    return Strides(phase, curves, t[-1:] - t[0], (*recording.notes, what, *more)), apart


def _from_strike(
    phase: Array, angles: dict[str, Array], late: float
) -> tuple[Array, dict[str, Array], tuple[str, ...]]:
    """Phase and curves (1, phases) of one stride, which begins at the heel strike if that is later than a
    share of it; and notes.
    """
    notes: tuple[str, ...] = ()
    strike = int(np.argmax(_ankle_ahead(*(np.radians(angles[j][:-1]) for j in ("thigh", "knee")))))
    if late < phase[strike] < 1.0 - late:
        notes = (f"the heel strikes at {100 * phase[strike]:.0f} % of it, where it now begins",)
        phase = np.append(np.roll((phase[:-1] - phase[strike]) % 1.0, -strike), 1.0)
        angles = {j: np.append(np.roll(v[:-1], -strike), v[strike]) for j, v in angles.items()}
    return phase, {j: v[None] for j, v in angles.items()}, notes


def _check_moving(recording: Recording) -> None:
    """Raise where a leg that makes no two heel strikes is at rest for a part of the time."""
    t = np.linspace(recording.t[0], recording.t[-1], TIMES)
    speeds = [np.gradient(np.interp(t, recording.t, recording.angles[j]), t) for j in ("thigh", "knee")]
    still = np.maximum(*map(abs, speeds)) < REST
    if still.mean() > RESTING:
        moves = t[~still]
        when = f", and moves from {moves[0]:.2f} to {moves[-1]:.2f} s" if len(moves) else ""
        raise Unusable(
            f"the leg stands still for {100 * still.mean():.0f} % of {t[-1] - t[0]:.3g} s{when}: not one "
            "whole stride of a walk. Give several strides without the standing."
        )


def _several(recording: Recording, begins: Array) -> Strides:
    """The strides between heel strikes, s, without those of another length than usual, those from or to
    standing, and those in which the other foot does not strike once, about half a stride later.
    """
    lengths, good = np.diff(begins), np.ones(len(begins) - 1, bool)
    if (other := recording.other) is not None:
        strikes = heel_strikes(other)
        phases = [
            (strikes[(strikes > b) & (strikes < b + n)] - b) / n
            for b, n in zip(begins, lengths, strict=False)
        ]
        seen = (begins[:-1] >= other.t[0]) & (begins[1:] <= other.t[-1])
        good = np.array([len(p) == 1 and abs(p[0] - 0.5) < UNEVEN for p in phases]) | ~seen
        if not good.any():
            found = ", ".join(f"{x:.2f}" for p in phases for x in p) or "none"
            raise Unusable(
                f"in {len(good)} strides of this leg the other foot strikes at {found} of a stride, and in a "
                "walk does once in each, at about 0.5: no walk, or markers are mistaken."
            )
    uneven = np.sum(~good)
    goes = np.array([steady(recording, *pair) for pair in pairwise(begins)])
    if not (good & goes).any():
        raise Unusable(
            "the hip does not go on through any stride: the subject starts, stops or hesitates. Give a "
            "steady walk."
        )
    stands = _beside_standing(recording, begins) | ~goes
    if (good & ~stands).any():
        good &= ~stands
    standing = np.sum(~good) - uneven
    alike = abs(lengths / np.median(lengths[good]) - 1.0) <= ODD
    if not (good & alike).any():
        found = ", ".join(f"{x:.2f}" for x in lengths[good])
        raise Unusable(f"its strides take {found} s, no two of which are alike. Give a steady walk.")
    good &= alike
    kept, phase = lengths[good], np.arange(POINTS + 1) / POINTS
    times = begins[:-1][good][:, None] + kept[:, None] * phase
    curves = {joint: np.interp(times, recording.t, angle) for joint, angle in recording.angles.items()}
    note = f"{len(kept)} stride{'s' if len(kept) > 1 else ''} of {kept.mean():.3f} s"
    note += f", {kept.min():.3f} to {kept.max():.3f} s" if len(kept) > 1 else ""
    note += f"; {uneven} without one strike of the other foot left out" if uneven else ""
    note += f"; {standing} from or to standing, or hesitating, left out" if standing else ""
    odd = np.sum(~good) - uneven - standing
    note += f"; {odd} of another length left out" if odd else ""
    return Strides(phase, curves, kept, (*recording.notes, note))


def _beside_standing(recording: Recording, begins: Array) -> NDArray[np.bool_]:
    """Of each stride between heel strikes, s, whether the ankle rests for long in the half stride before or
    after it: it is the first or the last of a walk, and no steady one.
    """
    t, ahead = _swing(recording)
    speed = abs(np.gradient(ahead, t))
    rested = np.cumsum(speed < SLOW * speed.max()) * (t[1] - t[0])
    half = 0.5 * np.diff(begins)

    def share(begin: Array) -> Array:
        rest: Array = (np.interp(begin + half, t, rested) - np.interp(begin, t, rested)) / half
        return rest

    beside: NDArray[np.bool_] = np.maximum(share(begins[:-1] - half), share(begins[1:])) > LONG
    return beside


def heel_strikes(recording: Recording) -> Array:
    """Times at which the ankle is farthest ahead of the hip (Zeni et al., Gait & Posture 27, 2008), s."""
    from scipy.signal import find_peaks

    t, ahead = _swing(recording)
    rate = (len(t) - 1) / (t[-1] - t[0])
    peaks, _ = find_peaks(ahead, distance=max(PERIODS[0] * rate, 1), prominence=PROMINENT * np.ptp(ahead))
    before, at, after = ahead[peaks - 1], ahead[peaks], ahead[peaks + 1]
    bend = before - 2.0 * at + after  # of the parabola through the three; none where they are equal
    between = np.divide(0.5 * (before - after), bend, out=np.zeros(len(peaks)), where=bend < 0)
    found: Array = t[peaks] + between / rate
    return found


def _swing(recording: Recording) -> tuple[Array, Array]:
    """Even times, s, and how far the ankle is ahead of the hip, m, without what is faster than a walk."""
    from scipy.signal import butter, sosfiltfilt

    t = np.linspace(recording.t[0], recording.t[-1], len(recording.t))
    rate = (len(t) - 1) / (t[-1] - t[0])
    thigh, knee = (np.radians(np.interp(t, recording.t, recording.angles[j])) for j in ("thigh", "knee"))
    ahead = _ankle_ahead(thigh, knee)
    if rate > 20.0 and len(t) > 30:  # noise has peaks of its own; walking is below 6 Hz
        ahead = sosfiltfilt(butter(2, min(6.0, 0.4 * rate), fs=rate, output="sos"), ahead)
    return t, ahead


def _ankle_ahead(thigh: Array, knee: Array) -> Array:
    """How far the ankle is ahead of the hip, m, of angles in rad."""
    ahead: Array = L1 * np.sin(thigh) + L2 * np.sin(thigh - knee)
    return ahead


def average(strides: Strides) -> dict[str, Array]:
    """The mean curve of each joint, closed: what its ends differ by is spread over the stride."""
    means = {joint: curve.mean(axis=0) for joint, curve in strides.curves.items()}
    return {j: mean - (strides.phase - 0.5) * (mean[-1] - mean[0]) for j, mean in means.items()}
