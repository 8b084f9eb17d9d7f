"""study=stability: hard cases, each simulated with every stepper, and judged by physical criteria.

The energy balance closes, the sand supplies no energy beyond what smoothing allows, a standing walker does
not move, and the objectives are those of a refined walk.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from rich.text import Text

from footopt.effects import bristle_length
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.numbers import percent
from footopt.report.output import foot_entry, scene_entry
from footopt.studies.runs import Study
from footopt.studies.stability_cases import CASES, Case
from footopt.walk import FIVE, STEPPERS, Accuracy, Scene, Walk, simulate
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.checks import energy_gap, power_from_sand, sinking_speed, smoothing_power
from footopt.walk.ladder import numerics
from footopt.walk.objectives import sizes
from footopt.walk.resolution import BEYOND, PROMISE

#: Of the time step, for explicit steppers, which evaluate no Jacobian and solve nothing: Euler then has the
#: effort of SDIRK2 (two stages of 1-2 evaluations, with derivatives), Heun twice and RK4 four times as much.
EXPLICIT_SHARE = 0.2

CONTROL = 1e-3  # m/s, of the method under step control, where the settings have none

#: Methods by name: a stepper, and whether its steps are controlled, as those of the presets are.
METHODS = {**{name: (name, False) for name in STEPPERS}, "sdirk2_control": ("sdirk2", True)}

#: Each with its reason; none depends on the stepper. That of an error follows from the accuracy.
LIMITS = {
    "chatter": 1e-3,  # of the weight: what a force plate resolves; the trapped state has none at all
    "yielding": 3.0,  # in units of what the smoothed law itself yields, good to a factor for any sole
    "energy": 0.05,  # of |W|
    "rest": 3e-8,  # m/s: in half a minute a thousandth of a grain
    "place": 1e-4,  # m, by which the time step and the length of bristles may choose where it stands
}
SETTLED = 0.1  # of every limit: refinements of a truth change no measure by more
TWICE = 2  # times in a row: once may be chance
MOST_WORK = 2e9  # evaluations of a plate in a walk that is refined once more


class Measure(NamedTuple):
    """One number about a walk, stable within its limit."""

    name: str
    value: float
    limit: float

    @property
    def ratio(self) -> float:
        """Value over limit; infinite for a value that is not a number."""
        if not math.isfinite(self.value):
            return math.inf
        return 0.0 if self.value == 0.0 else self.value / self.limit if self.limit else math.inf


class Verdict(NamedTuple):
    """A case with a method: stable or not, and by which measure."""

    case: Case
    method: str
    measures: Sequence[Measure]
    walk: Walk
    truth: Walk

    @property
    def title(self) -> str:
        """The case, and by how much refinement still moves its reference."""
        if self.truth.reason:
            return self.case.name
        value = next(m.value for m in self.measures if m.name == "truth")
        length = f"{max(1e6 * value, 0.01):.1g} µm"
        return f"{self.case.name}\n(±{length if stands_still(self.walk.scene) else percent(value)})"

    @property
    def decides(self) -> Measure:
        """The measure that comes closest to its limit, or is furthest beyond it."""
        return max(self.measures, key=lambda m: m.ratio)

    @property
    def stable(self) -> bool:
        """Whether every measure is within its limit."""
        return self.decides.ratio <= 1.0

    @property
    def told(self) -> str:
        """The verdict in a table: of a walk that is not stable the measure that decides, and its value."""
        name, value, limit = self.decides
        number = f" {value:.2g}".replace("e-0", "e-").replace("e+0", "e") if limit else ""
        return "ok" if self.stable else f"NO {name}{number}"


def run(study: Study) -> None:
    """Judge every case with every method."""
    known = {case.name: case for case in CASES}
    cases = [known[name] for name in study.some_of(known)]
    methods = study.some_of(METHODS, "methods")
    base = study.foot, study.scene, study.accuracy
    with study.compiling("every method"):
        for stepper in {METHODS[method][0] for method in methods}:
            simulate(study.foot, study.scene, replace(study.accuracy, stepper=stepper))
    with study.progress(len(cases) * len(methods), "walk") as step:
        found = [judge_case(case, base, methods, partial(step, news=case.name)) for case in cases]
    stable = {method: sum(row[i].stable for row in found) for i, method in enumerate(methods)}
    titles = ["case, and its reference", *(method.replace("_", " ") for method in methods)]
    table = terminal.table(titles, titles)
    failing = [row for row in found if not all(v.stable for v in row)]
    for row in failing:
        table.add_row(row[0].title, *(Text(v.told, "" if v.stable else "bold red") for v in row))
    table.add_section()
    table.add_row("stable cases", *(f"{count} of {len(cases)}" for count in stable.values()))
    verdicts = []
    for v in (v for row in found for v in row):
        measures = {m.name: {"value": m.value, "limit": m.limit} for m in v.measures}
        verdicts.append({"case": v.case.name, "method": v.method, "stable": v.stable, "measures": measures})
    entry = scene_entry(study.scene, numerics(study.accuracy, study.scene, study.foot), ())
    study.conclude(
        "Stability of the steppers",
        [table],
        {"design": foot_entry(study.foot), **entry, "stable": stable, "verdicts": verdicts},
        summary=[
            f"Stable with every method, and not shown: {len(found) - len(failing)} of {len(found)} cases.",
            "Where a method is not stable: the measure that is furthest beyond its limit.",
            "Behind a case: the change when its reference is refined once more.",
        ],
    )


def judge_case(
    case: Case,
    base: tuple[Foot, Scene, AnyAccuracy],
    methods: Sequence[str],
    step: Callable[[], None] = lambda: None,
) -> list[Verdict]:
    """Judge a case, which starts from the settings `base`, with `METHODS`; `step` is called after each."""
    foot, scene = case.foot() if case.foot else base[0], case.scene(base[1])
    foot = replace(foot, space=None)  # its numbers are found by itself, not by ten soles of its space
    own = replace(numerics(base[2], scene, foot), **case.accuracy)
    control, limit = own.control or CONTROL, BEYOND * (own.tolerance or PROMISE)
    start = replace(own, stepper="sdirk2", control=control)
    truth, stands = find_truth(foot, scene, start, case.accuracy, limit)
    found: list[Verdict] = []
    for method in methods:
        stepper, controlled = METHODS[method]
        dt = case.steps * own.dt * (1.0 if STEPPERS[stepper].implicit else EXPLICIT_SHARE)
        trial = replace(own, stepper=stepper, dt=dt, control=control if controlled else None)
        walk = simulate(foot, scene, trial)
        found.append(Verdict(case, method, judge(walk, truth, stands, limit), walk, truth))
        step()
    return found


def find_truth(
    foot: Foot, scene: Scene, accuracy: Accuracy, given: Mapping[str, Any], limit: float
) -> tuple[Walk, Measure]:
    """Refine a walk until steps, plates and creep speed each change it little, except for those `given`.

    A walker that stands keeps its creep speed, which determines how it sinks; its bristles are a tenth as
    long. `limit` is that of the error of an objective. The measure is what a further refinement changes.
    """
    if stands_still(scene):
        effects: tuple[Any, ...] = scene.effects
        shorter = (replace(e, length=0.1 * e.length) if e.bristle_length else e for e in effects)
        scene, limit = replace(scene, effects=tuple(shorter)), LIMITS["place"]
        given = {"control": None, "creep": accuracy.creep, **given}
    walked = cache(lambda one: replace(simulate(foot, scene, one), bristles=None))  # they take memory
    now, stood, changes = replace(accuracy.refined(), **given), 0, dict.fromkeys(finer(accuracy), math.inf)
    while True:
        truth, ways = walked(now), {}
        for cause, one in finer(now).items() if truth.evaluations * now.plates < MOST_WORK else ():
            one = replace(one, **given)
            if one.plates in (now.plates, 2 * now.plates) and not scene.too_long(one):
                changes[cause] = max(m.ratio for m in compare(walked(one), truth, limit))
                ways[changes[cause]] = one
        stands = Measure("truth", limit * sum(changes.values()), limit)
        stood = stood + 1 if stands.ratio <= SETTLED else 0
        if not ways or stood == TWICE:
            return truth, stands
        now = ways[max(ways)]


def finer(accuracy: Accuracy) -> dict[str, Accuracy]:
    """An accuracy with its time step, its plates or its creep speed refined."""
    fine = accuracy.refined()
    return {
        "dt": replace(accuracy, dt=fine.dt, control=fine.control, name="refined"),
        "plates": replace(accuracy, plates=fine.plates, name="refined"),
        "creep": replace(accuracy, creep=fine.creep, name="refined"),
    }


def stands_still(scene: Scene) -> bool:
    """Whether the walker never begins to walk."""
    return math.isinf(scene.gait.start)


def judge(walk: Walk, truth: Walk, stands: Measure, limit: float) -> list[Measure]:
    """Measures of a walk, of which none is beyond its limit if it is stable; `limit` as in `compare`."""
    found = [*compare(walk, truth, limit), stands]
    if walk.reason or truth.reason:
        return found
    found.append(Measure("energy", energy_gap(walk), LIMITS["energy"]))
    if not bristle_length(walk.scene.effects):  # what bristles give back they have stored
        allowed = smoothing_power(walk.scene.sand.stress_map)
        found.append(Measure("power", power_from_sand(walk), allowed))
    return found + (_standing(walk) if stands_still(walk.scene) else [])


def compare(walk: Walk, truth: Walk, limit: float) -> list[Measure]:
    """Measures of a walk against the right one: its end, its objectives, or where the walker stands.

    `limit` is that of the error of an objective.
    """
    if walk.reason or truth.reason:
        return [Measure(walk.reason or "no failure", float(walk.reason != truth.reason), 0.0)]
    if stands_still(walk.scene):
        return [Measure("place", float(np.hypot(*(walk.com[-1] - truth.com[-1]))), LIMITS["place"])]
    own, exact = (np.array([one.objectives[name] for name in FIVE]) for one in (walk, truth))
    errors = dict(zip(FIVE, (np.abs(own - exact) / sizes(exact, walk.scene)).tolist(), strict=True))
    peak = errors.pop("peak_power")  # on its own: an impact may be shorter than a step
    return [Measure("error", max(errors.values()), limit), Measure("peak", peak, limit)]


def _standing(walk: Walk) -> list[Measure]:
    """Measures of the second half of standing: the walker may move only as the law lets it sink."""
    half = 0.5 * walk.t[-1]
    late = walk.t > half
    weight = walk.scene.walker.mass * walk.scene.gravity[1]  # what of it presses on the sand
    force = walk.force[late, :, 1].sum(axis=1) / weight
    moved = float(np.hypot(*np.ptp(walk.com[late], axis=0)))
    plain = not bristle_length(walk.scene.effects)
    drift = LIMITS["yielding"] * sinking_speed(walk, half) * half if plain else 0.0
    return [
        Measure("chatter", float(force.std()), LIMITS["chatter"]),
        Measure("load", float(abs(force.mean() - 1.0)), LIMITS["chatter"]),
        Measure("drift", moved, LIMITS["rest"] * half + drift),
    ]
