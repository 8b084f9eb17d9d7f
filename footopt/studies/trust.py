"""Can a search be trusted? Every solver against the exact answer, on a space small enough to know it.

Every design of the space is walked once on each of the three sands; the solvers then search the
table, many times each. `solver.pop_size` is theirs too; `study.budget` is what each may ask for.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table as RichTable

from footopt.design import SINGLE, SOLVERS, FootProblem, Solver, search
from footopt.design.truth import BATCH, REACHED, Attempt, Tabulated, judge, walk_all
from footopt.errors import SettingError, check
from footopt.foot.waypoints import written
from footopt.report import terminal
from footopt.report.figures.trust import trust
from footopt.sand import Sand
from footopt.studies.accuracy import SANDS
from footopt.studies.base import Study


class Score(NamedTuple):
    """All attempts of a solver on one sand.

    Parameters
    ----------
    sand, solver : str
        Whose they are.
    found : float
        Share that came upon the design with the best J_W.
    regret : float
        Median of J_W's, relative.
    found_at : float
        Median evaluations until the optimum, or of several objectives `truth.REACHED` of the exact
        hypervolume; infinite if half of the attempts never came that far.
    hypervolume, igd_plus : float
        Medians, against the exact front; NaN for one objective.
    """

    sand: str
    solver: str
    found: float
    regret: float
    found_at: float
    hypervolume: float
    igd_plus: float


def run(study: Study) -> None:
    """Walk with the whole space, let every solver search it, and say what each was worth."""
    options, space = study.options, study.space
    check(1 <= options.seeds <= 1000, "study.seeds", options.seeds, "a whole number >= 1 and <= 1000")
    size = study.config.solver.pop_size or 100
    allowed = f"at least one generation, {size}, and <= 1e7"
    check(size <= options.budget <= 10**7, "study.budget", options.budget, allowed)
    names = list(SOLVERS) if options.solvers is None else options.solvers
    if unknown := [name for name in names if name not in SOLVERS]:
        raise SettingError("study.solvers", unknown, f"some of {', '.join(SOLVERS)}")
    seeds, generations = 2 if options.quick else options.seeds, options.budget // size
    solvers = [
        Solver(name, size, generations, seed)
        for seed in range(study.seed, study.seed + seeds)  # each round has all of them
        for name in names
    ]
    attempts: dict[str, list[Attempt]] = {}
    exact: dict[str, dict[str, Any]] = {}
    designs = space.K**space.n
    with study.progress(len(SANDS) * (-(-designs // BATCH) + len(solvers)), "task") as step:
        for sand in SANDS:
            scene = replace(study.scene, sand=Sand.named(sand))
            problem = FootProblem(scene, "pareto", space, study.accuracy, study.threads)
            news = f"walking with all {space.K}^{space.n} soles on {sand} sand"
            walked = walk_all(problem, partial(step, news))
            single, several = (Tabulated(problem, walked, name) for name in ("efficiency", "pareto"))
            exact[sand] = {
                "efficiency": single.optimum,
                "k": single.best_k.tolist(),
                "front": len(several.front),
                "feasible": single.feasible,
            }
            attempts[sand] = []
            for solver in solvers:
                truth = single if solver.name in SINGLE else several
                attempts[sand].append(judge(search(truth, solver), truth))
                step(news=f"{solver.name}, seed {solver.seed}, on {sand} sand")
    scores = [score(sand, name, attempts[sand]) for sand in SANDS for name in names]
    study.write_csv(
        "trust.csv",
        ["sand", "solver", "seed", "regret", "found_at", "hypervolume", "igd_plus"],
        (
            [sand, a.solver, a.seed, a.regret, a.found_at, a.hypervolume, a.igd_plus]
            for sand in SANDS
            for a in attempts[sand]
        ),
    )
    evaluations = size * generations
    caption = "What each search came to, for every solver and sand, against the exact answer."
    study.save("trust", trust(attempts, names, evaluations), caption)
    study.conclude(
        "Solvers against the exact answer",
        [table(scores, f"{seeds} searches each among {designs} soles", evaluations)],
        {
            "seed": study.seed,
            "designs": designs,
            "accuracy": asdict(study.accuracy),
            "seeds": seeds,
            "evaluations": evaluations,
            "exact": exact,
            "scores": [s._asdict() for s in scores],
        },
        said=[
            f"{sand} sand: {e['feasible']} of {designs} soles are feasible, {e['front']} on the "
            f"exact front; best J_W {terminal.number(e['efficiency'])} with k = {written(e['k'])}"
            for sand, e in exact.items()
        ],
    )


def score(sand: str, solver: str, attempts: list[Attempt]) -> Score:
    """What one solver's attempts on a sand come to."""
    own = [a for a in attempts if a.solver == solver]
    return Score(
        sand=sand,
        solver=solver,
        found=float(np.mean([a.hit for a in own])),
        regret=float(np.median([a.regret for a in own])),
        found_at=float(np.median([a.found_at if np.isfinite(a.found_at) else np.inf for a in own])),
        hypervolume=float(np.median([a.hypervolume for a in own])),
        igd_plus=float(np.median([a.igd_plus for a in own])),
    )


def table(scores: list[Score], what: str, evaluations: int) -> RichTable:
    """Scores for the terminal, the sands apart."""
    numbers = ("best J_W found", "median regret", "evaluations until found", "hypervolume", "IGD+")
    words = ("sand", "solver")
    shown = terminal.table((*words, *numbers), words, title=f"{what}, {evaluations} evaluations")
    for i, s in enumerate(scores):
        found_at = f"{s.found_at:.0f}" if np.isfinite(s.found_at) else f"> {evaluations}"
        front = ("", "") if s.solver in SINGLE else (f"{s.hypervolume:.1%}", f"{s.igd_plus:.3f}")
        last = i + 1 < len(scores) and scores[i + 1].sand != s.sand
        shown.add_row(
            s.sand, s.solver, f"{s.found:.0%}", f"{s.regret:.2%}", found_at, *front, end_section=last
        )
    shown.caption = f"found: the optimum; of several objectives {REACHED:.0%} of the exact hypervolume"
    return shown
