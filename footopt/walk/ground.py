"""The sand's surface as the feet leave it: a height field along x (`Footprints`).

While it walks, a foot notes how deep it has pressed each cell. Once a stride, when its ankle reaches furthest
forward, it takes in the surface onto which it will come down (`_take_in`): sand as all prints have left it. A
print is taken out of the surface, put beside it, and what is too steep slides (`_print`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from footopt.compiled import INLINE, cached_njit, called, inlined
from footopt.walk.contact import ankle_of, motion, submerged
from footopt.walk.slides import settle
from footopt.walk.state import Sole, lent
from footopt.walk.surface import Surface, found_by, surface_at

Array = NDArray[np.float64]

FAR = 4.0  # of a foot's reach: so far the field goes on around it
CLEAR = 0.05  # of a foot's length: so far out of the sand it takes in its own print as a whole
ROOM = 3.0  # of a foot's width, to both sides of a print, where sand may slide
CELLS = 2048  # of a field at first
LATE = 1e-9  # s, of rounding in the end of a step


class Ground(NamedTuple):
    """A height field, m; cell i has its middle at (first + i) * cell."""

    first: int
    cell: float
    height: Array  # (cells,): the sand without what the feet have done since they took it in
    found: Array  # (2 feet, cells): as each foot took it in, which is what its plates feel
    lowest: Array  # (2 feet, cells): where each sole has been since, inf where it has not
    pressed: Array  # (2 feet, cells): by how much below what it found, m
    ahead: Array  # (2 feet, cells): the part of that which moves ahead, and behind
    behind: Array
    back: Array  # (cells,): room for what a print puts behind
    over: Array  # (2 feet, 2, plates): where the contact notes the sand over each plate, and its slope
    top: Array  # (2 feet,): the highest sand that each foot may feel, m
    before: Array  # (2 feet, plates + 1, 2): where a sole's points were, x in cells, z in m; inf in the air
    beside: Array  # (1,): area that has gone to the sides of the feet, m^2
    end: float  # share of the sand under a foot that is pressed down that goes to each of its ends
    upright: float  # the greatest height or depth that the sides of a heap or print as wide as the foot leave
    most: float  # area of the largest heap that a foot pushes along, m^2


@inlined
def level_ground(cell, first, cells, plates, points, end, upright, most):
    """Sand at rest: undisturbed."""
    found, pressed, ahead, behind = np.zeros((4, 2, cells))
    height, back, lowest = np.zeros(cells), np.zeros(cells), np.full((2, cells), np.inf)
    over, before = np.zeros((2, 2, plates)), np.full((2, points, 2), np.inf)
    top, beside = np.zeros(2), np.zeros(1)
    return Ground(
        first, cell, height, found, lowest, pressed, ahead, behind, back, over, top, before, beside,
        end, upright, most,
    )  # fmt: skip


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
    arc, (x, z) = 0.0, sole.ends
    for j in range(1, len(x)):
        arc += np.hypot(x[j] - x[j - 1], z[j] - z[j - 1])
    width, length = np.sum(sole.area) / arc, np.max(x) - np.min(x)
    ends = 0.5 * width / length if width < length else 1.0 - 0.5 * length / width
    upright = width * prints.side
    ground = level_ground(
        cell_of(prints, sole), first, cells, len(sole.x), len(x), 0.5 * ends, upright, width * upright
    )
    return _with(sole, ground)


@inlined
def cell_of(prints, sole):
    """Width of a cell under a sole, m."""
    return (np.max(sole.ends[0]) - np.min(sole.ends[0])) / prints.cells


@inlined
def _with(sole, ground):
    return Sole(
        sole.x, sole.z, sole.c2, sole.s2, sole.area, sole.block_x, sole.block_z, sole.block_dx,
        sole.block_dz, sole.reach, sole.span, sole.tangent, sole.ends, ground,
    )  # fmt: skip


@inlined
def footprint(prints, sole, poses, begin, end, x, z, vx, vz):
    """The sole on the ground as both feet leave it at a step's end.

    poses: (2 feet, 7), at that time. begin, end: of the step, s. x, z, vx, vz: of the hip. Arrays are written
    in place.
    """
    if prints is None:
        return sole
    for foot in range(2):
        while not _inside(sole.ground, poses[foot][0] + x, FAR * sole.reach):
            sole = _with(sole, _longer(sole.ground))
    ground = _lent(sole.ground)
    for foot in range(2):
        _lay(ground, foot, sole, ankle_of(poses, foot, x, z, vx, vz))
    if end >= prints.reaches - LATE:
        step = 0.5 * prints.period
        first = max(int(np.floor((begin - prints.reaches + LATE) / step)) + 1, 0)
        for k in range(first, int(np.floor((end - prints.reaches + LATE) / step)) + 1):
            foot = 1 - k % 2
            _take_in(prints, ground, foot, sole, ankle_of(poses, foot, x, z, vx, vz))
    return sole


@inlined
def _inside(ground, x, reach):
    """Whether the field goes on so far to both sides of x, with room for a heap."""
    first, last = (x - reach) / ground.cell - ground.first, (x + reach) / ground.cell - ground.first
    return first > 1.0 and last < len(ground.height) - 2


@called
def _longer(ground):
    """The same ground with as many cells more, half of them at either side."""
    cells = len(ground.height)
    more = cells // 2
    out = level_ground(
        ground.cell, ground.first - more, 2 * cells, ground.over.shape[2], ground.before.shape[1],
        ground.end, ground.upright, ground.most,
    )  # fmt: skip
    out.beside[0] = ground.beside[0]
    for foot in range(2):
        out.top[foot] = ground.top[foot]
        for j in range(ground.before.shape[1]):
            for axis in range(2):
                out.before[foot, j, axis] = ground.before[foot, j, axis]
    for i in range(cells):  # of whole arrays numba would compile how their shapes may differ, for seconds
        out.height[more + i] = ground.height[i]
        for foot in range(2):
            out.found[foot, more + i] = ground.found[foot, i]
            out.lowest[foot, more + i] = ground.lowest[foot, i]
            out.pressed[foot, more + i] = ground.pressed[foot, i]
            out.ahead[foot, more + i] = ground.ahead[foot, i]
            out.behind[foot, more + i] = ground.behind[foot, i]
    return out


@inlined
def _lent(ground):
    """The same ground, whose arrays a sole keeps alive: see `state.lent`."""
    return Ground(
        ground.first, ground.cell, lent(ground.height), lent(ground.found), lent(ground.lowest),
        lent(ground.pressed), lent(ground.ahead), lent(ground.behind), lent(ground.back), lent(ground.over),
        lent(ground.top), lent(ground.before), lent(ground.beside),
        ground.end, ground.upright, ground.most,
    )  # fmt: skip


@called
def _lay(ground, foot, sole, ankle):
    """Note where a sole in the sand is: its lowest height over each cell, and where what it presses goes.

    Between two steps its points go straight on: no plate may be over what they sweep at either.
    """
    before = ground.before[foot]
    first, last = submerged(sole, ankle, ground.top[foot])
    if first == last:
        before[0, 0] = np.inf
        return
    known, scale = before[0, 0] < np.inf, 1.0 / ground.cell
    x0 = z0 = 0.0
    for j in range(len(before)):
        x, z = sole.ends[0, j], sole.ends[1, j]
        x1 = (ankle.x + ankle.cos * x - ankle.sin * z) * scale - ground.first
        z1, vx, vz = motion(ankle, x, z)
        if j > 0:
            _note(ground, foot, x0, z0, x1, z1, vx, vz)
        if known:
            _note(ground, foot, before[j, 0] - ground.first, before[j, 1], x1, z1, vx, vz)
        before[j, 0], before[j, 1] = x1 + ground.first, z1
        x0, z0 = x1, z1


@inlined
def _note(ground, foot, x0, z0, x1, z1, vx, vz):
    """Note a straight part of a sole, x in cells, and where what it presses goes, by its velocity, m/s."""
    low, rise = min(z0, z1), 0.0
    first, last = max(int(np.ceil(min(x0, x1))), 0), min(int(np.floor(max(x0, x1))), len(ground.height) - 1)
    if first <= last and x0 != x1:
        rise = (z1 - z0) / (x1 - x0)
        low = z0 + rise * (first - x0)
    for i in range(first, last + 1):
        found, lowest = ground.found[foot, i], ground.lowest[foot, i]
        if low < lowest:
            ground.lowest[foot, i] = low
            more = min(lowest, found) - low
            if more > 0.0:
                level = vx * abs(vx) / (vx * vx + vz * vz + 1e-300)  # part of the motion; the rest presses
                to_end = ground.end * (1.0 - abs(level))
                ground.pressed[foot, i] += more
                ground.ahead[foot, i] += more * (to_end + max(level, 0.0))
                ground.behind[foot, i] += more * (to_end + max(-level, 0.0))
        low += rise


@called
def _take_in(prints, ground, foot, sole, ankle):
    """A foot takes in the sand as it lies, with the print in which the other one stands.

    Its own print is part of that if the foot is out of the sand, the more so the further, up to `CLEAR`: what
    it moves itself it does not feel before it has left it.
    """
    found, top = ground.found[foot], 0.0
    clear, surface = np.inf, Surface(ground.first, 1.0 / ground.cell, found)
    for j in range(sole.ends.shape[1]):
        x, z = sole.ends[0, j], sole.ends[1, j]
        level, _ = surface_at(surface, ankle.x + ankle.cos * x - ankle.sin * z)
        clear = min(clear, motion(ankle, x, z)[0] - level)
    share = min(max(clear / (CLEAR * prints.cells * ground.cell), 0.0), 1.0)
    for i in range(len(found)):
        found[i] = ground.height[i]
    _print(prints, ground, 1 - foot, found)
    if share > 0.0:
        own = found.copy()
        _print(prints, ground, foot, own)
        for i in range(len(found)):
            found[i] += share * (own[i] - found[i])
    if share == 1.0:
        ground.beside[0] += _print(prints, ground, foot, ground.height)
        for i in range(len(found)):
            ground.lowest[foot, i] = np.inf
            ground.pressed[foot, i] = ground.ahead[foot, i] = ground.behind[foot, i] = 0.0
    for i in range(len(found)):
        top = max(top, found[i])
    ground.top[foot] = top


@called
def _print(prints, ground, foot, height):
    """Press a foot's print into a surface: area that goes beside, m^2.

    What is displaced goes to the next cells ahead and behind, up to the sole where one was over them.
    """
    lowest, begin, end = ground.lowest[foot], len(height), 0
    most, beside, carried = ground.most / ground.cell, 0.0, 0.0
    for i in range(len(height)):
        pushed, ground.back[i] = height[i] - lowest[i], 0.0
        if pushed > 0.0:
            height[i] = lowest[i]
            known = ground.pressed[foot, i]
            ahead = ground.ahead[foot, i] / known if known > 0.0 else ground.end
            ground.back[i] = pushed * (ground.behind[foot, i] / known if known > 0.0 else ground.end)
            carried += pushed * ahead
            beside += pushed - pushed * ahead - ground.back[i]
        elif carried > 0.0:
            beside += max(carried - most, 0.0)
            carried = _put(height, lowest, i, min(carried, most))
        else:
            continue
        begin, end = min(begin, i), i + 1
    beside += carried  # none, unless the field ends at a print
    carried, i = 0.0, end - 1
    while i >= 0 and (i >= begin or carried > 0.0):
        if ground.back[i] > 0.0:
            carried += ground.back[i]
        elif carried > 0.0:
            beside += max(carried - most, 0.0)
            carried = _put(height, lowest, i, min(carried, most))
            begin = min(begin, i)
        i -= 1
    beside += carried
    if end > 0:
        room = int(ROOM * ground.most / (ground.upright * ground.cell)) + 1
        begin, end = max(begin - room, 0), min(end + room, len(height))
        settle(height, begin, end, prints.rise * ground.cell, prints.fall * ground.cell)
        for i in range(begin, end):  # a heap or print that is too high for its width
            held = min(max(height[i], -ground.upright), ground.upright)
            beside += height[i] - held
            height[i] = held
    return beside * ground.cell


@inlined
def _put(height, lowest, i, carried):
    """Put sand on a cell, as far as there is room under the sole: how much is left, m."""
    put = min(carried, max(lowest[i] - height[i], 0.0))
    height[i] += put
    return carried - put


@cached_njit(nogil=True, error_model="numpy")
def replay(prints, sole, poses, times, motions, first, rows, heights, beside, levels):
    """Make a walk's prints again from its trace, with a field that begins at the cell `first`.

    poses : (T + 1, 2, 7), times : (T + 1,), motions : (T + 1, 4), x, z, vx, vz of the hip: at the start and
    at each sample. rows : of samples, increasing. heights : (rows, cells), m, filled with the sand after each
    of them; also says how many cells there are. beside : (rows,), m^2. levels : (rows, 2, plates), m, filled
    with the surface that each plate felt there.
    """
    sole = grounded(prints, sole, first, heights.shape[1])
    n = 0
    for i in range(len(poses)):
        x, z, vx, vz = motions[i, 0], motions[i, 1], motions[i, 2], motions[i, 3]
        wanted = n < len(rows) and rows[n] == i - 1
        if wanted:
            for foot in range(2):
                ankle, found = ankle_of(poses[i], foot, x, z, vx, vz), found_by(sole.ground, foot)
                for j in range(levels.shape[2]):
                    at = ankle.x + ankle.cos * sole.x[j] - ankle.sin * sole.z[j]
                    levels[n, foot, j] = surface_at(found, at)[0]
        sole = footprint(prints, sole, poses[i], times[max(i - 1, 0)], times[i], x, z, vx, vz)
        if wanted:
            ground = sole.ground
            for j in range(heights.shape[1]):
                heights[n, j] = ground.height[j]
            beside[n] = ground.beside[0]
            for foot in range(2):
                beside[n] += _print(prints, ground, foot, heights[n])
            n += 1
