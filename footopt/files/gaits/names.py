"""Which markers of a file are a leg's joints, by the names that laboratories give them."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

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
NEEDED = ("hip", "knee", "ankle")


def find_leg(places: Mapping[str, Array], names: Mapping[str, str], side: str) -> dict[str, Array]:
    """A leg's markers by part (of `USUAL`), each (n, 3); the hip from the pelvis if it has no marker itself.

    Parameters
    ----------
    places : mapping of (n, 3) array
        Markers by name.
    names : mapping
        The file's own names of parts, where they are not usual.
    side : str
        "right" or "left".
    """
    plain = {_plain(name): place for name, place in reversed(list(places.items()))}
    found = {
        part: places.get(names[part]) if names.get(part) else _find(plain, usual, side)
        for part, usual in USUAL.items()
    }
    if found["hip"] is None and not names.get("hip"):
        found["hip"] = _hip_of_pelvis(plain, side)
    return {part: place for part, place in found.items() if place is not None}


def looked_for(part: str, names: Mapping[str, str], side: str) -> str:
    """The names under which a part is looked for, in words."""
    if own := names.get(part):
        return own
    usual = ", ".join(f"{side[0].upper()}{u.upper()}" for u in USUAL[part])
    return usual + (", or the pelvis: RASI, LASI and RPSI, LPSI or SACR" if part == "hip" else "")


def _plain(name: str) -> str:
    """Letters and digits in lower case, without the subject that some programs put before a colon, or the
    study that OpenCap puts at the end.
    """
    return re.sub(r"_study$|[^a-z0-9]", "", name.rpartition(":")[2].lower())


def _find(plain: Mapping[str, Array], usual: tuple[str, ...], side: str) -> Array | None:
    """The marker with one of the usual names, the side before it or, else, after it."""
    before = [s + u for u in usual for s in SIDES[side]]
    after = [u + s for u in usual for s in SIDES[side]]
    return next((plain[name] for name in before + after if name in plain), None)


def _hip_of_pelvis(plain: Mapping[str, Array], side: str) -> Array | None:
    """The hip's centre from four (or three) markers of the pelvis: Harrington et al., J. Biomech. 40 (2007).

    In mm, from the middle of the front markers: 0.24 depth + 9.9 back, 0.30 width + 10.9 down,
    0.33 width + 7.3 to the side.
    """
    front, back = ([_find(plain, usual, s) for s in SIDES] for usual in (ASIS, PSIS))
    sacrum = next((plain[name] for name in SACRUM if name in plain), None)
    if back[0] is not None and back[1] is not None:
        sacrum = 0.5 * (back[0] + back[1])
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
    outwards = right if side == "right" else -right
    hip: Array = (
        middle
        - (0.24 * depth + 0.0099) * ahead
        + (0.30 * width + 0.0109) * down
        + (0.33 * width + 0.0073) * outwards
    )
    return hip
