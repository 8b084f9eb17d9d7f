"""The sand under a walk as its feet have left it, made again from the walk's trace."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.effects.footprints import Prints
from footopt.walk.ground import FAR, cell_of, replay
from footopt.walk.state import Sole

Array = NDArray[np.float64]


class MovedSand(NamedTuple):
    """The sand under a walk at some samples.

    Parameters
    ----------
    x : (cells,), m
        Of the cells' middles.
    height : (samples, cells), m
        Over the undisturbed sand, as it would lie if both feet were lifted.
    beside : (samples,), m^2
        Area that has gone to the sides of the feet: with that of `height` it is 0.
    level : (samples, 2 feet, plates), m
        Of the surface that each plate feels.
    """

    x: Array
    height: Array
    beside: Array
    level: Array


def moved_sand(
    prints: Prints, sole: Sole, poses: Array, times: Array, motions: Array, index: NDArray[np.int64]
) -> MovedSand:
    """The sand that a sole moves, at some samples.

    Parameters
    ----------
    prints : Prints
        Of the scene.
    sole : Sole
        Of both feet.
    poses : (T + 1, 2, 7)
        Both feet relative to the hip: at the start, then at each of T samples.
    times : (T + 1,), s
        Of the start, and of the samples.
    motions : (T + 1, 4), m and m/s
        The hip's x, z and velocity in x and z at the same times.
    index : (samples,), int
        Which samples, from 0 to T - 1.
    """
    margin = (FAR + 1.0) * float(sole.reach)
    cell = cell_of(prints, sole)
    ankles = motions[:, :1] + poses[:, :, 0]
    first, last = (int(np.floor(x / cell)) for x in (ankles.min() - margin, ankles.max() + margin))
    rows, back = np.unique(index, return_inverse=True)
    heights, beside = np.zeros((len(rows), last - first + 1)), np.zeros(len(rows))
    levels = np.zeros((len(rows), 2, len(sole.x)))
    replay(prints, sole, poses, times, motions, first, rows, heights, beside, levels)
    x = cell * np.arange(first, last + 1, dtype=np.float64)
    return MovedSand(x, heights[back], beside[back], levels[back])
