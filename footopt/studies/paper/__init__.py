"""The paper's study from nothing: search the feet, draw the figures, measure and judge the claims."""

from collections.abc import Mapping, Sequence
from math import isfinite, nan
from typing import Any

from footopt.errors import FootoptError
from footopt.files.io import plain
from footopt.foot import SHAPES, Foot
from footopt.foot.waypoints import heights_text
from footopt.report import terminal
from footopt.report.figures.studies import all_figures
from footopt.report.numbers import number
from footopt.report.output import scene_entry
from footopt.studies.build import check_searchable
from footopt.studies.paper.claims import CLAIMS, measure
from footopt.studies.paper.walks import SANDS, changes, evidence
from footopt.studies.runs import Study
from footopt.walk import FIVE, OBJECTIVES, Walk, simulate

Entry = Mapping[str, Any]
VERDICTS = ("holds", "does not hold", "depends on a choice", "undecided")
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
        for name, (figure, caption) in (all_figures(own) if study.wants_figures else {}).items():
            study.save(name, figure, caption)
        for name, other in others.items():
            try:
                margins[name] = measure(evidence(other, searched), other.study.speed_loss)
            except FootoptError:  # a search found no foot at all
                margins[name] = dict.fromkeys(CLAIMS, nan)
            step(news=name)
    found = content(own, measure(own, config.study.speed_loss), margins)
    study.conclude(
        "The paper, judged",
        [
            terminal.table(head, [word for word in head if word not in MEASURES], title, rows)
            for title, head, rows in tables(found)
        ],
        {
            "seed": config.solver.seed,
            **found,
            **scene_entry(own["hard"].scene, own["hard"].accuracy, tuple(OBJECTIVES)),
        },
        summary=(f"{summary(found)}.",),
    )


def judge(margin: float, changed: Mapping[str, float]) -> dict[str, Any]:
    """Judge a claim by its margin at the settings and with each open choice made otherwise.

    It depends on the choices that turn it. A margin that is NaN, of a walk that failed, turns nothing.
    """
    turned = [name for name, m in changed.items() if isfinite(m + margin) and (m > 0.0) != (margin > 0.0)]
    holds, fails, depends, undecided = VERDICTS
    verdict = depends if turned else holds if margin > 0.0 else fails if isfinite(margin) else undecided
    return {"margin": margin, "verdict": verdict, "hangs_on": turned, "changed": dict(changed)}


def content(
    walks: Mapping[str, Walk], margins: Mapping[str, float], changed: Mapping[str, Mapping[str, float]]
) -> dict[str, Any]:
    """The study's part of result.json, in JSON's own types; `changed`: the margins by each change."""
    claims = []
    for name, margin in margins.items():
        judged = judge(margin, {change: found[name] for change, found in changed.items()})
        claims.append({"id": name, **CLAIMS[name], **judged})
    feet = {
        name: {"k": w.foot.k, "reason": w.reason, "objectives": {n: w.objectives[n] for n in JUDGED}}
        for name, w in walks.items()
        if name in (*SANDS, *SHAPES)
    }
    return dict(plain({"claims": claims, "walks": feet}))


def summary(found: Entry) -> str:
    """The number of claims with each verdict, in one line."""
    verdicts = [claim["verdict"] for claim in found["claims"]]
    hold, fail, depend, _ = map(verdicts.count, VERDICTS)
    return f"{len(verdicts)} claims: {hold} hold, {fail} do not hold, {depend} depend on a choice"


def tables(found: Entry) -> list[tuple[str, Sequence[str], list[list[str]]]]:
    """The tables of `content`: a title, a head and rows each."""
    claims = [[c["place"], c["says"], *_judgement(c)] for c in found["claims"]]
    walks = [
        [
            f"the best for {name} sand" if name in SANDS else name,
            heights_text(walk["k"]) if walk["k"] else "",
            *(walk["reason"] or "-" if v is None else number(v) for v in walk["objectives"].values()),
        ]
        for name, walk in found["walks"].items()
    ]
    return [
        ("Claims", ("figure", "claim", "margin", "verdict"), claims),
        ("The best feet, and the five shapes", ("foot", "k", *MEASURES), walks),
    ]


def _judgement(claim: Entry) -> list[str]:
    """The margin of a claim, and its verdict with what it depends on."""
    margin, verdict, turned = claim["margin"], claim["verdict"], ", ".join(claim["hangs_on"])
    if turned:
        verdict = f"holds, but not with {turned}" if margin > 0.0 else f"holds only with {turned}"
    return ["-" if margin is None else f"{margin:+.3g} {claim['unit']}".rstrip(), verdict]
