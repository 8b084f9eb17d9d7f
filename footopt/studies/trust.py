"""Can a search be trusted? Every solver against the exact answer, on a space small enough to know it.

Every design of the space is walked once in every scene: on three sands, and in `study.scenes` scenes
that were drawn at random. The solvers then search the tables, many times each; `study.budget` is how many
different designs each may walk with. Tables and searches are kept in the folder: a study that is stopped
goes on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table as RichTable

from footopt.design import SINGLE, SOLVERS, FootProblem, Solver, search
from footopt.design.context import context, digest
from footopt.design.peers import PEERS, asked_by
from footopt.design.solvers.registry import COARSELY
from footopt.design.truth import (
    BATCH,
    WITHIN,
    Attempt,
    Tabulated,
    expected_walks,
    judge,
    judge_designs,
    walk_all,
)
from footopt.effects import name_of
from footopt.errors import SettingError, check
from footopt.files.tasks import Tasks
from footopt.foot.waypoints import written
from footopt.report import terminal
from footopt.report.figures.trust import trust
from footopt.report.numbers import percent
from footopt.studies.accuracy import SANDS
from footopt.studies.base import Study
from footopt.studies.record import accuracy_entry
from footopt.walk.scenarios import Scenario, anything, sands

RANDOM = "random scenes"
QUICK_SCENES, QUICK_SEEDS = 1, 2


class Score(NamedTuple):
    """All attempts of a solver on one sand, or in all random scenes.

    Parameters
    ----------
    where, solver : str
        Whose they are.
    found : float
        Share that came within `truth.WITHIN` of the best J_W.
    regret : float
        Median of J_W's, relative.
    expected : float
        Walks until within it, with restarts (`truth.expected_walks`): the geometric mean over the scenes,
        infinite if in one of them no attempt found it.
    hypervolume : float
        Median share of the exact front's; NaN for one objective.
    """

    where: str
    solver: str
    found: float
    regret: float
    expected: float
    hypervolume: float


def run(study: Study) -> None:
    """Walk with the whole space, let every solver search it, and say what each was worth."""
    options, space = study.options, study.space
    check(1 <= options.seeds <= 1000, "study.seeds", options.seeds, "a whole number >= 1 and <= 1000")
    check(0 <= options.scenes <= 1000, "study.scenes", options.scenes, "a whole number from 0 to 1000")
    size = study.config.solver.pop_size
    least = Solver("ga", size).size
    allowed = f"at least one generation, {least}, and <= 1e7"
    check(least <= options.budget <= 10**7, "study.budget", options.budget, allowed)
    known = [name for name in (*SOLVERS, *PEERS) if name not in COARSELY]  # a table has no coarse walks
    names = known if options.solvers is None else options.solvers
    if unknown := [name for name in names if name not in known]:
        raise SettingError("study.solvers", unknown[0], f"one of {', '.join(known)}")
    seeds = min(options.seeds, QUICK_SEEDS) if options.quick else options.seeds
    count = min(options.scenes, QUICK_SCENES) if options.quick else options.scenes
    for name in names:
        if name in PEERS:  # whose library is missed before all soles walk
            asked_by(name, FootProblem(space=space, accuracy="draft"), 1, study.seed)
    drawn = [anything(study.seed + i, f"random {i + 1}") for i in range(count)]
    runs = [(name, seed) for seed in range(study.seed, study.seed + seeds) for name in names]
    attempts: dict[str, list[Attempt]] = {}
    done = Tasks(study.folder / "attempts.jsonl")
    exact: dict[str, dict[str, Any]] = {}
    designs = space.K**space.n
    scenes = (*sands(study.scene, SANDS), *drawn)
    with study.progress(len(scenes) * (-(-designs // BATCH) + len(runs)), "task") as step:
        for scenario in scenes:
            problem = FootProblem(scenario.scene, "pareto", space, study.accuracy, study.threads)
            news = f"walking with all {space.K}^{space.n} soles, {scenario.name}"
            walked = walk_all(problem, partial(step, news), study.folder / "exact")
            truths = [Tabulated(problem, walked, name) for name in ("efficiency", "pareto")]
            exact[scenario.name] = answer(scenario, *truths)
            attempts[scenario.name] = []
            where = digest(context(problem))
            for name, seed in runs:
                what = (name, seed, size, options.budget)
                found = done((where, *what), partial(attempted, *what, *truths))
                attempts[scenario.name].append(Attempt(**found))
                step(news=f"{name}, seed {seed}, {scenario.name}")
    groups = {sand: [attempts[sand]] for sand in SANDS} | (
        {RANDOM: [attempts[s.name] for s in drawn]} if drawn else {}
    )
    scores = [score(where, name, scenes) for where, scenes in groups.items() for name in names]
    columns = ("solver", "seed", "walks", "regret", "within_at", "hypervolume")
    study.write_csv(
        "trust.csv",
        ["scene", *columns],
        ([name, *(getattr(a, c) for c in columns)] for name, made in attempts.items() for a in made),
    )
    caption = "What each search came to, for every solver and sand, against the exact answer."
    pooled = {where if where == RANDOM else f"{where} sand": [*chain(*own)] for where, own in groups.items()}
    study.save("trust", trust(pooled, names, options.budget), caption)
    study.conclude(
        "Solvers against the exact answer",
        [table(scores, f"{seeds} searches each among {designs} soles", options.budget)],
        {
            "seed": study.seed,
            "designs": designs,
            "accuracy": asdict(study.accuracy),
            "seeds": seeds,
            "evaluations": options.budget,
            "exact": exact,
            "scores": [s._asdict() for s in scores],
        },
        said=[describe(name, designs, found) for name, found in exact.items()],
    )


def attempt(
    name: str, seed: int, size: int | None, budget: int, single: Tabulated, several: Tabulated
) -> Attempt:
    """One search of a table; of one objective it ends with the optimum."""
    if name in PEERS:
        asked = asked_by(name, single, budget, seed, single.optimum)
        return judge_designs(name, seed, np.array(asked.designs), single)
    truth, solver = single if name in SINGLE else several, Solver(name, size, seed=seed, walks=budget)
    return judge(search(truth, solver, lambda g: truth is single and g.best <= truth.optimum), truth)


def attempted(*what: Any) -> dict[str, Any]:
    """An `attempt` in JSON's types."""
    return asdict(attempt(*what))


def answer(scenario: Scenario, single: Tabulated, several: Tabulated) -> dict[str, Any]:
    """What there is to be found, in result.json, and the scene if it was drawn."""
    found = {
        "efficiency": single.optimum,
        "k": single.best_k.tolist(),
        "front": len(several.front),
        "feasible": single.feasible,
    }
    scene, legs = scenario.scene, scenario.scene.walker.l1 + scenario.scene.walker.l2
    about = f"zeta {scene.sand.zeta:.3g}, {scene.walker.mass:.0f} kg, legs {legs:.2f} m, "
    about += f"stride {scene.gait.period:.2f} s, pitch {scene.gait.pitch}"
    about += "".join(f", {name_of(effect).replace('_', ' ')}" for effect in scene.effects)
    return found | {"scene": about, "accuracy": accuracy_entry(single.accuracy, scene, single.space)}


def describe(name: str, designs: int, found: Mapping[str, Any]) -> str:
    """The exact answer in a line."""
    return (
        f"{name} ({found['scene']}): {found['feasible']} of {designs} soles are feasible, {found['front']} "
        f"on the exact front; best J_W {terminal.number(found['efficiency'])} with k = {written(found['k'])}"
    )


def score(where: str, solver: str, scenes: Sequence[Sequence[Attempt]]) -> Score:
    """What one solver's attempts come to, in one scene or several."""
    by_scene = [[a for a in made if a.solver == solver] for made in scenes]
    own = [*chain(*by_scene)]
    with np.errstate(divide="ignore"):
        expected = np.exp(np.mean(np.log([expected_walks(made) for made in by_scene])))
    return Score(
        where=where,
        solver=solver,
        found=float(np.mean([a.hit for a in own])),
        regret=float(np.median([a.regret for a in own])),
        expected=float(expected),
        hypervolume=float(np.median([a.hypervolume for a in own])),
    )


def table(scores: list[Score], what: str, walks: int) -> RichTable:
    """Scores for the terminal, the sands apart."""
    numbers = ("J_W within 0.1 %", "median regret", "expected walks", "hypervolume")
    words = ("scene", "solver")
    shown = terminal.table((*words, *numbers), words, title=f"{what}, {walks} walks")
    for i, s in enumerate(scores):
        expected = f"{s.expected:.0f}" if np.isfinite(s.expected) else "-"
        front = "" if np.isnan(s.hypervolume) else f"{100 * s.hypervolume:.1f} %"
        last = i + 1 < len(scores) and scores[i + 1].where != s.where
        cells = (percent(s.found), percent(s.regret), expected, front)
        shown.add_row(s.where, s.solver, *cells, end_section=last)
    shown.caption = (
        f"expected: walks until J_W is within {percent(WITHIN)}, with restarts; walks are different designs; "
        "-: in one scene or more no search came that near"
    )
    return shown
