"""`under_laws`: feet under each law that the sand may follow, and the foot that loses least under the worst.

No experiment tells which law holds for a foot in the sand of a beach. The laws are the scene's own, those
with and without the leading edge and shadowing, and its own with a lower and a higher zeta.
"""

import math
from concurrent.futures import Executor
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from footopt.arrays import Array, Ints
from footopt.design.archive import Evaluator
from footopt.design.problem import FootProblem
from footopt.design.result import Confirmation, SearchResult
from footopt.design.robust import Race
from footopt.design.scenarios import Scenario, Spread, possible_laws
from footopt.design.search import search
from footopt.design.solvers import Solver
from footopt.design.store import Store
from footopt.errors import FootoptError
from footopt.walk.accuracy import PRESETS, AnyAccuracy, Tolerance
from footopt.walk.ladder import numerics
from footopt.walk.objectives import MEASURES, relative_change
from footopt.walk.simulate import evaluate

FIRST = 10  # soles that a search begins with
TIMES = 2  # budget of the search under all laws together, over that of the search under each
LAST = 5  # best soles of the search under all laws that are evaluated again
EVEN = 30  # designs in a generation, or an eighth of a small budget: such a search begins near its end
NOTHING = 1e-9  # of the largest value: a smaller best value counts as 0, as that of `hollow` may be
LEAST = 20  # evaluations of a search under a law


@dataclass(frozen=True, eq=False)
class UnderLaws:
    """Feet under every law."""

    laws: tuple[Scenario, ...]  # the scene's own first
    k: Ints  # (feet, n), heights; the best foot by the scene's own law first, the flat sole last
    #: (laws, feet), of the single objective, relative to the best of these feet under the law; infinite where
    #: a foot fails or breaks a limit, NaN under a law in which all do, and for several objectives
    losses: Array
    #: for each law, relative changes of values from the flat sole, (feet,), by name; NaN where one fails
    changes: list[dict[str, Array]]

    @property
    def worst(self) -> Array:
        """The loss of each foot under the law that is worst for it, (feet,)."""
        some = np.isfinite(self.losses).any(axis=1)
        return self.losses[some].max(axis=0) if some.any() else np.full(len(self.k), np.nan)

    @property
    def steadiest(self) -> int | None:
        """The foot that loses least under the worst law; None if each fails under one."""
        return int(self.worst.argmin()) if np.isfinite(self.worst).any() else None

    def entry(self, foot: int) -> list[dict[str, Any]]:
        """A foot in result.json: its loss and changes under each law, the scene's own first."""
        return [
            {
                "law": law.name,
                "loss": float(losses[foot]),
                "change": {name: float(column[foot]) for name, column in changes.items()},
            }
            for law, losses, changes in zip(self.laws, self.losses, self.changes, strict=True)
        ]


def under_laws(
    result: SearchResult,
    confirmed: Confirmation,
    spread: float = Spread.zeta,
    share: float | None = 0.05,
    store: str | Path | None = None,
    executor: Executor | None = None,
) -> UnderLaws:
    """The best foot of a search, soles that should lose little under every law, and the flat one, under each.

    Parameters
    ----------
    result : SearchResult
        Under the scene's own law.
    confirmed : Confirmation
        Of it; its accuracy is that of the walks.
    spread : float
        A standard deviation of the logarithm of zeta.
    share : float, optional
        Of the search's evaluations, for a search under each law (`candidates`). Without it, and where there
        are several objectives or no other law, there are only the best foot and the flat sole.
    store : str or Path, optional
        A file to keep every evaluation in, as in `search`.
    executor : concurrent.futures.Executor, optional
        Of the workers that evaluate, as in `search`.
    """
    problem = result.problem
    laws, feet = possible_laws(problem.scene, spread), [result.k[confirmed.designs[:1]]]
    if share is not None and len(laws) > 1 and problem.n_obj == 1:
        feet.append(candidates(result, laws, share, store, executor))
    feet.append(np.full((1, problem.space.n), problem.space.K))
    return compare(problem.at(confirmed.accuracy), laws, np.concatenate(feet))


def compare(problem: FootProblem, laws: tuple[Scenario, ...], feet: Ints) -> UnderLaws:
    """Evaluate feet (feet, n) under every law, the best one by the scene's own first and the flat sole last.

    All are walked with the numbers that the scene's own law takes: to find other ones would take longer than
    these walks.
    """
    k, name = problem.space.check(feet), problem.ranking_objective
    numbers = numerics(problem.accuracy, problem.scene, problem.space)
    losses, changes = np.full((len(laws), len(k)), np.nan), []
    for row, law in zip(losses, laws, strict=True):
        table = evaluate(k, law.scene, numbers, problem.record, problem.space, problem.threads)
        relative = relative_change(table.values, table.values[-1])
        changes.append(dict(zip(problem.record, relative.T, strict=True)))
        good = problem.feasible(table.values, table.reasons, problem.space.box_violation(k))
        if problem.n_obj == 1 and good.any():
            values = problem.column(table.values, name)
            lost = MEASURES[name].sign * values
            row[:] = np.where(good, (lost - lost[good].min()) / _size(values[good], name), np.inf)
    return UnderLaws(laws, k, losses, changes)


def _size(values: Array, name: str) -> float:
    """What losses of an objective are relative to: its best value, or the largest if the best is 0."""
    best, most = abs(values[(MEASURES[name].sign * values).argmin()]), np.abs(values).max()
    return float(best if best > NOTHING * most else most or 1.0)


def candidates(
    result: SearchResult,
    laws: tuple[Scenario, ...],
    share: float,
    store: str | Path | None = None,
    executor: Executor | None = None,
) -> Ints:
    """Soles (soles, n) that should lose little under every law, found from a search under the scene's own.

    Each other law in turn is searched with `share` of the search's evaluations, from the best soles of
    the laws before it and from those of the search; then, from the best sole of each law, all together with
    twice as many soles (`Race`). They walk no finer than `draft`: what is found is to be evaluated
    again. A law under which no foot walks is left out.
    """
    problem, start, name = result.problem, result.k[result.leaders(FIRST)], result.problem.ranking_objective
    numbers = numerics(drafted(problem.accuracy), problem.scene, problem.space)
    walks, doing = max(math.ceil(share * result.evaluations), LEAST), "searching the foot to print"
    alike = problem.names, problem.space, numbers, problem.threads
    found: list[Ints] = []
    walked: list[tuple[Scenario, float, Evaluator]] = []  # laws, with references and evaluators

    def solver(walks: int) -> Solver:
        size = max(min(EVEN, walks // 8), FIRST)
        return Solver(walks=walks, pop_size=size, seed=result.solver.seed)

    with ExitStack() as opened:
        for law in laws:
            alone = FootProblem(law.scene, *alike, problem.limits)
            kept = None if store is None else opened.enter_context(Store(store, alone))
            most = len(start) if law.scene == problem.scene else walks  # that has been searched
            with suppress(FootoptError):  # no foot walks
                begin = _different([*found[::-1], start])
                best = search(alone, solver(most), store=kept, executor=executor, start=begin)
                best.uninterrupted(doing)
                reference = _size(best.column(name)[best.feasible], name)
                walked.append((law, reference, Evaluator(alone, kept, executor)))
                found.append(best.k[[best.best]])
        if len(walked) > 1:
            with suppress(FootoptError):  # none walks under all of them
                race = Race(*zip(*walked, strict=True))
                best = search(race, solver(TIMES * walks), start=_different(found)).uninterrupted(doing)
                found.append(best.k[best.leaders(LAST)])
    return np.unique(np.concatenate(found or [start]), axis=0)


def _different(soles: list[Ints]) -> Ints:
    """The first `FIRST` different ones of some soles."""
    return np.array(list(dict.fromkeys(map(tuple, np.concatenate(soles).tolist())))[:FIRST])


def drafted(accuracy: AnyAccuracy) -> AnyAccuracy:
    """An accuracy, but no finer than `draft`, for what only ranks feet."""
    draft = PRESETS["draft"]
    return draft if isinstance(accuracy, Tolerance) and accuracy.error < draft.error else accuracy
