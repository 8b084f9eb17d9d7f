"""What does accuracy cost in time? A work-precision study of steppers, time steps, plates and creep.

Random feet walk on the three sands at many settings; the error of a setting is measured against the
limit of many plates and small steps, its cost on one thread, and what it decides by the share of pairs
of feet that J_W ranks wrongly. The presets and `accuracy.tolerance` come from the table that this study
writes (`footopt/walk/accuracy.csv` is one such table).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as RichTable

from footopt.errors import check
from footopt.foot import Foot, Waypoints
from footopt.report import terminal
from footopt.report.figures.studies import work_precision
from footopt.sand import Sand
from footopt.studies.audit import own_time
from footopt.studies.base import Study
from footopt.studies.settings import FEET_HELP, SPACE, WORLD, StudySettings, setting
from footopt.studies.validation.model import model_error
from footopt.walk import FIVE, Accuracy, Scene, evaluate, simulate
from footopt.walk.accuracy import PRESETS, TABLE_COLUMNS, work
from footopt.walk.steppers import STEPPERS

Array = NDArray[np.float64]

SANDS = ("soft", "regular", "hard")
QUANTILE = 95.0  # of the feet: the error that this share of them does not exceed, %
ASKED = ("draft", "standard", "fine")  # presets whose wrong pairs are told
TOLERANCES = (0.02, 0.005, 0.0005)  # that the cheapest setting is told for
LIMIT = Accuracy("sdirk2", 1e-4, 800, 1e-5, "limit")
QUICK_LIMIT = Accuracy("sdirk2", 5e-4, 256, 1e-4, "limit")
PLATES = 64  # of settings that differ in time only

IMPLICIT_DT = (
    2e-2, 1.25e-2, 1e-2, 8e-3, 7e-3, 6.25e-3, 5.5e-3, 5e-3, 4e-3, 2.5e-3, 1.6e-3, 1e-3, 5e-4, 2.5e-4,
)  # fmt: skip
EXPLICIT_DT = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1e-4, 5e-5)
ARC_PLATES = (24, 32, 40, 48, 52, 56, 60, 64, 80, 96, 128, 160, 192, 256)
CHORD_PLATES = (25, 50, 100, 200, 400)
CREEPS = (1e-2, 1e-3, 1e-5)
CONTROLS = (3e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5)  # m/s
LONGEST_DT = (1.25e-2, 1e-2, 8e-3)  # of steps under control

MEASURED = (*FIVE, "efficiency")

CAPTION = (
    "Error of the worst objective, for 95 % of the feet, against the time that a design takes, for every "
    "stepper, time step and number of plates; the presets are marked."
)


@dataclass
class Settings(StudySettings):
    """What accuracy costs in time: steppers, time steps, plates and creep speeds."""

    name: str = "accuracy"
    feet: int = setting(40, FEET_HELP)
    quick: bool = setting(False, "Whether a first look is enough.")
    reads = (*WORLD, *SPACE, "solver.seed")


@dataclass(frozen=True)
class Measurement:
    """One setting: its error against the limit and its cost.

    Parameters
    ----------
    accuracy : Accuracy
        The setting.
    errors : (sands, objectives)
        Relative, of the `QUANTILE`; infinite where a walk failed.
    worst : (sands,)
        As `errors`, of each foot's worst objective.
    evaluations, plate_evaluations : float
        Of the contact, and of plates in it; per design, mean over the sands.
    ms : float
        Per design on one thread, mean over the sands.
    wrong : (sands,)
        Share of pairs of feet that J_W ranks wrongly.
    """

    accuracy: Accuracy
    errors: Array
    worst: Array
    evaluations: float
    plate_evaluations: float
    ms: float
    wrong: Array

    @property
    def error(self) -> float:
        """The largest of `worst` over the sands."""
        return float(self.worst.max())

    @property
    def row(self) -> dict[str, Any]:
        """The setting, its error and its cost by the names of `TABLE_COLUMNS`."""
        return {name: getattr(self.accuracy, name) for name in TABLE_COLUMNS[:-4]} | {
            name: float(f"{getattr(self, name):.4g}") for name in TABLE_COLUMNS[-4:]
        }


def run(study: Study) -> None:
    """Measure all settings: the table, the figure and the presets that follow."""
    count, quick = study.options.feet, study.options.quick
    check(1 <= count <= 10_000, "study.feet", count, "a whole number, 1 to 10,000")
    space = study.space
    scenes = [replace(study.scene, sand=Sand.named(name)) for name in SANDS]
    feet = space.random(count, seed=study.seed, inside=True)
    grid, limit = (quick_grid(), QUICK_LIMIT) if quick else (full_grid(), LIMIT)
    about = f"{len(grid)} settings, {count} feet inside their box, sands {', '.join(SANDS)}"
    study.say(about)
    truths, measured = [], []
    with study.compiling("every stepper"):
        for stepper in STEPPERS:
            evaluate(feet[:1], scenes[0], Accuracy(stepper), space=space, threads=1)
    with study.progress(len(grid) + len(scenes), "measurement") as step:
        for scene in scenes:
            truths.append(evaluate(feet, scene, limit, MEASURED, space, study.threads).values)
            step("the limit of small steps and many plates")
        for accuracy in grid:
            measured.append(measure(accuracy, feet, scenes, space, truths))
            step(f"{accuracy.stepper}, dt {1e3 * accuracy.dt:g} ms, {accuracy.plates} plates")
    write_table(study, measured)
    study.save("accuracy", work_precision(measured, list(PRESETS.values())), CAPTION)
    flat = Foot.flat(space)
    errors = [model_error(simulate(flat, scene, "fine")) for scene in scenes]
    picks = {tolerance: cheapest(measured, tolerance) for tolerance in TOLERANCES}
    own = {m.accuracy: m for m in measured}
    presets = {name: own[nameless(name)] for name in ASKED}
    study.conclude(
        "What accuracy costs",
        [table_of_presets(presets), table(pareto(measured))],
        {
            "seed": study.seed,
            "feet": feet.tolist(),
            "model_error": dict(zip(SANDS, errors, strict=True)),
            "presets": [
                {"preset": name, **m.row, "wrong": dict(zip(SANDS, m.wrong.tolist(), strict=True))}
                for name, m in presets.items()
            ],
            "cheapest": {str(t): None if m is None else m.row for t, m in picks.items()},
        },
        said=[
            *(f"Cheapest within {100 * t:g} %: {_describe(m)}" for t, m in picks.items()),
            *terminal.describe_model(errors),
        ],
        about=[about],
    )


def nameless(preset: str) -> Accuracy:
    """A preset as a setting among others, as it is for the paper's walk."""
    return replace(Accuracy.named(preset), name=Accuracy().name, adapt=False)


def full_grid() -> list[Accuracy]:
    """All settings of the study."""
    grid = [Accuracy("sdirk2", dt, PLATES) for dt in IMPLICIT_DT]
    grid += [Accuracy("sdirk2", dt, n) for dt in IMPLICIT_DT if dt >= 1e-3 for n in ARC_PLATES]
    grid += [Accuracy("sdirk2", dt, n, 2e-5) for dt in (2.5e-3, 1e-3) for n in ARC_PLATES if n >= 96]
    for dt, control, n in itertools.product(LONGEST_DT, CONTROLS, ARC_PLATES):
        if control >= 1e-3 or dt == 1e-2:
            grid.append(Accuracy("sdirk2", dt, n, control=control))
        if control <= 2e-4 and dt == 1e-2 and n >= 96:
            grid.append(Accuracy("sdirk2", dt, n, 2e-5, control=control))
    grid += [Accuracy("implicit_euler", dt, PLATES) for dt in IMPLICIT_DT]
    explicit = ("explicit_euler", "semi_implicit_euler", "heun", "rk4")
    grid += [Accuracy(name, dt, PLATES) for name in explicit for dt in EXPLICIT_DT]
    grid += [Accuracy("sdirk2", 2.5e-3, n, rule="chord") for n in CHORD_PLATES]
    grid += [Accuracy("sdirk2", 1e-3, 192, creep) for creep in CREEPS]
    return list(dict.fromkeys([*grid, *map(nameless, ASKED)]))


def quick_grid() -> list[Accuracy]:
    """A few settings of each kind, for a first look (and for the tests)."""
    grid = [Accuracy("sdirk2", dt, n) for dt in (1e-2, 5e-3, 2.5e-3) for n in (32, PLATES)]
    grid += [Accuracy(name, dt, PLATES) for name in STEPPERS if name != "sdirk2" for dt in (2e-3, 1e-3)]
    grid += [Accuracy("sdirk2", 1e-2, PLATES, control=3e-4)]
    grid += map(nameless, ASKED)
    return [*grid, Accuracy("sdirk2", 2.5e-3, 50, rule="chord")]


def measure(
    accuracy: Accuracy,
    feet: NDArray[np.int64],
    scenes: Sequence[Scene],
    space: Waypoints,
    limits: Sequence[Array],
) -> Measurement:
    """Errors and cost of one setting.

    Parameters
    ----------
    accuracy : Accuracy
        The setting.
    feet : (feet, n)
        Heights of soles of the `space`.
    scenes : sequence of Scene
        One on each sand.
    space : Waypoints
        The design space.
    limits : sequence of (feet, `MEASURED`)
        The right values in each scene.
    """
    errors, worst, counts, wrong, seconds = [], [], [], [], 0.0
    evaluate(feet[:1], scenes[0], accuracy, space=space, threads=1)  # compiled, pose table made
    for scene, limit in zip(scenes, limits, strict=True):
        started = own_time()
        found = evaluate(feet, scene, accuracy, MEASURED, space=space, threads=1)
        seconds += own_time() - started
        error, j = _error(found.values, limit)[:, : len(FIVE)], MEASURED.index("efficiency")
        counts.append((found.evaluations.mean(), found.plates.mean()))
        wrong.append(wrong_pairs(found.values[:, j], limit[:, j]))
        errors.append(np.percentile(error, QUANTILE, axis=0))
        worst.append(np.percentile(error.max(axis=1), QUANTILE))
    evaluations, plates = np.mean(counts, axis=0).tolist()
    return Measurement(
        accuracy,
        np.array(errors),
        np.array(worst),
        evaluations,
        plates,
        1e3 * seconds / (len(feet) * len(scenes)),
        np.array(wrong),
    )


def wrong_pairs(values: Array, truth: Array) -> float:
    """Share of all pairs of feet that values (feet,) rank otherwise than the truth; NaN for no pair."""
    first, second = np.triu_indices(len(truth), 1)
    with np.errstate(invalid="ignore"):
        turned = np.sign(values[first] - values[second]) != np.sign(truth[first] - truth[second])
    return float(turned.mean()) if len(first) else float("nan")


def _error(values: Array, reference: Array) -> Array:
    """Relative error (feet, objectives); infinite where only one of the two walks failed."""
    with np.errstate(invalid="ignore"):
        error = np.abs(values / reference - 1.0)
    both = np.isnan(values) & np.isnan(reference)
    return np.where(both, 0.0, np.where(np.isfinite(error), error, np.inf))


def pareto(measured: Sequence[Measurement]) -> list[Measurement]:
    """Settings that no other beats in both error and cost, cheapest first."""
    best: list[Measurement] = []
    for m in sorted(measured, key=lambda m: (m.ms, m.error)):
        if np.isfinite(m.error) and (not best or m.error < best[-1].error):
            best.append(m)
    return best


def cheapest(measured: Sequence[Measurement], tolerance: float) -> Measurement | None:
    """The cheapest setting whose error is within the tolerance."""
    return min((m for m in measured if m.error <= tolerance), key=lambda m: work(m.row), default=None)


def write_table(study: Study, measured: Sequence[Measurement]) -> None:
    """All settings with their errors (fractions) and cost (ms per design and core)."""
    header = [*TABLE_COLUMNS, *(f"wrong_{s}" for s in SANDS), *(f"error_{s}" for s in SANDS)]
    header += [f"error_{s}_{name}" for s in SANDS for name in FIVE]
    rows = (
        [*m.row.values(), *(float(f"{e:.3g}") for e in (*m.wrong, *m.worst, *m.errors.ravel()))]
        for m in sorted(measured, key=lambda m: m.ms)
    )
    study.write_csv("accuracy.csv", header, rows)


def table(best: Sequence[Measurement]) -> RichTable:
    """The settings that no other beats, for the terminal."""
    shown = terminal.table(
        ("stepper", "plates", "dt (ms), control", "creep (m/s)", "error (%)", "ms per design and core"),
        words=("stepper",),
        title="settings that no other beats (error: worst objective, 95 % of the feet)",
    )
    for m in best:
        a = m.accuracy
        dt = f"{1e3 * a.dt:g}" if a.control is None else f"<= {1e3 * a.dt:g}, {a.control:g} m/s"
        error, ms = f"{100 * m.error:.3g}", f"{m.ms:.3g}"
        shown.add_row(a.stepper, f"{a.plates} {a.rule}", dt, f"{a.creep:g}", error, ms)
    return shown


def table_of_presets(presets: Mapping[str, Measurement]) -> RichTable:
    """Presets with what they decide wrongly, for the terminal."""
    return terminal.table(
        ("preset", "error (%)", "ms", *(f"{sand}: pairs wrong (%)" for sand in SANDS)),
        words=("preset",),
        title="pairs of random feet that J_W ranks wrongly",
        rows=(
            (name, f"{100 * m.error:.2g}", f"{m.ms:.3g}", *(f"{100 * w:.2g}" for w in m.wrong))
            for name, m in presets.items()
        ),
    )


def _describe(m: Measurement | None) -> str:
    if m is None:
        return "none of these settings"
    a = m.accuracy
    control = "" if a.control is None else f", control {a.control:g} m/s"
    return f"{a.stepper}, dt {a.dt:g} s{control}, {a.plates} {a.rule} plates, {m.ms:.3g} ms"
