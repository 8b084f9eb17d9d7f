"""What an executor costs on top of walking: the same batch here and by workers, as many as threads here.

python benchmarks/engines.py  # a table; with --quick, one small batch
"""

from __future__ import annotations

import pickle
import statistics
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import ExitStack

from measure import arguments, feet

import footopt as fo
from footopt.design import Evaluator, make_executor
from footopt.design.executor import Chunks, Walked, attempt, walk_chunk
from footopt.walk.simulate import available_threads

BATCHES, CHUNKS = (200, 20_000), 200


def overheads(
    names: tuple[str, ...], designs: int, repeats: int, cores: int
) -> dict[str, tuple[float, float]]:
    """Time of a batch by each engine: a ratio to `local` in the same round (median), and s (median).

    Every round has all engines in turn, so that what slows the machine slows all.
    """
    problem = fo.FootProblem(threads=cores)
    times: dict[str, list[float]] = {name: [] for name in ("local", *names)}
    with ExitStack() as stack:
        walks = {"local": Evaluator(problem)}
        for name in names:
            walks[name] = Evaluator(problem, None, stack.enter_context(make_executor(name, cores)))
        k = feet(designs)
        for walk in walks.values():
            for _ in range(2):  # the first sends the problem, the second knows what a design costs
                walk(k)
        for _ in range(repeats):
            for name, walk in walks.items():
                start = time.perf_counter()
                walk(k)
                times[name].append(time.perf_counter() - start)
    return {
        name: (
            statistics.median(a / b for a, b in zip(times[name], times["local"], strict=True)),
            statistics.median(times[name]),
        )
        for name in names
    }


def fixed(name: str, chunks: int, repeats: int, cores: int) -> float:
    """Time that a chunk takes without its walking, s: many chunks of one design at once, less their walks."""
    problem = fo.FootProblem(threads=1, accuracy="draft")
    found = []
    with make_executor(name, cores) as executor:
        assert isinstance(executor, Executor)
        sent = Chunks(problem, executor)._sent
        for _ in range(repeats + 1):
            start = time.perf_counter()
            futures = [executor.submit(walk_chunk, *sent, row[None]) for row in feet(chunks)]
            walking = sum(future.result().seconds for future in futures) / cores
            found.append((time.perf_counter() - start - walking) / chunks)
    return statistics.median(found[1:])


def wire(designs: int = 100) -> tuple[float, float, int]:
    """Bytes a design out and back, in chunks of so many, and of the problem, once a chunk."""
    problem, k = fo.FootProblem(), feet(designs)
    found = attempt(problem, k)
    assert isinstance(found, Walked)
    (_, content) = Chunks(problem, Executor())._sent
    return len(pickle.dumps(k)) / designs, len(pickle.dumps(found)) / designs, len(content)


def rows(batches: tuple[int, ...], chunks: int, repeats: int, cores: int) -> Iterator[tuple[str, str]]:
    """What was measured, as rows of a table."""
    names = ("processes", "dask")
    for designs in batches:
        for name, (ratio, seconds) in overheads(names, designs, repeats, cores).items():
            yield f"{name}, {designs:,} designs", f"{ratio:.2f} times `local` ({seconds:.3f} s)"
    for name in names:
        yield f"{name}, a chunk without its walks", f"{1e3 * fixed(name, chunks, repeats, cores):.2f} ms"
    out, back, problem = wire()
    yield (
        "on the wire",
        f"{out:.0f} bytes a design out, {back:.0f} back; {problem:,} for the problem, once a chunk",
    )


def main() -> None:
    """Print the table."""
    parser = arguments(__doc__)
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--cores", type=int, default=min(2, available_threads()))
    given = parser.parse_args()
    print("| engine | measured |\n| --- | --- |")
    sizes = ((20,), 10, 1, 1) if given.quick else (BATCHES, CHUNKS, given.repeats, given.cores)
    for row in rows(*sizes):
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
