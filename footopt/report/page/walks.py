"""Pages of a walk, and of a search with those of its best design and the flat sole; the page's own walk."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from footopt.design import EXHAUSTIVE, Confirmation, SearchResult
from footopt.design.certificate import joined
from footopt.design.result import SHOWN
from footopt.design.scenarios import possible_laws
from footopt.effects import name_of
from footopt.foot import Foot, Plates, Waypoints
from footopt.foot.plates import RULES
from footopt.foot.waypoints import FINE, slope_matrix
from footopt.gait import STANDING
from footopt.report.numbers import title
from footopt.report.page.file import column, packed
from footopt.report.stage import ARROWS, forces_along, ground, groups
from footopt.report.style import sides
from footopt.report.terminal import describe_confirmation, describe_scene, describe_search
from footopt.sand.law import EARTH, PER_CM3
from footopt.walk import MEASURES, STEPPERS, Accuracy, Scene, Walk, discretize, newton
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.checks import WHY
from footopt.walk.contact import BENT, EXPOSED, TURN
from footopt.walk.ladder import numerics
from footopt.walk.loop import MAX_REPEATS, NEAR_PEAK, PEAK
from footopt.walk.metrics import JUMP
from footopt.walk.objectives import floors

FRAMES = 250  # samples of a walk's forces along the sole
SAMPLES = 4  # of its other traces, at most, for each of them
TRACES = ("com", "velocity", "force", "power", "work")
ON_THE_PAGE = ("front", "front_values", "confirmed")  # as designs, not as entries of result.json
POSE_STEP = 0.01  # s, between the poses of the gait
OUTSIDE = "a robot walks in MuJoCo, not in the page"
STEPPER = "sdirk2"  # of the page's own walk
ROWS = 200_000  # poses, at most, of a walk that a browser is to tabulate: 22 MB


def walk_content(walk: Walk, entry: dict[str, Any], flat: Walk | None = None) -> dict[str, Any]:
    """The page of one walk, beside that of the flat sole; `entry` is the run's result.json."""
    others = [] if flat is None or flat is walk else [_traces(flat, "flat")]
    entry = {name: value for name, value in entry.items() if others or name != "flat"}
    foot, values = walk.foot, entry.get("objectives", walk.objectives)
    space = foot.space if foot.k is not None else None
    given = foot.k is not None and foot.name.startswith("k=")  # the page tells k beside the sole
    name = "as given" if given else title(foot.name)
    return {
        **_common(entry, walk, tuple(values), walk.accuracy, foot),
        "title": f"A walk on {place(walk.world)}{f': {name}' * (not given)}",
        "headline": [describe_scene(walk.scene)],
        "warnings": [] if walk.feasible else [f"The walk failed: {walk.reason}."],
        "space": space and spline(space),
        "top": foot.top,
        "designs": {
            "values": packed(np.array([list(values.values())], float)),
            "labels": [name],
            "feasible": [int(walk.feasible)],
            "reasons": [walk.reason],
            **({"k": packed(np.array(foot.k))} if space else {"soles": [packed(foot.contour)]}),
        },
        "best": 0,
        "walks": [_traces(walk, name, 0), *others],
    }


def search_content(
    result: SearchResult, confirmed: Confirmation, best: Walk, flat: Walk, entry: dict[str, Any]
) -> dict[str, Any]:
    """The page of a search, with the walks of its best design and of the flat sole.

    It holds `SHOWN` designs at most: the front, the foot to print, and an even selection of the others.
    `entry` is the run's result.json.
    """
    problem, chosen, several = result.problem, int(confirmed.designs[0]), result.problem.n_obj > 1
    exact = result.solver.name == EXHAUSTIVE
    search, printed = describe_search(result), []
    finely: list[float] | None = None
    if entry.get("to_print"):
        k = np.array([entry["to_print"]["k"]])
        result = joined(result, k, *problem.walk(k))
        printed = np.flatnonzero((result.k == k).all(axis=1)).tolist()
        change = entry["to_print"]["laws"][0]["change"]  # at the finer accuracy
        finely = [entry["flat"][name] * (1.0 + change[name]) for name in problem.record]
    others = np.setdiff1d(np.arange(result.designs), result.shown)
    room = min(SHOWN - len(result.shown), len(others))
    even = others[np.linspace(0, len(others) - 1, room).astype(int)]
    rows = np.union1d(result.shown, [*even, chosen, *printed])
    certificate = entry.get("certificate")
    return {
        **_common(entry, best, problem.record, problem.accuracy, problem.space),
        "title": f"A foot for {place(best.world)}",
        "headline": [
            f"Designed for {', '.join(map(title, problem.names))} on {describe_scene(problem.scene)}",
            search,
            describe_confirmation(confirmed),
            *([certificate["says"]] if certificate else []),
            *([f"{len(rows)} of the designs are on this page"] if len(rows) < result.designs else []),
        ],
        "warnings": entry["remarks"],
        "ranking_objective": problem.names[0],
        "choice": problem.choice.by if several else "best",
        "objectives": list(problem.names),
        "designs": {
            "rows": packed(rows),
            "values": packed(result.values[rows]),
            "k": packed(result.k[rows]),
            "generation": None if exact else packed(result.generation[rows]),
            "feasible": result.feasible[rows].astype(int),
            "reasons": result.reasons[rows],
        },
        "space": spline(problem.space),
        "top": problem.space.top,
        "best": int(np.searchsorted(rows, chosen)),
        "bestValues": confirmed.values[0],
        "printedValues": finely,
        "printed": int(np.searchsorted(rows, printed[0])) if printed else None,
        "front": packed(np.searchsorted(rows, result.shown if several else [])),
        "walks": [_traces(best, "best", int(np.searchsorted(rows, chosen))), _traces(flat, "flat")],
        "history": [] if exact else [
            {"evaluations": g.evaluations, "best": g.hypervolume if several else g.best,
             "median": g.median, "front": g.front} for g in result.history
        ],
    }  # fmt: skip


def place(world: Scene) -> str:
    """The sand of a scene, and its gravity unless it is the Earth's."""
    return world.sand.title + ("" if abs(world.g - EARTH) < 1e-9 else f", gravity {world.g:g} m/s^2")


def _common(
    entry: dict[str, Any], walk: Walk, names: Sequence[str], accuracy: AnyAccuracy, foot: Foot | Waypoints
) -> dict[str, Any]:
    """The columns of values, the scene's gait, the constants of walks, and the run's own entry."""
    scene, world = walk.scene, walk.world
    spread = entry.get("settings", {}).get("sand", {}).get("spread", 0.0)
    t = np.linspace(0.0, world.duration, int(np.ceil(world.duration / POSE_STEP)) + 1)
    angles = np.stack([angle for angle, _ in world.gait.angles(t)], axis=-1)
    return {
        "columns": [column(name, MEASURES[name].unit, MEASURES[name].maximise) for name in names],
        "entry": {name: value for name, value in entry.items() if name not in ON_THE_PAGE},
        "ground": ground(world),
        "sides": [side for side, _ in sides(walk)],
        "physics": physics(scene, accuracy, foot, spread)
        if isinstance(scene, Scene)
        else {"refusal": OUTSIDE},
        "gait": {
            "end": world.duration,
            "angles": packed(angles),  # thigh, shank and pitch of both legs, for soles that have not walked
            "strikes": world.strikes,
            "l1": world.walker.l1,
            "l2": world.walker.l2,
        },
    }


def _traces(walk: Walk, label: str, design: int | None = None) -> dict[str, Any]:
    """A walk, of a design or of the flat sole: an even selection of its samples, and forces at fewer."""
    foot = walk.foot
    shared: dict[str, Any] = {"design": design, "label": label, "reason": walk.reason}
    shared |= {"ankle": foot.ankle, "top": foot.top, "sole": packed(foot.contour)}
    if len(walk.t) == 0:
        return {**shared, "t": packed(walk.t)}
    index = np.unique(np.linspace(0, len(walk.t) - 1, SAMPLES * FRAMES).astype(int))
    even = np.unique(np.searchsorted(walk.t, np.linspace(walk.t[0], walk.t[-1], FRAMES)))
    sole, legs = walk.sole, {}
    if not isinstance(walk.scene, Scene):  # joints of both legs and the pitch of their feet
        joints, pitch = walk.legs(walk.t[index]), walk.pitch(walk.t[index])
        legs = {"legs": packed(np.concatenate([joints.reshape(*pitch.shape, -1), pitch[..., None]], axis=2))}
    begin, size = groups(sole.x.shape[1])
    # relative to the ankle, as plates are; the page turns and carries them
    at = [np.add.reduceat(part[0], begin) / size for part in (sole.x, sole.z)]
    return {
        **shared,
        "t": packed(walk.t[index]),
        **{name: packed(getattr(walk, name)[index]) for name in TRACES},
        **legs,
        "at": packed(np.stack(at, axis=-1)),
        "when": packed(walk.t[even]),
        "arrows": packed(forces_along(walk, even)[1]),
    }


def physics(
    scene: Scene, accuracy: AnyAccuracy, foot: Foot | Waypoints, spread: float = 0.0
) -> dict[str, Any]:
    """The constants, in SI units, of the page's walks: of its one foot, or of all soles of a space.

    `spread` is a standard deviation of the logarithm of zeta, by which other laws of sand differ. Where the
    page cannot walk, only the reason, as "refusal".
    """
    accuracy = numerics(accuracy, scene, foot)
    if why := refusal(scene, accuracy, foot):
        return {"refusal": why}
    gait, walker, (tilt, g) = scene.gait, scene.walker, scene.gravity
    foot_pitch = gait.foot if gait.pitch == "measured" else None
    return {
        "sand": {
            "zeta": scene.sand.zeta,
            "gravity": walker.g / EARTH,
            "unit": PER_CM3,
            "law": scene.sand.stress_map.law._asdict(),
        },
        "walker": asdict(walker),
        "gravity": {"g": g, "tilt": tilt},
        "gait": {
            "thigh": gait.thigh._asdict(),
            "knee": gait.knee._asdict(),
            "pitch": None if foot_pitch is None else foot_pitch._asdict(),
            "start": gait.start,
            "period": gait.period,
            "standing": STANDING,
        },
        "end": scene.duration,
        "strike": gait.heel_strike,
        "accuracy": {
            **asdict(accuracy),
            "parts": RULES[accuracy.rule],
            "gamma": STEPPERS[STEPPER].parameters.gamma,
            "rest": discretize.REST,
            "halvings": discretize.HALVINGS,
            "traced": discretize.TRACED,
            "tabled": discretize.TABLED,
            "newton": newton.NEWTON,
            "most": newton.MAX_NEWTON,
            "shortest": newton.SHORTEST,
            "inside": newton.INSIDE,
            "gated": newton.SMOOTH_STEP,
            "changed": newton.CHANGED,
            "changedGated": newton.CHANGED_GATED,
            "turn": TURN,
            "exposed": EXPOSED,
            "bent": BENT,
            "near": NEAR_PEAK,
            "peak": PEAK,
            "jump": JUMP,
            "repeats": MAX_REPEATS,
        },
        "arrows": ARROWS,
        "effects": _laws(scene),
        "others": [
            {
                "law": other.name,
                "zeta": other.scene.sand.zeta / scene.sand.zeta,
                "effects": _laws(other.scene),
            }
            for other in possible_laws(scene, spread)[1:]
            if all(e.in_page for e in other.scene.effects)
        ],
        "why": [WHY[name] for name in ("depth of the sole", "depth of the ankle")],
        "floors": floors(scene),
        "foot": {"ankle": foot.ankle, "width": foot.width},
        "plates": _plates(foot, accuracy) if isinstance(foot, Foot) and foot.k is None else None,
    }


def _plates(foot: Foot, accuracy: Accuracy) -> dict[str, Any]:
    """The plates of a sole without waypoints; the page cuts those of others itself."""
    cut = foot.plates(accuracy.plates, accuracy.rule)
    columns = {name: packed(getattr(cut, name)[0], double=True) for name in Plates._fields[:8]}
    return {**columns, "span": float(cut.span[0])}


def _laws(scene: Scene) -> dict[str, Any]:
    """The laws of effects by their names."""
    return {name_of(e): e.law._asdict() for e in scene.effects if e.law is not None}


def spline(space: Waypoints) -> dict[str, Any]:
    """The constants of the splines through waypoints."""
    return {**asdict(space), "fine": FINE, "slopes": slope_matrix(space.n)}


def refusal(scene: Scene, accuracy: Accuracy, foot: Foot | Waypoints) -> str:
    """The reason for which the page cannot walk by itself, or ""."""
    if others := [name_of(e) for e in scene.effects if not e.in_page]:
        return f"effects={', '.join(others)} of this run is not in the page's own walk"
    if accuracy.stepper != STEPPER:
        return f"accuracy.stepper={accuracy.stepper} of this run is not in the page's own walk"
    if foot.closed:
        return "foot.closed=true of this run is not in the page's own walk"
    if discretize.pose_rows(scene.path, accuracy) > ROWS:
        return "the walk of this run is too long, or its steps are too short, to be made while one waits"
    return ""
