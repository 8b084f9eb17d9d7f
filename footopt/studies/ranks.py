"""Ranks of a search's finalists, and of the flat sole, under other sand laws than the scene's.

The other laws are those with and without the leading edge and shadowing, and zeta by its spread up and down.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.design import FootProblem
from footopt.design.scenarios import Scenario, harder_and_softer, plausible_laws
from footopt.report.numbers import percent
from footopt.walk import Scene, Simulator, evaluate
from footopt.walk.ladder import numerics
from footopt.walk.objectives import relative_change

Ints = NDArray[np.int64]


class RankChange(NamedTuple):
    """The best design under another law: its place among the finalists, and against the flat sole."""

    law: str
    place: int  # of the best design; 1 is the first
    loss: float  # of the single objective, relative to the best finalist under this law; NaN for several
    turned: tuple[str, ...]  # objectives in which the best design and the flat sole change places
    change: dict[str, float]  # relative, from the flat sole to the best design; NaN where one of them failed


def alternative_laws(scene: Scene | Simulator, spread: float) -> list[Scenario]:
    """A scene under the laws that may be true instead of its own, and with zeta a standard deviation off.

    None of one without sand.
    """
    if scene.sand is None:
        return []
    return [*(s for s in plausible_laws(scene) if s.scene != scene), *harder_and_softer(scene, spread)]


def rank_changes(problem: FootProblem, finalists: Ints, flat: Ints, spread: float) -> list[RankChange]:
    """Evaluate finalists (designs, n), the best one first, and the flat sole (n,) under every other law.

    `spread` is a standard deviation of the logarithm of zeta. All walk with the numbers that the
    scene's own law takes: to find other ones would take longer than these walks.
    """
    numbers = numerics(problem.accuracy, problem.scene, problem.space)
    feet, alternatives = np.concatenate([finalists, flat[None]]), alternative_laws(problem.scene, spread)
    own, *others = (
        evaluate(feet, scene, numbers, problem.record, problem.space, problem.threads).values
        for scene in (problem.scene, *(law.scene for law in alternatives))
    )
    before, found = own[0] - own[-1], []
    for law, values in zip(alternatives, others, strict=True):
        scores, after = problem.ranked(values[:-1]), values[0] - values[-1]
        turned = (before * after < 0.0) | (np.isfinite(before) & ~np.isfinite(after))
        single = problem.n_obj == 1 and math.isfinite(scores[0])
        loss = float((scores[0] - scores.min()) / abs(scores.min())) if single else math.nan
        change = dict(zip(problem.record, relative_change(values[0], values[-1]).tolist(), strict=True))
        names = tuple(name for name, t in zip(problem.record, turned, strict=True) if t)
        found.append(RankChange(law.name, 1 + int((scores < scores[0]).sum()), loss, names, change))
    return found


def turned_by(found: Sequence[RankChange]) -> dict[str, list[str]]:
    """Laws under which the best design and the flat sole change places, by objective."""
    names = dict.fromkeys(name for rank in found for name in rank.turned)
    return {name: [rank.law for rank in found if name in rank.turned] for name in names}


def by_objective(found: Sequence[RankChange]) -> dict[str, list[float]]:
    """Relative changes from the flat sole to the best design under the laws, by objective."""
    return {name: [rank.change[name] for rank in found] for name in (found[0].change if found else ())}


def describe(found: Sequence[RankChange], count: int) -> list[str]:
    """The ranks in a line; none where nothing was evaluated."""
    if not found or count < 2:
        return []
    each = []
    for r in found:
        loss = f", loses {percent(r.loss)}" if math.isfinite(r.loss) and r.place > 1 else ""
        each.append(f"{r.law} no. {r.place}{loss}")
    return [f"Under other laws the best of {count} finalists is: {'; '.join(each)}"]


def entry(found: Sequence[RankChange]) -> dict[str, Any]:
    """Ranks in result.json."""
    return {"laws": [rank._asdict() for rank in found], "turned": turned_by(found)}
