"""A search by models of the objectives, for walks that cost more than a model does."""

from __future__ import annotations

import warnings
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.population import Population

from footopt.design.fronts import nondominated
from footopt.design.solvers.memetic import Moves, front, order, steps
from footopt.design.solvers.moves import RandomInside, allowed
from footopt.design.solvers.registry import DEAR

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST = 20  # feasible designs before there are models
FITTED = 200  # designs that a model's lengths are fitted to
TRAINED = 1500  # designs that a model knows
STEPS = 15  # of L-BFGS-B a generation, from the lengths of the last one
ROUNDS, CHILDREN = 12, 600  # of moves on the models, and children in each
CANDIDATES, RANDOM = 500, 50  # designs that samples choose from: the best of the moves, and random ones
PARENTS = 20  # of one objective, of which the moves begin
NOISE = (1e-4, 1.0)  # of a model's variance: ruggedness that it cannot follow


class Surrogate(Moves):
    """Gaussian processes of the objectives; each design of a batch is the best of another sample of them.

    Each objective has a process of scikit-learn's with a squared exponential kernel of two lengths, for
    heights and for differences of neighbours. The kernel sees whole numbers only, as Garrido-Merchan &
    Hernandez-Lobato (Neurocomputing 380, 2020) advise. A single objective of one sign is modelled by its
    logarithm: J_W is a product of measures that are smoother than itself. The moves of `memetic` improve
    designs on the models' means; of what they come upon, samples of the processes choose (Thompson 1933;
    Kandasamy et al. 2018): explored is what the models do not know. With several objectives each sample looks
    in another direction, by the augmented Chebyshev distance from its ideal point (Knowles 2006).
    """

    growth = DEAR

    def __init__(self, pop_size: int | None = None, **kwargs: Any) -> None:
        super().__init__(pop_size, **kwargs)
        self.theta: list[Array] = []  # of each kernel, from which the next fit goes on

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        self.front = front(Population.merge(self.front, infills))
        self.pop = self.known[order(self.known)[:PARENTS]] if self.problem.n_obj == 1 else self.front

    def _set_optimum(self) -> None:
        self.opt = self.pop[:1] if self.problem.n_obj == 1 else self.front

    def _propose(self, size: int) -> Ints:
        from sklearn.exceptions import ConvergenceWarning
        from threadpoolctl import threadpool_limits

        good = self.known.get("CV")[:, 0] <= 0.0
        if good.sum() < LEAST:
            return super()._propose(size)
        X, F = self.known.get("X").astype(np.int64), self.known.get("F").astype(float)
        F = np.where(good[:, None], F, F[good].max(axis=0))  # what fails is as bad as the worst
        with threadpool_limits(1), warnings.catch_warnings():  # sums in another order would lead elsewhere
            warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound
            models = self._models(X, F)
            candidates = self._candidates(models)
            if not len(candidates):
                return super()._propose(size)
            drawn = np.stack([self._samples(m, candidates, size) for m in models], axis=-1)
        span = np.ptp(drawn, axis=(0, 1))
        far = (drawn - drawn.min(axis=(0, 1))) / np.where(span > 0.0, span, 1.0)
        weighted = far * self.random_state.dirichlet(np.ones(len(models)), size)
        score = weighted.max(axis=-1) + 0.05 * weighted.sum(axis=-1)
        taken: dict[int, None] = {}
        for column in score.T:
            free = (int(i) for i in np.argsort(column, kind="stable") if int(i) not in taken)
            taken[next(free, 0)] = None
        return self._new(candidates[list(taken)], size)

    def _models(self, X: Ints, F: Array) -> list[Any]:
        """A process for each objective."""
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

        one = F.shape[1] == 1
        rank = (F if one else (F - F.min(axis=0)) / np.maximum(np.ptp(F, axis=0), 1e-300)).sum(axis=1)
        known = self._few(rank, TRAINED)
        fitted = self._few(rank[known], FITTED)
        inputs, models = self._inputs(X[known]), []
        for j in range(F.shape[1]):
            y = bounded(logarithmic(F[known, j]) if one else F[known, j])
            lengths = RBF(np.full(inputs.shape[1], 3.0), (0.1, 100.0))
            kernel = ConstantKernel(4.0, (1e-2, 1e4)) * lengths + WhiteKernel(1e-2, NOISE)
            if self.theta:
                kernel = kernel.clone_with_theta(self.theta[j])
            options = {"alpha": 1e-8, "normalize_y": True}
            few = GaussianProcessRegressor(kernel, optimizer=partial(fit, n=X.shape[1]), **options)
            few.fit(inputs[fitted], y[fitted])
            models.append(GaussianProcessRegressor(few.kernel_, optimizer=None, **options).fit(inputs, y))
        self.theta = [model.kernel_.theta for model in models]
        return models

    def _inputs(self, X: Ints) -> Array:
        """What a kernel sees of designs: heights and slopes, 2 for the whole range of heights."""
        return np.asarray(2.0 * steps(X) / float(np.max(self.problem.xu)))

    def _few(self, rank: Array, count: int) -> Ints:
        """Places of at most so many designs: the best, and as many of the others at random."""
        if len(rank) <= count:
            return np.arange(len(rank))
        places = rank.argsort(kind="stable")
        rest = self.random_state.permutation(places[count // 2 :])[: count - count // 2]
        return np.concatenate([places[: count // 2], rest])

    def _means(self, models: list[Any], X: Ints) -> Array:
        inputs = self._inputs(X)
        return np.stack([model.predict(inputs) for model in models], axis=1)

    def _candidates(self, models: list[Any]) -> Ints:
        """Designs never asked for that are good on the models: what moves come upon, and random ones."""
        known, draw = self.pop, self.random_state
        pool = np.unique(self.pop.get("X").astype(np.int64), axis=0)[:CANDIDATES]
        mean = self._means(models, pool)
        for _ in range(ROUNDS):
            self.pop = Population.new(X=pool)
            children = np.unique(self._children(CHILDREN), axis=0)
            children = children[allowed(self.problem, children)]
            if not len(children):
                continue
            pool = np.concatenate([pool, children])
            mean = np.concatenate([mean, self._means(models, children)])
            pool, first = np.unique(pool, axis=0, return_index=True)
            best = leaders(mean[first], CANDIDATES)
            pool, mean = pool[best], mean[first][best]
        self.pop = known
        drawn = RandomInside().do(self.problem, RANDOM, random_state=draw).get("X").astype(np.int64)
        return self._fresh(np.concatenate([pool, drawn]))

    def _samples(self, model: Any, X: Ints, count: int) -> Array:
        """Samples of a process at designs, (designs, count)."""
        mean, covariance = model.predict(self._inputs(X), return_cov=True)
        jitter = 1e-8 * max(float(np.trace(covariance)) / len(covariance), 1e-12)
        factor = np.linalg.cholesky(covariance + jitter * np.eye(len(covariance)))
        return np.asarray(mean[:, None] + factor @ self.random_state.normal(size=(len(mean), count)))


def bounded(f: Array) -> Array:
    """An objective whose worst values are drawn in: they are of no interest."""
    middle = float(np.median(f))
    return np.minimum(f, middle + 2.0 * (middle - float(f.min())))


def logarithmic(f: Array) -> Array:
    """The logarithm of a minimised objective that has one sign; another one as it is."""
    return np.sign(f) * np.log(np.abs(f)) if (f > 0.0).all() or (f < 0.0).all() else f


def fit(objective: Any, theta: Array, bounds: Array, n: int) -> tuple[Array, float]:
    """scikit-learn's optimizer of a kernel: a few steps, with one length for heights and one for slopes."""
    from scipy.optimize import minimize

    tied = np.repeat([0, 1, 2, 3], [1, n, n - 1, 1])  # variance, lengths, noise
    first = np.unique(tied, return_index=True)[1]

    def of_tied(few: Array) -> tuple[float, Array]:
        value, slope = objective(few[tied])
        return float(value), np.bincount(tied, slope).astype(float)

    given: dict[str, Any] = {"method": "L-BFGS-B", "options": {"maxiter": STEPS}}
    found = minimize(of_tied, theta[first], jac=True, bounds=bounds[first], **given)
    return found.x[tied], float(found.fun)


def leaders(value: Array, count: int) -> Ints:
    """Places of the best designs (designs, objectives), or of one front after the other."""
    if value.shape[1] == 1:
        return np.argsort(value[:, 0], kind="stable")[:count]
    left, kept = np.arange(len(value)), np.empty(0, np.int64)
    while len(left) and len(kept) < count:
        now = nondominated(value[left])
        kept, left = np.concatenate([kept, left[now]]), left[~now]
    return kept[:count]
