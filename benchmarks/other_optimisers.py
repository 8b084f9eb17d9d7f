"""footopt's solvers against optimisers of other libraries, counted in walks, on scenes drawn at random.

`python benchmarks/other_optimisers.py` lets every optimiser search the least J_W on ten scenes, ten seeds
each, and writes a row for each search into `outputs/optimisers.csv`, from which it goes on where it was
stopped; the tables follow. It needs `pip install -e ".[benchmark]"`; what is not installed is left out and
named. A scene is drawn by its number: gait, walker, sand, effects, and how many waypoints and levels a sole
has. The solvers' constants were chosen on scenes 1, 4 and 8; those that are judged begin at 101.

`footopt.design.peers` has the other optimisers, and says what a walk is. A search ends when it has come
within 0.1 % of the best sole known, or at its walks, or when it has asked for 20 times as many designs. With
--quick: one scene, one seed, 100 walks.
"""

from __future__ import annotations

import csv
import sys
import time
import warnings
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from measure import arguments

import footopt as fo
from footopt.design import SOLVERS
from footopt.design.peers import PEERS, asked_by
from footopt.errors import MissingError
from footopt.gait.fourier import Fourier
from footopt.walk.accuracy import COARSE

FIRST_SCENE, FIRST, FEW, MANY = 101, 300, 1_000, 10_000
WITHIN = 1e-3  # of the best known, relative
BASE = "memetic"  # beside whose searches from the same seeds those of the others are set
EFFECTS: dict[str, tuple[Any, ...]] = {
    "none": (),
    "leading edge": (fo.LeadingEdge(),),
    "inertia": (fo.Inertia(),),
}


def draw(number: int, objective: str | tuple[str, ...] = "efficiency") -> fo.FootProblem:
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
        problem = fo.FootProblem(scene, objective, space, COARSE, 1)
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


#: Optimisers, and at how many walks each is judged: those that take long for a design at the fewer only.
RUNS = {"memetic": MANY, "ga": MANY} | {
    name: {"smac": FIRST, "optuna_tpe": FEW, "optuna_cma": FEW}.get(name, MANY) for name in PEERS
}


def searched(name: str, problem: fo.FootProblem, walks: int, seed: int, enough: float) -> list[float]:
    """The least J_W after each walk of a search, of a solver of footopt or of another optimiser."""
    if name not in SOLVERS:
        return asked_by(name, problem, walks, seed, enough).bests
    found = fo.search(problem, name, lambda g: bool(g.best <= enough), walks=walks, seed=seed)
    inside = found.reasons != "box"
    j = np.where(found.feasible, found.column("efficiency"), np.inf)[inside]
    return [float(value) for value in np.minimum.accumulate(j)]


def best_known(problem: fo.FootProblem) -> float:
    """The best J_W of long searches, by which searches are ended; tables go by the best of all of them."""
    return min(searched("memetic", problem, MANY, seed, -np.inf)[-1] for seed in (901, 902))


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

    An optimiser is in a table if it has been given so many walks in every scene. What is assumed of a scene
    in which no search hits depends on how many there were: so the default's searches from the same seeds
    stand beside it.
    """
    for walks in budgets:
        print(f"\nUp to {walks:,} walks, {len(best)} scenes:\n")
        print(f"| optimiser | searches | expected walks (90 %) | `{BASE}`, same seeds | scenes hit | hits | "
              "median regret | s a search |")  # fmt: skip
        print("| --- | --- | --- | --- | --- | --- | --- | --- |")
        lines = []
        found = {key(row): row for row in rows if int(row["walks"]) >= walks}
        for name in {name for _, name, _ in found}:
            own = [row for (_, who, _), row in found.items() if who == name]
            if {int(row["scene"]) for row in own} != {*best}:
                continue
            same = [found.get((scene, BASE, seed)) for scene, who, seed in found if who == name]
            beside = "" if None in same else f"{geometric(by_scene(same, best, walks), walks):,.0f}"
            hits = by_scene(own, best, walks)
            lacks = [regret(row["improved"], best[int(row["scene"])], walks) for row in own]
            every = [h is not None for of_scene in hits for h in of_scene]
            scenes = f"{sum(any(h is not None for h in of_scene) for of_scene in hits)} of {len(hits)}"
            low, high = spread(hits, walks)
            ahead = f"{geometric(hits, walks):,.0f} ({low:,.0f} to {high:,.0f})"
            seconds = np.median([float(row["seconds"]) for row in own])
            lines.append((geometric(hits, walks), f"| {name} | {len(own)} | {ahead} | {beside} | {scenes} | "
                          f"{np.mean(every):.0%} | {np.median(lacks):.2%} | {seconds:.1f} |"))  # fmt: skip
        print(*(line for _, line in sorted(lines)), sep="\n")


def by_scene(rows: list[Any], best: dict[int, float], walks: int) -> list[list[int | None]]:
    """After how many walks each search hit, the searches of a scene together."""
    hits: dict[int, list[int | None]] = {scene: [] for scene in best}
    for row in rows:
        hits[int(row["scene"])].append(hit(row["improved"], best[int(row["scene"])], walks))
    return [*hits.values()]


def key(row: dict[str, str]) -> tuple[int, str, int]:
    """Which search a row is of."""
    return int(row["scene"]), row["optimiser"], int(row["seed"])


def main(runs: dict[str, int] = RUNS, about: str | None = __doc__) -> None:
    """Search with some optimisers, each at most so many walks, and print the tables."""
    parser = arguments(about)
    parser.add_argument("--scenes", type=int, nargs="*", default=range(FIRST_SCENE, FIRST_SCENE + 10))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--walks", type=int, default=MANY, help="of a search, at most")
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no search is begun")
    parser.add_argument("--only", nargs="*", default=[*runs], choices=runs)
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
    have = {key(r): int(r["walks"]) for r in rows}
    missing: set[str] = set()
    end = time.time() + 60.0 * given.minutes
    problems: dict[int, tuple[fo.FootProblem, float]] = {}
    for seed in range(1, seeds + 1):  # all scenes have a few searches before one has all
        for scene in scenes:
            if time.time() > end:
                break
            if scene not in problems:
                problem = draw(scene)
                best = -1e9 if given.quick else known.get(scene) or best_known(problem)
                problems[scene] = problem, best
            problem, best = problems[scene]
            for name, most in runs.items():
                asked, walks = name in given.only, min(most, given.walks)
                done = have.get((scene, name, seed), 0) >= walks or name in missing
                if not asked or done or time.time() > end:
                    continue
                started = time.perf_counter()
                try:
                    bests = searched(name, problem, walks, seed, best * (1 - WITHIN))
                except MissingError as error:
                    missing.add(name)
                    print(f"{name} is left out: {error}")
                    continue
                row = {
                    "scene": scene, "optimiser": name, "seed": seed, "walks": walks, "best": best,
                    "seconds": round(time.perf_counter() - started, 2), "improved": improvements(bests),
                }  # fmt: skip
                rows.append({column: str(value) for column, value in row.items()})
                if not given.quick:
                    new = not given.out.is_file()
                    given.out.parent.mkdir(parents=True, exist_ok=True)
                    with open(given.out, "a", newline="") as file:
                        writer = csv.DictWriter(file, row)
                        if new:
                            writer.writeheader()
                        writer.writerow(row)
    last = {key(r): r for r in rows}  # a search that was done again
    asked = [
        r for (scene, name, seed), r in last.items() if scene in scenes and seed <= seeds and name in runs
    ]
    best_known_now = {scene: value for scene, value in best_by_scene(rows).items() if scene in scenes}
    tables(asked, best_known_now, tuple(sorted({min(w, given.walks) for w in (FIRST, FEW, MANY)})))
    sys.stdout.flush()


if __name__ == "__main__":
    main()
