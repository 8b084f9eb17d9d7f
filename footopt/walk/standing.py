"""How deep the walker stands at first: where the sand carries the weight."""

import numpy as np

from footopt.compiled import inlined
from footopt.walk.contact import bristles_between, part_force, submerged
from footopt.walk.metrics import sinkage_of
from footopt.walk.state import Ankle, Motion, ankle_of

DOWN = 2.0**-30  # m/s: too slow to change a pressure of an effect, and a power of two, which rounds nothing
SLOW = 1e-9 * DOWN  # m/s: a turning speed that changes no such force; its square is one that `rsqrt` takes


@inlined
def static_height(world, sole, poses, h0):
    """Hip height (m) at which the limit forces of downward motion on both feet carry the weight.

    Vertical balance only: eq. 2 with h = (0, -1) on every plate, and effects as at rest. NaN if even at the
    surface the forces do not carry the weight. Found by the Illinois method, which takes a tenth of the
    evaluations of bisection.

    h0: bristles that are bent straight down, or None.
    """
    weight, low, high = world.mass * world.g, 0.0, sinkage_of(sole, poses, Motion(0.0, 0.0, 0.0, 0.0))
    below, above, side = np.nan, -weight, 0
    z = low
    for _ in range(200):
        missing = _limit_force(world, sole, poses, z, h0) - weight
        if np.isnan(below):  # at the surface
            if high <= low or missing < 0.0:
                return np.nan
            below = missing
        elif abs(missing) <= 1e-13 * weight:
            return z
        elif missing > 0.0:
            above *= 0.5 if side > 0 else 1.0  # the other end has stood twice: as if it were nearer
            low, below, side = z, missing, 1
        else:
            below *= 0.5 if side < 0 else 1.0
            high, above, side = z, missing, -1
        z = (low * above - high * below) / (above - below)
        if not low < z < high:
            return z
    return low


@inlined
def _limit_force(world, sole, poses, z, h0):
    """Limit force of downward motion on both feet at the hip height z, N."""
    total = 0.0
    for foot in range(2):
        still = ankle_of(poses, foot)
        ankle = Ankle(still.x, z + still.z, 0.0, -DOWN, still.cos, still.sin, 0.0)
        first, last = submerged(sole, ankle)
        if first < last:
            slow, bristles = SLOW if h0 is None else np.inf, bristles_between(h0, foot, first, last)
            total += part_force(world, sole, first, last, ankle, slow, None, bristles).z
    return total
