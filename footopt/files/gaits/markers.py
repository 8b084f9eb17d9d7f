"""From markers to the angles of a leg in its plane of motion.

Nothing is assumed of the laboratory's axes: up is from the ankle to the hip, the plane of motion is
where the ankle swings, and forward is the way the knee bends.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.motion import Markers
from footopt.files.gaits.strides import Recording, wrong

Array = NDArray[np.float64]

#: Usual names without their side: joint centres, Plug-in Gait, OpenSim, OpenCap, Helen Hayes, HBM, CAST, IOR.
USUAL = {
    "hip": ("hjc", "hip", "hipjc", "hipcenter", "gtr", "gtro", "gtroc", "gt", "ftc", "troch", "trochanter",
            "greattrochanter"),
    "knee": ("kjc", "kneejc", "kneecenter", "kne", "knee", "kneelat", "knelat", "lfc", "lek", "fle", "le"),
    "ankle": ("ajc", "anklejc", "anklecenter", "ank", "ankle", "anklelat", "anklat", "lmal", "lm", "fal"),
    "heel": ("hee", "heel", "cal", "calc", "fcc", "ca"),
    "toe": ("toe", "toetip", "bigtoe", "mt2", "met2", "toemed", "fm2", "sm", "mt1", "mt5", "toelat", "fm1",
            "fm5"),
}  # fmt: skip
ASIS, PSIS = ("asi", "asis", "ias"), ("psi", "psis", "ips")
SACRUM = ("sacr", "sacral", "vsacral", "sacrum", "sac")
SIDES = {"right": ("r", "right"), "left": ("l", "left")}
SEGMENT = (0.1, 0.9)  # length of a thigh or shank, m; anything else is a mistake in the units
STRETCH = 0.2  # a distance of hip and knee, or knee and ankle, farther from the median: no marker of a leg
SPEED = 15.0  # m/s; a marker that is faster than a sprinter's foot has jumped
APART = 0.05  # left and right markers that are nearer, m, cannot be told apart by their place


def to_recording(
    markers: Markers, path: str | Path, names: Mapping[str, str], side: str | None, max_gap: float
) -> Recording:
    """Thigh, knee and, with heel and toe, the foot's pitch of one leg.

    Parameters
    ----------
    names : the file's own names of hip, knee, ankle, heel, toe, where they are not usual.
    side : "right" or "left"; None: the right one, or the left one if its markers are missing.
    max_gap : of a marker that is filled by a spline, s.

    Raises
    ------
    FileError : a marker is missing, unseen for too long, or where no leg can be.
    """
    leg = side or next((s for s in SIDES if not _missing(markers, names, s)), "right")
    if missing := _missing(markers, names, leg):
        raise wrong(
            path,
            f"no marker for the {leg} {' and '.join(missing)}. "
            + " ".join(f"For the {part}, looked for {_looked_for(part, names, leg)}." for part in missing)
            + f" The file has {', '.join(markers.places)}. Name it with gait.names.{missing[0]}=...",
        )
    notes = [*markers.notes, f"the {leg} leg"]
    places = _leg(markers, names, leg)
    other = "left" if leg == "right" else "right"
    if not _missing(markers, {}, other) and not names:
        swapped = _unswap(places, _leg(markers, names, other))
        notes += [f"{part}: left and right exchanged in {n} frames, put back" for part, n in swapped.items()]
    recorded = dict(places)
    t, places = _filled(markers.t, places, path, max_gap, notes)
    hip, knee, ankle = places["hip"], places["knee"], places["ankle"]

    up = _up(hip - ankle)
    forward = _forward(hip, knee, ankle, up)
    travelled = float((hip[-1] - hip[0]) @ forward)
    if travelled < -0.3:
        raise wrong(
            path,
            f"the hip goes {-travelled:.2f} m backwards while the knee bends "
            "forwards. Check the markers' names (gait.names), or that the subject walks forwards.",
        )
    (thigh, l1), (shank, l2) = (_segment(a, b, forward, up) for a, b in ((hip, knee), (knee, ankle)))
    for part, length in (("thigh", l1), ("shank", l2)):
        if not SEGMENT[0] <= length.mean() <= SEGMENT[1]:
            raise wrong(
                path,
                f"the {part} would be {length.mean():.4g} m long. Check the units "
                "in the file and the markers' names (gait.names).",
            )
    _check_rigid(markers.t, recorded, path)
    swing = [np.std(_steady(t, place @ forward)) for place in (hip, ankle)]
    if swing[0] > swing[1]:
        raise wrong(
            path,
            f"the hip swings by {swing[0]:.3f} m (rms), the ankle by {swing[1]:.3f} m: exchanged?",
        )
    notes.append(
        f"thigh {l1.mean():.3f} m and shank {l2.mean():.3f} m long in the file (to walk with such legs: "
        f"walker.l1={l1.mean():.3f} walker.l2={l2.mean():.3f})"
    )
    way = "+-"[int(forward[np.argmax(abs(forward))] < 0)] + "xyz"[int(np.argmax(abs(forward)))]
    notes.append(f"up is {'+-'[int(up.min() < 0)]}{'xyz'[int(np.argmax(abs(up)))]}, forward about {way}")
    rows = [t, thigh, thigh - shank]
    if {"heel", "toe"} <= places.keys():
        pitch, _ = _segment(places["heel"], places["toe"], forward, up)
        # markers sit at different heights: the foot is level while the ankle is lowest and slowest
        level = np.median(pitch[np.argsort(ankle @ up)[: len(pitch) // 4]])
        rows.append(pitch - level)
        notes.append("foot: level where the ankle is lowest")
    return Recording.checked(path, np.array(rows), tuple(notes))


def _missing(markers: Markers, names: Mapping[str, str], side: str) -> list[str]:
    """Which of hip, knee and ankle a file has no marker for."""
    return [part for part in ("hip", "knee", "ankle") if part not in _leg(markers, names, side)]


def _leg(markers: Markers, names: Mapping[str, str], side: str) -> dict[str, Array]:
    """A leg's markers by part, each (n, 3); the hip from the pelvis if it has no marker itself."""
    found = {}
    for part, usual in USUAL.items():
        name = names.get(part) or _find(markers, [s + u for u in usual for s in SIDES[side]], usual, side)
        if name in markers.places:
            found[part] = markers.places[name]
    if "hip" not in found and not names.get("hip"):
        hip = _hip_of_pelvis(markers, side)
        if hip is not None:
            found["hip"] = hip
    return found


def _find(markers: Markers, prefixed: list[str], usual: tuple[str, ...], side: str) -> str | None:
    """The marker's name in the file: the side before or after the part, in any case and punctuation."""
    plain = {_plain(name): name for name in reversed(markers.places)}
    wanted = [*prefixed, *(u + s for u in usual for s in SIDES[side])]
    return next((plain[name] for name in wanted if name in plain), None)


def _plain(name: str) -> str:
    """Letters and digits in lower case, without the subject that some programs put before a colon, or the
    study that OpenCap puts at the end.
    """
    return re.sub(r"_study$|[^a-z0-9]", "", name.rpartition(":")[2].lower())


def _looked_for(part: str, names: Mapping[str, str], side: str) -> str:
    if own := names.get(part):
        return own
    usual = ", ".join(f"{side[0].upper()}{u.upper()}" for u in USUAL[part])
    pelvis = ", or the pelvis: RASI, LASI and RPSI, LPSI or SACR" if part == "hip" else ""
    return usual + pelvis


def _hip_of_pelvis(markers: Markers, side: str) -> Array | None:
    """The hip's centre from four (or three) markers of the pelvis: Harrington et al., J. Biomech. 40 (2007).

    In mm, from the middle of the front markers: 0.24 depth + 9.9 back, 0.30 width + 10.9 down,
    0.33 width + 7.3 to the side.
    """

    def at(usual: tuple[str, ...], of: str) -> Array | None:
        name = _find(markers, [s + u for u in usual for s in SIDES[of]], usual, of)
        return None if name is None else markers.places[name]

    front, back = [at(ASIS, s) for s in SIDES], [at(PSIS, s) for s in SIDES]
    plain = {_plain(name): place for name, place in markers.places.items()}
    sacrum = next((plain[name] for name in SACRUM if name in plain), None)
    if front[0] is None or front[1] is None:
        return None
    if back[0] is not None and back[1] is not None:
        sacrum = 0.5 * (back[0] + back[1])
    if sacrum is None:
        return None
    middle = 0.5 * (front[0] + front[1])
    width = np.linalg.norm(front[0] - front[1], axis=1, keepdims=True)
    right = (front[0] - front[1]) / width
    ahead = middle - sacrum
    ahead = ahead - np.sum(ahead * right, axis=1, keepdims=True) * right
    depth = np.linalg.norm(ahead, axis=1, keepdims=True)
    ahead = ahead / depth
    down = np.cross(ahead, right)
    outwards = right if side == "right" else -right
    hip: Array = (
        middle
        - (0.24 * depth + 0.0099) * ahead
        + (0.30 * width + 0.0109) * down
        + (0.33 * width + 0.0073) * outwards
    )
    return hip


def _unswap(leg: dict[str, Array], other: dict[str, Array]) -> dict[str, int]:
    """Put markers back that changed sides for some frames; how many frames, by part."""
    done: dict[str, int] = {}
    between = leg["hip"] - other["hip"]
    if not np.isfinite(between.sum(axis=1)).any():
        return done
    hips = np.nanmean(between, axis=0)
    for part in leg.keys() & other.keys() - {"hip"}:
        aside: Array = (leg[part] - other[part]) @ (hips / np.linalg.norm(hips))
        if not np.isfinite(aside).any():
            continue  # never seen together
        turn = 1.0 if np.nanmedian(aside) >= 0 else -1.0
        wrong = turn * aside < -APART
        if wrong.any():
            exchanged = np.where(wrong[:, None], other[part], leg[part])
            leg[part] = exchanged
            done[part] = int(wrong.sum())
    return done


def _check_rigid(t: Array, places: dict[str, Array], path: str | Path) -> None:
    """Raise where a leg's marker jumps: from the joint before it, or in time."""
    for part, from_ in (("knee", "hip"), ("ankle", "knee")):
        lengths = np.linalg.norm(places[part] - places[from_], axis=1)
        usual = float(np.nanmedian(lengths))
        worst = int(np.nanargmax(abs(lengths - usual)))
        if abs(lengths[worst] - usual) > STRETCH * usual:
            raise wrong(
                path,
                f"the {part} is {lengths[worst]:.4g} m from the {from_} at "
                f"{t[worst]:.6g} s, and usually {usual:.4g} m. A marker has jumped or is mistaken: "
                "mend it in the program that recorded it, or cut the file there.",
            )
    for part, place in places.items():
        with np.errstate(divide="ignore", invalid="ignore"):
            speeds = np.linalg.norm(np.diff(place, axis=0), axis=1) / np.diff(t)
        speeds = np.where(np.isfinite(speeds), speeds, 0.0)
        if speeds.max(initial=0.0) > SPEED:
            at = int(np.argmax(speeds))
            raise wrong(
                path,
                f"the {part} jumps by {speeds[at] * (t[at + 1] - t[at]):.4g} m at "
                f"{t[at]:.6g} s. Mend the marker in the program that recorded it, or cut the file there.",
            )


def _filled(
    t: Array, places: dict[str, Array], path: str | Path, max_gap: float, notes: list[str]
) -> tuple[Array, dict[str, Array]]:
    """Short gaps filled by a spline, from the first to the last frame in which every marker is seen."""
    from scipy.interpolate import CubicSpline

    seen = {part: np.isfinite(place.sum(axis=1)) for part, place in places.items()}
    for part in ("heel", "toe"):
        if part in seen and not seen[part].any():
            del seen[part], places[part]
    never = [part for part, ok in seen.items() if not ok.any()]
    together = np.flatnonzero(np.all(list(seen.values()), axis=0))
    if never or len(together) < 4:
        raise wrong(path, f"the {', '.join(never) or 'leg'} is never seen with the others.")
    inside = slice(together[0], together[-1] + 1)
    filled = {}
    for part, place in places.items():
        ok = seen[part][inside]
        times, place = t[inside], place[inside]
        known = times[ok]
        longest = int(np.argmax(np.diff(known))) if len(known) > 1 else 0
        if known[longest + 1] - known[longest] > max_gap + 1.5 * np.median(np.diff(t)):
            place_in_time = f"the {part} is not seen from {known[longest]:.3f} to {known[longest + 1]:.3f} s"
            if part in ("heel", "toe"):  # these are not needed
                notes.append(f"{place_in_time}: no pitch of the foot")
                continue
            raise wrong(
                path,
                f"{place_in_time}, longer than gait.max_gap = {max_gap:g} s. Fill "
                "the gap in the program that recorded it, or cut the file there.",
            )
        if not ok.all():
            notes.append(f"{part}: {np.sum(~ok)} frames in gaps of at most {max_gap:g} s filled")
        filled[part] = CubicSpline(known, place[ok])(times)
    return t[inside], filled


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


def _steady(t: Array, way: Array) -> Array:
    """What is left of a way without its mean speed, m."""
    left: Array = way - np.polynomial.Polynomial.fit(t, way, 1)(t)
    return left


def _segment(begin: Array, end: Array, forward: Array, up: Array) -> tuple[Array, Array]:
    """Angle of a segment from the downward vertical, + forward, deg, and its length, m."""
    step = end - begin
    angle: Array = np.degrees(np.arctan2(step @ forward, -(step @ up)))
    return angle, np.hypot(step @ forward, step @ up)
