"""The figure of one step: the sole in the sand from touch-down to push-off, with the forces along it."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from footopt.errors import check
from footopt.report.figures.traces import walk_label
from footopt.report.stage import SHORTEST, Stage, View, round_down
from footopt.report.style import PAGE, SIDES, message, new_figure, styled
from footopt.walk import Walk
from footopt.walk.phases import stance, step_on_patch

Array = NDArray[np.float64]

COLUMNS = 3  # snapshots side by side
LONGEST = 0.1  # arrow, m
ABOVE = 0.05  # what is shown of the shank above the highest sole, m


def step(walk: Walk, frames: int = 6) -> Figure:
    """The right foot's first step, or the first one on a patch of other sand; see `steps`."""
    number = step_on_patch(walk)
    return steps({f"{SIDES[1 - number % 2][0]} foot": walk}, frames, number)


@styled
def steps(walks: Mapping[str, Walk], frames: int = 6, number: int = 0) -> Figure:
    """A step, the right foot's first one, in walks by label: the sole in the sand and its forces.

    Snapshots at equal intervals, those of a walk all in the same place, and all in the same scale.
    Each arrow is the force on one of `body.ARROWS` parts of the sole and ends there; titles are times
    since touch-down (see `footopt.walk.phases.stance`).

    Raises
    ------
    SettingError
        There are no frames.
    """
    check(frames >= 1, "frames", frames, "a whole number >= 1")
    found = [step for label, walk in walks.items() if (step := _snapshots(label, walk, frames, number))]
    if not found:
        return _no_step(next(iter(walks.values())))
    metres = LONGEST / max(float(np.linalg.norm(step.force, axis=-1).max()) for step in found)  # per newton
    points = [step.points(metres) for step in found]
    span = max(float(np.ptp(p[:, 0])) for p in points) + 0.02
    low = min(float(p[:, 1].min()) for p in points) - 0.02
    sloped = any(step.stage.ground["gravity"] for step in found)
    high = max(float(p[:, 1].max()) for p in points) + (2.0 if sloped else 1.0) * ABOVE
    columns = min(frames, COLUMNS)
    rows = -(-frames // columns)
    width = (PAGE - 0.55) / COLUMNS - 0.08
    height = min(rows * (width * (high - low) / span + 0.35) + 0.7, 8.5 / len(found))
    inch = max(span / width, (high - low) / ((height - 0.7) / rows - 0.35))  # m
    figure = new_figure(PAGE, height * len(found))
    parts = np.ravel(figure.subfigures(len(found), 1, squeeze=False))
    for part, step, p in zip(parts, found, points, strict=True):
        left = 0.5 * float(p[:, 0].min() + p[:, 0].max() - span)
        panels = part.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for axes in panels[frames:]:
            axes.set_axis_off()
        for j, axes in enumerate(panels[:frames]):
            first = j == 0 and step is found[0]  # which has all words
            newtons = round_down(0.8 * LONGEST / metres) if first else 0.0
            view = View(left, left + span, low, high, inch / 72 * 4.5, metres, newtons, close=True)
            step.stage.draw_ground(axes, view, words=first)
            step.stage.draw_feet(axes, j, view, [step.foot])
            axes.set(xlim=view[:2], ylim=view[2:4], aspect="equal")
            axes.set_title(f"{step.since[j]:.2f} s", loc="left")
            axes.xaxis.set_major_locator(MaxNLocator(3))
            axes.yaxis.set_major_locator(MaxNLocator(4))
        part.supxlabel("$x$ (m)")
        part.supylabel("$z$ (m)")
        least = SHORTEST * view.unit / metres
        part.suptitle(textwrap.fill(f"{step.title}, from {least:.2g} N on", 125))
    return figure


class _Step(NamedTuple):
    """A foot at M instants of a walk: s since the step began."""

    stage: Stage
    foot: int
    since: Array  # (M,)
    title: str

    @property
    def force(self) -> Array:
        """On parts of its sole, (M, arrows, 2), N."""
        return self.stage.forces.force[:, self.foot]

    def points(self, metres: float) -> Array:
        """The ends of soles and arrows, (m, 2), with arrows of so many metres per newton."""
        tails = self.stage.forces.at[:, self.foot] - metres * self.force
        outline = self.stage.body.outline[:, self.foot]
        return np.concatenate([part.reshape(-1, 2) for part in (outline, tails)])


def _snapshots(label: str, walk: Walk, frames: int, number: int) -> _Step | None:
    """Snapshots of a step; None if the foot never stood."""
    contact = stance(walk, number)
    if contact is None:
        return None
    begin, end = walk.t[contact.first], walk.t[contact.last]
    share = (np.arange(frames) + 0.5) / frames  # at its very ends a contact carries no force
    index = np.searchsorted(walk.t, begin + share * (end - begin))  # steps of time are not equally long
    stage = Stage(walk, walk.t[index])
    began = f"t = {begin:.2f} s"
    since = f"heel strike ({began}; dragged through the sand until then)"
    since = since if contact.dragged else f"touch-down ({began})"
    parts = stage.forces.at.shape[2]
    title = f"{walk_label(label, walk)}, time since {since}; arrows: force on 1/{parts} of the sole"
    return _Step(stage, contact.foot, walk.t[index] - begin, title)


def _no_step(walk: Walk) -> Figure:
    """A figure that says why there is no step in it."""
    figure = new_figure(PAGE, 1.6)
    axes = figure.subplots()
    axes.set_axis_off()
    why = f"the walk failed: {walk.reason}" if walk.reason else "its foot never touched the sand"
    message(axes, f"no step of the right foot to show: {why}")
    return figure
