"""The walker's body in the world at any instants: legs, soles, and the forces along them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.files.outline import closed_contour
from footopt.walk import Scene, Walk

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

ARROWS = 20  # parts of a sole, at most, that have a force each


class Body(NamedTuple):
    """Both feet, left one first, at M instants."""

    legs: Array  # (M, 2 feet, 3, 2), m: hip, knee, ankle
    sole: Array  # (M, 2 feet, s, 2), m
    outline: Array  # (M, 2 feet, p, 2), m: the sole and the foot's top

    @property
    def hip(self) -> Array:
        """The COM, (M, 2), m."""
        return self.legs[:, 0, 0]


class Forces(NamedTuple):
    """Forces of the sand on parts of both soles at M instants, each (M, 2 feet, arrows, 2)."""

    at: Array  # where they act, m
    force: Array  # N

    def resultant(self) -> tuple[Array, Array]:
        """Where the whole of a foot's force acts, and what it is, each (M, 2 feet, 2).

        The place is the mean of the parts' places by their forces; NaN for a foot without a force.
        """
        size = np.linalg.norm(self.force, axis=-1, keepdims=True)
        total = size.sum(axis=2)
        weight = np.where(total > 0.0, total, np.nan)
        return (size * self.at).sum(axis=2) / weight, self.force.sum(axis=2)


def legs(scene: Scene, t: ArrayLike, hip: Array) -> Array:
    """Hip, knee and ankle of both legs at times t (M,) with the hip at (M, 2): (M, 2 feet, 3, 2), m."""
    (thigh, _), (shank, _), _ = scene.gait.angles(np.asarray(t, float))
    top = np.broadcast_to(hip[:, None], (*thigh.shape, 2))
    knee = top + scene.walker.l1 * _down(thigh)
    return np.stack([top, knee, knee + scene.walker.l2 * _down(shank)], axis=2)


def body(walk: Walk, t: ArrayLike, sole: Array | None = None) -> Body:
    """A walk's body at times t (M,), linear between its samples; the sole has its own points, or others."""
    t = np.asarray(t, float)
    hip = np.stack([np.interp(t, walk.t, walk.com[:, axis]) for axis in range(2)], axis=-1)
    joints = legs(walk.scene, t, hip)
    pitch = walk.scene.gait.angles(t)[2][0]
    turn = np.stack([np.cos(pitch), np.sin(pitch)], axis=-1)[..., None, :]
    outline = closed_contour(walk.foot.contour, max(0.0, walk.foot.contour[:, 1].max() + 0.005))
    ankle = joints[:, :, 2, None]
    shown = (walk.foot.contour if sole is None else sole, outline)
    placed = (ankle + _turned(points - walk.foot.ankle, turn) for points in shown)
    return Body(joints, *placed)


def forces_along(walk: Walk, index: Ints, arrows: int = ARROWS) -> Forces:
    """Forces along both soles at samples (M,) of a walk, summed over neighbouring plates."""
    plates = walk.plates(index)
    begin, size = groups(plates.position.shape[2], arrows)
    middle = np.add.reduceat(plates.position, begin, axis=2) / size[:, None]
    return Forces(middle, np.add.reduceat(plates.force, begin, axis=2))


def groups(count: int, parts: int) -> tuple[Ints, Ints]:
    """Where groups of neighbours begin, for `np.add.reduceat`, and how many are in each: `parts` at most."""
    parts = min(parts, count)
    begin = count * np.arange(parts) // parts
    return begin, np.diff(np.append(begin, count))


def _down(angle: Array) -> Array:
    """The direction of a segment that hangs at an angle from the vertical, + forward."""
    return np.stack([np.sin(angle), -np.cos(angle)], axis=-1)


def _turned(points: Array, turn: Array) -> Array:
    """Points (m, 2) turned by (..., 1, 2), the cosine and sine of an angle."""
    c, s = turn[..., 0], turn[..., 1]
    return np.stack([c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]], axis=-1)
