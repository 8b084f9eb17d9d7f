"""`RankModel`: ranks of designs as Gaussians of the distance between soles expect them from known ones."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.design.fronts import ranks

Array = NDArray[np.float64]

WIDTH, SMOOTHING = 0.7, 1e-3  # one over the Gaussians' length, in the range of heights; added to their matrix


class RankModel:
    """Interpolates ranks by each objective with Gaussian radial basis functions and a constant.

    Soles are as far from each other as their heights and the differences of neighbours are: few of these
    change where a run is shifted.

    Parameters
    ----------
    known : (designs, n)
        Heights of designs.
    F : (designs, objectives)
        Their objectives, minimised.
    top : float
        The largest height.
    """

    def __init__(self, known: Array, F: Array, top: float) -> None:
        self.ranks = ranks(F) / len(F)
        self._top = top
        self._known = self._steps(known)
        kernel = self._kernel(self._known)
        kernel[np.diag_indices(len(F))] += SMOOTHING
        solved = np.linalg.solve(kernel, np.column_stack([self.ranks, np.ones(len(F))]))
        self._constant = solved[:, :-1].sum(axis=0) / solved[:, -1].sum()
        self._weights = solved[:, :-1] - solved[:, -1:] * self._constant

    def __call__(self, X: Any) -> Array:
        """Ranks of designs (designs, n) by each objective, (designs, objectives); the best is near 0."""
        expected = self._kernel(self._steps(X)) @ self._weights + self._constant
        return np.asarray(np.round(expected, 6))  # sums in another order must not lead elsewhere

    def _steps(self, X: Any) -> Array:
        """Heights and differences of neighbours, (designs, 2 n - 1), in the range of heights."""
        return np.concatenate([X, np.diff(X, axis=1)], axis=1).astype(float) / self._top

    def _kernel(self, points: Array) -> Array:
        """exp(-(WIDTH r)^2) for the distances r of points from those that are known."""
        square = np.square(points).sum(axis=1)[:, None] + np.square(self._known).sum(axis=1)
        square -= 2.0 * (points @ self._known.T)
        return np.asarray(np.exp(-(WIDTH**2) * np.maximum(square, 0.0)))
