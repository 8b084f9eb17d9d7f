"""The paper's study from nothing: search the feet, draw the figures, measure and judge the claims."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite, nan
from typing import Any

from footopt.errors import FootoptError
from footopt.files.io import plain
from footopt.foot import Foot
from footopt.foot.waypoints import heights_text
from footopt.report import terminal
from footopt.report.figures.paper import all_figures
from footopt.report.figures.tables import claims as draw_claims
from footopt.report.numbers import number
from footopt.studies.base import Study, foot_entry, scene_entry
from footopt.studies.build import check_searchable
from footopt.studies.paper.claims import CLAIMS, measure
from footopt.studies.paper.walks import SANDS, Evidence, changes, evidence
from footopt.walk import FIVE, OBJECTIVES, Walk, simulate

__all__ = ["run"]

Entry = Mapping[str, Any]
CAPTION = "Every claim: whether it holds at the settings, and with each open choice made otherwise."
VERDICTS = ("holds", "does not hold", "hangs on a choice", "undecided")
JUDGED = (*FIVE, "efficiency")
MEASURES = ("distance (m)", "mean height (m)", "work (J)", "peak power (W)", "speed loss (m/s)", "J_W")


def run(study: Study) -> None:
    """Repeat the paper: search its feet, draw its figures, judge its claims."""
    config = study.config
    check_searchable(config.foot)
    searched, others = dict[str, list[int]](), dict(changes(config))
    study.say(f"Searching feet for {', '.join(SANDS)} sand, {1 + len(others)} times")
    with study.compiling():
        simulate(Foot.flat(), study.scene, study.accuracy)
    margins = {}
    with study.progress(1 + len(others), "choice") as step:
        own = evidence(config, searched)
        step(news="the settings")
        for name, (figure, caption) in all_figures(own.shapes, own.optima, own.crossed).items():
            study.save(name, figure, caption)
        for name, other in others.items():
            try:
                margins[name] = measure(evidence(other, searched))
            except FootoptError:  # a search found no foot at all
                margins[name] = dict.fromkeys(CLAIMS, nan)
            step(news=name)
    found = content(own, margins)
    study.save("claims", draw_claims(found["claims"]), CAPTION)
    study.conclude(
        "The paper, judged",
        [
            terminal.table(head, [word for word in head if word not in MEASURES], title, rows)
            for title, head, rows in tables(found)
        ],
        {
            "seed": config.solver.seed,
            **found,
            **scene_entry(own.crossed.scene, own.crossed.accuracy, tuple(OBJECTIVES)),
        },
        summary=(f"{summary(found)}.",),
    )


def judge(margin: float, changed: Mapping[str, float]) -> dict[str, Any]:
    """Judge a claim by its margin at the settings and with each open choice made otherwise.

    It hangs on the choices that turn it. A margin that is NaN, of a walk that failed, turns nothing.
    """
    turned = [name for name, m in changed.items() if isfinite(m + margin) and (m > 0.0) != (margin > 0.0)]
    own = (0 if margin > 0.0 else 1) if isfinite(margin) else 3
    verdict = VERDICTS[2 if turned else own]
    return {"margin": margin, "verdict": verdict, "hangs_on": turned, "changed": dict(changed)}


def content(own: Evidence, margins: Mapping[str, Mapping[str, float]]) -> dict[str, Any]:
    """The study's part of result.json, in JSON's own types; `margins`: of each claim by each change."""
    claims = []
    for name, margin in measure(own).items():
        judged = judge(margin, {change: found[name] for change, found in margins.items()})
        claims.append({"id": name, **CLAIMS[name], **judged})
    feet = {sand: foot_entry(walk.foot) | _walk_entry(walk) for sand, walk in own.optima.items()}
    shapes = {name: _walk_entry(walk) for name, walk in own.shapes.items()}
    return dict(plain({"claims": claims, "optima": feet, "shapes": shapes}))


def _walk_entry(walk: Walk) -> dict[str, Any]:
    return {"reason": walk.reason, "objectives": {name: walk.objectives[name] for name in JUDGED}}


def summary(found: Entry) -> str:
    """The number of claims with each verdict, in one line."""
    verdicts = [claim["verdict"] for claim in found["claims"]]
    hold, fail, depend, _ = map(verdicts.count, VERDICTS)
    return f"{len(verdicts)} claims: {hold} hold, {fail} do not hold, {depend} hang on a choice"


def tables(found: Entry) -> list[tuple[str, Sequence[str], list[list[str]]]]:
    """The tables of `content`: a title, a head and rows each."""
    claims = [[c["place"], c["says"], *_judgement(c)] for c in found["claims"]]
    feet = {f"the best for {sand} sand": foot for sand, foot in found["optima"].items()} | found["shapes"]
    walks = [
        [name, heights_text(foot["k"]) if "k" in foot else "", *_measures(foot)]
        for name, foot in feet.items()
    ]
    return [
        ("Claims", ("figure", "claim", "margin", "verdict"), claims),
        ("The best feet, and the five shapes", ("foot", "k", *MEASURES), walks),
    ]


def _judgement(claim: Entry) -> list[str]:
    """The margin of a claim, and its verdict with what it hangs on."""
    margin, verdict, turned = claim["margin"], claim["verdict"], ", ".join(claim["hangs_on"])
    if turned:
        verdict = f"holds, but not with {turned}" if margin > 0.0 else f"holds only with {turned}"
    return ["-" if margin is None else f"{margin:+.3g} {claim['unit']}".rstrip(), verdict]


def _measures(walk: Entry) -> list[str]:
    return [walk["reason"] or "-" if v is None else number(v) for v in walk["objectives"].values()]
