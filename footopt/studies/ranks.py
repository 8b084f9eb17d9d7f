"""Which ranks does a plausible change of the law turn round? Finalists and the flat sole under other laws.

The other laws are those with and without the leading edge and shadowing, and zeta by its spread up and down.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.design import FootProblem
from footopt.design.robust import regret
from footopt.design.scenarios import Scenario, harder_and_softer, plausible_laws
from footopt.report.numbers import percent
from footopt.studies.audit import tau
from footopt.walk import MEASURES, Scene, evaluate

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Rank:
    """What becomes of the best design under another law.

    Parameters
    ----------
    law : str
        Which.
    place : int
        Of the best design among the finalists; 1 is the first.
    tau : float
        Kendall's tau of the finalists' order, this law against the run's own; NaN for fewer than two.
    lost : float
        Of the single objective, against the best finalist under this law, relative; NaN for several.
    turned : tuple of str
        Objectives in which the best design and the flat sole change places.
    change : dict of str to float
        Of each objective from the flat sole to the best design, relative; NaN where one of them failed.
    """

    law: str
    place: int
    tau: float
    lost: float
    turned: tuple[str, ...]
    change: dict[str, float] = field(default_factory=dict)


def other_laws(scene: Scene, spread: float) -> list[Scenario]:
    """A scene under the laws that may be true instead of its own, and with zeta a standard deviation off."""
    return [*(s for s in plausible_laws(scene) if s.scene != scene), *harder_and_softer(scene, spread)]


def ranks(problem: FootProblem, finalists: Ints, flat: Ints, spread: float) -> list[Rank]:
    """Walk with finalists, the best one first, and the flat sole under every other law.

    Parameters
    ----------
    problem : FootProblem
        Their scene, objectives, space and accuracy.
    finalists : (designs, n)
        Heights of the soles.
    flat : (n,)
        Of the flat sole.
    spread : float
        One standard deviation of the logarithm of zeta.
    """
    feet = np.concatenate([finalists, flat[None]])

    def walked(scene: Scene) -> Array:
        return evaluate(feet, scene, problem.accuracy, problem.record, problem.space, problem.threads).values

    own = walked(problem.scene)
    order, found = problem.ranked(own[:-1]), []
    for law in other_laws(problem.scene, spread):
        values = walked(law.scene)
        score = problem.ranked(values[:-1])
        both = np.isfinite(order) & np.isfinite(score)
        lost = math.nan
        if problem.n_obj == 1:
            column = values[:-1, problem.record.index(problem.ranking_objective)]
            maximise = MEASURES[problem.ranking_objective].maximise
            if np.isfinite(column).any():
                best = (np.nanmax if maximise else np.nanmin)(column)
                lost = float(regret(column[:1], np.array(best), problem.ranking_objective)[0])
        place = 1 + int((score < score[0]).sum()) if np.isfinite(score[0]) else len(score)
        with np.errstate(divide="ignore", invalid="ignore"):
            change = dict(zip(problem.record, (values[0] / values[-1] - 1.0).tolist(), strict=True))
        turned = _turned(problem, own, values)
        found.append(Rank(law.name, place, tau(order[both], score[both]), lost, turned, change))
    return found


def _turned(problem: FootProblem, own: Array, values: Array) -> tuple[str, ...]:
    """Objectives of the record in which the first and the last foot change places."""
    before, after = own[0] - own[-1], values[0] - values[-1]
    turned = (before * after < 0.0) | (np.isfinite(before) & ~np.isfinite(after))
    return tuple(name for name, t in zip(problem.record, turned, strict=True) if t)


def turned_by(found: Sequence[Rank]) -> dict[str, list[str]]:
    """Laws under which the best design and the flat sole change places, by objective."""
    names = dict.fromkeys(name for rank in found for name in rank.turned)
    return {name: [rank.law for rank in found if name in rank.turned] for name in names}


def describe(found: Sequence[Rank], count: int) -> list[str]:
    """The ranks in a line; none where nothing was walked."""
    if not found or count < 2:
        return []
    each = []
    for r in found:
        lost = f", loses {percent(r.lost)}" if math.isfinite(r.lost) and r.place > 1 else ""
        each.append(f"{r.law} no. {r.place}{lost}")
    return [f"Under other laws the best of {count} finalists is: {'; '.join(each)}"]


def entry(found: Sequence[Rank]) -> dict[str, Any]:
    """Ranks in result.json."""
    return {"laws": [asdict(r) for r in found], "turned": turned_by(found)}
