"""How well a walk is resolved: its error estimate by refinement, and a warning where that is too large."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from footopt.foot import Foot
from footopt.walk.accuracy import PRESETS, AnyAccuracy
from footopt.walk.checks import Diagnostic
from footopt.walk.objectives import FIVE, sizes
from footopt.walk.results import Walk
from footopt.walk.simulate import estimated, simulate
from footopt.walk.simulator import Simulator

#: A warning is due where the estimate is this many times what the accuracy promises.
BEYOND = 10.0
PROMISE = PRESETS["standard"].error  # relative, of an accuracy without a tolerance

WHY = "try accuracy=fine, or a smaller accuracy.dt or accuracy.creep, or more accuracy.plates"


def estimate_error(
    foot: Foot, scene: Simulator | None = None, accuracy: AnyAccuracy | str = "standard"
) -> dict[str, float]:
    """Error estimate of a walk's objectives by refinement, absolute, in their own units.

    From the walks that are refined once and twice (`Accuracy.refined`), by `simulate.estimated`. NaN where
    the walk fails or a refined one ends otherwise, and for a walk that is too long to be refined (`ROWS`).

    Parameters
    ----------
    foot, scene, accuracy
        As in `simulate`.
    """
    return error_of(simulate(foot, scene, accuracy))


def error_of(walk: Walk, names: Sequence[str] | None = None) -> dict[str, float]:
    """`estimate_error` of a walk that has been simulated."""
    names = tuple(names or walk.objectives)
    values = np.array([list(walk.measures(names).values())])
    found = estimated(values, [walk.foot], walk.scene, walk.accuracy, names, threads=1)
    return dict(zip(names, found[0].tolist(), strict=True))


def resolution(walk: Walk, errors: Mapping[str, float]) -> list[Diagnostic]:
    """Whether a walk's worst error estimate is far above what its accuracy promises; empty if it is not.

    The `errors` are from `estimate_error`. A walk that failed has none.
    """
    if not walk.feasible:
        return []
    values = walk.objectives
    size = {name: max(abs(value), 1e-3) for name, value in values.items() if name != "efficiency"}
    size |= dict(zip(FIVE, sizes(np.array([values[name] for name in FIVE]), walk.scene), strict=True))
    shares = {
        name: errors[name] / size[name]
        for name in size
        if math.isfinite(values[name]) and math.isfinite(errors.get(name, math.nan))
    }
    limit = BEYOND * (walk.accuracy.tolerance or PROMISE)
    if not shares:
        return _outcome(walk, 100.0 * limit)
    worst = max(shares, key=lambda name: shares[name])
    if shares[worst] <= limit:
        return []
    name = f"estimated error of {worst.replace('_', ' ')}"
    return [Diagnostic(name, 100.0 * shares[worst], "%", 100.0 * limit, WHY)]


def _outcome(walk: Walk, limit: float) -> list[Diagnostic]:
    """Whether a finer walk fails where this one did not."""
    finer = [walk.accuracy.refined(times) for times in (1, 2)]
    if any(map(walk.scene.too_long, finer)):
        return []
    reasons = {simulate(walk.foot, walk.scene, one).reason for one in finer} - {""}
    why = f"a finer walk fails ({', '.join(sorted(reasons))}); try accuracy=fine"
    return [Diagnostic("estimated error of the outcome", 100.0, "%", limit, why)] if reasons else []
