"""Which stepper stays stable where? Hard cases, each simulated with every method and judged by numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from rich.text import Text

from footopt.errors import check
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.figures.tables import Cell, verdicts
from footopt.studies.base import Study, foot_entry, scene_entry
from footopt.studies.settings import Config
from footopt.studies.stability_cases import CASES, Case
from footopt.studies.stability_judges import Measure, Truth, find_truth, judge
from footopt.walk import STEPPERS, Scene, Walk, simulate
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.ladder import numerics
from footopt.walk.resolution import BEYOND, PROMISE

#: Of the time step, for explicit steppers, which evaluate no Jacobian and solve nothing: Euler then has the
#: effort of SDIRK2 (two stages of 1-2 evaluations, with derivatives), Heun twice and RK4 four times as much.
EXPLICIT_SHARE = 0.2

CONTROL = 1e-3  # m/s, of the method under step control, where the settings have none

#: Methods by name: a stepper, and whether its steps are controlled, as those of the presets are.
METHODS = {**{name: (name, False) for name in STEPPERS}, "sdirk2_control": ("sdirk2", True)}

CAPTION = "Which method is stable in which case, with the measure that decides, as in the table."


class Verdict(NamedTuple):
    """A case with a method: stable or not, and by which measure."""

    case: Case
    method: str
    measures: Sequence[Measure]
    walk: Walk
    truth: Truth | None

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
        """The cell of it in the figure."""
        return Cell(self.stable, self.decides.name, self.decides.value)

    @property
    def entry(self) -> dict[str, Any]:
        """The entry of it in result.json."""
        return {
            "case": self.case.name,
            "method": self.method,
            "stable": self.stable,
            "measure": self.decides.name,
            "measures": {m.name: {"value": m.value, "limit": m.limit} for m in self.measures},
            "reason": self.walk.reason,
            **{name: getattr(self.walk, name) for name in ("evaluations", "rescues", "shortened", "repeats")},
        }


def judge_case(
    case: Case,
    base: tuple[Foot, Scene, AnyAccuracy],
    methods: Sequence[str],
    step: Callable[[], None] = lambda: None,
) -> list[Verdict]:
    """Judge a case, which starts from the settings `base`, with `METHODS`; `step` is called after each."""
    foot, scene = case.foot() if case.foot else base[0], case.scene(base[1])
    own = replace(numerics(base[2], scene, foot), **case.accuracy)
    control, limit = own.control or CONTROL, BEYOND * (own.tolerance or PROMISE)
    truth = find_truth(foot, scene, replace(own, stepper="sdirk2", control=control), case.accuracy, limit)
    found: list[Verdict] = []
    for method in methods:
        stepper, controlled = METHODS[method]
        dt = case.steps * own.dt * (1.0 if STEPPERS[stepper].implicit else EXPLICIT_SHARE)
        trial = replace(own, stepper=stepper, dt=dt, control=control if controlled else None)
        walk = simulate(foot, scene, trial)
        found.append(Verdict(case, method, judge(walk, truth, limit), walk, truth))
        step()
    return found


def chosen(config: Config) -> tuple[list[Case], list[str]]:
    """The cases and methods that the settings name; null is all."""
    cases = {case.name: case for case in CASES}
    names = []
    for key, known in (("cases", list(cases)), ("methods", list(METHODS))):
        given = getattr(config.study, key)
        names.append(known if given is None else given)
        allowed = f"null for all, or some of: {', '.join(known)}"
        check(bool(names[-1]) and {*names[-1]} <= {*known}, f"study.{key}", given, allowed)
    return [cases[name] for name in names[0]], names[1]


def run(study: Study) -> None:
    """Judge every case with every method."""
    cases, methods = chosen(study.config)
    base = study.foot, study.scene, study.accuracy
    with study.compiling("every method"):
        for stepper in {METHODS[method][0] for method in methods}:
            simulate(study.foot, study.scene, replace(study.accuracy, stepper=stepper))
    with study.progress(len(cases) * len(methods), "walk") as step:
        found = [judge_case(case, base, methods, partial(step, news=case.name)) for case in cases]
    cells = {(v.case.name, v.method): v.cell for row in found for v in row}
    study.save("stability", verdicts([case.name for case in cases], methods, cells), CAPTION)
    stable = {m: sum(cells[case.name, m].stable for case in cases) for m in methods}
    titles = ["case", *(method.replace("_", " ") for method in methods)]
    table = terminal.table(titles, titles)
    for case in cases:
        table.add_row(case.name, *(_shown(cells[case.name, method]) for method in methods))
    table.add_section()
    table.add_row("stable cases", *(f"{count} of {len(cases)}" for count in stable.values()))
    study.conclude(
        "Stability of the steppers",
        [table],
        {
            "design": foot_entry(study.foot),
            **scene_entry(study.scene, numerics(study.accuracy, study.scene, study.foot), ()),
            "stable": stable,
            "verdicts": [v.entry for row in found for v in row],
        },
        summary=["Where a method is not stable: the measure that is furthest beyond its limit."],
    )


def _shown(cell: Cell) -> Text:
    return Text("ok") if cell.stable else Text(f"NO {cell.text}", style="bold red")
