"""The foot to print: its largest loss over the laws, against that of a robust search ten times as long.

`python benchmarks/to_print.py [SCENES]` takes the paper's three sands, and so many scenes of `solvers.py`. In
each the default search is followed by the one for the foot to print, with three seeds. To compare, the best
foot of each law is found by two searches of 5,000 walks, and the robust one by two more, all at `standard`.
It prints the largest losses (%) of the best foot by the scene's own law, of the foot to print for each seed
and of the robust one, and the time of the second search over the first's.
"""

import sys
import time
from typing import Any

import numpy as np
from solvers import draw

import footopt as fo
from footopt.design import FootProblem, RobustProblem, confirm, search, under_laws
from footopt.design.scenarios import possible_laws, sands
from footopt.design.to_print import compare
from footopt.walk.ladder import numerics

LONG, FIRST = 5_000, 201  # walks; number of the first random scene
SEEDS = (1, 2, 3)


def judged(name: str, given: FootProblem) -> tuple[list[float], float, float]:
    """Largest losses of the foot to print by seed, and of the robust one; median time over the search's."""
    scene, space = given.scene, given.space
    problem, laws = FootProblem(scene, "efficiency", space), possible_laws(scene, fo.Spread().zeta)
    numbers, flat = numerics(problem.accuracy, scene, space), np.full((1, space.n), space.K)
    feet, times = [], []
    for seed in SEEDS:
        begin = time.process_time()
        result = search(problem, seed=seed)
        first = time.process_time()
        confirmed = confirm(result, "fine")
        chosen = time.process_time()
        under = under_laws(result, confirmed)
        times.append((time.process_time() - chosen) / (first - begin))
        feet += [under.k[0], under.k[under.steadiest or 0]]

    specialists, references = [], []
    for law in laws:
        alone = FootProblem(law.scene, "efficiency", space, numbers)
        found = [search(alone, walks=LONG, seed=seed) for seed in (1, 2)]
        specialists += [r.k[r.best] for r in found]
        references.append(min(r.column("efficiency")[r.best] for r in found))
    robust: Any = RobustProblem(laws, "efficiency", space, numbers, references=references)
    start = np.unique(specialists[::2], axis=0)
    longer = [r.k[r.best] for r in (search(robust, walks=LONG, seed=seed, start=start) for seed in (1, 2))]
    every = compare(problem.at(numbers), laws, np.array([*feet, *longer, *specialists, *flat]))
    best, printed, robust_foot = (
        every.worst[0],
        every.worst[1 : len(feet) : 2],
        every.worst[len(feet) :][:2].min(),
    )
    shown = " ".join(f"{100 * loss:6.2f}" for loss in printed)
    spent = float(np.median(times))
    print(f"{name:8} {100 * best:6.1f}  {shown}  {100 * robust_foot:6.2f} {spent:6.2f}", flush=True)
    return printed.tolist(), robust_foot, spent


def main() -> None:
    """Judge the paper's sands and random scenes."""
    random = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    problems = {s.name: FootProblem(s.scene) for s in sands(fo.Scene())}
    problems |= {str(number): draw(number) for number in range(FIRST, FIRST + random)}
    print("scene      best  to print, by seed    robust   time", flush=True)
    rows = [judged(name, problem) for name, problem in problems.items()]
    excess = 100 * np.array([np.array(printed) - robust for printed, robust, _ in rows])
    within = f"{np.mean(excess <= 1.0):.0%} of searches lose at most 1 % more than the robust foot"
    middle, time_ratio = np.median(excess), np.median([spent for *_, spent in rows])
    print(f"{within}, median {middle:.2f} %, worst {excess.max():.2f} %; time {time_ratio:.2f}")


if __name__ == "__main__":
    main()
