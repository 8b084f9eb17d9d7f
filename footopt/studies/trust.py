"""Can a search be trusted? Every solver against the exact answer, on a space small enough to know it.

Every design of the space is walked once on each of the three sands; the solvers then search the
table, many times each. `solver.pop_size` is theirs too; `study.budget` is what each may ask for.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from rich.table import Table as RichTable

from footopt.design import EXHAUSTIVE, SINGLE, SOLVERS, FootProblem, Solver, search
from footopt.design.truth import BATCH, REACHED, Attempt, Tabulated, judge, walk_all
from footopt.errors import SettingError, check
from footopt.files import run as files
from footopt.report import figures, summary, terminal
from footopt.report.figures.trust import trust
from footopt.report.progress import progress
from footopt.sand import Sand
from footopt.studies import build
from footopt.studies.accuracy import SANDS
from footopt.studies.base import Study

WALKED_IN_A_SEARCH = 2500  # designs that are walked in the time of one search, about


@dataclass(frozen=True)
class Score:
    """All attempts of a solver on one sand.

    found : share that came upon the design with the best J_W. regret : median, of J_W, relative.
    found_at : median evaluations until the optimum, or of several objectives `truth.REACHED` of the
        exact hypervolume; infinite if half of the attempts never came that far.
    hypervolume, igd_plus : medians, against the exact front; NaN for one objective.
    """

    sand: str
    solver: str
    found: float
    regret: float
    found_at: float
    hypervolume: float
    igd_plus: float


def run(study: Study) -> None:
    """Walk the space, let every solver search it, and write what each was worth."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    options = config.study
    check(1 <= options.seeds <= 1000, "study.seeds", options.seeds, "a whole number >= 1 and <= 1000")
    size = config.solver.pop_size if config.solver.name != EXHAUSTIVE else 100
    check(
        size <= options.budget <= 10**7,
        "study.budget",
        options.budget,
        f"at least one generation, {size}, and <= 1e7",
    )
    names = list(SOLVERS) if options.solvers is None else options.solvers
    if unknown := [name for name in names if name not in SOLVERS]:
        raise SettingError("study.solvers", unknown, f"some of {', '.join(SOLVERS)}")
    scene, space = build.make_scene(config), build.make_space(config.foot)
    accuracy = build.make_accuracy(config.accuracy)
    seeds = 2 if options.quick else options.seeds
    solvers = [
        Solver(name, size, options.budget // size, seed)
        for seed in range(config.solver.seed, config.solver.seed + seeds)  # each round has all of them
        for name in names
    ]
    attempts: dict[str, list[Attempt]] = {}
    exact: dict[str, dict[str, Any]] = {}
    parts = -(-(space.K**space.n) // BATCH)
    work = len(SANDS) * (parts * BATCH / WALKED_IN_A_SEARCH + len(solvers))
    with progress(out, len(SANDS) * (parts + len(solvers)), "task", work) as step:
        for sand in SANDS:
            problem = FootProblem(
                replace(scene, sand=Sand.named(sand)), "pareto", space, accuracy, config.engine.threads
            )
            all_soles = f"walking with all {space.K}^{space.n} soles on {sand} sand"
            table = walk_all(problem, partial(step, BATCH / WALKED_IN_A_SEARCH, all_soles))
            truths = {
                True: Tabulated(problem, table, "efficiency"),
                False: Tabulated(problem, table, "pareto"),
            }
            exact[sand] = {
                "efficiency": truths[True].optimum,
                "k": truths[True].best_k.tolist(),
                "front": len(truths[False].front),
                "feasible": truths[True].feasible,
            }
            attempts[sand] = []
            for solver in solvers:
                truth = truths[solver.name in SINGLE]
                attempts[sand].append(judge(search(truth, solver), truth))
                step(news=f"{solver.name}, seed {solver.seed}, on {sand} sand")
    scores = [score(sand, name, attempts[sand]) for sand in SANDS for name in names]
    files.write_csv(
        folder / "trust.csv",
        ["sand", "solver", "seed", "regret", "found_at", "hypervolume", "igd_plus"],
        (
            [sand, a.solver, a.seed, a.regret, a.found_at, a.hypervolume, a.igd_plus]
            for sand in SANDS
            for a in attempts[sand]
        ),
    )
    figures.save(trust(attempts, names, size * (options.budget // size)), folder / "figures", "trust")
    record = {
        "study": "trust",
        "seed": config.solver.seed,
        "designs": space.K**space.n,
        "accuracy": dataclasses.asdict(accuracy),
        "seeds": seeds,
        "evaluations": size * (options.budget // size),
        "exact": exact,
        "scores": [dataclasses.asdict(s) for s in scores],
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    shown = _table(scores, space.K**space.n, seeds, size * (options.budget // size))
    said = [
        f"{sand} sand: {e['feasible']} of {space.K**space.n} soles are feasible, {e['front']} on the "
        f"exact front; best J_W {terminal.number(e['efficiency'])} with k = {e['k']}"
        for sand, e in exact.items()
    ]
    says = {"trust": "What each search came to, for every solver and sand, against the exact answer."}
    summary.conclude(folder, "Solvers against the exact answer", said, says, [shown], record)


def score(sand: str, solver: str, attempts: list[Attempt]) -> Score:
    """What one solver's attempts on a sand come to."""
    own = [a for a in attempts if a.solver == solver]
    late = [a.found_at if np.isfinite(a.found_at) else np.inf for a in own]
    return Score(
        sand=sand,
        solver=solver,
        found=float(np.mean([a.hit for a in own])),
        regret=float(np.median([a.regret for a in own])),
        found_at=float(np.median(late)),
        hypervolume=float(np.median([a.hypervolume for a in own])),
        igd_plus=float(np.median([a.igd_plus for a in own])),
    )


def _table(scores: list[Score], designs: int, seeds: int, evaluations: int) -> RichTable:
    table = terminal.table(
        (
            "sand",
            "solver",
            "best J_W found",
            "median regret",
            "evaluations until found",
            "hypervolume",
            "IGD+",
        ),
        words=("sand", "solver"),
        title=f"{seeds} searches each among {designs} soles, {evaluations} evaluations",
    )
    for i, s in enumerate(scores):
        single = s.solver in SINGLE
        found_at = f"{s.found_at:.0f}" if np.isfinite(s.found_at) else f"> {evaluations}"
        table.add_row(
            s.sand,
            s.solver,
            f"{s.found:.0%}",
            f"{s.regret:.2%}",
            found_at,
            "" if single else f"{s.hypervolume:.1%}",
            "" if single else f"{s.igd_plus:.3f}",
            end_section=i + 1 < len(scores) and scores[i + 1].sand != s.sand,
        )
    table.caption = f"found: the optimum; of several objectives {REACHED:.0%} of the exact hypervolume"
    return table
