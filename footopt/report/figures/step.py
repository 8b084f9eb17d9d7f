"""The figure of one step: the sole in the sand from touch-down to push-off, with the forces along it."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from footopt.errors import check
from footopt.gait.gait import RIGHT
from footopt.report.body import body, forces_along
from footopt.report.figures.ground import draw_sand
from footopt.report.figures.traces import walk_label
from footopt.report.figures.walker import draw_arrows, round_down
from footopt.report.style import BLUE, GREY, PAGE, PALE, VERMILLION, Axes, message, new_figure, styled
from footopt.walk import Walk
from footopt.walk.phases import stance

Array = NDArray[np.float64]

SHANK = 0.14  # of the shank is drawn, m
LONGEST = 0.08  # arrow, m
VISIBLE = 0.02  # of the longest arrow; shorter ones are heads without a shaft


def step(walk: Walk, frames: int = 6) -> Figure:
    """One step of the right foot from touch-down to push-off; see `steps`."""
    return steps({"right foot": walk}, frames)


@styled
def steps(walks: Mapping[str, Walk], frames: int = 6) -> Figure:
    """The right foot's first step in walks by label, a row each: the sole in the sand and its forces.

    Snapshots at equal intervals, those of a row all in the same place, and all in the same scale.
    Each arrow is the force on one of `body.ARROWS` parts of the sole and ends there; titles are times
    since touch-down (see `footopt.walk.phases.stance`).

    Raises
    ------
    SettingError
        There are no frames.
    """
    check(frames >= 1, "frames", frames, "a whole number >= 1")
    rows = [row for label, walk in walks.items() if (row := _snapshots(label, walk, frames))]
    if not rows:
        return _no_step(next(iter(walks.values())))
    metres = LONGEST / max(row.size.max() for row in rows)  # of arrow per newton
    drawn = [row.points(metres) for row in rows]
    span = max(float(np.ptp(points[:, 0])) for points in drawn) + 0.02
    low = min(*(points[:, 1].min() - 0.01 for points in drawn), -0.06) - 0.2 * span  # room for the key
    high = max(*(points[:, 1].max() for points in drawn), 0.02) + 0.01
    width = (PAGE - 0.55) / frames - 0.08
    height = min(width * (high - low) / span + 0.85, 8.0 / len(rows))
    figure = new_figure(PAGE, height * len(rows))
    for i, (row, points) in enumerate(zip(rows, drawn, strict=True)):
        left = 0.5 * float(points[:, 0].min() + points[:, 0].max() - span)
        part = figure if len(rows) == 1 else figure.add_subfigure(figure.add_gridspec(len(rows), 1)[i])
        panels = part.subplots(1, frames, sharex=True, sharey=True, squeeze=False)[0]
        for j, axes in enumerate(panels):
            draw_sand(axes, left, left + span, low)
            row.draw(axes, j, metres)
            axes.set(xlim=(left, left + span), ylim=(low, high), aspect="equal", xlabel="$x$ (m)")
            axes.xaxis.set_major_locator(MaxNLocator(2))
            axes.yaxis.set_major_locator(MaxNLocator(4))
        if i == 0:
            newtons = round_down(0.8 * LONGEST / metres)
            arrows = next(a for a in panels[0].collections if hasattr(a, "U"))
            place = left + 0.05 * span + metres * newtons, low + 0.08 * span
            panels[0].quiverkey(arrows, *place, newtons, f"{newtons:g} N", labelpos="E", coordinates="data",
                                labelsep=0.05, zorder=5)  # fmt: skip
        panels[0].set_ylabel("$z$ (m)")
        part.suptitle(textwrap.fill(row.title, 125))
    return figure


def _no_step(walk: Walk) -> Figure:
    """A figure that says why there is no step in it."""
    figure = new_figure(PAGE, 1.6)
    axes = figure.subplots()
    axes.set_axis_off()
    why = f"the walk failed: {walk.reason}" if walk.reason else "its foot never touched the sand"
    message(axes, f"no step of the right foot to show: {why}")
    return figure


class _Snapshots(NamedTuple):
    """The right foot at M instants of a step: m, N, s since the step began."""

    outline: Array  # (M, points, 2)
    sole: Array  # (M, points, 2)
    shank: Array  # (M, 2, 2), the ankle and a point of the shank
    at: Array  # (M, arrows, 2)
    force: Array  # (M, arrows, 2)
    since: Array  # (M,)
    title: str

    @property
    def size(self) -> Array:
        """Of the forces, (M, arrows), N."""
        return np.asarray(np.linalg.norm(self.force, axis=-1))

    def points(self, metres: float) -> Array:
        """Everything that is drawn, (m, 2), with arrows of so many metres per newton."""
        parts = self.outline, self.at - metres * self.force, self.shank
        return np.concatenate([part.reshape(-1, 2) for part in parts])

    def draw(self, axes: Axes, j: int, metres: float) -> None:
        """Foot, shank and forces of one snapshot."""
        axes.add_patch(Polygon(self.outline[j], closed=True, fc=PALE, ec=GREY, lw=0.5, zorder=2))
        axes.plot(*self.shank[j].T, color=GREY, lw=4, solid_capstyle="round", zorder=2.5)
        axes.plot(*self.shank[j, 0], "o", color="black", ms=3, zorder=3.5)
        axes.plot(*self.sole[j].T, color=BLUE, zorder=3)
        axes.set_title(f"{self.since[j]:.2f} s")
        seen = self.size[j] > VISIBLE * self.size.max()
        looks: dict[str, Any] = {"pivot": "tip", "width": 0.008, "color": VERMILLION, "zorder": 4}
        draw_arrows(axes, self.at[j, seen], self.force[j, seen], metres, **looks)


def _snapshots(label: str, walk: Walk, frames: int) -> _Snapshots | None:
    """Snapshots of the right foot's first step; None if it never stood."""
    contact = stance(walk)
    if contact is None:
        return None
    # at its very ends a contact carries no force
    share = np.linspace(0.05, 0.95, frames) if frames > 1 else np.array([0.5])
    begin, end = walk.t[contact.first], walk.t[contact.last]
    index = np.searchsorted(walk.t, begin + share * (end - begin))  # steps of time are not equally long
    at, force = (part[:, RIGHT] for part in forces_along(walk, index))
    placed = body(walk, walk.t[index])
    knee, ankle = placed.legs[:, RIGHT, 1], placed.legs[:, RIGHT, 2]
    shank = np.stack([ankle, ankle + SHANK / walk.scene.walker.l2 * (knee - ankle)], axis=1)
    began = f"t = {begin:.2f} s"
    since = f"heel strike ({began}; dragged through the sand until then)"
    since = since if contact.dragged else f"touch-down ({began})"
    title = f"{walk_label(label, walk)}, time since {since}; arrows: force on 1/{at.shape[1]} of the sole"
    outline, sole = placed.outline[:, RIGHT], placed.sole[:, RIGHT]
    return _Snapshots(outline, sole, shank, at, force, walk.t[index] - begin, title)
