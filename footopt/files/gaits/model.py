"""Thigh and knee by the laboratory's own model: the angles that Plug-in Gait writes into C3D files."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from footopt.files.gaits.markers import Markers

Array = NDArray[np.float64]

JOINTS = ("Pelvis", "Hip", "Knee")
SAME = 0.1  # deg rms; where the markers are the model's own centres of joints
ALIKE = 15.0  # deg rms that model and markers differ by at most; beyond, the angles are no Plug-in Gait's


def of_model(markers: Markers, t: Array, side: str, forward: Array, up: Array) -> list[Array] | None:
    """Thigh and knee in the plane of motion, deg, by a file's own angles at times t; None if one is missing.

    The model's knee bends about an axis that a marker on the thigh sets. Where that is turned out of the
    plane, part of the bend is called varus. So the rotations are put together first, each about the axis to
    the left, then forward, then along the segment (x is the laboratory's axis nearest to forward), and the
    segments are looked at from the side.
    """
    from scipy.spatial.transform import Rotation

    found = {name.rpartition(":")[2]: place for name, place in markers.places.items()}
    rows, left = np.isin(markers.t, t), 1.0 if side == "left" else -1.0
    own = [found[name][rows] for name in (f"{side[0].upper()}{j}Angles" for j in JOINTS) if name in found]
    if len(own) < len(JOINTS) or not np.isfinite(own).all():
        return None
    signs = ([1.0, left, -left], [-1.0, -left, -left], [1.0, -left, -left])
    pelvis, hip, knee = (
        Rotation.from_euler("YXZ", a * sign, degrees=True) for a, sign in zip(own, signs, strict=True)
    )
    ahead = np.where(abs(forward) == abs(forward).max(), np.sign(forward), 0.0)
    axes = np.array([ahead, np.cross(up, ahead), up])
    thigh, shank = (turn.apply((0.0, 0.0, -1.0)) @ axes for turn in (pelvis * hip, pelvis * hip * knee))
    thigh, shank = (np.degrees(np.arctan2(way @ forward, -(way @ up))) for way in (thigh, shank))
    return [thigh, thigh - shank]
