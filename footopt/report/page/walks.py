"""Pages of one walk, and of a search with the walks of its designs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.design import EXHAUSTIVE, Confirmation, SearchResult
from footopt.design.result import SHOWN
from footopt.foot import Foot, Waypoints
from footopt.report.body import forces_along, groups
from footopt.report.numbers import percent, sand_title, title
from footopt.report.page.file import column, packed
from footopt.report.page.physics import ARROWS, physics, refusal
from footopt.report.stage import ground
from footopt.report.terminal import describe_confirmation, describe_foot, describe_scene, describe_search
from footopt.walk import FIVE, MEASURES, Accuracy, Scene, Walk
from footopt.walk.phases import step_on_patch

Array = NDArray[np.float64]

WALKS = 200  # designs beside the best one whose walks are on the page
FRAMES = 60  # samples of the forces along the sole of each of their walks
FINE_FRAMES = 250  # of the walk that the page is about
SAMPLES = 4  # of the other traces, at most, for each of the forces along the sole
TRACES = ("com", "velocity", "force", "power", "work")
ON_THE_PAGE = ("front", "front_values", "confirmed")  # as designs, not as entries of result.json
HOLLOW = 0.5e-3  # m; a smaller one is called none
POSE_STEP = 0.01  # s, between the poses of the gait


def walk_content(walk: Walk, entry: dict[str, Any], flat: Walk | None = None) -> dict[str, Any]:
    """The page of one walk.

    Parameters
    ----------
    walk : Walk
        What the page is about.
    entry : dict
        What result.json says of the run.
    flat : Walk, optional
        That of the flat sole, which it is compared with.
    """
    others = [] if flat is None or flat is walk else [traces_of_flat(flat)]
    entry = {name: value for name, value in entry.items() if others or name != "flat"}
    foot, values = walk.foot, entry.get("objectives", walk.objectives)
    if foot.space is not None and foot.k is not None:
        shape: dict[str, Any] = {"k": packed(np.array(foot.k))}
    else:
        shape = {"soles": [packed(foot.contour, exact=True)]}
    return {
        **common(entry, walk.scene, tuple(values), walk.accuracy, foot, step_on_patch(walk)),
        "title": f"{title(foot.name)} on {sand_title(walk.scene.sand)}",
        "headline": [f"{describe_scene(walk.scene)}; {describe_foot(foot)}"],
        "space": splines(foot.space) if "k" in shape and foot.space else None,
        "top": foot.top,
        "width": foot.width,
        "designs": {
            "values": packed(np.array([list(values.values())], float), exact=True),
            "labels": [title(foot.name)],
            "feasible": [int(walk.feasible)],
            "reasons": [walk.reason],
            **shape,
        },
        "best": 0,
        "walks": [{"design": 0, "label": title(foot.name), **_traces(walk, FINE_FRAMES)}, *others],
    }


def walked_designs(result: SearchResult, confirmed: Confirmation) -> list[int]:
    """The designs beside the best one whose walks `search_content` holds: none where the page itself walks.

    Else the other finalists, of which more than `WALKS` are thinned out evenly.
    """
    problem, others = result.problem, confirmed.designs[1:].tolist()
    if not refusal(problem.scene, problem.accuracy, problem.space):
        return []
    return list(others[:: -(-len(others) // WALKS) or 1])


def search_content(
    result: SearchResult,
    confirmed: Confirmation,
    best: Walk,
    flat: Walk,
    walks: Iterable[tuple[int, Walk]],
    entry: dict[str, Any],
) -> dict[str, Any]:
    """The page of a search.

    It holds `SHOWN` designs at most: the front, and an even selection of the others.

    Parameters
    ----------
    result : SearchResult
        What the page is about.
    confirmed : Confirmation
        Its finalists, walked again.
    best, flat : Walk
        Of the best design and of the flat sole.
    walks : iterable of (int, Walk)
        Of `walked_designs`, with the design of each, at the search's accuracy.
    entry : dict
        What result.json says of the run.
    """
    problem = result.problem
    record, chosen = problem.record, int(confirmed.designs[0])
    front = result.shown.tolist() if problem.n_obj > 1 else []
    lineage = successive_bests(result)
    exact = result.solver.name == EXHAUSTIVE
    rows = np.union1d(result.selected(SHOWN), [*lineage, chosen])
    place = {row: i for i, row in enumerate(rows.tolist())}
    reasons = [*dict.fromkeys(map(str, result.reasons))]
    codes = np.array([reasons.index(str(r)) for r in result.reasons])
    return {
        **common(entry, problem.scene, record, problem.accuracy, problem.space, step_on_patch(best)),
        "title": verdict(best, flat, problem.names),
        "headline": [
            f"Soles for {', '.join(map(title, problem.names))} on {describe_scene(problem.scene)}",
            describe_search(result),
            describe_confirmation(confirmed),
            *([entry["certificate"]["says"]] if entry.get("certificate") else []),
            *([f"{len(rows)} of the designs are on this page"] if len(rows) < result.designs else []),
        ],
        "guide": problem.names[0],
        "choice": problem.choice.by if problem.n_obj > 1 else "best",
        "objectives": list(problem.names),
        "designs": {
            "rows": packed(rows),
            "values": packed(result.values[rows], exact=True),
            "k": packed(result.k[rows]),
            "generation": None if exact else packed(result.generation[rows]),
            "feasible": packed(result.feasible[rows].astype(int)),
            "reasons": reasons,
            "reason": packed(codes[rows]),
        },
        "space": splines(problem.space),
        "top": problem.space.top,
        "width": problem.space.width,
        "best": place[chosen],
        "bestValues": confirmed.values[0],
        "front": packed(np.array([place[i] for i in front], int)),
        "walks": [
            {"design": place[chosen], "label": "best", **_traces(best, FINE_FRAMES)},
            traces_of_flat(flat),
            *({"design": place[i], "label": f"design {i}", **_traces(walk, FRAMES)} for i, walk in walks),
        ],
        "lineage": [place[i] for i in lineage],
        "history": [] if exact else [
            {
                "evaluations": g.evaluations,
                "best": g.hypervolume if problem.n_obj > 1 else g.best,
                "median": g.median,
                "front": g.front,
            }
            for g in result.history
        ],
    }  # fmt: skip


def verdict(best: Walk, flat: Walk, sought: Sequence[str] = ()) -> str:
    """What became of the foot, in a line: its largest gain in what was sought, its largest loss in all."""
    kind = "A hollow foot" if best.foot.hollow >= HOLLOW else "A foot without a hollow"
    said = f"{kind} for {sand_title(best.scene.sand)}"
    goals = [name for name in sought if name != "efficiency" and name in best.objectives] or FIVE
    gains = {}  # relative
    for name in dict.fromkeys([*goals, *FIVE]):
        value, base = best.objectives[name], flat.objectives[name]
        if math.isfinite(change := value / base - 1.0 if base else math.nan):
            gains[name] = -MEASURES[name].sign * change
    told = {}
    for name in (
        *sorted(gains.keys() & goals, key=gains.__getitem__)[-1:],
        *sorted(gains, key=gains.__getitem__)[:1],
    ):
        less = (gains[name] > 0.0) == (MEASURES[name].sign > 0.0)
        if abs(gains[name]) >= 0.005:
            told[name] = f"{percent(abs(gains[name]))} {'less' if less else 'more'} {title(name)}"
    return f"{said}: {', '.join(told.values())} than a flat one" if told else said


def successive_bests(result: SearchResult) -> list[int]:
    """The designs that were the best so far at the end of a generation, in order; the last is the best.

    None for several objectives, and for a space that was enumerated: no search came to its designs.
    """
    if result.problem.n_obj > 1 or result.solver.name == EXHAUSTIVE:
        return []
    f = np.where(result.feasible, result.problem.minimised(result.values)[:, 0], np.inf)
    before = np.concatenate([[np.inf], np.minimum.accumulate(f)[:-1]])
    better = np.flatnonzero(f < before)
    last = np.append(result.generation[better][1:] != result.generation[better][:-1], True)
    return [int(i) for i in better[last]]


def common(
    entry: dict[str, Any],
    scene: Scene,
    names: Sequence[str],
    accuracy: Accuracy,
    foot: Foot | Waypoints,
    step: int = 0,
) -> dict[str, Any]:
    """What every page of walks holds: the columns of values, the scene's gait, the run's own facts."""
    t = np.linspace(0.0, scene.duration, int(np.ceil(scene.duration / POSE_STEP)) + 1)
    thigh, shank, pitch = (angle for angle, _ in scene.gait.angles(t))
    return {
        "columns": [column(name, MEASURES[name].unit, MEASURES[name].maximise) for name in names],
        "entry": {name: value for name, value in entry.items() if name not in ON_THE_PAGE},
        "ground": ground(scene),
        "physics": physics(scene, accuracy, foot),
        "gait": {
            "end": scene.duration,
            "angles": packed(np.stack([thigh, shank, pitch], axis=-1)),
            "strikes": scene.gait.heel_strikes(scene.duration),
            "step": step,  # that is shown close
            "l1": scene.walker.l1,
            "l2": scene.walker.l2,
        },
    }


def splines(space: Waypoints) -> dict[str, Any]:
    """Every sole of a space at once: a spline is linear in its heights.

    contour(k) = base + sum_i (k_i - 1) columns_i, in z; x is the same for all.
    """
    one = np.ones((1, space.n), int)
    base = space.contour(one)[0]
    raised = one + np.eye(space.n, dtype=int) if space.K > 1 else np.tile(one, (space.n, 1))
    columns = space.contour(raised)[:, :, 1] - base[:, 1]
    return {
        "n": space.n,
        "x": packed(base[:, 0], exact=True),
        "base": packed(base[:, 1], exact=True),
        "columns": packed(columns, exact=True),
        "waypoints": packed(space.x, exact=True),
        "step": space.H / space.K,
        "L": space.L,
        "H": space.H,
    }


def traces_of_flat(flat: Walk) -> dict[str, Any]:
    """The walk of the flat sole, which is no design of a page."""
    return {"design": None, "label": "flat", **_traces(flat, FINE_FRAMES), "sole": packed(flat.foot.contour)}


def _traces(walk: Walk, frames: int) -> dict[str, Any]:
    """A walk at its samples, or an even selection of many, and the forces along its sole at fewer."""
    foot = walk.foot
    shared = {"ankle": foot.ankle, "top": foot.top, "reason": walk.reason}
    if len(walk.t) == 0:
        return {**shared, "t": packed(walk.t)}
    index = np.unique(np.linspace(0, len(walk.t) - 1, SAMPLES * frames).astype(int))
    even = np.unique(np.searchsorted(walk.t, np.linspace(walk.t[0], walk.t[-1], frames)))
    sole = foot.plates(walk.accuracy.plates, walk.accuracy.rule)
    begin, size = groups(sole.x.shape[1], ARROWS)
    # relative to the ankle, as plates are; the page turns and carries them
    at = [np.add.reduceat(part[0], begin) / size for part in (sole.x, sole.z)]
    return {
        **shared,
        "t": packed(walk.t[index], exact=True),
        **{name: packed(getattr(walk, name)[index]) for name in TRACES},
        "at": packed(np.stack(at, axis=-1)),
        "area": packed(np.add.reduceat(sole.area[0], begin), exact=True),
        "when": packed(walk.t[even], exact=True),
        "arrows": packed(forces_along(walk, even, ARROWS).force),
    }
