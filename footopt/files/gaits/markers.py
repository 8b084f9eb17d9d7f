"""Markers over time, and the cells and units that files give them in."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.files.reading import Unusable, number

Array = NDArray[np.float64]

UNITS = {
    **{"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "in": 0.0254, "inch": 0.0254, "inches": 0.0254},
    **{"millimeters": 1e-3, "centimeters": 1e-2, "meters": 1.0},
}
FAR = 1e4  # m; no laboratory is so large


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
    """

    t: Array
    places: dict[str, Array]
    notes: tuple[str, ...] = ()


def to_markers(t: Array, names: Sequence[str], places: Array, notes: tuple[str, ...] = ()) -> Markers:
    """Markers by name, of places (n, markers, 3) in m; at exactly 0, 0, 0 none is."""
    if twice := next((name for name in names if name and names.count(name) > 1), None):
        raise Unusable(f"two markers are called {twice!r}. Which one is it?")
    if len(t) < 2 or not (np.isfinite(t).all() and (np.diff(t) > 0).all()):
        raise Unusable("needs several frames, with the time increasing.")
    if (far := np.nanmax(abs(places), initial=0.0)) > FAR:
        raise Unusable(f"a marker lies {far:.3g} m from the origin. Check it and the units.")
    places = np.where(np.all(places == 0.0, axis=-1, keepdims=True), np.nan, places)
    return Markers(t, {name: places[:, i] for i, name in enumerate(names[: places.shape[1]])}, notes)


def metres(unit: str) -> float:
    """A unit of length that a file states, m."""
    if unit.strip().lower() not in UNITS:
        raise Unusable(
            f"its units are one of {', '.join(UNITS)} in a file that can be read. It says {unit!r}."
        )
    return UNITS[unit.strip().lower()]


def to_numbers(rows: Iterable[tuple[int, Sequence[str]]], wide: int, gaps: bool) -> Array:
    """The cells of numbered lines as numbers, (rows, wide); with `gaps`, an empty or missing one is NaN.

    Raises
    ------
    ValueError
        A cell is not a number, or a row has too many or too few.
    """
    found = []
    for line, cells in rows:
        more = [cell for cell in cells[wide:] if cell]
        if more or (len(cells) < wide and not gaps):
            raise ValueError(f"line {line} has {len(cells)} cells where the header has {wide}")
        try:
            row = [number(cell) if cell or not gaps else np.nan for cell in cells[:wide]]
        except ValueError as error:
            raise ValueError(f"line {line}: {error}") from None
        found.append(row + [np.nan] * (wide - len(row)))
    return np.array(found, float).reshape(-1, wide)


def differing(held: Iterable[tuple[str, str | None, int]]) -> tuple[str, ...]:
    """A note for each count of things that a header states otherwise than it is."""
    return tuple(
        f"the header says {said} {things}, and there are {found}"
        for things, said, found in held
        if said not in (None, "", str(found))
    )
