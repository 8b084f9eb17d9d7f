"""The sand's surface as the feet leave it: a height field along x, updated after each step (`Footprints`).

A step sees the surface as it was at its beginning. After it, the sand under a sole is pushed down to it,
what is displaced goes to the next free cells, and slopes beyond the angle of repose slide (`settle`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from footopt.compiled import INLINE, cached_njit, inlined
from footopt.walk.contact import ankle_of, motion
from footopt.walk.state import Sole
from footopt.walk.surface import found_by, surface_at

Array = NDArray[np.float64]

# in a foot's reach
NEAR, FAR = 3.0, 4.0  # so near a foot keeps what it found; what is nearer than FAR is looked at
FORGETS = 0.25  # way over which it forgets what it found, out of the sand
SLIDES = 1.5  # where it is looked at what slides; from there on it slides as far as it does
CELLS = 1024  # of a field at first


class Ground(NamedTuple):
    """A height field, m; cell i has its middle at (first + i) * cell."""

    first: int
    cell: float
    height: Array  # (cells,): the sand as it is
    found: Array  # (2 feet, cells): as each foot found it, which is what its plates feel
    under: Array  # (2 feet, cells): the sole's height, inf where there is no sole
    ahead: Array  # (2 feet, cells): share of the sand under it that moves ahead, and behind
    behind: Array
    over: Array  # (2 feet, 2, plates): where the contact notes the sand over each plate, and its slope
    top: Array  # (2 feet,): the highest sand that each foot may feel
    last: Array  # (2 feet, 2): where each ankle was, m
    beside: Array  # (1,): area that has gone to the sides of the feet, m^2
    end: float  # share of the sand under a foot that is pressed down that goes to each of its ends
    upright: float  # the greatest height or depth that the sides of a heap or print as wide as the foot leave


@inlined
def level_ground(cell, first, cells, plates, end, upright):
    """Sand at rest: undisturbed."""
    under, found = np.full((2, cells), np.inf), np.zeros((2, cells))
    ahead, behind, over = np.zeros((2, cells)), np.zeros((2, cells)), np.zeros((2, 2, plates))
    height, top, last, beside = np.zeros(cells), np.zeros(2), np.full((2, 2), np.inf), np.zeros(1)
    return Ground(first, cell, height, found, under, ahead, behind, over, top, last, beside, end, upright)


def on_ground(prints, sole):
    """A sole with sand of its own under it; the sole alone where a scene has no footprints."""
    if prints is None:
        return sole
    return grounded(prints, sole, -CELLS // 2, CELLS)


@overload(on_ground, jit_options=INLINE)
def _resolve(prints, sole):
    """Which of the two it is, is known from the type when the loop is compiled."""
    if isinstance(prints, types.NoneType):
        return lambda prints, sole: sole
    return lambda prints, sole: grounded(prints, sole, -CELLS // 2, CELLS)


@inlined
def grounded(prints, sole, first, cells):
    """A sole on undisturbed sand.

    Sand under a foot that is pressed down goes to the nearest edge of the rectangle that the foot is from
    above. A heap or a print with upright sides slides, at each of them, to the line of repose through half
    of its height. The lines from both sides meet where it is as high as the foot is wide, times their slope.
    """
    arc = 0.0
    for j in range(1, len(sole.x)):
        arc += np.hypot(sole.x[j] - sole.x[j - 1], sole.z[j] - sole.z[j - 1])
    width, length = np.sum(sole.area) / arc, np.max(sole.x) - np.min(sole.x)  # but for half a plate at an end
    ends = 0.5 * width / length if width < length else 1.0 - 0.5 * length / width
    return _with(sole, level_ground(prints.cell, first, cells, len(sole.x), 0.5 * ends, width * prints.side))


@inlined
def _with(sole, ground):
    return Sole(
        sole.x, sole.z, sole.c2, sole.s2, sole.area, sole.block_x, sole.block_z, sole.block_dx,
        sole.block_dz, sole.reach, sole.span, sole.tangent, ground,
    )  # fmt: skip


@inlined
def footprint(prints, sole, poses, x, z, vx, vz):
    """The sole on the ground as both feet leave it at a step's end.

    poses: (2 feet, 7), at that time. x, z, vx, vz: of the hip. Arrays are written in place.
    """
    if prints is None:
        return sole
    for foot in range(2):
        while not _inside(sole.ground, poses[foot][0] + x, FAR * sole.reach):
            sole = _with(sole, _longer(sole.ground))
    ground = sole.ground
    for foot in range(2):
        _lay(ground, foot, sole, ankle_of(poses, foot, x, z, vx, vz))
    for foot in range(2):
        first, last = _cells(ground, poses[foot][0] + x, sole.reach)
        _push(ground, foot, first, last)
    for foot in range(2):
        first, last = _cells(ground, poses[foot][0] + x, SLIDES * sole.reach)
        settle(ground, first, last, 1, prints.fall)
        settle(ground, first, last, -1, prints.rise)
        _spread(ground, first, last)
    for foot in range(2):
        _find(ground, foot, poses[foot][0] + x, poses[foot][1] + z, sole.reach, prints.own)
    return sole


@inlined
def _cells(ground, x, reach):
    """First cell, and one past the last, within a distance of x."""
    return (
        int(np.floor((x - reach) / ground.cell)) - ground.first,
        int(np.ceil((x + reach) / ground.cell)) - ground.first + 1,
    )


@inlined
def _inside(ground, x, reach):
    """Whether the field goes on to both sides, with room for a heap."""
    first, last = _cells(ground, x, reach)
    return first > 0 and last < len(ground.height)


@inlined
def _longer(ground):
    """The same ground with as many cells more, half of them at either side."""
    cells = len(ground.height)
    more = cells // 2
    out = level_ground(
        ground.cell, ground.first - more, 2 * cells, ground.over.shape[2], ground.end, ground.upright
    )
    out.beside[0] = ground.beside[0]
    for foot in range(2):  # of whole arrays numba would compile how their shapes may differ, for seconds
        out.last[foot, 0], out.last[foot, 1] = ground.last[foot, 0], ground.last[foot, 1]
    for i in range(cells):
        out.height[more + i] = ground.height[i]
        for foot in range(2):
            out.found[foot, more + i] = ground.found[foot, i]
            out.under[foot, more + i] = ground.under[foot, i]
    return out


@inlined
def _lay(ground, foot, sole, ankle):
    """Lay a sole over the cells: the height of its lowest plates, joined by lines, and where they move."""
    under, ahead, behind = ground.under[foot], ground.ahead[foot], ground.behind[foot]
    first, last = _cells(ground, ankle.x, SLIDES * sole.reach)
    for i in range(first, last):
        under[i] = np.inf
    x0 = z0 = 0.0
    for j in range(len(sole.x)):
        x1 = (ankle.x + ankle.cos * sole.x[j] - ankle.sin * sole.z[j]) / ground.cell - ground.first
        z1, vx, vz = motion(ankle, sole.x[j], sole.z[j])
        if j > 0 and x0 != x1:
            level = vx * abs(vx) / (vx * vx + vz * vz + 1e-300)  # part of the motion; the rest presses
            to_end = ground.end * (1.0 - abs(level))
            for i in range(int(np.ceil(min(x0, x1))), int(np.floor(max(x0, x1))) + 1):
                low = z0 + (z1 - z0) * (i - x0) / (x1 - x0)
                if low < under[i]:
                    under[i], ahead[i], behind[i] = low, to_end + max(level, 0.0), to_end + max(-level, 0.0)
        x0, z0 = x1, z1


@inlined
def _room(ground, i):
    """Height between the sand of a cell and the soles over it, m; inf without one, 0 where one touches it."""
    return max(min(ground.under[0, i], ground.under[1, i]) - ground.height[i], 0.0)


@inlined
def _free(ground, i):
    """Whether no sole touches the sand of a cell."""
    return _room(ground, i) > 0.0


@inlined
def _push(ground, foot, first, last):
    """Push the sand down to a sole, and what is displaced to the next free cells ahead and behind."""
    height, under, ahead, behind = ground.height, ground.under[foot], ground.ahead[foot], ground.behind[foot]
    carried = 0.0
    for i in range(first, last):
        pushed = height[i] - under[i]
        if pushed > 0.0:
            height[i] = under[i]
            carried += ahead[i] * pushed
            behind[i] *= pushed
            ground.beside[0] += ((1.0 - ahead[i]) * pushed - behind[i]) * ground.cell
        else:
            behind[i] = 0.0
            if carried > 0.0:
                carried -= _put(ground, i, carried)
    i = last
    while carried > 0.0 and i < len(height):
        carried -= _put(ground, i, carried)
        i += 1
    ground.beside[0] += carried * ground.cell  # none, unless the field ends at a sole
    carried = 0.0
    for i in range(last - 1, first - 1, -1):
        carried += behind[i]
        if carried > 0.0:
            carried -= _put(ground, i, carried)
    i = first - 1
    while carried > 0.0 and i >= 0:
        carried -= _put(ground, i, carried)
        i -= 1
    ground.beside[0] += carried * ground.cell


@inlined
def _put(ground, i, height):
    """Put sand on a cell, as far as there is room under the soles: how much of it, m."""
    put = min(height, _room(ground, i))
    ground.height[i] += put
    return put


@inlined
def _spread(ground, first, last):
    """Let sand slide to or from the sides where a heap is higher, or a print deeper, than they can hold."""
    for i in range(max(first, 0), min(last, len(ground.height))):
        if abs(ground.height[i]) > ground.upright and _free(ground, i):
            held = min(max(ground.height[i], -ground.upright), ground.upright)
            ground.beside[0] += (ground.height[i] - held) * ground.cell
            ground.height[i] = held


@inlined
def settle(ground, first, last, way, drop):
    """Let sand slide where a cell is more than `drop` (m) above the next one in a direction.

    Both slide to the line of repose that holds as much area, and so do those beside them that the line
    reaches: isotonic regression of the height above a slope, by pooling adjacent violators (Barlow et al.,
    Statistical inference under order restrictions, 1972). It is exact, in one pass for each direction, and
    one pass does not undo the other's. Sand under a sole stays.
    """
    height, cells = ground.height, len(ground.height)
    steep = drop * (1.0 + 1e-12)
    first, last = max(first, 1 if way < 0 else 0), min(last, cells if way < 0 else cells - 1)
    for k in range(last - first):
        i = first + k if way > 0 else last - 1 - k
        if height[i] - height[i + way] <= steep or not (_free(ground, i) and _free(ground, i + way)):
            continue
        begin, end, count = i, i + way, 2  # the pool, and its mean height over a line that falls from `begin`
        mean = 0.5 * (height[i] + height[end] + drop)
        grows = True
        while grows:
            grows = False
            beyond, behind = end + way, begin - way
            if 0 <= beyond < cells and height[beyond] + count * drop < mean and _free(ground, beyond):
                mean += (height[beyond] + count * drop - mean) / (count + 1)
                end, count, grows = beyond, count + 1, True
            if 0 <= behind < cells and height[behind] - drop > mean and _free(ground, behind):
                mean = (count * (mean + drop) + height[behind]) / (count + 1)
                begin, count, grows = behind, count + 1, True
        for n in range(count):
            height[begin + n * way] = mean - n * drop


@inlined
def _find(ground, foot, x, z, reach, own):
    """What a foot finds: the sand as it is where it is far away; near it what it found before.

    Out of the sand it forgets that along its way, so that it matters little whether it leaves its own heap
    for the length of a step.
    """
    found, height, under, last_ = ground.found[foot], ground.height, ground.under[foot], ground.last[foot]
    kept = 1.0
    first, last = _cells(ground, x, reach)
    touches = False
    for i in range(first, last):
        if under[i] < found[i] or (not own and under[i] <= height[i]):
            touches = True
        elif own:
            found[i] = height[i]
    if not touches:
        kept = 0.0 if own else np.exp(-np.hypot(x - last_[0], z - last_[1]) / (FORGETS * reach))
    last_[0], last_[1] = x, z
    begin, end = (first, last) if own else _cells(ground, x, NEAR * reach)
    first, last = _cells(ground, x, FAR * reach)
    for i in range(first, begin):
        found[i] = height[i]
    if kept < 1.0:
        for i in range(begin, end):
            found[i] = height[i] + kept * (found[i] - height[i])
    for i in range(end, last):
        found[i] = height[i]
    first, last = _cells(ground, x, SLIDES * reach)
    top = -np.inf
    for i in range(first, last):
        top = max(top, found[i])
    ground.top[foot] = top


@cached_njit(error_model="numpy")
def pressed(prints, sole, poses, x, z, vx, vz):
    """`footprint` from Python: a sole on its ground after one step more."""
    return footprint(prints, sole, poses, x, z, vx, vz)


@cached_njit(nogil=True, error_model="numpy")
def replay(prints, sole, poses, motions, first, rows, heights, beside, levels):
    """Make a walk's prints again from its trace, with a field that begins at the cell `first`.

    poses : (T + 1, 2, 7), motions : (T + 1, 4), x, z, vx, vz of the hip: at the start and at each sample.
    rows : of samples, increasing. heights : (rows, cells), m, filled with the sand after each of them; also
    says how many cells there are. beside : (rows,), m^2. levels : (rows, 2, plates), m, filled with the
    surface that each plate felt there.
    """
    sole = grounded(prints, sole, first, heights.shape[1])
    x, z, vx, vz = motions[0, 0], motions[0, 1], motions[0, 2], motions[0, 3]
    sole = footprint(prints, sole, poses[0], x, z, vx, vz)
    n = 0
    for i in range(1, len(poses)):
        x, z, vx, vz = motions[i, 0], motions[i, 1], motions[i, 2], motions[i, 3]
        wanted = n < len(rows) and rows[n] == i - 1
        if wanted:
            for foot in range(2):
                ankle, found = ankle_of(poses[i], foot, x, z, vx, vz), found_by(sole.ground, foot)
                for j in range(levels.shape[2]):
                    at = ankle.x + ankle.cos * sole.x[j] - ankle.sin * sole.z[j]
                    levels[n, foot, j] = surface_at(found, at)[0]
        sole = footprint(prints, sole, poses[i], x, z, vx, vz)
        if wanted:
            beside[n] = sole.ground.beside[0]
            for i in range(heights.shape[1]):
                heights[n, i] = sole.ground.height[i]
            n += 1
