"""footopt's solvers against optimisers of other libraries, counted in walks, on scenes drawn at random.

`python benchmarks/solvers.py` lets every optimiser search the least J_W in ten scenes, ten seeds each, and
writes a row for each search into `outputs/optimisers.csv`, from which it goes on where it was stopped; the
tables follow. `pip install -e ".[benchmark]"` installs `cma`; without it that optimiser is left out. A scene
is drawn by its number: gait, walker, sand, effects, and how many waypoints and levels a sole has. The
solvers were tuned on scenes 1, 4 and 8; those that are judged begin at 101. Scenes from 601 on are rugged:
zeta from 10 to 100, slopes, the leading edge and inertia (`--scenes 601 602 ...`). 701 to 703 are a biped in
MuJoCo on soft, regular and hard sand, whose walks are expensive (`--walks 1000`).

A walk is a different sole inside its box. One that comes up again, or that leaves its box, costs nothing: the
optimiser is told how far the sole leaves it, which is worse than any walk. Optimisers of real numbers see
every design rounded. A search ends at its walks, or when it has asked for 20 times as many designs. With
--quick: one scene, one seed, 100 walks.
"""

from __future__ import annotations

import csv
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from measure import arguments

import footopt as fo
from footopt.design import SOLVERS
from footopt.design.solvers.moves import shifts
from footopt.errors import MissingError, needed
from footopt.gait import Fourier

FIRST_SCENE, RUGGED, BIPEDS, MANY = 101, 601, (701, 702, 703), 10_000
BUDGETS = (100, 300, 1_000, MANY)
WITHIN = 1e-3  # of the best known, relative
ASKED = 20  # designs for each walk, at most: an optimiser that only asks for known ones would never end
COARSELY = fo.Accuracy(
    dt=0.02, plates=32
)  # ranks of J_W are nearly those of standard, at a tenth of the time
COLUMNS = ("scene", "optimiser", "seed", "walks", "seconds", "improved")
EFFECTS: dict[str, tuple[Any, ...]] = {
    "none": (),
    "leading edge": (fo.LeadingEdge(),),
    "inertia": (fo.Inertia(),),
}


class Done(Exception):
    """The search is over: it has its walks."""


class Counted:
    """The J_W of a problem's soles as a number to minimise, which counts walks.

    Calling it with designs (designs, n), or one, gives a value for each: J_W inside the box, 1 where the walk
    fails, by how much a sole leaves its box, in its heights, outside. `Done` ends the search. `bests` is the
    least J_W after each walk.
    """

    def __init__(self, problem: fo.FootProblem, walks: int) -> None:
        self.problem, self.walks = problem, walks
        self.n, self.K = problem.space.n, problem.space.K
        self.bests: list[float] = []
        self._known: dict[bytes, float] = {}
        self._asked = 0

    def __call__(self, x: Any) -> Any:
        k = np.clip(np.round(np.atleast_2d(np.asarray(x, float))), 1, self.K).astype(np.int64)
        keys = [design.tobytes() for design in k]
        if new := {key: i for i, key in enumerate(keys) if key not in self._known}:
            self._walk(k[list(new.values())], list(new))
        self._asked += len(k)
        if self._asked >= ASKED * self.walks:
            raise Done
        return np.array([self._known[key] for key in keys])

    def _walk(self, k: Any, keys: list[bytes]) -> None:
        space = self.problem.space
        value = space.box_violation(k) / space.H
        inside = value <= space.box_tolerance
        if inside.any():
            j = self.problem.walk(k[inside])[0][:, self.problem.record.index("efficiency")]
            value[inside] = np.where(np.isfinite(j), j, 1.0)
        for i, key in enumerate(keys):
            self._known[key] = float(value[i])
            if inside[i]:
                self.bests.append(min(float(value[i]), self.bests[-1] if self.bests else np.inf))
                if len(self.bests) >= self.walks:
                    raise Done


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


def of_pymoo(path: str) -> Callable[[Counted, int], None]:
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


def local_search(value: Counted, seed: int) -> None:
    """Iterated local search by shifts of runs of waypoints: first improvement, kicks of three shifts."""
    rng, moves = np.random.default_rng(seed), shifts(value.n)
    k = value.problem.space.random(1, seed, inside=True)[0]
    least, home, best = float(value(k)[0]), k, np.inf
    while True:
        for move in rng.permutation(moves):
            if ((k + move >= 1) & (k + move <= value.K)).all() and (f := float(value(k + move)[0])) < least:
                k, least = k + move, f
                break
        else:
            if least <= best:
                home, best = k, least
            k = np.clip(home + rng.permutation(moves)[:3].sum(axis=0), 1, value.K)
            least = float(value(k)[0])


def scipy_de(value: Counted, seed: int) -> None:
    """Differential evolution of SciPy over whole numbers, at its defaults."""
    from scipy.optimize import differential_evolution

    while True:
        bounds = [(1, value.K)] * value.n
        differential_evolution(
            lambda x: float(value(x)[0]), bounds, integrality=True, polish=False, maxiter=10**6, seed=seed
        )
        seed += 1000


PEERS: dict[str, Callable[[Counted, int], None]] = {
    "random": random_soles,
    "cma": cma_es,
    "pymoo_de": of_pymoo("de:DE"),
    "pymoo_es": of_pymoo("es:ES"),
    "pymoo_pso": of_pymoo("pso:PSO"),
    "pymoo_cmaes": of_pymoo("cmaes:CMAES"),
    "scipy_de": scipy_de,
    "ils": local_search,
}
RUNS = ("memetic", "ga", *PEERS)


def draw(number: int, objective: str | tuple[str, ...] = "efficiency") -> fo.FootProblem:
    """The scene and space of a number, in which most random soles can walk."""
    if number in BIPEDS:
        robot = fo.mujoco.Robot(sand=fo.Sand.named(("soft", "regular", "hard")[number - BIPEDS[0]]))
        return fo.FootProblem(robot, objective, None, fo.Accuracy(dt=2e-3, plates=32), 1)
    for attempt in range(20):
        rng = np.random.default_rng([number, attempt])
        gait = fo.Gait.human(
            period=float(rng.uniform(0.95, 1.5)), pitch=str(rng.choice(["shank", "measured"]))
        )
        thigh, knee, foot = (varied(joint, rng) for joint in (gait.thigh, gait.knee, gait.foot))
        gait = replace(gait, thigh=thigh, knee=knee, foot=foot, name=f"drawn {number}")
        leg = rng.uniform(0.8, 1.2)
        mass = float(np.exp(rng.uniform(np.log(30), np.log(100))))
        soft, hard = (10, 100) if number >= RUGGED else (0.2, 12)
        zeta = float(np.exp(rng.uniform(np.log(soft), np.log(hard))))
        effects = EFFECTS[str(rng.choice(list(EFFECTS), p=[0.5, 0.25, 0.25]))]
        if number >= RUGGED and rng.random() < 0.5:
            effects += (fo.Slope(float(rng.uniform(-8.0, 8.0))),)
        space = fo.Waypoints(n=int(rng.choice([9, 11, 13])), K=int(rng.choice([8, 10, 14])))
        walker = fo.Walker(mass=mass, l1=0.47 * leg, l2=0.45 * leg)
        scene = fo.Scene(sand=fo.Sand(zeta=zeta), gait=gait, walker=walker, effects=effects)
        problem = fo.FootProblem(scene, objective, space, COARSELY, 1)
        walked = problem.evaluate_designs(space.random(64, seed=1, inside=True))
        if (walked.reasons == "").mean() > 0.5:
            return problem
    raise RuntimeError(f"no scene {number}")


def varied(joint: Fourier | None, rng: np.random.Generator) -> Fourier | None:
    """A joint's angle with every coefficient up to 15 % off."""
    if joint is None:
        return None
    a, b = (tuple((np.array(c) * rng.uniform(0.85, 1.15, len(c))).tolist()) for c in (joint.a, joint.b))
    return joint._replace(a=a, b=b)


def searched(name: str, problem: fo.FootProblem, walks: int, seed: int) -> list[float]:
    """The least J_W after each walk of a search, of a solver of footopt or of another optimiser."""
    if name not in SOLVERS:
        value = Counted(problem, walks)
        with suppress(Done):
            PEERS[name](value, seed)
        return value.bests
    found = fo.search(problem, name, walks=walks, seed=seed)
    inside = found.reasons != "box"
    j = np.where(found.feasible, found.column("efficiency"), np.inf)[inside]
    return [float(value) for value in np.minimum.accumulate(j)]


def improvements(bests: list[float]) -> str:
    """Each walk that was better than all before it, with its J_W, as text."""
    new = np.flatnonzero(np.diff(bests, prepend=np.inf) < 0.0)
    return " ".join(f"{i + 1}:{float(bests[i])!r}" for i in new.tolist())


def of_best(improved: str, best: float, walks: int) -> tuple[int | None, float]:
    """After how many walks a search came within `WITHIN` of the best, if it did, and its regret."""
    at, values = np.array([step.split(":") for step in improved.split()], float).T
    near = at[(values <= best * (1 - WITHIN)) & (at <= walks)]
    return int(near[0]) if len(near) else None, float(1.0 - values[at <= walks].min() / best)


def expected(hits: list[int | None], walks: int) -> float:
    """Expected walks to a hit of searches begun anew after so many walks; of no hit as of half a one."""
    found = [h for h in hits if h is not None]
    return (sum(found) + walks * (len(hits) - len(found))) / max(len(found), 0.5)


def geometric(hits: list[list[int | None]], walks: int) -> float:
    """Geometric mean over the scenes of the expected walks to a hit."""
    return float(np.exp(np.mean([np.log(expected(of_scene, walks)) for of_scene in hits])))


def table(rows: list[dict[str, str]], walks: int) -> None:
    """Print what all searches of at least so many walks come to; the best known sole is the best of all rows.

    Brackets hold 90 % of the expected walks of searches drawn again, 400 times. Only equal numbers of
    searches can be compared: where none hits, their number says what is assumed.
    """
    best: dict[str, float] = {}
    for row in rows:
        found = float(row["improved"].split()[-1].split(":")[1])
        best[row["scene"]] = min(best.get(row["scene"], 0.0), found)
    print(f"\nUp to {walks:,} walks, {len(best)} scenes:\n")
    print("| optimiser | searches | expected walks (90 %) | hits | median regret | s a search |")
    print("| --- | --- | --- | --- | --- | --- |")
    lines = []
    for name in dict.fromkeys(row["optimiser"] for row in rows):
        own = [row for row in rows if row["optimiser"] == name and int(row["walks"]) >= walks]
        hits: dict[str, list[int | None]] = {scene: [] for scene in best}
        regrets = []
        for row in own:
            at, lack = of_best(row["improved"], best[row["scene"]], walks)
            hits[row["scene"]].append(at)
            regrets.append(lack)
        if not all(hits.values()):
            continue  # not tried in every scene
        draw = np.random.default_rng(1)
        again = [
            geometric([[h[i] for i in draw.integers(len(h), size=len(h))] for h in hits.values()], walks)
            for _ in range(400)
        ]
        low, high = np.quantile(again, (0.05, 0.95))
        mean = geometric([*hits.values()], walks)
        share = np.mean([h is not None for of_scene in hits.values() for h in of_scene])
        seconds = np.median([float(row["seconds"]) for row in own])
        cells = (name, len(own), f"{mean:,.0f} ({low:,.0f} to {high:,.0f})", f"{share:.0%}")
        lines.append((mean, (*cells, f"{np.median(regrets):.2%}", f"{seconds:.1f}")))
    for _, cells in sorted(lines):
        print("|", " | ".join(map(str, cells)), "|")


def main(names: tuple[str, ...] = RUNS, about: str | None = __doc__) -> None:
    """Search with some optimisers, and print the tables."""
    parser = arguments(about)
    parser.add_argument("--scenes", type=int, nargs="*", default=range(FIRST_SCENE, FIRST_SCENE + 10))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--walks", type=int, default=MANY, help="of a search")
    parser.add_argument("--only", nargs="*", default=[*names], choices=names)
    parser.add_argument("--out", type=Path, default=Path("outputs/optimisers.csv"))
    given = parser.parse_args()
    warnings.simplefilter("ignore")  # the other libraries' own
    scenes, seeds, walks = (given.scenes, given.seeds, given.walks) if not given.quick else ([101], 1, 100)
    rows: list[dict[str, str]] = []
    if not given.quick and given.out.is_file():
        with open(given.out, newline="") as file:
            rows = list(csv.DictReader(file))
    have = {(row["scene"], row["optimiser"], row["seed"]) for row in rows if int(row["walks"]) >= walks}
    for scene in scenes:
        problem = draw(scene)
        for name, seed in product(given.only, range(1, seeds + 1)):
            if (str(scene), name, str(seed)) in have:
                continue
            started = time.perf_counter()
            try:
                bests = searched(name, problem, walks, seed)
            except MissingError as error:
                print(f"{name} is left out: {error}")
                continue
            found = (scene, name, seed, walks, time.perf_counter() - started, improvements(bests))
            rows.append(dict(zip(COLUMNS, map(str, found), strict=True)))
            if not given.quick:
                given.out.parent.mkdir(parents=True, exist_ok=True)
                with open(given.out, "a", newline="") as file:
                    writer = csv.DictWriter(file, COLUMNS)
                    if not file.tell():
                        writer.writeheader()
                    writer.writerow(rows[-1])
    rows = [row for row in rows if int(row["scene"]) in scenes and row["optimiser"] in names]
    for walks in sorted({min(budget, walks) for budget in BUDGETS}):
        table(rows, walks)


if __name__ == "__main__":
    main()
