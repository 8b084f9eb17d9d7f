"""Markers over time, and the units that files give them in."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import in_time
from footopt.files.io import Unusable

Array = NDArray[np.float64]

UNITS = {
    **{"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "in": 0.0254, "inch": 0.0254, "inches": 0.0254},
    **{"millimeters": 1e-3, "centimeters": 1e-2, "meters": 1.0},
}


class Markers(NamedTuple):
    """Markers over time.

    Parameters
    ----------
    t : (n,) array, s
        Times, increasing.
    places : dict of (n, 3) array, m
        By name; NaN where a marker is not seen.
    notes : tuple of str
        What of the file is odd.
    unclear : tuple of str
        Names that two markers have, so that neither is read.
    """

    t: Array
    places: dict[str, Array]
    notes: tuple[str, ...] = ()
    unclear: tuple[str, ...] = ()


def to_markers(t: Array, names: Sequence[str], places: Array, notes: tuple[str, ...] = ()) -> Markers:
    """Markers by name, of places (n, markers, 3) in m; at exactly 0, 0, 0 none is.

    Of several with one name the one with data is read; where two have data, neither.
    """
    many, more = in_time(t)
    t, places, notes = t[:many], places[:many], notes + more
    if many < 2:
        raise Unusable(f"has {many} frames, and a walk needs several.")
    places = np.where(np.all(places == 0.0, axis=-1, keepdims=True), np.nan, places)
    found: dict[str, Array] = {}
    unclear = []
    for name, place in zip(names, places.transpose(1, 0, 2), strict=False):
        if name not in found or not is_seen(found[name]):
            found[name] = place
        elif name and is_seen(place) and not np.array_equal(place, found[name], equal_nan=True):
            unclear.append(name)
    if twice := dict.fromkeys(n for n in names if n and n not in unclear and names.count(n) > 1):
        notes += (f"of the markers called {', '.join(twice)}, the first with data is read",)
    kept = {name: place for name, place in found.items() if name and name not in unclear}
    return Markers(t, kept, notes, tuple(dict.fromkeys(unclear)))


def is_seen(place: Array) -> bool:
    """Whether a marker is seen at all."""
    return bool(np.isfinite(place).any())


def metres(unit: str, setting: str | None = None) -> float:
    """A unit of length, m: that of the setting gait.units, or else the one that a file states."""
    given = (setting or unit).strip().lower()
    if given not in UNITS:
        raise Unusable(
            f"its unit of length must be one of {', '.join(UNITS)}, and is {given!r}. "
            "Set gait.units to the right one."
        )
    return UNITS[given]


def differing(held: Iterable[tuple[str, str | None, int]]) -> tuple[str, ...]:
    """A note for each count of things that a header states otherwise than it is."""
    return tuple(
        f"the header says {said} {things}, and there are {found}"
        for things, said, found in held
        if said not in (None, "", str(found))
    )
