"""Phases of a walk: when a foot stands on the sand."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from footopt.gait import RIGHT
from footopt.walk.results import Walk

STANDS = 1.0  # vertical force above which a foot stands on the sand, N


class Stance(NamedTuple):
    """The right foot's contact at the first heel strike, as samples of a walk."""

    first: int
    last: int
    dragged: bool  # the foot was in the sand long before, so that `first` is the heel strike


def stance(walk: Walk) -> Stance | None:
    """From touch-down to push-off of the right foot's first step; None if it never stood.

    The foot reaches the sand before the gait's nominal heel strike, so the contact is followed back
    from there. On soft sand, where a foot drags through its swing, there is no touch-down within a
    quarter of a stride, and the step begins at the heel strike.
    """
    strike, quarter = walk.scene.gait.heel_strike, walk.scene.gait.period / 4.0
    on = walk.force[:, RIGHT, 1] > STANDS
    after = np.flatnonzero(on & (walk.t >= strike - 1e-9))
    if len(after) == 0:
        return None
    at = int(after[0])
    off = np.flatnonzero(~on)
    before, behind = off[off < at], off[off > at]
    first = int(before[-1]) + 1 if len(before) else 0
    last = int(behind[0]) - 1 if len(behind) else len(on) - 1
    dragged = bool(walk.t[first] < strike - quarter)
    return Stance(at if dragged else first, last, dragged)
