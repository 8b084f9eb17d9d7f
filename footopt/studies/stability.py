"""Which stepper stays stable where? Hard cases, each simulated with every method and judged by numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any, NamedTuple

from rich.table import Table
from rich.text import Text

from footopt.errors import check
from footopt.report import terminal
from footopt.report.figures.tables import Cell, verdicts
from footopt.studies.base import Study, foot_entry, scene_entry
from footopt.studies.settings import OUTLINE, SCENE, SHAPE_SETTINGS, SPACE, Config, StudySettings, setting
from footopt.studies.stability_cases import CASES, Case, Setup
from footopt.studies.stability_judges import LIMITS, Measure
from footopt.walk import STEPPERS, Walk, simulate
from footopt.walk.adapt import adapted

#: Steppers that evaluate no Jacobian and solve nothing take this share of the time step, which
#: gives Euler the effort of SDIRK2 (two stages of 1-2 evaluations, with derivatives), Heun twice
#: and RK4 four times as much.
EXPLICIT_SHARE = 0.2

#: A walk is compared with SDIRK2 at the settings' time step over this, with at least so many plates and at
#: most this creep speed (m/s): its own error is below 1 %.
CONVERGED, PLATES, CREEP = 25.0, 512, 1e-5

CONTROL = 1e-3  # m/s, of the method under step control

#: What is judged, by name: a stepper and its step control. Every stepper takes steps of one length,
#: and the default one is also judged under control, as the accuracies by name use it.
METHODS: dict[str, tuple[str, float | None]] = {
    **{name: (name, None) for name in STEPPERS},
    "sdirk2_control": ("sdirk2", CONTROL),
}

CAPTION = "Which method is stable in which case, with the measure that decides, as in the table."
EACH_CELL = (
    "Each cell: ok, or the measure furthest beyond its limit; and how often a stage was rescued (r) or the "
    "walk repeated with a shorter step (x). All the numbers: result.json."
)


@dataclass
class Settings(StudySettings):
    """Which stepper stays stable in which hard case; every case starts from the settings."""

    name: str = "stability"
    cases: list[str] | None = setting(None, "Names of the cases; null: all.")
    methods: list[str] | None = setting(None, "Names of the steppers that are tried; null: all.")
    reads = (*SCENE, *SPACE, *SHAPE_SETTINGS, *OUTLINE, "foot.shape", "foot.k", "accuracy")


class Verdict(NamedTuple):
    """A case with a method: stable or not, and by which measure."""

    case: Case
    method: str
    measures: tuple[Measure, ...]
    walk: Walk

    @property
    def decides(self) -> Measure:
        """The measure that comes closest to its limit, or is furthest beyond it."""
        return max(self.measures, key=lambda m: m.ratio)

    @property
    def stable(self) -> bool:
        """Whether every measure is within its limit."""
        return self.decides.ratio <= 1.0

    @property
    def cell(self) -> Cell:
        """What tables and figures show of it."""
        return Cell(self.stable, self.decides.name, self.decides.value)

    @property
    def entry(self) -> dict[str, Any]:
        """What result.json holds of it, with what the walk took."""
        walk, steps = self.walk, len(self.walk.t)
        return {
            "case": self.case.name,
            "method": self.method,
            "stable": self.stable,
            "measure": self.decides.name,
            "measures": {m.name: {"value": m.value, "limit": m.limit} for m in self.measures},
            "reason": walk.reason,
            "dt": walk.accuracy.dt,
            "simulated": float(walk.t[-1]) if steps else 0.0,
            "evaluations_per_step": walk.evaluations / max(steps, 1),
            "rescues": walk.rescues,
            "shortened": walk.shortened,
            "repeats": walk.repeats,
        }


def judge(
    case: Case, base: Setup, methods: Sequence[str], step: Callable[[], None] = lambda: None
) -> list[Verdict]:
    """Judge one case with every method.

    Parameters
    ----------
    case : Case
        What is walked.
    base : (Foot, Scene, Accuracy)
        The settings, from which the case differs; the time step is that of the implicit steppers.
    methods : sequence of str
        Names in `METHODS`.
    step : callable
        Called after every method.
    """
    foot, scene, own = case.build(*base)
    own = adapted(own, scene, foot)

    @cache
    def converged() -> Walk:
        plates, creep, dt = max(own.plates, PLATES), min(own.creep, CREEP), base[2].dt / CONVERGED
        fine = replace(own, stepper="sdirk2", control=None, dt=dt, plates=plates, creep=creep, adapt=False)
        return simulate(foot, scene, fine)

    found: list[Verdict] = []
    for method in methods:
        stepper, control = METHODS[method]
        dt = own.dt * (1.0 if STEPPERS[stepper].implicit else EXPLICIT_SHARE)
        walk = simulate(foot, scene, replace(own, stepper=stepper, dt=dt, control=control))
        found.append(Verdict(case, method, tuple(case.judge(walk, converged)), walk))
        step()
    return found


def chosen(config: Config) -> tuple[list[Case], list[str]]:
    """The cases and methods that the settings name; null is all."""
    cases = {case.name: case for case in CASES}
    named: dict[str, list[str]] = {}
    for key, known in (("cases", list(cases)), ("methods", list(METHODS))):
        given = getattr(config.study, key)
        named[key] = known if given is None else given
        check(bool(named[key]), f"study.{key}", given, f"null for all, or some of: {', '.join(known)}")
        for word in named[key]:
            check(word in known, f"study.{key}", word, f"one of: {', '.join(known)}")
    return [cases[name] for name in named["cases"]], named["methods"]


def run(study: Study) -> None:
    """Judge every case with every method."""
    cases, methods = chosen(study.config)
    base = study.foot, study.scene, study.accuracy
    found: list[Verdict] = []
    with study.compiling("every method"):
        for stepper, control in map(METHODS.__getitem__, methods):
            simulate(study.foot, study.scene, replace(study.accuracy, stepper=stepper, control=control))
    with study.progress(len(cases) * len(methods), "walk") as step:
        for case in cases:
            found += judge(case, base, methods, partial(step, news=case.name))
    cells = {(v.case.name, v.method): v.cell for v in found}
    study.save("stability", verdicts([case.name for case in cases], methods, cells), CAPTION)
    explicit = ", ".join(m for m in methods if not STEPPERS[METHODS[m][0]].implicit)
    dt = 1e3 * study.accuracy.dt
    theirs = f"; {explicit}: {EXPLICIT_SHARE * dt:g} ms, for Euler the same effort" if explicit else ""
    stable = {m: sum(v.stable for v in found if v.method == m) for m in methods}
    study.conclude(
        "What stays stable",
        [table(cases, stable, found)],
        {
            "design": foot_entry(study.foot),
            **scene_entry(study.scene, study.accuracy, ()),
            "limits": LIMITS,
            "explicit_share_of_dt": EXPLICIT_SHARE,
            "stable": stable,
            "cases": len(cases),
            "verdicts": [v.entry for v in found],
        },
        said=[EACH_CELL, f"Time step {dt:g} ms{theirs}."],
    )


def table(cases: Sequence[Case], stable: dict[str, int], found: Sequence[Verdict]) -> Table:
    """Cases (rows) and methods (columns) for the terminal, and how many are stable."""
    titles = ["case", *(method.replace("_", " ") for method in stable)]
    shown = terminal.table(titles, words=titles)
    for case in cases:
        shown.add_row(case.name, *(_cell(v) for v in found if v.case is case))
    shown.add_section()
    shown.add_row("stable cases", *(f"{count} of {len(cases)}" for count in stable.values()))
    return shown


def _cell(v: Verdict) -> Text:
    words = ["ok" if v.stable else f"NO {v.cell.text}"]
    words += [f"{letter}{n}" for letter, n in (("r", v.walk.rescues), ("x", v.walk.repeats)) if n]
    return Text(" ".join(words), style="" if v.stable else "bold red")
