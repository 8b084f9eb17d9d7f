"""Optimisers of other libraries, and random soles, by whose walks footopt's own solvers are judged.

A walk is a different sole inside its box. One that comes up again, or that leaves its box, costs nobody
anything: the optimiser is told how far the sole leaves it, which is worse than any walk. Optimisers of real
numbers see every design rounded. Each begins anew where it ends, until `Done`.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import Any

import numpy as np

from footopt.design.problem import Array, FootProblem, Ints
from footopt.errors import MissingError, needed

ASKED = 20  # designs for each walk, at most: who only asks for what it knows would never end


class Done(Exception):
    """The search is over: it has its walks, or what there is to find."""


class Counted:
    """The J_W of a problem's soles as a number to minimise, which counts walks.

    Calling it with designs (designs, n), or one, gives a value for each: J_W inside the box, 1 where the walk
    fails, by how much a sole leaves its box, in its heights, outside. `Done` ends the search.

    Parameters
    ----------
    problem : FootProblem
        Whose soles walk.
    walks : int
        At most.
    enough : float
        A J_W that ends the search.

    Attributes
    ----------
    bests : list of float
        The least J_W after each walk.
    designs : list of (n,)
        The soles that walked, in their order.
    """

    def __init__(self, problem: FootProblem, walks: int, enough: float = -np.inf) -> None:
        self.problem, self.walks, self.enough = problem, walks, enough
        self.n, self.K = problem.space.n, problem.space.K
        self.bests: list[float] = []
        self.designs: list[Ints] = []
        self._known: dict[bytes, float] = {}
        self._asked = 0

    def __call__(self, x: Any) -> Array:
        k = np.clip(np.round(np.atleast_2d(np.asarray(x, float))), 1, self.K).astype(np.int64)
        keys = [design.tobytes() for design in k]
        if new := {key: i for i, key in enumerate(keys) if key not in self._known}:
            self._walk(k[list(new.values())], list(new))
        self._asked += len(k)
        if self._asked >= ASKED * self.walks:
            raise Done
        return np.array([self._known[key] for key in keys])

    def _walk(self, k: Ints, keys: list[bytes]) -> None:
        space = self.problem.space
        value = space.box_violation(k) / space.H
        inside = value <= space.box_tolerance
        if inside.any():
            j = self.problem.walk(k[inside])[0][:, self.problem.record.index("efficiency")]
            value[inside] = np.where(np.isfinite(j), j, 1.0)
        for i, key in enumerate(keys):
            self._known[key] = float(value[i])
            if inside[i]:
                self.designs.append(k[i])
                self.bests.append(min(float(value[i]), self.bests[-1] if self.bests else np.inf))
                if len(self.bests) >= self.walks or value[i] <= self.enough:
                    raise Done


Peer = Callable[[Counted, int], None]


def random_soles(value: Counted, seed: int) -> None:
    """Soles inside their box, drawn at random: what every optimiser has to beat."""
    while True:
        value(value.problem.space.random(100, seed, inside=True))
        seed += 1000


def cma_es(value: Counted, seed: int) -> None:
    """CMA-ES of `cma` on integers, with restarts of doubled population (Hansen; CMA with margin)."""
    cma = needed("cma", "cma", "benchmark")
    rng, size = np.random.default_rng(seed), 4 + int(3 * np.log(value.n))
    while True:
        options = {
            "bounds": [[1] * value.n, [value.K] * value.n],
            "integer_variables": list(range(value.n)),
            "popsize": size,
            "seed": int(rng.integers(1, 2**31)),
            "verbose": -9,
        }
        search = cma.CMAEvolutionStrategy(rng.uniform(1, value.K, value.n), value.K / 4, options)
        while not search.stop():
            x = search.ask()
            search.tell(x, value(x).tolist())
        size *= 2


def of_pymoo(path: str) -> Peer:
    """An algorithm of pymoo at its defaults."""

    def run(value: Counted, seed: int) -> None:
        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize

        class Rounded(Problem):  # type: ignore[misc]  # pymoo has no types
            def _evaluate(self, x: Any, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
                out["F"] = value(x)

        module, name = path.split(":")
        algorithm = getattr(import_module(f"pymoo.algorithms.soo.nonconvex.{module}"), name)
        while True:
            problem = Rounded(n_var=value.n, n_obj=1, xl=1, xu=value.K)
            minimize(problem, algorithm(), ("n_gen", 10**6), seed=seed)
            seed += 1000

    return run


def scipy_de(value: Counted, seed: int) -> None:
    """Differential evolution of SciPy over whole numbers, at its defaults."""
    from scipy.optimize import differential_evolution

    while True:
        bounds = [(1, value.K)] * value.n
        differential_evolution(
            lambda x: float(value(x)[0]), bounds, integrality=True, polish=False, maxiter=10**6, seed=seed
        )
        seed += 1000


def scipy_annealing(value: Counted, seed: int) -> None:
    """Dual annealing of SciPy, without its local search, which needs a gradient."""
    from scipy.optimize import dual_annealing

    while True:
        bounds = [(0.5, value.K + 0.5)] * value.n
        dual_annealing(lambda x: float(value(x)[0]), bounds, rng=seed, maxiter=10**6, no_local_search=True)
        seed += 1000


def of_optuna(name: str, **given: Any) -> Peer:
    """A sampler of `optuna`, 3.6 or newer: hydra-optuna-sweeper holds it back."""

    def run(value: Counted, seed: int) -> None:
        optuna = needed("optuna", "optuna", "benchmark")
        if tuple(map(int, optuna.__version__.split(".")[:2])) < (3, 6):
            raise MissingError('optuna is too old: pip install "footopt[benchmark]"')
        optuna.logging.set_verbosity(optuna.logging.ERROR)
        study = optuna.create_study(sampler=getattr(optuna.samplers, name)(seed=seed, **given))
        study.optimize(
            lambda trial: float(value([trial.suggest_int(f"k{i}", 1, value.K) for i in range(value.n)])[0]),
            n_trials=ASKED * value.walks,
        )

    return run


def of_nevergrad(name: str) -> Peer:
    """An optimiser of `nevergrad`."""

    def run(value: Counted, seed: int) -> None:
        ng = needed("nevergrad", "nevergrad", "benchmark")
        array = ng.p.Array(shape=(value.n,), lower=1, upper=value.K).set_integer_casting()
        array.random_state.seed(seed)
        optimiser = ng.optimizers.registry[name](array, budget=3 * value.walks)
        while True:
            asked = optimiser.ask()
            optimiser.tell(asked, float(value(asked.value)[0]))

    return run


def smac(value: Counted, seed: int) -> None:
    """SMAC3 of `smac`: a random forest and expected improvement, at the defaults for hyperparameters."""
    from tempfile import TemporaryDirectory

    library = needed("smac", "smac", "benchmark")
    space = needed("ConfigSpace", "smac", "benchmark").ConfigurationSpace(
        {f"k{i}": (1, value.K) for i in range(value.n)}
    )
    trial = import_module("smac.runhistory").TrialValue
    with TemporaryDirectory() as folder:
        most = ASKED * value.walks
        scenario = library.Scenario(
            space, deterministic=True, n_trials=most, seed=seed, output_directory=folder
        )
        facade = library.HyperparameterOptimizationFacade
        search = facade(scenario, lambda config, seed=0: 0.0, logging_level=50)
        while True:
            asked = search.ask()
            k = [asked.config[f"k{i}"] for i in range(value.n)]
            search.tell(asked, trial(cost=float(value(k)[0])))


def deap_ga(value: Counted, seed: int) -> None:
    """A (50 + 50) genetic algorithm of `deap`: two-point crossover, uniform integer mutation."""
    import random

    needed("deap", "deap", "benchmark")
    algorithms, base, creator, tools = (
        import_module(f"deap.{name}") for name in ("algorithms", "base", "creator", "tools")
    )
    if not hasattr(creator, "Sole"):
        creator.create("Fitness", base.Fitness, weights=(-1.0,))
        creator.create("Sole", list, fitness=creator.Fitness)
    random.seed(seed)
    box = base.Toolbox()
    box.register("height", random.randint, 1, value.K)
    box.register("sole", tools.initRepeat, creator.Sole, box.height, value.n)
    box.register("evaluate", value)
    box.register("map", lambda each, soles: [(float(f),) for f in each(soles)])  # all at once: quicker
    box.register("mate", tools.cxTwoPoint)
    box.register("mutate", tools.mutUniformInt, low=1, up=value.K, indpb=1.5 / value.n)
    box.register("select", tools.selTournament, tournsize=3)
    soles = tools.initRepeat(list, box.sole, 50)
    algorithms.eaMuPlusLambda(soles, box, 50, 50, 0.5, 0.5, 10**6, verbose=False)


#: By name, in `study=trust` and in benchmarks/other_optimisers.py. Those of SciPy, pymoo and `random` need no
#: further package.
PEERS: dict[str, Peer] = {
    "random": random_soles,
    "cma": cma_es,
    "pymoo_de": of_pymoo("de:DE"),
    "pymoo_es": of_pymoo("es:ES"),
    "pymoo_pso": of_pymoo("pso:PSO"),
    "pymoo_cmaes": of_pymoo("cmaes:CMAES"),
    "scipy_de": scipy_de,
    "scipy_annealing": scipy_annealing,
    "deap_ga": deap_ga,
    "nevergrad_one_plus_one": of_nevergrad("DiscreteOnePlusOne"),
    "nevergrad_de": of_nevergrad("TwoPointsDE"),
    "nevergrad_ngopt": of_nevergrad("NGOpt"),
    "optuna_cma": of_optuna("CmaEsSampler", with_margin=True),
    "optuna_tpe": of_optuna("TPESampler", multivariate=True),
    "smac": smac,
}


def asked_by(name: str, problem: FootProblem, walks: int, seed: int, enough: float = -np.inf) -> Counted:
    """A search of a peer: `designs` and `bests` of what is returned tell how it went.

    Raises
    ------
    MissingError
        Its library is not installed, or too old.
    """
    value = Counted(problem, walks, enough)
    with suppress(Done):
        PEERS[name](value, seed)
    return value
