"""Every benchmark as one Markdown table of ratios, for the README.

python benchmarks/report.py            # all of it, about five minutes
python benchmarks/report.py plates ga  # some of it
python benchmarks/report.py --quick    # all of it, once, small and on one sand: does it run?
"""

from __future__ import annotations

import platform
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

import against_numpy
import effects
import equal_accuracy
import growth
import numba
import numpy as np
import overhead
import plate_loop
import startup
from measure import SANDS, arguments, feet, interleaved, processor, scene

import footopt as fo
from footopt.walk.loop import at_once

Row = tuple[str, str, str]  # what, measured, aim


def paper(quick: bool) -> Iterator[Row]:
    """1: the paper's algorithm in numpy."""
    sizes = (2, 1, 2e-3) if quick else (8, 3, 1e-4)
    for sand in SANDS[-1:] if quick else SANDS:
        c = against_numpy.compare(feet(2 if quick else 30), scene(sand), *sizes)
        yield (
            f"the paper's algorithm in numpy, {sand} sand, one core",
            f"**{c.numpy / c.footopt:,.0f}** times faster ({c.numpy:.2f} s and {1e3 * c.footopt:.2f} ms per "
            f"design; error {c.numpy_error:.2f} % and {c.error:.2f} %, `{c.preset}`)",
            ">= 1,000",
        )
        yield (
            f"... vectorised over {sizes[0]} designs too, {sand} sand",
            f"{c.batch / c.footopt:,.0f} times faster ({c.batch:.2f} s per design)",
            "",
        )


def euler(quick: bool) -> Iterator[Row]:
    """2: explicit Euler, compiled, at equal accuracy."""
    aims = {("hard", 0.5): ">= 5", ("hard", 0.05): ">= 20"}
    k, sizes = (feet(2), (1, 1)) if quick else (feet(30), (5, 5))
    for target in (5.0,) if quick else (0.5, 0.05):
        for sand in SANDS[-1:] if quick else SANDS:
            found, times = equal_accuracy.compare(scene(sand), k, target, *sizes)
            best = min(("fixed", "controlled"), key=lambda name: times[name])
            each = ", ".join(f"{1e3 * times[name]:.2f} {name}" for name in times)
            yield (
                f"explicit Euler, compiled too, at {target:g} %, {sand} sand",
                f"**{times['explicit'] / times[best]:.1f}** times faster (ms per design: {each}; steps of "
                f"{1e3 * found['explicit'].dt:.3g} and {1e3 * found['fixed'].dt:.3g} ms, control "
                f"{found['controlled'].control:.1g} m/s)",
                aims.get((sand, target), ""),
            )


def absolute(quick: bool) -> Iterator[Row]:
    """3: milliseconds per design and core at `standard`."""
    k, cores = feet(4 if quick else 320), min(2, at_once())
    jobs = {
        f"{sand} {threads}": lambda sand=sand, threads=threads: fo.evaluate(k, scene(sand), threads=threads)
        for sand in SANDS
        for threads in sorted({1, cores})
    }
    clocks, repeats = (time.perf_counter, time.process_time), 1 if quick else 9
    wall, busy = (interleaved(jobs, repeats, clock) for clock in clocks)
    for threads in sorted({1, cores}):
        each = [1e3 * threads * wall[f"{sand} {threads}"] / len(k) for sand in SANDS]
        listed = ", ".join(f"{sand} {ms:.2f}" for sand, ms in zip(SANDS, each, strict=True))
        on = 1e3 * np.mean([busy[f"{sand} {threads}"] for sand in SANDS]) / len(k)
        yield (
            f"ms per design and core at `standard`, {threads} thread{'s'[: threads - 1]}",
            f"**{np.mean(each):.2f}** ({listed}; {on:.2f} of processor time)",
            "<= .35",
        )


def plates(quick: bool) -> Iterator[Row]:
    """4: the plate loop and a C loop vectorised by hand."""
    with tempfile.TemporaryDirectory() as folder:
        library = plate_loop.build(Path(folder))
        if isinstance(library, str):
            yield "the plate loop and a C loop by hand", f"skipped: {library}", "<= 1.3"
            return
        for jacobian, n in product((False, True), (16, 64)):
            ours, theirs, ratio = plate_loop.compare(library, n, jacobian, *((1, 1000) if quick else ()))
            yield (
                f"a C loop by hand, {n} plates, {'with' if jacobian else 'without'} Jacobian",
                f"**{ratio:.2f}** times its time ({ours:.2f} and {theirs:.2f} ns per submerged plate)",
                "<= 1.3",
            )


def size(quick: bool) -> Iterator[Row]:
    """5: growth, threads and memory."""
    small = {"designs": 4, "repeats": 1} if quick else {}
    for name, measured in (
        ("designs", growth.in_designs((10, 20), 1) if quick else growth.in_designs()),
        ("plates", growth.in_plates(growth.PLATES[:2] if quick else growth.PLATES, **small)),
        ("duration", growth.in_duration(growth.DURATION[:2] if quick else growth.DURATION, **small)),
    ):
        power, times = measured
        low, high = min(times), max(times)
        yield (
            f"growth in {name}, from {low:g} to {high:g}",
            f"power **{power:.2f}** ({times[high] / times[low]:.1f} times for {high / low:.1f})",
            "1",
        )
    if at_once() >= 2:
        faster, busy = growth.in_threads(**small)
        yield (
            "two threads",
            f"**{faster:.2f}** times faster than one ({busy:.2f} times its processor time)",
            ">= 1.85",
        )
    designs = 100 if quick else 100_000
    large = growth.large_call(designs)
    yield (
        f"{designs:,} designs in one call, `draft`",
        f"**{large['peak']:.0f} MB** at the peak, {large['before']:.0f} MB before; {large['seconds']:.0f} s",
        "< 1,000 MB",
    )


def start(quick: bool) -> Iterator[Row]:
    """6: start-up."""
    names = tuple(startup.WARM)
    times = startup.warm(names[:2], 1) if quick else startup.warm(names)
    code = startup.SMALL if quick else startup.FIRST
    empty = times["an empty interpreter"]
    aims = {"footopt --help": "<= 1 s", "import footopt": "<= .3 s"}
    for name, value in times.items():
        less = "" if value == empty else f" ({value / empty:.1f} times an empty interpreter)"
        yield name, f"**{value:.2f} s**{less}", aims.get(name, "")
    first, cached = startup.first_compilation(code)
    yield "first evaluation, nothing compiled", f"**{first:.1f} s**, {cached:.2f} s the next time", "<= 30 s"
    places = {True: "read-only package", False: "read-only package and home"}
    for home, name in places.items():
        if quick and not home:
            continue
        found = startup.read_only(home, code)
        told = (
            found
            if isinstance(found, str)
            else f"{found[0]:.1f} s, **{found[1]:.2f} s** the next time (in {', '.join(found[2])})"
        )
        yield f"first evaluation, {name}", told, "cached"


def ga(quick: bool) -> Iterator[Row]:
    """7: the share of a GA run outside the compiled walk."""
    for threads in range(1, min(2, at_once()) + 1):
        shares, wall = overhead.search_shares(threads, *((6, 2) if quick else ()))
        listed = ", ".join(f"{name} {100 * v:.1f}" for name, v in shares.items() if name != "kernel")
        yield (
            f"default GA run outside the walk, {threads} thread{'s'[: threads - 1]}",
            f"**{100 * (1.0 - shares['kernel']):.0f} %** of {wall:.1f} s ({listed})",
            "",
        )


def scenes(quick: bool) -> Iterator[Row]:
    """8: what effects cost where a scene names them."""
    for sand, found in effects.compare(quick=quick).items():
        sets = [name for name in effects.SETS if name in found]
        added = [f"{name} {found[name][0]:.2f} ({found[name][1]:.2f})" for name in sets]
        yield (
            f"time (evaluations) with effects over the bare walk's, {sand} sand",
            ", ".join(added[1:]),
            "",
        )


PARTS: dict[str, Callable[[bool], Iterator[Row]]] = {
    f.__name__: f for f in (paper, euler, absolute, plates, size, start, ga, scenes)
}


def main() -> None:
    """Print the table."""
    parser = arguments(__doc__)
    parser.add_argument("parts", nargs="*", help=f"any of {', '.join(PARTS)}; all by default")
    given = parser.parse_args()
    names = given.parts or list(PARTS)
    if unknown := [name for name in names if name not in PARTS]:
        parser.error(f"unknown: {', '.join(unknown)}; known: {', '.join(PARTS)}")
    words = [*(["--quick"] if given.quick else []), *(names if names != list(PARTS) else [])]
    command = " ".join(["python benchmarks/report.py", *words])
    print(
        f"`{command}`: {processor()}, {at_once()} cores, python {platform.python_version()}, "
        f"numba {numba.__version__}, numpy {np.__version__}, footopt {fo.__version__}.\n"
    )
    print("| footopt against | measured | aim |\n| --- | --- | --- |")
    for name in names:
        for row in PARTS[name](given.quick):
            print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
