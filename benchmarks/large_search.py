"""How the memory of a search of five objectives, and the time of its generations, grow with evaluations.

Walks cost nothing here: what is measured is the search around them. `python benchmarks/large_search.py
1000000` searches by NSGA-II, or by the solver that is named after the number, keeps every design in a store,
and writes and confirms the designs; with `whole` after them the command footopt does it, with its figures
and its page.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from growth import _peak

import footopt as fo
from footopt.design import confirm, search
from footopt.files.io import write_csv

SIZE = 200  # designs a generation


class Cheap(fo.FootProblem):
    """Five objectives that contradict each other, for nothing: distances of the heights from five points."""

    def walk(self, k):
        centres = np.random.default_rng(1).uniform(1.0, self.space.K, size=(len(self.record), self.space.n))
        apart = ((k[:, None, :] - centres) ** 2).sum(axis=2) / self.space.n
        signs = np.array([-1.0 if name in ("distance", "mean_height") else 1.0 for name in self.record])
        return signs * apart, np.full(len(k), "")


def measured(evaluations: int, folder: Path, solver: str = "nsga2") -> dict[str, object]:
    """Search, confirm and write; processor time a generation and MB at powers of two of the evaluations."""
    problem = Cheap(objective="pareto", space=fo.Waypoints(box_tolerance=np.inf))
    rows: list[dict[str, float]] = []
    mark, last = SIZE, (0, time.process_time())

    def note(g) -> None:
        nonlocal mark, last
        if g.evaluations >= mark or g.evaluations >= evaluations:
            now = time.process_time()
            each = (now - last[1]) / (g.generation - last[0])
            rows.append({"evaluations": g.evaluations, "front": g.front, "ms": 1e3 * each, "MB": _peak()})
            mark, last = 2 * mark, (g.generation, now)
            print(json.dumps(rows[-1]), flush=True)

    before = _peak()
    generations = evaluations // SIZE
    result = search(
        problem, solver, note, folder / "designs.sqlite", pop_size=SIZE, n_gen=generations, seed=1
    )
    searched = _peak()
    started = time.perf_counter()
    write_csv(folder / "designs.csv", result.columns)
    confirmed = confirm(result, "fine")
    return {
        "before": before, "searched": searched, "written": _peak(), "designs": result.designs,
        "confirmed": len(confirmed.designs), "write_s": time.perf_counter() - started,
    }  # fmt: skip


def whole(evaluations: int, folder: Path, solver: str = "nsga2") -> None:
    """The command with such walks, from its first word to its page."""
    from footopt.cli.main import main

    fo.FootProblem.walk = Cheap.walk
    search_of = [
        f"solver={solver}",
        f"solver.pop_size={SIZE}",
        f"solver.walks={evaluations}",
        "objective=pareto",
    ]
    sys.argv = ["footopt", *search_of, "foot.box_tolerance=1", "accuracy=draft", f"hydra.run.dir={folder}"]
    main()
    for file in sorted(folder.rglob("*.*")):
        print(f"{file.relative_to(folder)}: {file.stat().st_size / 1e6:.1f} MB")
    print(f"{_peak():.0f} MB, {time.process_time():.0f} s of processor time")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        named = [word for word in sys.argv[2:3] if word != "whole"]
        if "whole" in sys.argv:
            whole(int(sys.argv[1]), Path(place) / "run", *named)
        else:
            print(json.dumps(measured(int(sys.argv[1]), Path(place), *named)))
