"""Which solver covers most of a front? On the scenes of `solvers.py`.

`python benchmarks/fronts.py` gives every solver 2,500 walks in each of ten random scenes that none was tuned
on: of the five objectives, or with `--objectives 2` or `3` of as many, drawn for each scene. Each front is a
file in `outputs/fronts`, so that it goes on where it was stopped. The table has shares of the hypervolume of
all fronts of a scene merged. A sole outside its box is no walk: the solvers with the
textbook's operators, which ask for such soles, have as many walks inside the box as the others. With
--quick: one scene, one seed, 100 walks.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
from measure import arguments
from solvers import FIRST_SCENE, draw

import footopt as fo
from footopt.design.fronts import hypervolume_shares
from footopt.walk.objectives import FIVE

WALKS = 2_500
#: Solvers, and what is given to them.
RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    "nsga2": ("nsga2", {}),
    "archive": ("archive", {}),
    "agemoea2": ("agemoea2", {}),
    "smsemoa": ("smsemoa", {}),
    "nsga2 of the textbook": ("nsga2", {"operators": {}}),
}


def front(problem: fo.FootProblem, name: str, walks: int, seed: int) -> Any:
    """F of the front of so many walks inside the box, (designs, objectives)."""
    from moocore import filter_dominated

    solver, given = RUNS[name]
    r = fo.search(problem, solver, walks=(4 if given else 1) * walks, seed=seed, **given)
    first = np.flatnonzero(r.reasons != "box")[:walks]
    return filter_dominated(problem.minimised(r.values[first[r.feasible[first]]]))


def main() -> None:
    """Search, and print the table."""
    parser = arguments(__doc__)
    parser.add_argument("--scenes", type=int, nargs="*", default=range(FIRST_SCENE, FIRST_SCENE + 10))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--objectives", type=int, default=5, choices=(2, 3, 4, 5))
    parser.add_argument("--only", nargs="*", default=[*RUNS], choices=RUNS)
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no search is begun")
    parser.add_argument("--out", type=Path, default=Path("outputs/fronts"))
    given = parser.parse_args()
    scenes, seeds, walks = ([FIRST_SCENE], 1, 100) if given.quick else (given.scenes, given.seeds, WALKS)
    folder = given.out / str(given.objectives)
    folder.mkdir(parents=True, exist_ok=True)
    end = time.time() + 60.0 * given.minutes
    found: dict[int, dict[tuple[str, int], Any]] = {scene: {} for scene in scenes}
    for seed in range(1, seeds + 1):
        for scene in scenes:
            problem = None
            for name in given.only:
                path = folder / f"{scene}-{name.replace(' ', '-')}-{seed}-{walks}.npy"
                if not path.exists():
                    if time.time() > end:
                        continue
                    drawn = np.random.default_rng(scene).permutation(len(FIVE))[: given.objectives]
                    names = tuple(FIVE[i] for i in np.sort(drawn))
                    problem = problem or draw(scene, names)
                    np.save(path, front(problem, name, walks, seed))
                found[scene][name, seed] = np.load(path)
    print("| solver | share of the merged front's hypervolume, mean | worst | searches |")
    print("| --- | --- | --- | --- |")
    shares: dict[str, list[float]] = {name: [] for name in given.only}
    for fronts in found.values():
        for (name, _), share in zip(fronts, hypervolume_shares([*fronts.values()]), strict=True):
            shares[name].append(100.0 * share)
    for name, of_name in shares.items():
        if of_name:
            print(f"| {name} | {np.mean(of_name):.1f} % | {min(of_name):.1f} % | {len(of_name)} |")


if __name__ == "__main__":
    main()
