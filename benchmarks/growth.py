"""How the time of an evaluation grows with designs, plates and duration; and its memory.

Run as a program with a number of designs, it evaluates them in one call and prints its peak memory.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from measure import exponent, interleaved

import footopt as fo
from footopt.walk.accuracy import PRESETS
from footopt.walk.ladder import numerics

DESIGNS = (100, 200, 400, 800, 1600, 3200)
PLATES = (32, 64, 128, 256, 512)
DURATION = (2.9, 5.3, 10.1, 19.7)  # two to sixteen strides, s


def _fit(jobs: dict[float, Callable[[], object]], repeats: int) -> tuple[float, dict[float, float]]:
    times = interleaved({str(size): job for size, job in jobs.items()}, repeats)
    by_size = {size: times[str(size)] for size in jobs}
    return exponent(np.array(list(by_size)), np.array(list(by_size.values()))), by_size


def in_designs(sizes: Sequence[int] = DESIGNS, repeats: int = 5) -> tuple[float, dict[float, float]]:
    """Exponent, and seconds by the number of designs."""
    scene, k = fo.Scene(), fo.Waypoints().random(max(sizes), 1)
    return _fit({n: lambda n=n: fo.evaluate(k[:n], scene, threads=1) for n in sizes}, repeats)


def in_plates(
    sizes: Sequence[int] = PLATES, designs: int = 100, repeats: int = 5
) -> tuple[float, dict[float, float]]:
    """Exponent, and seconds by the number of plates."""
    scene, space = fo.Scene(), fo.Waypoints()
    k, standard = space.random(designs, 1), numerics(PRESETS["standard"], scene, space)
    return _fit(
        {n: lambda n=n: fo.evaluate(k, scene, replace(standard, plates=n), threads=1) for n in sizes}, repeats
    )


def in_duration(
    sizes: Sequence[float] = DURATION, designs: int = 100, repeats: int = 5
) -> tuple[float, dict[float, float]]:
    """Exponent, and seconds by the time walked."""
    k = fo.Waypoints().random(designs, 1)
    return _fit({t: lambda t=t: fo.evaluate(k, fo.Scene(t_f=t), threads=1) for t in sizes}, repeats)


def in_threads(designs: int = 800, repeats: int = 15) -> tuple[float, float]:
    """How much faster two threads are than one, and the processor time they take over one's.

    On a machine that is busy with other work, the first is small and the second still 1.
    """
    scene, k = fo.Scene(), fo.Waypoints().random(designs, 1)
    jobs = {str(n): lambda n=n: fo.evaluate(k, scene, threads=n) for n in (1, 2)}
    wall, busy = (interleaved(jobs, repeats, clock) for clock in (time.perf_counter, time.process_time))
    return wall["1"] / wall["2"], busy["2"] / busy["1"]


def large_call(designs: int) -> dict[str, float]:
    """Evaluate many designs in one call of a process of its own: s, and MB before and at its peak."""
    out = subprocess.run(
        [sys.executable, str(Path(__file__)), str(designs)], capture_output=True, text=True, check=True
    ).stdout
    result: dict[str, float] = json.loads(out)
    return result


def _peak() -> float:
    """Largest resident memory of this process so far, MB."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage counts that of the process it was started from as well
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return int(line.split()[1]) * 1024 / 1e6
    unit = 1 if sys.platform == "darwin" else 1024  # bytes there, kB elsewhere
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


if __name__ == "__main__":
    k = fo.Waypoints().random(int(sys.argv[1]), 1)
    fo.evaluate(k[:2], accuracy="draft")
    before, start = _peak(), time.perf_counter()
    table = fo.evaluate(k, accuracy="draft")
    print(json.dumps({"seconds": time.perf_counter() - start, "before": before, "peak": _peak()}))
