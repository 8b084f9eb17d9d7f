"""study=robust: one foot for many scenarios, and its losses against the specialist of each.

Every scenario gets its specialist, the robust foot is searched by the same solver with as many
designs, and all feet are then evaluated in all scenarios. The robust foot minimises a measure of its regret:
the relative loss against the best specialist known in a scenario.
"""

from concurrent.futures import Executor
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table as RichTable

from footopt.arrays import Array, Ints, Words
from footopt.design import FootProblem, SearchResult, Solver, confirm, search
from footopt.design.robust import RobustProblem, regret
from footopt.design.scenarios import Scenario, Spread, draw, plausible_laws, sands
from footopt.design.store import plain
from footopt.errors import FootoptError, SettingError, check
from footopt.files import io as files
from footopt.files.feet import write_foot
from footopt.foot import Foot
from footopt.report import figures, terminal
from footopt.report.output import foot_entry, report_generations, scene_entry
from footopt.studies import build
from footopt.studies.runs import Study
from footopt.studies.settings import Config
from footopt.walk import MEASURES, Simulator
from footopt.walk.ladder import numerics

Heights = dict[str, Ints]  # of soles, by the feet's names

SHOWN = 6  # scenarios that have a column in the table
ROBUST = "robust"


class Comparison(NamedTuple):
    """All feet in all scenarios."""

    names: tuple[str, ...]  # of the feet: the scenarios' specialists, the robust foot
    values: Array  # (scenarios, feet, record), natural signs
    reasons: Words  # (scenarios, feet), of failed walks
    references: Array  # (scenarios,), the ranking objective of the specialist that is best in each
    regrets: Array  # (feet, scenarios), against these


def run(study: Study) -> None:
    """Search the specialists and the robust foot, and report the losses of each."""
    config, options, finer = study.config, study.options, study.finer_accuracy
    solver, scene = study.solver(), study.simulator
    scenarios = make_scenarios(config, scene)
    problem = RobustProblem(
        scenarios, config.objective.names, study.space, study.accuracy, config.engine.threads,
        options.measure, options.tail, references=np.ones(len(scenarios)),
    )  # fmt: skip
    feet: Heights = {}
    units = solver.generations(problem.space) * 2 * len(scenarios)
    with study.executor() as executor, study.progress(units, solver.unit) as step:
        for owner in scenarios:
            alone = FootProblem(
                owner.scene, problem.names, owner.space(problem.space), problem.accuracy, problem.threads
            )
            tell = report_generations(step, problem.ranking_objective, 1, f"{owner.name}: ")
            result = searched(study, alone, solver, owner.name, executor, tell)
            feet[owner.name] = result.k[confirm(result, finer, options.finalists).designs[0]]
            study.say(f"specialist, {owner.name}: {terminal.describe_search(result)}")
        problem.references = compare(problem, feet).references
        sought = f"{options.measure} {problem.ranking_objective} relative to the specialists'"
        tell = report_generations(step, sought, len(scenarios), f"{ROBUST}: ")
        result = searched(study, problem, solver, ROBUST, executor, tell)
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
    _write_files(study, judge, compared, foot, result)
    shown = soles if len(soles) <= 1 + SHOWN else {ROBUST: soles[ROBUST]}
    study.save("contours", figures.contours(shown), "The specialists' soles and the robust one.")
    objectives, names = judge.walk(feet[ROBUST][None])[0][0], [s.name for s in scenarios]
    study.conclude(
        "One foot for everything",
        [table(judge, compared)],
        {
            "design": foot_entry(foot),
            "objectives": dict(zip(judge.record, objectives.tolist(), strict=True)),
            "measure": {"name": options.measure, "tail": options.tail, "of": judge.ranking_objective},
            "feet": {name: k.tolist() for name, k in feet.items()},
            "hollow_mm": {name: 1e3 * sole.hollow for name, sole in soles.items()},
            "scenarios": [
                {**plain(s), "accuracy": asdict(numerics(finer, s.scene, s.space(judge.space)))}
                for s in scenarios
            ],
            "regrets": {
                name: dict(zip(names, row, strict=True))
                for name, row in zip(compared.names, compared.regrets.tolist(), strict=True)
            },
            **scene_entry(scene, numerics(finer, scene, judge.space), judge.record),
            "search_accuracy": asdict(numerics(problem.accuracy, scene, judge.space)),
            "solver": asdict(solver),
            "seed": solver.seed,
            "evaluations": result.evaluations,
        },
        summary=[
            f"Robust foot: {terminal.describe_foot(foot)}",
            *_remarks(names, compared),
        ],
    )


def make_scenarios(config: Config, scene: Simulator) -> tuple[Scenario, ...]:
    """The scenarios that the settings ask for about a scene."""
    options = config.study
    if options.scenarios == "drawn":
        return draw(scene, make_spread(config), options.draws, config.solver.seed)
    fixed = {"sands": sands, "laws": plausible_laws}
    check(options.scenarios in fixed, "study.scenarios", options.scenarios, "sands, laws or drawn")
    return fixed[options.scenarios](scene)


def make_spread(config: Config) -> Spread:
    """How far the scenarios of the settings lie apart.

    zeta is null for that of the sand; a period or angles that are null are measured: how the strides of the
    gait's file differ.
    """
    values = dict(vars(config.study.spread))
    if values["zeta"] is None:
        values["zeta"] = config.sand.spread
    unknown = [name for name, value in values.items() if value is None]
    if not unknown:
        return Spread(**values)
    strides = build.make_strides(config.gait)
    if strides is None or len(strides.periods) < 3:
        allowed = "a number, unless gait.path records three strides or more"
        raise SettingError(f"study.spread.{unknown[0]}", None, allowed)
    measured = dict(zip(("period", "angles"), strides.variation(), strict=True))
    return Spread(**values | {name: measured[name] for name in unknown})


def searched(
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


def _remarks(scenarios: list[str], compared: Comparison) -> list[str]:
    """Where a specialist is not the best of its scenario."""
    beaten = [name for i, name in enumerate(scenarios) if compared.regrets[i, i] > 0.0]
    if not beaten:
        return []
    return [
        f"{', '.join(beaten)}: another specialist is better than this scenario's own, whose search did "
        "not find the best foot. Regrets are against the better one; a larger solver.walks may help."
    ]
