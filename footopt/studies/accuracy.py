"""study=accuracy: what accuracy costs in time, for every stepper in a scene, and for the presets.

A few soles climb each stepper's ladder to the tolerance of `fine` (`footopt.walk.ladder`). Other random soles
walk on all of its rungs: their errors are measured against converged walks, their cost on one thread.
"""

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np

from footopt.arrays import Array, Ints
from footopt.design.problem import RECORD
from footopt.errors import check_whole
from footopt.files.io import write_csv
from footopt.foot import Waypoints
from footopt.report.figures.studies import work_precision
from footopt.report.numbers import percent
from footopt.report.output import scene_entry
from footopt.studies.effects import own_time
from footopt.studies.runs import Study
from footopt.walk import FIVE, PRESETS, STEPPERS, Accuracy, Scene, evaluate
from footopt.walk.accuracy import TOLERANCES, work
from footopt.walk.ladder import changes_of, ladder, numbers_at, numerics

QUANTILE = 95.0  # of the feet: the error that this share of them does not exceed, %
CONVERGED = PRESETS["reference"]
CAPTION = "The error of the worst objective, for 95 % of the feet, against the time that a design takes."


class Measurement(NamedTuple):
    """One setting: its error against the converged walks, and its cost per design."""

    method: str  # the stepper, or the preset
    accuracy: Accuracy
    error: float  # relative, the `QUANTILE` of each foot's worst objective; infinite where walks failed
    work: float  # as `footopt.walk.accuracy.work` has it, the same on every machine
    ms: float  # of processor time
    wrong: float  # share of the pairs of feet that J_W ranks wrongly; NaN for one foot

    @property
    def row(self) -> dict[str, Any]:
        """As accuracy.csv and result.json have it."""
        numbers = {name: getattr(self, name) for name in ("error", "work", "ms", "wrong")}
        return {"method": self.method, **asdict(self.accuracy), **numbers}


def run(study: Study) -> None:
    """Measure all settings and presets, and draw them."""
    count, scene, space = study.options.feet, study.scene, study.space
    check_whole("study.feet", count, 1, 10_000)
    feet = space.random(count, seed=study.config.solver.seed, inside=True)
    with study.compiling("every stepper"):
        for stepper in STEPPERS:
            evaluate(feet[:1], scene, Accuracy(stepper), space=space, threads=1)
    fine = [replace(PRESETS["fine"], stepper=stepper) for stepper in STEPPERS]
    with study.progress(len(TOLERANCES) + len(fine), "ladder") as step:
        for of in (*(PRESETS[name] for name in TOLERANCES), *fine):
            ladder(of, scene, space)  # which is kept
            step(news=f"{of.name}, {of.stepper}")
    preset = {name: numerics(PRESETS[name], scene, space) for name in TOLERANCES}
    rungs = ((of, rung) for of in fine for rung in ladder(of, scene, space)[1].path)
    settings = [*((of.stepper, numbers_at(of, scene.path, rung)) for of, rung in rungs), *preset.items()]
    measured = []
    with study.progress(len(settings) + 1, "setting") as step:
        truth = evaluate(feet, scene, CONVERGED, RECORD, space, study.config.engine.threads).values
        step(news="the converged walks")
        for method, accuracy in settings:
            measured.append(measure(method, accuracy, feet, scene, space, truth))
            step(news=method)
    others, presets = measured[: -len(preset)], measured[-len(preset) :]
    rows = [m.row for m in measured]
    write_csv(study.folder / "accuracy.csv", {name: [row[name] for row in rows] for name in rows[0]})
    shown = [m for m in others if np.isfinite(m.error)]
    study.save("accuracy", lambda: work_precision(shown, presets), CAPTION)
    entry = {"seed": study.config.solver.seed, "feet": feet.tolist(), "presets": [m.row for m in presets]}
    study.conclude(
        "The cost of accuracy",
        [],
        entry | scene_entry(scene, numerics(CONVERGED, scene, space), RECORD),
        summary=[
            f"{len(settings)} settings, {count} feet inside their box.",
            *(_describe(m, others) for m in presets),
        ],
    )


def measure(
    method: str, accuracy: Accuracy, feet: Ints, scene: Scene, space: Waypoints, truth: Array
) -> Measurement:
    """Error and cost of one setting; `truth` (feet, `RECORD`) are the values of the converged walks."""
    taken = []
    for _ in range(2):  # the first one also makes the table of poses
        started = own_time()
        found = evaluate(feet, scene, accuracy, RECORD, space, threads=1)
        taken.append(own_time() - started)
    worst = changes_of(found.values[:, : len(FIVE)], truth[:, : len(FIVE)], scene).max(axis=1)
    j = RECORD.index("efficiency")
    return Measurement(
        method,
        accuracy,
        float(np.percentile(worst, QUANTILE)),
        work(found.evaluations, found.counts["plates"]).mean(),
        1e3 * min(taken) / len(feet),
        wrong_pairs(found.values[:, j], truth[:, j]),
    )


def wrong_pairs(values: Array, truth: Array) -> float:
    """Share of all pairs of feet that values (feet,) rank otherwise than the truth; NaN for no pair."""
    first, second = np.triu_indices(len(truth), 1)
    with np.errstate(invalid="ignore"):
        turned = np.sign(values[first] - values[second]) != np.sign(truth[first] - truth[second])
    return float(turned.mean()) if len(first) else float("nan")


def _describe(preset: Measurement, others: Sequence[Measurement]) -> str:
    """A preset in words, and the setting that meets its tolerance with the least work."""
    tolerance = TOLERANCES[preset.method]
    words = (
        f"{preset.method}: error {percent(preset.error)}, {preset.ms:.3g} ms per design and core; "
        f"J_W ranks {percent(preset.wrong)} of the pairs of feet wrongly. "
        f"Cheapest within {percent(tolerance)}: "
    )
    found = min((m for m in others if m.error <= tolerance), key=lambda m: m.work, default=None)
    if found is None:
        return f"{words}none of these settings."
    a = found.accuracy
    control = "" if a.control is None else f", control {a.control:.2g} m/s"
    return f"{words}{a.stepper}, dt {1e3 * a.dt:.3g} ms{control}, {a.plates} plates, {found.ms:.3g} ms."
