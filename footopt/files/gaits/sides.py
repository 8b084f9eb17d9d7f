"""Which leg of a file is read, and markers of two legs that change places for some frames."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.markers import Markers, is_seen
from footopt.files.gaits.names import NEEDED, SIDES, by_subject, find_leg, hip_of_pelvis, looked_for
from footopt.files.io import Unusable

Array = NDArray[np.float64]
Leg = dict[str, Array]

APART = 0.05  # left and right markers that are nearer, m, cannot be told apart by their place
HIGH = (
    0.05  # m; markers on the pelvis's front, or a wrong length of the leg in a model, are more above the hip
)
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
        seen = {name: is_seen(place) for name, place in markers.places.items()}
        empty = ", ".join(name for name in seen if not seen[name])
        raise Unusable(
            f"no marker for the {side} {' and '.join(missing)}.{twice} "
            + " ".join(f"For the {part}, looked for {looked_for(part, names, side)}." for part in missing)
            + f" The file has {', '.join(filter(seen.get, seen)) or 'none'}"
            + (f", and without data {empty}" if empty else "")
            + f". Name it with gait.names.{missing[0]}=..."
        )
    notes = (*markers.notes, f"the {side} leg")
    if (pelvis := hip_of_pelvis(places, side, leg["knee"])) is not None:
        thigh = leg["knee"] - pelvis
        above = np.sum((pelvis - leg["hip"]) * thigh, axis=1) / np.linalg.norm(thigh, axis=1)
        if not (above := above[np.isfinite(above)]).any():
            notes += ("hip: from the markers of the pelvis (Harrington et al. 2007)",)
        elif (high := float(np.median(above))) > HIGH:
            notes += (
                f"hip: {high:.2f} m above where the markers of the pelvis have it (Harrington et al. 2007)",
            )
    other = legs["left" if side == "right" else "right"]
    if names or not other.keys() >= set(NEEDED):
        return leg, None, notes
    return leg, other, notes + _put_back(leg, other)


def mirrored(leg: Leg, other: Leg, is_right: bool, forward: Array, up: Array) -> tuple[str, ...]:
    """A note if the leg that is called the right one is on the left of the way forward."""
    across = (leg["hip"] - other["hip"]) @ np.cross(forward, up)
    if not (np.isfinite(across).any() and (np.nanmedian(across) < 0.0) == is_right):
        return ()
    return ("left and right are exchanged, or the axes mirrored; the leg's angles are right all the same",)


def _put_back(leg: Leg, other: Leg) -> tuple[str, ...]:
    """Put markers back, in both legs, that changed sides for some frames; notes that say so.

    They are exchanged only where that makes the legs more rigid and the markers' ways shorter.
    """
    from scipy.ndimage import find_objects, label

    notes: tuple[str, ...] = ()
    across = leg["hip"] - other["hip"]
    width = np.linalg.norm(across, axis=1)
    width[width == 0.0] = np.nan  # hips in one place have no sides
    for part, joint in JOINED.items():
        if not leg.keys() & other.keys() >= {part, joint}:
            continue
        aside = np.sum((leg[part] - other[part]) * across, axis=1)
        if not np.isfinite(aside).any():
            continue  # never seen together
        aside *= np.sign(np.nanmedian(aside)) / width
        put, now = 0, _unrest(leg, other, part, joint)
        for (run,) in find_objects(label(aside < -APART)[0]):
            swapped = leg | {part: leg[part].copy()}, other | {part: other[part].copy()}
            swapped[0][part][run], swapped[1][part][run] = other[part][run], leg[part][run]
            then = _unrest(*swapped, part, joint)
            if (then < now).all():
                leg[part], other[part], now = swapped[0][part], swapped[1][part], then
                put += run.stop - run.start
        if put:
            notes += (f"{part}: left and right exchanged in {put} frames, put back",)
    return notes


def _unrest(leg: Leg, other: Leg, part: str, joint: str) -> Array:
    """How far a part's distance from its joint is from the usual one, and how long its way is, m: sums over
    both legs and the frames in which both are seen.
    """
    places = np.array([[each[part], each[joint]] for each in (leg, other)])
    places = places[..., np.isfinite(places).all(axis=(0, 1, 3)), :]
    apart = np.linalg.norm(places[:, 0] - places[:, 1], axis=-1)
    if not apart.size:  # nothing is more rigid than what is never seen
        return np.zeros(2)
    off = abs(apart - np.median(apart, axis=1, keepdims=True))
    return np.array([off.sum(), np.linalg.norm(np.diff(places[:, 0], axis=1), axis=-1).sum()])
