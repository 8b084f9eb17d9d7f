"""A search by coarse walks, and by models of what finer ones change, for walks that are dear."""

from __future__ import annotations

import warnings
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.population import Population
from pymoo.core.sampling import Sampling
from pymoo.problems.static import StaticProblem

from footopt.design.fronts import nondominated
from footopt.design.solvers.memetic import Archive, Memetic, Moves, front, order, steps
from footopt.design.solvers.registry import DEAR

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

FIRST, EACH = 2000, 20  # coarse walks before the first dear one, and for each of them
LEAST = 8  # dear walks before there are models
FITTED, TRAINED = 200, 1000  # the newest of them, that a model's lengths are fitted to, and that it knows
STEPS = 15  # of L-BFGS-B a generation, from the lengths of the last one
CANDIDATES = 500  # designs that samples choose from
PARENTS = 20  # of one objective, for children where no candidate is left
NOISE = (1e-4, 1.0)  # of a model's variance: ruggedness that it cannot follow


class Surrogate(Moves):
    """The solver for quick walks at work on coarse ones, which models of the dear ones correct.

    `memetic`, or `archive` for several objectives, searches by walks as coarse as still rank designs. What a
    dear walk has beyond a coarse one, of each objective and limit, is modelled by a Gaussian process of
    scikit-learn's (Kennedy & O'Hagan, Biometrika 87, 2000) with a squared exponential kernel of three
    lengths: for heights, for differences of neighbours, and for what the coarse walk says. It sees whole
    numbers only, as Garrido-Merchan & Hernandez-Lobato (Neurocomputing 380, 2020) advise. Each design of a
    batch is the best of another sample of the processes, and the first the best by their means (Thompson
    1933; Kandasamy et al. 2018): explored is what they do not know. With several objectives each sample looks
    in another direction, by the augmented Chebyshev distance from its ideal point (Knowles 2006).
    """

    growth = DEAR

    def __init__(self, pop_size: int | None = None, **kwargs: Any) -> None:
        super().__init__(pop_size, sampling=_BestCoarsely(self), **kwargs)
        self.coarse: Any = None  # the search by coarse walks
        self.known = self.coarsely = Population.new()  # what dear walks know, and coarse ones
        self.models: list[Any] = []  # of each objective and limit
        self.middle, self.scale = np.zeros(1), np.ones(1)  # of coarse values

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        self.known = Population.merge(self.known, infills)
        self.front = front(Population.merge(self.front, infills))
        self.pop = self.known[order(self.known)[:PARENTS]] if self.problem.n_obj == 1 else self.front

    def _set_optimum(self) -> None:
        self.opt = self.pop[:1] if self.problem.n_obj == 1 else self.front

    def _propose(self, size: int) -> Ints:
        from sklearn.exceptions import ConvergenceWarning
        from threadpoolctl import threadpool_limits

        with threadpool_limits(1), warnings.catch_warnings():  # sums in another order would lead elsewhere
            warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound
            self._learn()
            self.search_coarsely(EACH * size)
            X = self.candidates()
            return self._new(X[self._chosen(X, size)] if self.models and len(X) else X, size)

    def search_coarsely(self, walks: int) -> None:
        """Go on, for so many walks, with the search by coarse walks and what models add to them."""
        found = Population.new()
        if self.coarse is None:
            self.coarse = Memetic() if self.problem.n_obj == 1 else Archive()
            seed = int(self.random_state.integers(2**31))
            self.coarse.setup(self.problem, termination=("n_gen", 10**9), seed=seed, verbose=False)
        else:  # all that it knows has other values now
            found, none = self.coarsely, Population.new()
            self.coarsely = self.coarse.pop = self.coarse.front = none
            self.coarse.champion, self.coarse.learnt, self.coarse.pop_size = None, [], EACH
            self.coarse.alone = []
        while True:
            if len(found):
                F, G = self._expected(found.get("X").astype(np.int64))
                self.coarse.evaluator.skip_already_evaluated = False
                self.coarse.evaluator.eval(StaticProblem(self.problem, F=F, G=G), found)
                self.coarse.tell(infills=found)
                self.coarsely = Population.merge(self.coarsely, found)
            if walks <= 0 or (found := self.coarse.ask()) is None:
                return
            walks -= len(found)

    def candidates(self) -> Ints:
        """Designs without a dear walk that promise most, (candidates, n)."""
        known, count = self.coarsely, CANDIDATES + len(self.asked)
        best = order(known)[:count] if self.problem.n_obj == 1 else leaders(known, count)
        return self._fresh(known[best].get("X").astype(np.int64))[:CANDIDATES]

    def _coarse(self, X: Ints) -> tuple[Array, Array, Array]:
        """What coarse walks say of designs: what is modelled (designs, models), and F and G."""
        F, G = self.problem.coarse(X)
        return np.concatenate([F, G[:, 2:]], axis=1), F, G  # the first constraints are no numbers to model

    def _expected(self, X: Ints) -> tuple[Array, Array]:
        """F and G (designs, ...) that dear walks should have."""
        values, F, G = self._coarse(X)
        if self.models:
            inputs = self._inputs(X, values)
            values = values + np.stack([model.predict(inputs) for model in self.models], axis=1)
        n_obj = F.shape[1]
        return values[:, :n_obj], np.concatenate([G[:, :2], values[:, n_obj:]], axis=1)

    def _inputs(self, X: Ints, values: Array) -> Array:
        """What a kernel sees: heights and slopes, 2 for the whole range of heights, and coarse values."""
        shape = 2.0 * steps(X) / float(np.max(self.problem.xu))
        return np.concatenate([shape, np.clip((values - self.middle) / self.scale, -3.0, 3.0)], axis=1)

    def _learn(self) -> None:
        """Fit a process to what dear walks have beyond coarse ones, of each objective and limit."""
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

        X, G = self.known.get("X").astype(np.int64), self.known.get("G").astype(float)
        values, _, coarse = self._coarse(X)
        good = np.flatnonzero((G[:, 0] <= 0.0) & (coarse[:, 0] <= 0.0))[-TRAINED:]  # both walked
        if len(good) < LEAST:
            return
        dear = np.concatenate([self.known.get("F").astype(float), G[:, 2:]], axis=1)
        X, values, beyond = X[good], values[good], (dear - values)[good]
        self.middle = np.median(values, axis=0)
        self.scale = np.maximum(values.std(axis=0), 1e-6 * np.abs(self.middle) + 1e-300)
        inputs, models = self._inputs(X, values), []
        sizes = (1, X.shape[1], X.shape[1] - 1, values.shape[1], 1)
        for j, y in enumerate(beyond.T):
            lengths = RBF(np.full(inputs.shape[1], 3.0), (0.3, 30.0))
            kernel = ConstantKernel(1.0, (1e-2, 1e2)) * lengths + WhiteKernel(1e-2, NOISE)
            if self.models:
                kernel = kernel.clone_with_theta(self.models[j].kernel_.theta)
            options = {"alpha": 1e-8, "normalize_y": True}
            few = GaussianProcessRegressor(kernel, optimizer=partial(fit, sizes=sizes), **options)
            few.fit(inputs[-FITTED:], y[-FITTED:])
            models.append(GaussianProcessRegressor(few.kernel_, optimizer=None, **options).fit(inputs, y))
        self.models = models

    def _chosen(self, X: Ints, size: int) -> Ints:
        """Places of the candidates (candidates, n) that samples of the processes choose, each another."""
        values, F, _ = self._coarse(X)
        inputs, n_obj = self._inputs(X, values), F.shape[1]
        drawn = np.stack([self._samples(model, inputs, size) for model in self.models], axis=-1)
        drawn += values[:, None]
        far = drawn[..., :n_obj] - drawn[..., :n_obj].min(axis=(0, 1))
        far /= np.maximum(far.max(axis=(0, 1)), 1e-300)
        weighted = far * self.random_state.dirichlet(np.ones(n_obj), size)
        broken = 2.0 * (drawn[..., n_obj:] > 0.0).sum(axis=-1)  # limits; no distance is as far
        score = weighted.max(axis=-1) + 0.05 * weighted.sum(axis=-1) + broken
        taken: dict[int, None] = {}
        for column in score.T:
            free = (int(i) for i in np.argsort(column, kind="stable") if int(i) not in taken)
            taken[next(free, 0)] = None
        return np.array([*taken], np.int64)

    def _samples(self, model: Any, inputs: Array, count: int) -> Array:
        """The mean of a process at designs, and samples of it, (designs, count)."""
        mean, covariance = model.predict(inputs, return_cov=True)
        jitter = 1e-8 * max(float(np.trace(covariance)) / len(covariance), 1e-300)
        factor = np.linalg.cholesky(covariance + jitter * np.eye(len(covariance)))
        normal = self.random_state.normal(size=(len(mean), count))
        normal[:, 0] = 0.0
        return np.asarray(mean[:, None] + factor @ normal)


class _BestCoarsely(Sampling):
    """The designs to begin with: the best of the search by coarse walks."""

    def __init__(self, of: Surrogate) -> None:
        super().__init__()
        self.of = of

    def _do(self, problem: Any, n_samples: int, **kwargs: Any) -> Ints:
        self.of.search_coarsely(FIRST)
        return self.of.candidates()[:n_samples]


def fit(objective: Any, theta: Array, bounds: Array, sizes: tuple[int, ...]) -> tuple[Array, float]:
    """scikit-learn's optimizer of a kernel: a few steps, with one number for each group of parameters."""
    from scipy.optimize import minimize

    tied = np.repeat(np.arange(len(sizes)), sizes)  # variance, lengths of heights, slopes, values, noise
    first = np.unique(tied, return_index=True)[1]

    def of_tied(few: Array) -> tuple[float, Array]:
        value, slope = objective(few[tied])
        return float(value), np.bincount(tied, slope).astype(float)

    given: dict[str, Any] = {"method": "L-BFGS-B", "options": {"maxiter": STEPS}}
    found = minimize(of_tied, theta[first], jac=True, bounds=bounds[first], **given)
    return found.x[tied], float(found.fun)


def leaders(pop: Any, count: int) -> Ints:
    """Places of some of a population: one front of the feasible after the other; if none is, the nearest."""
    F, left = pop.get("F"), np.flatnonzero(pop.get("CV")[:, 0] <= 0.0)
    kept = np.empty(0, np.int64)
    while len(left) and len(kept) < count:
        now = nondominated(F[left])
        kept, left = np.concatenate([kept, left[now]]), left[~now]
    return kept if len(kept) else order(pop)[:count]
