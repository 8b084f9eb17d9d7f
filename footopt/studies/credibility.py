"""How credible are the results? The factors of NASA-STD-7009B, each with its evidence, measured as it runs.

The levels are this project's own judgement, from 0 (nothing) to 4, by rules that stand beside the numbers.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from importlib.resources import files

import numpy as np
from rich.table import Table

from footopt.files.run import write_text
from footopt.foot import Foot, Waypoints
from footopt.report import terminal
from footopt.report.numbers import percent
from footopt.sand import Sand
from footopt.studies import validation
from footopt.studies.base import Study
from footopt.studies.ranks import other_laws
from footopt.studies.validation import model
from footopt.studies.validation.compare import AGREES, DIFFERS, OPEN
from footopt.walk import Scene, Spread, estimate_error, evaluate, simulate
from footopt.walk.audit import tau
from footopt.walk.objectives import FIVE
from footopt.walk.reference import LIMITS, PUBLISHED, RAMP, contact_forces

SANDS = ("soft", "regular", "hard")
FEET = 8  # random soles on each sand whose estimated errors are held against a finer walk
RANKED = 40  # random soles whose order is compared between laws
ROUNDING = 1e-12  # of the force: as near as the compiled law has to be to the readable one
MOTIONS = 100  # of a buried foot, in which the compiled law is held against the readable one


@dataclass(frozen=True)
class Factor:
    """A factor of credibility.

    Parameters
    ----------
    name : str
        As in the standard.
    level : int
        0 to 4.
    rule : str
        What gives the level.
    evidence : str
        What was found.
    missing : str
        What the next level needs.
    """

    name: str
    level: int
    rule: str
    evidence: str
    missing: str


def run(study: Study) -> None:
    """Measure what can be measured, and write the page."""
    found = []
    asks = (code, solution, pedigree, validated, inputs, robustness, process, history)
    with study.compiling(), study.progress(len(asks), "factor") as step:
        for ask in asks:
            found.append(ask())
            step(news=found[-1].name)
    write_text(study.folder / "credibility.md", page(found))
    study.conclude(
        "How credible are the results?",
        [table(found)],
        {"factors": [asdict(f) for f in found]},
        said=[f"{f.name}, level {f.level}: {f.evidence}. Missing: {f.missing}." for f in found],
    )


def by(value: float, *limits: float) -> int:
    """How many of some increasing limits a value reaches."""
    return sum(value >= limit for limit in limits)


def code() -> Factor:
    """Is the program the law? Against another program's numbers, and against the law in its angles."""
    off = 0.0
    for p in PUBLISHED:
        walked = evaluate([RAMP], Scene(sand=Sand.named(p.sand)), "reference").values[0]
        off = max(off, float(np.abs(walked / p.objectives - 1.0).max()))
    rng, law = np.random.default_rng(1), 0.0
    foot = Foot.from_waypoints(RAMP)
    for motion in rng.normal(0.0, [0.5, 0.5, 2.0], (MOTIONS, 3)):
        compiled, readable, size = contact_forces(foot, Scene(), 100, tuple(motion.tolist()), 1e-4, True)
        law = max(law, float(np.abs(compiled - readable).max()) / size)
    good = off <= LIMITS["reference"] and law < ROUNDING
    return Factor(
        "code verification",
        3 if good else 1,
        "3 where a second program and the law in its angles are met, else 1",
        f"three walks of a program that was written apart are met within {percent(off)} at accuracy "
        f"reference; the compiled law is the published one within {ROUNDING:.0e} of the force in "
        f"{MOTIONS} random motions",
        "a review from outside the project",
    )


def solution() -> Factor:
    """Are numbers as exact as they say? Estimated errors against walks at the finest accuracy."""
    feet, ratios, worst = Waypoints().random(FEET, seed=1, inside=True), [], 0.0
    for name in SANDS:
        scene = Scene(sand=Sand.named(name))
        finest = evaluate(feet, scene, "reference").values
        for k, true in zip(feet, finest, strict=True):
            foot = Foot.from_waypoints(k)
            own, errors = simulate(foot, scene).objectives, estimate_error(foot, scene)
            off = np.array([abs(own[n] - t) for n, t in zip(FIVE, true, strict=True)])
            ratios += (off / np.array([errors[n] for n in FIVE])).tolist()
            worst = max(worst, float((off / np.abs(true)).max()))
    hold, near = (float(np.mean(np.array(ratios) <= factor)) for factor in (1.0, 2.0))
    return Factor(
        "solution verification",
        1 + (near >= 0.9) + (hold >= 0.9),
        "3 where estimates hold 90 % of the true errors, 2 where they do within a factor of two, else 1",
        f"of {len(ratios)} objectives of {FEET} random soles on three sands the estimated error holds the "
        f"true one in {percent(hold)}, and within a factor of two in {percent(near)}; the largest true error "
        f"at accuracy standard is {percent(worst)}",
        "an estimate that is a bound, and one for every number of every study",
    )


def pedigree() -> Factor:
    """How good are the data? How many of their uncertainties somebody measured."""
    why = []
    for path in files(validation).iterdir():
        if path.name.endswith(".toml"):
            content = tomllib.loads(path.read_text(encoding="utf-8"))
            why += [part["why"] for part in (*content["quantities"], *content.get("inputs", {}).values())]
    assumed = sum("assumed" in words for words in why)
    return Factor(
        "data pedigree",
        by(1.0 - assumed / len(why), 0.0, 0.5, 0.9),
        "3 where 90 % of the uncertainties were measured, 2 where half, else 1",
        f"every number of an experiment names its source; of {len(why)} uncertainties {assumed} are assumed",
        "raw data with their spread; most sources print means",
    )


def validated() -> Factor:
    """Is the law right? The verdicts of study=validate."""
    counts = Counter(model.verdicts())
    every = sum(counts.values())
    return Factor(
        "validation",
        by(counts[AGREES] / every, 0.0, 0.5),
        "2 where half of the comparisons agree, else 1; more needs a foot that walks in measured sand",
        f"of {every} comparisons with experiments {counts[AGREES]} agree, {counts[DIFFERS]} differ, and "
        f"{counts[OPEN]} cannot be told (study=validate)",
        "a foot of a known shape that walks in sand with a measured zeta",
    )


def inputs() -> Factor:
    """Is known how uncertain inputs are? Which spreads a user can measure."""
    measurable = ("zeta", "period", "angles")
    every = list(vars(Spread()))
    return Factor(
        "input pedigree and uncertainty",
        by(len(measurable) / len(every), 0.0, 0.25, 0.9),
        "3 where 90 % of the spreads can be measured, 2 where a quarter, else 1",
        f"{len(every)} inputs of a walk have a spread in study=robust and study=sensitivity; the defaults "
        f"are chosen, not measured; {len(measurable)} can be: {', '.join(measurable)} (study=calibrate, "
        "gait.path)",
        "spreads that were measured on many people and sands, and how inputs go together",
    )


def robustness() -> Factor:
    """Do conclusions survive? The order of random soles under other laws and another zeta."""
    scene, feet = Scene(), Waypoints().random(RANKED, seed=1, inside=True)
    own = evaluate(feet, scene).efficiency
    taus = {}
    for law in other_laws(scene, Spread().zeta):
        other = evaluate(feet, law.scene).efficiency
        both = np.isfinite(own) & np.isfinite(other)
        taus[law.name] = tau(own[both], other[both])
    least = min(taus.values())
    each = ", ".join(f"{value:.2f} with {name}" for name, value in taus.items())
    return Factor(
        "robustness of results",
        by(least, -1.0, 0.5, 0.8),
        "3 where Kendall's tau is 0.8 or more under every other law, 2 where 0.5, else 1",
        f"order of {RANKED} random soles on hard sand by J_W against that under other laws, Kendall's tau: "
        f"{each}",
        "one law that experiments prefer",
    )


def process() -> Factor:
    """Is it known what was done? What each run keeps."""
    return Factor(
        "process and management",
        2,
        "by hand",
        "each run keeps its settings, versions, source commit, processor and seed; walks are bit-identical "
        "from release to release or the change is in the changelog; every command of the docs is run by "
        "a test",
        "releases that somebody else has reviewed",
    )


def history() -> Factor:
    """Has anybody used it?"""
    return Factor(
        "use history",
        0,
        "by hand",
        "nobody is known to have built a foot by it",
        "one foot, printed and tested",
    )


def table(found: Sequence[Factor]) -> Table:
    """Levels for the terminal."""
    shown = terminal.table(("factor", "level", "rule"), words=("factor", "rule"))
    for f in found:
        shown.add_row(f.name, f"{f.level} of 4", f.rule)
    return shown


def page(found: Sequence[Factor]) -> str:
    """The page as Markdown."""
    weakest = min(f.level for f in found)
    lines = [
        "# How credible is it?",
        "",
        "This page is what `footopt study=credibility` writes, and a test holds it to that. The factors are",
        "those of NASA-STD-7009B. The levels, from 0 (nothing) to 4, are this project's own judgement, by",
        "the rules in the table.",
        "",
        f"**The weakest factor counts: level {weakest}.** Use footopt to choose what to build and test, not",
        "in place of a test.",
        "",
        "| factor | level | rule | evidence | missing for more |",
        "| --- | --- | --- | --- | --- |",
        *(f"| {f.name} | {f.level} | {f.rule} | {f.evidence} | {f.missing} |" for f in found),
        "",
        "[Validation](validation.md) has the experiments, [the claims](claims.md) what becomes of",
        "the paper's.",
    ]
    return "\n".join(lines) + "\n"
