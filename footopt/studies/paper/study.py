"""The paper's study from nothing: search the feet, draw the figures, measure and judge the claims."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.design import Solver, search
from footopt.effects import LeadingEdge
from footopt.errors import FootoptError, SettingError, check
from footopt.files import run as files
from footopt.foot import Foot
from footopt.report import figures, terminal
from footopt.report.figures import paper as paper_figures
from footopt.report.page import write_study
from footopt.report.progress import progress
from footopt.sand import Sand
from footopt.studies import build
from footopt.studies.base import Study
from footopt.studies.paper import page
from footopt.studies.paper.claims import CLAIMS, SANDS, Evidence, filled
from footopt.studies.paper.readings import Readings, ReadProblem, read
from footopt.studies.paper.sweep import (
    Factor,
    Judgement,
    changed,
    combinations,
    factors,
    judge,
    one_at_a_time,
    shown,
)
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.settings import Config
from footopt.studies.shapes import make_shapes, walk_shapes
from footopt.walk import OBJECTIVES, Accuracy, Scene, Walk, simulate
from footopt.walk.simulate import at_once
from footopt.walk.validity import diagnose

Array = NDArray[np.float64]

SOLVER = "ga"  # the paper's
SWEEP_BUDGET = (40, 40)  # designs a generation and generations where the sweep searches again
QUICK_BUDGET, QUICK_SAMPLES = (20, 6), 4
#: How long it takes, in walks of a design, to ask pymoo for a generation; and to measure all claims.
PYMOO, EVIDENCE = 40.0, 500.0


@dataclass(frozen=True)
class Budget:
    """How much is searched and swept."""

    pop_size: int
    n_gen: int
    seeds: int
    samples: int
    sweep: tuple[int, int]

    @classmethod
    def of(cls, config: Config) -> Budget:
        """The budget of the settings; smaller in a quick first look."""
        s, c = config.study, config.solver
        check(1 <= s.seeds <= 1000, "study.seeds", s.seeds, "a whole number >= 1 and <= 1000")
        check(
            0 <= s.samples <= 10_000, "study.samples", s.samples, "a whole number from 0 (no sweep) to 10,000"
        )
        if s.quick:
            return cls(*QUICK_BUDGET, 1, min(s.samples, QUICK_SAMPLES), QUICK_BUDGET)
        sweep = min(SWEEP_BUDGET[0], c.pop_size), min(SWEEP_BUDGET[1], c.n_gen)
        return cls(c.pop_size, c.n_gen, s.seeds, s.samples, sweep)


@dataclass(frozen=True, eq=False)
class Setup:
    """The library's own objects for one configuration."""

    config: Config

    @cached_property
    def readings(self) -> Readings:
        return Readings.of(self.config.study)

    @cached_property
    def accuracy(self) -> Accuracy:
        """Of the walks that claims are measured on."""
        confirm = self.config.study.confirm
        return Accuracy.named(confirm) if confirm else build.make_accuracy(self.config.accuracy)

    @cached_property
    def base(self) -> Scene:
        """The walk of the settings, read from their files once."""
        return build.make_scene(self.config)

    def scene(self, sand: str) -> Scene:
        """The walk on one of the sands."""
        if sand not in SANDS:
            raise SettingError("study.shape_sand", sand, f"one of {', '.join(SANDS)}")
        scene = dataclasses.replace(self.base, sand=Sand.named(sand))
        if not self.config.study.leading_edge:
            return scene
        return dataclasses.replace(scene, effects=(*scene.effects, LeadingEdge()))

    def shapes(self) -> dict[str, Walk]:
        """Walks of the five shapes."""
        scene = self.scene(self.config.study.shape_sand)
        return walk_shapes(make_shapes(self.config), scene, self.accuracy)

    def best(self, sand: str, pop_size: int, n_gen: int, seed: int, threads: int | None) -> Foot:
        """The best foot that one run of the GA finds."""
        problem = ReadProblem(
            self.readings,
            scene=self.scene(sand),
            space=build.make_space(self.config.foot),
            accuracy=build.make_accuracy(self.config.accuracy),
            threads=threads,
        )
        return search(problem, Solver(SOLVER, pop_size, n_gen, seed)).foot

    def walk(self, foot: Foot, sand: str) -> Walk:
        """A walk with a foot, finely."""
        return simulate(foot, self.scene(sand), self.accuracy)

    def evidence(self, feet: Mapping[str, Foot]) -> Evidence:
        """All walks that claims need, with the best foot of each sand."""
        return Evidence(
            shapes=self.shapes(),
            optima={sand: self.walk(feet[sand], sand) for sand in SANDS},
            crossed=self.walk(feet["regular"], "hard"),
            filled=self.walk(filled(feet["hard"]), "hard"),
            readings=self.readings,
        )


def measure(evidence: Evidence) -> Array:
    """The margins of all claims, (claims,)."""
    with np.errstate(invalid="ignore"):
        return np.array([claim.margin(evidence) for claim in CLAIMS.values()])


def optimise(
    setup: Setup, budget: Budget, threads: int | None, step: Callable[[str], None]
) -> dict[str, list[Walk]]:
    """For each sand a walk with the best foot of each seed, best first by J_W as it is read."""
    found = {}
    first = setup.config.solver.seed
    for sand in SANDS:
        walks = []
        for seed in range(first, first + budget.seeds):
            foot = setup.best(sand, budget.pop_size, budget.n_gen, seed, threads)
            walks.append(setup.walk(foot, sand))
            step(f"searched for {sand} sand, seed {seed}")
        found[sand] = sorted(walks, key=lambda walk: read(walk, setup.readings).objectives["efficiency"])
    return found


@dataclass(frozen=True, eq=False)
class Sweep:
    """Margins for other choices where the paper leaves one.

    chosen : the factors. alone : (changes, claims), of every single change, named "setting=level" in
    `changes`. levels : (samples, factors); margins : (samples, claims), of random combinations.
    """

    chosen: tuple[Factor, ...]
    changes: list[str]
    alone: Array
    levels: NDArray[np.int64]
    margins: Array

    def judgements(self, margins: Array) -> dict[str, Judgement]:
        """Every claim judged; `margins` (claims,) are those at the settings."""
        return {
            name: judge(
                float(margins[i]),
                zip(self.changes, self.alone[:, i], strict=True),
                self.margins[:, i],
                self.levels,
                self.chosen,
                claim.about,
            )
            for i, (name, claim) in enumerate(CLAIMS.items())
        }


Change = dict[str, Any]  # levels by the settings' names


def plan(config: Config, budget: Budget) -> tuple[tuple[Factor, ...], list[Change], NDArray[np.int64]]:
    """What is swept: the factors, single changes, and the levels of combinations, (samples, factors)."""
    chosen = factors(config)
    singles = one_at_a_time(chosen) if budget.samples else []
    return chosen, singles, combinations(chosen, budget.samples, config.solver.seed)


def jobs_of(chosen: Sequence[Factor], singles: list[Change], levels: NDArray[np.int64]) -> list[Change]:
    """Single changes, then combinations."""
    drawn = [{f.setting: f.levels[v] for f, v in zip(chosen, row, strict=True)} for row in levels]
    return [*singles, *drawn]


def moves_feet(chosen: Sequence[Factor], change: Change) -> bool:
    """Whether feet are searched again."""
    return any(f.setting in change and "optima" in f.moves for f in chosen)


def searching(pop_size: int, n_gen: int, threads: int | None) -> float:
    """About how long a search takes, in walks of a design: pymoo's part is not shared by threads."""
    return n_gen * (pop_size / at_once(threads) + PYMOO)


def effort(budget: Budget, threads: int | None, searches: bool) -> float:
    """About how long one change of the sweep takes, in walks of a design."""
    fine = EVIDENCE / at_once(threads)
    return fine + (len(SANDS) * searching(*budget.sweep, threads) if searches else 0.0)


def sweep(
    config: Config,
    optima: Mapping[str, Foot],
    budget: Budget,
    threads: int | None,
    step: Callable[[float], None] = lambda work: None,
) -> Sweep:
    """Measure the claims for single changes and random combinations.

    Feet are searched again wherever a change could move them, by one run of the GA with
    `SWEEP_BUDGET`; other changes keep `optima`. Threads work on different combinations, each walks on
    one. A search that finds no foot at all leaves its margins undecided. `step` is called with the
    `effort` of every one that is done.
    """
    chosen, singles, levels = plan(config, budget)
    jobs = jobs_of(chosen, singles, levels)

    def margins(settings: Change) -> Array:
        setup = Setup(changed(config, settings))
        if not moves_feet(chosen, settings):
            return measure(setup.evidence(optima))
        seed = setup.config.solver.seed
        try:
            feet = {sand: setup.best(sand, *budget.sweep, seed, threads=1) for sand in SANDS}
        except FootoptError:
            return np.full(len(CLAIMS), np.nan)
        return measure(setup.evidence(feet))

    rows = np.full((len(jobs), len(CLAIMS)), np.nan)
    with ThreadPoolExecutor(at_once(threads)) as pool:
        futures = {pool.submit(margins, job): i for i, job in enumerate(jobs)}
        try:
            for future in as_completed(futures):
                i = futures[future]
                rows[i] = future.result()
                step(effort(budget, threads, moves_feet(chosen, jobs[i])))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    changes = [f"{setting}={shown(level)}" for change in singles for setting, level in change.items()]
    return Sweep(chosen, changes, rows[: len(singles)], levels, rows[len(singles) :])


def run(study: Study) -> None:
    """Do the paper's study and write everything to `folder`."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    budget, setup, threads = Budget.of(config), Setup(config), config.engine.threads
    for name, own in (("shape", "waypoints"), ("k", None)):
        value = getattr(config.foot, name)
        check(
            value == own, f"foot.{name}", value, f"{own}: the study chooses its feet", "Use study=simulate."
        )
    setup.scene("hard").need_heel_strike()
    Solver(SOLVER, budget.pop_size, budget.n_gen, config.solver.seed)  # refused before anything is walked
    out.print(
        f"Searching feet for {', '.join(SANDS)} sand: {SOLVER}, {budget.seeds} seeds of "
        f"{budget.pop_size} x {budget.n_gen}"
    )
    with terminal.told_if_slow(out, "Compiling the walk; this is done once and kept on disk ..."):
        setup.shapes()
    chosen, singles, levels = plan(config, budget)
    jobs = jobs_of(chosen, singles, levels)
    once = searching(budget.pop_size, budget.n_gen, threads)
    searches = len(SANDS) * budget.seeds
    work = searches * once + sum(effort(budget, threads, moves_feet(chosen, job)) for job in jobs)
    with progress(out, searches + len(jobs), "task", work) as step:
        runs = optimise(setup, budget, threads, partial(step, once))
        for sand, walks in runs.items():
            out.print(f"{sand:8s} {terminal.describe_foot(walks[0].foot)}")
        feet = {sand: dataclasses.replace(walks[0].foot, name=sand) for sand, walks in runs.items()}
        evidence = setup.evidence(feet)
        drawn = paper_figures.all_figures(evidence.shapes, evidence.optima, evidence.crossed)
        for name, figure in drawn.items():
            figures.save(figure, folder / "figures", name)
        swept = sweep(config, feet, budget, threads, partial(step, news="sweep"))

    margins = measure(evidence)
    judged = swept.judgements(margins)
    rows = [
        paper_figures.Row(CLAIMS[name].says, j.holds, j.share, j.decides if 0.0 < j.share < 1.0 else "")
        for name, j in judged.items()
    ]
    figures.save(paper_figures.claims(rows), folder / "figures", "claims")
    content = {
        "sweep": {
            "samples": budget.samples,
            "search": dict(zip(("pop_size", "n_gen"), budget.sweep, strict=True)),
            "factors": [dataclasses.asdict(f) for f in swept.chosen],
        },
        "claims": page.claim_entries(judged, swept.changes, swept.alone),
        "errata": page.erratum_entries(),
    }
    files.write_json(folder / "claims.json", content)
    record = {
        "study": "paper",
        "seed": config.solver.seed,
        "optima": {sand: _optimum(setup, walks, config.solver.seed) for sand, walks in runs.items()},
        "shapes": {
            name: {"objectives": read(walk, setup.readings).objectives, "reason": walk.reason}
            for name, walk in evidence.shapes.items()
        },
        **scene_entry(setup.scene(config.study.shape_sand), setup.accuracy, tuple(OBJECTIVES)),
        "readings": setup.readings._asdict(),
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    files.write_json(folder / "result.json", record)
    text = page.markdown(evidence, judged, swept.chosen, budget.samples, budget.sweep)
    files.write_text(folder / "claims.md", text)
    tables = [page.table(judged)]
    if budget.samples:
        tables.append(page.sensitivity_table(judged, swept.chosen))
    says = {name: paper_figures.SAYS[name] for name in (*drawn, "claims")}
    said = [page.summary(judged), "All of it in words, with the feet and the errata: claims.md."]
    write_study(folder, "The paper, judged", said, says, tables, record)
    for table in tables:
        out.print(table)
    for sand in SANDS:
        out.print(f"The best foot for {sand} sand, on it:")
        terminal.print_validity(out, diagnose(evidence.optima[sand]))
    out.print(page.summary(judged))
    terminal.everything_is_in(out, folder, clock())


def _optimum(setup: Setup, walks: Sequence[Walk], first_seed: int) -> dict[str, Any]:
    """The best foot of a sand and what every seed found, in result.json."""
    return {
        "design": foot_entry(walks[0].foot),
        "objectives": read(walks[0], setup.readings).objectives,
        "seeds": list(range(first_seed, first_seed + len(walks))),
        "all_seeds_best_first": [
            {
                "k": walk.foot.k,
                "hollow_mm": 1e3 * walk.foot.hollow,
                "efficiency": read(walk, setup.readings).objectives["efficiency"],
            }
            for walk in walks
        ],
    }
