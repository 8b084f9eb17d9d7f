"""Which leg of a file is read, and markers of two legs that change places for some frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.markers import Markers
from footopt.files.gaits.names import NEEDED, SIDES, by_subject, find_leg, looked_for
from footopt.files.reading import Unusable

Array = NDArray[np.float64]
Leg = dict[str, Array]

APART = 0.05  # left and right markers that are nearer, m, cannot be told apart by their place
#: The joint that each part is fixed to.
JOINED = {"knee": "hip", "ankle": "knee", "heel": "ankle", "toe": "ankle"}


def both_legs(
    markers: Markers, names: Mapping[str, str], side: str | None
) -> tuple[Leg, Leg | None, tuple[str, ...]]:
    """The leg that is read, the other one if the file has it whole, each markers by part, and notes.

    Of several subjects in a file the first with a whole leg is read.

    Raises
    ------
    Unusable
        A marker is missing.
    """
    sides = (side,) if side else SIDES
    for places in by_subject(markers.places):
        legs = {s: find_leg(places, names, s) for s in SIDES}
        if whole := [s for s in sides if legs[s].keys() >= set(NEEDED)]:
            break
    side = next(iter(whole or sides))
    leg = legs[side]
    if missing := [part for part in NEEDED if part not in leg]:
        twice = f" Two markers are called {', '.join(markers.unclear)}." if markers.unclear else ""
        raise Unusable(
            f"no marker for the {side} {' and '.join(missing)}.{twice} "
            + " ".join(f"For the {part}, looked for {looked_for(part, names, side)}." for part in missing)
            + f" The file has {', '.join(markers.places)}. Name it with gait.names.{missing[0]}=..."
        )
    notes = (*markers.notes, f"the {side} leg")
    other = legs["left" if side == "right" else "right"]
    if names or not other.keys() >= set(NEEDED):
        return leg, None, notes
    return leg, other, notes + _put_back(markers.t, leg, other)


def _put_back(t: Array, leg: Leg, other: Leg) -> tuple[str, ...]:
    """Put markers back, in both legs, that changed sides for some frames; notes that say so.

    They are exchanged only where that makes the legs more rigid and the markers slower.
    """
    notes: tuple[str, ...] = ()
    with np.errstate(invalid="ignore", divide="ignore"):
        across = leg["hip"] - other["hip"]
        across = across / np.linalg.norm(across, axis=1, keepdims=True)
    for part, joint in JOINED.items():
        if not leg.keys() & other.keys() >= {part, joint}:
            continue
        aside = np.sum((leg[part] - other[part]) * across, axis=1)
        if not np.isfinite(aside).any():
            continue  # never seen together
        swapped = np.sign(np.nanmedian(aside)) * aside < -APART
        put = 0
        for begin, end in _runs(swapped):
            now = (leg[part], leg[joint]), (other[part], other[joint])
            if _stiffer(*now[0], *now[1], begin, end) and _slower(t, leg[part], other[part], begin, end):
                exchanged = np.zeros((len(t), 1), bool)
                exchanged[begin:end] = True
                leg[part], other[part] = (
                    np.where(exchanged, other[part], leg[part]),
                    np.where(exchanged, leg[part], other[part]),
                )
                put += end - begin
        if put:
            notes += (f"{part}: left and right exchanged in {put} frames, put back",)
    return notes


def _runs(here: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Begin and end of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], here, [False]])))
    return zip(map(int, edges[::2]), map(int, edges[1::2]), strict=True)


def _stiffer(part: Array, joint: Array, part_2: Array, joint_2: Array, begin: int, end: int) -> bool:
    """Whether the distances of parts from their joints vary less with the parts exchanged in a run."""

    long, long_2 = np.linalg.norm(part - joint, axis=1), np.linalg.norm(part_2 - joint_2, axis=1)
    if not (np.isfinite(long).any() and np.isfinite(long_2).any()):
        return False
    usual, usual_2 = np.nanmedian(long), np.nanmedian(long_2)
    other, other_2 = np.linalg.norm(part_2 - joint, axis=1), np.linalg.norm(part - joint_2, axis=1)
    before = abs(long - usual) + abs(long_2 - usual_2)
    after = abs(other - usual) + abs(other_2 - usual_2)
    return bool(np.nansum(after[begin:end]) < np.nansum(before[begin:end]))


def _slower(t: Array, part: Array, part_2: Array, begin: int, end: int) -> bool:
    """Whether both parts jump less, into a run and out of it, if they are exchanged in it."""
    seen = np.isfinite((part + part_2).sum(axis=1))
    inside, before, after = (
        np.flatnonzero(seen[part_]) + (part_.start or 0)
        for part_ in (slice(begin, end), slice(0, begin), slice(end, None))
    )
    edges = [(a[-1], b[0]) for a, b in ((before, inside), (inside, after)) if len(a) and len(b)]

    def speed(a: Array, b: Array) -> float:
        with np.errstate(divide="ignore", invalid="ignore"):  # of times that are there twice
            return float(sum(np.linalg.norm(a[i] - b[j]) / (t[j] - t[i]) for i, j in edges))

    return speed(part, part_2) + speed(part_2, part) < speed(part, part) + speed(part_2, part_2)
