"""The figure of one step: the sole in the sand from touch-down to push-off, with the forces along it."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from footopt.report import style
from footopt.report.stage import Stage, draw_ground, draw_key
from footopt.walk import Walk
from footopt.walk.phases import stance, step_on_patch

Array = NDArray[np.float64]

ROWS, COLUMNS = 2, 3  # of snapshots
LONGEST = 0.07  # arrow, m
ABOVE = 0.05  # what is shown of the shank above the highest sole, m


def step(walk: Walk) -> Figure:
    """The right foot's first step, or the first one on a patch of other sand; see `steps`."""
    number = step_on_patch(walk)
    return steps({f"{style.SIDES[1 - number % 2][0]} foot": walk}, number)


@style.styled()
def steps(walks: Mapping[str, Walk], number: int = 0) -> Figure:
    """A step, the right foot's first one, in walks by label: the sole in the sand and its forces.

    Snapshots are at equal intervals of time and in one scale, and those of a walk in one place. Each arrow is
    the force on one of `stage.ARROWS` parts of the sole and ends there. A walk needs a
    `footopt.walk.phases.stance` in that step.
    """
    found = [_snapshots(label, walk, number) for label, walk in walks.items()]
    largest = max(float(np.linalg.norm(step.force, axis=-1).max()) for step in found)
    points = [step.points(LONGEST / largest) for step in found]
    span = max(float(np.ptp(p[:, 0])) for p in points) + 0.02
    low = min(float(p[:, 1].min()) for p in points) - 0.02
    sloped = any(step.stage.ground["gravity"] for step in found)
    high = max(float(p[:, 1].max()) for p in points) + (2.0 if sloped else 1.0) * ABOVE
    figure = style.new_figure(style.PAGE, 6.0 * len(found))
    figure.set_layout_engine("constrained", hspace=0.0)
    grid = figure.subplots(ROWS * len(found), COLUMNS, sharey=True, squeeze=False)
    for rows, step, p in zip(np.split(grid, len(found)), found, points, strict=True):
        middle = 0.5 * float(p[:, 0].min() + p[:, 0].max())
        for j, axes in enumerate(rows.flat):
            axes.set(xlim=(middle - 0.5 * span, middle + 0.5 * span), ylim=(low, high), aspect="equal")
            draw_ground(axes, step.stage.ground, words=axes is grid[0, 0])
            arrows = step.stage.draw_feet(axes, j, largest / LONGEST, [step.foot], close=True)
            if axes is grid[0, 0]:
                draw_key(axes, arrows, 0.8 * largest)
            axes.text(0.02, 0.98, f"{step.since[j]:.2f} s", va="top", transform=axes.transAxes)
            axes.xaxis.set_major_locator(MaxNLocator(3))
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.tick_params(labelbottom=axes in rows[-1])
        rows[0, COLUMNS // 2].set_title(textwrap.fill(step.title, 125))
    figure.supxlabel("$x$ (m)")
    figure.supylabel("$z$ (m)")
    style.fit_height(figure, grid[:, 0].tolist())
    return figure


class _Step(NamedTuple):
    """A foot at M instants of a walk: s since the step began."""

    stage: Stage
    foot: int
    since: Array  # (M,)
    title: str

    @property
    def force(self) -> Array:
        """On parts of its sole, (M, parts, 2), N."""
        return self.stage.forces.force[:, self.foot]

    def points(self, metres: float) -> Array:
        """The ends of soles and arrows, (m, 2), with arrows of so many metres per newton."""
        tails = self.stage.forces.at[:, self.foot] - metres * self.force
        outline = self.stage.body.outline[:, self.foot]
        return np.concatenate([part.reshape(-1, 2) for part in (outline, tails)])


def _snapshots(label: str, walk: Walk, number: int) -> _Step:
    """Snapshots of a step."""
    contact = stance(walk, number)
    assert contact is not None
    begin, end = walk.t[contact.first], walk.t[contact.last]
    share = (np.arange(ROWS * COLUMNS) + 0.5) / (
        ROWS * COLUMNS
    )  # at its very ends a contact carries no force
    index = np.searchsorted(walk.t, begin + share * (end - begin))  # steps of time are not equally long
    stage = Stage(walk, walk.t[index])
    began = f"t = {begin:.2f} s"
    since = f"heel strike ({began}; dragged through the sand until then)"
    since = since if contact.dragged else f"touch-down ({began})"
    parts = stage.forces.at.shape[2]
    title = f"{style.walk_label(label, walk)}, time since {since}; arrows: force on 1/{parts} of the sole"
    return _Step(stage, contact.foot, walk.t[index] - begin, title)
