"""study=optimize: search the design space, and leave the best foot, and the foot to print, in every form."""

import math
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np
from rich.text import Text

from footopt.design import (
    EXHAUSTIVE,
    FRONT_RULES,
    Confirmation,
    Evaluator,
    FootProblem,
    SearchResult,
    Solver,
    confirm,
    search,
    under_laws,
)
from footopt.design.certificate import Certificate, certified
from footopt.design.fronts import excess
from footopt.errors import check
from footopt.files import io as files
from footopt.files.feet import write_all
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.numbers import change, counted, number, percent, quantity, title
from footopt.report.output import foot_entry, report_generations
from footopt.studies.build import make_problem, make_start
from footopt.studies.effects import choose_effects
from footopt.studies.runs import Study
from footopt.studies.simulate import check_files, walk_entry, write_film, write_walk
from footopt.walk import MEASURES, Accuracy, Diagnostic, Walk, gain_shares, simulate
from footopt.walk.ladder import SHARE, ladder, numerics
from footopt.walk.objectives import floors


class Findings(NamedTuple):
    """The best foot under other laws, and the foot to print; all is empty if there are no other laws."""

    entry: dict[str, Any]  # in result.json
    ranges: dict[str, list[float]]  # of the best foot's changes from the flat one under the others, by name
    rank: str  # under how many laws it is better than the flat one; ends with a space
    to_print: Foot | None = None  # the foot that loses least under the worst law
    printed: tuple[str, ...] = ()  # that foot in two lines; in one if it is the best one
    beaten: bool = False  # whether that foot is better than the best one by the run's own law


def run(study: Study) -> Any:
    """Search, then walk with the best foot and leave everything about it; returns its values."""
    options, share = study.options, study.options.laws
    check(share is None or 0.0 < share <= 1.0, "study.laws", share, "null, or a share > 0 and <= 1")
    solver = study.solver()
    check_files(study, Foot.flat(study.space))
    scene, chosen = choose_effects(study)
    problem = make_problem(study.config, scene)
    study.say(terminal.describe_setup(scene, problem.space))
    with study.compiling():
        flat = simulate(Foot.flat(problem.space), scene, study.finer_accuracy)
    result, confirmed, certificate = _search(study, problem, solver, flat.objectives["efficiency"])
    k = result.k[confirmed.designs[0]]
    best = replace(Foot.from_waypoints(k, problem.space), name=f"best of {solver.name}")
    walk = simulate(best, scene, study.finer_accuracy)
    entry, diagnostics = walk_entry(study, walk, flat, problem.record, chosen)
    values, base = entry["objectives"], entry["flat"]
    laws = _under_laws(study, result, confirmed)

    if study.wants_report:
        files.write_csv(study.folder / "designs.csv", result.columns)
    if study.wants_figures:
        _draw(study, result, int(confirmed.designs[0]), base)
    notes = write_walk(study, walk, {_role(problem): walk, "flat": flat})
    if laws.to_print is not None:
        write_all(laws.to_print, study.folder, study.config.foot.block, "to_print")
    remarks = [*_warnings(problem, values, base, laws), *terminal.describe_few(result)]
    record = study.write_result(
        {
            "design": foot_entry(best),
            **entry,
            "remarks": remarks,
            **laws.entry,
            "gain_shares": gain_shares(values, base, floors(scene)),
            **_search_entry(result, confirmed, options.finalists),
            "certificate": certificate and {"says": str(certificate), **asdict(certificate)},
            "notes": notes,
        }
    )
    if study.wants_report:
        from footopt.report import page

        shown = page.search_content(result, confirmed, walk, flat, record)
        page.write(study.folder / "report.html", shown | study.origin)
    write_film(study, walk)
    _tell(study, walk, entry, diagnostics, laws, result, confirmed, certificate)
    for words in remarks:
        terminal.warn(study.console, words)
    study.close("print contour.stl" if laws.to_print is None else "print to_print.stl")
    if result.interrupted:
        done, every = len(result.history), solver.generations(problem.space)
        raise KeyboardInterrupt(f"after generation {done} of {every}, with a full report")
    return values


def _under_laws(study: Study, result: SearchResult, confirmed: Confirmation) -> Findings:
    """Evaluate the best foot, soles that should lose little under every law, and the flat one under each."""
    problem, options, rank = result.problem, study.options, ""
    if not (study.wants_report and options.confirm):
        return Findings({"laws": []}, {}, rank)
    share = None if result.interrupted else options.laws
    if share is not None and problem.n_obj == 1:
        study.say("Searching the foot to print, which loses least under the worst law")
    store = options.store or study.folder / "designs.sqlite"
    with study.executor() as executor, study.compiling("a walk for each law"):
        under = under_laws(result, confirmed, study.config.sand.spread, share, store, executor)
    if len(under.laws) > 1 and problem.n_obj == 1:
        count = sum(int(losses[0] < losses[-1]) for losses in under.losses)
        rank = f"Beats flat under {count} of {len(under.laws)} laws. "
    laws = under.entry(0)
    ranges = {name: [law["change"][name] for law in laws[1:]] for name in problem.record}
    found = Findings({"laws": laws}, ranges, rank)
    chosen = None if share is None or len(under.laws) == 1 else under.steadiest
    if chosen is None:
        return found
    foot = replace(Foot.from_waypoints(under.k[chosen], problem.space), name="to print")
    printed, name = under.entry(chosen), problem.ranking_objective
    worst, of_best = float(under.worst[chosen]), float(under.worst[0])
    losses = {"worst_loss": worst, "worst_loss_of_best": of_best}
    entry = found.entry | {"to_print": {**foot_entry(foot), "laws": printed, **losses}}
    same = f"To print: this foot. It loses at most {percent(worst)} to the best found for any law."
    if chosen == 0:
        return found._replace(entry=entry, to_print=foot, printed=(same,))
    own, *others = (law["change"][name] for law in printed)
    gain = f"{title(name)} {change(name, 1.0 + own, 1.0)} ({terminal.span(name, others)})"
    told = (
        f"{gain}; loses at most {percent(worst)} to the best found for any law, the first {percent(of_best)}."
    )
    lines = (f"To print, chosen for all {len(laws)} laws: {terminal.describe_foot(foot)}", told)
    beaten = bool(under.losses[0][chosen] < under.losses[0][0])
    return found._replace(entry=entry, to_print=foot, printed=lines, beaten=beaten)


def _tell(
    study: Study, walk: Walk, entry: dict[str, Any], diagnostics: Sequence[Diagnostic], laws: Findings,
    result: SearchResult, confirmed: Confirmation, certificate: Certificate | None,
) -> None:  # fmt: skip
    """Print the answer, and what is outside the tested range; all about it with study.details."""
    values, base, errors = (entry[name] for name in ("objectives", "flat", "error_estimate"))
    problem, several = result.problem, result.problem.n_obj > 1
    sought = "efficiency" if several else problem.ranking_objective
    which = FRONT_RULES[problem.choice.by] if several else "Best foot"
    study.say(
        f"{which} for {terminal.describe_scene(walk.scene)}: {terminal.describe_foot(walk.foot)}",
        *([] if several else [terminal.headline(sought, values[sought], base[sought], laws.ranges)]),
        terminal.objective_table(_role(problem), values, base, under=laws.ranges, told="efficiency"),
        laws.rank + terminal.describe_errors(errors, values),
        _about_search(result, confirmed, certificate),
        *laws.printed,
    )
    if study.options.details:
        study.say(
            terminal.describe_search(result),
            terminal.describe_confirmation(confirmed),
            *([] if certificate is None else [str(certificate)]),
            terminal.objective_table(_role(problem), values, base, errors),
        )
        terminal.print_validity(study.console, diagnostics)
    elif outside := [d.name for d in diagnostics if d.outside]:
        told = f"{counted(len(outside), 'warning')} ({', '.join(outside)})"
        where = "report.html" if study.wants_report else "study.details=true"
        study.say(Text(f"{told}: see {where}.", style="yellow"))


def _role(problem: FootProblem) -> str:
    """What the answer is called: of several objectives a rule has chosen it."""
    return "chosen" if problem.n_obj > 1 else "best"


def _about_search(result: SearchResult, confirmed: Confirmation, certificate: Certificate | None) -> str:
    """How many soles were evaluated, and what is known of the best one, in a sentence."""
    space, told = result.problem.space, []
    if certificate is not None and certificate.holds:
        told.append(f"no better one within {counted(certificate.distance, 'waypoint')} of it")
    if not confirmed.agrees:
        told.append(f"another one was best before accuracy {confirmed.accuracy.name}")
    if result.stopped or result.interrupted:
        told.append(f"stopped {result.stopped}" if result.stopped else "interrupted")
    searched, every = f"{result.designs:,} of {space.K}^{space.n} soles", result.solver.name == EXHAUSTIVE
    if every and not (result.interrupted or result.stopped):
        searched = f"all {space.K}^{space.n} soles, of which {result.designs:,} stay in their box"
    return f"Search: {'; '.join([searched, *told])}."


def _warnings(
    problem: FootProblem, values: dict[str, float], base: dict[str, float], laws: Findings
) -> list[str]:
    """Warnings about the best design: it is no better than another one, or breaks a limit."""
    said, by = [], problem.choice.by if problem.n_obj > 1 else problem.ranking_objective
    if by in MEASURES and MEASURES[by].sign * (values[by] - base[by]) >= 0.0:
        compared = f"{number(values[by])} against {number(base[by])}"
        said.append(f"The flat sole is as good or better in {title(by)}: {compared}.")
    if laws.beaten:
        said.append(f"The foot to print has the better {title(by)} by the run's own law, too: search longer.")
    said += [f"{title(n)} has no number for the best foot." for n in problem.names if math.isnan(values[n])]
    limits = [(f"constraint.{name}", name, limit) for name, limit in problem.limits.items()]
    if problem.choice.by == "limits":
        limits += [(f"choose.limits.{name}", name, limit) for name, limit in problem.choice.limits.items()]
    for setting, name, limit in limits:
        if excess(name, limit, np.array([values[name]]))[0] > 0.0:
            value = quantity(values[name], MEASURES[name].unit)
            said.append(f"The best foot breaks {setting}={limit:g} at the finer accuracy: {value}.")
    return said


def _search(
    study: Study, problem: FootProblem, solver: Solver, base: float
) -> tuple[SearchResult, Confirmation, Certificate | None]:
    """Search where `engine` says, keep every walk in the run's store, and confirm what was found."""
    space = problem.space
    with study.executor() as executor, study.store(problem) as store:
        sought = ", ".join(map(title, problem.names))
        study.say(
            f"Searching for the best {sought} among {space.K}^{space.n} soles on "
            f"{terminal.describe_scene(problem.scene)} with {solver.name}"
        )
        study.say(*_describe_ladder(problem))
        if known := store.describe():
            study.say(known)
        with study.progress(solver.generations(space), "generation") as step:
            first = problem.names[0]
            tell = report_generations(step, first, base=base if first == "efficiency" else None)
            start = make_start(study.options.start, space)
            result = search(problem, solver, tell, store, executor, start=start)
        finer, finalists = study.finer_accuracy, study.options.finalists
        if result.interrupted:
            study.say("Stopped: reporting what was found so far (Ctrl-C again: not even that)")
        asked, several = study.options.certify, problem.n_obj > 1
        if result.interrupted or several or solver.name == EXHAUSTIVE or asked is False:
            return result, confirm(result, finer, finalists), None
        most = math.inf if asked else result.designs
        return certified(result, finer, finalists, Evaluator(problem, store, executor), most)


def _search_entry(result: SearchResult, confirmed: Confirmation, finalists: int) -> dict[str, Any]:
    """A search in result.json; a front as it is when it is walked finely, the chosen design first."""
    problem, several = result.problem, result.problem.n_obj > 1
    front = confirmed.designs[confirmed.good] if several else confirmed.designs[:0]
    return {
        "objective_names": problem.names,
        "choose": asdict(problem.choice) if several else None,
        "constraints": problem.limits,
        "hypervolume": result.history[-1].hypervolume,
        "front_size": len(result.front),
        "search_accuracy": asdict(numerics(problem.accuracy, problem.scene, problem.space)),
        "confirmed": {
            "k": result.k[confirmed.designs[:finalists]].tolist(),
            "values": confirmed.values[:finalists],
            "columns": problem.record,
            "designs": len(confirmed.designs),
            "no_longer_good": int(np.sum(~confirmed.good)),
            "agrees": confirmed.agrees,
            "largest_change": confirmed.largest_change,
        },
        "solver": asdict(result.solver),
        "seed": result.solver.seed,
        "evaluations": result.evaluations,
        "designs": result.designs,
        "reused": result.reused,
        "infeasible": sum(result.failures.values()),
        "reasons": result.failures,
        "front": result.k[front].tolist(),
        "front_values": confirmed.values[confirmed.good] if several else [],
        "front_columns": problem.record,
        "interrupted": result.interrupted,
        "stopped": result.stopped,
        "search_time_s": result.seconds,
    }


def _draw(study: Study, result: SearchResult, chosen: int, flat: dict[str, float]) -> None:
    """Draw how a search went, and the front that it found."""
    from footopt.report import figures  # matplotlib takes a second

    problem, several = result.problem, result.problem.n_obj > 1
    best = [row.hypervolume if several else row.best for row in result.history]
    if result.solver.name != EXHAUSTIVE and np.isfinite(best).sum() > 1:
        relative = not several and problem.ranking_objective == "efficiency" and flat["efficiency"] < 0.0
        base = flat["efficiency"] if relative else None
        study.save("convergence", figures.convergence(result, base))
    if several:
        values = np.stack([result.column(name) for name in problem.names], axis=1)
        front = values[result.shown]
        marks = {"chosen": values[chosen], "flat sole": [flat[name] for name in problem.names]}
        drawn = figures.scatter_matrix(
            {f"{counted(len(front), 'design')} on the front": front}, problem.objectives, marks
        )
        study.save("scatter_matrix", drawn)


def _describe_ladder(problem: FootProblem) -> list[str]:
    """The parameters for a tolerance, and what finding them cost; nothing if they were set by hand."""
    if isinstance(accuracy := problem.accuracy, Accuracy):
        return []
    numbers, found = ladder(accuracy, problem.scene, problem.space)
    if not found.work > 0.0:  # no sole has walked
        return []
    worst = percent(found.error) if math.isfinite(found.error) else "some fail"
    missed = "" if found.error <= SHARE * accuracy.error else f", missed by random soles ({worst})"
    return [
        f"Errors of the five within {percent(accuracy.error)}{missed}: {numbers.plates} plates and steps of "
        f"{1e3 * numbers.dt:.3g} ms at most, found in the time of {found.price / found.work:.0f} walks"
    ]
