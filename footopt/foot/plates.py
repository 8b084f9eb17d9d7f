"""From a contour to plates, at equal steps along its arc."""

from typing import NamedTuple, Self

import numpy as np

from footopt.arrays import Array
from footopt.compiled import cached_njit

#: How plates are laid on a contour; each name's number of chords that a plate averages over.
#: "chord": a plate is the chord between neighbours, as in the paper. "arc": a plate has the mean
#: place and the mean direction of its piece of the contour. The law is linear in depth and in
#: (cos 2 beta, sin 2 beta), so that this leaves only their covariance within a plate as an error.
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
    turn: Array  # rad, of the contour within a plate; 0 for chords
    span: Array  # (designs,), m, for which a plate stands; 0 for chords
    width: Array  # (designs,), m

    @classmethod
    def from_points(
        cls, points: Array, ankle: Array, width: Array, rule: str, top: Array | None, turns: bool = True
    ) -> Self:
        """Cut soles into plates, and with a `top` (designs,), m, the sides and tops that close them.

        Points (designs, plates * RULES[rule] + 1, 2), m, are at equal steps along the arc, from heel to toe
        with the sand below. The ankle is (designs, 2), m, the width (designs,), m. Without `turns` these are
        0: they take as long as all else.
        """
        pieces = [(points, RULES[rule])]
        if top is not None:
            pieces.append((cap(points, top, (points.shape[1] - 1) // RULES[rule]), 1))
        cuts = [cut(line, parts) for line, parts in pieces]
        for found, (line, parts) in zip(cuts if turns else (), pieces, strict=False):
            found[7] = turns_within(line, parts)
        span = (
            np.zeros(len(points)) if RULES[rule] == 1 else (cuts[0][4] * width[:, None]).mean(axis=1) / width
        )
        x, z, c2, s2, length, tx, tz, turn = cuts[0] if top is None else np.concatenate(cuts, axis=2)
        x, z, area = x - ankle[:, :1], z - ankle[:, 1:], length * width[:, None]
        return cls(x, z, c2, s2, area, tx, tz, turn, span, np.full(len(points), width))


@cached_njit(nogil=True, error_model="numpy")
def cut(points, parts):
    """The means of `parts` neighbouring chords each along contours (designs, m, 2), m.

    Returns (8, designs, plates): place x and z (m), cosine and sine of twice the angle, length (m), the
    direction, a unit vector, and 0 for turns.
    """
    designs, plates = points.shape[0], (points.shape[1] - 1) // parts
    out = np.zeros((8, designs, plates))
    for d in range(designs):
        for i in range(plates):
            x = z = c2 = s2 = total = 0.0
            for j in range(i * parts, (i + 1) * parts):
                dx, dz = points[d, j + 1, 0] - points[d, j, 0], points[d, j + 1, 1] - points[d, j, 1]
                square = max(dx * dx + dz * dz, 1e-60)  # a side of no length has no area, and no harm
                length = np.sqrt(square)
                x += 0.5 * (points[d, j + 1, 0] + points[d, j, 0]) * length
                z += 0.5 * (points[d, j + 1, 1] + points[d, j, 1]) * length
                c2 += (dx * dx - dz * dz) / length
                s2 += 2.0 * dx * dz / length
                total += length
            first, last = i * parts, (i + 1) * parts
            dx, dz = points[d, last, 0] - points[d, first, 0], points[d, last, 1] - points[d, first, 1]
            norm = max(np.sqrt(dx * dx + dz * dz), 1e-30)
            out[0, d, i], out[1, d, i] = x / total, z / total
            out[2, d, i], out[3, d, i], out[4, d, i] = c2 / total, s2 / total, total
            out[5, d, i], out[6, d, i] = dx / norm, dz / norm
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


def turns_within(points: Array, parts: int) -> Array:
    """The turns of soles (designs, m, 2) within plates of `parts` chords each, (designs, plates), rad."""
    if parts == 1:  # chords stand for themselves
        return np.zeros((len(points), points.shape[1] - 1))
    dx, dz = np.moveaxis(points[:, 1:] - points[:, :-1], -1, 0)
    across = dx[:, :-1] * dz[:, 1:] - dz[:, :-1] * dx[:, 1:]
    ahead = dx[:, :-1] * dx[:, 1:] + dz[:, :-1] * dz[:, 1:]
    turn = np.pad(np.abs(np.arctan2(across, ahead)), ((0, 0), (1, 1)))
    between = turn[:, ::parts]
    between[between > CORNER] = 0.0  # a corner between two plates adds no curvature to either
    inside = turn[:, :-1].reshape(len(points), -1, parts).sum(axis=2)
    return np.asarray(inside + 0.5 * (between[:, 1:] - between[:, :-1]))


def along_arc(polyline: Array, plates: int, parts: int) -> Array:
    """Points along the arc of a polyline (m, 2), m: (plates parts + 1, 2), m, at equal steps between corners.

    At a corner, where it turns by more than `CORNER`, one plate ends and the next begins: a plate around it
    would have the mean of two directions. There are at most half as many corners as plates, the sharpest.
    """
    arc, turns = arc_and_turns(polyline)
    corners = np.flatnonzero(np.abs(turns) > CORNER)
    corners = np.sort(corners[np.argsort(-np.abs(turns[corners]), kind="stable")[: (plates - 1) // 2]])
    ends = np.concatenate([[0.0], arc[corners], arc[-1:]])
    share = np.diff(ends) / arc[-1] * (plates - len(ends) + 1)
    count = 1 + share.astype(np.int64)  # one each, and the others by length
    rest = np.argsort(-(share % 1.0), kind="stable")[: plates - count.sum()]
    count[rest] += 1
    steps = zip(ends, np.diff(ends), parts * count, strict=False)
    at = np.concatenate([*(begin + length * np.arange(n) / n for begin, length, n in steps), arc[-1:]])
    return np.stack([np.interp(at, arc, column) for column in polyline.T], axis=-1)


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
