"""Which stepper stays stable where? Hard cases, each walked with every method and judged by numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

from rich.table import Table
from rich.text import Text

from footopt.errors import check
from footopt.report import terminal
from footopt.report.figures.stability import Cell, verdicts
from footopt.studies.base import Study
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.settings import Config
from footopt.studies.stability_cases import CASES, Case
from footopt.studies.stability_judges import LIMITS, UNJUDGED, Measure, Setup, Trial
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

#: What a walk took, in result.json and stability.csv: its step and simulated time (s) and its counts.
TOOK = ("reason", "dt", "simulated", "evaluations_per_step", "rescues", "shortened", "repeats")

CAPTION = "Which method is stable in which case, with the measure that decides, as in the table."
EACH_CELL = (
    "Each cell: ok, or the measure furthest beyond its limit; and how often a stage was rescued (r) or the "
    "walk repeated with a shorter step (x). All the numbers: stability.csv, result.json."
)


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
    def took(self) -> dict[str, Any]:
        """What the walk took, by the names of `TOOK`."""
        walk = self.walk
        simulated = float(walk.t[-1]) if len(walk.t) else 0.0
        each = walk.evaluations / max(len(walk.t), 1)
        counts = (walk.rescues, walk.shortened, walk.repeats)
        return dict(zip(TOOK, (walk.reason, walk.accuracy.dt, simulated, each, *counts), strict=True))


def judge(
    case: Case, base: Setup, methods: Sequence[str], step: Callable[[], None] = lambda: None
) -> list[Verdict]:
    """Judge one case with every method.

    Parameters
    ----------
    case : Case
        What is walked.
    base : Setup
        Where the case starts from; its time step is that of the implicit steppers.
    methods : sequence of str
        Names in `METHODS`.
    step : callable
        Called after every method.
    """
    setup = case.build(base)
    setup = replace(setup, accuracy=adapted(setup.accuracy, setup.scene, setup.foot))

    @cache
    def converged() -> Walk:
        own = setup.accuracy
        plates, creep, dt = max(own.plates, PLATES), min(own.creep, CREEP), base.accuracy.dt / CONVERGED
        fine = replace(own, stepper="sdirk2", control=None, dt=dt, plates=plates, creep=creep, adapt=False)
        return simulate(setup.foot, setup.scene, fine)

    found: list[Verdict] = []
    for method in methods:
        stepper, control = METHODS[method]
        dt = setup.accuracy.dt * (1.0 if STEPPERS[stepper].implicit else EXPLICIT_SHARE)
        accuracy = replace(setup.accuracy, stepper=stepper, dt=dt, control=control)
        trial = Trial(replace(setup, accuracy=accuracy), converged)
        found.append(Verdict(case, method, tuple(case.judge(trial)), trial.walk))
        step()
    return found


def chosen(config: Config) -> tuple[list[Case], list[str]]:
    """The cases and methods that the settings name; null is all."""
    known = {case.name: case for case in CASES}
    names = list(known) if config.study.cases is None else rejoined(config.study.cases, known)
    methods = list(METHODS) if config.study.methods is None else config.study.methods
    given: tuple[tuple[str, list[str], Any], ...] = (
        ("study.cases", names, known),
        ("study.methods", methods, METHODS),
    )
    for setting, words, allowed in given:
        check(bool(words), setting, words, f"null for all, or some of: {'; '.join(allowed)}")
        for word in words:
            check(word in allowed, setting, word, f"one of: {'; '.join(allowed)}")
    return [known[name] for name in names], methods


def rejoined(parts: Sequence[str], known: Container[str]) -> list[str]:
    """Names that hold commas, which the command line takes apart, put together again."""
    names, rest = [], list(parts)
    while rest:
        many = next((n for n in range(len(rest), 0, -1) if ", ".join(rest[:n]) in known), 1)
        names.append(", ".join(rest[:many]))
        rest = rest[many:]
    return names


def run(study: Study) -> None:
    """Judge every case with every method."""
    cases, methods = chosen(study.config)
    base = Setup(study.foot, study.scene, study.accuracy)
    found: list[Verdict] = []
    with study.compiling("every method"):
        for stepper, control in map(METHODS.__getitem__, methods):
            simulate(base.foot, base.scene, replace(base.accuracy, stepper=stepper, control=control))
    with study.progress(len(cases) * len(methods), "walk") as step:
        for case in cases:
            found += judge(case, base, methods, partial(step, news=case.name))
    names = list(dict.fromkeys(m.name for v in found for m in v.measures))
    header = ["case", "method", "stable", "measure", "value", "limit", *TOOK, *names, "asks"]
    study.write_csv("stability.csv", header, (_row(v, names) for v in found))
    cells = {(v.case.name, v.method): v.cell for v in found}
    study.save("stability", verdicts([case.name for case in cases], methods, cells), CAPTION)
    explicit = ", ".join(m for m in methods if not STEPPERS[METHODS[m][0]].implicit)
    dt = 1e3 * base.accuracy.dt
    theirs = f"; {explicit}: {EXPLICIT_SHARE * dt:g} ms, for Euler the same effort" if explicit else ""
    stable = {m: sum(v.stable for v in found if v.method == m) for m in methods}
    study.conclude(
        "What stays stable",
        [table(cases, stable, found)],
        {
            "design": foot_entry(base.foot),
            **scene_entry(base.scene, base.accuracy, ()),
            "limits": LIMITS,
            "explicit_share_of_dt": EXPLICIT_SHARE,
            "stable": stable,
            "cases": len(cases),
            "verdicts": [_entry(v) for v in found],
        },
        said=[EACH_CELL, f"Time step {dt:g} ms{theirs}."],
    )


def _entry(v: Verdict) -> dict[str, Any]:
    """A verdict in result.json."""
    limits = {m.name: None if m.limit == UNJUDGED else m.limit for m in v.measures}
    return {
        "case": v.case.name,
        "asks": v.case.asks,
        "method": v.method,
        "stable": v.stable,
        "measure": v.decides.name,
        "measures": {m.name: {"value": m.value, "limit": limits[m.name]} for m in v.measures},
        **v.took,
    }


def _row(v: Verdict, names: Sequence[str]) -> list[object]:
    """A verdict in stability.csv: a column for each measure, empty where it is not asked."""
    values = {m.name: m.value for m in v.measures}
    measured = (values.get(name, math.nan) for name in names)
    return [v.case.name, v.method, int(v.stable), *v.decides, *v.took.values(), *measured, v.case.asks]


def table(cases: Sequence[Case], stable: dict[str, int], found: Sequence[Verdict]) -> Table:
    """Cases (rows) and methods (columns) for the terminal, and how many are stable."""
    by_name = {(v.case.name, v.method): v for v in found}
    titles = ["case", *(method.replace("_", " ") for method in stable)]
    shown = terminal.table(titles, words=titles)
    for case in cases:
        shown.add_row(case.name, *(_cell(by_name[case.name, method]) for method in stable))
    shown.add_section()
    shown.add_row("stable cases", *(f"{count} of {len(cases)}" for count in stable.values()))
    return shown


def _cell(v: Verdict) -> Text:
    words = ["ok" if v.stable else f"NO {v.cell.text}"]
    words += [f"{letter}{n}" for letter, n in (("r", v.walk.rescues), ("x", v.walk.repeats)) if n]
    return Text(" ".join(words), style="" if v.stable else "bold red")
