"""The figure of one step: the sole in the sand from touch-down to push-off, with the forces along it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from footopt.report import style
from footopt.report.stage import ARROWS, Stage, draw_ground, draw_key
from footopt.walk import Walk
from footopt.walk.phases import Stance, stance, step_on_patch

ROWS, COLUMNS = 2, 3  # of snapshots
LONGEST = 0.07  # arrow, m
MARGIN = 0.02  # around the soles and below the arrows, m


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
    found = [stance(walk, number) for walk in walks.values()]
    contacts = [contact for contact in found if contact]
    stages = [_snapshots(walk, contact) for walk, contact in zip(walks.values(), contacts, strict=True)]
    foot = contacts[0].foot
    largest = max(float(np.linalg.norm(s.forces.force[:, foot], axis=-1).max()) for s in stages)
    soles = [stage.body.outline[:, foot].reshape(-1, 2) for stage in stages]
    span = max(float(np.ptp(sole[:, 0])) for sole in soles) + 2 * MARGIN
    low = min(float(sole[:, 1].min()) for sole in soles) - LONGEST - MARGIN
    high = max(float(sole[:, 1].max()) for sole in soles) + 2 * MARGIN
    figure = style.new_figure(style.PAGE, 6.0 * len(walks))
    figure.set_layout_engine("constrained", hspace=0.0)
    grid = figure.subplots(ROWS * len(walks), COLUMNS, sharey=True, squeeze=False)
    parts = zip(np.split(grid, len(walks)), stages, soles, contacts, walks.items(), strict=True)
    for rows, stage, sole, contact, (label, walk) in parts:
        left, begin = 0.5 * float(sole[:, 0].min() + sole[:, 0].max() - span), walk.t[contact.first]
        for i, axes in enumerate(rows.flat):
            axes.set(xlim=(left, left + span), ylim=(low, high), aspect="equal")
            draw_ground(axes, stage.ground, words=axes is grid[0, -1])
            arrows = stage.draw_feet(axes, i, largest / LONGEST, [foot], close=True)
            if axes is grid[0, 0]:
                draw_key(axes, arrows, 0.8 * largest)
            axes.text(0.02, 0.98, f"{stage.t[i] - begin:.2f} s", va="top", transform=axes.transAxes)
            axes.xaxis.set_major_locator(MaxNLocator(3))
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.tick_params(labelbottom=axes in rows[-1])
        since = f"{'heel strike' if contact.dragged else 'touch-down'} at t = {begin:.2f} s"
        title = f"{style.walk_label(label, walk)}, time since {since}"
        rows[0, COLUMNS // 2].set_title(f"{title}; arrows: force on 1/{ARROWS} of the sole")
    figure.supxlabel("$x$ (m)")
    figure.supylabel("$z$ (m)")
    style.fit_height(figure, grid[:, 0].tolist())
    return figure


def _snapshots(walk: Walk, contact: Stance) -> Stage:
    """A walk at equal intervals of a contact, without its very ends, where it carries no force."""
    begin, end = walk.t[contact.first], walk.t[contact.last]
    times = np.linspace(begin, end, 2 * ROWS * COLUMNS + 1)[1::2]
    return Stage(walk, walk.t[np.searchsorted(walk.t, times)])
