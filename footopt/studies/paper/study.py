"""The paper's study from nothing: search the feet, draw the figures, measure and judge the claims."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import partial

from footopt.errors import check
from footopt.files import run as files
from footopt.files.tasks import Tasks
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.figures import paper as paper_figures
from footopt.studies.base import Study
from footopt.studies.paper import page
from footopt.studies.paper.claims import CLAIMS, SANDS, measure
from footopt.studies.paper.judge import judge, summary
from footopt.studies.paper.readings import read
from footopt.studies.paper.setup import SOLVER, Setup, affordable
from footopt.studies.paper.sweep import Plan, sweep
from footopt.studies.record import scene_entry
from footopt.studies.validation.model import model_error
from footopt.walk import OBJECTIVES, Walk
from footopt.walk.simulate import at_once
from footopt.walk.validity import diagnose


def run(study: Study) -> None:
    """Repeat the paper: search its feet, draw its figures, judge its claims here and in a sweep."""
    config = affordable(study.config)
    for name, own in (("shape", "waypoints"), ("k", None)):
        value = getattr(config.foot, name)
        check(
            value == own, f"foot.{name}", value, f"{own}: the study chooses its feet", "Use study=simulate."
        )
    setup, solver = Setup(config), config.solver
    setup.scene("hard").need_heel_strike()
    study.say(
        f"Searching feet for {', '.join(SANDS)} sand: {SOLVER}, {config.study.seeds} times with "
        f"{solver.n_gen} generations of {solver.pop_size} designs"
    )
    with study.compiling():
        setup.shapes()
    plan = Plan.of(config)
    threads = at_once(study.threads)
    with study.progress(len(SANDS) * config.study.seeds + len(plan.changes), "task") as step:
        done = Tasks(study.folder / "tasks.jsonl")
        runs = optimise(setup, step, done)
        for sand, walks in runs.items():
            study.say(f"{sand:8s} {terminal.describe_foot(walks[0].foot)}")
        feet = {sand: dataclasses.replace(walks[0].foot, name=sand) for sand, walks in runs.items()}
        evidence = setup.evidence(feet)
        drawn = paper_figures.all_figures(evidence.shapes, evidence.optima, evidence.crossed)
        for name, figure in drawn.items():
            study.save(name, figure, paper_figures.CAPTIONS[name])
        swept = sweep(plan, feet, threads, partial(step, "sweep"), done)

    judged = {
        name: judge(float(margin), column, plan, CLAIMS[name].about)
        for name, margin, column in zip(CLAIMS, measure(evidence), swept.T, strict=True)
    }
    found = page.content(evidence, plan, judged, runs)
    study.save("claims", paper_figures.claims(found["claims"]), paper_figures.CAPTIONS["claims"])
    files.write_text(study.folder / "claims.md", page.markdown(found))
    head: tuple[str, ...] = ("figure", "claim", "margin", "share", "verdict")
    what = "What the paper says, and what comes out (margin: holds if above 0; share: of settings that agree)"
    tables = [terminal.table(head, ("figure", "claim", "verdict"), what)]
    for row in page.claim_rows(found):
        tables[0].add_row(*row)
    if config.study.samples:
        head = ("claim", "setting, with its share", "single changes that turn it")
        tables.append(terminal.table(head, head, "Which setting decides"))
        for claim, *settings, changes in page.decision_rows(found):
            tables[1].add_row(claim, ", ".join(s for s in settings if s != "-") or "none", changes)
    for sand in SANDS:
        study.say(f"The best foot for {sand} sand, on it:")
        terminal.print_validity(study.console, diagnose(evidence.optima[sand]))
    study.conclude(
        "The paper, judged",
        tables,
        {
            "seed": config.solver.seed,
            **found,
            **scene_entry(setup.scene(config.study.shape_sand), setup.accuracy, tuple(OBJECTIVES)),
            "readings": setup.readings._asdict(),
        },
        said=(
            f"{summary([j.verdict for j in judged.values()])}.",
            *terminal.describe_model(model_error(walk) for walk in evidence.optima.values()),
            "The page claims.md has all of it in words, with the feet and the errata.",
        ),
    )


def optimise(setup: Setup, step: Callable[[str], None], done: Tasks) -> dict[str, list[Walk]]:
    """Return for each sand a walk with the best foot of each seed, best first by J_W as it is read."""
    space = setup.problem(SANDS[0]).space
    found, first = {}, setup.config.solver.seed
    for sand in SANDS:
        walks = []
        for seed in range(first, first + setup.config.study.seeds):
            k = done((setup.named(sand), seed), partial(setup.heights, sand, seed))
            walks.append(setup.walk(Foot.from_waypoints(k, space), sand))
            step(f"searched for {sand} sand, seed {seed}")
        found[sand] = sorted(walks, key=lambda walk: read(walk, setup.readings).objectives["efficiency"])
    return found
