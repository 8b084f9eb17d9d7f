"""One foot for all sands? What a robust foot loses against the specialists that each scenario has.

Every scenario gets its specialist, the robust foot is searched by the same solver with as many
designs, and all feet then walk in all scenarios. The robust foot minimises a measure of its regret:
the relative loss against the best specialist known in a scenario. Of drawn scenarios, the foot for
the median scene takes part too, and both meet scenarios that neither was designed for.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as RichTable

from footopt.design import (
    EXHAUSTIVE,
    FootProblem,
    Generation,
    SearchResult,
    Solver,
    confirm,
    make_executor,
    search,
)
from footopt.design.result import check_finalists
from footopt.design.robust import RobustProblem, regret
from footopt.errors import FootoptError, SettingError, check
from footopt.files import drawings
from footopt.files import run as files
from footopt.foot import Foot
from footopt.report import figures, summary, terminal
from footopt.report.figures import robust as robust_figures
from footopt.report.progress import progress, telling
from footopt.studies import build
from footopt.studies.base import Study
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.settings import Config
from footopt.walk import OBJECTIVES, Accuracy, Scene
from footopt.walk.scenarios import Scenario, draw, sands

Array = NDArray[np.float64]

SOURCES = ("sands", "drawn")
HELD_OUT = 200  # fresh scenarios that test the robust foot
QUICK_DRAWS, QUICK_GENERATIONS, QUICK_HELD_OUT = 3, 5, 8
SHOWN = 6  # scenarios that a table on the terminal has columns for
MEDIAN, ROBUST = "median scene", "robust"

#: What each figure shows.
SAYS = {
    "contours": "The specialists' soles and the robust one, or the median scene's.",
    "regrets": "What each foot loses in each scenario against the best specialist there.",
    "convergence": "The regret of the best foot so far, over the evaluations of the robust search.",
    "held_out": "Regret of the robust foot against the median scene's, in scenarios that neither knew.",
    "scatter_matrix": "The Pareto front of the robust search, pair by pair of objectives.",
}


@dataclass(frozen=True, eq=False)
class Comparison:
    """All feet in all scenarios.

    Parameters
    ----------
    names : of the feet: the scenarios' specialists, the median scene's where there is one, the
        robust foot. k : (feet, n).
    values : (scenarios, feet, record), natural signs. reasons : (scenarios, feet), of failed walks.
    references : (scenarios,), the guide's value of the specialist that is best in each.
    regrets : (feet, scenarios), against these.
    """

    names: tuple[str, ...]
    k: NDArray[np.int64]
    values: Array
    reasons: NDArray[np.str_]
    references: Array
    regrets: Array


def run(study: Study) -> None:
    """Search the specialists and the robust foot, and write what each loses to `folder`."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    build.check_searchable(config.foot)
    options, c = config.study, config.solver
    scene, scenarios = make_scenarios(config)
    solver = Solver(c.name, c.pop_size, min(c.n_gen, QUICK_GENERATIONS) if options.quick else c.n_gen, c.seed)
    accuracy = build.make_accuracy(config.accuracy)
    finer = Accuracy.named(options.confirm) if options.confirm else accuracy
    check_finalists(options.finalists)
    judge = RobustProblem(
        scenarios, config.objective.names, build.make_space(config.foot), accuracy, config.engine.threads,
        options.measure, options.tail,
    )  # fmt: skip
    if solver.name != EXHAUSTIVE:  # a solver that does not fit is refused before anything is walked
        solver.build(judge.n_obj)

    feet = scenarios if options.scenarios == "sands" else (*scenarios, Scenario(MEDIAN, scene))
    found: dict[str, NDArray[np.int64]] = {}
    each = solver.generations(judge.space)
    work = float(each * (len(feet) + len(scenarios)))  # the robust foot walks in all scenarios
    unit = "batch" if solver.name == EXHAUSTIVE else "generation"
    store, e = config.study.store or folder / "designs.sqlite", config.engine
    with (
        make_executor(e.name, e.workers, e.address, e.timeout) as executor,
        progress(out, each * (len(feet) + 1), unit, work) as step,
    ):
        for scenario in feet:
            alone = FootProblem(
                scenario.scene, judge.names, scenario.space(judge.space), accuracy, judge.threads
            )
            tell = telling(step, judge.guide, about=f"{scenario.name}: ")
            result = searched(alone, solver, scenario.name, tell, store, executor)
            found[scenario.name] = result.k[confirm(result, finer, options.finalists).designs[0]]
            out.print(f"specialist, {scenario.name}: {terminal.describe_search(result)}")
        problem = RobustProblem(
            scenarios, judge.names, judge.space, accuracy, judge.threads, options.measure, options.tail,
            references=compare(judge, found).references,
        )  # fmt: skip
        tell = telling(step, judge.guide, len(scenarios), f"{ROBUST}: ", " of the specialist's")
        result = searched(problem, solver, ROBUST, tell, store, executor)
    confirmed = confirm(result, finer, options.finalists)
    found[ROBUST] = result.k[confirmed.designs[0]]
    out.print(f"{ROBUST}: {terminal.describe_search(result)}")
    out.print(terminal.describe_confirmation(confirmed))

    judge.accuracy = finer
    compared = compare(judge, found)
    foot = dataclasses.replace(Foot.from_waypoints(found[ROBUST].tolist(), judge.space), name=ROBUST)
    fresh = held_out(config, scene, judge, found) if options.scenarios == "drawn" else None
    names = write(folder, judge, compared, foot, result, fresh)
    objectives = judge.walk(found[ROBUST][None])[0][0]
    record = {
        "study": "robust",
        "design": foot_entry(foot),
        "objectives": dict(zip(judge.record, objectives.tolist(), strict=True)),
        "measure": {"name": options.measure, "tail": options.tail, "of": judge.guide},
        "feet": {name: k.tolist() for name, k in found.items()},
        "scenarios": [scenario_entry(s) for s in scenarios],
        "regrets": {
            name: dict(zip([s.name for s in scenarios], row, strict=True))
            for name, row in zip(compared.names, compared.regrets.tolist(), strict=True)
        },
        "held_out_regret": None if fresh is None else fresh.tolist(),
        **scene_entry(scene, finer, judge.record),
        "search_accuracy": dataclasses.asdict(accuracy),
        "solver": dataclasses.asdict(solver),
        "seed": solver.seed,
        "evaluations": result.evaluations,
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    shown, said = report(judge, compared, foot, fresh)
    says = {name: SAYS[name] for name in names}
    summary.conclude(folder, "One foot for everything", said, says, [shown], record)


def make_scenarios(config: Config) -> tuple[Scene, tuple[Scenario, ...]]:
    """The scene of a configuration and the scenarios about it."""
    study, scene = config.study, build.make_scene(config)
    if study.scenarios not in SOURCES:
        raise SettingError("study.scenarios", study.scenarios, f"one of {', '.join(SOURCES)}")
    if study.scenarios == "sands":
        return scene, sands(scene)
    check(2 <= study.draws <= 10_000, "study.draws", study.draws, "a whole number >= 2 and <= 10,000")
    count = min(study.draws, QUICK_DRAWS) if study.quick else study.draws
    return scene, draw(scene, build.make_spread(config), count, config.solver.seed)


def searched(
    problem: FootProblem,
    solver: Solver,
    name: str,
    tell: Callable[[Generation], None],
    store: str | Path,
    executor: Executor | None,
) -> SearchResult:
    """A search whose evaluations are kept; an interrupted one ends the study."""
    try:
        result = search(problem, solver, tell, store, executor)
    except FootoptError as error:
        raise FootoptError(f"{name}: {error}") from None
    if result.interrupted:
        raise KeyboardInterrupt(f"while searching a foot for {name}")
    return result


def compare(judge: RobustProblem, found: dict[str, NDArray[np.int64]]) -> Comparison:
    """Walk with all feet in all scenarios."""
    k = np.array(list(found.values()))
    values, reasons = judge.walk_each(k)
    guide = values[..., judge.record.index(judge.guide)]
    specialists = guide[:, [name != ROBUST for name in found]]
    references = (np.nanmax if OBJECTIVES[judge.guide].maximise else np.nanmin)(specialists, axis=1)
    regrets = regret(guide, references[:, None], judge.guide).T
    return Comparison(tuple(found), k, values, reasons, references, regrets)


def held_out(
    config: Config, scene: Scene, judge: RobustProblem, found: dict[str, NDArray[np.int64]]
) -> Array:
    """Regret of the robust foot against the median scene's in fresh scenarios; NaN if one fails."""
    count = QUICK_HELD_OUT if config.study.quick else HELD_OUT
    fresh = draw(scene, build.make_spread(config), count, config.solver.seed + 1)
    problem = RobustProblem(fresh, judge.names, judge.space, judge.accuracy, judge.threads)
    values, _ = problem.walk_each(np.array([found[MEDIAN], found[ROBUST]]))
    guide = values[..., judge.record.index(judge.guide)]
    return regret(guide[:, 1], guide[:, 0], judge.guide)


def write(
    folder: Path,
    judge: RobustProblem,
    compared: Comparison,
    foot: Foot,
    result: SearchResult,
    fresh: Array | None,
) -> list[str]:
    """Tables, the robust foot's contour, and figures, whose names come back."""
    files.write_csv(
        folder / "regrets.csv",
        ["foot", "scenario", "zeta", "mass", "period", *judge.record, "reason", "regret"],
        (
            [
                name, s.name, s.scene.sand.zeta, s.scene.walker.mass, s.scene.gait.period,
                *compared.values[j, i].tolist(), str(compared.reasons[j, i]), float(compared.regrets[i, j]),
            ]
            for i, name in enumerate(compared.names)
            for j, s in enumerate(judge.scenarios)
        ),
    )  # fmt: skip
    files.write_designs(folder / "designs.csv", result.columns)
    drawings.write_csv(folder / "contour.csv", foot.contour)
    drawings.write_dxf(folder / "contour.dxf", foot.contour, foot.body_outline())
    shown = compared.names if fresh is None else (MEDIAN, ROBUST)
    soles = {
        name: Foot.from_waypoints(k.tolist(), judge.space)
        for name, k in zip(compared.names, compared.k, strict=True)
        if name in shown
    }
    scenarios = [s.name for s in judge.scenarios]
    own = float(np.sign(compared.references[0]))  # of a walk as good as the reference
    history = [
        {
            "evaluations": g.evaluations,
            "best": 100.0 * regret(np.array(g.best), np.array(own), judge.guide),
            "median": 100.0 * regret(np.array(g.median), np.array(own), judge.guide),
        }
        for g in result.history
    ]
    drawn = {
        "contours": figures.contours(soles),
        "regrets": robust_figures.regrets(compared.regrets, compared.names, scenarios),
        "convergence": figures.convergence(history, f"{judge.measure} regret (%)"),
    }
    if fresh is not None:
        drawn["held_out"] = robust_figures.held_out(fresh)
    if judge.n_obj > 1:
        columns = [judge.record.index(name) for name in judge.names]
        drawn["scatter_matrix"] = figures.scatter_matrix(
            result.values[result.front][:, columns], judge.names, marked=0
        )
    for name, figure in drawn.items():
        figures.save(figure, folder / "figures", name)
    return list(drawn)


def report(
    judge: RobustProblem, compared: Comparison, foot: Foot, fresh: Array | None
) -> tuple[RichTable, list[str]]:
    """The regrets as a table, and what follows from them."""
    scenarios = [s.name for s in judge.scenarios]
    title = judge.guide.replace("_", " ")
    columns = scenarios if len(scenarios) <= SHOWN else []
    table = terminal.table(
        ("foot", *columns, "mean", "worst", "worst in"),
        words=("foot",),
        title=f"{title} lost against the best specialist in each scenario (%)",
    )
    for name, row in zip(compared.names, 100.0 * compared.regrets, strict=True):
        cells = [f"{v:.2f}" if np.isfinite(v) else "failed" for v in row[: len(columns)]]
        if np.isfinite(row).all():
            cells += [f"{row.mean():.2f}", f"{row.max():.2f}", scenarios[int(row.argmax())]]
        else:
            cells += ["failed", "failed", scenarios[int(np.argmin(np.isfinite(row)))]]
        table.add_row(name, *cells)
    said = [f"Robust foot: {terminal.describe_foot(foot)}"]
    beaten = [
        name for i, name in enumerate(scenarios) if compared.regrets[compared.names.index(name), i] > 0.0
    ]
    if beaten:
        said.append(
            f"{', '.join(beaten)}: another specialist is better than this scenario's own, whose search did "
            "not find the best foot. Regrets are against the better one; a larger solver.n_gen may help."
        )
    if fresh is not None:
        gain = -100.0 * fresh[np.isfinite(fresh)]
        failed = f", {len(fresh) - len(gain)} with a failed walk" if len(gain) < len(fresh) else ""
        said.append(
            f"In {len(fresh)} fresh scenarios{failed} the robust foot is better than the median scene's in "
            f"{np.mean(fresh < 0.0):.0%}: {np.median(gain):+.1f} % in the median, "
            f"{gain.min():+.1f} % to {gain.max():+.1f} %"
        )
    return table, said


def scenario_entry(scenario: Scenario) -> dict[str, Any]:
    """A scenario in result.json."""
    scene = scenario.scene
    return {
        "name": scenario.name,
        "weight": scenario.weight,
        "zeta": scene.sand.zeta,
        "mass": scene.walker.mass,
        "period_s": scene.gait.period,
        "thigh_deg": scene.gait.thigh._asdict(),
        "knee_deg": scene.gait.knee._asdict(),
        "ankle_shift_m": scenario.ankle,
    }
