"""Foot and gait together: what does it gain to change how one walks, too, and which of the two does it?

On each sand the best foot for the gait as it is given is searched first, then foot and gait together, with as
many walks again, beginning with that foot. Who walks otherwise has to be as fast: walks last as long, and the
distance may not be shorter. What is gained is shared between foot and gait by walking with either alone.
"""

from __future__ import annotations

import dataclasses
import math
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from rich.table import Table as RichTable

from footopt.design import EXHAUSTIVE, FootProblem, SearchResult, Solver, confirm, make_executor, search
from footopt.design.codesign import CoDesign, FootAndGait, shares, speed
from footopt.design.problem import Ints
from footopt.design.result import check_finalists
from footopt.errors import FootoptError, SettingError, check
from footopt.foot import Foot
from footopt.gait.genes import GENES, values_of
from footopt.report import figures, terminal
from footopt.report.numbers import percent
from footopt.report.progress import Step, report_generations
from footopt.studies.accuracy import SANDS
from footopt.studies.base import Study, flat_efficiency
from footopt.studies.build import check_searchable
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.validation.model import model_error
from footopt.walk import MEASURES, simulate
from footopt.walk.scenarios import Scenario, sands

SLACK = 2e-3  # of the speed that is asked for: the error of walks at `standard`
QUICK_GENERATIONS = 5

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Found:
    """What came out on one sand.

    Parameters
    ----------
    problem : CoDesign
        At the finer accuracy.
    k : (4, n)
        The best foot with the gait as it is given; that with the other gait; the other foot with the gait as
        it is given; both.
    values : (4, record)
        Of these.
    speed : float, m/s
        That was asked for.
    evaluations : int
        Of both searches.
    """

    problem: CoDesign
    k: Ints
    values: Array
    speed: float
    evaluations: int

    @property
    def guide(self) -> Array:
        """The objective of the four."""
        return np.asarray(self.values[:, self.problem.record.index(self.problem.guide)])

    @property
    def genes(self) -> dict[str, float]:
        """The gait that was found."""
        levels = tuple(int(level) for level in self.k[3, -len(GENES) :])
        return values_of(self.problem.scene.gait, levels, self.problem.space.K)

    @property
    def gain(self) -> float:
        """Of both together against the best foot alone, relative."""
        alone, _, _, both = self.guide
        return float(-MEASURES[self.problem.guide].sign * (both - alone) / abs(alone)) + 0.0

    @property
    def shares(self) -> tuple[float, float]:
        """Shares of foot and gait in ln of how the objective changed; NaN where it did not."""
        alone, gait, foot, both = self.guide
        parts = shares(alone, foot, gait, both)
        total = sum(parts)
        return (parts[0] / total, parts[1] / total) if total else (math.nan, math.nan)


def run(study: Study) -> None:
    """Search the foot, then foot and gait, on every sand, and say what was gained by what."""
    config, options = study.config, study.options
    check_searchable(config.foot)
    check_finalists(options.finalists)
    names = config.objective.names
    check(len(names) == 1, "objective.names", names, "one objective, whose gain is shared")
    check(options.speed is None or 0 < options.speed < 100, "study.speed", options.speed,
          "null, or a speed > 0 and < 100, in m/s")  # fmt: skip
    solver = Solver(**vars(config.solver))
    if solver.name == EXHAUSTIVE:
        raise SettingError("solver", solver.name, "a solver that searches", "Try solver=memetic.")
    if options.quick:
        solver = dataclasses.replace(solver, n_gen=QUICK_GENERATIONS)
    FootAndGait.of(study.space)  # refused before anything is walked
    units, e = solver.generations(study.space), config.engine
    found: dict[str, Found] = {}
    with (
        make_executor(e.name, e.workers, e.address, e.timeout) as executor,
        study.progress(2 * units * len(SANDS), "generation") as step,
    ):
        for scenario in sands(study.scene, SANDS):
            found[scenario.name] = _on(study, scenario, solver, executor, step)
    _write(study, found)
    first, space, finer = found[SANDS[0]].problem, study.space, study.finer_accuracy
    feet = {name: Foot.from_waypoints(f.k[0, : space.n].tolist(), space) for name, f in found.items()}
    walks = (simulate(foot, found[name].problem.scene, finer) for name, foot in feet.items())
    errors = [model_error(walk, spread=options.spread.zeta) for walk in walks]
    study.conclude(
        "Foot and gait together",
        [table(found), gaits(found)],
        {
            "codesign": {name: entry(f) for name, f in found.items()},
            "ranges": {name: dataclasses.asdict(gene) for name, gene in GENES.items()},
            "model_error": dict(zip(found, errors, strict=True)),
            **scene_entry(study.scene, finer, first.record),
            "search_accuracy": dataclasses.asdict(study.accuracy),
            "solver": dataclasses.asdict(solver),
            "seed": solver.seed,
            "evaluations": sum(f.evaluations for f in found.values()),
        },
        said=[*(describe(name, f) for name, f in found.items()), *terminal.describe_model(errors)],
    )


def _on(study: Study, scenario: Scenario, solver: Solver, executor: Executor | None, step: Step) -> Found:
    """Both searches on one sand."""
    name, space, finer = scenario.name, study.space, study.finer_accuracy
    objective = study.config.objective.names
    scene = dataclasses.replace(scenario.scene, t_f=scenario.scene.duration)
    lasting = scene.duration - scene.gait.start
    asked = {} if study.options.speed is None else {"distance": study.options.speed * lasting}
    alone = FootProblem(scene, objective, space, study.accuracy, study.threads, asked)
    base = flat_efficiency(alone)
    try:
        result = _search(study, alone, solver, f"{name}, foot", executor, step, base)
    except FootoptError as error:
        if not asked:
            raise
        distances = alone.evaluate(space.random(64, seed=1)).values[:, alone.record.index("distance")]
        raise SettingError(
            "study.speed",
            study.options.speed,
            f"a speed that feet reach with the gait as it is given: 64 random ones on {name} sand at most "
            f"{np.nanmax(distances, initial=0.0) / lasting:.2g} m/s",
            str(error),
        ) from None
    own = result.k[confirm(result, finer, study.options.finalists).designs[0]]
    if study.options.speed is None:
        walked = float(alone.evaluate(own).values[0, alone.record.index("distance")])
        asked = {"distance": (1.0 - SLACK) * walked}
    both = CoDesign(
        scene, space, objective=objective, accuracy=study.accuracy, threads=study.threads, limits=asked
    )
    begin = np.append(own, both.space.own)
    together = _search(study, both, solver, f"{name}, foot and gait", executor, step, base, begin[None])
    best = together.k[confirm(together, finer, study.options.finalists).designs[0]]
    count = len(GENES)
    k = np.array([begin, [*own, *best[-count:]], [*best[:-count], *both.space.own], best])
    both.accuracy = finer
    return Found(both, k, both.walk(k)[0], speed(asked["distance"], scene),
                 result.evaluations + together.evaluations)  # fmt: skip


def _search(
    study: Study, problem: FootProblem, solver: Solver, name: str, executor: Executor | None, step: Step,
    base: float | None, start: ArrayLike | None = None,
) -> SearchResult:  # fmt: skip
    """A search whose evaluations are kept; an interrupted one ends the study."""
    try:
        with study.store(problem) as store:
            tell = report_generations(step, problem.guide, 1, f"{name}: ", base)
            result = search(problem, solver, tell, store, executor, start=start)
    except FootoptError as error:
        raise FootoptError(f"{name}: {error}") from None
    if result.interrupted:
        raise KeyboardInterrupt(f"while searching {name}")
    study.say(f"{name}: {terminal.describe_search(result)}")
    return result


def table(found: dict[str, Found]) -> RichTable:
    """What is gained on each sand, and by what."""
    guide = next(iter(found.values())).problem.guide
    title = (
        f"{guide.replace('_', ' ')} of foot and gait together against the best foot with the gait as it is"
    )
    columns = ("sand", "foot alone", "together", "gain", "by the foot", "by the gait", "speed (m/s)")
    shown = terminal.table(columns, words=("sand",), title=title)
    for name, f in found.items():
        alone, both = f.guide[0], f.guide[3]
        parts = (percent(share) if math.isfinite(share) else "-" for share in f.shares)
        numbers = (terminal.number(alone), terminal.number(both), f"{100 * f.gain:+.1f} %")
        shown.add_row(name, *numbers, *parts, f"{f.speed:.3f}")
    shown.caption = "by the foot, by the gait: shares of the gain in ln of the objective"
    return shown


def gaits(found: dict[str, Found]) -> RichTable:
    """The gait that was found on each sand, and the one that was given."""
    what = "The gaits that were found; step and lift are times those of the gait as given"
    shown = terminal.table(("sand", *map(_title, GENES)), words=("sand",), title=what)
    for name, f in found.items():
        shown.add_row(name, *(f"{value:.3g}" for value in f.genes.values()))
    own = values_of(f.problem.scene.gait, f.k[0, -len(GENES) :].tolist(), f.problem.space.K)
    shown.add_row("as given", *(f"{value:.3g}" for value in own.values()))
    return shown


def _title(name: str) -> str:
    unit = GENES[name].unit
    return name.replace("_", " ") + (f" ({unit})" if unit else "")


def undone(f: Found) -> dict[str, float]:
    """What of the objective is lost if one gene is as the gait was given, relative, by name."""
    k = np.tile(f.k[3], (len(GENES), 1))
    places = range(f.problem.space.n - len(GENES), f.problem.space.n)
    for row, place in enumerate(places):
        k[row, place] = f.k[0, place]
    column = f.problem.record.index(f.problem.guide)
    values = f.problem.walk(k)[0][:, column]
    sign, both = MEASURES[f.problem.guide].sign, f.guide[3]
    return dict(zip(GENES, (sign * (values - both) / abs(both)).tolist(), strict=True))


def describe(name: str, f: Found) -> str:
    """What was found on a sand, in a line."""
    before, after = (f.problem.foot_of(k).name for k in (f.k[0], f.k[3]))
    said = f"{name}: {after} in place of {before}"
    lost = {gene: loss for gene, loss in undone(f).items() if loss > 0.0}
    if lost:
        most = max(lost, key=lambda gene: lost[gene])
        said += (
            f"; of the gait its {most.replace('_', ' ')} counts most: "
            f"without its change {percent(lost[most])} is lost"
        )
    own = values_of(f.problem.scene.gait, f.k[0, -len(GENES) :].tolist(), f.problem.space.K)
    ends = [gene for gene, value in f.genes.items() if value != own[gene] and GENES[gene].at_end(value)]
    if ends:
        said += f"; at the end of its assumed range: {', '.join(gene.replace('_', ' ') for gene in ends)}"
    return said


def entry(f: Found) -> dict[str, Any]:
    """What was found on a sand, in result.json."""
    rows = ("foot_alone", "gait_changed", "foot_changed", "together")
    foot, gait = f.shares
    return {
        "design": foot_entry(f.problem.foot_of(f.k[3])),
        "foot_alone": foot_entry(f.problem.foot_of(f.k[0])),
        "gait": f.genes,
        "values": {
            name: dict(zip(f.problem.record, row, strict=True))
            for name, row in zip(rows, f.values.tolist(), strict=True)
        },
        "gain": f.gain,
        "share_of_foot": foot,
        "share_of_gait": gait,
        "lost_without": undone(f),
        "speed": f.speed,
        "evaluations": f.evaluations,
    }


def _write(study: Study, found: dict[str, Found]) -> None:
    """The soles and gaits as files, and the soles in a figure."""
    soles: dict[str, Foot] = {}
    for name, f in found.items():
        foot = dataclasses.replace(f.problem.foot_of(f.k[3]), name=f"{name}, with its gait")
        foot.to_file(study.folder / f"contour_{name}.csv")
        f.problem.scene_of(f.k[3]).gait.to_file(study.folder / f"gait_{name}.json")
        soles |= {name: f.problem.foot_of(f.k[0]), foot.name: foot}
    caption = "The best soles for the gait as it is given, and those that were found together with a gait."
    study.save("contours", figures.contours(soles), caption)
