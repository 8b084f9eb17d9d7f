"""Phases of a walk: when a foot stands on the sand."""

from typing import NamedTuple

import numpy as np

from footopt.gait import LEFT, RIGHT
from footopt.walk.results import Walk

LEAST_FORCE = 1.0  # N, vertical: above it a foot stands on the sand


class Stance(NamedTuple):
    """A foot's contact at a heel strike, as samples of a walk."""

    first: int
    last: int
    dragged: bool  # the foot was in the sand long before, so that `first` is the heel strike
    foot: int


def stance(walk: Walk, step: int = 0) -> Stance | None:
    """From touch-down to push-off of a step, the first of which is the right foot's; None if it never stood.

    The foot reaches the sand before the gait's nominal heel strike, so the contact is followed back
    from there. On soft sand, where a foot drags through its swing, there is no touch-down within a
    quarter of a stride, and the step begins at the heel strike.
    """
    strikes, foot = walk.scene.strikes, LEFT if step % 2 else RIGHT
    if step >= len(strikes):
        return None
    strike, quarter = strikes[step], walk.scene.stride / 4.0
    on = walk.force[:, foot, 1] > LEAST_FORCE
    after = np.flatnonzero(on & (walk.t >= strike - 1e-9))
    if len(after) == 0:
        return None
    at, off = int(after[0]), np.concatenate([[-1], np.flatnonzero(~on), [len(on)]])
    behind = int(np.searchsorted(off, at))
    first, last = int(off[behind - 1]) + 1, int(off[behind]) - 1
    dragged = bool(walk.t[first] < strike - quarter)
    return Stance(at if dragged else first, last, dragged, foot)


def step_on_patch(walk: Walk) -> int:
    """The first step in whose middle the foot is on a patch of other sand; 0 where there is none."""
    patches = [zone for effect in walk.scene.effects for zone in effect.zones]
    for step in range(len(walk.scene.strikes) if patches else 0):
        if (contact := stance(walk, step)) is None:
            continue
        middle = np.array([(contact.first + contact.last) // 2])
        x = walk.plates(middle).position[0, contact.foot, :, 0]
        if any(begin < x.max() and x.min() < end for begin, end, _ in patches):
            return step
    return 0
