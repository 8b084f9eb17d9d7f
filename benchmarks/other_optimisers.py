"""footopt's solvers against optimisers of other libraries, counted in walks, on scenes drawn at random.

`python benchmarks/other_optimisers.py` lets every optimiser search the least J_W on ten scenes, ten seeds
each, and writes a row for each search into `outputs/optimisers.csv`, from which it goes on where it was
stopped; the tables follow. It needs `pip install -e ".[benchmark]"`; what is not installed is left out and
named. A scene is drawn by its number: gait, walker, sand, effects, and how many waypoints and levels a sole
has. The solvers' constants were chosen on scenes 1, 4 and 8; those that are judged begin at 101.

A walk is a different sole inside its box. One that comes up again, or that leaves its box, costs nobody
anything: the others are told how far it leaves it, which is worse than any walk. Optimisers of real numbers
see every design rounded. A search ends when it has come within 0.1 % of the best sole known, or at its walks,
or when it has asked for 20 times as many designs. With --quick: one scene, one seed, 100 walks.
"""

from __future__ import annotations

import csv
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from measure import arguments
from numpy.typing import NDArray

import footopt as fo
from footopt.design import truth
from footopt.gait.fourier import Fourier

FIRST_SCENE, FIRST, FEW, MANY = 101, 300, 1_000, 10_000
WITHIN = 1e-3  # of the best known, relative
ASKED = 20  # designs for each walk, at most
EFFECTS: dict[str, tuple[Any, ...]] = {
    "none": (),
    "leading edge": (fo.LeadingEdge(),),
    "inertia": (fo.Inertia(),),
}
#: As coarse as walks can be whose J_W still ranks soles as finer ones do: the others cost twice as much.
COARSE = fo.Accuracy("sdirk2", 0.02, 32, 1e-4, "coarse")

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


def draw(number: int, objective: str = "efficiency") -> fo.FootProblem:
    """The scene and space of a number, in which most random soles can walk."""
    for attempt in range(20):
        rng = np.random.default_rng([number, attempt])
        gait = fo.Gait.human(
            period=float(rng.uniform(0.95, 1.5)), pitch=str(rng.choice(["shank", "measured"]))
        )
        thigh, knee, foot = (varied(joint, rng) for joint in (gait.thigh, gait.knee, gait.foot))
        gait = replace(gait, thigh=thigh, knee=knee, foot=foot, name=f"drawn {number}")
        leg = rng.uniform(0.8, 1.2)
        mass = float(np.exp(rng.uniform(np.log(30), np.log(100))))
        zeta = float(np.exp(rng.uniform(np.log(0.2), np.log(12))))
        effects = EFFECTS[str(rng.choice(list(EFFECTS), p=[0.5, 0.25, 0.25]))]
        space = fo.Waypoints(n=int(rng.choice([9, 11, 13])), K=int(rng.choice([8, 10, 14])))
        walker = fo.Walker(mass=mass, l1=0.47 * leg, l2=0.45 * leg)
        scene = fo.Scene(sand=fo.Sand(zeta=zeta), gait=gait, walker=walker, effects=effects)
        problem = Remembering(scene, objective, space, COARSE, 1)
        walked = problem.evaluate(space.random(64, seed=1, inside=True))
        if (walked.reasons == "").mean() > 0.5:
            return problem
    raise RuntimeError(f"no scene {number}")


def varied(joint: Fourier | None, rng: np.random.Generator) -> Fourier | None:
    """A joint's angle with every coefficient up to 15 % off."""
    if joint is None:
        return None
    a, b = (tuple((np.array(c) * rng.uniform(0.85, 1.15, len(c))).tolist()) for c in (joint.a, joint.b))
    return joint._replace(a=a, b=b)


class Remembering(fo.FootProblem):
    """A `FootProblem` that walks no design twice, over all searches: it saves hours."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.known: dict[bytes, tuple[Floats, np.str_]] = {}

    def walk(self, k: Ints) -> tuple[Floats, NDArray[np.str_]]:
        keys = [heights.tobytes() for heights in k.astype(np.int8)]
        if new := {key: i for i, key in enumerate(keys) if key not in self.known}:
            values, reasons = super().walk(k[list(new.values())])
            self.known.update(zip(new, zip(values, reasons, strict=True), strict=True))
        found = [self.known[key] for key in keys]
        return np.array([v for v, _ in found]), np.array([r for _, r in found], np.str_)


class Done(Exception):
    """The search is over: it has its walks, or what there is to find."""


class Counted:
    """A problem as one number to minimise; it counts walks, and keeps the best value after each.

    Calling it with designs (designs, n), or one, gives a value for each: J_W inside the box, how far the sole
    leaves it outside. `Done` ends the search.
    """

    def __init__(self, problem: fo.FootProblem, walks: int, best: float) -> None:
        self.problem, self.walks = problem, walks
        self.n, self.K = problem.space.n, problem.space.K
        self.enough, self.asked = best * (1 - WITHIN), 0
        self.seen: set[bytes] = set()
        self.bests: list[float] = []

    def __call__(self, x: Any) -> Floats:
        k = np.clip(np.round(np.atleast_2d(np.asarray(x, float))), 1, self.K).astype(np.int64)
        violation = self.problem.space.box_violation(k) / self.problem.space.H
        inside = violation <= self.problem.space.box_tolerance
        out = violation.copy()
        if inside.any():
            j = self.problem.walk(k[inside])[0][:, self.problem.record.index("efficiency")]
            out[inside] = np.where(np.isfinite(j), j, 1.0)
        for design, value in zip(k[inside], out[inside], strict=True):
            if (key := design.tobytes()) not in self.seen:
                self.seen.add(key)
                self.bests.append(min(value, self.bests[-1] if self.bests else np.inf))
                if len(self.seen) >= self.walks or value <= self.enough:
                    raise Done
        self.asked += len(k)
        if self.asked >= ASKED * self.walks:
            raise Done
        return out


def of_footopt(name: str, **given: Any) -> Callable[[Counted, int], None]:
    """A solver of footopt by name."""

    def run(value: Counted, seed: int) -> None:
        def watch(generation: Any) -> bool:
            return bool(generation.best <= value.enough)

        found = fo.search(value.problem, name, watch, walks=value.walks, seed=seed, **given)
        inside = found.reasons != "box"
        j = np.where(found.feasible, found.column("efficiency"), np.inf)[inside]
        value.bests = np.minimum.accumulate(j).tolist()[: value.walks]

    return run


def of_pymoo(path: str, **given: Any) -> Callable[[Counted, int], None]:
    """An algorithm of pymoo at its defaults, or as given, over real numbers that are rounded."""

    def run(value: Counted, seed: int) -> None:
        from importlib import import_module

        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize

        class Rounded(Problem):
            def _evaluate(self, x: Any, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
                out["F"] = value(x)

        module, name = path.split(":")
        algorithm = getattr(import_module(f"pymoo.algorithms.soo.nonconvex.{module}"), name)
        while True:  # it begins anew where it ends
            minimize(
                Rounded(n_var=value.n, n_obj=1, xl=1, xu=value.K),
                algorithm(**given),
                ("n_gen", 10**6),
                seed=seed,
            )
            seed += 1000

    return run


def random_soles(value: Counted, seed: int) -> None:
    """Soles inside their box, drawn at random: what every optimiser has to beat."""
    while True:
        value(value.problem.space.random(100, seed, inside=True))
        seed += 1000


def cma_es(value: Counted, seed: int) -> None:
    """CMA-ES of `cma` on integers, with restarts of doubled population (Hansen; CMA with margin)."""
    import cma

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


def of_optuna(name: str, **given: Any) -> Callable[[Counted, int], None]:
    """A sampler of `optuna`."""

    def run(value: Counted, seed: int) -> None:
        import optuna

        if tuple(map(int, optuna.__version__.split(".")[:2])) < (3, 6):  # hydra-optuna-sweeper holds it back
            raise ImportError('optuna is too old: pip install "footopt[benchmark]"')
        optuna.logging.set_verbosity(optuna.logging.ERROR)
        study = optuna.create_study(sampler=getattr(optuna.samplers, name)(seed=seed, **given))
        study.optimize(
            lambda trial: float(value([trial.suggest_int(f"k{i}", 1, value.K) for i in range(value.n)])[0]),
            n_trials=3 * value.walks,
        )

    return run


def of_nevergrad(name: str) -> Callable[[Counted, int], None]:
    """An optimiser of `nevergrad`."""

    def run(value: Counted, seed: int) -> None:
        import nevergrad as ng

        array = ng.p.Array(shape=(value.n,), lower=1, upper=value.K).set_integer_casting()
        array.random_state.seed(seed)
        optimiser = ng.optimizers.registry[name](array, budget=3 * value.walks)
        while True:
            asked = optimiser.ask()
            optimiser.tell(asked, float(value(asked.value)[0]))

    return run


def smac(value: Counted, seed: int) -> None:
    """SMAC3 of `smac`: a random forest and expected improvement, at the defaults for hyperparameters."""
    from tempfile import mkdtemp

    from ConfigSpace import ConfigurationSpace
    from smac import HyperparameterOptimizationFacade, Scenario
    from smac.runhistory import TrialValue

    space = ConfigurationSpace({f"k{i}": (1, value.K) for i in range(value.n)})
    scenario = Scenario(space, deterministic=True, n_trials=3 * value.walks, seed=seed,
                        output_directory=Path(mkdtemp()))  # fmt: skip
    search = HyperparameterOptimizationFacade(scenario, lambda config, seed=0: 0.0, logging_level=50)
    while True:
        asked = search.ask()
        k = [asked.config[f"k{i}"] for i in range(value.n)]
        search.tell(asked, TrialValue(cost=float(value(k)[0])))


def scipy_de(value: Counted, seed: int) -> None:
    """SciPy's differential evolution of integers, as `study=trust` has it."""
    value(truth.scipy_de(value.problem, 3 * value.walks, seed))


def dual_annealing(value: Counted, seed: int) -> None:
    """SciPy's dual annealing, without its local search, which needs a gradient."""
    from scipy.optimize import dual_annealing

    while True:
        bounds = [(0.5, value.K + 0.5)] * value.n
        dual_annealing(lambda x: float(value(x)[0]), bounds, rng=seed, maxiter=10**6, no_local_search=True)
        seed += 1000


def deap_ga(value: Counted, seed: int) -> None:
    """A (50 + 50) genetic algorithm of `deap`: two-point crossover, uniform integer mutation."""
    import random

    from deap import algorithms, base, creator, tools

    if not hasattr(creator, "Sole"):
        creator.create("Fitness", base.Fitness, weights=(-1.0,))
        creator.create("Sole", list, fitness=creator.Fitness)
    random.seed(seed)
    box = base.Toolbox()
    box.register("height", random.randint, 1, value.K)
    box.register("sole", tools.initRepeat, creator.Sole, box.height, value.n)
    box.register("evaluate", lambda k: (float(value(k)[0]),))
    box.register("mate", tools.cxTwoPoint)
    box.register("mutate", tools.mutUniformInt, low=1, up=value.K, indpb=1.5 / value.n)
    box.register("select", tools.selTournament, tournsize=3)
    soles = tools.initRepeat(list, box.sole, 50)
    algorithms.eaMuPlusLambda(soles, box, 50, 50, 0.5, 0.5, 10**6, verbose=False)


#: Optimisers, and at how many walks each is judged: those that need seconds for a design, or that come to
#: nothing, at the fewer only.
RUNS: dict[str, tuple[Callable[[Counted, int], None], int]] = {
    "footopt memetic (default)": (of_footopt("memetic"), MANY),
    "footopt surrogate": (of_footopt("surrogate"), FEW),
    "random": (random_soles, FEW),
    "cma: CMA-ES, integer, restarts": (cma_es, MANY),
    "pymoo: GA, integer (footopt ga)": (of_footopt("ga"), MANY),
    "deap: GA": (deap_ga, FEW),
    "pymoo: DE": (of_pymoo("de:DE"), FEW),
    "pymoo: ES": (of_pymoo("es:ES"), FEW),
    "pymoo: PSO": (of_pymoo("pso:PSO"), MANY),
    "pymoo: CMA-ES": (of_pymoo("cmaes:CMAES"), MANY),
    "scipy: differential evolution": (scipy_de, FEW),
    "scipy: dual annealing": (dual_annealing, FEW),
    "nevergrad: DiscreteOnePlusOne": (of_nevergrad("DiscreteOnePlusOne"), FEW),
    "nevergrad: two-points DE": (of_nevergrad("TwoPointsDE"), FEW),
    "nevergrad: NGOpt": (of_nevergrad("NGOpt"), FEW),
    "optuna: CMA-ES with margin": (of_optuna("CmaEsSampler", with_margin=True), FEW),
    "optuna: TPE": (of_optuna("TPESampler", multivariate=True), FEW),
    "smac: SMAC3": (smac, FIRST),
}


def best_known(problem: Remembering) -> float:
    """The best J_W of long searches, by which searches are ended; tables go by the best of all of them."""
    for seed in (901, 902):
        fo.search(problem, "memetic", walks=MANY, seed=seed)
    return best_of(problem)


def best_of(problem: Remembering) -> float:
    """The best J_W of all walks inside the box so far."""
    k = np.array([np.frombuffer(key, np.int8) for key in problem.known], np.int64)
    j = np.array([v[problem.record.index("efficiency")] for v, _ in problem.known.values()])
    return float(np.nanmin(np.where(problem.space.inside(k), j, np.nan)))


def improvements(bests: list[float]) -> str:
    """Each walk that was better than all before it, with its J_W, as text."""
    new = np.flatnonzero(np.diff(bests, prepend=np.inf) < 0.0)
    return " ".join(f"{i + 1}:{float(bests[i])!r}" for i in new.tolist())


def hit(improved: str, best: float, walks: int) -> int | None:
    """After how many walks a search came within `WITHIN` of the best; None if it did not."""
    for step in improved.split():
        at, value = step.split(":")
        if float(value) <= best * (1 - WITHIN):
            return int(at) if int(at) <= walks else None
    return None


def regret(improved: str, best: float, walks: int) -> float:
    """What a search lacked of the best after so many walks, relative."""
    steps = [step.split(":") for step in improved.split()]
    return 1.0 - min(float(value) for at, value in steps if int(at) <= walks) / best


def expected(hits: Iterable[int | None], walks: int) -> float:
    """Expected walks to a hit of searches begun anew after so many walks; of no hit as of half a one."""
    hits = list(hits)
    found = [h for h in hits if h is not None]
    return (sum(found) + walks * (len(hits) - len(found))) / max(len(found), 0.5)


def geometric(hits: list[list[int | None]], walks: int) -> float:
    """Geometric mean over the scenes of the expected walks to a hit."""
    return float(np.exp(np.mean([np.log(expected(of_scene, walks)) for of_scene in hits])))


def spread(hits: list[list[int | None]], walks: int) -> tuple[float, float]:
    """90 % of what `geometric` would be with other seeds: searches of each scene drawn again, 400 times."""
    draw = np.random.default_rng(1)
    again = [
        geometric([[h[i] for i in draw.integers(len(h), size=len(h))] for h in hits], walks)
        for _ in range(400)
    ]
    low, high = np.quantile(again, (0.05, 0.95))
    return float(low), float(high)


def best_by_scene(rows: list[dict[str, str]]) -> dict[int, float]:
    """The best J_W of every scene that is known from all searches."""
    best: dict[int, float] = {}
    for row in rows:
        found = float(row["improved"].split()[-1].split(":")[1])
        best[int(row["scene"])] = min(best.get(int(row["scene"]), 0.0), float(row["best"]), found)
    return best


def tables(rows: list[dict[str, str]], best: dict[int, float], budgets: tuple[int, ...]) -> None:
    """Print what all rows come to at each number of walks.

    An optimiser is in a table if it has been given so many walks from as many seeds in every scene as the
    others: what is assumed of a scene in which no search hits depends on how many there were.
    """
    pairs = {(row["scene"], row["seed"]) for row in rows}
    for walks in budgets:
        print(f"\nUp to {walks:,} walks, {len(best)} scenes:\n")
        print("| optimiser | expected walks (90 %) | scenes hit | searches that hit | median regret |")
        print("| --- | --- | --- | --- | --- |")
        lines = []
        counts = Counter(row["optimiser"] for row in rows if int(row["walks"]) >= walks)
        for name in (name for name, count in counts.items() if count == len(pairs)):
            hits, lacks = [], []
            for scene in sorted(best):
                own = [r for r in rows if (int(r["scene"]), r["optimiser"]) == (scene, name)]
                hits.append([hit(r["improved"], best[scene], walks) for r in own])
                lacks.append(float(np.median([regret(r["improved"], best[scene], walks) for r in own])))
            every = [h is not None for of_scene in hits for h in of_scene]
            scenes = f"{sum(any(h is not None for h in of_scene) for of_scene in hits)} of {len(hits)}"
            low, high = spread(hits, walks)
            ahead = f"{geometric(hits, walks):,.0f} ({low:,.0f} to {high:,.0f})"
            lines.append((geometric(hits, walks), f"| {name} | {ahead} | {scenes} | {np.mean(every):.0%} of "
                          f"{len(every)} | {np.mean(lacks):.2%} |"))  # fmt: skip
        print(*(line for _, line in sorted(lines)), sep="\n")


def main() -> None:
    """Search, and print the tables."""
    parser = arguments(__doc__)
    parser.add_argument("--scenes", type=int, nargs="*", default=range(FIRST_SCENE, FIRST_SCENE + 10))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--walks", type=int, default=MANY, help="of a search, at most")
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no search is begun")
    parser.add_argument("--only", nargs="*", default=[""], help="optimisers with one of these words")
    parser.add_argument("--out", type=Path, default=Path("outputs/optimisers.csv"))
    given = parser.parse_args()
    warnings.simplefilter("ignore")  # the other libraries' own
    scenes, seeds = ([FIRST_SCENE], 1) if given.quick else (given.scenes, given.seeds)
    given.walks = 100 if given.quick else given.walks
    rows: list[dict[str, str]] = []
    if not given.quick and given.out.is_file():
        with open(given.out, newline="") as file:
            rows = list(csv.DictReader(file))
    known = best_by_scene(rows)
    # a search that ended for a best that has since been beaten is done again
    rows = [r for r in rows if float(r["best"]) <= known[int(r["scene"])] * (1 - WITHIN)]
    have = {(int(r["scene"]), r["optimiser"], int(r["seed"])): int(r["walks"]) for r in rows}
    missing: set[str] = set()
    end = time.time() + 60.0 * given.minutes
    problems: dict[int, tuple[Remembering, float]] = {}
    for seed in range(1, seeds + 1):  # all scenes have a few searches before one has all
        for scene in scenes:
            if time.time() > end:
                break
            if scene not in problems:
                problem = draw(scene)
                best = -1e9 if given.quick else known.get(scene) or best_known(problem)
                problems[scene] = problem, best
            problem, best = problems[scene]
            for name, (run, most) in RUNS.items():
                asked, walks = any(word in name for word in given.only), min(most, given.walks)
                done = have.get((scene, name, seed), 0) >= walks or name in missing
                if not asked or done or time.time() > end:
                    continue
                value = Counted(problem, walks, best)
                started = time.perf_counter()
                try:
                    with suppress(Done):
                        run(value, seed)
                except ImportError as error:
                    missing.add(name)
                    print(f"{name} is left out: {error}. pip install -e '.[benchmark]' brings it.")
                    continue
                row = {
                    "scene": scene, "optimiser": name, "seed": seed, "walks": value.walks, "best": best,
                    "seconds": round(time.perf_counter() - started, 2), "improved": improvements(value.bests),
                }  # fmt: skip
                rows.append({key: str(v) for key, v in row.items()})
                if not given.quick:
                    new = not given.out.is_file()
                    given.out.parent.mkdir(parents=True, exist_ok=True)
                    with open(given.out, "a", newline="") as file:
                        writer = csv.DictWriter(file, row)
                        if new:
                            writer.writeheader()
                        writer.writerow(row)
    last = {
        (int(r["scene"]), r["optimiser"], int(r["seed"])): r for r in rows
    }  # a search that was done again
    asked = [row for (scene, _, seed), row in last.items() if scene in scenes and seed <= seeds]
    best_known_now = {scene: value for scene, value in best_by_scene(rows).items() if scene in scenes}
    tables(asked, best_known_now, tuple(sorted({min(w, given.walks) for w in (FIRST, FEW, MANY)})))
    sys.stdout.flush()


if __name__ == "__main__":
    main()
