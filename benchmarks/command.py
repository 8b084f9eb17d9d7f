"""Time of the default command: warm, with nothing compiled, and in turn with that of another checkout.

python benchmarks/command.py          # about a minute
python benchmarks/command.py FOLDER   # beside another checkout of footopt, such as the last release's
python benchmarks/command.py --quick  # does it run?

By the clock and of all processors, processes of their own with all that Python's start and end take. What is
warm is run in turn, after a run that is not counted; each number is the median of three.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measure import arguments

HERE = Path(__file__).resolve().parents[1]

#: What a process runs: `python -m footopt`, which says at its end how long it has compiled.
COMMAND = """
import atexit, runpy
from numba.core import event
compiling = event.TimingListener()
event.register("numba:compile", compiling)
atexit.register(lambda: print("compiled for", compiling.duration if compiling.done else 0.0))
runpy.run_module("footopt", run_name="__main__", alter_sys=True)
"""


def run(checkout: Path, words: list[str], **environment: str) -> tuple[float, float, float]:
    """Seconds by the clock, of all processors, and of compiling."""
    env = {**os.environ, "PYTHONPATH": str(checkout), **environment}
    with tempfile.TemporaryDirectory() as folder:
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        given = [sys.executable, "-c", COMMAND, f"hydra.run.dir={folder}/run", *words]
        done = subprocess.run(given, cwd=folder, env=env, check=True, capture_output=True, text=True)
        clock, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return clock, used, float(done.stdout.rsplit(maxsplit=1)[-1])


def main() -> None:
    parser = arguments(str(__doc__))
    parser.add_argument("folder", nargs="?", type=Path, help="another checkout")
    given = parser.parse_args()
    words = ["solver.walks=60"] if given.quick else []
    checkouts = {"here": HERE} | ({"there": given.folder.resolve()} if given.folder else {})
    for checkout in checkouts.values():
        run(checkout, words)
    times: dict[str, list[tuple[float, ...]]] = {name: [] for name in checkouts}
    for _ in range(1 if given.quick else 3):
        for name, checkout in checkouts.items():
            times[name].append(run(checkout, words))
    if not given.quick:
        with tempfile.TemporaryDirectory() as cache:
            times["here, nothing compiled"] = [run(HERE, words, NUMBA_CACHE_DIR=cache)]
    print("| the command | by the clock (s) | of processors (s) | of it compiling (s) |")
    print("| --- | --- | --- | --- |")
    for name, rows in times.items():
        print(
            f"| {name} | "
            + " | ".join(f"{statistics.median(column):.1f}" for column in zip(*rows, strict=True))
            + " |"
        )
    if given.folder:
        for i, what in enumerate(("clock", "processors")):
            ratios = [there[i] / here[i] for here, there in zip(times["here"], times["there"], strict=True)]
            print(f"{what}: there over here", *(f"{ratio:.2f}" for ratio in ratios))


if __name__ == "__main__":
    main()
