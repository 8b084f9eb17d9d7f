"""What the paper says comes out, as data: each claim, how it is decided, and its signed margin.

A margin is positive where the claim holds, in a unit of its own; NaN where a walk that it needs
failed. Where a claim's words name no number ("no obvious difference", "convex"), the limit that
stands in for them is written down in `decided`; none was moved to turn a verdict.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from footopt.foot import Foot, lower_hull
from footopt.gait.gait import RIGHT
from footopt.studies.paper.readings import Readings, read, switch_losses
from footopt.walk import Walk
from footopt.walk.phases import STANDS, Stance, stance

Array = NDArray[np.float64]

SANDS = ("soft", "regular", "hard")
MARKED = 0.1  # m/s, of speed lost at a switch: a tenth of the normal speed
NORMAL = 1.0  # m/s, normal walking speed (the paper: "around 1 m/s")
NOT_OBVIOUS = 0.2  # of a curve's own rms: how far curves may part that a reader sees as one
PUSH_OFF = 0.27  # s after touch-down (the paper)
MIDDLE = 1.0 / 3.0  # of the sole's length is its middle


@dataclass(frozen=True, eq=False)
class Evidence:
    """The walks that claims are measured on.

    shapes : of the five shapes, by name. optima : of the best foot of each sand, on that sand.
    crossed : of the regular sand's best foot on hard sand. filled : of the hard sand's best foot
    with its hollow filled up, on hard sand.
    """

    shapes: Mapping[str, Walk]
    optima: Mapping[str, Walk]
    crossed: Walk
    filled: Walk
    readings: Readings

    def of_shapes(self, name: str) -> dict[str, float]:
        """An objective of the five shapes, as it is read."""
        return {shape: self.value(walk, name) for shape, walk in self.shapes.items()}

    def of_optima(self, name: str) -> dict[str, float]:
        """An objective of each sand's best foot, as it is read."""
        return {sand: self.value(walk, name) for sand, walk in self.optima.items()}

    def value(self, walk: Walk, name: str) -> float:
        """An objective of a walk, as it is read; NaN if the walk failed."""
        return read(walk, self.readings).objectives[name]

    @property
    def hard(self) -> Walk:
        """The hard sand's best foot on hard sand."""
        return self.optima["hard"]

    @cached_property
    def losses(self) -> dict[str, Array]:
        """Speed lost at the three switches by every shape and best foot, each (3,), m/s."""
        walks = {**self.shapes, **self.optima}
        return {name: switch_losses(walk, self.readings) for name, walk in walks.items()}


@dataclass(frozen=True)
class Claim:
    """One sentence of the paper.

    Parameters
    ----------
    name : in tables and files. place : where the paper says or shows it. says : the paper's
        sentence in other words. decided : what the margin is, with any limit. unit : of the margin.
    margin : from the evidence to a number, > 0 where the claim holds.
    """

    name: str
    place: str
    says: str
    decided: str
    unit: str
    margin: Callable[[Evidence], float]

    @property
    def about(self) -> str:
        """Which walks it is about: the five "shapes", or the "optima"."""
        return "shapes" if self.place.startswith("Fig. 4") else "optima"


CLAIMS: dict[str, Claim] = {}


def claim(
    place: str, says: str, decided: str, unit: str
) -> Callable[[Callable[[Evidence], float]], Callable[[Evidence], float]]:
    """Register a function as the margin of the claim of its name."""

    def register(margin: Callable[[Evidence], float]) -> Callable[[Evidence], float]:
        CLAIMS[margin.__name__] = Claim(margin.__name__, place, says, decided, unit, margin)
        return margin

    return register


# --- five shapes ----------------------------------------------------------------------------------


@claim("Fig. 4a", "The triangle walks furthest", "its distance less the others' largest", "m")
def triangle_furthest(e: Evidence) -> float:
    return lead(e.of_shapes("distance"), "reversed_triangle")


@claim(
    "Fig. 4a",
    "The triangle's forward speed is highest",
    "its mean V_x from the first heel strike on, less the others' largest",
    "m/s",
)
def triangle_fastest(e: Evidence) -> float:
    return lead({name: mean_speed(walk) for name, walk in e.shapes.items()}, "reversed_triangle")


@claim(
    "Fig. 4a",
    "The flat foot comes next after the triangle",
    "the rectangle's distance less the largest of ellipse, circle and L",
    "m",
)
def flat_next(e: Evidence) -> float:
    distance = e.of_shapes("distance")
    del distance["reversed_triangle"]
    return lead(distance, "rectangle")


@claim("Fig. 4a", "The circle keeps the COM highest", "its mean height less the others' largest", "m")
def circle_highest(e: Evidence) -> float:
    return lead(e.of_shapes("mean_height"), "circle")


@claim("Fig. 4a", "The circle ends at the shortest distance", "the others' smallest less its own", "m")
def circle_shortest(e: Evidence) -> float:
    return trail(e.of_shapes("distance"), "circle")


@claim(
    "Fig. 4a",
    "The circle loses marked speed at every stance switch",
    f"its smallest loss at t = 1.1, 1.7, 2.3 s less {MARKED:g} m/s",
    "m/s",
)
def circle_loses(e: Evidence) -> float:
    return float(np.min(e.losses["circle"])) - MARKED


@claim(
    "Fig. 4a",
    "... and more than the other shapes",
    "its loss less the others' largest, at the switch where that is least",
    "m/s",
)
def circle_loses_most(e: Evidence) -> float:
    others = [e.losses[name] for name in e.shapes if name != "circle"]
    return float(np.min(e.losses["circle"] - np.max(others, axis=0)))


@claim(
    "Fig. 4a",
    "The five differ in vertical velocity not obviously",
    f"{NOT_OBVIOUS:g} less the shapes' largest rms distance from their mean V_z(t) over its rms",
    "",
)
def same_vertical_velocity(e: Evidence) -> float:
    walks = list(e.shapes.values())
    if not all(walk.feasible for walk in walks):
        return float("nan")
    scene = walks[0].scene
    t = np.linspace(scene.gait.start, scene.duration, 1000)
    curves = np.array([np.interp(t, walk.t, walk.velocity[:, 1]) for walk in walks])
    mean = curves.mean(axis=0)
    parted = np.sqrt(np.mean((curves - mean) ** 2, axis=1))
    return NOT_OBVIOUS - float(parted.max() / np.sqrt(np.mean(mean**2)))


@claim("Fig. 4b", "The circle needs the highest power", "its p_max less the others' largest", "W")
def circle_most_power(e: Evidence) -> float:
    return lead(e.of_shapes("peak_power"), "circle")


@claim(
    "Fig. 4b",
    "Ellipse and rectangle need the least power",
    "the others' smallest p_max less the larger of the two",
    "W",
)
def ellipse_and_flat_least_power(e: Evidence) -> float:
    power = e.of_shapes("peak_power")
    two = [power.pop("ellipse"), power.pop("rectangle")]
    return float(np.min(list(power.values())) - np.max(two))


# --- the contours ---------------------------------------------------------------------------------


@claim("Fig. 6", "The best foot for hard sand is not convex", "its hollow less one level H/K", "mm")
def hard_hollow(e: Evidence) -> float:
    return 1e3 * (e.hard.foot.hollow - level(e.hard.foot))


@claim(
    "Fig. 6",
    "... by its curvature",
    "the angle that the sole turns inwards, less the larger of the other two",
    "deg",
)
def hard_bends_in(e: Evidence) -> float:
    return lead({sand: inward_turn(walk.foot) for sand, walk in e.optima.items()}, "hard")


@claim("Fig. 6", "The best foot for regular sand is convex", "one level H/K less its hollow", "mm")
def regular_convex(e: Evidence) -> float:
    foot = e.optima["regular"].foot
    return 1e3 * (level(foot) - foot.hollow)


@claim("Fig. 6", "The best foot for soft sand is convex", "one level H/K less its hollow", "mm")
def soft_convex(e: Evidence) -> float:
    foot = e.optima["soft"].foot
    return 1e3 * (level(foot) - foot.hollow)


@claim(
    "Fig. 6",
    "The best foot for regular sand curves little",
    "the hard sand's rms curvature less its own",
    "1/m",
)
def regular_curves_little(e: Evidence) -> float:
    return rms_curvature(e.hard.foot) - rms_curvature(e.optima["regular"].foot)


@claim(
    "Fig. 6",
    "The best foot for soft sand curves little",
    "the hard sand's rms curvature less its own",
    "1/m",
)
def soft_curves_little(e: Evidence) -> float:
    return rms_curvature(e.hard.foot) - rms_curvature(e.optima["soft"].foot)


# --- a step on hard sand --------------------------------------------------------------------------


@claim(
    "Fig. 7",
    "The hollow spares plates in the middle of the foot",
    "share of the middle third in the sand, mean over the step: with the hollow filled, less as it is",
    "",
)
def hollow_spares_plates(e: Evidence) -> float:
    return contact_zone(e.filled).middle - contact_zone(e.hard).middle


@claim("Fig. 7", "... and so saves work", "|W| with the hollow filled, less as it is", "J")
def hollow_saves_work(e: Evidence) -> float:
    return e.value(e.filled, "work") - e.value(e.hard, "work")


@claim(
    "Fig. 7",
    "The force that moves the body forwards comes at push-off",
    f"share of the step's forward impulse after {PUSH_OFF:g} s from touch-down, less one half",
    "",
)
def push_off_carries(e: Evidence) -> float:
    step = one_step(e.hard)
    if step is None:
        return float("nan")
    forward = step.lasts * np.maximum(step.force[:, 0], 0.0)
    return float(forward[step.t >= PUSH_OFF].sum() / forward.sum()) - 0.5


@claim(
    "Fig. 7",
    "The regular sand's foot puts more of its sole into hard sand",
    "share of the sole in the sand, mean over the step, less the hard sand's foot's",
    "",
)
def regular_foot_larger_zone(e: Evidence) -> float:
    return contact_zone(e.crossed).whole - contact_zone(e.hard).whole


@claim(
    "Fig. 7",
    "... and further to the front",
    "x_p of its vertical force, mean over the step, less the hard sand's foot's",
    "mm",
)
def regular_foot_leads(e: Evidence) -> float:
    return 1e3 * (contact_zone(e.crossed).centre - contact_zone(e.hard).centre)


@claim(
    "Fig. 7",
    "It pushes off for longer",
    "time of the step with a forward force, less the hard sand's foot's",
    "s",
)
def regular_foot_pushes_longer(e: Evidence) -> float:
    return push_time(e.crossed) - push_time(e.hard)


@claim("Fig. 7", "... with larger power", "its p_max less the hard sand's foot's", "W")
def regular_foot_more_power(e: Evidence) -> float:
    return e.value(e.crossed, "peak_power") - e.value(e.hard, "peak_power")


@claim("Fig. 7", "... and larger work", "its |W| less the hard sand's foot's", "J")
def regular_foot_more_work(e: Evidence) -> float:
    return e.value(e.crossed, "work") - e.value(e.hard, "work")


# --- three sands ----------------------------------------------------------------------------------


@claim("Fig. 8a", "On hard sand one walks furthest", "distance less the others' largest", "m")
def hard_furthest(e: Evidence) -> float:
    return lead(e.of_optima("distance"), "hard")


@claim("Fig. 8a", "On hard sand one sinks least", "the others' smallest depth of the sole less its own", "m")
def hard_sinks_least(e: Evidence) -> float:
    return trail(e.of_optima("maximum_sinkage"), "hard")


@claim("Fig. 8a", "On soft sand one walks shortest", "the others' smallest distance less its own", "m")
def soft_shortest(e: Evidence) -> float:
    return trail(e.of_optima("distance"), "soft")


@claim("Fig. 8a", "On soft sand one sinks deepest", "depth of the sole less the others' largest", "m")
def soft_sinks_deepest(e: Evidence) -> float:
    return lead(e.of_optima("maximum_sinkage"), "soft")


@claim(
    "Fig. 8a",
    "On soft sand most speed is lost at t = 1.1, 1.7, 2.3 s",
    "loss less the others' largest, at the switch where that is least",
    "m/s",
)
def soft_loses_most(e: Evidence) -> float:
    others = np.max([e.losses["regular"], e.losses["hard"]], axis=0)
    return float(np.min(e.losses["soft"] - others))


@claim(
    "Fig. 8a",
    "On soft sand it takes longest to reach the normal speed",
    f"time until V_x is {NORMAL:g} m/s (t_f if never), less the others' longest",
    "s",
)
def soft_slowest_start(e: Evidence) -> float:
    return lead({sand: time_to_speed(walk) for sand, walk in e.optima.items()}, "soft")


@claim(
    "Fig. 8b",
    "On soft sand the drag is larger, fore and aft",
    "peak of one foot's f_x less the others' largest, in the direction where that is least",
    "N",
)
def soft_peak_drag(e: Evidence) -> float:
    return min(
        lead({sand: peak_drag(walk, way) for sand, walk in e.optima.items()}, "soft") for way in (1, -1)
    )


@claim(
    "Fig. 8b",
    "... on average over time",
    "mean of the forward and of the backward part of f_x likewise",
    "N",
)
def soft_mean_drag(e: Evidence) -> float:
    return min(
        lead({sand: mean_drag(walk, way) for sand, walk in e.optima.items()}, "soft") for way in (1, -1)
    )


@claim(
    "Fig. 8b",
    "On soft sand a foot is in contact for longer",
    f"share of the time with f_z > {STANDS:g} N from the first heel strike on, less the others' largest",
    "",
)
def soft_longest_contact(e: Evidence) -> float:
    return lead({sand: contact_share(walk) for sand, walk in e.optima.items()}, "soft")


@claim("Fig. 8c", "After three steps the work is largest on soft sand", "|W| less the others' largest", "J")
def soft_most_work(e: Evidence) -> float:
    return lead({sand: work_after_three_steps(walk) for sand, walk in e.optima.items()}, "soft")


# --- measures -------------------------------------------------------------------------------------


def lead(values: Mapping[str, float], name: str) -> float:
    """How far one value is above all others; NaN if any is."""
    return float(values[name] - np.max([v for other, v in values.items() if other != name]))


def trail(values: Mapping[str, float], name: str) -> float:
    """How far one value is below all others; NaN if any is."""
    return lead({other: -v for other, v in values.items()}, name)


def mean_since_heel_strike(walk: Walk, values: Array) -> float:
    """Mean over time of a trace, (T,), from the first heel strike on; NaN if the walk failed."""
    if not walk.feasible:
        return float("nan")
    after = walk.t >= walk.scene.gait.heel_strike
    t = walk.t[after]
    return float(np.trapezoid(values[after], t) / (t[-1] - t[0]))


def mean_speed(walk: Walk) -> float:
    """Mean V_x from the first heel strike on, m/s."""
    return mean_since_heel_strike(walk, walk.velocity[:, 0])


def time_to_speed(walk: Walk) -> float:
    """Time at which V_x first reaches the normal speed, s; t_f if it never does."""
    if not walk.feasible:
        return float("nan")
    fast = np.flatnonzero(walk.velocity[:, 0] >= NORMAL)
    return float(walk.t[fast[0]]) if len(fast) else walk.scene.duration


def peak_drag(walk: Walk, way: int) -> float:
    """Largest f_x of one foot, forwards (1) or backwards (-1), from the first heel strike on, N."""
    if not walk.feasible:
        return float("nan")
    after = walk.t >= walk.scene.gait.heel_strike
    return float((way * walk.force[after, :, 0]).max())


def mean_drag(walk: Walk, way: int) -> float:
    """Mean over time of the forward (1) or backward (-1) part of both feet's f_x, N."""
    return mean_since_heel_strike(walk, np.maximum(way * walk.force[..., 0], 0.0).sum(axis=1))


def contact_share(walk: Walk) -> float:
    """Share of the time that a foot carries something, mean of both feet."""
    return mean_since_heel_strike(walk, (walk.force[..., 1] > STANDS).mean(axis=1))


def work_after_three_steps(walk: Walk) -> float:
    """|W| of both feet half a stride after the third heel strike, or at t_f if that is sooner, J."""
    if not walk.feasible:
        return float("nan")
    end = walk.scene.gait.heel_strike + 1.5 * walk.scene.gait.period
    return abs(float(np.interp(end, walk.t, walk.work.sum(axis=1))))


@dataclass(frozen=True)
class Step:
    """The right foot's first step.

    t : (M,), since touch-down, s. lasts : (M,), how long the step of time before each sample was, s:
    they are not equally long. force : (M, 2), on the foot, N.
    """

    t: Array
    lasts: Array
    force: Array
    samples: Stance


def one_step(walk: Walk) -> Step | None:
    """The right foot's first step, None if there is none."""
    samples = stance(walk) if walk.feasible else None
    if samples is None:
        return None
    part = slice(samples.first, samples.last + 1)
    t, lasts = walk.t[part] - walk.t[samples.first], np.diff(walk.t, prepend=0.0)[part]
    return Step(t, lasts, walk.force[part, RIGHT], samples)


def push_time(walk: Walk) -> float:
    """How long the sand pushes forwards on the right foot in its first step, s."""
    step = one_step(walk)
    if step is None:
        return float("nan")
    return float(step.lasts[step.force[:, 0] > 0.0].sum())


@dataclass(frozen=True)
class Zone:
    """What of a sole is in the sand, mean over a step.

    whole, middle : shares of the plates, and of those in the middle third. centre : x_p where the
    vertical force acts, m.
    """

    whole: float = float("nan")
    middle: float = float("nan")
    centre: float = float("nan")


def contact_zone(walk: Walk, instants: int = 100) -> Zone:
    """The zone of the right foot's first step, from so many instants of it."""
    step = one_step(walk)
    if step is None:
        return Zone()
    index = step.samples.first + np.searchsorted(step.t, np.linspace(0.0, step.t[-1], instants))
    states = walk.plates(index)
    x = walk.foot.plates(walk.accuracy.plates, walk.accuracy.rule).x[0] + walk.foot.ankle[0]
    contour = walk.foot.contour[:, 0]
    half = 0.5 * MIDDLE * (contour.max() - contour.min())
    middle = np.abs(x - 0.5 * (contour.max() + contour.min())) <= half
    inside = states.position[:, RIGHT, :, 1] < 0.0
    up = states.force[:, RIGHT, :, 1]
    return Zone(float(inside.mean()), float(inside[:, middle].mean()), float((up @ x).sum() / up.sum()))


def filled(foot: Foot) -> Foot:
    """The foot with its hollow filled up: its lower convex hull."""
    return replace(foot, contour=lower_hull(foot.contour)[0], name="filled", k=None, space=None)


def level(foot: Foot) -> float:
    """One level of the waypoints, H/K, m: what a hollow must exceed to be more than the grid's own."""
    return float("nan") if foot.space is None else foot.space.H / foot.space.K


def bends(foot: Foot) -> tuple[Array, Array]:
    """Turn of the sole between neighbours of 400 chords, (399,), rad, + convex; and their length, m."""
    chord = np.diff(foot.points(400), axis=0)
    return np.diff(np.unwrap(np.arctan2(chord[:, 1], chord[:, 0]))), np.hypot(*chord.T)[1:]


def inward_turn(foot: Foot) -> float:
    """Angle that the sole turns the wrong way for a convex one, deg."""
    return float(np.degrees(np.maximum(-bends(foot)[0], 0.0).sum()))


def rms_curvature(foot: Foot) -> float:
    """Root mean square of the curvature along the arc, 1/m."""
    turn, length = bends(foot)
    return float(np.sqrt(np.mean((turn / length) ** 2)))
