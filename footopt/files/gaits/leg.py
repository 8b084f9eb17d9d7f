"""From markers to the angles of a leg in its plane of motion.

Nothing is assumed of the laboratory's axes: up is from the ankle to the hip, the plane of motion is
where the ankle swings, and forward is the way the knee bends.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.angles import Recording, climbing, recording
from footopt.files.gaits.markers import Markers
from footopt.files.gaits.model import ALIKE, SAME, of_model
from footopt.files.gaits.names import NEEDED
from footopt.files.gaits.sides import Leg, both_legs, mirrored
from footopt.files.io import Unusable

Array = NDArray[np.float64]

SEGMENT = (0.1, 0.9)  # length of a thigh, shank or foot, m; anything else is a mistake in the units
STRETCH = 0.2  # of a segment's usual length that it may be longer or shorter: its markers are fixed to it
WHOLE = 0.9  # of the time of a leg; a foot that is seen for less of it is left out
APART, ASIDE = 0.08, 0.7  # m between hips that tell left from right, and how far along the swing they may lie
BACKWARDS = 0.3  # m that the hip may go backwards, on a treadmill
STIFF = 0.03  # m that the knee is ahead of hip and ankle, in the mean; where it is less, the toes say more
PLANTED = 5e-3  # m rms; an ankle that moves by less stays where it is, and a hip that rises by less is still
SWINGS = 1.5  # times as much as the ankle's the speed of a hip never varies
TURN = 30.0  # deg that a straight walk's heading may change by
PACE = 0.3  # m/s below which a way has no heading
AVERAGED = 1.0  # s over which a heading is averaged: a pelvis swings with each stride


def leg_angles(markers: Markers, names: Mapping[str, str], side: str | None, max_gap: float) -> Recording:
    """Thigh, knee and, with heel and toe, the foot's pitch of one leg; thigh and knee of the other.

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
    from scipy.signal import detrend

    leg, other, notes = both_legs(markers, names, side)
    _check_leg(markers.t, leg)
    if {"heel", "toe"} <= leg.keys():
        try:
            _check_segment(markers.t, leg, "foot", "heel", "toe")
        except Unusable as why:
            leg, notes = {part: leg[part] for part in NEEDED}, (*notes, f"no pitch of the foot: {why}")
    t, places, filled = _filled(markers.t, leg, max_gap)
    hip, ankle = places["hip"], places["ankle"]
    up = _up(hip - ankle)
    _check_straight(markers.t, leg["hip"], None if other is None else other["hip"], up)
    forward = _forward(places, up)
    if other is not None:
        _check_ahead(leg["hip"] - other["hip"], forward, up)
    if (travelled := (hip[-1] - hip[0]) @ forward) < -BACKWARDS:
        raise Unusable(
            f"the hip goes {-travelled:.2f} m backwards while the knee bends forwards. "
            "Check the markers' names (gait.names), or that the subject walks forwards."
        )
    angles, lengths = _angles(places, forward, up)
    which = "right" if "the right leg" in notes else "left"
    if not any(names.values()) and (model := of_model(markers, t, which, forward, up)) is not None:
        off = np.sqrt(np.mean(np.square(np.subtract(model, angles)), axis=1))
        differ = f"the markers' are {off[0]:.1f} and {off[1]:.1f} deg (rms) from them"
        if SAME < off.max() < ALIKE:
            angles = model
            notes += (
                f"thigh and knee: the file's own angles; {differ} (gait.names.knee=... reads the markers)",
            )
        elif off.max() >= ALIKE:
            notes += (f"the file's own angles of thigh and knee are left out: {differ}",)
    sways, rises = (float(np.std(detrend(hip @ way))) for way in (forward, up))
    if np.std(detrend(ankle @ forward)) < PLANTED < rises and sways < rises:
        raise Unusable(
            f"the hip goes up and down by {np.ptp(hip @ up):.2f} m while the ankle stays where it is: squats "
            "or sitting down, and no walk."
        )
    of_hip, of_ankle = (float(np.std(np.gradient(place @ forward, t))) for place in (hip, ankle))
    if of_hip > SWINGS * of_ankle:
        raise Unusable(
            f"the hip's speed varies by {of_hip:.2g} m/s (rms), the ankle's by {of_ankle:.2g} m/s: are they "
            "exchanged (gait.names)? Or no walk."
        )
    notes += (
        *filled,
        f"thigh {lengths[0]:.3f} m and shank {lengths[1]:.3f} m long in the file (to walk with such legs: "
        f"walker.l1={lengths[0]:.3f} walker.l2={lengths[1]:.3f})",
        f"up is {_axis(up)}, forward about {_axis(forward)}",
        *climbing(hip @ up),
    )
    if other is not None:
        notes += mirrored(leg, other, "the right leg" in notes, forward, up)
    if {"heel", "toe"} <= places.keys():
        pitch, _ = _segment(places["heel"], places["toe"], forward, up)
        # markers sit at different heights: the foot is level while the ankle is lowest and slowest
        angles.append(pitch - np.median(pitch[np.argsort(ankle @ up)[: len(pitch) // 4]]))
    own = recording(np.array([t, *angles]), notes)
    level = ("foot: level where the ankle is lowest",) if "foot" in own.angles else ()
    second = None if other is None else _other(markers.t, other, max_gap, forward, up)
    return own._replace(notes=own.notes + level, other=second, way=(hip @ forward)[: len(own.t)])


def _other(t: Array, leg: Leg, max_gap: float, forward: Array, up: Array) -> Recording | None:
    """Thigh and knee of the leg that is not read; it is wanted for a check only."""
    try:
        _check_leg(t, leg)
        now, places, _ = _filled(t, {part: leg[part] for part in NEEDED}, max_gap)
        return recording(np.array([now, *_angles(places, forward, up)[0]]))
    except Unusable:
        return None


def _angles(places: Leg, forward: Array, up: Array) -> tuple[list[Array], list[float]]:
    """Thigh and knee, deg, and the mean lengths of thigh and shank, m."""
    hip, knee, ankle = (places[part] for part in NEEDED)
    (thigh, l1), (shank, l2) = (_segment(a, b, forward, up) for a, b in ((hip, knee), (knee, ankle)))
    return [thigh, thigh - shank], [float(l1.mean()), float(l2.mean())]


def _check_leg(t: Array, leg: Leg) -> None:
    _check_segment(t, leg, "thigh", "hip", "knee")
    _check_segment(t, leg, "shank", "knee", "ankle")


def _check_segment(t: Array, leg: Leg, name: str, begin: str, end: str) -> None:
    """Raise unless a segment is seen, of a human size, and rigid."""
    apart = np.linalg.norm(leg[end] - leg[begin], axis=1)
    if np.isfinite(apart).sum() < 4:
        raise Unusable(f"the {begin} and the {end} are hardly ever seen together.")
    usual, worst = float(np.nanmedian(apart)), int(np.nanargmax(abs(apart - np.nanmedian(apart))))
    if not SEGMENT[0] <= usual <= SEGMENT[1]:
        raise Unusable(
            f"the {name} would be {usual:.4g} m long. Check the units in the file (gait.units sets "
            "others) and the markers' names (gait.names)."
        )
    if abs(apart[worst] - usual) > STRETCH * usual:
        raise Unusable(
            f"the {end} is {apart[worst]:.4g} m from the {begin} at {t[worst]:.6g} s, and usually "
            f"{usual:.4g} m. A marker has jumped or is mistaken: "
            "mend it in the program that recorded it, or cut the file there."
        )


def _filled(
    t: Array, places: dict[str, Array], max_gap: float
) -> tuple[Array, dict[str, Array], tuple[str, ...]]:
    """Short gaps filled by a spline, from the first to the last frame with all markers; and notes.

    Markers of the foot that are not there for long shorten nothing: they are left out.
    """
    from scipy.interpolate import CubicSpline

    seen = {part: np.isfinite(place.sum(axis=1)) for part, place in places.items()}
    leg, together = (
        np.flatnonzero(np.all([seen[part] for part in parts], axis=0)) for parts in (NEEDED, seen)
    )
    if len(leg) < 4:
        raise Unusable("hip, knee and ankle are hardly ever seen together.")
    parts, notes = tuple(places), tuple[str, ...]()
    if len(together) < 4 or together[-1] - together[0] < WHOLE * (leg[-1] - leg[0]):
        together, parts = leg, NEEDED
        notes = (f"no pitch of the foot: it is seen for less than {100 * WHOLE:g} % of the time",)
    inside = slice(together[0], together[-1] + 1)
    filled = {}
    for part in parts:
        ok, times, place = seen[part][inside], t[inside], places[part][inside]
        known = np.concatenate([times[:1], times[ok], times[-1:]])
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
        filled[part] = CubicSpline(times[ok], place[ok])(times)
    return t[inside], filled, notes


def _check_straight(t: Array, hip: Array, other: Array | None, up: Array) -> None:
    """Raise if the subject turns: its hips, or without the other one the way that it goes.

    In less than twice `AVERAGED` hips must turn from one half to the other, and the way by half as much: a
    pelvis turns to and fro in each stride.
    """
    from scipy.ndimage import uniform_filter1d

    frames = max(round(AVERAGED / float(np.median(np.diff(t)))), 1)
    place, across = ((hip if o is None else hip - o)[:, up == 0] @ np.array([1.0, 1j]) for o in (None, other))
    begin, end = t[0], t[-1]
    if other is not None and len(t) < 2 * frames:
        way = np.diff(place) / np.diff(t)
        turn = min(2.0 * _turned(way), _turned(across / abs(across))) if abs(np.nanmean(way)) > PACE else 0.0
    else:
        times, across = t[np.isfinite(across)], across[np.isfinite(across)]
        if other is None:
            across = np.gradient(uniform_filter1d(across, frames, mode="nearest"), times)
        moving = abs(across) > (PACE if other is None else 0.0)
        times, across = times[moving], across[moving]
        if len(times) < 2 * frames:
            return
        heading = np.angle(uniform_filter1d(across / abs(across), frames, mode="nearest"), deg=True)
        heading = np.unwrap(heading, period=360.0)
        begin, end = times[sorted((int(np.argmin(heading)), int(np.argmax(heading))))]
        turn = float(np.ptp(heading))
    if turn > TURN:
        raise Unusable(
            f"the subject turns by {turn:.0f} deg from {begin:.4g} to {end:.4g} s, and footopt walks "
            "straight ahead. Cut out a part that goes straight."
        )


def _check_ahead(across: Array, forward: Array, up: Array) -> None:
    """Raise if the leg swings along the line between both hips, `across` (n, 3), m."""
    seen = across[np.isfinite(across).all(axis=1)]
    mean = seen.mean(axis=0) if len(seen) else np.zeros(3)
    mean -= (mean @ up) * up
    if (apart := float(np.linalg.norm(mean))) > APART and abs(mean @ forward) > ASIDE * apart:
        raise Unusable(
            "the ankle swings along the line between both hips: steps to the side, and no walk ahead; or one "
            "of them is another marker (gait.names)."
        )


def _turned(directions: NDArray[np.complex128]) -> float:
    """Twice the angle between the means of both halves of directions (n,), deg: a steady turn."""
    half = len(directions) // 2
    return 2.0 * abs(float(np.angle(np.nanmean(directions[half:]) / np.nanmean(directions[:half]), deg=True)))


def _up(leg: Array) -> Array:
    """The laboratory's axis that the leg stands along, (3,)."""
    mean = leg.mean(axis=0)
    axis = int(np.argmax(abs(mean)))
    up: Array = np.eye(3)[axis] * np.sign(mean[axis])
    return up


def _forward(places: Leg, up: Array) -> Array:
    """The level direction in which the ankle swings and the knee bends; if that is stiff, the toes point."""
    hip, knee, ankle = (places[part] for part in NEEDED)
    swing = ankle - hip
    swing = swing - np.outer(swing @ up, up)
    _, _, axes = np.linalg.svd(swing - swing.mean(axis=0), full_matrices=False)
    forward: Array = axes[0] - (axes[0] @ up) * up
    forward = forward / np.linalg.norm(forward)
    ahead = float(np.mean((knee - 0.5 * (hip + ankle)) @ forward))
    if abs(ahead) < STIFF and {"heel", "toe"} <= places.keys():
        ahead = float(np.mean((places["toe"] - places["heel"]) @ forward))
    return forward if ahead > 0 else -forward


def _axis(direction: Array) -> str:
    """The laboratory's axis that is nearest to a direction, as +x."""
    axis = int(np.argmax(abs(direction)))
    return "+-"[int(direction[axis] < 0)] + "xyz"[axis]


def _segment(begin: Array, end: Array, forward: Array, up: Array) -> tuple[Array, Array]:
    """Angle of a segment from the downward vertical, + forward, deg, and its length, m."""
    step = end - begin
    angle: Array = np.degrees(np.arctan2(step @ forward, -(step @ up)))
    return angle, np.hypot(step @ forward, step @ up)
