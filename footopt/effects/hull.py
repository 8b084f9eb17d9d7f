"""The lower convex hull of soles, compiled."""

import numpy as np

from footopt.compiled import cached_njit


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
            if size == 0 or x[i] > x[hull[size - 1]]:  # a point straight above a corner is not on the hull
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
            if gap > 1e-12:  # a convex sole stays the same to the last bit
                out[d, i, 1] = z[i] - (1.0 - effective) * gap
    return out
