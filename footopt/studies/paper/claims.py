"""Measures of the paper's claims: signed margins, positive where a claim holds.

claims.toml has the words of each claim: what its measure computes, and in which unit. A margin is NaN where a
walk that it needs failed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from functools import partial
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from footopt.foot import Foot
from footopt.gait.gait import RIGHT
from footopt.studies.paper.walks import Evidence, switch_losses
from footopt.walk import Walk
from footopt.walk.phases import LEAST_FORCE, stance

Array = NDArray[np.float64]
Walks = Mapping[str, Walk]
Number = str | Callable[[Walk], float]  # an objective, or another number of a walk

#: Numbers that stand in for the paper's words; none was moved to turn a verdict.
LIMITS = {
    "marked_loss": 0.1,  # m/s, speed lost at a switch that counts as marked: a tenth of the normal speed
    "normal_speed": 1.0,  # m/s (the paper: "around 1 m/s")
    "not_obvious": 0.2,  # how far curves may part that a reader sees as one, over their own rms
    "push_off": 0.27,  # s after touch-down, when push-off begins (the paper)
    "contact": LEAST_FORCE,  # N, vertical force above which a foot is in contact
}


def mean(walk: Walk, trace: Array) -> float:
    """The mean over time of a trace, (T,)."""
    late = walk.t >= walk.scene.gait.heel_strike
    t = walk.t[late]
    return float(np.trapezoid(trace[late], t) / (t[-1] - t[0]))


def mean_drag(walk: Walk, sign: int) -> float:
    """The mean over time of the forward (1) or backward (-1) part of both feet's f_x, N."""
    return mean(walk, np.maximum(sign * walk.force[..., 0], 0.0).sum(axis=1))


def peak_drag(walk: Walk, sign: int) -> float:
    """The largest f_x of one foot, forwards (1) or backwards (-1), N."""
    return float((sign * walk.force[walk.t >= walk.scene.gait.heel_strike, :, 0]).max())


def contact_share(walk: Walk) -> float:
    """The share of the time that a foot is in contact, mean of both feet."""
    return mean(walk, (walk.force[..., 1] > LIMITS["contact"]).mean(axis=1))


def time_to_speed(walk: Walk) -> float:
    """The time at which V_x first reaches the normal speed, s; t_f if it never does."""
    fast = np.flatnonzero(walk.velocity[:, 0] >= LIMITS["normal_speed"])
    return float(walk.t[fast[0]]) if len(fast) else walk.scene.duration


def work_after_three_steps(walk: Walk) -> float:
    """|W| of both feet half a stride after the third heel strike, or at t_f if that is sooner, J."""
    end = walk.scene.gait.heel_strike + 1.5 * walk.scene.gait.period
    return abs(float(np.interp(end, walk.t, walk.work.sum(axis=1))))


def first_step(walk: Walk) -> slice:
    """The samples of the first step, none if the foot never stands."""
    found = stance(walk)
    return slice(found.first, found.last + 1) if found else slice(0, 0)


def push(walk: Walk) -> tuple[float, float]:
    """The time for which the sand pushes the foot forwards, s, and the share of its impulse at push-off."""
    step = first_step(walk)
    t, lasts = walk.t[step], np.diff(walk.t, prepend=0.0)[step]
    impulse = np.maximum(walk.force[step, RIGHT, 0], 0.0) * lasts
    late = t - t[:1] >= LIMITS["push_off"]
    return float(lasts[impulse > 0.0].sum()), float(impulse[late].sum() / impulse.sum())


def contact_zone(walk: Walk, instants: int = 100) -> tuple[float, float, float]:
    """The part of the sole that is in the sand, mean over so many instants of the step.

    The share of all plates, that of the plates of the middle third, and x_p where the vertical force acts, m.
    """
    step = first_step(walk)
    if step.stop == 0:
        return np.nan, np.nan, np.nan
    t = walk.t[step] - walk.t[step.start]
    states = walk.plates(step.start + np.searchsorted(t, np.linspace(0.0, t[-1], instants)))
    x = walk.foot.plates(walk.accuracy.plates, walk.accuracy.rule).x[0] + walk.foot.ankle[0]
    heel, toe = walk.foot.contour[:, 0].min(), walk.foot.contour[:, 0].max()
    middle = np.abs(x - 0.5 * (toe + heel)) <= (toe - heel) / 6.0
    inside = states.position[:, RIGHT, :, 1] < 0.0
    up = states.force[:, RIGHT, :, 1]
    return float(inside.mean()), float(inside[:, middle].mean()), float((up @ x).sum() / up.sum())


def convexity(foot: Foot) -> float:
    """One level of the waypoints, H/K, less the hollow, mm: a smaller hollow may be the grid's own."""
    return np.nan if foot.space is None else 1e3 * (foot.space.H / foot.space.K - foot.hollow)


def bends(foot: Foot) -> tuple[float, float]:
    """The angle that a sole turns the wrong way for a convex one, deg; the rms of its curvature, 1/m."""
    chord = np.diff(foot.points(400), axis=0)
    turn, length = np.diff(np.unwrap(np.arctan2(chord[:, 1], chord[:, 0]))), np.hypot(*chord.T)[1:]
    inward = float(np.degrees(np.maximum(-turn, 0.0).sum()))
    return inward, float(np.sqrt(np.mean((turn / length) ** 2)))


def number(walk: Walk, what: Number) -> float:
    """An objective or another number of a walk; NaN if it failed."""
    if not walk.feasible:
        return np.nan
    return walk.objectives[what] if isinstance(what, str) else what(walk)


def lead(walks: Walks, what: Number, *names: str) -> float:
    """How far the numbers of some walks are above those of all others."""
    values = {name: number(walk, what) for name, walk in walks.items()}
    mine = [values.pop(name) for name in names]
    return float(np.min(mine) - np.max(list(values.values())))


def trail(walks: Walks, what: Number, *names: str) -> float:
    """How far the numbers of some walks are below those of all others."""
    return lead(walks, lambda walk: -number(walk, what), *names)


def loses_most(e: Evidence, walks: Walks, name: str) -> float:
    """How much more speed a walk loses than all others, at the switch where that is least."""
    losses = {other: switch_losses(walk, e.speed_loss) for other, walk in walks.items()}
    own = losses.pop(name)
    return float(np.min(own - np.max(list(losses.values()), axis=0)))


def vertical_parting(walks: Walks) -> float:
    """The largest rms distance of a walk's V_z(t) from the walks' mean, over the rms of the mean."""
    if not all(walk.feasible for walk in walks.values()):
        return np.nan
    scene = next(iter(walks.values())).scene
    t = np.linspace(scene.gait.start, scene.duration, 1000)
    curves = np.array([np.interp(t, walk.t, walk.velocity[:, 1]) for walk in walks.values()])
    middle = curves.mean(axis=0)
    parted = np.sqrt(np.mean((curves - middle) ** 2, axis=1))
    return float(parted.max() / np.sqrt(np.mean(middle**2)))


def soft_drag(e: Evidence, drag: Callable[..., float]) -> float:
    """How much larger a drag on soft sand is, in the direction where that is least."""
    return float(np.min([lead(e.optima, partial(drag, sign=sign), "soft") for sign in (1, -1)]))


def gap(one: Walk, other: Walk, what: Number) -> float:
    """How much more of something one walk has than another."""
    return number(one, what) - number(other, what)


def regular_foot(e: Evidence, what: Number) -> float:
    """How much more of something the foot for regular sand has on hard sand than its own foot."""
    return gap(e.crossed, e.optima["hard"], what)


def flatter(e: Evidence, sand: str) -> float:
    """How much less the best foot of a sand curves than that for hard sand."""
    return bends(e.optima["hard"].foot)[1] - bends(e.optima[sand].foot)[1]


TRIANGLE = "reversed_triangle"
MEASURES: dict[str, Callable[[Evidence], float]] = {
    # the five shapes
    "triangle_furthest": lambda e: lead(e.shapes, "distance", TRIANGLE),
    "triangle_fastest": lambda e: lead(e.shapes, lambda walk: mean(walk, walk.velocity[:, 0]), TRIANGLE),
    "flat_next": lambda e: lead(
        {name: walk for name, walk in e.shapes.items() if name != TRIANGLE}, "distance", "rectangle"
    ),
    "circle_highest": lambda e: lead(e.shapes, "mean_height", "circle"),
    "circle_shortest": lambda e: trail(e.shapes, "distance", "circle"),
    "circle_loses": lambda e: (
        float(np.min(switch_losses(e.shapes["circle"], e.speed_loss))) - LIMITS["marked_loss"]
    ),
    "circle_loses_most": lambda e: loses_most(e, e.shapes, "circle"),
    "same_vertical_velocity": lambda e: LIMITS["not_obvious"] - vertical_parting(e.shapes),
    "circle_most_power": lambda e: lead(e.shapes, "peak_power", "circle"),
    "ellipse_and_flat_least_power": lambda e: trail(e.shapes, "peak_power", "ellipse", "rectangle"),
    # the contours
    "hard_hollow": lambda e: -convexity(e.optima["hard"].foot),
    "hard_bends_in": lambda e: lead(e.optima, lambda walk: bends(walk.foot)[0], "hard"),
    "regular_convex": lambda e: convexity(e.optima["regular"].foot),
    "soft_convex": lambda e: convexity(e.optima["soft"].foot),
    "regular_curves_little": lambda e: flatter(e, "regular"),
    "soft_curves_little": lambda e: flatter(e, "soft"),
    # a step on hard sand
    "hollow_spares_plates": lambda e: gap(e.filled, e.optima["hard"], lambda walk: contact_zone(walk)[1]),
    "hollow_saves_work": lambda e: gap(e.filled, e.optima["hard"], "work"),
    "push_off_carries": lambda e: number(e.optima["hard"], lambda walk: push(walk)[1]) - 0.5,
    "regular_foot_larger_zone": lambda e: regular_foot(e, lambda walk: contact_zone(walk)[0]),
    "regular_foot_leads": lambda e: 1e3 * regular_foot(e, lambda walk: contact_zone(walk)[2]),
    "regular_foot_pushes_longer": lambda e: regular_foot(e, lambda walk: push(walk)[0]),
    "regular_foot_more_power": lambda e: regular_foot(e, "peak_power"),
    "regular_foot_more_work": lambda e: regular_foot(e, "work"),
    # three sands, each with its best foot
    "hard_furthest": lambda e: lead(e.optima, "distance", "hard"),
    "hard_sinks_least": lambda e: trail(e.optima, "maximum_sinkage", "hard"),
    "soft_shortest": lambda e: trail(e.optima, "distance", "soft"),
    "soft_sinks_deepest": lambda e: lead(e.optima, "maximum_sinkage", "soft"),
    "soft_loses_most": lambda e: loses_most(e, e.optima, "soft"),
    "soft_slowest_start": lambda e: lead(e.optima, time_to_speed, "soft"),
    "soft_peak_drag": lambda e: soft_drag(e, peak_drag),
    "soft_mean_drag": lambda e: soft_drag(e, mean_drag),
    "soft_longest_contact": lambda e: lead(e.optima, contact_share, "soft"),
    "soft_most_work": lambda e: lead(e.optima, work_after_three_steps, "soft"),
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
        return {name: float(margin(evidence)) for name, margin in MEASURES.items()}
