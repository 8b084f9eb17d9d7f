"""What the paper says comes out, and how it is measured: a signed margin, positive where a claim holds.

claims.toml has the words of each claim: what its measure computes, and in which unit. A margin is NaN where a
walk that it needs failed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from typing import NamedTuple

import numpy as np

from footopt.studies.paper import quantities as q
from footopt.studies.paper.readings import Readings, switch_losses
from footopt.walk import Walk
from footopt.walk.phases import STANDS

SANDS = ("soft", "regular", "hard")

#: Numbers that stand in for the paper's words; none was moved to turn a verdict.
LIMITS = {
    "marked_loss": 0.1,  # m/s, speed lost at a switch that counts as marked: a tenth of the normal speed
    "normal_speed": 1.0,  # m/s (the paper: "around 1 m/s")
    "not_obvious": 0.2,  # how far curves may part that a reader sees as one, over their own rms
    "push_off": 0.27,  # s after touch-down, when push-off begins (the paper)
    "contact": STANDS,  # N, vertical force above which a foot is in contact
}

Walks = Mapping[str, Walk]
Number = str | Callable[[Walk], float]  # an objective, or another number of a walk


@dataclass(frozen=True, eq=False)
class Evidence:
    """The walks that claims are measured on, with p_max and dV_x as they are read."""

    shapes: Walks  # of the five shapes, by name
    optima: Walks  # of the best foot of each sand on that sand, by sand
    crossed: Walk  # of the best foot for regular sand, on hard sand
    filled: Walk  # of the best foot for hard sand with its hollow filled up, on hard sand
    readings: Readings

    @property
    def hard(self) -> Walk:
        """The walk of the best foot for hard sand on hard sand."""
        return self.optima["hard"]

    def more(self, what: Number) -> float:
        """Return how much more of something the foot for regular sand has on hard sand than its own foot."""
        return _number(self.crossed, what) - _number(self.hard, what)


def _number(walk: Walk, what: Number) -> float:
    if not walk.feasible:
        return q.NAN
    return walk.objectives[what] if isinstance(what, str) else what(walk)


def lead(walks: Walks, what: Number, name: str) -> float:
    """Return how far one walk's number is above those of all others; NaN if any failed."""
    others = [_number(walk, what) for other, walk in walks.items() if other != name]
    return float(_number(walks[name], what) - np.max(others))


def trail(walks: Walks, what: Number, name: str) -> float:
    """Return how far one walk's number is below those of all others; NaN if any failed."""
    return lead(walks, lambda walk: -_number(walk, what), name)


def flat_next(e: Evidence) -> float:
    """Leave the triangle out: the flat foot leads the rest."""
    rest = {name: walk for name, walk in e.shapes.items() if name != "reversed_triangle"}
    return lead(rest, "distance", "rectangle")


def loses_most(e: Evidence, walks: Walks, name: str) -> float:
    """Return how much more speed one walk loses than the others, at the switch where that is least."""
    losses = {other: switch_losses(walk, e.readings) for other, walk in walks.items()}
    own = losses.pop(name)
    return float(np.min(own - np.max(list(losses.values()), axis=0)))


def ellipse_and_flat_least_power(e: Evidence) -> float:
    """Compare the larger of the two with the smallest of the rest."""
    power = {name: walk.objectives["peak_power"] for name, walk in e.shapes.items()}
    two = [power.pop("ellipse"), power.pop("rectangle")]
    return float(np.min(list(power.values())) - np.max(two))


def soft_drag(e: Evidence, drag: Callable[..., float]) -> float:
    """Return how much larger a drag on soft sand is, in the direction where that is least."""
    return float(np.min([lead(e.optima, partial(drag, way=way), "soft") for way in (1, -1)]))


def curves_little(e: Evidence, sand: str) -> float:
    """Return how much less the best foot of a sand curves than that for hard sand."""
    return q.rms_curvature(e.hard.foot) - q.rms_curvature(e.optima[sand].foot)


MEASURES: dict[str, Callable[[Evidence], float]] = {
    # the five shapes
    "triangle_furthest": lambda e: lead(e.shapes, "distance", "reversed_triangle"),
    "triangle_fastest": lambda e: lead(e.shapes, q.mean_speed, "reversed_triangle"),
    "flat_next": flat_next,
    "circle_highest": lambda e: lead(e.shapes, "mean_height", "circle"),
    "circle_shortest": lambda e: trail(e.shapes, "distance", "circle"),
    "circle_loses": lambda e: (
        float(np.min(switch_losses(e.shapes["circle"], e.readings))) - LIMITS["marked_loss"]
    ),
    "circle_loses_most": lambda e: loses_most(e, e.shapes, "circle"),
    "same_vertical_velocity": lambda e: LIMITS["not_obvious"] - q.vertical_parting(list(e.shapes.values())),
    "circle_most_power": lambda e: lead(e.shapes, "peak_power", "circle"),
    "ellipse_and_flat_least_power": ellipse_and_flat_least_power,
    # the contours
    "hard_hollow": lambda e: -q.convexity(e.hard.foot),
    "hard_bends_in": lambda e: lead(e.optima, lambda walk: q.inward_turn(walk.foot), "hard"),
    "regular_convex": lambda e: q.convexity(e.optima["regular"].foot),
    "soft_convex": lambda e: q.convexity(e.optima["soft"].foot),
    "regular_curves_little": lambda e: curves_little(e, "regular"),
    "soft_curves_little": lambda e: curves_little(e, "soft"),
    # a step on hard sand
    "hollow_spares_plates": lambda e: q.contact_zone(e.filled).middle - q.contact_zone(e.hard).middle,
    "hollow_saves_work": lambda e: e.filled.objectives["work"] - e.hard.objectives["work"],
    "push_off_carries": lambda e: q.push_share(e.hard, LIMITS["push_off"]) - 0.5,
    "regular_foot_larger_zone": lambda e: e.more(lambda walk: q.contact_zone(walk).whole),
    "regular_foot_leads": lambda e: 1e3 * e.more(lambda walk: q.contact_zone(walk).centre),
    "regular_foot_pushes_longer": lambda e: e.more(q.push_time),
    "regular_foot_more_power": lambda e: e.more("peak_power"),
    "regular_foot_more_work": lambda e: e.more("work"),
    # three sands, each with its best foot
    "hard_furthest": lambda e: lead(e.optima, "distance", "hard"),
    "hard_sinks_least": lambda e: trail(e.optima, "maximum_sinkage", "hard"),
    "soft_shortest": lambda e: trail(e.optima, "distance", "soft"),
    "soft_sinks_deepest": lambda e: lead(e.optima, "maximum_sinkage", "soft"),
    "soft_loses_most": lambda e: loses_most(e, e.optima, "soft"),
    "soft_slowest_start": lambda e: lead(
        e.optima, lambda walk: q.time_to_speed(walk, LIMITS["normal_speed"]), "soft"
    ),
    "soft_peak_drag": lambda e: soft_drag(e, q.peak_drag),
    "soft_mean_drag": lambda e: soft_drag(e, q.mean_drag),
    "soft_longest_contact": lambda e: lead(e.optima, q.contact_share, "soft"),
    "soft_most_work": lambda e: lead(e.optima, q.work_after_three_steps, "soft"),
}


class Claim(NamedTuple):
    """One sentence of the paper: its measure, and its words in claims.toml."""

    margin: Callable[[Evidence], float]
    words: dict[str, str]


def _claims() -> dict[str, Claim]:
    words = tomllib.loads(files(__package__).joinpath("claims.toml").read_text(encoding="utf-8"))
    for said in words.values():
        said["decided"] = said["decided"].format(**LIMITS)
    return {name: Claim(MEASURES[name], said) for name, said in words.items()}


CLAIMS = _claims()


def measure(evidence: Evidence) -> dict[str, float]:
    """Return the margins of all claims, by their names."""
    with np.errstate(invalid="ignore"):
        return {name: float(claim.margin(evidence)) for name, claim in CLAIMS.items()}
