"""Which waypoints mattered: permutation importance (Breiman 2001) by a quadratic fit of a run's designs."""

from typing import Any

import numpy as np

from footopt.arrays import Array, Ints

MOST = 4_000  # designs of a fit, and as many that judge it
RIDGE = 1e-3  # of the variance of a term: the best designs of a search are nearly alike
PER_TERM = 4  # designs that a term of the fit takes at least


def importance(k: Ints, values: Array, seed: int = 0) -> dict[str, Any] | None:
    """How much each waypoint's height, of k (designs, n), tells of a value (designs,): shares of 1.

    A quadratic is fitted to half of the designs. A waypoint matters by how much the fit's squared error in
    the other half rises where its heights are shuffled among them; "explained" is the share of their variance
    that the fit explains. None where the designs are too few, or the fit explains nothing.
    """
    rng = np.random.default_rng(seed)
    rows = rng.permutation(np.flatnonzero(np.isfinite(values)))[: 2 * MOST]
    pairs = np.triu_indices(n := k.shape[1])
    if len(rows) < 2 * PER_TERM * (1 + n + len(pairs[0])) or not np.ptp(values[rows]):
        return None
    z = (k[rows] - k[rows].mean(axis=0)) / np.maximum(k[rows].std(axis=0), 1e-12)  # one may never move
    y = (values[rows] - values[rows].mean()) / values[rows].std()

    def terms(x: Array) -> Array:
        return np.column_stack([np.ones(len(x)), x, x[:, pairs[0]] * x[:, pairs[1]]])

    fitted, judge, told = terms(z[::2]), z[1::2], y[1::2]
    ridge = RIDGE * len(fitted) * np.eye(fitted.shape[1])
    weights = np.linalg.solve(fitted.T @ fitted + ridge, fitted.T @ y[::2])

    def error(x: Array) -> float:
        return float(np.mean((told - terms(x) @ weights) ** 2))

    least, rises = error(judge), np.zeros(n)
    for waypoint in range(n):
        shuffled = judge.copy()
        shuffled[:, waypoint] = rng.permutation(judge[:, waypoint])
        rises[waypoint] = max(error(shuffled) - least, 0.0)
    if not rises.any() or least >= told.var():
        return None
    return {"shares": rises / rises.sum(), "explained": 1.0 - least / float(told.var())}
