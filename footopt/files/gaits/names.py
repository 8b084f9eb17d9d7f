"""Which markers of a file are a leg's joints, by the names that laboratories give them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.markers import is_seen

Array = NDArray[np.float64]

#: Usual names without their side: joint centres, Plug-in Gait, OpenSim, OpenCap, Helen Hayes, HBM, CAST, IOR.
USUAL = {
    "hip": ("hjc", "hip", "hipjc", "hipcenter", "gtr", "gtro", "gtroc", "gt", "ftc", "troch", "trochanter",
            "greattrochanter"),
    "knee": ("kjc", "kneejc", "kneecenter", "kne", "knee", "kneelat", "knelat", "lfc", "lek", "fle", "le",
             "lepi", "latepi", "lfe", "lfep", "latknee", "kneeout"),
    "ankle": ("ajc", "anklejc", "anklecenter", "ank", "ankle", "anklelat", "anklat", "lmal", "lm", "fal",
              "latmal", "latankle", "ankleout", "mallat"),
    "heel": ("hee", "heel", "hel", "cal", "calc", "calcaneus", "fcc", "ca", "cpg"),
    "toe": ("toe", "toes", "toetip", "bigtoe", "mt2", "met2", "2mt", "toemed", "fm2", "sm", "d2m", "mt1",
            "1mt", "d1m", "mt5", "5mt", "d5m", "mtp", "toelat", "fm1", "fm5", "hlx", "hallux", "mt23", "met"),
}  # fmt: skip
#: Markers on the inner side of a joint: its centre is in the middle of both.
MEDIAL = {
    "knee": ("knm", "mkne", "knem", "kneemed", "mknee", "me", "mek", "fme", "medknee", "kneein", "mfc"),
    "ankle": ("anm", "mank", "ankm", "anklemed", "ankmed", "mankle", "mm", "tam", "mmal", "medmal",
              "medankle", "anklein", "malmed", "med"),
}  # fmt: skip
ACROSS = 0.2  # m between both sides of a knee or an ankle, at most
COMPUTED = 3  # of the usual names of a knee and an ankle, the first ones, which are of centres
#: Hip, knee and ankle as Vicon's models have computed them, ends of femur and tibia; and of animation rigs.
CENTRES = (("fep", "feo", "tio"), ("upleg", "leg", "foot"))
#: CMU's waist markers (FWT, BWT) are at the iliac spines.
ASIS, PSIS = ("asi", "asis", "ias", "fwt"), ("psi", "psis", "ips", "bwt")
SACRUM = ("sacr", "sacral", "vsacral", "vsacrum", "sacrum", "sac", "mpsis", "midpsis", "psism", "s1", "s2")
SIDES = {"right": ("r", "right"), "left": ("l", "left")}
SHOWN = 6  # of the usual names, in a message; docs/files.md has more
NEEDED = ("hip", "knee", "ankle")


def find_leg(places: Mapping[str, Array], names: Mapping[str, str], side: str) -> dict[str, Array]:
    """A leg's markers by part (of `USUAL`), each (n, 3); the hip from the pelvis if it has no marker itself.

    A marker without data counts as none, unless `names` names it.

    Parameters
    ----------
    places : mapping of (n, 3) array
        Markers by name.
    names : mapping
        The file's own names of parts, where they are not usual.
    side : str
        "right" or "left".
    """
    plain = _by_plain_name(places)
    found = {part: _find(plain, usual, side) for part, usual in USUAL.items()}
    for part, inner in MEDIAL.items():
        outer, medial = found[part], _find(plain, inner, side)
        if outer is None or medial is None or _find(plain, USUAL[part][:COMPUTED], side) is not None:
            continue
        middle, width = 0.5 * (outer + medial), np.linalg.norm(outer - medial, axis=1)
        if _share(middle) == _share(outer) and np.nanmedian(width) < ACROSS:  # many are off before the walk
            found[part] = middle
    pelvis = hip_of_pelvis(places, side, found["knee"])
    if found["hip"] is None or (pelvis is not None and _share(pelvis) > 2.0 * _share(found["hip"])):
        found["hip"] = pelvis
    for triple in CENTRES:
        centres = [_find(plain, (name,), side) for name in triple]
        if all(centre is not None for centre in centres):
            found |= dict(zip(NEEDED, centres, strict=True))
    found |= {part: places.get(name) for part, name in names.items() if name and part in USUAL}
    return {part: place for part, place in found.items() if place is not None}


def by_subject(places: Mapping[str, Array]) -> Iterator[dict[str, Array]]:
    """The markers of each subject, whose name stands before a colon; and then all of a file."""
    subjects = dict.fromkeys(name.rpartition(":")[0] for name in places)
    for subject in subjects if len(subjects) > 1 else ():
        yield {name: place for name, place in places.items() if name.rpartition(":")[0] == subject}
    yield dict(places)


def looked_for(part: str, names: Mapping[str, str], side: str) -> str:
    """The names under which a part is looked for, in words."""
    if own := names.get(part):
        return own
    usual = ", ".join(f"{side[0].upper()}{u.upper()}" for u in USUAL[part][:SHOWN]) + " and others"
    return usual + (", or the pelvis: RASI, LASI and RPSI, LPSI or SACR" if part == "hip" else "")


def _share(place: Array) -> float:
    """The share of the frames in which a marker is seen."""
    return float(np.isfinite(place[:, 0]).mean())


def _plain(name: str) -> str:
    """Letters and digits in lower case, without the subject that some programs put before a colon, or the
    study that OpenCap puts at the end.
    """
    return re.sub(r"_study$|[^a-z0-9]", "", name.rpartition(":")[2].lower())


def _by_plain_name(places: Mapping[str, Array]) -> dict[str, Array]:
    """The markers with data; OpenCap's files also have what the cameras saw, in names without `_study`."""
    order = sorted(places, key=lambda name: not name.endswith("_study"))
    return {_plain(name): places[name] for name in reversed(order) if is_seen(places[name])}


def _find(plain: Mapping[str, Array], usual: tuple[str, ...], side: str) -> Array | None:
    """The marker with one of the usual names, the side before it or, else, after it."""
    before = [s + u for u in usual for s in SIDES[side]]
    after = [u + s for u in usual for s in SIDES[side]]
    return next((plain[name] for name in before + after if name in plain), None)


def hip_of_pelvis(places: Mapping[str, Array], side: str, knee: Array | None) -> Array | None:
    """The hip's centre from four (or three) markers of the pelvis: Harrington et al., J. Biomech. 40 (2007).

    Down is where the knee is: a laboratory's axes may be mirrored, and its left and right exchanged.

    In mm, from the middle of the front markers: 0.24 depth + 9.9 back, 0.30 width + 10.9 down,
    0.33 width + 7.3 to the side.
    """
    plain = _by_plain_name(places)
    front, back = ([_find(plain, usual, s) for s in SIDES] for usual in (ASIS, PSIS))
    sacrum = next((plain[name] for name in SACRUM if name in plain), None)
    if back[0] is not None and back[1] is not None:
        sacrum = 0.5 * (back[0] + back[1])
    elif sacrum is None:  # one of them is as far back as their middle
        sacrum = back[0] if back[0] is not None else back[1]
    if front[0] is None or front[1] is None or sacrum is None:
        return None
    middle = 0.5 * (front[0] + front[1])
    width = np.linalg.norm(front[0] - front[1], axis=1, keepdims=True)
    right = (front[0] - front[1]) / width
    ahead = middle - sacrum
    ahead = ahead - np.sum(ahead * right, axis=1, keepdims=True) * right
    depth = np.linalg.norm(ahead, axis=1, keepdims=True)
    ahead = ahead / depth
    down = np.cross(ahead, right)
    if knee is not None and np.nanmedian(np.sum((knee - middle) * down, axis=1)) < 0.0:
        down = -down
    outwards = right if side == "right" else -right
    hip: Array = (
        middle
        - (0.24 * depth + 0.0099) * ahead
        + (0.30 * width + 0.0109) * down
        + (0.33 * width + 0.0073) * outwards
    )
    return hip
