"""`certified`: the best design of a search, with every sole near it evaluated and none better."""

import math
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from footopt.arrays import Array, Ints, Words
from footopt.design.archive import Designs, Evaluator
from footopt.design.problem import FootProblem
from footopt.design.result import Confirmation, SearchResult, confirm, largest_change
from footopt.foot import Waypoints
from footopt.walk.accuracy import AnyAccuracy

MOST = 20_000  # soles of a neighbourhood: of a larger space only nearer ones are evaluated
FAILED = 1e300  # of a design that breaks a constraint: any neighbour that keeps it is better
SAFETY = 2.0  # times the largest change between accuracies that was seen: closer designs are evaluated finely


@dataclass(frozen=True)
class Certificate:
    """That no sole near a design is better."""

    k: tuple[int, ...]  # heights of the design
    distance: int  # waypoints in which a neighbour may differ by any height: 1 or 2
    soles: int  # neighbours
    inside: int  # of these, the soles that stay in their box: the others are infeasible
    walks: int  # of these, the ones that the search had not evaluated
    finely: int  # soles so near in value that they were evaluated at the finer accuracy, too
    accuracy: str  # name of that one, at which neighbours are compared with the design
    margin: float  # how near, relative: SAFETY times the largest change, of finalists and of these soles
    steps: int  # how often a better neighbour took the place of what the search had found
    holds: bool  # whether no neighbour is better; otherwise they were not all evaluated

    def __str__(self) -> str:
        near = "one waypoint" if self.distance == 1 else "up to 2 waypoints"
        known = f"{self.soles:,} soles, {self.inside:,} in their box, {self.walks:,} evaluated for this"
        if self.finely:
            known += f", {self.finely:,} of them within {100 * self.margin:.2g} % also at {self.accuracy}"
        found = f"; better ones found in it: {self.steps}" if self.steps else ""
        if self.holds:
            near += ", or by a shift of a run of its waypoints by one level"
            return f"Certificate: no sole that differs in {near}, is better ({known}{found})"
        return (
            f"No certificate: the best design has {self.inside:,} neighbours in their box, more than the "
            f"search has evaluated{found}. study.certify=true evaluates them all"
        )


def neighbours(k: Ints, space: Waypoints) -> tuple[Ints, int]:
    """The neighbours of a sole, (soles, n), and in how many waypoints they may differ from it by any height.

    In two, unless these are more than `MOST`: then in one. Runs of waypoints shifted by one level are always
    among them, because a spline changes its shape most when neighbouring waypoints move together.
    """
    from footopt.design.solvers.moves import shifts

    n, K = space.n, space.K
    distance = 2 if n * (n - 1) // 2 * (K - 1) ** 2 + n * (K - 1) <= MOST else 1
    found = [k + shifts(n)]
    for at in combinations(range(n), distance):
        changed = np.repeat(k[None], K**distance, axis=0)
        changed[:, at] = 1 + np.indices((K,) * distance).reshape(distance, -1).T
        found.append(changed)
    near = np.unique(np.concatenate(found), axis=0)
    kept = ((near >= 1) & (near <= K)).all(axis=1) & (near != k).any(axis=1)
    return near[kept], distance


def certified(
    result: SearchResult, accuracy: AnyAccuracy, finalists: int, evaluator: Evaluator, most: float = math.inf
) -> tuple[SearchResult, Confirmation, Certificate]:
    """Confirm a search of one objective, and evaluate every neighbour of the design that comes out of it.

    Neighbours are evaluated at the accuracy of the search. Those that could be better at the finer one are
    evaluated at that, too, by how finalists change from one to the other; and more of them where the
    neighbours change by more. One that is better takes the design's place, and its neighbours are evaluated,
    until none is: it joins the result that is returned. If all this takes more than `most` evaluations, the
    certificate does not hold.
    """
    problem, space = result.problem, result.problem.space
    searched, fresh, count, steps = {k.tobytes() for k in result.k}, set[bytes](), finalists, 0
    while True:
        confirmed = confirm(result, accuracy, count)
        own, good = result.k[confirmed.designs[0]], confirmed.good
        both = result.values[confirmed.designs[good]], confirmed.values[good]
        before, after = (problem.column(each, problem.ranking_objective) for each in both)
        margin = SAFETY * largest_change(before, after, none=0.0)
        pair = result.values[confirmed.designs[:1]], confirmed.values[:1]
        least, goal = (problem.minimised(each)[0, 0] if good[0] else FAILED for each in pair)
        near, distance = neighbours(own, space)
        inside = near[space.inside(near)]
        new = {k.tobytes() for k in inside} - searched
        affordable = len(fresh | new) <= most
        finer, walked = np.full(len(inside), np.inf), np.zeros(len(inside), bool)
        if affordable and len(inside):
            fresh |= new
            f = _judged(problem, inside, *evaluator(inside))
            while (close := (f <= least + margin * abs(least)) & ~walked).any():
                finer[close] = _judged(problem, inside[close], *problem.at(accuracy).walk(inside[close]))
                walked |= close
                margin = max(margin, SAFETY * largest_change(f[close], finer[close], none=0.0))
        if finer.min(initial=np.inf) >= goal:
            break
        steps += 1
        best = inside[[finer.argmin()]]
        values, reasons = evaluator(best)
        result = joined(result, best, values, reasons)
        ranks = problem.scores(result.values[result.feasible])
        count = max(finalists, int((ranks <= problem.scores(values)[0]).sum()))  # it has to be among them
    certificate = Certificate(
        k=tuple(own.tolist()),
        distance=distance,
        soles=len(near),
        inside=len(inside),
        walks=len(fresh),
        finely=int(walked.sum()),
        accuracy=accuracy.name,
        margin=margin,
        steps=steps,
        holds=affordable,
    )
    return result, confirmed, certificate


def _judged(problem: FootProblem, k: Ints, values: Array, reasons: Words) -> Array:
    """The objective of evaluated designs, minimised, (designs,); infinite where a constraint is broken."""
    kept = problem.feasible(values, reasons, problem.space.box_violation(k))
    return np.where(kept, problem.minimised(values)[:, 0], np.inf)


def joined(result: SearchResult, k: Ints, values: Array, reasons: Words) -> SearchResult:
    """A search with one design more (1, n), as if its last generation had found it."""
    if (result.k == k).all(axis=1).any():
        return result
    problem = result.problem
    old = Designs(*(getattr(result, name) for name in Designs._fields))
    new = Designs(k, values, reasons, problem.space.box_violation(k), result.generation[-1:])
    better = problem.scores(values)[0] < problem.scores(result.values[[result.best]])[0]
    best = len(result.k) if better else result.best
    return replace(result, **Designs.joined([old, new])._asdict(), best=best, front=np.array([best]))
