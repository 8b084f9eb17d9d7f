"""What an accuracy means for a decision: feet ranked wrongly, whole searches, and orders of convergence."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as RichTable

from footopt.design import FootProblem, confirm, search
from footopt.effects import Rest
from footopt.foot import Waypoints
from footopt.report import terminal
from footopt.walk import Accuracy, Scene, evaluate

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

ASKED = ("draft", "standard", "fine")  # presets that search
CONFIRM = "fine"  # what their finalists are walked again at
FINALISTS = 20
SEEDS = (1, 2, 3)
RIGHT = 0.02  # of the pairs of finalists that a right ranking may turn round
SAFETY = 1.25  # of the grid convergence index on three grids (Roache, J. Fluids Eng. 116, 1994)

#: Three grids of each knob, each twice as fine as the one before.
GRIDS = {
    "time step": [Accuracy("sdirk2", dt, 64) for dt in (2e-3, 1e-3, 5e-4)],
    "plates": [Accuracy("sdirk2", 1e-3, n) for n in (64, 128, 256)],
    "creep speed": [Accuracy("sdirk2", 1e-3, 128, creep) for creep in (4e-4, 2e-4, 1e-4)],
}
LENGTHS = (4e-6, 2e-6, 1e-6)  # delta of effects=rest, m

#: Starts a process that walks once; the first one with an empty cache compiles the walk.
ONCE = "import footopt as fo; fo.evaluate([[5] * 11, [6] * 11])"


@dataclass(frozen=True, eq=False)
class Search:
    """One whole search: at a preset, its finalists confirmed.

    Parameters
    ----------
    preset, sand : str
        Where it searched.
    seed : int
        Of the solver.
    finalists : (finalists, n)
        Heights, the answer first.
    search_s, confirm_s : float, s
        Processor time: wall time on one free core, whatever else the machine does.
    """

    preset: str
    sand: str
    seed: int
    finalists: Ints
    search_s: float
    confirm_s: float


def searches(
    scenes: Sequence[Scene],
    space: Waypoints,
    threads: int | None,
    seeds: Sequence[int],
    step: Callable[[str], None],
    **budget: Any,
) -> list[Search]:
    """Search each scene at each of the presets `ASKED` by each seed.

    Parameters
    ----------
    scenes : sequence of Scene
        One on each sand.
    space : Waypoints
        Where.
    threads : int, optional
        That walk.
    seeds : sequence of int
        Of the solver.
    step : callable
        Told what was done.
    **budget
        The solver's pop_size and n_gen; its own by default.
    """
    found = []
    for scene in scenes:
        for preset in ASKED:
            problem = FootProblem(scene, space=space, accuracy=preset, threads=threads)
            for seed in seeds:
                times = [time.process_time()]
                result = search(problem, "memetic", seed=seed, **budget)
                times.append(time.process_time())
                k = result.k[confirm(result, CONFIRM, FINALISTS).designs]
                times.append(time.process_time())
                found.append(Search(preset, scene.sand.name, seed, k, *map(float, np.diff(times))))
                step(f"search at {preset} on {scene.sand.name} sand")
    return found


def finalists_of(found: Sequence[Search], scenes: Sequence[Scene], preset: str = "standard") -> list[Ints]:
    """The finalists of the first search on each sand at a preset, (finalists, n) each."""
    first = {s.sand: s.finalists for s in reversed(found) if s.preset == preset}
    return [first[scene.sand.name] for scene in scenes]


def lost(found: Sequence[Search], scenes: Sequence[Scene], limit: Accuracy, **how: Any) -> list[float]:
    """Share of J_W that each search's answer lacks against the best answer of all on its sand."""
    values = np.empty(len(found))
    for scene in scenes:
        own = [i for i, s in enumerate(found) if s.sand == scene.sand.name]
        answers, place = np.unique([found[i].finalists[0] for i in own], axis=0, return_inverse=True)
        j = evaluate(answers, scene, limit, ("efficiency",), **how).values[:, 0]
        values[own] = (1.0 - j / j.min())[place.ravel()]
    return [float(value) for value in values]


def wrong(values: Array, truth: Array) -> float:
    """Share of all pairs of feet that values (feet,) rank otherwise than the truth; NaN for no pair."""
    first, second = np.triu_indices(len(truth), 1)
    if not len(first):
        return math.nan
    with np.errstate(invalid="ignore"):
        turned = np.sign(values[first] - values[second]) != np.sign(truth[first] - truth[second])
    return float(turned.mean())


def compile_seconds() -> float:
    """Processor time of compiling the walk, s: of a start with an empty cache, less that of the next."""
    times = []
    with tempfile.TemporaryDirectory() as cache:
        for _ in range(2):
            before = os.times()
            environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
            subprocess.run([sys.executable, "-c", ONCE], check=True, env=environment, capture_output=True)
            after = os.times()
            times.append(after[2] - before[2] + after[3] - before[3])  # of processes that have ended
    return times[0] - times[1]


def rows(
    measured: Sequence[Any], found: Sequence[Search], loss: Sequence[float], compile_s: float
) -> list[Any]:
    """What each of the presets `ASKED` costs and decides, by name.

    Parameters
    ----------
    measured : sequence of footopt.studies.accuracy.Measurement
        The presets among them.
    found : sequence of Search
        Of `searches`.
    loss : sequence of float
        Of each, from `lost`.
    compile_s : float, s
        From `compile_seconds`.
    """
    by_setting = {m.accuracy: m for m in measured}
    table = []
    for preset in ASKED:
        m = by_setting[nameless(preset)]
        own = [i for i, s in enumerate(found) if s.preset == preset]
        table.append(
            {
                "preset": preset,
                "error": m.error,
                "evaluations": m.evaluations,
                "plate_evaluations": m.plate_evaluations,
                "ms": m.ms,
                "wrong_random": m.wrong_random,
                "wrong_finalists": m.wrong_finalists,
                "compile_s": compile_s,
                "search_s": float(np.median([found[i].search_s for i in own])),
                "confirm_s": float(np.median([found[i].confirm_s for i in own])),
                "loss_mean": float(np.mean([loss[i] for i in own])),
                "loss_worst": max(loss[i] for i in own),
                "losses": [loss[i] for i in own],
            }
        )
    return table


def nameless(preset: str) -> Accuracy:
    """A preset as a setting among others, as it is for the paper's walk."""
    return replace(Accuracy.named(preset), name=Accuracy().name, adapt=False)


def right_ranking(measured: Sequence[Any]) -> tuple[Any, float] | None:
    """Cheapest setting that turns at most `RIGHT` of the finalists' pairs round, and s for all of them."""
    good = [m for m in measured if m.wrong_finalists <= RIGHT]
    best = min(good, key=lambda m: m.ms, default=None)
    return None if best is None else (best, 1e-3 * best.ms * FINALISTS)


@dataclass(frozen=True)
class Order:
    """How a knob's error falls on one sand.

    Parameters
    ----------
    knob, sand : str
        What is halved, and where.
    order : float
        Observed: log2 of the change from the first to the second grid over that from there to the third.
    index : float
        Grid convergence index of the third: the band around its values that holds the limit, relative.
    """

    knob: str
    sand: str
    order: float
    index: float


def orders(
    scenes: Sequence[Scene],
    feet: Ints,
    space: Waypoints,
    threads: int | None,
    rest: bool,
    step: Callable[[str], None],
) -> list[Order]:
    """Observed orders of `GRIDS`, and of delta where `rest`: of each foot's worst objective, 95 % of feet."""
    found = []
    for scene in scenes:
        cases = {knob: [(scene, accuracy) for accuracy in grid] for knob, grid in GRIDS.items()}
        if rest:
            at = Accuracy("sdirk2", 1e-3, 128)
            cases["elastic length"] = [(replace(scene, effects=(Rest(length),)), at) for length in LENGTHS]
        for knob, grids in cases.items():
            coarse, middle, fine = (
                evaluate(feet, where, accuracy, space=space, threads=threads).values
                for where, accuracy in grids
            )
            changes = [np.abs(a - b) / np.abs(fine) for a, b in ((coarse, middle), (middle, fine))]
            first, second = (float(np.nanpercentile(np.nanmax(c, axis=1), 95.0)) for c in changes)
            order = math.log2(first / second)
            index = SAFETY * second / (2.0**order - 1.0) if order > 0.0 else math.inf
            found.append(Order(knob, scene.sand.name, order, index))
            step(f"order of the {knob} on {scene.sand.name} sand")
    return found


def table_of_presets(presets: Sequence[Any]) -> RichTable:
    """The presets as a decision, for the terminal."""
    shown = terminal.table(
        ("preset", "evaluations", "ms", "random pairs wrong (%)", "finalists wrong (%)",
         "search, confirmed (s)", "J_W lost: mean, worst (%)"),
        words=("preset",),
        title="what an accuracy decides (pairs of feet that J_W ranks wrongly; whole searches)",
    )  # fmt: skip
    for row in presets:
        shown.add_row(
            row["preset"],
            f"{row['evaluations']:.0f}",
            f"{row['ms']:.3g}",
            *(f"{100 * row[name]:.2g}" for name in ("wrong_random", "wrong_finalists")),
            f"{row['search_s'] + row['confirm_s']:.2g}",
            f"{100 * row['loss_mean']:.2g}, {100 * row['loss_worst']:.2g}",
        )
    return shown


def table_of_orders(found: Sequence[Order]) -> RichTable:
    """Observed orders, for the terminal."""
    shown = terminal.table(
        ("halved", "sand", "observed order", "grid convergence index (%)"),
        words=("halved", "sand"),
        title="how errors fall (worst objective, 95 % of the feet; index: of the finest of three grids)",
    )
    for o in found:
        shown.add_row(o.knob, o.sand, f"{o.order:.1f}", f"{100 * o.index:.2g}")
    return shown
