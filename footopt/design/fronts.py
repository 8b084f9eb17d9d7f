"""Fronts: their hypervolume, also of large ones, what few designs stand for them, and what half attain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Reals = NDArray[np.floating[Any]]

REFERENCE = 1.1  # of hypervolumes, where the merged front spans 0 to 1 in every objective
EXACT = 1000  # designs of a front up to which its hypervolume is exact: the time grows with a power of them
DIRECTIONS = 2048  # that a larger one is estimated in
BLOCK = 256  # designs that are looked at together
FEW, TABLE = 16, 2**17  # rays, and rays by designs, that are not halved again
SOUGHT = 2 ** np.arange(12, 21, 2)  # directions in which designs are sought that stand for a front
SHARE = 0.999  # of its hypervolume that a thinned front keeps, if so many designs may stay


class Volume:
    """Hypervolume of a front that grows, up to the origin: exact, and estimated where the front is large.

    Along a direction a front reaches as far as the best of its designs, and the hypervolume is the mean of
    that to the power of the objectives, times a constant (Deng & Zhang, IEEE Transactions on Evolutionary
    Computation 23, 2019). The estimate goes on from the last exact value, and new designs alone change it.
    """

    def __init__(self) -> None:
        self._reach = np.empty(0)
        self._constant = 0.0

    def __call__(self, f: Array, new: NDArray[np.bool_]) -> float:
        """The hypervolume of F (designs, objectives), minimised, of which some have not been seen before."""
        from moocore import hypervolume

        objectives = f.shape[1]
        if len(f) <= EXACT and not len(self._reach):
            return float(hypervolume(f, ref=np.zeros(objectives)))
        rays = directions(objectives, DIRECTIONS)
        if not len(self._reach):
            self._reach = reached(-f, rays)[0]
            exact = float(hypervolume(f, ref=np.zeros(objectives)))
            self._constant = exact / float((self._reach**objectives).mean())
        else:
            self._reach = np.maximum(self._reach, reached(-f[new], rays)[0])
        return self._constant * float((self._reach**objectives).mean())


def nondominated(F: Array) -> NDArray[np.bool_]:
    """Which designs no other dominates, (designs,)."""
    from moocore import is_nondominated

    return np.asarray(is_nondominated(np.ascontiguousarray(F, float), keep_weakly=True))


def ranks(F: Array) -> Ints:
    """Place of each design by each objective, (designs, objectives)."""
    best = F.T.argsort(kind="stable")
    place = np.empty_like(best)
    np.put_along_axis(place, best, np.arange(len(F))[None], axis=1)
    return place.T


def enlarged(F: Array, new: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which designs of a front F (designs, objectives) no new one dominates, and which new ones stay, too."""
    blocks, stay = [F[start : start + BLOCK] for start in range(0, len(F), BLOCK)], nondominated(new)
    for block in blocks:
        stay[stay] = ~dominated(new[stay], block)
    return ~np.concatenate([np.empty(0, bool), *(dominated(block, new[stay]) for block in blocks)]), stay


def dominated(F: Array, by: Array) -> NDArray[np.bool_]:
    """Which designs (designs, objectives) others dominate, (designs,)."""
    as_good = np.ones((len(by), len(F)), bool)
    for one, other in zip(by.T, F.T, strict=True):
        as_good &= one[:, None] <= other
    better, worse = np.nonzero(as_good)
    found = np.zeros(len(F), bool)
    found[worse[(by[better] < F[worse]).any(axis=1)]] = True
    return found


def thinned(f: Array, most: int) -> tuple[Ints, float, float]:
    """Designs that stand for a large front: those that reach farthest, each in some direction.

    Of more and more directions, until they keep `SHARE` of the front's hypervolume, by two standard errors
    more, or are as many as may be, or there are no more directions (`SOUGHT`).

    Parameters
    ----------
    f : (designs, objectives)
        A front, minimised.
    most : int
        How many at most.

    Returns
    -------
    places : (kept,)
        The best of each objective first; the first of them stand for the front as well as so few can.
    share, error : float
        Of the front's hypervolume that they keep, by Monte Carlo in other directions, and its standard error.
    """
    objectives = f.shape[1]
    span = np.ptp(f, axis=0)
    inward = REFERENCE - (f - f.min(axis=0)) / np.where(span > 0.0, span, 1.0)
    inward = inward.astype(np.float32)
    others, every = (
        directions(objectives, count, seed).astype(np.float32)
        for seed, count in enumerate((8 * DIRECTIONS, SOUGHT[-1]))
    )
    whole, far = reached(inward, others)[0] ** objectives, np.zeros(len(others))
    kept, share, error = np.empty(0, np.int64), 0.0, 0.0
    for rays in np.split(every, SOUGHT[:-1]):
        found = np.concatenate([kept, f.argmin(axis=0), reached(inward, rays)[1]])
        found = found[np.sort(np.unique(found, return_index=True)[1])][:most]
        for start in range(len(kept), len(found), BLOCK):
            kept = found[: start + BLOCK]
            far = np.maximum(far, reached(inward[kept[start:]], others)[0])
            share = float((far**objectives).sum() / whole.sum())
            apart = far**objectives - share * whole
            error = float(np.sqrt(np.mean(apart**2) / len(whole)) / whole.mean())
            if share - 2.0 * error >= SHARE or len(kept) == most:
                return kept, share, error
    return kept, share, error


def directions(objectives: int, count: int, seed: int = 0) -> Array:
    """Unit vectors (count, objectives) of the positive orthant, uniform on the sphere, always the same."""
    drawn = np.abs(np.random.default_rng(seed).normal(size=(count, objectives)))
    unit: Array = drawn / np.linalg.norm(drawn, axis=1, keepdims=True)
    return unit


def reached(inward: Reals, rays: Reals) -> tuple[Array, Ints]:
    """How far a front reaches along each ray, and by which of its designs, (rays,) each; inward: -F.

    Rays are halved into cones; along those of a cone only designs are looked at that reach as far along the
    cone's farthest ray as some design does along all of them. A front of no designs reaches 0.
    """
    best, which, steep = np.zeros(len(rays)), np.zeros(len(rays), np.int64), 1.0 / rays
    todo = [(np.arange(len(inward)), np.fmax(inward.T, 0.0), np.arange(len(rays)))]
    while todo and len(inward):
        near, front, cone = todo.pop()
        ends = steep[cone].min(axis=0), steep[cone].max(axis=0)
        stay = np.flatnonzero(_least(front, ends[1]) >= _least(front, ends[0]).max())
        near, front = near[stay], front[:, stay]
        if len(cone) > FEW and len(cone) * len(near) > TABLE:
            order = cone[rays[cone, np.ptp(rays[cone], axis=0).argmax()].argsort()]
            todo += [(near, front, half) for half in np.array_split(order, 2)]
            continue
        far = _least(front, steep[cone].T[:, :, None])
        place = far.argmax(axis=1)
        best[cone], which[cone] = far[np.arange(len(cone)), place], near[place]
    return best, which


def _least(front: Reals, steep: Reals) -> Reals:
    """How far designs, (objectives, designs), reach along rays, by their inverses (objectives, ...)."""
    far: Reals = front[0] * steep[0]
    for one, other in zip(front[1:], steep[1:], strict=True):
        np.minimum(far, one * other, out=far)
    return far


def hypervolume_shares(fronts: Sequence[Array]) -> list[float]:
    """Hypervolume of each front over that of all merged; F (designs, objectives) of each, minimised."""
    from moocore import filter_dominated, hypervolume

    merged = filter_dominated(np.concatenate(fronts))
    low, span = merged.min(axis=0), np.ptp(merged, axis=0)
    span = np.where(span > 0.0, span, 1.0)
    whole, *parts = (hypervolume((f - low) / span, ref=REFERENCE) for f in (merged, *fronts))
    return [float(part / whole) for part in parts]


def median_attainment(fronts: Sequence[Array]) -> Array:
    """What half of the fronts attain, (points, 2), of F (designs, 2), minimised.

    The empirical attainment function (Fonseca, Guerreiro, Lopez-Ibanez & Paquete 2011).
    """
    from moocore import eaf

    sets = np.repeat(np.arange(len(fronts)), [len(front) for front in fronts])
    return np.asarray(eaf(np.concatenate(fronts), sets, percentiles=[50])[:, :2])
