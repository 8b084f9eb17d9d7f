"""Numbers taken from a finished walk or from a sole, by which the claims are measured."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.foot import Foot, lower_hull
from footopt.gait.gait import RIGHT
from footopt.walk import Walk
from footopt.walk.phases import STANDS, stance

Array = NDArray[np.float64]
NAN = float("nan")


def walking(walk: Walk) -> NDArray[np.bool_]:
    """Return the samples from the first heel strike on, (T,)."""
    return np.asarray(walk.t >= walk.scene.gait.heel_strike)


def mean(walk: Walk, trace: Array) -> float:
    """Return the mean over time of a trace, (T,), from the first heel strike on."""
    t = walk.t[walking(walk)]
    return float(np.trapezoid(trace[walking(walk)], t) / (t[-1] - t[0]))


def mean_speed(walk: Walk) -> float:
    """Return the mean V_x, m/s."""
    return mean(walk, walk.velocity[:, 0])


def mean_drag(walk: Walk, way: int) -> float:
    """Return the mean over time of the forward (1) or backward (-1) part of both feet's f_x, N."""
    return mean(walk, np.maximum(way * walk.force[..., 0], 0.0).sum(axis=1))


def peak_drag(walk: Walk, way: int) -> float:
    """Return the largest f_x of one foot, forwards (1) or backwards (-1), N."""
    return float((way * walk.force[walking(walk), :, 0]).max())


def contact_share(walk: Walk) -> float:
    """Return the share of the time that a foot is in contact, mean of both feet."""
    return mean(walk, (walk.force[..., 1] > STANDS).mean(axis=1))


def time_to_speed(walk: Walk, speed: float) -> float:
    """Return the time at which V_x first reaches a speed (m/s), s; t_f if it never does."""
    fast = np.flatnonzero(walk.velocity[:, 0] >= speed)
    return float(walk.t[fast[0]]) if len(fast) else walk.scene.duration


def work_after_three_steps(walk: Walk) -> float:
    """Return |W| of both feet half a stride after the third heel strike, or at t_f if that is sooner, J."""
    end = walk.scene.gait.heel_strike + 1.5 * walk.scene.gait.period
    return abs(float(np.interp(end, walk.t, walk.work.sum(axis=1))))


def vertical_parting(walks: list[Walk]) -> float:
    """Return the largest rms distance of a walk's V_z(t) from the walks' mean, over the rms of the mean."""
    if not all(walk.feasible for walk in walks):
        return NAN
    scene = walks[0].scene
    t = np.linspace(scene.gait.start, scene.duration, 1000)
    curves = np.array([np.interp(t, walk.t, walk.velocity[:, 1]) for walk in walks])
    middle = curves.mean(axis=0)
    parted = np.sqrt(np.mean((curves - middle) ** 2, axis=1))
    return float(parted.max() / np.sqrt(np.mean(middle**2)))


def first_step(walk: Walk) -> slice | None:
    """Return the samples of the right foot's first step, None if there is none."""
    found = stance(walk) if walk.feasible else None
    return slice(found.first, found.last + 1) if found else None


def _forward(walk: Walk, step: slice) -> tuple[Array, Array]:
    """Return the forward force of the right foot in a step, and how long each sample of it lasts."""
    return np.maximum(walk.force[step, RIGHT, 0], 0.0), np.diff(walk.t, prepend=0.0)[step]


def push_time(walk: Walk) -> float:
    """Return how long the sand pushes the right foot forwards in its first step, s."""
    step = first_step(walk)
    if step is None:
        return NAN
    force, lasts = _forward(walk, step)
    return float(lasts[force > 0.0].sum())


def push_share(walk: Walk, begin: float) -> float:
    """Return the share of the step's forward impulse that comes later than `begin` (s) after touch-down."""
    step = first_step(walk)
    if step is None:
        return NAN
    impulse, t = np.multiply(*_forward(walk, step)), walk.t[step]
    return float(impulse[t - t[0] >= begin].sum() / impulse.sum())


class Zone(NamedTuple):
    """What of a sole is in the sand, mean over a step."""

    whole: float = NAN  # share of the plates
    middle: float = NAN  # share of the plates of the sole's middle third
    centre: float = NAN  # x_p where the vertical force acts, m


def contact_zone(walk: Walk, instants: int = 100) -> Zone:
    """Return the zone of the right foot's first step, from so many instants of it."""
    step = first_step(walk)
    if step is None:
        return Zone()
    t = walk.t[step] - walk.t[step.start]
    states = walk.plates(step.start + np.searchsorted(t, np.linspace(0.0, t[-1], instants)))
    x = walk.foot.plates(walk.accuracy.plates, walk.accuracy.rule).x[0] + walk.foot.ankle[0]
    heel, toe = walk.foot.contour[:, 0].min(), walk.foot.contour[:, 0].max()
    middle = np.abs(x - 0.5 * (toe + heel)) <= (toe - heel) / 6.0
    inside = states.position[:, RIGHT, :, 1] < 0.0
    up = states.force[:, RIGHT, :, 1]
    return Zone(float(inside.mean()), float(inside[:, middle].mean()), float((up @ x).sum() / up.sum()))


def filled(foot: Foot) -> Foot:
    """Return the foot with its hollow filled up: its lower convex hull."""
    return replace(foot, contour=lower_hull(foot.contour)[0], name="filled", k=None, space=None)


def convexity(foot: Foot) -> float:
    """Return one level of the waypoints, H/K, less the hollow, mm: a smaller hollow may be the grid's own."""
    return NAN if foot.space is None else 1e3 * (foot.space.H / foot.space.K - foot.hollow)


def _bends(foot: Foot) -> tuple[Array, Array]:
    """Turn of the sole between neighbours of 400 chords, (399,), rad, + convex; and their length, m."""
    chord = np.diff(foot.points(400), axis=0)
    return np.diff(np.unwrap(np.arctan2(chord[:, 1], chord[:, 0]))), np.hypot(*chord.T)[1:]


def inward_turn(foot: Foot) -> float:
    """Return the angle that the sole turns the wrong way for a convex one, deg."""
    return float(np.degrees(np.maximum(-_bends(foot)[0], 0.0).sum()))


def rms_curvature(foot: Foot) -> float:
    """Return the root mean square of the curvature along the arc, 1/m."""
    turn, length = _bends(foot)
    return float(np.sqrt(np.mean((turn / length) ** 2)))
