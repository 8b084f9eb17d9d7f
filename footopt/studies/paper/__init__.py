"""study=paper: search the paper's feet, draw its figures, measure and judge its claims.

claims.toml has each claim in words, and the numbers of walks from which its margin is computed: positive
where the claim holds, NaN where a walk that it needs failed.
"""

import tomllib
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.resources import files
from math import isfinite, nan
from typing import Any

import numpy as np

from footopt.arrays import Array
from footopt.design.problem import RECORD
from footopt.errors import FootoptError
from footopt.files.io import plain
from footopt.foot import SHAPES, Foot
from footopt.foot.waypoints import heights_text
from footopt.gait import RIGHT
from footopt.report import terminal
from footopt.report.figures.studies import all_figures
from footopt.report.numbers import number
from footopt.report.output import scene_entry
from footopt.studies.build import check_searchable
from footopt.studies.paper.walks import SANDS, changes, evidence, switch_losses
from footopt.studies.runs import Study
from footopt.walk import OBJECTIVES, Walk, simulate
from footopt.walk.results import LEAST_LOAD, stance

Entry = Mapping[str, Any]
VERDICTS = ("holds", "does not hold", "depends on a choice", "undecided")
HEADS = ("distance (m)", "mean height (m)", "work (J)", "peak power (W)", "speed loss (m/s)", "J_W")
Numbers = Mapping[str, Any]  # of a walk, by name; NaN where it failed
Walks = Mapping[str, Numbers]  # of the walks of `evidence`, by their names; "shapes": of the five together
Names = Sequence[str]

#: Numbers in place of the paper's words; none was tuned to change a verdict.
LIMITS = {
    "marked_loss": 0.1,  # m/s, speed lost at a switch that counts as marked: a tenth of the normal speed
    "normal_speed": 1.0,  # m/s (the paper: "around 1 m/s")
    "not_obvious": 0.2,  # how far curves may part that a reader sees as one, over their own rms
    "push_off": 0.27,  # s after touch-down, when push-off begins (the paper)
    "contact": LEAST_LOAD,  # vertical force over the weight above which a foot is in contact
}

INSTANTS = 1000  # of a curve


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
            terminal.table(head, [word for word in head if word not in HEADS], title, rows)
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

    It depends on the choices that change its verdict. A NaN, the margin of a walk that failed, changes none.
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
        name: {"k": w.foot.k, "reason": w.reason, "objectives": {n: w.objectives[n] for n in RECORD}}
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
        ("The best feet, and the five shapes", ("foot", "k", *HEADS), walks),
    ]


def _judgement(claim: Entry) -> list[str]:
    """The margin of a claim, and its verdict with what it depends on."""
    margin, verdict, turned = claim["margin"], claim["verdict"], ", ".join(claim["hangs_on"])
    if turned:
        verdict = f"holds, but not with {turned}" if margin > 0.0 else f"holds only with {turned}"
    return ["-" if margin is None else f"{margin:+.3g} {claim['unit']}".rstrip(), verdict]


def numbers(walk: Walk, speed_loss: str) -> Numbers:
    """The numbers that claims compare, of the sole and of the walk; the latter are NaN if it failed."""
    found: dict[str, Any] = defaultdict(lambda: np.nan, of_contour(walk.foot))
    found["vertical_velocity"] = np.full(INSTANTS, np.nan)
    if walk.feasible:
        losses = {f"loss_{i}": loss for i, loss in enumerate(switch_losses(walk, speed_loss))}
        found |= {**walk.objectives, **of_traces(walk), **of_first_step(walk), **losses}
    return found


def of_contour(foot: Foot) -> dict[str, float]:
    """Numbers of a sole: how convex it is, how far it bends inwards, and the rms of its curvature, 1/m."""
    chord = np.diff(foot.points(400), axis=0)
    turn, length = np.diff(np.unwrap(np.arctan2(chord[:, 1], chord[:, 0]))), np.hypot(*chord.T)[1:]
    level = foot.space.H / foot.space.K if foot.space else np.nan
    return {
        "convexity": 1e3 * (level - foot.hollow),  # mm; a hollow below one level may be the grid's own
        "inward_turn": float(np.degrees(np.maximum(-turn, 0.0).sum())),
        "curvature": float(np.sqrt(np.mean((turn / length) ** 2))),
    }


def of_traces(walk: Walk) -> dict[str, Any]:
    """Numbers of the traces, most of them from the first heel strike on: means over time, and peaks."""
    gait, late = walk.scene.gait, walk.t >= walk.scene.gait.heel_strike
    t, drag = walk.t[late], walk.force[late, :, 0]

    def mean(trace: Array) -> float:
        return float(np.trapezoid(trace, t) / (t[-1] - t[0]))

    fast = np.flatnonzero(walk.velocity[:, 0] >= LIMITS["normal_speed"])
    three_steps = gait.heel_strike + 1.5 * gait.period
    instants = np.linspace(gait.start, walk.scene.duration, INSTANTS)
    return {
        "vertical_velocity": np.interp(instants, walk.t, walk.velocity[:, 1]),
        "mean_speed": mean(walk.velocity[late, 0]),
        "time_to_speed": float(walk.t[fast[0]]) if len(fast) else walk.scene.duration,
        "work_after_three_steps": abs(float(np.interp(three_steps, walk.t, walk.work.sum(axis=1)))),
        "contact_share": mean((walk.force[late, :, 1] > LIMITS["contact"] * walk.scene.weight).mean(axis=1)),
        "mean_drag_forwards": mean(np.maximum(drag, 0.0).sum(axis=1)),
        "mean_drag_backwards": mean(np.maximum(-drag, 0.0).sum(axis=1)),
        "peak_drag_forwards": float(drag.max()),
        "peak_drag_backwards": float(-drag.min()),
    }


def of_first_step(walk: Walk) -> dict[str, float]:
    """Numbers of the first step: how it pushes, and the part of the sole in the sand, from 100 instants."""
    found = stance(walk)
    if found is None:
        return {}
    step = slice(found.first, found.last + 1)
    t, lasts = walk.t[step] - walk.t[found.first], np.diff(walk.t, prepend=0.0)[step]
    impulse = np.maximum(walk.force[step, RIGHT, 0], 0.0) * lasts
    states = walk.plates(found.first + np.searchsorted(t, np.linspace(0.0, t[-1], 100)))
    x = walk.foot.plates(walk.accuracy.plates, walk.accuracy.rule).x[0] + walk.foot.ankle[0]
    heel, toe = walk.foot.contour[:, 0].min(), walk.foot.contour[:, 0].max()
    middle = np.abs(x - 0.5 * (toe + heel)) <= (toe - heel) / 6.0
    inside = states.position[:, RIGHT, :, 1] < 0.0
    up = states.force[:, RIGHT, :, 1]
    return {
        "push_time": float(lasts[impulse > 0.0].sum()),  # s
        "push_off_share": float(impulse[t >= LIMITS["push_off"]].sum() / impulse.sum()),
        "zone": float(inside.mean()),  # share of all plates
        "middle_zone": float(inside[:, middle].mean()),  # share of those of the middle third
        "centre": float((up @ x).sum() / up.sum()),  # m, x_p of the vertical force
    }


def parting(walks: Walks) -> float:
    """The largest rms distance of a shape's V_z(t) from their mean, over the rms of the mean."""
    curves = np.array([walks[name]["vertical_velocity"] for name in SHAPES])
    middle = curves.mean(axis=0)
    return float(np.sqrt(np.mean((curves - middle) ** 2, axis=1)).max() / np.sqrt(np.mean(middle**2)))


def margin(
    walks: Walks, of: Names, numbers: Names, above: Names = (), below: Names = (), scale: float = 1.0
) -> float:
    """The least lead of numbers of the walks `of` over those of others, or a limit, `above` or `below`."""

    def values(names: Names, number: str) -> Array:
        found = [walks[name][number] if name in walks else LIMITS.get(name, name) for name in names]
        return np.array(found, float) if above else -np.array(found, float)

    return scale * float(np.min([values(of, n).min() - values(above or below, n).max() for n in numbers]))


#: Each claim in words, by its name; its margin is in `MEASURES`.
CLAIMS: dict[str, dict[str, Any]] = tomllib.loads(
    files(__package__).joinpath("claims.toml").read_text(encoding="utf-8")
)
MEASURES: dict[str, Callable[[Walks], float]] = {
    name: partial(margin, **claim.pop("margin")) for name, claim in CLAIMS.items()
}
for claim in CLAIMS.values():
    claim["decided"] = claim["decided"].format(**LIMITS)


def measure(walks: Mapping[str, Walk], speed_loss: str) -> dict[str, float]:
    """The margins of all claims, by their names, of the walks of `evidence` and the reading of dV_x."""
    found = {name: numbers(walk, speed_loss) for name, walk in walks.items()}
    with np.errstate(invalid="ignore"):
        found["shapes"] = {"parting": parting(found)}
        return {name: measured(found) for name, measured in MEASURES.items()}
