"""From markers to the angles of a leg in its plane of motion.

Nothing is assumed of the laboratory's axes: up is from the ankle to the hip, the plane of motion is
where the ankle swings, and forward is the way the knee bends.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import Recording, recording
from footopt.files.gaits.markers import Markers
from footopt.files.gaits.names import NEEDED, SIDES, find_leg, looked_for
from footopt.files.reading import Unusable

Array = NDArray[np.float64]

SEGMENT = (0.1, 0.9)  # length of a thigh or shank, m; anything else is a mistake in the units
STRETCH = 0.2  # a distance of hip and knee, or knee and ankle, farther from the median: no marker of a leg
SPEED = 15.0  # m/s; a marker that is faster than a sprinter's foot has jumped
APART = 0.05  # left and right markers that are nearer, m, cannot be told apart by their place
BACKWARDS = 0.3  # m that the hip may go backwards, on a treadmill


def leg_angles(markers: Markers, names: Mapping[str, str], side: str | None, max_gap: float) -> Recording:
    """Thigh, knee and, with heel and toe, the foot's pitch of one leg.

    Parameters
    ----------
    markers : Markers
        What a file holds.
    names : mapping
        The file's own names of hip, knee, ankle, heel, toe, where they are not usual.
    side : str, optional
        "right" or "left"; by default the right one, or the left one if the right one's markers are missing.
    max_gap : float, s
        Longest gap of a marker that is filled by a spline.

    Raises
    ------
    Unusable
        A marker is missing, unseen for too long, or where no leg can be.
    """
    side, seen, notes = _seen(markers, names, side)
    t, places, filled = _filled(markers.t, seen, max_gap)
    hip, knee, ankle = (places[part] for part in NEEDED)
    up = _up(hip - ankle)
    forward = _forward(hip, knee, ankle, up)
    (thigh, l1), (shank, l2) = (_segment(a, b, forward, up) for a, b in ((hip, knee), (knee, ankle)))
    _check_walk((hip[-1] - hip[0]) @ forward, {"thigh": l1.mean(), "shank": l2.mean()})
    _check_rigid(markers.t, seen)
    of_hip, of_ankle = (np.std(_steady(t, place @ forward)) for place in (hip, ankle))
    if of_hip > of_ankle:
        raise Unusable(f"the hip swings by {of_hip:.3f} m (rms), the ankle by {of_ankle:.3f} m: exchanged?")
    notes += (
        *filled,
        f"thigh {l1.mean():.3f} m and shank {l2.mean():.3f} m long in the file (to walk with such legs: "
        f"walker.l1={l1.mean():.3f} walker.l2={l2.mean():.3f})",
        f"up is {_axis(up)}, forward about {_axis(forward)}",
    )
    rows = [t, thigh, thigh - shank]
    if {"heel", "toe"} <= places.keys():
        pitch, _ = _segment(places["heel"], places["toe"], forward, up)
        # markers sit at different heights: the foot is level while the ankle is lowest and slowest
        rows.append(pitch - np.median(pitch[np.argsort(ankle @ up)[: len(pitch) // 4]]))
        notes += ("foot: level where the ankle is lowest",)
    return recording(np.array(rows), notes)


def _seen(
    markers: Markers, names: Mapping[str, str], side: str | None
) -> tuple[str, dict[str, Array], tuple[str, ...]]:
    """The leg that is read, its markers by part, and notes."""
    legs = {s: find_leg(markers.places, names, s) for s in SIDES}
    side = side or next((s for s in SIDES if legs[s].keys() >= set(NEEDED)), "right")
    leg = legs[side]
    if missing := [part for part in NEEDED if part not in leg]:
        raise Unusable(
            f"no marker for the {side} {' and '.join(missing)}. "
            + " ".join(f"For the {part}, looked for {looked_for(part, names, side)}." for part in missing)
            + f" The file has {', '.join(markers.places)}. Name it with gait.names.{missing[0]}=..."
        )
    notes = (*markers.notes, f"the {side} leg")
    other = legs["left" if side == "right" else "right"]
    if not names and other.keys() >= set(NEEDED):
        notes += _put_back(leg, other)
    return side, leg, notes


def _put_back(leg: dict[str, Array], other: dict[str, Array]) -> tuple[str, ...]:
    """Put markers back, in `leg`, that changed sides for some frames; notes that say so."""
    notes: tuple[str, ...] = ()
    between = leg["hip"] - other["hip"]
    if not np.isfinite(between.sum(axis=1)).any():
        return notes
    hips = np.nanmean(between, axis=0)
    for part in leg.keys() & other.keys() - {"hip"}:
        aside: Array = (leg[part] - other[part]) @ (hips / np.linalg.norm(hips))
        if not np.isfinite(aside).any():
            continue  # never seen together
        swapped = (1.0 if np.nanmedian(aside) >= 0 else -1.0) * aside < -APART
        if swapped.any():
            leg[part] = np.where(swapped[:, None], other[part], leg[part])
            notes += (f"{part}: left and right exchanged in {swapped.sum()} frames, put back",)
    return notes


def _check_rigid(t: Array, places: dict[str, Array]) -> None:
    """Raise where a leg's marker jumps: from the joint before it, or in time."""
    for part, from_ in (("knee", "hip"), ("ankle", "knee")):
        lengths = np.linalg.norm(places[part] - places[from_], axis=1)
        usual = float(np.nanmedian(lengths))
        worst = int(np.nanargmax(abs(lengths - usual)))
        if abs(lengths[worst] - usual) > STRETCH * usual:
            raise Unusable(
                f"the {part} is {lengths[worst]:.4g} m from the {from_} at {t[worst]:.6g} s, and usually "
                f"{usual:.4g} m. A marker has jumped or is mistaken: "
                "mend it in the program that recorded it, or cut the file there."
            )
    for part, place in places.items():
        steps = np.nan_to_num(np.linalg.norm(np.diff(place, axis=0), axis=1))
        at = int(np.argmax(steps / np.diff(t)))
        if steps[at] > SPEED * (t[at + 1] - t[at]):
            raise Unusable(
                f"the {part} jumps by {steps[at]:.4g} m at {t[at]:.6g} s. "
                "Mend the marker in the program that recorded it, or cut the file there."
            )


def _filled(
    t: Array, places: dict[str, Array], max_gap: float
) -> tuple[Array, dict[str, Array], tuple[str, ...]]:
    """Short gaps filled by a spline, from the first to the last frame with all markers; and notes."""
    from scipy.interpolate import CubicSpline

    seen = {part: np.isfinite(place.sum(axis=1)) for part, place in places.items()}
    seen = {part: ok for part, ok in seen.items() if part in NEEDED or ok.any()}
    never = [part for part, ok in seen.items() if not ok.any()]
    together = np.flatnonzero(np.all(list(seen.values()), axis=0))
    if never or len(together) < 4:
        raise Unusable(f"the {', '.join(never) or 'leg'} is never seen with the others.")
    inside = slice(together[0], together[-1] + 1)
    notes: tuple[str, ...] = ()
    filled = {}
    for part in seen:
        ok, times, place = seen[part][inside], t[inside], places[part][inside]
        known = times[ok]
        longest = int(np.argmax(np.diff(known)))
        if known[longest + 1] - known[longest] > max_gap + 1.5 * np.median(np.diff(t)):
            gap = f"the {part} is not seen from {known[longest]:.3f} to {known[longest + 1]:.3f} s"
            if part in NEEDED:
                raise Unusable(
                    f"{gap}, longer than gait.max_gap = {max_gap:g} s. Fill the gap in the program that "
                    "recorded it, or cut the file there."
                )
            notes += (f"{gap}: no pitch of the foot",)
            continue
        if not ok.all():
            notes += (f"{part}: {np.sum(~ok)} frames in gaps of at most {max_gap:g} s filled",)
        filled[part] = CubicSpline(known, place[ok])(times)
    return t[inside], filled, notes


def _check_walk(travelled: float, lengths: dict[str, float]) -> None:
    """Raise unless a leg of a human size walks forwards; both in m."""
    if travelled < -BACKWARDS:
        raise Unusable(
            f"the hip goes {-travelled:.2f} m backwards while the knee bends forwards. "
            "Check the markers' names (gait.names), or that the subject walks forwards."
        )
    for part, length in lengths.items():
        if not SEGMENT[0] <= length <= SEGMENT[1]:
            raise Unusable(
                f"the {part} would be {length:.4g} m long. Check the units "
                "in the file and the markers' names (gait.names)."
            )


def _up(leg: Array) -> Array:
    """The laboratory's axis that the leg stands along, (3,)."""
    mean = leg.mean(axis=0)
    axis = int(np.argmax(abs(mean)))
    up: Array = np.eye(3)[axis] * np.sign(mean[axis])
    return up


def _forward(hip: Array, knee: Array, ankle: Array, up: Array) -> Array:
    """The level direction in which the ankle swings and the knee bends, (3,)."""
    swing = ankle - hip
    swing = swing - np.outer(swing @ up, up)
    _, _, axes = np.linalg.svd(swing - swing.mean(axis=0), full_matrices=False)
    forward: Array = axes[0] - (axes[0] @ up) * up
    forward = forward / np.linalg.norm(forward)
    bend = ((knee - hip) - 0.5 * (ankle - hip)) @ forward
    return forward if np.mean(bend) > 0 else -forward


def _axis(direction: Array) -> str:
    """The laboratory's axis that is nearest to a direction, as +x."""
    axis = int(np.argmax(abs(direction)))
    return "+-"[int(direction[axis] < 0)] + "xyz"[axis]


def _steady(t: Array, way: Array) -> Array:
    """What is left of a way without its mean speed, m."""
    left: Array = way - np.polynomial.Polynomial.fit(t, way, 1)(t)
    return left


def _segment(begin: Array, end: Array, forward: Array, up: Array) -> tuple[Array, Array]:
    """Angle of a segment from the downward vertical, + forward, deg, and its length, m."""
    step = end - begin
    angle: Array = np.degrees(np.arctan2(step @ forward, -(step @ up)))
    return angle, np.hypot(step @ forward, step @ up)
