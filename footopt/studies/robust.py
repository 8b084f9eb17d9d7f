"""study=robust: one foot for many scenarios, and its losses against the specialist of each.

Every scenario gets its specialist, the robust foot is searched by the same solver with as many
designs, and all feet are then evaluated in all scenarios. The robust foot minimises a measure of its regret:
the relative loss against the best specialist known in a scenario. Of drawn scenarios, the foot for
the median scene takes part too, and both are evaluated in scenarios that neither was designed for.
"""

from __future__ import annotations

from concurrent.futures import Executor
from copy import copy
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as RichTable

from footopt.design import EXHAUSTIVE, FootProblem, SearchResult, Solver, confirm, make_executor, search
from footopt.design.result import check_finalists
from footopt.design.robust import RobustProblem, regret
from footopt.design.scenarios import Scenario, draw, plausible_laws, sands
from footopt.errors import FootoptError, check, check_whole
from footopt.files import io as files
from footopt.files.feet import write_foot
from footopt.foot import Foot, Waypoints
from footopt.report import figures, terminal
from footopt.report.figures import tables
from footopt.report.figures.search import FRONT
from footopt.report.progress import report_generations
from footopt.studies.base import Study, accuracy_entry, foot_entry, scene_entry
from footopt.studies.build import check_searchable, make_scene, make_spread
from footopt.studies.settings import Config
from footopt.studies.validation.model import model_error
from footopt.walk import MEASURES, Scene, simulate
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.ladder import numerics

Array = NDArray[np.float64]
Heights = dict[str, NDArray[np.int64]]  # of soles, by the feet's names

SOURCES = ("sands", "laws", "drawn")
HELD_OUT = 200  # fresh scenarios that test the robust foot
SHOWN = 6  # scenarios that have a column in the table
MEDIAN, ROBUST = "median scene", "robust"


class Comparison(NamedTuple):
    """All feet in all scenarios."""

    names: tuple[str, ...]  # of the feet: the scenarios' specialists, the median scene's, the robust foot
    values: Array  # (scenarios, feet, record), natural signs
    reasons: NDArray[np.str_]  # (scenarios, feet), of failed walks
    references: Array  # (scenarios,), the ranking objective of the specialist that is best in each
    regrets: Array  # (feet, scenarios), against these


def run(study: Study) -> None:
    """Search the specialists and the robust foot, and report the losses of each."""
    config, options, finer = study.config, study.options, study.finer_accuracy
    check_searchable(config.foot)
    check_finalists(options.finalists)
    drawn = options.scenarios == "drawn"
    scene, scenarios = make_scenarios(config)
    problem = RobustProblem(
        scenarios, config.objective.names, study.space, study.accuracy, study.threads, options.measure,
        options.tail, references=np.ones(len(scenarios)),
    )  # fmt: skip
    solver = Solver(**vars(config.solver)).fitting(problem.n_obj)
    solver.build(problem.n_obj)  # what does not fit is refused before anything is simulated
    solver.check_space(problem.space)

    owners = (*scenarios, Scenario(MEDIAN, scene)) if drawn else scenarios
    feet: Heights = {}
    units = solver.generations(problem.space) * (len(owners) + len(scenarios))
    unit, e = "batch" if solver.name == EXHAUSTIVE else "generation", config.engine
    with (
        make_executor(e.name, e.workers, e.address, e.timeout) as executor,
        study.progress(units, unit) as step,
    ):
        for owner in owners:
            alone = FootProblem(
                owner.scene, problem.names, owner.space(problem.space), problem.accuracy, problem.threads
            )
            tell = report_generations(step, problem.ranking_objective, 1, f"{owner.name}: ")
            result = _search(study, alone, solver, owner.name, executor, tell)
            feet[owner.name] = result.k[confirm(result, finer, options.finalists).designs[0]]
            study.say(f"specialist, {owner.name}: {terminal.describe_search(result)}")
        problem.references = compare(problem, feet).references
        sought = f"{options.measure} {problem.ranking_objective} relative to the specialists'"
        tell = report_generations(step, sought, len(scenarios), f"{ROBUST}: ")
        result = _search(study, problem, solver, ROBUST, executor, tell)
    confirmed = confirm(result, finer, options.finalists)
    feet[ROBUST] = result.k[confirmed.designs[0]]
    study.say(
        f"{ROBUST}: {terminal.describe_search(result)}",
        terminal.describe_confirmation(confirmed),
    )

    judge = problem.at(finer)
    judge.references = np.ones(len(scenarios))  # values as they are
    compared = compare(judge, feet)
    soles = {name: Foot.from_waypoints(k.tolist(), judge.space) for name, k in feet.items()}
    foot = replace(soles[ROBUST], name=ROBUST)
    fresh = held_out_regret(study, scene, judge, feet) if drawn else None
    _write_files(study, judge, compared, foot, result)
    _save_figures(study, judge, compared, soles, result)
    model = model_error(simulate(foot, scene, finer), spread=make_spread(config).zeta)
    objectives, names = judge.walk(feet[ROBUST][None])[0][0], [s.name for s in scenarios]
    study.conclude(
        "One foot for everything",
        [table(judge, compared)],
        {
            "design": foot_entry(foot),
            "objectives": dict(zip(judge.record, objectives.tolist(), strict=True)),
            "model_error": model,
            "measure": {"name": options.measure, "tail": options.tail, "of": judge.ranking_objective},
            "feet": {name: k.tolist() for name, k in feet.items()},
            "hollow_mm": {name: 1e3 * sole.hollow for name, sole in soles.items()},
            "scenarios": [scenario_entry(s, finer, judge.space) for s in scenarios],
            "regrets": {
                name: dict(zip(names, row, strict=True))
                for name, row in zip(compared.names, compared.regrets.tolist(), strict=True)
            },
            "held_out_regret": None if fresh is None else fresh.tolist(),
            **scene_entry(scene, numerics(finer, scene, judge.space), judge.record),
            "search_accuracy": accuracy_entry(problem.accuracy, scene, judge.space),
            "solver": asdict(solver),
            "seed": solver.seed,
            "evaluations": result.evaluations,
        },
        summary=[
            f"Robust foot: {terminal.describe_foot(foot)}",
            *_remarks(names, compared, fresh),
            *terminal.describe_model([model]),
        ],
    )


def make_scenarios(config: Config) -> tuple[Scene, tuple[Scenario, ...]]:
    """The scene of the settings and the scenarios about it."""
    options, scene = config.study, make_scene(config)
    check(options.scenarios in SOURCES, "study.scenarios", options.scenarios, f"one of {', '.join(SOURCES)}")
    if options.scenarios == "drawn":
        check_whole(options.draws, "study.draws", 2, 10_000)
        return scene, draw(scene, make_spread(config), options.draws, config.solver.seed)
    return scene, sands(scene) if options.scenarios == "sands" else plausible_laws(scene)


def _search(
    study: Study, problem: FootProblem, solver: Solver, name: str, executor: Executor | None, tell: Any
) -> SearchResult:
    """A search whose evaluations are kept; an interrupted one ends the study."""
    try:
        with study.store(problem) as store:
            result = search(problem, solver, tell, store, executor)
    except FootoptError as error:
        raise FootoptError(f"{name}: {error}") from None
    if result.interrupted:
        raise KeyboardInterrupt(f"while searching a foot for {name}")
    return result


def compare(judge: RobustProblem, feet: Heights) -> Comparison:
    """Evaluate all feet in all scenarios."""
    values, reasons = judge.walk_each(np.array(list(feet.values())))
    ranked = values[..., judge.record.index(judge.ranking_objective)]
    specialists = ranked[:, [name != ROBUST for name in feet]]
    sign = MEASURES[judge.ranking_objective].sign
    references = sign * np.nanmin(sign * specialists, axis=1)
    regrets = regret(ranked, references[:, None], judge.ranking_objective).T
    return Comparison(tuple(feet), values, reasons, references, regrets)


def held_out_regret(study: Study, scene: Scene, judge: RobustProblem, feet: Heights) -> Array:
    """Regret of the robust foot against the median scene's in fresh scenarios; NaN if one fails."""
    fresh = copy(judge)
    fresh.scenarios = draw(scene, make_spread(study.config), HELD_OUT, study.seed + 1)
    values, _ = fresh.walk_each(np.array([feet[MEDIAN], feet[ROBUST]]))
    ranked = values[..., judge.record.index(judge.ranking_objective)]
    return regret(ranked[:, 1], ranked[:, 0], judge.ranking_objective)


def _write_files(
    study: Study, judge: RobustProblem, compared: Comparison, foot: Foot, result: SearchResult
) -> None:
    """The robust foot's contour; for a report, the regrets and every evaluated design."""
    rows = (
        [name, s.name, *compared.values[j, i].tolist(), compared.reasons[j, i], compared.regrets[i, j]]
        for i, name in enumerate(compared.names)
        for j, s in enumerate(judge.scenarios)
    )
    write_foot(foot, study.folder / "contour.csv")
    if study.wants_report:
        study.write_csv("regrets.csv", ["foot", "scenario", *judge.record, "reason", "regret"], rows)
        files.write_csv(study.folder / "designs.csv", result.columns)
        write_foot(foot, study.folder / "contour.dxf")


def _save_figures(
    study: Study, judge: RobustProblem, compared: Comparison, soles: dict[str, Foot], result: SearchResult
) -> None:
    """The soles, the regrets and, of several objectives, the front."""
    shown = {name: soles[name] for name in (MEDIAN, ROBUST)} if MEDIAN in soles else soles
    caption = "The specialists' soles and the robust one, or the median scene's."
    study.save("contours", figures.contours(shown), caption)
    regrets = tables.regrets(compared.regrets, compared.names, [s.name for s in judge.scenarios])
    study.save("regrets", regrets, "The loss of each foot in each scenario against the best specialist.")
    if judge.n_obj > 1:
        columns = [judge.record.index(name) for name in judge.names]
        front = result.values[result.shown][:, columns]
        drawn = figures.scatter_matrix({FRONT: front}, judge.names, {"chosen": front[0]})
        study.save("scatter_matrix", drawn, "The Pareto front of the robust search, pair by pair.")


def table(judge: RobustProblem, compared: Comparison) -> RichTable:
    """The regrets for the terminal."""
    scenarios = [s.name for s in judge.scenarios]
    title = judge.ranking_objective.replace("_", " ")
    columns = scenarios if len(scenarios) <= SHOWN else []
    shown = terminal.table(
        ("foot", *columns, "mean", "worst"),
        words=("foot",),
        title=f"{title} lost against the best specialist in each scenario (%)",
    )
    for name, row in zip(compared.names, 100.0 * compared.regrets, strict=True):
        numbers = (*row[: len(columns)], row.mean(), row.max())
        shown.add_row(name, *(f"{v:.2f}" if np.isfinite(v) else "failed" for v in numbers))
    return shown


def _remarks(scenarios: list[str], compared: Comparison, fresh: Array | None) -> list[str]:
    """Where a specialist is not the best of its scenario, and the gain in fresh scenarios."""
    remarks = []
    if beaten := [name for i, name in enumerate(scenarios) if compared.regrets[i, i] > 0.0]:
        remarks.append(
            f"{', '.join(beaten)}: another specialist is better than this scenario's own, whose search did "
            "not find the best foot. Regrets are against the better one; a larger solver.walks may help."
        )
    if fresh is not None:
        gain = -100.0 * fresh[np.isfinite(fresh)]
        failed = f", {len(fresh) - len(gain)} with a failed walk" if len(gain) < len(fresh) else ""
        remarks.append(
            f"In {len(fresh)} fresh scenarios{failed} the robust foot is better than the median scene's in "
            f"{100 * np.mean(fresh < 0.0):.0f} %: {np.median(gain):+.1f} % in the median, "
            f"{gain.min():+.1f} % to {gain.max():+.1f} %"
        )
    return remarks


def scenario_entry(scenario: Scenario, accuracy: AnyAccuracy, space: Waypoints) -> dict[str, Any]:
    """A scenario in result.json, with the numbers that an accuracy comes to in it."""
    scene = scenario.scene
    return {
        "name": scenario.name,
        "zeta": scene.sand.zeta,
        "mass": scene.walker.mass,
        "period_s": scene.gait.period,
        "thigh_deg": scene.gait.thigh._asdict(),
        "knee_deg": scene.gait.knee._asdict(),
        "ankle_shift_m": scenario.ankle,
        "accuracy": accuracy_entry(accuracy, scene, scenario.space(space)),
    }
