"""study=robust: one foot for many scenarios, and its losses against the specialist of each.

Every scenario gets its specialist, the robust foot is searched by the same solver with as many
designs, and all feet are then evaluated in all scenarios. The robust foot minimises a measure of its regret:
the relative loss against the best specialist known in a scenario.
"""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from rich.table import Table as RichTable

from footopt.arrays import Array
from footopt.design import Confirmation, FootProblem, SearchResult, Solver, confirm, search
from footopt.design.robust import RobustProblem, regret, risk
from footopt.design.scenarios import Scenario, Spread, draw, plausible_laws, sands
from footopt.design.store import typed_json
from footopt.errors import FootoptError, check
from footopt.files import io as files
from footopt.files.feet import write_foot
from footopt.foot import Foot
from footopt.report import figures, terminal
from footopt.report.numbers import title
from footopt.report.output import Step, foot_entry, report_generations, scene_entry
from footopt.studies.runs import Study
from footopt.studies.settings import Config
from footopt.walk import Simulator
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.ladder import numerics

SHOWN = 6  # scenarios that have a column in the table
ROBUST = "robust"


def run(study: Study) -> None:
    """Search the specialists and the robust foot, and report the losses of each."""
    config, options, finer = study.config, study.options, study.finer_accuracy
    solver, scene = study.solver(), study.simulator
    scenarios = make_scenarios(config, scene)
    problem = RobustProblem(
        scenarios, config.objective.names, study.space, study.accuracy, config.engine.threads,
        options.measure, options.tail, references=np.ones(len(scenarios)),
    )  # fmt: skip
    k = []  # heights of the specialists, the robust foot
    units = solver.generations(problem.space) * 2 * len(scenarios)
    with study.executor() as executor, study.progress(units, "generation") as step:
        for s in scenarios:
            space = s.space(problem.space)
            alone = FootProblem(s.scene, problem.names, space, problem.accuracy, problem.threads)
            result, confirmed = searched(study, alone, solver, s.name, finer, executor, step)
            k.append(result.k[confirmed.designs[0]])
        problem.specialists = np.array(k)
        values = problem.walk_each(problem.specialists)[0]
        problem.references = problem.bests(values)
        start = None
        if getattr(solver.build(problem.n_obj), "initialization", None) is not None:  # it can begin with them
            losses = np.nan_to_num(compare(problem, values).T, nan=np.inf)
            ranked = np.argsort(risk(losses, options.measure, options.tail), kind="stable")
            start = problem.specialists[np.sort(ranked[: next(solver.sizes())])]
        result, confirmed = searched(
            study, problem, solver, ROBUST, finer, executor, step, len(scenarios), start
        )
    study.say(terminal.describe_confirmation(confirmed))
    k.append(result.k[confirmed.designs[0]])

    judge, names = problem.at(finer), [*(s.name for s in scenarios), ROBUST]
    judge.references = np.ones(len(scenarios))  # values as they are
    values, reasons = judge.walk_each(np.array(k))
    regrets = compare(judge, values)
    soles = {name: Foot.from_waypoints(h.tolist(), judge.space) for name, h in zip(names, k, strict=True)}
    foot = replace(soles[ROBUST], name=ROBUST)
    write_foot(foot, study.folder / "contour.csv")
    if study.wants_report:
        rows = {"foot": np.repeat(names, len(scenarios)), "scenario": names[:-1] * len(names)}
        rows |= dict(zip(judge.record, values.T.reshape(len(judge.record), -1), strict=True))
        rows |= {"reason": reasons.T.ravel(), "regret": regrets.ravel()}
        files.write_csv(study.folder / "regrets.csv", rows)
        files.write_csv(study.folder / "designs.csv", result.columns)
        write_foot(foot, study.folder / "contour.dxf")
    shown = soles if len(soles) <= 1 + SHOWN else {ROBUST: soles[ROBUST]}
    study.save("contours", lambda: figures.contours(shown), "The specialists' soles and the robust one.")
    measured = zip(judge.record, judge.walk(k[-1][None])[0][0].tolist(), strict=True)
    lost = {"regret (mean)": float(regrets[-1].mean()), "regret (worst)": float(regrets[-1].max())}
    entry: dict[str, Any] = {  # no value is that of a walk
        "design": foot_entry(foot),
        "objectives": lost | {f"{name} ({options.measure})": value for name, value in measured},
        "measure": {"name": options.measure, "tail": options.tail, "of": judge.ranking_objective},
        "feet": {name: sole.k for name, sole in soles.items()},
        "hollow_mm": {name: 1e3 * sole.hollow for name, sole in soles.items()},
    }
    own = [asdict(numerics(finer, s.scene, s.space(judge.space))) for s in scenarios]
    entry["scenarios"] = [typed_json(s) | {"accuracy": one} for s, one in zip(scenarios, own, strict=True)]
    each = zip(names, regrets.tolist(), strict=True)
    entry["regrets"] = {name: dict(zip(names, row, strict=False)) for name, row in each}
    entry |= scene_entry(scene, numerics(finer, scene, judge.space), judge.record)
    for name, of in (("units", ""), ("maximise", False)):  # of the objectives here
        told = {f"{one} ({options.measure})": value for one, value in entry[name].items()}
        entry[name] = told | dict.fromkeys(lost, of)
    searching = asdict(numerics(problem.accuracy, scene, judge.space))
    entry |= {"search_accuracy": searching, "solver": asdict(solver), "seed": solver.seed}
    study.conclude(
        "One foot for everything",
        [table(judge.ranking_objective, names, regrets)],
        entry | {"evaluations": result.evaluations},
        summary=[f"Robust foot: {terminal.describe_foot(foot)}", *_remarks(names, regrets)],
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
    """The spread of the scenarios by the settings; a null zeta means that of the sand."""
    values = dict(vars(config.study.spread))
    return Spread(**values | ({"zeta": config.sand.spread} if values["zeta"] is None else {}))


def searched(
    study: Study, problem: FootProblem, solver: Solver, name: str, finer: AnyAccuracy,
    executor: Executor | None, step: Step, units: int = 1, start: Any = None,
) -> tuple[SearchResult, Confirmation]:  # fmt: skip
    """A search whose evaluations are kept, and its finalists; an interrupted one ends the study.

    `step` counts each of its generations as some units.
    """
    tell = report_generations(step, problem.ranking_objective, units, f"{name}: ")
    try:
        with study.store(problem) as store:
            result = search(problem, solver, tell, store, executor, start=start)
    except FootoptError as error:
        raise FootoptError(f"{name}: {error}") from None
    result.uninterrupted(f"searching a foot for {name}")
    study.say(f"{name}: {terminal.describe_search(result)}")
    return result, confirm(result, finer, study.options.finalists)


def compare(judge: RobustProblem, values: Array) -> Array:
    """Regrets (feet, scenarios) of feet by values (scenarios, feet, record), of the specialists first."""
    by, references = judge.ranking_objective, judge.bests(values[:, : len(judge.scenarios)])
    return regret(judge.column(values, by), references[:, None], by).T


def table(objective: str, feet: Sequence[str], regrets: Array) -> RichTable:
    """The regrets for the terminal; scenarios have the names of their specialists."""
    columns = feet[:-1] if len(feet) <= 1 + SHOWN else []
    shown = terminal.table(
        ("foot", *columns, "mean", "worst"),
        words=("foot",),
        title=f"{title(objective)} lost against the best specialist in each scenario (%)",
    )
    for name, row in zip(feet, 100.0 * regrets, strict=True):
        numbers = (*row[: len(columns)], row.mean(), row.max())
        shown.add_row(name, *(f"{v:.2f}" if np.isfinite(v) else "failed" for v in numbers))
    return shown


def _remarks(feet: Sequence[str], regrets: Array) -> list[str]:
    """Where a specialist is not the best of its scenario."""
    best = np.nanmin(regrets, axis=0, initial=np.inf)
    beaten = [name for name, own, least in zip(feet, regrets.diagonal(), best, strict=False) if own > least]
    if not beaten:
        return []
    return [
        f"{', '.join(beaten)}: another foot is better than this scenario's own, whose search did "
        "not find the best foot. Regrets are against the best specialist; a larger solver.walks may help."
    ]
