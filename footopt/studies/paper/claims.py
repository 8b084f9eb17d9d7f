"""What the paper says comes out, and how it is measured: a signed margin, positive where a claim holds.

claims.toml has the words of each claim: what its measure computes, and in which unit. A margin is NaN where a
walk that it needs failed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.studies.paper import quantities as q
from footopt.studies.paper.readings import Readings, read, switch_losses
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


@dataclass(frozen=True, eq=False)
class Evidence:
    """The walks that claims are measured on.

    Parameters
    ----------
    shapes : dict of Walk
        Walks of the five shapes, by name.
    optima : dict of Walk
        Walks of the best foot of each sand on that sand, by sand.
    crossed : Walk
        The best foot for regular sand, on hard sand.
    filled : Walk
        The best foot for hard sand with its hollow filled up, on hard sand.
    readings : Readings
        How p_max and dV_x are read.
    """

    shapes: Mapping[str, Walk]
    optima: Mapping[str, Walk]
    crossed: Walk
    filled: Walk
    readings: Readings

    @property
    def hard(self) -> Walk:
        """The walk of the best foot for hard sand on hard sand."""
        return self.optima["hard"]

    def value(self, walk: Walk, name: str) -> float:
        """Return an objective of a walk, as it is read; NaN if the walk failed."""
        return read(walk, self.readings).objectives[name]

    def of_shapes(self, what: str | Callable[[Walk], float]) -> dict[str, float]:
        """Return an objective, as it is read, or another number of the five shapes' walks."""
        return self._numbers(self.shapes, what)

    def of_optima(self, what: str | Callable[[Walk], float]) -> dict[str, float]:
        """Return an objective, as it is read, or another number of the best feet's walks."""
        return self._numbers(self.optima, what)

    def _numbers(self, walks: Mapping[str, Walk], what: str | Callable[[Walk], float]) -> dict[str, float]:
        return {
            name: self.value(walk, what) if isinstance(what, str) else what(walk)
            for name, walk in walks.items()
        }

    @cached_property
    def losses(self) -> dict[str, NDArray[np.float64]]:
        """Speed lost at the three switches by every shape and best foot, each (3,), m/s."""
        walks = {**self.shapes, **self.optima}
        return {name: switch_losses(walk, self.readings) for name, walk in walks.items()}


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


class Claim(NamedTuple):
    """One sentence of the paper.

    Parameters
    ----------
    margin : callable
        From the evidence to a number, > 0 where the claim holds.
    place, says, decided, unit : str
        Where the paper says or shows it, its sentence in other words, what the margin is, and its unit.
    """

    margin: Callable[[Evidence], float]
    place: str
    says: str
    decided: str
    unit: str

    @property
    def about(self) -> str:
        """Which walks it is about: the five "shapes", or the "optima"."""
        return "shapes" if self.place.startswith("Fig. 4") else "optima"


def _claims() -> dict[str, Claim]:
    words = tomllib.loads(files(__package__).joinpath("claims.toml").read_text(encoding="utf-8"))
    for said in words.values():
        said["decided"] = said["decided"].format(**LIMITS)
    return {name: Claim(MEASURES[name], **said) for name, said in words.items()}


CLAIMS = _claims()


def measure(evidence: Evidence) -> NDArray[np.float64]:
    """Return the margins of all claims, (claims,)."""
    with np.errstate(invalid="ignore"):
        return np.array([claim.margin(evidence) for claim in CLAIMS.values()])
