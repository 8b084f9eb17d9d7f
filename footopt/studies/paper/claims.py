"""Measures of the paper's claims: signed margins, positive where a claim holds.

claims.toml has the words of each claim: what its measure computes, and in which unit. A margin is NaN where a
walk that it needs failed.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.foot import Foot
from footopt.gait.gait import RIGHT
from footopt.studies.paper.walks import Evidence, switch_losses
from footopt.walk import Walk
from footopt.walk.phases import LEAST_FORCE, stance

Array = NDArray[np.float64]
Numbers = Mapping[str, float]  # of a walk, by name

#: Numbers that stand in for the paper's words; none was moved to turn a verdict.
LIMITS = {
    "marked_loss": 0.1,  # m/s, speed lost at a switch that counts as marked: a tenth of the normal speed
    "normal_speed": 1.0,  # m/s (the paper: "around 1 m/s")
    "not_obvious": 0.2,  # how far curves may part that a reader sees as one, over their own rms
    "push_off": 0.27,  # s after touch-down, when push-off begins (the paper)
    "contact": LEAST_FORCE,  # N, vertical force above which a foot is in contact
}


def numbers(walk: Walk, speed_loss: str) -> Numbers:
    """The numbers that claims compare, of the sole and of the walk; the latter are NaN if it failed."""
    found: dict[str, float] = defaultdict(lambda: np.nan, of_contour(walk.foot))
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


def of_traces(walk: Walk) -> dict[str, float]:
    """Numbers of the traces, most of them from the first heel strike on: means over time, and peaks."""
    gait, late = walk.scene.gait, walk.t >= walk.scene.gait.heel_strike
    t, drag = walk.t[late], walk.force[late, :, 0]

    def mean(trace: Array) -> float:
        return float(np.trapezoid(trace, t) / (t[-1] - t[0]))

    fast = np.flatnonzero(walk.velocity[:, 0] >= LIMITS["normal_speed"])
    three_steps = gait.heel_strike + 1.5 * gait.period
    return {
        "mean_speed": mean(walk.velocity[late, 0]),
        "time_to_speed": float(walk.t[fast[0]]) if len(fast) else walk.scene.duration,
        "work_after_three_steps": abs(float(np.interp(three_steps, walk.t, walk.work.sum(axis=1)))),
        "contact_share": mean((walk.force[late, :, 1] > LIMITS["contact"]).mean(axis=1)),
        "mean_drag_forwards": mean(np.maximum(drag, 0.0).sum(axis=1)),
        "mean_drag_backwards": mean(np.maximum(-drag, 0.0).sum(axis=1)),
        "peak_drag_forwards": float(drag.max()),
        "peak_drag_backwards": float(-drag.min()),
    }


def of_first_step(walk: Walk, instants: int = 100) -> dict[str, float]:
    """Numbers of the first step: how it pushes, and the part of the sole in the sand, mean over instants."""
    found = stance(walk)
    if found is None:
        return {}
    step = slice(found.first, found.last + 1)
    t, lasts = walk.t[step] - walk.t[found.first], np.diff(walk.t, prepend=0.0)[step]
    impulse = np.maximum(walk.force[step, RIGHT, 0], 0.0) * lasts
    states = walk.plates(found.first + np.searchsorted(t, np.linspace(0.0, t[-1], instants)))
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


class Found(NamedTuple):
    """`Evidence` as numbers."""

    shapes: Mapping[str, Numbers]
    optima: Mapping[str, Numbers]
    crossed: Numbers
    filled: Numbers
    parting: float  # of the shapes' vertical velocities


def find(e: Evidence) -> Found:
    """The numbers of all walks."""

    def each(walks: Mapping[str, Walk]) -> dict[str, Numbers]:
        return {name: numbers(walk, e.speed_loss) for name, walk in walks.items()}

    others = each({"crossed": e.crossed, "filled": e.filled})
    return Found(each(e.shapes), each(e.optima), **others, parting=vertical_parting(e.shapes))


def vertical_parting(walks: Mapping[str, Walk]) -> float:
    """The largest rms distance of a walk's V_z(t) from the walks' mean, over the rms of the mean."""
    if not all(walk.feasible for walk in walks.values()):
        return np.nan
    scene = next(iter(walks.values())).scene
    t = np.linspace(scene.gait.start, scene.duration, 1000)
    curves = np.array([np.interp(t, walk.t, walk.velocity[:, 1]) for walk in walks.values()])
    middle = curves.mean(axis=0)
    parted = np.sqrt(np.mean((curves - middle) ** 2, axis=1))
    return float(parted.max() / np.sqrt(np.mean(middle**2)))


def lead(walks: Mapping[str, Numbers], number: str, *names: str) -> float:
    """How far a number of some walks is above that of all others."""
    values = {name: found[number] for name, found in walks.items()}
    own = [values.pop(name) for name in names]
    return float(np.min(own) - np.max(list(values.values())))


def trail(walks: Mapping[str, Numbers], number: str, *names: str) -> float:
    """How far a number of some walks is below that of all others."""
    return lead({name: {number: -found[number]} for name, found in walks.items()}, number, *names)


def loses_most(walks: Mapping[str, Numbers], name: str) -> float:
    """How much more speed a walk loses than all others, at the switch where that is least."""
    return float(np.min([lead(walks, f"loss_{i}", name) for i in range(3)]))


def regular_foot(e: Found, number: str) -> float:
    """How much more of something the foot for regular sand has on hard sand than its own foot."""
    return e.crossed[number] - e.optima["hard"][number]


def soft_drag(e: Found, drag: str) -> float:
    """How much larger a drag on soft sand is, in the direction where that is least."""
    return float(np.min([lead(e.optima, f"{drag}_{way}", "soft") for way in ("forwards", "backwards")]))


TRIANGLE = "reversed_triangle"
MEASURES: dict[str, Callable[[Found], float]] = {
    # the five shapes
    "triangle_furthest": lambda e: lead(e.shapes, "distance", TRIANGLE),
    "triangle_fastest": lambda e: lead(e.shapes, "mean_speed", TRIANGLE),
    "flat_next": lambda e: lead(
        {n: v for n, v in e.shapes.items() if n != TRIANGLE}, "distance", "rectangle"
    ),
    "circle_highest": lambda e: lead(e.shapes, "mean_height", "circle"),
    "circle_shortest": lambda e: trail(e.shapes, "distance", "circle"),
    "circle_loses": lambda e: (
        float(np.min([e.shapes["circle"][f"loss_{i}"] for i in range(3)])) - LIMITS["marked_loss"]
    ),
    "circle_loses_most": lambda e: loses_most(e.shapes, "circle"),
    "same_vertical_velocity": lambda e: LIMITS["not_obvious"] - e.parting,
    "circle_most_power": lambda e: lead(e.shapes, "peak_power", "circle"),
    "ellipse_and_flat_least_power": lambda e: trail(e.shapes, "peak_power", "ellipse", "rectangle"),
    # the contours
    "hard_hollow": lambda e: -e.optima["hard"]["convexity"],
    "hard_bends_in": lambda e: lead(e.optima, "inward_turn", "hard"),
    "regular_convex": lambda e: e.optima["regular"]["convexity"],
    "soft_convex": lambda e: e.optima["soft"]["convexity"],
    "regular_curves_little": lambda e: e.optima["hard"]["curvature"] - e.optima["regular"]["curvature"],
    "soft_curves_little": lambda e: e.optima["hard"]["curvature"] - e.optima["soft"]["curvature"],
    # a step on hard sand
    "hollow_spares_plates": lambda e: e.filled["middle_zone"] - e.optima["hard"]["middle_zone"],
    "hollow_saves_work": lambda e: e.filled["work"] - e.optima["hard"]["work"],
    "push_off_carries": lambda e: e.optima["hard"]["push_off_share"] - 0.5,
    "regular_foot_larger_zone": lambda e: regular_foot(e, "zone"),
    "regular_foot_leads": lambda e: 1e3 * regular_foot(e, "centre"),
    "regular_foot_pushes_longer": lambda e: regular_foot(e, "push_time"),
    "regular_foot_more_power": lambda e: regular_foot(e, "peak_power"),
    "regular_foot_more_work": lambda e: regular_foot(e, "work"),
    # three sands, each with its best foot
    "hard_furthest": lambda e: lead(e.optima, "distance", "hard"),
    "hard_sinks_least": lambda e: trail(e.optima, "maximum_sinkage", "hard"),
    "soft_shortest": lambda e: trail(e.optima, "distance", "soft"),
    "soft_sinks_deepest": lambda e: lead(e.optima, "maximum_sinkage", "soft"),
    "soft_loses_most": lambda e: loses_most(e.optima, "soft"),
    "soft_slowest_start": lambda e: lead(e.optima, "time_to_speed", "soft"),
    "soft_peak_drag": lambda e: soft_drag(e, "peak_drag"),
    "soft_mean_drag": lambda e: soft_drag(e, "mean_drag"),
    "soft_longest_contact": lambda e: lead(e.optima, "contact_share", "soft"),
    "soft_most_work": lambda e: lead(e.optima, "work_after_three_steps", "soft"),
}

#: The words of each claim, by the name of its measure.
CLAIMS: dict[str, dict[str, str]] = tomllib.loads(
    files(__package__).joinpath("claims.toml").read_text(encoding="utf-8")
)
for claim in CLAIMS.values():
    claim["decided"] = claim["decided"].format(**LIMITS)


def measure(evidence: Evidence) -> dict[str, float]:
    """The margins of all claims, by their names."""
    with np.errstate(invalid="ignore"):
        found = find(evidence)
        return {name: float(margin(found)) for name, margin in MEASURES.items()}
