"""What effects cost: the bare walk against one without their code, and what each effect adds.

python benchmarks/effects.py  # a table for soft, regular and hard sand, about two minutes

With --quick two feet walk once on one sand with one effect, in the process that compiles.

The same source compiled twice may differ by 5 to 9 % in time, by how its machine code happens to lie. So
the deleted code is compared with a plain copy of the source that the same process compiles in the same
way, and every ratio is the median over processes that load the code in another order. What effects add
is against footopt's own bare walk, and known no better than that.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import ModuleType

import deleted
import numpy as np
from measure import SANDS, arguments, feet, interleaved, scene

import footopt as fo
from footopt.effects import EFFECTS

DELETED, COPY = "code deleted", "bare, copied"
#: What is walked, by name: each effect with its own defaults, and all of them.
SETS = {
    "bare": (),
    **{name: (effect(),) for name, effect in EFFECTS.items()},
    "all": tuple(effect() for effect in EFFECTS.values()),
}

QUICK = ("bare", "inertia")

Ratios = dict[str, tuple[float, float]]


def load(folder: Path) -> dict[str, ModuleType]:
    """The two loops that `write` has written."""
    return {DELETED: deleted.load(folder), COPY: deleted.load(folder, "footopt_copy")}


def write(folder: Path) -> None:
    """Write the source without the effects' code, and a plain copy of it."""
    deleted.write(folder)
    deleted.write(folder, "footopt_copy", delete=False)


def jobs(
    sand: str, designs: int, loops: dict[str, ModuleType], sets: Collection[str]
) -> dict[str, Callable[[], fo.Table]]:
    """Walks of random feet on a sand, one thread: by other loops, and with some of `SETS`."""

    def walk(*effects: object) -> fo.Table:
        return fo.evaluate(feet(designs), replace(scene(sand), effects=effects), threads=1)

    def other(loop: ModuleType) -> fo.Table:
        with deleted.walking(loop):
            return walk()

    others = {name: partial(other, loop) for name, loop in loops.items()}
    return {**others, **{name: partial(walk, *SETS[name]) for name in sets}}


def here(
    sand: str,
    loops: dict[str, ModuleType],
    seed: int,
    designs: int = 30,
    repeats: int = 9,
    sets: Collection[str] = tuple(SETS),
) -> Ratios:
    """Processor time over the bare walk's (its copy's), and evaluations likewise, in this process.

    Without the effects' code the walks must be the same to the last bit.

    seed : of the order in which the walks are loaded and measured.
    """
    walks = jobs(sand, designs, loops, sets)
    chosen = {name: walks[name] for name in np.random.default_rng(seed).permutation(list(walks)).tolist()}
    tables = {name: job() for name, job in chosen.items()}
    for name in (DELETED, COPY):
        np.testing.assert_array_equal(tables[name].raw, tables["bare"].raw, err_msg=name)
    counts = {name: table.evaluations.sum() for name, table in tables.items()}
    times = interleaved(chosen, repeats, time.thread_time)
    base = {name: COPY if name == DELETED else "bare" for name in chosen}
    return {name: (times[name] / times[b], float(counts[name] / counts[b])) for name, b in base.items()}


def compare(processes: int = 7, quick: bool = False) -> dict[str, Ratios]:
    """`here` for every sand: the median over processes, after one that compiles; quick: of that one."""
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder))
        found = []
        for seed in range(1 if quick else 1 + processes):
            run = [sys.executable, __file__, folder, str(seed), *(["--quick"] if quick else [])]
            found.append(json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout))
    kept = found if quick else found[1:]
    sands, known = list(kept[0]), kept[0][SANDS[-1]]
    names = [name for name in (DELETED, COPY, *SETS) if name in known]
    median = np.median([[[one[sand][name] for name in names] for sand in sands] for one in kept], axis=0)
    return {
        sand: {name: (float(t), float(n)) for name, (t, n) in zip(names, rows, strict=True)}
        for sand, rows in zip(sands, median, strict=True)
    }


def main() -> None:
    """Print the table; or, given a folder of `write` and a seed, this process's ratios."""
    parser = arguments(__doc__)
    parser.add_argument("folder", nargs="?", type=Path, help="of `write`: print this process's ratios")
    parser.add_argument("seed", nargs="?", type=int, help="of their order")
    given = parser.parse_args()
    if given.folder is not None:
        loops, sizes = load(given.folder), (2, 1, QUICK) if given.quick else ()
        sands = SANDS[-1:] if given.quick else SANDS
        print(json.dumps({sand: here(sand, loops, given.seed, *sizes) for sand in sands}))
        return
    found = compare(quick=given.quick)
    print("| over the bare walk | " + " | ".join(f"{sand}: time | evaluations" for sand in found) + " |")
    print("| --- |" + " --- | --- |" * len(found))
    for name in found[SANDS[-1]]:
        row = (f"{of_sand[name][0]:.3f} | {of_sand[name][1]:.3f}" for of_sand in found.values())
        print(f"| {name} | " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
