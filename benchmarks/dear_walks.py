"""How many dear walks does `solver=surrogate` need, and how long does it take, beside `memetic`?

`python benchmarks/dear_walks.py reference` has random scenes of `other_optimisers.py` at accuracy=reference,
`effects` with leading edge, inertia, shadowing and footprints at once, and `robust` as 16 scenarios drawn of
each, by the mean of J_W relative to the flat sole's. Each search has a row in `outputs/dear_KIND.csv`, from
which it goes on where it was stopped; the tables follow: by dear walks, and by what else they took. With
--quick: one scene, one seed, 30 walks.
"""

from __future__ import annotations

import csv
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from measure import arguments
from solvers import draw, improvements
from solvers import table as printed

import footopt as fo

FIRST_SCENE, SCENES = 401, 6
WALKS = {"memetic": 1_000, "surrogate": 300}
EVERY = (fo.LeadingEdge(), fo.Inertia(), fo.Shadowing(), fo.Footprints())
SCENARIOS = 16


def dear(kind: str, number: int) -> fo.FootProblem:
    """A problem whose walks are dear, in the scene of a number."""
    drawn = draw(number)
    scene, space = drawn.scene, drawn.space
    if kind == "reference":
        return fo.FootProblem(scene, "efficiency", space, "reference", 1)
    if kind == "effects":
        return fo.FootProblem(replace(scene, effects=EVERY), "efficiency", space, "standard", 1)
    scenarios = fo.draw(scene, fo.Spread(), SCENARIOS, number)
    flat = np.full((1, space.n), space.K)
    worn = [fo.evaluate(flat, s.scene, "standard", ("efficiency",), s.space(space)) for s in scenarios]
    references = [float(table.values[0, 0]) for table in worn]
    return fo.RobustProblem(scenarios, "efficiency", space, "standard", 1, "mean", references=references)


def main() -> None:
    """Search, and print the tables."""
    parser = arguments(__doc__)
    parser.add_argument("kind", choices=("reference", "effects", "robust"), nargs="?", default="reference")
    parser.add_argument("--scenes", type=int, nargs="*", default=range(FIRST_SCENE, FIRST_SCENE + SCENES))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--only", nargs="*", default=[*WALKS], choices=WALKS)
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no search is begun")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    out = given.out or Path(f"outputs/dear_{given.kind}.csv")
    rows: list[dict[str, str]] = []
    if out.is_file() and not given.quick:
        with open(out, newline="") as file:
            rows = list(csv.DictReader(file))
    have = {(row["scene"], row["optimiser"], row["seed"]) for row in rows}
    end = time.time() + 60.0 * given.minutes
    scenes, seeds = ([FIRST_SCENE], 1) if given.quick else (given.scenes, given.seeds)
    for seed in range(1, seeds + 1):
        for scene in scenes:
            for name in given.only:
                if (str(scene), name, str(seed)) in have or time.time() > end:
                    continue
                problem, walks = dear(given.kind, scene), 30 if given.quick else WALKS[name]
                started = time.process_time()
                found = fo.search(problem, name, walks=walks, seed=seed)
                seconds = time.process_time() - started
                j = np.where(found.feasible, found.column("efficiency"), np.inf)
                row = {
                    "scene": scene, "optimiser": name, "seed": seed, "walks": walks, "best": 0.0,
                    "seconds": round(seconds, 2), "choosing": found.choosing / found.seconds,
                    "coarse": found.coarse, "improved": improvements(np.minimum.accumulate(j).tolist()),
                }  # fmt: skip
                rows.append({column: str(value) for column, value in row.items()})
                if not given.quick:
                    new = not out.is_file()
                    out.parent.mkdir(parents=True, exist_ok=True)
                    with open(out, "a", newline="") as file:
                        writer = csv.DictWriter(file, row)
                        if new:
                            writer.writeheader()
                        writer.writerow(row)
    for walks in (30,) if given.quick else sorted(WALKS.values()):
        printed(rows, walks)
    print()
    for name in given.only:
        own = [row for row in rows if row["optimiser"] == name]
        total, share = (np.array([float(row[of]) for row in own]) for of in ("seconds", "choosing"))
        each = 1e3 * np.mean((1.0 - share) * total / [int(row["walks"]) for row in own])
        coarse = np.mean([int(row["coarse"]) for row in own])
        print(f"{name}: {each:.1f} ms a dear walk, {coarse:,.0f} coarse walks a search, which takes "
              f"{np.mean(total):.1f} s, {np.mean(share * total):.1f} of these to choose")  # fmt: skip


if __name__ == "__main__":
    main()
