"""What is saved by stopping walks that cannot matter any more, and what could be at most.

python benchmarks/early_stops.py          # some minutes
python benchmarks/early_stops.py --quick  # does it run?

Work, peak power and speed loss only grow during a walk. For each of them `ga` stops an offspring as soon as
it cannot survive (`solver.race`): first, what of a search's evaluations of the contact that saves.

For J_W and for several objectives distance and height would have to be bounded: second, the largest share
for three solvers. Everything is taken in favour of it: distance and height at the end are known, a design
counts as good as all that were ever walked before its generation allow, not only those that still live, and
stopping costs nothing. Every tenth design of a search is walked again with its trace.
"""

from __future__ import annotations

import numpy as np
from measure import arguments, scene

import footopt as fo
from footopt.walk.objectives import FIVE

SOLVERS = {"memetic": 30, "ga": 100, "nsga2": 100}  # survivors of a generation: parents, or population


def running(walk: fo.Walk) -> np.ndarray:
    """Work, peak power and speed loss at each sample of a walk so far, (samples, 3)."""
    late = walk.t > walk.scene.gait.heel_strike - 1e-9
    speed = np.maximum.accumulate(np.where(late, walk.velocity[:, 0], -np.inf))
    fall = np.where(late, speed - walk.velocity[:, 0], 0.0)
    power = np.where(late, np.abs(walk.power).max(axis=1), 0.0)
    work = np.abs(walk.work.sum(axis=1))
    return np.stack([work, np.maximum.accumulate(power), np.maximum.accumulate(fall)], axis=1)


def needed(walk: fo.Walk, values: np.ndarray, earlier: np.ndarray, survivors: int, several: bool) -> float:
    """The share of a walk after which it is certain that the design does not survive; 1 if it is not."""
    distance, height = values[:2]
    so_far = running(walk)
    if several:  # in the worst case as many as survive are better in all five
        known = np.maximum.accumulate(so_far, axis=0)
        fixed = (earlier[:, 0] >= distance) & (earlier[:, 1] >= height)
        better = [np.sum(fixed & (earlier[:, 2:] <= row).all(axis=1)) >= survivors for row in known]
    else:
        bound = -distance * height / np.maximum(so_far, [1.0, 1.0, 1e-3]).prod(axis=1)
        j = -earlier[:, 0] * earlier[:, 1] / np.maximum(earlier[:, 2:], [1.0, 1.0, 1e-3]).prod(axis=1)
        better = bound > np.sort(j)[survivors - 1]
    worse = np.flatnonzero(better)
    # the evaluations of a walk are about even in its steps
    return 1.0 if len(worse) == 0 else (worse[0] + 1) / len(walk.t)


def share(sand: str, name: str, walks: int) -> float:
    """The largest share of a search's walking that stopping could save, in %."""
    several, survivors = name == "nsga2", SOLVERS[name]
    problem = fo.FootProblem(scene(sand), objective="pareto" if several else "efficiency")
    result = fo.search(problem, name, walks=walks, seed=1)
    values = result.values[:, [problem.record.index(o) for o in FIVE]]
    good = np.isfinite(values).all(axis=1)
    shares = []
    for i in range(0, len(values), 10):
        earlier = values[(result.generation < result.generation[i]) & good]
        walk = fo.simulate(fo.Foot.from_waypoints(result.k[i], problem.space), problem.scene)
        enough = good[i] and len(earlier) >= survivors
        shares.append(needed(walk, values[i], earlier, survivors, several) if enough else 1.0)
    return 100.0 * (1.0 - float(np.mean(shares)))


def saved(sand: str, objective: str, walks: int) -> float:
    """The share of a search's evaluations of the contact that `ga` saves with its race, in %."""
    problem = fo.FootProblem(scene(sand), objective)
    result = fo.search(problem, "ga", walks=walks, seed=1)
    whole = stopped = 0
    for generation in range(1, 1 + int(result.generation.max())):
        now, before = result.generation == generation, (result.generation < generation) & result.feasible
        best = np.sort(result.column(objective)[before])[: SOLVERS["ga"]]
        ends = problem.lost(float(best[-1]) if len(best) == SOLVERS["ga"] else np.inf)
        asked = result.k[now], problem.scene, problem.accuracy, (objective,), problem.space
        whole += fo.evaluate(*asked).evaluations.sum()
        stopped += fo.evaluate(*asked, ends=ends).evaluations.sum()
    return 100.0 * (1.0 - stopped / whole)


def main() -> None:
    """Print the tables."""
    quick = arguments(__doc__ or "").parse_args().quick
    names = ("work", "peak_power", "speed_loss")
    print("| ga | " + " | ".join(names) + " |\n" + "| --- " * (1 + len(names)) + "|")
    for sand in ("soft",) if quick else ("soft", "regular", "hard"):
        rows = (saved(sand, name, 300 if quick else 4_000) for name in names)
        print(f"| {sand} | " + " | ".join(f"{percent:.1f} %" for percent in rows) + " |", flush=True)
    print("| sand | " + " | ".join(SOLVERS) + " |\n" + "| --- " * (1 + len(SOLVERS)) + "|")
    for sand in ("soft",) if quick else ("soft", "hard"):
        found = (share(sand, name, 300 if quick else 10_000) for name in SOLVERS)
        print(f"| {sand} | " + " | ".join(f"{percent:.1f} %" for percent in found) + " |", flush=True)


if __name__ == "__main__":
    main()
