"""The figure of one step: the sole in the sand from touch-down to push-off, with the forces along it."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from footopt.report import style
from footopt.report.stage import ARROWS, Stage, draw_ground, draw_key
from footopt.walk import Walk
from footopt.walk.results import stance, step_on_patch

ROWS, COLUMNS = 2, 3  # of snapshots
LONGEST = 0.07  # arrow, m
MARGIN = 0.02  # around the soles and below the arrows, m


@style.styled()
def step(walk: Walk) -> Figure:
    """The right foot's first step, or the first one on a patch of other sand: the sole and its forces.

    Snapshots are at equal intervals of time. Each arrow is the force on one of `stage.ARROWS` parts of the
    sole and ends there. The walk needs a `footopt.walk.results.stance`.
    """
    contact = stance(walk, step_on_patch(walk))
    assert contact is not None
    foot, begin, end = contact.foot, walk.t[contact.first], walk.t[contact.last]
    times = np.linspace(begin, end, 2 * ROWS * COLUMNS + 1)[1::2]  # at its ends a contact carries no force
    stage = Stage(walk, walk.t[np.searchsorted(walk.t, times)])
    largest = float(np.linalg.norm(stage.force[:, foot], axis=-1).max())
    sole = stage.outline[:, foot].reshape(-1, 2)
    (left, low), (right, high) = sole.min(axis=0), sole.max(axis=0)
    figure = style.new_figure(style.PAGE, 6.0)
    figure.set_layout_engine("constrained", hspace=0.0)
    grid = figure.subplots(ROWS, COLUMNS, sharex=True, sharey=True)
    for i, axes in enumerate(grid.flat):
        axes.set(xlim=(left - MARGIN, right + MARGIN), aspect="equal")
        axes.set(ylim=(low - LONGEST - MARGIN, max(high, 0.0) + 2 * MARGIN))
        draw_ground(axes, stage.ground, words=axes is grid[0, -1])
        arrows = stage.draw_feet(axes, i, largest / LONGEST, foot, close=True)
        if i == 0:
            draw_key(axes, arrows, 0.8 * largest)
        axes.text(0.02, 0.98, f"{stage.t[i] - begin:.2f} s", va="top", transform=axes.transAxes)
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.yaxis.set_major_locator(MaxNLocator(4))
    since = f"{'heel strike' if contact.dragged else 'touch-down'} at t = {begin:.2f} s"
    title = f"{style.walk_label(f'{walk.sides[foot]} foot', walk)}, time since {since}"
    grid[0, COLUMNS // 2].set_title(f"{title}; arrows: force on 1/{ARROWS} of the sole")
    figure.supxlabel("$x$ (m)")
    figure.supylabel("$z$ (m)")
    style.fit_height(figure, grid[:, 0].tolist())
    return figure
