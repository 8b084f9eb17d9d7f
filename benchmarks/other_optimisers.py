"""footopt's solvers against optimisers of other libraries, at the same number of evaluations.

`python benchmarks/other_optimisers.py` prints the table (17 minutes of processor time); it needs
`pip install -e ".[benchmark]"`. An evaluation is a design asked for, also one that came up before. What
lies outside its box is worse than anything inside, by how far it is outside. The optimisers of real
numbers see every design rounded. With --quick: one seed, 300 evaluations, and without the libraries
that are not installed.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable

import numpy as np
from measure import SANDS, arguments
from numpy.typing import NDArray

import footopt as fo

BUDGET, QUICK_BUDGET = 10_000, 300
LIBRARIES = ("cma", "nevergrad", "pygmo")
WITHIN = 1e-3  # of the best known, relative

#: The best designs known: see the function `best_known`.
BEST_KNOWN = {
    "soft": (1, 3, 5, 7, 8, 9, 10, 10, 10, 10, 9),
    "regular": (1, 2, 3, 4, 5, 7, 9, 10, 10, 9, 7),
    "hard": (2, 6, 6, 2, 1, 1, 1, 1, 3, 4, 1),
}

Ints = NDArray[np.int64]
Run = Callable[[fo.FootProblem, int, int], float]  # problem, seed, evaluations: the best value found


class Remembering(fo.FootProblem):
    """A `FootProblem` that walks no design twice, over all runs of all optimisers: it saves hours."""

    def __init__(self, *args: object, **kwargs: object) -> None:
        super().__init__(*args, **kwargs)
        self.known: dict[bytes, tuple[NDArray[np.float64], np.str_]] = {}

    def walk(self, k: Ints) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
        keys = [heights.tobytes() for heights in k]
        if new := {key: i for i, key in enumerate(keys) if key not in self.known}:
            values, reasons = super().walk(k[list(new.values())])
            self.known.update(zip(new, zip(values, reasons, strict=True), strict=True))
        found = [self.known[key] for key in keys]
        return np.array([v for v, _ in found]), np.array([r for _, r in found], np.str_)


class Counted:
    """A problem as one number to minimise: J_W inside, a penalty outside; and the best so far."""

    def __init__(self, problem: fo.FootProblem, budget: int) -> None:
        self.problem, self.budget, self.asked, self.best = problem, budget, 0, np.inf

    def __call__(self, x: object) -> NDArray[np.float64]:
        k = np.clip(np.round(np.atleast_2d(np.asarray(x, float))), 1, self.problem.space.K).astype(np.int64)
        k = k[: self.budget - self.asked]
        found = self.problem.evaluate(k)
        outside = np.maximum(self.problem.constraints(*found), 0.0).sum(axis=1)
        values = np.where(outside > 0.0, outside, self.problem.minimised(found.values)[:, 0])  # J_W < 0
        self.asked += len(k)
        self.best = min(self.best, values.min())
        return values


def of_footopt(name: str) -> Run:
    """A solver of footopt by name."""

    def run(problem: fo.FootProblem, seed: int, budget: int) -> float:
        result = fo.search(problem, name, pop_size=100, n_gen=budget // 100, seed=seed)
        return float(result.column("efficiency")[result.best])

    return run


def cma_es(problem: fo.FootProblem, seed: int, budget: int) -> float:
    """CMA-ES of `cma` on integers, with restarts of doubled population (Hansen; CMA with margin)."""
    import cma

    value, n, high = Counted(problem, budget), problem.space.n, problem.space.K
    rng = np.random.default_rng(seed)
    size = 4 + int(3 * np.log(n))
    while value.asked < budget:
        options = {
            "bounds": [[1] * n, [high] * n],
            "integer_variables": list(range(n)),
            "popsize": size,
            "seed": int(rng.integers(1, 2**31)),
            "verbose": -9,
        }
        search = cma.CMAEvolutionStrategy(rng.uniform(1, high, n), high / 4, options)
        while not search.stop() and value.asked < budget:
            x = search.ask()
            if value.asked + len(x) > budget:
                value(x)
                break
            search.tell(x, value(x).tolist())
        size *= 2
    return float(value.best)


def nevergrad_discrete(problem: fo.FootProblem, seed: int, budget: int) -> float:
    """The discrete (1+1) evolution strategy of `nevergrad`, 20 designs at a time."""
    import nevergrad as ng

    value = Counted(problem, budget)
    parameters = ng.p.Array(shape=(problem.space.n,), lower=1, upper=problem.space.K)
    parameters.set_integer_casting()
    parameters.random_state.seed(seed)
    optimiser = ng.optimizers.registry["DiscreteOnePlusOne"](parameters, budget=budget, num_workers=20)
    while value.asked < budget:
        asked = [optimiser.ask() for _ in range(min(20, budget - value.asked))]
        for candidate, v in zip(asked, value([c.value for c in asked]), strict=True):
            optimiser.tell(candidate, float(v))
    return float(value.best)


def pygmo_ga(problem: fo.FootProblem, seed: int, budget: int) -> float:
    """The GA of `pygmo` (sga) with the operators for integers that it recommends, 100 a generation."""
    import pygmo

    value, n, high = Counted(problem, budget), problem.space.n, problem.space.K

    class Walk:
        def fitness(self, x: NDArray[np.float64]) -> list[float]:
            return [float(value(x)[0])]

        def batch_fitness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
            return value(x.reshape(-1, n))

        def get_bounds(self) -> tuple[list[int], list[int]]:
            return [1] * n, [high] * n

        def get_nix(self) -> int:
            return n

    population = pygmo.population(pygmo.problem(Walk()), size=100, seed=seed, b=pygmo.bfe())
    algorithm = pygmo.sga(gen=budget // 100 - 1, cr=0.9, m=1 / n, crossover="sbx", eta_c=3, seed=seed)
    pygmo.algorithm(algorithm).evolve(population)
    return float(value.best)


RUNS: dict[str, Run] = {
    "footopt memetic (default)": of_footopt("memetic"),
    "footopt ga": of_footopt("ga"),
    "footopt de": of_footopt("de"),
    "cma: CMA-ES, integer, restarts": cma_es,
    "nevergrad: DiscreteOnePlusOne": nevergrad_discrete,
    "pygmo: sga": pygmo_ga,
}


def best_known(problem: fo.FootProblem) -> tuple[tuple[int, ...], float]:
    """The best of long runs (50,000 evaluations, three seeds, two solvers), and of all that is near it.

    Near: any two runs of neighbouring waypoints shifted by one level each, as long as that improves.
    """
    runs = [
        fo.search(problem, name, pop_size=200, n_gen=250, seed=seed)
        for name in ("memetic", "ga")
        for seed in (1, 2, 3)
    ]
    best = min(runs, key=lambda r: r.column("efficiency")[r.best])
    k, value = best.k[best.best], float(best.column("efficiency")[best.best])
    first, last = np.triu_indices(problem.space.n)
    at = np.arange(problem.space.n)
    run = ((first[:, None] <= at) & (at <= last[:, None])).astype(np.int64)
    shifts = np.concatenate([run, -run, np.zeros((1, problem.space.n), np.int64)])
    pairs = np.unique((shifts[:, None] + shifts).reshape(-1, problem.space.n), axis=0)
    while True:
        near = k + pairs
        near = near[((near >= 1) & (near <= problem.space.K)).all(axis=1)]
        found = problem.evaluate(near)
        inside = (problem.constraints(*found) <= 0.0).all(axis=1)
        j = np.where(inside, problem.minimised(found.values)[:, 0], np.inf)
        if j.min() >= value:
            return tuple(map(int, k)), value
        k, value = near[j.argmin()], float(j.min())


def main() -> None:
    """Print the table, or with --best-known the best designs known."""
    parser = arguments(__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--best-known", action="store_true", help="find the best known designs again")
    given = parser.parse_args()
    seeds, budget = (1, QUICK_BUDGET) if given.quick else (given.seeds, BUDGET)
    if given.best_known:
        for sand in SANDS:
            print(sand, *best_known(Remembering(fo.Scene(sand=fo.Sand.named(sand)))), flush=True)
        return
    missing = []
    for name in LIBRARIES:
        try:
            __import__(name)
        except ImportError:
            missing.append(name)
    if missing:
        said = f"{', '.join(missing)} is not installed: pip install -e '.[benchmark]' brings it."
        if not given.quick:
            sys.exit(said)
        print(f"{said}\n")
    runs = {name: run for name, run in RUNS.items() if name.partition(":")[0] not in missing}
    warnings.simplefilter("ignore")  # the other libraries' own
    print("| optimiser | sand | within 0.1 % of the best known | median regret | largest | seconds a run |")
    print("| --- | --- | --- | --- | --- | --- |")
    for sand in SANDS:
        problem = Remembering(fo.Scene(sand=fo.Sand.named(sand)))
        best = float(problem.minimised(problem.evaluate([BEST_KNOWN[sand]]).values)[0, 0])
        for name, run in runs.items():
            started = time.perf_counter()
            found = np.array([run(problem, seed, budget) for seed in range(1, seeds + 1)])
            seconds = (time.perf_counter() - started) / seeds
            regret = 1.0 - found / best  # negative: better than the best known
            print(
                f"| {name} | {sand} | {np.mean(regret <= WITHIN):.0%} | {np.median(regret):.3%} | "
                f"{regret.max():.3%} | {seconds:.1f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
