"""Angles of one leg over time, and what must hold of them for a walk."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.files.reading import Unusable

Array = NDArray[np.float64]

#: What a joint of a walker can do, deg; a table in other units or with other columns leaves it.
LIMITS = {"thigh": (-90.0, 120.0), "knee": (-12.0, 170.0), "foot": (-120.0, 120.0)}
LEAST = 3.0  # range of the thigh in a walk, deg; in radians no walk reaches it
PERIODS = (0.2, 5.0)  # of a stride, s: a sprinter's is 0.45; anything else is a mistake in the units
JUMP, RARE = 5.0, 12.0  # deg from the mean of its neighbours, and so many times what is usual: a wrong value
FREQUENT = 0.02  # s; between rows farther apart a joint may turn by as much
SKIP = 4.0  # a longer step of time than so many usual ones is a hole in a recording


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
    """

    t: Array
    angles: dict[str, Array]
    notes: tuple[str, ...] = ()


def recording(rows: Array, notes: tuple[str, ...] = ()) -> Recording:
    """Rows of time, thigh, knee and perhaps foot, (3 or 4, n), as a `Recording`.

    Raises
    ------
    Unusable
        The rows are no walk, or have a hole or a wrong value.
    """
    t = rows[0]
    steps = np.diff(t)
    if len(t) < 4 or not np.isfinite(rows).all() or (steps <= 0).any():
        raise Unusable("needs at least 4 rows, finite, with the time increasing.")
    longest, usual = int(np.argmax(steps)), float(np.median(steps))
    if steps[longest] > SKIP * usual:
        raise Unusable(
            f"nothing is recorded from {t[longest]:.6g} to {t[longest + 1]:.6g} s, where rows are usually "
            f"{usual:.3g} s apart. Fill it, or cut there."
        )
    angles = dict(zip(("thigh", "knee", "foot"), rows[1:], strict=False))
    check_angles(angles)
    if usual <= FREQUENT:
        for joint, values in angles.items():
            _check_jumps(joint, t, values)
    return Recording(t, angles, notes)


def check_angles(angles: dict[str, Array]) -> None:
    """Raise `Unusable` unless these are the angles of a walk, in degrees."""
    for joint, values in angles.items():
        least, most, (low, high) = values.min(), values.max(), LIMITS[joint]
        if not (low <= least and most <= high):
            raise Unusable(
                f"the {joint} goes from {least:.4g} to {most:.4g} deg, beyond {low:g} to {high:g} deg. "
                "Check the columns, their signs (a bent knee is +), and the units."
            )
    moved = float(np.ptp(angles["thigh"]))
    if moved < LEAST:
        raise Unusable(
            f"the thigh moves by {moved:.3g} deg only, which is no walk. "
            "Angles must be in degrees; of MOT and STO files, inDegrees says which."
        )


def check_period(period: float) -> None:
    """Raise `Unusable` unless a stride can take so long, s."""
    if not PERIODS[0] <= period <= PERIODS[1]:
        raise Unusable(
            f"a stride would take {period:.4g} s, and must take {PERIODS[0]:g} to {PERIODS[1]:g} s. "
            "Check that the time is in s; gait.period sets another one for the walk."
        )


def _check_jumps(joint: str, t: Array, values: Array) -> None:
    off = abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
    if off.max() > max(JUMP, RARE * float(np.median(off))):
        at = 1 + int(np.argmax(off))
        raise Unusable(
            f"the {joint} jumps at {t[at]:.6g} s: {values[at]:.4g} deg between "
            f"{values[at - 1]:.4g} and {values[at + 1]:.4g} deg. Mend it, or cut the file there."
        )
