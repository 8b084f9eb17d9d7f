"""Shadowing: the sand that rests in a groove of the sole moves with the foot."""

from dataclasses import dataclass

import numpy as np

from footopt.arrays import Array
from footopt.compiled import cached_njit
from footopt.effects.base import Effect
from footopt.errors import check


@dataclass(frozen=True)
class Shadowing(Effect, name="shadowing"):
    """A groove counts with a part of its depth: the sole comes nearer to its lower convex hull.

    Each point of the sole is moved straight down, in the foot frame, until its gap to the convex hull is
    `effective` times what it was; plates are cut from that sole. A convex sole stays as it is.

    Source: Agarwal, Karsai, Goldman & Kamrin, Science Advances 7 (2021), who let a third of the height of a
    wheel's grousers count. Range: grooves that are narrow, and sand that has come to rest in them. The law
    does not know where the foot moves.

    Parameters
    ----------
    effective : float
        The part of a groove's depth that counts: 1 is the plain law, 0 the hull.

    Raises
    ------
    SettingError
        The part is not from 0 to 1.
    """

    effective: float = 1.0 / 3.0
    literature = plausible = True

    def __post_init__(self) -> None:
        check(0 <= self.effective <= 1, "effects.shadowing.effective", self.effective, "a part, from 0 to 1")

    def reshape(self, points: Array) -> Array:
        """Soles (designs, points, 2), m, with what is left of their grooves."""
        return np.asarray(filled(points, self.effective))


@cached_njit(nogil=True, error_model="numpy")
def filled(points, effective):
    """Soles whose gaps to their lower convex hulls are `effective` times what they were.

    points: (designs, m, 2), m, in the order of the contour.
    """
    out = points.copy()
    count = points.shape[1]
    order, hull = np.empty(count, np.int64), np.empty(count, np.int64)
    for d in range(len(points)):
        x, z = points[d, :, 0], points[d, :, 1]
        for i in range(count):  # by x, then z; nearly in order as they come, unless the sole overhangs
            j = i
            while j > 0 and (x[order[j - 1]], z[order[j - 1]]) > (x[i], z[i]):
                order[j] = order[j - 1]
                j -= 1
            order[j] = i
        size = 0
        for i in order:  # Andrew's monotone chain
            while size >= 2:
                a, b = hull[size - 2], hull[size - 1]
                if (x[b] - x[a]) * (z[i] - z[a]) - (z[b] - z[a]) * (x[i] - x[a]) > 0.0:
                    break
                size -= 1
            if size == 0 or x[i] > x[hull[size - 1]]:  # what stands above a corner is no floor
                hull[size] = i
                size += 1
        right, margin = 0, 1e-9 * (x[hull[size - 1]] - x[hull[0]])
        for i in order:
            if not x[hull[0]] + margin < x[i] < x[hull[size - 1]] - margin:
                continue  # a vertical end has nothing below it
            while right < size - 1 and x[hull[right]] < x[i]:
                right += 1
            a, b = hull[max(right - 1, 0)], hull[right]
            part = (x[i] - x[a]) / (x[b] - x[a]) if x[i] < x[b] else 1.0
            gap = z[i] - z[a] - part * (z[b] - z[a])
            if gap > 1e-12:  # a convex sole keeps its last bit
                out[d, i, 1] = z[i] - (1.0 - effective) * gap
    return out
