"""What an engine costs on top of walking: the same batch here and by workers, as many as threads here.

python benchmarks/engines.py  # a table; with --quick, one small batch
"""

from __future__ import annotations

import pickle
import statistics
import time
from collections.abc import Iterator
from contextlib import ExitStack

from footopt.design.workers import WALKED, Reply, Task
from measure import arguments, feet

import footopt as fo
from footopt.design import Engine, make_engine
from footopt.walk.simulate import available_threads

BATCHES, CHUNKS = (200, 20_000), 200


def overheads(
    names: tuple[str, ...], designs: int, repeats: int, cores: int
) -> dict[str, tuple[float, float]]:
    """Time of a batch by each engine: a ratio to `local` in the same round (median), and s (median).

    Every round has other designs and all engines in turn, so that what slows the machine slows all.
    """
    problem = fo.FootProblem(threads=cores)
    times: dict[str, list[float]] = {name: [] for name in ("local", *names)}
    with ExitStack() as stack:
        engines: dict[str, Engine] = {"local": make_engine()}
        for name in names:
            engines[name] = stack.enter_context(make_engine(name, cores))
        k = feet(designs)
        for engine in engines.values():
            for _ in range(2):  # the first sends the problem, the second knows what a design costs
                engine.walk(problem, k)
        for _ in range(repeats):
            for name, engine in engines.items():
                start = time.perf_counter()
                engine.walk(problem, k)
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
    k = feet(chunks)
    found = []
    with make_engine(name, cores) as engine:
        assert hasattr(engine, "run")
        engine.walk(problem, k)
        tasks = [engine._task._replace(k=row[None]) for row in k]  # type: ignore[attr-defined]
        engine.run(tasks)
        for _ in range(repeats):
            start = time.perf_counter()
            replies = engine.run(tasks)
            walking = sum(reply.seconds for reply in replies) / cores
            found.append((time.perf_counter() - start - walking) / chunks)
    return statistics.median(found)


def wire(designs: int = 100) -> tuple[float, float, int]:
    """Bytes a design out and back, in chunks of so many, and of the problem, once a worker."""
    problem, k = fo.FootProblem(), feet(designs)
    out = len(pickle.dumps(Task("0" * 64, None, k)))
    back = len(pickle.dumps(Reply(WALKED, problem.walk(k), 1.0)))
    return out / designs, back / designs, len(pickle.dumps(problem))


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
        f"{out:.0f} bytes a design out, {back:.0f} back; {problem:,} for the problem, once a worker",
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
