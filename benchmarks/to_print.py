"""The foot to print: its largest loss over the laws, against that of a robust search ten times as long.

`python benchmarks/to_print.py [SCENES]` takes the paper's three sands, and so many scenes of `solvers.py`. In
each the default search is followed by the one for the foot to print. To compare, the best foot of each law is
found by two searches of 5,000 walks, and the robust one by two more, all at `standard`. It prints the largest
losses (%) of the best foot by the scene's own law, of the foot to print and of the robust one, and the time
of the second search over the first's.
"""

import sys
import time
from typing import Any

import numpy as np
from solvers import draw

import footopt as fo
from footopt.design import FootProblem, RobustProblem, confirm, search, under_laws
from footopt.design.laws import compare, possible_laws
from footopt.design.scenarios import sands
from footopt.walk.ladder import numerics

LONG, FIRST = 5_000, 201  # walks; number of the first random scene


def judged(name: str, given: FootProblem) -> tuple[float, float, float, float]:
    """Largest losses of the best foot, of the one to print and of the robust one; time over the search's."""
    scene, space = given.scene, given.space
    problem, laws = FootProblem(scene, "efficiency", space), possible_laws(scene, fo.Spread().zeta)
    numbers, flat = numerics(problem.accuracy, scene, space), np.full((1, space.n), space.K)
    begin = time.process_time()
    result = search(problem, seed=1)
    first = time.process_time()
    confirmed = confirm(result, "fine")
    chosen = time.process_time()
    under = under_laws(result, confirmed)
    spent = (time.process_time() - chosen) / (first - begin)

    specialists, references = [], []
    for law in laws:
        alone = FootProblem(law.scene, "efficiency", space, numbers)
        found = [search(alone, walks=LONG, seed=seed) for seed in (1, 2)]
        specialists += [r.k[r.best] for r in found]
        references.append(min(r.column("efficiency")[r.best] for r in found))
    robust: Any = RobustProblem(laws, "efficiency", space, numbers, references=references)
    start = np.unique(specialists[::2], axis=0)
    longer = [r.k[r.best] for r in (search(robust, walks=LONG, seed=seed, start=start) for seed in (1, 2))]
    feet = np.array([under.k[0], under.k[under.steadiest or 0], *longer, *specialists, *flat])
    every = compare(problem.at(numbers), laws, feet)
    best, to_print, *others = every.worst[:4]
    print(
        f"{name:12} {100 * best:7.1f} {100 * to_print:7.2f} {100 * min(others):7.2f} {spent:7.2f}", flush=True
    )
    return best, to_print, min(others), spent


def main() -> None:
    """Judge the paper's sands and random scenes."""
    random = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    problems = {s.name: FootProblem(s.scene) for s in sands(fo.Scene())}
    problems |= {str(number): draw(number) for number in range(FIRST, FIRST + random)}
    print("scene           best   print  robust  time", flush=True)
    rows = np.array([judged(name, problem) for name, problem in problems.items()])
    excess = 100 * (rows[:, 1] - rows[:, 2])
    within = f"{np.mean(excess <= 1.0):.0%} within 1 %"
    print(f"{within}, worst {excess.max():.2f} %; time {np.median(rows[:, 3]):.2f}")


if __name__ == "__main__":
    main()
