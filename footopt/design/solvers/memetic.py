"""The default solvers: moves that suit a spline, a model that selects them, neighbours, and restarts."""

from copy import deepcopy
from typing import Any

import numpy as np
from pymoo.core.algorithm import Algorithm
from pymoo.core.individual import Individual
from pymoo.core.initialization import Initialization
from pymoo.core.population import Population
from pymoo.util.display.multi import MultiObjectiveOutput
from pymoo.util.display.single import SingleObjectiveOutput

from footopt.arrays import Array, Ints
from footopt.design.fronts import nondominated
from footopt.design.problem import Known
from footopt.design.solvers import WALKS, grown
from footopt.design.solvers.model import Memory, Pool, RankModel
from footopt.design.solvers.moves import IDLE, RandomInside, allowed, exchanged, shifted, shifts

PARENTS = 30  # at first; for one objective twice as many after each restart
MOST_PARENTS = 240
PATIENCE = 8  # generations without a better design before the best one's neighbours are proposed
NORMAL = 0.5  # share of the children that are drawn from the parents' normal distribution
CROSSED = 0.4  # share of the others that have two parents
TWICE = 0.2  # share of the rest that are shifted twice
CHILDREN = 1000  # a generation, of which a model chooses
LEARNT = 40  # designs before there is a model
REMEMBERED = 10_000  # designs of a front, at most
WORSE = 1e100  # worse than any value, for a model of ranks: an infeasible design, the more it violates
FEW = 100  # parents, for several objectives
ENDS = 0.2  # share of a generation that seeks the best by one of several objectives alone
WATCHED, STALLED = 500, 0.05  # a front stalls if, of so many designs, a smaller share is well ahead of it
AHEAD = 0.01  # well ahead of each design of the front: by this share of the range of some objective
FREE = 2 / 3  # share of the children that the model does not choose while a front has at most `FEW` designs


class Moves(Algorithm):
    """Base of both solvers: no design twice, none outside its box, generations that grow (`grown`)."""

    def __init__(self, pop_size: int | None = None, sampling: Any = None, **kwargs: Any) -> None:
        super().__init__(**{"termination": ("n_eval", WALKS), **kwargs})  # pymoo's tolerances know no restart
        self.pop_size = pop_size
        self.initialization = Initialization(RandomInside() if sampling is None else sampling)
        self.proposed = Known()
        self.memory: Memory  # what a model is made of
        self.model: RankModel | None = None
        self.pool: Pool  # the population
        self.front: Pool  # and what no other dominates; of one objective the best
        self.every: Pool  # of several, the same of all populations

    def _setup(self, problem: Any, **kwargs: Any) -> None:
        self.proposed = Known()
        self.memory = Memory(np.empty((0, problem.n_var), np.int64), np.empty((0, problem.n_obj)))
        if self.display.output is None:
            self.display.output = MultiObjectiveOutput() if problem.n_obj > 1 else SingleObjectiveOutput()

    def _size(self) -> int:
        """Designs of the next generation."""
        return self.pop_size or grown(len(self.proposed))

    def _initialize_infill(self) -> Any:
        drawn = self.initialization.do(self.problem, self._size(), random_state=self.random_state)
        X = np.round(drawn.get("X").astype(float)).astype(np.int64)
        fresh = self.proposed.fresh(X)
        self.proposed.add(X[fresh])  # outside its box, too, if a user begins with it
        begun = deepcopy(drawn[fresh])  # a user's own, which may have been evaluated
        begun.set("X", X[fresh])
        return begun

    def _infill(self) -> Any:
        found = self._found(self._size())
        if not len(found):  # a small space has no more
            self.termination.force_termination = True
            return None
        config = Individual.default_config()
        return Population.create(*(Individual(config, X=k) for k in found))

    def _found(self, size: int) -> Ints:
        """New designs, `size` of them if there are as many."""
        found = self._propose(size)
        idle = 0
        while (wanted := size - len(found)) and idle < IDLE:
            children = self._screened(self._fresh(self._children(max(CHILDREN, wanted))), wanted)
            found = np.concatenate([found, self._noted(children[:wanted])])
            idle = 0 if len(children) else idle + 1
        return found if len(found) else self._drawn(size)

    def _drawn(self, count: int) -> Ints:
        """New designs drawn at random."""
        drawn = RandomInside()._do(self.problem, 4 * count, self.random_state)
        return self._noted(self._fresh(drawn)[:count])

    def _fresh(self, X: Ints) -> Ints:
        """The designs (designs, n) that are allowed and were not proposed before, each once."""
        X = X[self.proposed.fresh(X)].astype(np.int64)
        return X[allowed(self.problem, X)]

    def _noted(self, fresh: Ints) -> Ints:
        """Note designs (designs, n) that are fresh as proposed, and return them."""
        self.proposed.add(fresh)
        return fresh

    def _children(self, count: int) -> Ints:
        """Children of drawn parents, or of all parents' distribution."""
        normal = self.random_state.random(count) < NORMAL
        drawn = int(normal.sum())
        X = np.empty((count, self.problem.n_var), np.int64)
        X[normal] = normal_sample(self.pool.X.astype(float), drawn, self.random_state)
        X[~normal] = self._moved(count - drawn)
        return X

    def _moved(self, count: int) -> Ints:
        """Children of drawn parents: exchanged, shifted, or both."""
        draw = self.random_state
        X = self._parents(count)
        crossed = draw.random(count) < CROSSED
        X = np.where(crossed[:, None], exchanged(X, self._parents(count), draw), X)
        coin = draw.random(count)
        often = np.where(crossed, coin < 0.5, 1 + (coin < TWICE))
        X = np.where((often > 0)[:, None], shifted(X, draw), X)
        return np.where((often > 1)[:, None], shifted(X, draw), X)

    def _screened(self, X: Ints, count: int) -> Ints:
        """The most promising child, by a model of the walks so far, of each of `count` groups."""
        if self.memory.told < LEARNT or len(X) <= count:
            return X
        promise, order = self._promise(X), self.random_state.permutation(len(X))
        size, larger = divmod(len(X), count)  # so many groups are larger by one
        first = larger * (size + 1)
        groups = order[:first].reshape(larger, size + 1), order[first:].reshape(count - larger, size)
        return X[[i for rows in groups for i in rows[np.arange(len(rows)), promise[rows].argmax(axis=1)]]]

    def _promise(self, X: Ints) -> Array:
        """How far designs (designs, n) should lie ahead of the best so far, in ranks, (designs,)."""
        expected, known = self._expected(X)
        by_objective, promise = np.ascontiguousarray(expected.T), np.full(len(X), np.inf)
        for ahead in known[nondominated(known)]:
            np.minimum(promise, (ahead[:, None] - by_objective).max(axis=0), out=promise)
        return promise

    def _expected(self, X: Ints) -> tuple[Array, Array]:
        """Ranks of designs (designs, n) by each objective, as a model predicts them, and of known ones."""
        if self.model is None:
            self.model = RankModel(*self.memory.trained(), int(np.max(self.problem.xu)))
        return self.model(X), self.model.ranks

    def _parents(self, count: int) -> Ints:
        """Designs (count, n) that children are made of."""
        return np.asarray(self.pool.X[self.random_state.integers(len(self.pop), size=count)])

    def _initialize_advance(self, infills: Any = None, told: Any = None, **kwargs: Any) -> None:
        self.pool = self.front = self.every = told.take(slice(0))
        self._advance(infills, told=told)

    def advance(self, infills: Any = None, **kwargs: Any) -> Any:
        """Note what has been evaluated, and go on."""
        told = self.pool.take(slice(0)) if infills is None else Pool.of(infills)  # None: nothing was found
        bad = told.violation[:, None]
        self.memory = self.memory.joined(told.X, np.where(bad > 0.0, WORSE * (1.0 + bad), told.F))
        self.model = None
        return super().advance(infills=infills, told=told, **kwargs)

    def _go_on_with(self, pool: Pool) -> None:
        """Make a population the parents."""
        self.pop, self.pool = pool.pop, pool

    def _propose(self, size: int) -> Ints:
        """Designs that are proposed ahead of children."""
        return np.empty((0, self.problem.n_var), np.int64)


class Memetic(Moves):
    """One objective: few parents and their children; where it stalls, the best one's neighbours; restarts."""

    def __init__(self, pop_size: int | None = None, **kwargs: Any) -> None:
        super().__init__(pop_size, **kwargs)
        self.parents, self.age = PARENTS, 0

    def _advance(self, infills: Any = None, told: Any = None, **kwargs: Any) -> None:
        pool = self.pool.joined(told)
        best = pool.order()[: self.parents]
        self.age = 0 if best[0] >= len(self.pool.X) else self.age + 1
        self._go_on_with(pool.take(best))

    def _set_optimum(self) -> None:
        pool = self.front.joined(self.pool.take(slice(1)))
        self.front = pool.take(pool.order()[:1])
        self.opt = self.front.pop

    def _parents(self, count: int) -> Ints:
        """Better ones more often: the square of a uniform number picks the place."""
        place = (len(self.pop) * self.random_state.random(count) ** 2).astype(np.int64)
        return np.asarray(self.pool.X[place])

    def _propose(self, size: int) -> Ints:
        """Where it stalls, the best one's neighbourhood, in half of a generation; then a restart."""
        found = super()._propose(size) if self.age < PATIENCE else self._near(max(size // 2, 1))
        return found if len(found) or self.age < 3 * PATIENCE else self._restart(size)

    def _near(self, count: int) -> Ints:
        """New designs from the best one's neighbourhood."""
        near = self.pool.X[0] + shifts(self.problem.n_var)
        return self._noted(self._fresh(self.random_state.permutation(near))[:count])

    def _restart(self, size: int) -> Ints:
        """Random designs to begin anew with, and twice as many parents."""
        self.age, self.parents = 0, min(2 * self.parents, MOST_PARENTS)
        drawn = self._drawn(size)
        if len(drawn) == size:
            self._go_on_with(self.pool.take(slice(0)))
        return drawn


class Archive(Moves):
    """Several objectives: every design that no other dominates is kept, and is a parent.

    NSGA-II's survival (Deb et al. 2002) adds further parents up to `FEW`, or selects `FEW` of a larger front.
    The model does not see where a rugged front continues: while the front is small, it selects only a third
    of the children. A front that stalls may be a local one: then another population begins without it, and
    once that stalls too, both are joined.
    """

    def __init__(self, pop_size: int | None = None, **kwargs: Any) -> None:
        super().__init__(pop_size, **kwargs)
        self.before: Memory  # what the populations before have evaluated
        self.seen, self.ahead = 0, 0  # designs since the last look, and those of them well ahead of the front

    def _advance(self, infills: Any = None, told: Any = None, **kwargs: Any) -> None:
        alone, before = self.every is self.front, self.front.F
        self.front, added = self.front.front_with(told)
        self.seen, self.ahead = self.seen + len(told.X), self.ahead + self._ahead(before, added)
        self.front = self._thinned(self.front)
        self.every = self.front if alone else self._thinned(self.every.front_with(told)[0])
        few = len(self.front.X) <= FEW
        self._go_on_with(self._survivors(told) if few else self._least_crowded(self.front, FEW))

    def _ahead(self, before: Array, added: int) -> int:
        """How many of the newest designs of the front are well ahead of the front before."""
        F, span = self.front.F, np.ptp(self.front.F, axis=0)
        span = np.where(span > 0.0, span, 1.0)
        leads = [((before - new) / span).max(axis=1).min(initial=np.inf) for new in F[len(F) - added :]]
        return int((np.array(leads) > AHEAD).sum())

    def _survivors(self, told: Pool) -> Pool:
        """The parents and new designs that NSGA-II would let survive."""
        from pymoo.operators.survival.rank_and_crowding import RankAndCrowding

        pool = self.pool.joined(told)
        survive = {"n_survive": min(FEW, len(pool.X)), "random_state": self.random_state}
        return pool.take(RankAndCrowding().do(self.problem, pool.pop, return_indices=True, **survive))

    def _thinned(self, front: Pool) -> Pool:
        """A front; if it has more than `REMEMBERED` designs, the least crowded half of as many."""
        return front if len(front.X) <= REMEMBERED else self._least_crowded(front, REMEMBERED // 2)

    def _least_crowded(self, front: Pool, most: int) -> Pool:
        """`most` designs of a front, chosen as NSGA-II chooses among designs of one rank."""
        from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
        from pymoo.util.randomized_argsort import randomized_argsort

        crowding = get_crowding_function("cd").do(front.F, n_remove=len(front.X) - most)
        draw = {"method": "numpy", "random_state": self.random_state}
        return front.take(randomized_argsort(crowding, order="descending", **draw)[:most])

    def _set_optimum(self) -> None:
        self.opt = self.every.pop

    def _propose(self, size: int) -> Ints:
        """Some for the ends of the front; while it is small, a quarter are its most promising neighbours."""
        if self.seen >= WATCHED:
            stalled, self.seen, self.ahead = self.ahead < STALLED * self.seen, 0, 0
            if stalled and len(drawn := self._restart(size)):
                return drawn
        if self.memory.told < LEARNT:
            return super()._propose(size)
        ends = self._ends(int(ENDS * size))
        X = self.front.X
        if len(X) > FEW:
            return ends
        near = (X[:, None] + shifts(X.shape[1])).reshape(-1, X.shape[1])
        X = self._fresh(self.random_state.permutation(near)[: 3 * CHILDREN])
        best = np.argsort(-self._promise(X), kind="stable")
        return np.concatenate([ends, self._noted(X[best[: max(size // 4, 1)]])])

    def _ends(self, count: int) -> Ints:
        """The most promising children by one objective of the best designs by it; objectives take turns."""
        by, draw = (self.n_iter - 1) % self.problem.n_obj, self.random_state
        best = self.memory.X[self.memory.F[:, by].argsort(kind="stable")[:PARENTS]]
        one, other = (best[draw.integers(len(best), size=CHILDREN)] for _ in range(2))
        crossed = draw.random(CHILDREN) < CROSSED
        children = self._fresh(shifted(np.where(crossed[:, None], exchanged(one, other, draw), one), draw))
        order = np.argsort(self._expected(children)[0][:, by], kind="stable")
        return self._noted(children[order[:count]])

    def _restart(self, size: int) -> Ints:
        """Random designs of a second population; if there is one already, both go on together instead."""
        if self.every is not self.front:
            self.front, self.memory = self.every, self.before.joined(self.memory.X, self.memory.F)
            self._go_on_with(self.front)
            return super()._propose(size)
        drawn = self._drawn(size)
        if len(drawn) == size:
            self.before, self.memory = self.memory, Memory(self.memory.X[:0], self.memory.F[:0])
            self.front = self.front.take(slice(0))
            self._go_on_with(self.front)
        return drawn

    def _screened(self, X: Ints, count: int) -> Ints:
        free = int(FREE * count) if len(self.front.X) <= FEW else 0
        return np.concatenate([super()._screened(X[free:], count - free), X[:free]])


def normal_sample(X: Array, count: int, draw: Any) -> Ints:
    """Whole numbers from the normal distribution of designs (designs, n): (count, n).

    An estimation of distribution (Larranaga & Lozano 2002); the variances do not vanish.
    """
    n, mean = X.shape[1], X.mean(axis=0)
    covariance = (X - mean).T @ (X - mean) / max(len(X) - 1, 1) + 0.05 * np.eye(n)
    drawn = mean + draw.standard_normal((count, n)) @ np.linalg.cholesky(covariance).T
    return np.asarray(np.rint(drawn).astype(np.int64))
