"""From a contour to plates, at equal steps along its arc."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


#: How plates are laid on a contour; each name's number of chords that a plate averages over.
#: "chord": a plate is the chord between neighbours, as in the paper. "arc": a plate has the mean
#: place and the mean direction of its piece of the contour. The law is linear in depth and in
#: (cos 2 beta, sin 2 beta), so that this leaves only their covariance within a plate as an error.
RULES = {"chord": 1, "arc": 4}


class Plates(NamedTuple):
    """The plates of a batch of feet, structure of arrays, each of shape (designs, plates).

    Places are in the foot frame, from the ankle; ``c2`` and ``s2`` are cos and sin of twice the
    plate's angle (or their means), all that the stress law needs of it. ``tx`` and ``tz`` are the
    plate's direction along the contour, a unit vector, for its outward normal (t_z, -t_x); None where
    nothing asks for them.
    """

    x: Array  # m
    z: Array  # m
    c2: Array
    s2: Array
    area: Array  # m^2, width times length
    tx: Array | None = None
    tz: Array | None = None

    @classmethod
    def from_points(
        cls, points: Array, ankle: Array, width: Array, rule: str = "arc", directed: bool = False
    ) -> Plates:
        """Plates along a contour.

        Parameters
        ----------
        points : (designs, plates * RULES[rule] + 1, 2), m, at equal steps along the arc, from heel
            to toe with the sand below
        ankle : (designs, 2), m, foot frame
        width : (designs,), m
        rule : a name in `RULES`. directed : whether ``tx`` and ``tz`` are wanted.
        """
        chord = points[:, 1:] - points[:, :-1]
        dx, dz = chord[..., 0], chord[..., 1]
        square = np.maximum(dx * dx + dz * dz, 1e-60)  # a side of no length has no area, and no harm
        length = np.sqrt(square)
        middle = 0.5 * (points[:, 1:] + points[:, :-1]) - ankle[:, None, :]
        parts = RULES[rule]
        total = _sum_parts(length, parts)

        def mean(value: Array) -> Array:
            return _sum_parts(value * length, parts) / total

        plates = cls(
            x=mean(middle[..., 0]),
            z=mean(middle[..., 1]),
            c2=mean((dx * dx - dz * dz) / square),
            s2=mean(2.0 * dx * dz / square),
            area=total * width[:, None],
        )
        if not directed:
            return plates
        along_x, along_z = mean(dx / length), mean(dz / length)
        norm = np.sqrt(along_x * along_x + along_z * along_z)
        return plates._replace(tx=along_x / norm, tz=along_z / norm)

    def take(self, index: slice | NDArray[np.int64]) -> Plates:
        """The plates of some of the designs."""
        given = {name: column for name, column in self._asdict().items() if column is not None}
        return Plates(**{name: np.ascontiguousarray(column[index]) for name, column in given.items()})


def _sum_parts(value: Array, parts: int) -> Array:
    """Sums of `parts` neighbours, elementwise, so that no batch rounds differently."""
    total = value[:, ::parts].copy()
    for i in range(1, parts):
        total += value[:, i::parts]
    return total


def along_arc(polyline: Array, plates: int) -> Array:
    """Points at equal arc lengths of a polyline.

    Parameters
    ----------
    polyline : (m, 2), m

    Returns
    -------
    points : (plates + 1, 2), m
    """
    steps = np.hypot(*np.diff(polyline, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    at = arc[-1] * np.arange(plates + 1) / plates
    return np.stack([np.interp(at, arc, polyline[:, 0]), np.interp(at, arc, polyline[:, 1])], axis=1)


def lower_hull(contour: Array) -> tuple[Array, float, float, float]:
    """Lower convex hull of a sole and where the sole is farthest above it.

    Parameters
    ----------
    contour : (m, 2), m

    Returns
    -------
    hull : (h, 2), m, from heel to toe
    x, low, high : where the gap is largest; the hull's height there and the sole's, m
    """
    hull: list[Array] = []
    for p in contour[np.lexsort((contour[:, 1], contour[:, 0]))]:  # Andrew's monotone chain
        while len(hull) >= 2:
            (ax, az), (bx, bz) = hull[-1] - hull[-2], p - hull[-2]
            if ax * bz - az * bx > 0.0:
                break
            hull.pop()
        hull.append(p)
    corners = np.array(hull)
    left, right = corners[0, 0], corners[-1, 0]
    margin = 1e-9 * (right - left)
    inner = contour[(contour[:, 0] > left + margin) & (contour[:, 0] < right - margin)]
    # a vertical side at an end is part of the chain, but has no inside
    flat = corners[np.concatenate([[True], np.diff(corners[:, 0]) > 0.0])]
    if len(inner) == 0:  # nothing between the ends but the straight hull itself
        inner = flat.mean(axis=0, keepdims=True)
    floor = np.interp(inner[:, 0], flat[:, 0], flat[:, 1])
    i = int(np.argmax(inner[:, 1] - floor))
    return flat, float(inner[i, 0]), float(floor[i]), float(inner[i, 1])


def hollow(contour: Array) -> float:
    """Largest gap, along z_p, between a sole and its lower convex hull, m.

    0 for a convex sole; the depth of the hollow for one that touches ground at heel and toe only.
    Points on the contour's vertical sides do not count.

    Parameters
    ----------
    contour : (m, 2), m
    """
    _, _, low, high = lower_hull(contour)
    return max(high - low, 0.0)
