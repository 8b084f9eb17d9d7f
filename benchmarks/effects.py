"""What effects cost: walks with each over the walk without.

python benchmarks/effects.py  # a table for soft, regular and hard sand, about two minutes

With --quick two feet walk once on one sand with one effect. The same source compiled twice may differ by 5 to
9 % in time, by how its machine code happens to lie: ratios are known no better than that.
"""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import replace
from functools import partial

from measure import SANDS, arguments, feet, interleaved, scene

import footopt as fo
from footopt.effects import EFFECTS

#: What is walked, by name: each effect with its own defaults, and all of them.
SETS = {
    "bare": (),
    **{name: (effect(),) for name, effect in EFFECTS.items()},
    "all": tuple(effect() for effect in EFFECTS.values()),
}

QUICK = ("bare", "inertia")

Ratios = dict[str, tuple[float, float]]


def ratios(sand: str, designs: int, repeats: int, sets: Collection[str]) -> Ratios:
    """Processor time over the bare walk's, and evaluations likewise, of random feet in one thread."""
    walks = {
        name: partial(fo.evaluate, feet(designs), replace(scene(sand), effects=SETS[name]), threads=1)
        for name in sets
    }
    counts = {name: job().evaluations.sum() for name, job in walks.items()}
    times = interleaved(walks, repeats, time.thread_time)
    return {name: (times[name] / times["bare"], float(counts[name] / counts["bare"])) for name in walks}


def compare(quick: bool = False) -> dict[str, Ratios]:
    """`ratios` for every sand; quick: for one, of two feet."""
    if quick:
        return {SANDS[-1]: ratios(SANDS[-1], 2, 1, QUICK)}
    return {sand: ratios(sand, 30, 9, tuple(SETS)) for sand in SANDS}


def main() -> None:
    """Print the table."""
    found = compare(quick=arguments(__doc__).parse_args().quick)
    print("| over the bare walk | " + " | ".join(f"{sand}: time | evaluations" for sand in found) + " |")
    print("| --- |" + " --- | --- |" * len(found))
    for name in found[SANDS[-1]]:
        row = (f"{of_sand[name][0]:.3f} | {of_sand[name][1]:.3f}" for of_sand in found.values())
        print(f"| {name} | " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
