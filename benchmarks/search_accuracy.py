"""Does a search at a coarse accuracy, confirmed at a fine one, find what a fine search finds?

`python benchmarks/search_accuracy.py` prints the table of docs/accuracy.md (about 3 minutes);
with --quick, tiny searches with one seed.
"""

import time

import numpy as np
from measure import SANDS, arguments

import footopt as fo
from footopt.design import confirm

SEEDS = (1, 2, 3, 4)


def main() -> None:
    """Best and median J_W over the seeds, at `fine` after confirmation, and the median time."""
    quick = arguments(__doc__).parse_args().quick
    seeds, budget = (SEEDS[:1], {"pop_size": 10, "n_gen": 2}) if quick else (SEEDS, {})
    print("| sand | search at | best J_W | median J_W | largest change of a value | seconds |")
    print("| --- | --- | --- | --- | --- | --- |")
    for sand in SANDS:
        for accuracy in ("draft", "standard", "fine"):
            problem = fo.FootProblem(fo.Scene(sand=fo.Sand.named(sand)), accuracy=accuracy)
            j, change, seconds = [], [], []
            for seed in seeds:
                started = time.perf_counter()
                confirmed = confirm(fo.search(problem, "ga", seed=seed, **budget), "fine")
                seconds.append(time.perf_counter() - started)
                j.append(confirmed.values[0][problem.record.index("efficiency")])
                change.append(confirmed.largest_change)
            print(
                f"| {sand} | {accuracy} | {min(j):.3e} | {np.median(j):.3e} | "
                f"{100 * max(change):.2g} % | {np.median(seconds):.1f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
