"""`atlas`: the best sole of every cell of a map, of all designs that a store knows.

A map of what is possible (quality and diversity: Mouret & Clune, arXiv 1504.04909, 2015), without a search of
its own: who searched for one thing has walked with thousands of soles that are good for another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from footopt.design.problem import Array, FootProblem, Ints
from footopt.design.store import ERROR, Store
from footopt.errors import FootoptError, check
from footopt.foot import Foot
from footopt.walk.objectives import MEASURES
from footopt.walk.simulate import evaluate

BLOCK = 4096  # designs whose descriptors are measured at a time


@dataclass(frozen=True, eq=False)
class Atlas:
    """The best design of every cell.

    Parameters
    ----------
    names : (str, str)
        Descriptors, along and across.
    edges : (2, cells + 1)
        Of the cells, in the descriptors' units.
    cells : (filled, 2)
        Where each design is, along and across, from 0.
    k : (filled, n)
        Its heights.
    values : (filled, 3)
        What `FootProblem.guide` is of it, and its descriptors, natural signs.
    counts : (filled,)
        Feasible designs in its cell.
    walks : int
        Designs that the store knows.
    """

    names: tuple[str, str]
    edges: Array
    cells: Ints
    k: Ints
    values: Array
    counts: Ints
    walks: int


def atlas(problem: FootProblem, store: Store, names: Sequence[str], cells: int) -> Atlas:
    """Sort all feasible designs of a store into cells of two descriptors, and keep the best of each.

    Descriptors that a store does not record are measured: of a foot from its heights, of a walk by walking
    again.

    Parameters
    ----------
    problem : FootProblem
        Whose store it is; what is best is said by its `guide`.
    store : Store
        Of that problem.
    names : (str, str)
        Any two of `MEASURES`.
    cells : int
        Along each.

    Raises
    ------
    SettingError
        The descriptors are not two different measures.
    FootoptError
        The store has no feasible design of the problem, or all are alike in a descriptor.
    """
    allowed = f"two different ones of {', '.join(MEASURES)}"
    good = len(names) == 2 and len(set(names)) == 2 and all(name in MEASURES for name in names)
    check(good, "study.descriptors", list(names), allowed)
    check(2 <= cells <= 100, "study.cells", cells, "a whole number from 2 to 100")
    heights, known = store.everything()
    known_values = np.array([e.values for e in known]).reshape(-1, len(problem.record))
    reasons = np.array([e.reason for e in known], np.str_)
    k = np.array(heights, np.int64).reshape(-1, problem.space.n)
    violation = problem.space.box_violation(k) if len(k) else np.empty(0)
    kept = (problem.constraints(known_values, reasons, violation) <= 0.0).all(axis=1) & (reasons != ERROR)
    if not kept.any():
        why = store.describe() or f"{store.path} is empty"
        raise FootoptError(f"No feasible design of this search is known. {why}.")
    k, recorded = k[kept], known_values[kept]
    found = np.stack([_column(problem, k, recorded, name) for name in names], axis=1)
    whole = np.isfinite(found).all(axis=1)
    k, recorded, found = k[whole], recorded[whole], found[whole]
    spread = len(k) > 0 and bool((np.ptp(found, axis=0) > 0.0).all())
    if not spread:
        raise FootoptError(f"All {len(k)} feasible designs are alike in {' or '.join(names)}: try others.")
    edges = np.linspace(found.min(axis=0), found.max(axis=0), cells + 1, axis=1)
    at = np.stack([np.searchsorted(e[1:-1], f, side="right") for e, f in zip(edges, found.T, strict=True)], 1)
    guide = problem.record.index(problem.guide)
    order = np.argsort(MEASURES[problem.guide].sign * recorded[:, guide], kind="stable")
    filled, first, counts = np.unique(at[order], axis=0, return_index=True, return_counts=True)
    best = order[first]
    values = np.concatenate([recorded[best][:, [guide]], found[best]], axis=1)
    return Atlas((names[0], names[1]), edges, filled, k[best], values, counts, len(known))


def _column(problem: FootProblem, k: Ints, recorded: Array, name: str) -> Array:
    """A measure of designs (designs, n): as it was recorded, of the foot, or by walking again."""
    if name in problem.record:
        return np.asarray(recorded[:, problem.record.index(name)])
    measure = MEASURES[name]
    if measure.of == "foot":
        return np.array([float(measure.value(Foot.from_waypoints(row, problem.space))) for row in k])
    parts = []
    for begin in range(0, len(k), BLOCK):
        block = k[begin : begin + BLOCK]
        table = evaluate(block, problem.scene, problem.accuracy, (name,), problem.space, problem.threads)
        parts.append(table.values[:, 0])
    return np.concatenate(parts)
