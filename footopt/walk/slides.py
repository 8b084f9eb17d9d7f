"""Sand that slides until it is nowhere steeper than it can be."""

from __future__ import annotations

import numpy as np

from footopt.compiled import called


@called
def settle(height, begin, end, rise, fall):
    """Let sand slide to the nearest surface at rest, from cell `begin` up to `end`, in place.

    Of all surfaces that rise by at most `rise` (m) and fall by at most `fall` from cell to cell, it is the
    one with the least sum of squared differences from `height`. It has the same area; a cliff becomes the
    slope through half of its height; sand at rest stays; and no two surfaces come further apart by sliding.

    From left to right, the least sum up to a cell is a convex function of its height, and the derivative
    a chain of straight pieces. To go on by a cell moves those left of the zero by `-fall` and those right by
    `rise`, puts a piece that is 0 between them, and adds the next cell's square, which makes all of them
    steeper by the same. So a piece is its length and the cell at which it was put in (Agarwal, Phillips &
    Sadri, Lipschitz unimodal and isotonic regression on paths and trees, LATIN 2010).
    """
    cells = end - begin
    length, since = np.empty((2, 3 * cells)), np.empty((2, 3 * cells))  # of pieces left and right
    counts = np.ones(2, np.int64)  # of them; the last one on either side is next to the zero
    length[:, 0], since[:, 0] = np.inf, 0.0
    zeros = np.empty(cells)
    zeros[0] = height[begin]
    for i in range(1, cells):
        y, low, high = height[begin + i], zeros[i - 1] - fall, zeros[i - 1] + rise
        middle = min(max(y, low), high)
        for side, part in ((0, middle - low), (1, high - middle)):
            length[side, counts[side]], since[side, counts[side]] = part, i
            counts[side] += 1
        side, slope = (0, middle - y) if y < middle else (1, y - middle)
        way = 0.0
        while slope > 0.0:  # through pieces that it leaves on the other side
            last, other = counts[side] - 1, counts[1 - side]
            steepness = i - since[side, last] + 1.0
            part = min(slope / steepness, length[side, last])
            length[1 - side, other], since[1 - side, other] = part, since[side, last]
            counts[1 - side] += 1
            if part < length[side, last]:
                length[side, last] -= part
                slope = 0.0
            else:
                counts[side] -= 1
                slope -= part * steepness
            way += part
        zeros[i] = middle - way if y < middle else middle + way
    held = zeros[cells - 1]
    height[end - 1] = held
    for i in range(cells - 2, -1, -1):
        held = min(max(zeros[i], held - rise), held + fall)
        height[begin + i] = held
