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
from footopt.files.gaits.names import NEEDED
from footopt.files.gaits.sides import Leg, both_legs
from footopt.files.reading import Unusable

Array = NDArray[np.float64]

SEGMENT = (0.1, 0.9)  # length of a thigh or shank, m; anything else is a mistake in the units
STRETCH = 0.2  # a distance of hip and knee, or knee and ankle, farther from the median: no marker of a leg
SPEED = 15.0  # m/s; a marker that is faster than a sprinter's foot has jumped
WHOLE = 0.9  # of the time of a leg; a foot that is seen for less of it is left out
BACKWARDS = 0.3  # m that the hip may go backwards, on a treadmill
TURN, PACE = (
    30.0,
    0.3,
)  # deg that a straight walk's heading may change by; m/s below which a way has no heading
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
    leg, other, notes = both_legs(markers, names, side)
    t, places, filled = _filled(markers.t, leg, max_gap)
    hip, knee, ankle = (places[part] for part in NEEDED)
    up = _up(hip - ankle)
    _check_straight(markers.t, leg["hip"], None if other is None else other["hip"], up)
    forward = _forward(hip, knee, ankle, up)
    _check_walk((hip[-1] - hip[0]) @ forward)
    angles, lengths = _angles(places, forward, up)
    _check_leg(markers.t, leg, lengths)
    of_hip, of_ankle = (np.std(_steady(t, place @ forward)) for place in (hip, ankle))
    if of_hip > of_ankle:
        raise Unusable(f"the hip swings by {of_hip:.3f} m (rms), the ankle by {of_ankle:.3f} m: exchanged?")
    notes += (
        *filled,
        f"thigh {lengths[0]:.3f} m and shank {lengths[1]:.3f} m long in the file (to walk with such legs: "
        f"walker.l1={lengths[0]:.3f} walker.l2={lengths[1]:.3f})",
        f"up is {_axis(up)}, forward about {_axis(forward)}",
        *climbing(hip @ up),
    )
    jumps = [why for part in ("heel", "toe") if part in places and (why := _jump(markers.t, part, leg[part]))]
    if jumps:
        notes += (f"no pitch of the foot: {jumps[0]}",)
    elif {"heel", "toe"} <= places.keys():
        pitch, _ = _segment(places["heel"], places["toe"], forward, up)
        # markers sit at different heights: the foot is level while the ankle is lowest and slowest
        angles.append(pitch - np.median(pitch[np.argsort(ankle @ up)[: len(pitch) // 4]]))
        notes += ("foot: level where the ankle is lowest",)
    own = recording(np.array([t, *angles]), notes)
    return own._replace(other=None if other is None else _other(markers.t, other, max_gap, forward, up))


def _other(t: Array, leg: Leg, max_gap: float, forward: Array, up: Array) -> Recording | None:
    """Thigh and knee of the leg that is not read; it is wanted for a check only."""
    try:
        now, places, _ = _filled(t, {part: leg[part] for part in NEEDED}, max_gap)
        angles, lengths = _angles(places, forward, up)
        _check_leg(t, leg, lengths)
        return recording(np.array([now, *angles]))
    except Unusable:
        return None


def _angles(places: Leg, forward: Array, up: Array) -> tuple[list[Array], list[float]]:
    """Thigh and knee, deg, and the mean lengths of thigh and shank, m."""
    hip, knee, ankle = (places[part] for part in NEEDED)
    (thigh, l1), (shank, l2) = (_segment(a, b, forward, up) for a, b in ((hip, knee), (knee, ankle)))
    return [thigh, thigh - shank], [float(l1.mean()), float(l2.mean())]


def _check_leg(t: Array, leg: Leg, lengths: list[float]) -> None:
    """Raise unless a leg is of a human size, rigid and nowhere too fast."""
    for part, length in zip(("thigh", "shank"), lengths, strict=True):
        if not SEGMENT[0] <= length <= SEGMENT[1]:
            raise Unusable(
                f"the {part} would be {length:.4g} m long. Check the units in the file (gait.units sets "
                "others) and the markers' names (gait.names)."
            )
    for part, from_ in (("knee", "hip"), ("ankle", "knee")):
        apart = np.linalg.norm(leg[part] - leg[from_], axis=1)
        usual = float(np.nanmedian(apart))
        worst = int(np.nanargmax(abs(apart - usual)))
        if abs(apart[worst] - usual) > STRETCH * usual:
            raise Unusable(
                f"the {part} is {apart[worst]:.4g} m from the {from_} at {t[worst]:.6g} s, and usually "
                f"{usual:.4g} m. A marker has jumped or is mistaken: "
                "mend it in the program that recorded it, or cut the file there."
            )
    for part in NEEDED:
        if why := _jump(t, part, leg[part]):
            raise Unusable(f"{why} Mend the marker in the program that recorded it, or cut the file there.")


def _jump(t: Array, part: str, place: Array) -> str:
    """Where a marker is faster than any foot, in a sentence; "" if it never is."""
    steps = np.nan_to_num(np.linalg.norm(np.diff(place, axis=0), axis=1))
    at = int(np.argmax(steps / np.diff(t)))
    if steps[at] <= SPEED * (t[at + 1] - t[at]):
        return ""
    return f"the {part} jumps by {steps[at]:.4g} m at {t[at]:.6g} s."


def _filled(
    t: Array, places: dict[str, Array], max_gap: float
) -> tuple[Array, dict[str, Array], tuple[str, ...]]:
    """Short gaps filled by a spline, from the first to the last frame with all markers; and notes.

    Markers of the foot that are not there for long shorten nothing: they are left out.
    """
    from scipy.interpolate import CubicSpline

    seen = {part: np.isfinite(place.sum(axis=1)) for part, place in places.items()}
    seen = {part: ok for part, ok in seen.items() if part in NEEDED or ok.any()}
    never = [part for part, ok in seen.items() if not ok.any()]
    leg, together = (
        np.flatnonzero(np.all([seen[part] for part in parts], axis=0)) for parts in (NEEDED, seen)
    )
    if never or len(leg) < 4:
        raise Unusable(f"the {', '.join(never) or 'leg'} is never seen with the others.")
    if len(together) < 4 or together[-1] - together[0] < WHOLE * (leg[-1] - leg[0]):
        together = leg
    inside = slice(together[0], together[-1] + 1)
    notes: tuple[str, ...] = ()
    filled = {}
    for part in seen:
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


def _check_walk(travelled: float) -> None:
    """Raise if a hip goes backwards, by so many m."""
    if travelled < -BACKWARDS:
        raise Unusable(
            f"the hip goes {-travelled:.2f} m backwards while the knee bends forwards. "
            "Check the markers' names (gait.names), or that the subject walks forwards."
        )


def _check_straight(t: Array, hip: Array, other: Array | None, up: Array) -> None:
    """Raise if the subject turns: its hips, or without the other one the way that it goes."""
    from scipy.ndimage import uniform_filter1d

    frames = max(round(AVERAGED / float(np.median(np.diff(t)))), 1)
    ahead, aside = np.flatnonzero(up == 0)
    if other is None:
        seen = np.isfinite(hip[:, 0])
        way = uniform_filter1d(hip[seen], frames, axis=0, mode="nearest")
        across = np.gradient(way, t[seen], axis=0)
        valid = np.hypot(across[:, ahead], across[:, aside]) > PACE
    else:
        across = hip - other
        seen = np.isfinite(across[:, 0])
        across = across[seen]
        valid = np.hypot(across[:, ahead], across[:, aside]) > 0.0
    across, times = across[valid], t[seen][valid]
    if len(times) < 2 * frames:
        return
    across = across / np.hypot(across[:, ahead], across[:, aside])[:, None]
    across = uniform_filter1d(across, frames, axis=0, mode="nearest")
    heading = np.degrees(np.unwrap(np.arctan2(across[:, aside], across[:, ahead])))
    turn, places = float(np.ptp(heading)), sorted((int(np.argmin(heading)), int(np.argmax(heading))))
    if turn > TURN:
        begin, end = times[places]
        raise Unusable(
            f"the subject turns by {turn:.0f} deg from {begin:.4g} to {end:.4g} s, and footopt walks "
            "straight ahead. Cut out a part that goes straight."
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
