"""Angles of one leg over time, and what must hold of them for a walk."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.files.io import Unusable

Array = NDArray[np.float64]

#: What a joint of a walker can do, deg; a table in other units or with other columns leaves it.
LIMITS = {"thigh": (-90.0, 120.0), "knee": (-12.0, 170.0), "foot": (-120.0, 120.0)}
LIES = 55.0  # deg, either way; even who walks crouched has a thigh at 30 in the mean
INCLUDED = 90.0  # deg, of a knee in the mean: who walks so sits
LEAST = 3.0  # range of the thigh in a walk, deg; in radians no walk reaches it
PERIODS = (0.2, 5.0)  # of a stride, s: a sprinter's is 0.45; anything else is a mistake in the units
SHORT = 0.22  # s, less than half a sprinter's stride
JUMP, RARE = 5.0, 12.0  # deg from the mean of its neighbours, and so many times what is usual: a wrong value
FREQUENT = 0.02  # s; between rows farther apart a joint turns by more, as the square
SKIP, SPARSE = 4.0, 0.05  # a step of time longer than so many usual ones, and than so many s, is a hole
CLIMB = 0.15  # m; a hip that rises or sinks by more over a recording is on stairs or a slope


class Recording(NamedTuple):
    """Angles of one leg over time.

    Parameters
    ----------
    t : (n,) array, s
        Times, increasing.
    angles : dict of (n,) array, deg
        By joint: thigh (from the vertical, + knee ahead of the hip), knee (+ flexion) and perhaps foot
        (pitch, + toe up).
    notes : tuple of str
        What was recognised, mended or assumed.
    other : Recording, optional
        The other leg, which a stride is checked by.
    way : (n,) array, m, optional
        How far forward the hip is, of markers.
    stride : float, s, optional
        After which a table over the phase of one stride begins again.
    """

    t: Array
    angles: dict[str, Array]
    notes: tuple[str, ...] = ()
    other: Recording | None = None
    way: Array | None = None
    stride: float | None = None


def recording(rows: Array, notes: tuple[str, ...] = (), unit: str = "deg") -> Recording:
    """Rows of time, s, and thigh, knee and perhaps foot in a unit, (3 or 4, n), as a `Recording`.

    A foot that cannot be one is left out, with a note: it follows the shank unless gait.pitch=measured.

    Raises
    ------
    Unusable
        The rows are no walk, or have a hole or a wrong value.
    """
    many, more = in_time(rows[0])
    t, rows = rows[0, :many], to_degrees(unit) * rows[1:, :many]
    if many < 4:
        raise Unusable(f"has {many} row{'s' * (many != 1)}, and a walk needs at least 4.")
    steps = np.diff(t)
    if t[-1] - t[0] + steps[-1] < SHORT:
        raise Unusable(
            f"its {many} rows are {t[-1] - t[0]:.3g} s in all, too short for a stride. Is the time in s? "
            "Give one heel strike to the next, or several strides."
        )
    longest, usual = int(np.argmax(steps)), float(np.median(steps))
    if steps[longest] > max(SKIP * usual, SPARSE):
        raise Unusable(
            f"nothing is recorded from {t[longest]:.6g} to {t[longest + 1]:.6g} s, where rows are usually "
            f"{usual:.3g} s apart. Fill it, or cut there."
        )
    notes += more
    angles = {}
    for joint, values in zip(LIMITS, rows, strict=False):
        try:
            _check_joint(joint, t, values, unit)
            angles[joint] = values
        except Unusable as why:
            if joint != "foot":
                raise
            notes += (f"no pitch of the foot: {why}",)
    return Recording(t, angles, notes)


def in_time(t: Array) -> tuple[int, tuple[str, ...]]:
    """How many rows can be read, without a last one that has the time of the one before it; and notes.

    Raises
    ------
    Unusable
        The time does not increase.
    """
    many, notes = len(t), tuple[str, ...]()
    if many > 1 and t[-1] == t[-2]:
        many, notes = many - 1, (f"the last row, again at {t[-1]:.6g} s, is left out",)
    if not (np.diff(t[:many]) > 0).all() or not np.isfinite(t[:many]).all():
        row = int(np.argmin(np.append(np.diff(t[:many]) > 0, True)))
        raise Unusable(
            f"the time must increase, and goes from {t[row]:.6g} s to {t[row + 1]:.6g} s after row {row + 1} "
            "of the data."
        )
    return many, notes


def climbing(height: Array) -> tuple[str, ...]:
    """A note if the hip, or the pelvis, at some heights (n,), m, rises or sinks from begin to end."""
    some = max(len(height) // 10, 1)
    climb = float(np.mean(height[-some:]) - np.mean(height[:some]))
    if abs(climb) < CLIMB:
        return ()
    way = "rises" if climb > 0 else "sinks"
    return (f"the hip {way} by {abs(climb):.2f} m: stairs or a slope, and no level ground",)


def to_degrees(unit: str) -> float:
    """Degrees in a unit of angle."""
    if unit not in ("deg", "rad"):
        raise Unusable(f"holds angles: gait.units must be deg or rad for it, and is {unit!r}.")
    return float(np.degrees(1.0)) if unit == "rad" else 1.0


def check_angles(angles: dict[str, Array], unit: str = "deg") -> None:
    """Raise `Unusable` unless these are the angles of a walk, in degrees; a file has them in a unit."""
    for joint, values in angles.items():
        least, most, (low, high) = values.min(), values.max(), LIMITS[joint]
        if not (low <= least and most <= high):
            raise Unusable(
                f"the {joint} goes from {least:.4g} to {most:.4g} deg, beyond {low:g} to {high:g} deg. "
                "No straight walk? Else check columns or markers, signs (a bent knee is +), and units."
            )
    moved = float(np.ptp(angles.get("thigh", [0.0, LEAST])))
    if moved < LEAST:
        other = (
            "They are read in radians: gait.units=deg says otherwise."
            if unit == "rad"
            else "Or a table has angles in radians: gait.units=rad says so; of MOT and STO files, inDegrees."
        )
        raise Unusable(f"the thigh moves by {moved:.3g} deg only: the subject stands. {other}")


def check_period(period: float) -> None:
    """Raise `Unusable` unless a stride can take so long, s."""
    if not PERIODS[0] <= period <= PERIODS[1]:
        raise Unusable(
            f"a stride would take {period:.4g} s, and must take {PERIODS[0]:g} to {PERIODS[1]:g} s. "
            "Check that the time is in s; gait.period sets another one for the walk."
        )


def _check_joint(joint: str, t: Array, values: Array, unit: str) -> None:
    if not (finite := np.isfinite(values)).all():
        row = int(np.argmin(finite))
        raise Unusable(f"row {row + 1} of the data, at {t[row]:.6g} s, has no finite angle of the {joint}.")
    mean = float(np.mean(values))
    if joint == "thigh" and abs(mean) > LIES:
        raise Unusable(
            f"the thigh points {mean:.0f} deg ahead of the vertical on average, and in a walk {LIES:g} at "
            "most: are the model's axes turned (pelvis_tilt), or the columns others?"
        )
    if joint == "knee" and mean > INCLUDED:
        raise Unusable(
            f"the knee is bent by {mean:.0f} deg on average: is it the angle between thigh and shank, 180 "
            "of a straight leg? Give 180 less it."
        )
    check_angles({joint: values}, unit)
    share = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    off = abs(values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:])
    turn = JUMP * max(float(np.median(np.diff(t))) / FREQUENT, 1.0) ** 2
    if off.max() > max(turn, RARE * float(np.median(off))):
        at = 1 + int(np.argmax(off))
        raise Unusable(
            f"the {joint} jumps at {t[at]:.6g} s: {values[at]:.4g} deg between "
            f"{values[at - 1]:.4g} and {values[at + 1]:.4g} deg. Mend it, or cut the file there."
        )
