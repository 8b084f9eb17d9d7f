"""From a contour to plates, at equal steps along its arc."""

from functools import lru_cache
from typing import NamedTuple, Self

import numpy as np

from footopt.arrays import Array, Ints
from footopt.compiled import cached_njit

#: How plates are laid on a contour; each name's number of equal steps along a plate.
#: "chord": a plate is the chord between neighbours, as in the paper. "arc": a plate has the mean place and
#: the mean direction of its piece of the contour: of its chords on a spline, and of all sides of a drawing.
#: The law is linear in depth and in (cos 2 beta, sin 2 beta), so that this leaves only their covariance
#: within a plate as an error.
RULES = {"chord": 1, "arc": 4}

CORNER = 0.3  # rad: chords that stand for a curve turn by less


class Plates(NamedTuple):
    """The plates of a batch of feet: arrays of shape (designs, plates), but for `span` and `width`."""

    x: Array  # m, in the foot frame from the ankle
    z: Array  # m
    c2: Array  # cosine of twice the plate's angle, or its mean ...
    s2: Array  # ... and its sine: all that the stress law needs of the angle
    area: Array  # m^2
    tx: Array  # along the contour, a unit vector; (t_z, -t_x) is its outward normal
    tz: Array
    turn: Array  # rad, within a plate: of an arc whose directions differ as much; 0 for chords
    span: Array  # (designs,), m, for which a plate stands; 0 for chords
    width: Array  # (designs,), m

    @classmethod
    def from_points(
        cls, points: Array, ends: Ints, ankle: Array, width: Array, rule: str, top: Array | None
    ) -> Self:
        """Cut soles into plates, and with a `top` (designs,), m, the sides and tops that close them.

        Points (designs, m, 2), m, are from heel to toe with the sand below; plates end at those numbered
        `ends`, (designs, plates + 1). The ankle is (designs, 2), m, the width (designs,), m.
        """
        cuts = [cut(points, ends)]
        if top is not None:
            closing = cap(points, top, cuts[0].shape[2])
            cuts.append(cut(closing, numbered(len(points), closing.shape[1])))
        span = cuts[0][4].mean(axis=1) if RULES[rule] > 1 else np.zeros(len(points))
        x, z, c2, s2, length, tx, tz, turn = cuts[0] if top is None else np.concatenate(cuts, axis=2)
        x, z, area = x - ankle[:, :1], z - ankle[:, 1:], length * width[:, None]
        return cls(x, z, c2, s2, area, tx, tz, turn, span, np.full(len(points), width))


@cached_njit(nogil=True, error_model="numpy")
def cut(points, ends):
    """The means of the chords from each end of a plate to the next, of contours (designs, m, 2), m.

    The ends are numbers of points, (designs, plates + 1). Returns (8, designs, plates): place x and z (m),
    cosine and sine of twice the angle, length (m), the direction, a unit vector, and the turn (rad): an arc
    that turns by phi has directions of variance phi^2 / 12.
    """
    designs, plates, sides = points.shape[0], ends.shape[1] - 1, points.shape[1] - 1
    out = np.empty((8, designs, plates))
    dx, dz, c2, s2 = np.empty(sides), np.empty(sides), np.empty(sides), np.empty(sides)
    lengths, per_length = np.empty(sides), np.empty(sides)
    for d in range(designs):
        at = points[d]
        for j in range(sides):  # loops that are vectorised write two arrays at most
            dx[j], dz[j] = at[j + 1, 0] - at[j, 0], at[j + 1, 1] - at[j, 1]
        for j in range(sides):  # a side of no length has no area, and no harm
            lengths[j] = np.sqrt(max(dx[j] * dx[j] + dz[j] * dz[j], 1e-60))
            per_length[j] = 1.0 / lengths[j]
        for j in range(sides):
            c2[j] = (dx[j] * dx[j] - dz[j] * dz[j]) * per_length[j]
            s2[j] = 2.0 * dx[j] * dz[j] * per_length[j]
        for i in range(plates):
            first, last = ends[d, i], ends[d, i + 1]
            tx, tz = at[last, 0] - at[first, 0], at[last, 1] - at[first, 1]
            norm = max(np.sqrt(tx * tx + tz * tz), 1e-30)
            tx, tz = tx / norm, tz / norm
            x = z = c = s = spread = total = 0.0
            for j in range(first, last):
                x += 0.5 * (at[j + 1, 0] + at[j, 0]) * lengths[j]
                z += 0.5 * (at[j + 1, 1] + at[j, 1]) * lengths[j]
                c += c2[j]
                s += s2[j]
                total += lengths[j]
                across = dx[j] * tz - dz[j] * tx
                # from c2 and s2 it would be a small difference of large numbers
                spread += across * across * per_length[j]
            per = 1.0 / total
            out[0, d, i], out[1, d, i], out[2, d, i], out[3, d, i] = per * x, per * z, per * c, per * s
            out[4, d, i], out[5, d, i], out[6, d, i] = total, tx, tz
            out[7, d, i] = np.sqrt(12.0 * per * spread)
    return out


def cap(sole: Array, top: Array, plates: int) -> Array:
    """The sides and the top that close soles (designs, m, 2), m: from the toe up, back, and down to the heel.

    Returns the ends of the plates, (designs, cap's plates + 1, 2), m: on a side an eighth of the sole's
    `plates`, on the top half as many. A sole that reaches higher than `top` (designs,), m, raises it.
    """
    level = np.maximum(top, sole[..., 1].max(axis=1))
    heel, toe = sole[:, 0], sole[:, -1]
    corners = [toe, np.stack([toe[:, 0], level], axis=1), np.stack([heel[:, 0], level], axis=1), heel]
    pieces = [toe[:, None]]
    for count, begin, end in zip((plates // 8, plates // 2, plates // 8), corners, corners[1:], strict=False):
        count = max(count, 1)
        part = (np.arange(1, count + 1) / count)[:, None]
        pieces.append(begin[:, None] + part * (end - begin)[:, None])
    return np.concatenate(pieces, axis=1)


@lru_cache(maxsize=8)
def numbered(designs: int, count: int) -> Ints:
    """Numbers from 0 of the points of each design, (designs, count)."""
    return np.tile(np.arange(count), (designs, 1))


def along_arc(polyline: Array, plates: int, parts: int) -> tuple[Array, Ints]:
    """Points along the arc of a polyline (m, 2), m, and the numbers of those where plates end.

    At a corner, where it turns by more than `CORNER`, one plate ends and the next begins: a plate around it
    would have the mean of two directions. There are at most half as many corners as plates, the sharpest.
    Where plates have several `parts`, the polyline's own points are among them: means are those of all its
    sides, however much finer than the plates. The numbers are (plates + 1,).
    """
    arc, turns = arc_and_turns(polyline)
    corners = np.flatnonzero(np.abs(turns) > CORNER)
    corners = np.sort(corners[np.argsort(-np.abs(turns[corners]), kind="stable")[: (plates - 1) // 2]])
    pieces = np.concatenate([[0.0], arc[corners], arc[-1:]])
    share = np.diff(pieces) / arc[-1] * (plates - len(pieces) + 1)
    count = 1 + share.astype(np.int64)  # one each, and the others by length
    rest = np.argsort(-(share % 1.0), kind="stable")[: plates - count.sum()]
    count[rest] += 1
    steps = zip(pieces, np.diff(pieces), parts * count, strict=False)
    at = np.concatenate([*(begin + length * np.arange(n) / n for begin, length, n in steps), arc[-1:]])
    own = np.empty(0)
    if parts > 1:
        after = np.clip(np.searchsorted(at, arc), 1, len(at) - 1)
        own = arc[np.minimum(arc - at[after - 1], at[after] - arc) > 1e-9 * arc[-1]]
    ends = (np.arange(len(at)) + np.searchsorted(own, at))[::parts]
    at = np.insert(at, np.searchsorted(at, own), own)
    return np.stack([np.interp(at, arc, column) for column in polyline.T], axis=-1), ends


@cached_njit(nogil=True, error_model="numpy")
def arc_and_turns(polyline):
    """Arc length (m) and turn (rad) of a polyline (m, 2) at its points, each (m,).

    It turns by 0 at its ends, and at a point that repeats the one before.
    """
    arc, turns = np.zeros(len(polyline)), np.zeros(len(polyline))
    corner, ax, az = 0, 0.0, 0.0  # the last point that repeats none, and the side that ends there
    for i in range(1, len(polyline)):
        bx, bz = polyline[i, 0] - polyline[i - 1, 0], polyline[i, 1] - polyline[i - 1, 1]
        arc[i] = arc[i - 1] + np.hypot(bx, bz)
        if bx != 0.0 or bz != 0.0:
            if corner > 0:
                turns[corner] = np.arctan2(ax * bz - az * bx, ax * bx + az * bz)
            corner, ax, az = i, bx, bz
    return arc, turns
