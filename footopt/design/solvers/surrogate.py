"""A search by models of the objectives, for walks that cost more than a model does."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.design.solvers.memetic import Moves, front, order
from footopt.design.solvers.moves import RandomInside, allowed, exchanged, shifted

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

BATCH = 50  # designs a generation
FITTED = 300  # designs that a model's lengths are fitted to
TRAINED = 1500  # designs that a model knows
ROUNDS, KIDS = 12, 600  # of moves on the models, and children in each
CANDIDATES, RANDOM = 500, 50  # designs that samples of the models choose from, and random ones beside them
NOISE = 1e-4  # at least, of a model's variance: ruggedness that it cannot follow


class Surrogate(Moves):
    """Gaussian processes of the objectives, sampled for each design of a batch (Thompson 1933).

    Each objective has a process with a Matern kernel of one length for each height and each difference of
    neighbours. Every design is a whole number before the kernel sees it, which Garrido-Merchan and
    Hernandez-Lobato (Neurocomputing 380, 2020) advise. The moves of `memetic` improve designs on the models; of what
    they find, each member of the batch is the best of another sample of the processes, in another direction
    if there are several objectives.
    """

    def __init__(self, pop_size: int | None = None, **kwargs: Any) -> None:
        super().__init__(pop_size or BATCH, **kwargs)
        self.theta: list[Array] = []

    def _initialize_advance(self, infills: Any = None, **kwargs: Any) -> None:
        self._advance(infills)

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        from pymoo.core.population import Population

        self.pop = Population.merge(self.pop, infills) if self.is_initialized else infills

    def _set_optimum(self) -> None:
        self.opt = self.pop[order(self.pop)[:1]] if self.problem.n_obj == 1 else front(self.pop)

    def _parents(self, count: int) -> Ints:
        best = self.pop[order(self.pop)[:20]] if self.problem.n_obj == 1 else self.opt
        return best.get("X")[self.random_state.integers(len(best), size=count)].astype(np.int64)

    def _propose(self, size: int) -> Ints:
        from threadpoolctl import threadpool_limits

        with threadpool_limits(1):  # a sum in another order would lead elsewhere
            return self._chosen(size)

    def _chosen(self, size: int) -> Ints:
        """The batch: each the best candidate by another sample of the models."""
        X, F = self.pop.get("X").astype(np.int64), self.pop.get("F").astype(float)
        good = self.pop.get("CV")[:, 0] <= 0.0
        if good.sum() < 10:
            return super()._propose(size)
        F = np.where(good[:, None], F, F[good].max(axis=0))  # what fails is as bad as the worst
        models = self._models(X, F)
        candidates = self._candidates(X, F, models, size)
        draw = self.random_state
        drawn = np.stack([sampled(m, features(candidates, self._top), size, draw) for m in models], axis=-1)
        if len(models) > 1:  # Chebyshev's distance from the ideal point, in a random direction each
            weights = draw.dirichlet(np.ones(len(models)), size)[None]
            low = np.min([m.y_train_.min() for m in models]) if False else drawn.min(axis=(0, 1))
            span = np.ptp(drawn, axis=(0, 1))
            distance = weights * (drawn - low) / np.where(span > 0, span, 1.0)
            score = distance.max(axis=-1) + 0.05 * distance.sum(axis=-1)
        else:
            score = drawn[..., 0]
        taken: list[int] = []
        for j in range(min(size, len(candidates))):
            ranks = np.argsort(score[:, j], kind="stable")
            taken.append(next(int(i) for i in ranks if int(i) not in taken))
        return self._new(candidates[taken], size)

    @property
    def _top(self) -> float:
        return float(np.max(self.problem.xu))

    def _models(self, X: Ints, F: Array) -> list[Any]:
        """A fitted process for each objective."""
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

        few = self._few(F, TRAINED)
        inputs, models = features(X[few], self._top), []
        fitted = self._few(F[few], FITTED)
        length = np.full(inputs.shape[1], 2.0)
        for j in range(F.shape[1]):
            y = flattened(F[few, j]) if F.shape[1] == 1 else scaled(F[few, j])
            kernel = ConstantKernel(4.0, (1e-2, 1e3)) * Matern(length, (0.1, 30.0), nu=2.5) + WhiteKernel(
                1e-2, (NOISE, 1.0)
            )
            if len(self.theta) == F.shape[1]:
                kernel = kernel.clone_with_theta(self.theta[j])
            model = GaussianProcessRegressor(kernel, optimizer=short, alpha=1e-8, normalize_y=True).fit(inputs[fitted], y[fitted])
            whole = GaussianProcessRegressor(model.kernel_, optimizer=None, alpha=1e-8, normalize_y=True)
            models.append(whole.fit(inputs, y))
        self.theta = [m.kernel_.theta for m in models]
        return models

    def _few(self, F: Array, count: int) -> Ints:
        """Places of at most so many designs: half the best, half the others at random."""
        if len(F) <= count:
            return np.arange(len(F))
        rank = np.argsort(F[:, 0] if F.shape[1] == 1 else ((F - F.min(axis=0)) / np.ptp(F, axis=0)).sum(axis=1))
        rest = self.random_state.permutation(rank[count // 2 :])[: count - count // 2]
        return np.concatenate([rank[: count // 2], rest])

    def _candidates(self, X: Ints, F: Array, models: list[Any], size: int) -> Ints:
        """Designs never asked for that are good on the models: what moves come upon, from the best so far."""
        draw, several = self.random_state, F.shape[1] > 1
        pool = np.unique(self._parents(100), axis=0)
        value = predicted(models, features(pool, self._top))
        for _ in range(ROUNDS):
            parents = pool[draw.integers(len(pool), size=KIDS)]
            crossed = draw.random(KIDS) < 0.4
            kids = np.where(crossed[:, None], exchanged(parents, pool[draw.integers(len(pool), size=KIDS)], draw), parents)
            kids = np.where((draw.random(KIDS) < 0.8)[:, None] | ~crossed[:, None], shifted(kids, draw), kids)
            kids = kids[allowed(self.problem, kids)]
            if not len(kids):
                continue
            pool = np.concatenate([pool, kids])
            value = np.concatenate([value, predicted(models, features(kids, self._top))])
            pool, first = np.unique(pool, axis=0, return_index=True)
            value = value[first]
            best = best_of(value, CANDIDATES if several else CANDIDATES)
            pool, value = pool[best], value[best]
        drawn = RandomInside().do(self.problem, RANDOM, random_state=draw).get("X").astype(np.int64)
        pool = np.unique(np.concatenate([pool, drawn]), axis=0)
        return pool[[x.tobytes() not in self.asked for x in pool]]


def features(X: Ints, top: float) -> Array:
    """What a kernel sees of designs: heights and differences of neighbours."""
    h = X / top
    return np.concatenate([2 * h, 2 * np.diff(h, axis=1)], axis=1)


def scaled(f: Array) -> Array:
    """An objective, with its worst values drawn in: they are of no interest."""
    return np.minimum(f, np.median(f) + 2.0 * (np.median(f) - f.min()))


def flattened(f: Array) -> Array:
    """A single objective on a scale on which the best differ more than the others."""
    z = (f - f.min()) / max(float(np.median(f) - f.min()), 1e-300)
    return np.log(0.03 + z)


def short(objective: Any, theta: Array, bounds: Array) -> tuple[Array, float]:
    """A few steps of L-BFGS-B: the next generation goes on from there."""
    from scipy.optimize import minimize

    found = minimize(objective, theta, jac=True, bounds=bounds, method="L-BFGS-B", options={"maxiter": 15})
    return found.x, found.fun


def predicted(models: list[Any], inputs: Array) -> Array:
    """Means (designs, objectives)."""
    return np.stack([m.predict(inputs) for m in models], axis=1)


def best_of(value: Array, count: int) -> Ints:
    """Places of the best by means: fronts, one after the other, if there are several objectives."""
    if value.shape[1] == 1:
        return np.argsort(value[:, 0], kind="stable")[:count]
    from moocore import is_nondominated

    left, kept = np.arange(len(value)), []
    while len(left) and sum(map(len, kept)) < count:
        now = is_nondominated(value[left], keep_weakly=True)
        kept.append(left[now])
        left = left[~now]
    return np.concatenate(kept)[:count]


def sampled(model: Any, inputs: Array, count: int, draw: Any) -> Array:
    """Samples of a process at designs, (designs, count)."""
    mean, covariance = model.predict(inputs, return_cov=True)
    scale = np.trace(covariance) / len(covariance)
    factor = np.linalg.cholesky(covariance + 1e-8 * max(scale, 1e-12) * np.eye(len(covariance)))
    return mean[:, None] + factor @ draw.normal(size=(len(mean), count))
