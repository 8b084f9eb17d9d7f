"""One foot for all sands? What a robust foot loses against the specialists that each scenario has.

Every scenario gets its specialist, the robust foot is searched by the same solver with as many
designs, and all feet then walk in all scenarios. The robust foot minimises a measure of its regret:
the relative loss against the best specialist known in a scenario. Of drawn scenarios, the foot for
the median scene takes part too, and both meet scenarios that neither was designed for.
"""

from __future__ import annotations

import dataclasses
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as RichTable

from footopt.design import EXHAUSTIVE, FootProblem, SearchResult, Solver, confirm, make_executor, search
from footopt.design.result import check_finalists
from footopt.design.robust import RobustProblem, regret
from footopt.design.scenarios import Scenario, draw, laws, sands
from footopt.errors import FootoptError, SettingError, check
from footopt.files import io as files
from footopt.files.feet import write_foot
from footopt.foot import Foot, Waypoints
from footopt.report import figures, terminal
from footopt.report.figures import tables
from footopt.report.figures.search import FRONT, history_label
from footopt.report.progress import Step, report_generations
from footopt.studies.base import Study, accuracy_entry, flat_efficiency, foot_entry, scene_entry
from footopt.studies.build import check_searchable, make_scene, make_spread
from footopt.studies.settings import Config, SearchSettings, SpreadConfig, default, setting
from footopt.studies.validation.model import model_error
from footopt.walk import MEASURES, Accuracy, Scene, simulate

Array = NDArray[np.float64]
Heights = dict[str, NDArray[np.int64]]  # of soles, by the feet's names

SOURCES = ("sands", "laws", "drawn")
HELD_OUT = 200  # fresh scenarios that test the robust foot
QUICK_DRAWS, QUICK_GENERATIONS, QUICK_HELD_OUT = 3, 5, 8
SHOWN = 6  # scenarios that a table on the terminal has columns for
MEDIAN, ROBUST = "median scene", "robust"


@dataclass
class Settings(SearchSettings):
    """One foot for three sands, several laws, or drawn scenes, against the specialist of each."""

    name: str = "robust"
    quick: bool = setting(False, "Whether a first look is enough: three draws, five generations.")
    scenarios: str = setting("sands", "What one foot is for: sands, laws, or drawn about the scene.")
    draws: int = setting(16, "How many scenarios are drawn.")
    measure: str = setting(
        default(RobustProblem, "measure"),
        "What counts of the loss over the scenarios: worst, mean, or tail (of the worst share).",
    )
    tail: float = setting(default(RobustProblem, "tail"), "The share of study.measure=tail.")
    spread: Any = field(default_factory=lambda: SpreadConfig(zeta=None))


@dataclass(frozen=True, eq=False)
class Comparison:
    """All feet in all scenarios.

    Parameters
    ----------
    names : (feet,)
        The scenarios' specialists, the median scene's where there is one, the robust foot.
    values : (scenarios, feet, record)
        Objectives, natural signs.
    reasons : (scenarios, feet)
        Of failed walks.
    references : (scenarios,)
        The ranking objective's value of the specialist that is best in each.
    regrets : (feet, scenarios)
        Against these.
    """

    names: tuple[str, ...]
    values: Array
    reasons: NDArray[np.str_]
    references: Array
    regrets: Array


def run(study: Study) -> None:
    """Search the specialists and the robust foot, and say what each loses."""
    config, options = study.config, study.options
    check_searchable(config.foot)
    scene, scenarios = make_scenarios(config)
    solver = Solver(**vars(config.solver))
    if options.quick:
        solver = dataclasses.replace(solver, n_gen=min(solver.n_gen or QUICK_GENERATIONS, QUICK_GENERATIONS))
    accuracy, finer = study.accuracy, study.finer_accuracy
    check_finalists(options.finalists)
    judge = RobustProblem(
        scenarios, config.objective.names, study.space, accuracy, study.threads, options.measure,
        options.tail, references=np.ones(len(scenarios)),
    )  # fmt: skip
    solver = solver.fitting(judge.n_obj)
    solver.build(judge.n_obj)  # what does not fit is refused before anything is walked
    solver.check_space(judge.space)

    owners = (*scenarios, Scenario(MEDIAN, scene)) if options.scenarios == "drawn" else scenarios
    feet: Heights = {}
    each = solver.generations(judge.space)
    units = each * (len(owners) + len(scenarios))  # the robust foot walks in all scenarios
    unit, e = "batch" if solver.name == EXHAUSTIVE else "generation", config.engine
    with (
        make_executor(e.name, e.workers, e.address, e.timeout) as executor,
        study.progress(units, unit) as step,
    ):
        for owner in owners:
            alone = FootProblem(owner.scene, judge.names, owner.space(judge.space), accuracy, judge.threads)
            result = _search(study, alone, solver, owner.name, executor, step)
            feet[owner.name] = result.k[confirm(result, finer, options.finalists).designs[0]]
            study.say(f"specialist, {owner.name}: {terminal.describe_search(result)}")
        problem = RobustProblem(
            scenarios, judge.names, judge.space, accuracy, judge.threads, options.measure, options.tail,
            references=compare(judge, feet).references,
        )  # fmt: skip
        result = _search(study, problem, solver, ROBUST, executor, step)
    confirmed = confirm(result, finer, options.finalists)
    feet[ROBUST] = result.k[confirmed.designs[0]]
    study.say(
        f"{ROBUST}: {terminal.describe_search(result)}",
        terminal.describe_confirmation(confirmed),
    )

    judge.accuracy = finer
    compared = compare(judge, feet)
    foot = dataclasses.replace(Foot.from_waypoints(feet[ROBUST].tolist(), judge.space), name=ROBUST)
    fresh = held_out_regret(study, scene, judge, feet) if options.scenarios == "drawn" else None
    _write_files(study, judge, compared, foot, result)
    _save_figures(study, judge, compared, feet, result, fresh)
    model = model_error(simulate(foot, scene, finer), spread=make_spread(config).zeta)
    objectives, regrets = judge.walk(feet[ROBUST][None])[0][0], compared.regrets.tolist()
    names = [s.name for s in scenarios]
    hollows = {name: 1e3 * Foot.from_waypoints(k.tolist(), judge.space).hollow for name, k in feet.items()}
    study.conclude(
        "One foot for everything",
        [table(judge, compared)],
        {
            "design": foot_entry(foot),
            "objectives": dict(zip(judge.record, objectives.tolist(), strict=True)),
            "model_error": model,
            "measure": {"name": options.measure, "tail": options.tail, "of": judge.ranking_objective},
            "feet": {name: k.tolist() for name, k in feet.items()},
            "hollow_mm": hollows,
            "scenarios": [scenario_entry(s, finer, judge.space) for s in scenarios],
            "regrets": {
                name: dict(zip(names, row, strict=True))
                for name, row in zip(compared.names, regrets, strict=True)
            },
            "held_out_regret": None if fresh is None else fresh.tolist(),
            **scene_entry(scene, finer, judge.record),
            "search_accuracy": dataclasses.asdict(accuracy),
            "solver": dataclasses.asdict(solver),
            "seed": solver.seed,
            "evaluations": result.evaluations,
        },
        said=[
            f"Robust foot: {terminal.describe_foot(foot)}",
            "Hollows (mm): " + ", ".join(f"{name} {depth:.1f}" for name, depth in hollows.items()),
            *_remarks(names, compared, fresh),
            *terminal.describe_model([model]),
        ],
    )


def make_scenarios(config: Config) -> tuple[Scene, tuple[Scenario, ...]]:
    """The scene of the settings and the scenarios about it."""
    options, scene = config.study, make_scene(config)
    if options.scenarios not in SOURCES:
        raise SettingError("study.scenarios", options.scenarios, f"one of {', '.join(SOURCES)}")
    if options.scenarios != "drawn":
        return scene, sands(scene) if options.scenarios == "sands" else laws(scene)
    check(
        2 <= options.draws <= 10_000,
        "study.draws",
        options.draws,
        "a whole number >= 2 and <= 10,000",
    )
    count = min(options.draws, QUICK_DRAWS) if options.quick else options.draws
    return scene, draw(scene, make_spread(config), count, config.solver.seed)


def _search(
    study: Study, problem: FootProblem, solver: Solver, name: str, executor: Executor | None, step: Step
) -> SearchResult:
    """A search whose evaluations are kept; an interrupted one ends the study."""
    units, base, scale = 1, flat_efficiency(problem), "flat"
    if isinstance(problem, RobustProblem):
        units, base, scale = len(problem.scenarios), np.sign(problem.references[0]), "the specialist's"
    try:
        tell = report_generations(step, problem.ranking_objective, units, f"{name}: ", base, scale)
        with study.store(problem) as store:
            result = search(problem, solver, tell, store, executor)
    except FootoptError as error:
        raise FootoptError(f"{name}: {error}") from None
    if result.interrupted:
        raise KeyboardInterrupt(f"while searching a foot for {name}")
    return result


def compare(judge: RobustProblem, feet: Heights) -> Comparison:
    """Walk with all feet in all scenarios."""
    values, reasons = judge.walk_each(np.array(list(feet.values())))
    ranked = values[..., judge.record.index(judge.ranking_objective)]
    specialists = ranked[:, [name != ROBUST for name in feet]]
    references = (np.nanmax if MEASURES[judge.ranking_objective].maximise else np.nanmin)(specialists, axis=1)
    regrets = regret(ranked, references[:, None], judge.ranking_objective).T
    return Comparison(tuple(feet), values, reasons, references, regrets)


def held_out_regret(study: Study, scene: Scene, judge: RobustProblem, feet: Heights) -> Array:
    """Regret of the robust foot against the median scene's in fresh scenarios; NaN if one fails."""
    count = QUICK_HELD_OUT if study.options.quick else HELD_OUT
    fresh = draw(scene, make_spread(study.config), count, study.seed + 1)
    problem = RobustProblem(fresh, judge.names, judge.space, judge.accuracy, judge.threads)
    values, _ = problem.walk_each(np.array([feet[MEDIAN], feet[ROBUST]]))
    ranked = values[..., judge.record.index(judge.ranking_objective)]
    return regret(ranked[:, 1], ranked[:, 0], judge.ranking_objective)


def _write_files(
    study: Study, judge: RobustProblem, compared: Comparison, foot: Foot, result: SearchResult
) -> None:
    """The regrets, every evaluated design, and the robust foot's contour."""
    rows = (
        [
            name, s.name, s.scene.sand.zeta, s.scene.walker.mass, s.scene.gait.period,
            *compared.values[j, i].tolist(), str(compared.reasons[j, i]), float(compared.regrets[i, j]),
        ]
        for i, name in enumerate(compared.names)
        for j, s in enumerate(judge.scenarios)
    )  # fmt: skip
    header = ["foot", "scenario", "zeta", "mass", "period", *judge.record, "reason", "regret"]
    study.write_csv("regrets.csv", header, rows)
    files.write_designs(study.folder / "designs.csv", result.columns)
    for ending in ("csv", "dxf"):
        write_foot(foot, study.folder / f"contour.{ending}")


def _save_figures(
    study: Study,
    judge: RobustProblem,
    compared: Comparison,
    feet: Heights,
    result: SearchResult,
    fresh: Array | None,
) -> None:
    """All figures, with what each shows."""
    shown = compared.names if fresh is None else (MEDIAN, ROBUST)
    soles = {name: Foot.from_waypoints(feet[name].tolist(), judge.space) for name in shown}
    caption = "The specialists' soles and the robust one, or the median scene's."
    study.save("contours", figures.contours(soles), caption)
    scenarios = [s.name for s in judge.scenarios]
    regrets = tables.regrets(compared.regrets, compared.names, scenarios)
    study.save("regrets", regrets, "What each foot loses in each scenario against the best specialist there.")
    own = np.array(np.sign(compared.references[0]))  # of a walk as good as the reference

    def percent(value: float) -> Array:
        return 100.0 * regret(np.array(value), own, judge.ranking_objective)

    history = [
        replace(g, best=float(percent(g.best)), median=float(percent(g.median))) for g in result.history
    ]
    caption = "The robust search: the best so far over its evaluations."
    label = f"{judge.measure} regret (%)" if judge.n_obj == 1 else history_label(judge.names)
    study.save("convergence", figures.convergence(history, label), caption)
    if fresh is not None:
        caption = "Regret of the robust foot against the median scene's, in scenarios that neither knew."
        study.save("held_out", tables.held_out(fresh), caption)
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
        shown.add_row(name, *cells)
    return shown


def _remarks(scenarios: list[str], compared: Comparison, fresh: Array | None) -> list[str]:
    """What is to be said of the regrets."""
    said = []
    places = {name: compared.names.index(name) for name in scenarios}
    if beaten := [name for i, name in enumerate(scenarios) if compared.regrets[places[name], i] > 0.0]:
        said.append(
            f"{', '.join(beaten)}: another specialist is better than this scenario's own, whose search did "
            "not find the best foot. Regrets are against the better one; a larger solver.walks may help."
        )
    if fresh is not None:
        gain = -100.0 * fresh[np.isfinite(fresh)]
        failed = f", {len(fresh) - len(gain)} with a failed walk" if len(gain) < len(fresh) else ""
        said.append(
            f"In {len(fresh)} fresh scenarios{failed} the robust foot is better than the median scene's in "
            f"{100 * np.mean(fresh < 0.0):.0f} %: {np.median(gain):+.1f} % in the median, "
            f"{gain.min():+.1f} % to {gain.max():+.1f} %"
        )
    return said


def scenario_entry(scenario: Scenario, accuracy: Accuracy, space: Waypoints) -> dict[str, Any]:
    """A scenario in result.json, with the numbers that an accuracy comes to in it."""
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
        "accuracy": accuracy_entry(accuracy, scene, scenario.space(space)),
    }
