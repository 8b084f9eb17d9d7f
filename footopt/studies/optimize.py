"""Which foot should I print? Search the design space, and leave the best foot in every form."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from footopt.design import (
    EXHAUSTIVE,
    FootProblem,
    SearchResult,
    Solver,
    Store,
    confirm,
    make_executor,
    search,
)
from footopt.design.exhaustive import Enumeration, check_size
from footopt.design.result import check_finalists
from footopt.files import run as files
from footopt.foot import Foot
from footopt.foot.export import write_all
from footopt.report import figures, film, page, terminal
from footopt.report.progress import progress, telling
from footopt.studies import build
from footopt.studies.auto import settle
from footopt.studies.base import Study
from footopt.studies.record import foot_entry, scene_entry, validity_entry
from footopt.walk import OBJECTIVES, Accuracy, Walk, estimate_error, gain_shares, simulate
from footopt.walk.validity import diagnose

LEADERS = 4  # best soles of an enumerated space that are drawn in one frame


def run(study: Study) -> None:
    """Search, then walk with the best foot and write everything about it to `folder`."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    build.check_searchable(config.foot)
    if config.study.video is not None:
        film.check_film(folder / config.study.video, setting="study.video")
    c = config.solver
    solver = Solver(c.name, c.pop_size, c.n_gen, c.seed)
    scene, audits = settle(config, None, out)
    problem = FootProblem(
        scene,
        config.objective.names,
        build.make_space(config.foot),
        build.make_accuracy(config.accuracy),
        config.engine.threads,
    )
    if solver.name == EXHAUSTIVE:  # what does not fit is refused before the search
        check_size(problem)
    else:
        solver.build(problem.n_obj)
    check_finalists(config.study.finalists)
    finer = Accuracy.named(config.study.confirm) if config.study.confirm else problem.accuracy
    flat = Foot.flat(problem.space)
    e = config.engine
    with (
        make_executor(e.name, e.workers, e.address, e.timeout) as executor,
        Store(config.study.store or folder / "designs.sqlite", problem) as store,
    ):
        with terminal.told_if_slow(out, "Compiling the walk; this is done once and kept on disk ..."):
            base = simulate(flat, problem.scene, finer)
        out.print(
            f"Searching {problem.space.K}^{problem.space.n} soles for {', '.join(problem.names)} on "
            f"{terminal.describe_scene(problem.scene)} with {solver.name}"
        )
        if known := store.describe():
            out.print(known)
        unit = "batch" if solver.name == EXHAUSTIVE else "generation"
        with progress(out, solver.generations(problem.space), unit) as step:
            result = search(problem, solver, telling(step, problem.guide), store, executor)
    if result.interrupted:
        out.print("Stopped: reporting what was found so far (Ctrl-C again: not even that)")
    confirmed = confirm(result, finer, config.study.finalists)
    best = dataclasses.replace(
        Foot.from_waypoints(result.k[confirmed.designs[0]], problem.space), name=f"best of {solver.name}"
    )
    walk = simulate(best, problem.scene, finer)
    errors = estimate_error(best, problem.scene, finer)
    diagnostics = diagnose(walk)
    entry = {
        "study": "optimize",
        "design": foot_entry(best),
        "objectives": {name: walk.objectives[name] for name in problem.record},
        "error_estimate": {name: errors[name] for name in problem.record},
        "flat": {name: base.objectives[name] for name in problem.record},
        "gain_shares": gain_shares(walk.objectives, base.objectives),
        **scene_entry(problem.scene, finer, problem.record),
        "search_accuracy": dataclasses.asdict(problem.accuracy),
        "confirmed": {
            "k": result.k[confirmed.designs].tolist(),
            "values": confirmed.values,
            "columns": problem.record,
            "agrees": confirmed.agrees,
            "largest_change": confirmed.largest_change,
        },
        **validity_entry(diagnostics),
        "solver": dataclasses.asdict(result.solver),
        "seed": result.solver.seed,
        "evaluations": result.evaluations,
        "designs": result.designs,
        "reused": result.reused,
        "infeasible": result.infeasible,
        "reasons": result.failures,
        "front": result.k[result.front].tolist() if problem.n_obj > 1 else [],
        "interrupted": result.interrupted,
        "search_time_s": result.seconds,
        "effects_audit": audits,
        "settings": settings,
        "versions": files.versions(),
    }
    files.write_designs(folder / "designs.csv", result.columns)
    files.write_walk(folder / "walk.nc", walk.variables, {"reason": walk.reason})
    _, notes = write_all(best, folder, config.foot.block)
    files.write_json(folder / "result.json", entry | {"notes": notes, "wall_time_s": clock()})
    marked = int(np.argmax(result.front == confirmed.designs[0]))
    draw(result, marked, best, walk, base, folder / "figures")
    shown = page.search_content(result, confirmed, walk, base, entry | {"wall_time_s": clock()})
    page.write(folder / "report.html", shown)
    if config.study.video is not None:
        film.animate(walk, folder / config.study.video)

    out.print(terminal.describe_search(result))
    out.print(terminal.describe_confirmation(confirmed))
    which = "Best design" if problem.n_obj == 1 else "Of the front the best in J_W"
    out.print(f"{which}: {terminal.describe_foot(best)}")
    feet = [("best", walk.objectives), ("flat", base.objectives)]
    out.print(terminal.objective_table(feet, problem.record, errors, gain=True))
    terminal.print_validity(out, diagnostics)
    for note in notes:
        out.print(note)
    terminal.everything_is_in(out, folder, clock())
    if result.interrupted:
        done, every = len(result.history), solver.generations(problem.space)
        raise KeyboardInterrupt(f"after {unit} {done} of {every}, with a full report")


def draw(result: SearchResult, marked: int, best: Foot, walk: Walk, flat: Walk, folder: Path) -> None:
    """All figures of a search; `marked` is the best design's place in the front."""
    problem = result.problem
    walks = {"best": walk, "flat": flat}
    drawn = {
        "contour": figures.contour(best),
        "com": figures.com(walks),
        "forces": figures.forces(walks),
        "power_work": figures.power_work(walks),
        "step": figures.step(walk),
    }
    if not isinstance(result, Enumeration):
        drawn["convergence"] = figures.convergence(result.history, OBJECTIVES[problem.guide].label)
    elif problem.n_obj == 1:
        leaders = enumerate(result.k[:LEADERS], start=1)
        drawn["contours"] = figures.contours(
            {f"no. {i}": Foot.from_waypoints(k, problem.space) for i, k in leaders}
        )
    if problem.n_obj > 1:
        columns = [problem.record.index(name) for name in problem.names]
        values = result.values[result.front][:, columns]
        drawn["scatter_matrix"] = figures.scatter_matrix(values, problem.names, marked=marked)
        drawn["parallel"] = figures.parallel(values, problem.names, marked=marked)
    for name, figure in drawn.items():
        figures.save(figure, folder, name)
