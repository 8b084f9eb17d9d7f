"""How each claim is measured: a signed margin, positive where the claim holds.

claims.toml says in words what each measure computes and in which unit. A margin is NaN where a walk that it
needs failed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from footopt.studies.paper import quantities as q
from footopt.studies.paper.evidence import Evidence
from footopt.walk import Walk
from footopt.walk.phases import STANDS

#: Numbers that stand in for the paper's words; none was moved to turn a verdict.
LIMITS = {
    "marked_loss": 0.1,  # m/s, speed lost at a switch that counts as marked: a tenth of the normal speed
    "normal_speed": 1.0,  # m/s (the paper: "around 1 m/s")
    "not_obvious": 0.2,  # how far curves may part that a reader sees as one, over their own rms
    "push_off": 0.27,  # s after touch-down, when push-off begins (the paper)
    "contact": STANDS,  # N, vertical force above which a foot is in contact
}


def lead(values: Mapping[str, float], name: str) -> float:
    """Return how far one value is above all others; NaN if any is."""
    return float(values[name] - np.max([v for other, v in values.items() if other != name]))


def trail(values: Mapping[str, float], name: str) -> float:
    """Return how far one value is below all others; NaN if any is."""
    return lead({other: -v for other, v in values.items()}, name)


def flat_next(e: Evidence) -> float:
    """Leave the triangle out: the flat foot leads the rest."""
    distance = e.of_shapes("distance")
    del distance["reversed_triangle"]
    return lead(distance, "rectangle")


def loses_most(e: Evidence, name: str, others: Mapping[str, Walk]) -> float:
    """Return how much more speed one walk loses than the others, at the switch where that is least."""
    most = np.max([e.losses[other] for other in others if other != name], axis=0)
    return float(np.min(e.losses[name] - most))


def ellipse_and_flat_least_power(e: Evidence) -> float:
    """Compare the larger of the two with the smallest of the rest."""
    power = e.of_shapes("peak_power")
    two = [power.pop("ellipse"), power.pop("rectangle")]
    return float(np.min(list(power.values())) - np.max(two))


def soft_drag(e: Evidence, drag: Callable[[Walk, int], float]) -> float:
    """Return how much larger a drag on soft sand is, in the direction where that is least."""
    ways = [{sand: drag(walk, way) for sand, walk in e.optima.items()} for way in (1, -1)]
    return min(lead(of_sands, "soft") for of_sands in ways)


MEASURES: dict[str, Callable[[Evidence], float]] = {
    # the five shapes
    "triangle_furthest": lambda e: lead(e.of_shapes("distance"), "reversed_triangle"),
    "triangle_fastest": lambda e: lead(e.of_shapes(q.mean_speed), "reversed_triangle"),
    "flat_next": flat_next,
    "circle_highest": lambda e: lead(e.of_shapes("mean_height"), "circle"),
    "circle_shortest": lambda e: trail(e.of_shapes("distance"), "circle"),
    "circle_loses": lambda e: float(np.min(e.losses["circle"])) - LIMITS["marked_loss"],
    "circle_loses_most": lambda e: loses_most(e, "circle", e.shapes),
    "same_vertical_velocity": lambda e: LIMITS["not_obvious"] - q.vertical_parting(list(e.shapes.values())),
    "circle_most_power": lambda e: lead(e.of_shapes("peak_power"), "circle"),
    "ellipse_and_flat_least_power": ellipse_and_flat_least_power,
    # the contours
    "hard_hollow": lambda e: -q.convexity(e.hard.foot),
    "hard_bends_in": lambda e: lead(e.of_optima(lambda walk: q.inward_turn(walk.foot)), "hard"),
    "regular_convex": lambda e: q.convexity(e.optima["regular"].foot),
    "soft_convex": lambda e: q.convexity(e.optima["soft"].foot),
    "regular_curves_little": lambda e: (
        q.rms_curvature(e.hard.foot) - q.rms_curvature(e.optima["regular"].foot)
    ),
    "soft_curves_little": lambda e: q.rms_curvature(e.hard.foot) - q.rms_curvature(e.optima["soft"].foot),
    # a step on hard sand
    "hollow_spares_plates": lambda e: q.contact_zone(e.filled).middle - q.contact_zone(e.hard).middle,
    "hollow_saves_work": lambda e: e.value(e.filled, "work") - e.value(e.hard, "work"),
    "push_off_carries": lambda e: q.push_share(e.hard, LIMITS["push_off"]) - 0.5,
    "regular_foot_larger_zone": lambda e: q.contact_zone(e.crossed).whole - q.contact_zone(e.hard).whole,
    "regular_foot_leads": lambda e: 1e3 * (q.contact_zone(e.crossed).centre - q.contact_zone(e.hard).centre),
    "regular_foot_pushes_longer": lambda e: q.push_time(e.crossed) - q.push_time(e.hard),
    "regular_foot_more_power": lambda e: e.value(e.crossed, "peak_power") - e.value(e.hard, "peak_power"),
    "regular_foot_more_work": lambda e: e.value(e.crossed, "work") - e.value(e.hard, "work"),
    # three sands, each with its best foot
    "hard_furthest": lambda e: lead(e.of_optima("distance"), "hard"),
    "hard_sinks_least": lambda e: trail(e.of_optima("maximum_sinkage"), "hard"),
    "soft_shortest": lambda e: trail(e.of_optima("distance"), "soft"),
    "soft_sinks_deepest": lambda e: lead(e.of_optima("maximum_sinkage"), "soft"),
    "soft_loses_most": lambda e: loses_most(e, "soft", e.optima),
    "soft_slowest_start": lambda e: lead(
        e.of_optima(lambda walk: q.time_to_speed(walk, LIMITS["normal_speed"])), "soft"
    ),
    "soft_peak_drag": lambda e: soft_drag(e, q.peak_drag),
    "soft_mean_drag": lambda e: soft_drag(e, q.mean_drag),
    "soft_longest_contact": lambda e: lead(e.of_optima(q.contact_share), "soft"),
    "soft_most_work": lambda e: lead(e.of_optima(q.work_after_three_steps), "soft"),
}
