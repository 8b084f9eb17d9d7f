"""How the benchmarks measure: interleaved repeats, medians, ratios; feet, scenes and errors."""

from __future__ import annotations

import argparse
import platform
import time
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import footopt as fo

Array = NDArray[np.float64]

SANDS = ("soft", "regular", "hard")
SEED = 7


def scene(sand: str) -> fo.Scene:
    """The paper's walk on a sand."""
    return fo.Scene(sand=fo.Sand.named(sand))


@lru_cache
def feet(designs: int) -> NDArray[np.int64]:
    """Random waypoint feet inside the box, (designs, n)."""
    return fo.Waypoints().random(designs, SEED, inside=True)


def interleaved(
    jobs: Mapping[str, Callable[[], object]], repeats: int, clock: Callable[[], float] = time.perf_counter
) -> dict[str, float]:
    """Median time of each job, s: in turn, so that what slows the machine slows all of them.

    clock : wall time, or `time.process_time` for that of all the process's threads on processors.
    """
    for job in jobs.values():
        job()
    times = {name: np.empty(repeats) for name in jobs}
    for repeat in range(repeats):
        for name, job in jobs.items():
            start = clock()
            job()
            times[name][repeat] = clock() - start
    return {name: float(np.median(values)) for name, values in times.items()}


def error(values: Array, exact: Array) -> float:
    """Largest relative error of an objective: its 95th percentile over the designs, in %.

    Infinite where a walk failed.
    """
    worst = np.max(np.abs(values / exact - 1.0), axis=1)
    return 100.0 * float(np.percentile(np.where(np.isfinite(worst), worst, np.inf), 95, method="higher"))


def arguments(description: str) -> argparse.ArgumentParser:
    """The command line of a benchmark."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="everything once and small: does it all run?")
    return parser


def exponent(sizes: Array, times: Array) -> float:
    """p of time ~ size^p, by least squares in the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])


def processor() -> str:
    """The processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown")
