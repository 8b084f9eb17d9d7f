"""Which waypoints mattered: permutation importance (Breiman 2001) by a quadratic fit of a run's designs."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST = 4_000  # designs of a fit, and as many that judge it
RIDGE = 1e-3  # of the variance of a term: the best designs of a search are nearly alike
PER_TERM = 4  # designs that a term of the fit takes at least

Array = NDArray[np.float64]


def importance(k: NDArray[np.int64], values: Array, seed: int = 0) -> dict[str, Any] | None:
    """How much each waypoint's height, of k (designs, n), tells of a value (designs,): shares of 1.

    A quadratic is fitted to half of the designs. A waypoint matters by how much the fit's squared error in
    the other half rises where its heights are shuffled among them; "explained" is the share of their variance
    that the fit explains. None where the designs are too few, or the fit explains nothing.
    """
    rng = np.random.default_rng(seed)
    rows = rng.permutation(np.flatnonzero(np.isfinite(values)))[: 2 * MOST]
    moves = np.ptp(k[rows], axis=0) > 0 if len(rows) else np.zeros(k.shape[1], bool)
    pairs = np.triu_indices(int(moves.sum()))
    if len(rows) < 2 * PER_TERM * (1 + int(moves.sum()) + len(pairs[0])) or not np.ptp(values[rows]):
        return None
    z = (k[rows][:, moves] - k[rows][:, moves].mean(axis=0)) / k[rows][:, moves].std(axis=0)
    y = (values[rows] - values[rows].mean()) / values[rows].std()

    def terms(x: Array) -> Array:
        return np.column_stack([np.ones(len(x)), x, x[:, pairs[0]] * x[:, pairs[1]]])

    fitted, judge, told = terms(z[::2]), z[1::2], y[1::2]
    ridge = RIDGE * len(fitted) * np.eye(fitted.shape[1])
    weights = np.linalg.solve(fitted.T @ fitted + ridge, fitted.T @ y[::2])

    def error(x: Array) -> float:
        return float(np.mean((told - terms(x) @ weights) ** 2))

    least, rises = error(judge), np.zeros(k.shape[1])
    for place, waypoint in enumerate(np.flatnonzero(moves)):
        shuffled = judge.copy()
        shuffled[:, place] = rng.permutation(judge[:, place])
        rises[waypoint] = max(error(shuffled) - least, 0.0)
    explained = 1.0 - least / float(told.var())
    return (
        {"shares": rises / rises.sum(), "explained": explained} if explained > 0.0 and rises.any() else None
    )
