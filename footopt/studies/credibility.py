"""How credible are the results? The factors of NASA-STD-7009B, each with its evidence, measured as it runs.

credibility.toml has their words, credibility.md the page. The levels, from 0 (nothing) to 4, are this
project's own judgement, by rules that stand beside the numbers.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import numpy as np

from footopt.files.run import write_text
from footopt.foot import Foot, Waypoints
from footopt.report import terminal
from footopt.report.numbers import percent
from footopt.sand import Sand
from footopt.studies.base import Study
from footopt.studies.ranks import other_laws
from footopt.studies.validation import model
from footopt.studies.validation.compare import AGREES, DIFFERS, OPEN, experiments
from footopt.walk import Scene, Spread, evaluate, simulate
from footopt.walk.audit import tau
from footopt.walk.objectives import FIVE
from footopt.walk.reference import LIMITS, PUBLISHED, RAMP, contact_forces
from footopt.walk.resolution import error_of

SANDS = ("soft", "regular", "hard")
FEET = 8  # random soles on each sand whose estimated errors are held against a finer walk
RANKED = 40  # random soles whose order is compared between laws
ROUNDING = 1e-12  # of the force: as near as the compiled law has to be to the readable one
MOTIONS = 100  # of a buried foot, in which the compiled law is held against the readable one

Measured = tuple[int, dict[str, Any]]  # a level, and the numbers of the evidence


def run(study: Study) -> None:
    """Measure what can be measured, and write the page."""
    found = []
    words = tomllib.loads(_text("credibility.toml"))
    with study.compiling(), study.progress(len(words), "factor") as step:
        for key, said in words.items():
            level, numbers = MEASURES[key]() if key in MEASURES else (said["level"], {})
            found.append(said | {"level": level, "evidence": said["evidence"].format(**numbers)})
            step(news=said["name"])
    shown = terminal.table(("factor", "level", "rule"), words=("factor", "rule"))
    for f in found:
        shown.add_row(f["name"], f"{f['level']} of 4", f["rule"])
    rows = [[f["name"], str(f["level"]), f["rule"], f["evidence"], f["missing"]] for f in found]
    weakest = min(f["level"] for f in found)
    page = _text("credibility.md").format(weakest=weakest, factors=terminal.markdown_rows(rows))
    write_text(study.folder / "credibility.md", page)
    study.conclude(
        "How credible are the results?",
        [shown],
        {"factors": found},
        said=[f"{f['name']}, level {f['level']}: {f['evidence']}. Missing: {f['missing']}." for f in found],
    )


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def by(value: float, *limits: float) -> int:
    """How many of some increasing limits a value reaches."""
    return sum(value >= limit for limit in limits)


def code() -> Measured:
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
    return 3 if good else 1, {
        "walks": len(PUBLISHED), "off": percent(off), "rounding": ROUNDING, "motions": MOTIONS,
    }  # fmt: skip


def solution() -> Measured:
    """Are numbers as exact as they say? Estimated errors against walks at the finest accuracy."""
    feet, ratios, worst = Waypoints().random(FEET, seed=1, inside=True), [], 0.0
    for name in SANDS:
        scene = Scene(sand=Sand.named(name))
        finest = evaluate(feet, scene, "reference").values
        for k, true in zip(feet, finest, strict=True):
            walk = simulate(Foot.from_waypoints(k), scene)
            own, errors = walk.objectives, error_of(walk)
            off = np.array([abs(own[n] - t) for n, t in zip(FIVE, true, strict=True)])
            ratios += (off / np.array([errors[n] for n in FIVE])).tolist()
            worst = max(worst, float((off / np.abs(true)).max()))
    hold, near = (float(np.mean(np.array(ratios) <= factor)) for factor in (1.0, 2.0))
    return 1 + (near >= 0.9) + (hold >= 0.9), {
        "objectives": len(ratios), "feet": FEET, "sands": len(SANDS), "hold": percent(hold),
        "near": percent(near), "worst": percent(worst),
    }  # fmt: skip


def pedigree() -> Measured:
    """How good are the data? How many of their uncertainties somebody measured."""
    parts = [[*e.content["quantities"], *e.content.get("inputs", {}).values()] for e in experiments()]
    why = [part["why"] for of_one in parts for part in of_one]
    assumed = sum("assumed" in words for words in why)
    return by(1.0 - assumed / len(why), 0.0, 0.5, 0.9), {"every": len(why), "assumed": assumed}


def validated() -> Measured:
    """Is the law right? The verdicts of study=validate."""
    counts = Counter(model.verdicts())
    agree, differ, open_ = (counts[verdict] for verdict in (AGREES, DIFFERS, OPEN))
    every = counts.total()
    return by(agree / every, 0.0, 0.5), {"every": every, "agree": agree, "differ": differ, "open": open_}


def inputs() -> Measured:
    """Is known how uncertain inputs are? Which spreads a user can measure."""
    names, every = ("zeta", "period", "angles"), len(vars(Spread()))
    share = len(names) / every
    return by(share, 0.0, 0.25, 0.9), {"every": every, "measurable": len(names), "names": ", ".join(names)}


def robustness() -> Measured:
    """Do conclusions survive? The order of random soles under other laws and another zeta."""
    scene, feet = Scene(), Waypoints().random(RANKED, seed=1, inside=True)
    own = evaluate(feet, scene).efficiency
    taus = {}
    for law in other_laws(scene, Spread().zeta):
        other = evaluate(feet, law.scene).efficiency
        both = np.isfinite(own) & np.isfinite(other)
        taus[law.name] = tau(own[both], other[both])
    each = ", ".join(f"{value:.2f} with {name}" for name, value in taus.items())
    return by(min(taus.values()), -1.0, 0.5, 0.8), {"feet": RANKED, "each": each}


MEASURES: dict[str, Callable[[], Measured]] = {
    f.__name__: f for f in (code, solution, pedigree, validated, inputs, robustness)
}
