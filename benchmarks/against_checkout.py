"""Time per design of this checkout over that of another, walk for walk in turn, and whether results agree.

python benchmarks/against_checkout.py FOLDER  # another checkout of footopt, such as the last release's

Each checkout walks in processes of its own. The same source compiled twice may differ by 5 to 9 % in time,
by how its machine code happens to lie; --processes many of each give the median.

--errors adds both errors on the three sands (worst objective, 95 % of the feet, each against its own
converged walks); --here DT CONTROL PLATES [CREEP] walks here with a setting in place of `standard`: given
once, or for soft, regular and hard sand, so that both have the same error on each. --seed draws other feet.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parents[1]

#: What a checkout's process runs: a line of input walks every case once, a line of output has the ms each.
WALKER = """
import sys, time
import numpy as np
import footopt as fo

feet = fo.Waypoints().random(int(sys.argv[1]), seed=int(sys.argv[4]), inside=True)
given = [one.split() for one in sys.argv[2].split(",") if one]
own = [
    fo.Accuracy("sdirk2", float(dt), int(n), *map(float, creep), control=float(held))
    for dt, held, n, *creep in given
]
own = own * (3 // len(own)) if own else ["standard"] * 3
sands = [fo.Scene(sand=fo.Sand.named(name)) for name in ("soft", "regular", "hard")]
full = fo.Scene(sand=fo.Sand.named("regular"), effects=(fo.LeadingEdge(), fo.Inertia()))
steppers = [fo.Accuracy(name, 1e-3, 64) for name in ("explicit_euler", "heun")]
cases = list(zip(sands, own)) + [(full, "standard")] + [(sands[1], a) for a in steppers]

def walk(scene, accuracy):
    started = time.thread_time()
    table = fo.evaluate(feet, scene, accuracy, threads=1)
    return 1e3 * (time.thread_time() - started) / len(feet), float(np.nansum(table.values))

for scene, accuracy in cases:  # compiled, poses made
    fo.evaluate(feet[:1], scene, accuracy, threads=1)
print("ready", flush=True)
if sys.argv[3]:
    limit = fo.Accuracy("sdirk2", 2e-4, 400, 1e-5)
    for scene, accuracy in cases[:3]:
        truth = fo.evaluate(feet, scene, limit).values
        error = abs(fo.evaluate(feet, scene, accuracy).values / truth - 1).max(axis=1)
        print(100 * np.percentile(error, 95), flush=True)
for _ in sys.stdin:
    print(*(number for case in cases for number in walk(*case)), flush=True)
"""
NAMES = ("soft", "regular", "hard", "two effects", "explicit Euler", "Heun")


class Walker:
    """A process that walks with one checkout's code."""

    def __init__(self, folder: Path, feet: int, setting: str, errors: bool, seed: int) -> None:
        environment = os.environ | {"PYTHONPATH": str(folder)}
        run = [sys.executable, "-c", WALKER, str(feet), setting, "errors" if errors else "", str(seed)]
        self.process = subprocess.Popen(
            run, env=environment, cwd=folder, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        assert self._line() == "ready"
        self.errors = [float(self._line()) for _ in range(3 if errors else 0)]  # %

    def _line(self) -> str:
        assert self.process.stdout is not None
        return self.process.stdout.readline().strip()

    def walk(self) -> tuple[list[float], list[float]]:
        """Time per design of every case, ms, and the sum of its results."""
        assert self.process.stdin is not None
        self.process.stdin.write("walk\n")
        self.process.stdin.flush()
        numbers = [float(word) for word in self._line().split()]
        return numbers[::2], numbers[1::2]

    def close(self) -> None:
        """End the process."""
        self.process.communicate()


def compare(
    other: Path,
    feet: int = 60,
    repeats: int = 15,
    setting: str = "",
    errors: bool = False,
    seed: int = 7,
) -> tuple[np.ndarray, list[bool], list[list[float]]]:
    """Median ms per design, (here and there, cases), which cases' results are the same, and both errors."""
    walkers = [Walker(HERE, feet, setting, errors, seed), Walker(other, feet, "", errors, seed)]
    found = [[walker.walk() for walker in walkers] for _ in range(repeats)]
    for walker in walkers:
        walker.close()
    ms = np.median([[times for times, _ in pair] for pair in found], axis=0)
    (_, here), (_, there) = found[0]
    return ms, [a == b for a, b in zip(here, there, strict=True)], [w.errors for w in walkers]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="the other checkout")
    parser.add_argument("--processes", type=int, default=3, help="pairs of processes")
    parser.add_argument("--errors", action="store_true", help="measure both errors, too")
    parser.add_argument("--here", nargs="+", default=[], action="append", metavar="DT", help="see above")
    parser.add_argument("--seed", type=int, default=7, help="of the feet")
    parser.add_argument("--quick", action="store_true", help="everything once and small: does it all run?")
    given = parser.parse_args()
    sizes = (2, 1) if given.quick else (60, 15)
    folder, setting = given.folder.resolve(), ",".join(map(" ".join, given.here))
    pairs = [
        compare(folder, *sizes, setting, given.errors and pair == 0, given.seed)
        for pair in range(1 if given.quick else given.processes)
    ]
    ratios = np.median([ms[0] / ms[1] for ms, _, _ in pairs], axis=0)
    here, there = np.median([ms for ms, _, _ in pairs], axis=0)
    print("| walk | here, ms | there, ms | ratio | same results |\n| --- | --- | --- | --- | --- |")
    for i, name in enumerate(NAMES):
        same = "yes" if all(equal[i] for _, equal, _ in pairs) else "no"
        print(f"| {name} | {here[i]:.3f} | {there[i]:.3f} | {ratios[i]:.3f} | {same} |")
    for where, errors in zip(("here", "there"), pairs[0][2], strict=True):
        if errors:
            print(f"error {where}, %: " + ", ".join(f"{e:.3f}" for e in errors))


if __name__ == "__main__":
    main()
