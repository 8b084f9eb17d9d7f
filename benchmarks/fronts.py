"""Which solver covers most of a front? On the scenes of `solvers.py`.

`python benchmarks/fronts.py` gives every solver 2,500 walks in each of ten random scenes that none was tuned
on: of the five objectives, or with `--objectives 2` or `3` of as many, drawn for each scene. Each front is a
file in `outputs/fronts`, so that it goes on where it was stopped. The tables have shares of the hypervolume
of all fronts of a scene merged; with `--walks 10000`, there are tables after 1,000 and 2,500 of them as well.
A sole outside its box is no walk: the solvers with the textbook's operators, which ask for such soles, have
as many walks inside the box as the others. With --quick: one scene, one seed, 100 walks.
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

WALKS, BUDGETS = 2_500, (1_000, 2_500)
#: Solvers, and what is given to them.
RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    "nsga2": ("nsga2", {}),
    "archive": ("archive", {}),
    "agemoea2": ("agemoea2", {}),
    "smsemoa": ("smsemoa", {}),
    "nsga2 of the textbook": ("nsga2", {"operators": {}}),
}


def fronts(problem: fo.FootProblem, name: str, budgets: list[int], seed: int) -> list[Any]:
    """F of the front of so many walks inside the box, (designs, objectives), for each budget."""
    from moocore import filter_dominated

    solver, given = RUNS[name]
    r = fo.search(problem, solver, walks=(4 if given else 1) * budgets[-1], seed=seed, **given)
    inside = np.flatnonzero(r.reasons != "box")
    kept = [inside[:walks][r.feasible[inside[:walks]]] for walks in budgets]
    return [filter_dominated(problem.minimised(r.values[rows])) for rows in kept]


def main() -> None:
    """Search, and print the table."""
    parser = arguments(__doc__)
    parser.add_argument("--scenes", type=int, nargs="*", default=range(FIRST_SCENE, FIRST_SCENE + 10))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--objectives", type=int, default=5, choices=(2, 3, 4, 5))
    parser.add_argument("--walks", type=int, default=WALKS, help="of a search")
    parser.add_argument("--only", nargs="*", default=[*RUNS], choices=RUNS)
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no search is begun")
    parser.add_argument("--out", type=Path, default=Path("outputs/fronts"))
    given = parser.parse_args()
    scenes, seeds, walks = (
        ([FIRST_SCENE], 1, 100) if given.quick else (given.scenes, given.seeds, given.walks)
    )
    budgets = [*(budget for budget in BUDGETS if budget < walks), walks]
    folder = given.out / str(given.objectives)
    folder.mkdir(parents=True, exist_ok=True)
    end = time.time() + 60.0 * given.minutes
    found: dict[int, dict[int, dict[tuple[str, int], Any]]] = {b: {s: {} for s in scenes} for b in budgets}
    for seed in range(1, seeds + 1):
        for scene in scenes:
            problem = None
            for name in given.only:
                paths = [folder / f"{scene}-{name.replace(' ', '-')}-{seed}-{b}.npy" for b in budgets]
                if not all(path.exists() for path in paths):
                    if time.time() > end:
                        continue
                    drawn = np.random.default_rng(scene).permutation(len(FIVE))[: given.objectives]
                    names = tuple(FIVE[i] for i in np.sort(drawn))
                    problem = problem or draw(scene, names)
                    for path, front in zip(paths, fronts(problem, name, budgets, seed), strict=True):
                        np.save(path, front)
                for budget, path in zip(budgets, paths, strict=True):
                    found[budget][scene][name, seed] = np.load(path)
    for budget, of_scene in found.items():
        print(f"\nAfter {budget:,} walks:\n")
        print("| solver | share of the merged front's hypervolume, mean | worst | searches |")
        print("| --- | --- | --- | --- |")
        shares: dict[str, list[float]] = {name: [] for name in given.only}
        for kept in of_scene.values():
            for (name, _), share in zip(kept, hypervolume_shares([*kept.values()]), strict=True):
                shares[name].append(100.0 * share)
        for name, of_name in shares.items():
            if of_name:
                print(f"| {name} | {np.mean(of_name):.1f} % | {min(of_name):.1f} % | {len(of_name)} |")


if __name__ == "__main__":
    main()
