"""Figures of walks against time: centre of mass, forces, power and work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from footopt.report.style import (
    BLUE,
    GREY,
    PAGE,
    SIDES,
    VERMILLION,
    Axes,
    as_text,
    legend_above,
    line,
    message,
    new_figure,
    styled,
)
from footopt.walk import Walk

Array = NDArray[np.float64]

#: A quantity of a walk: the trace's name, which of its components, and the label of its axis.
Panel = tuple[str, tuple[int, ...], str]


@styled
def com(walks: Mapping[str, Walk]) -> Figure:
    """Position and velocity of the centre of mass against time, of walks by label."""
    rows: list[list[Panel]] = [
        [("com", (i,), rf"${axis}_{{\mathrm{{COM}}}}$ (m)") for i, axis in enumerate("xz")],
        [("velocity", (i,), f"$V_{axis}$ (m/s)") for i, axis in enumerate("xz")],
    ]
    return _panels(walks, rows, sharey=False)


@styled
def forces(walks: Mapping[str, Walk]) -> Figure:
    """Force of the sand on each foot against time: f_x left, f_z right; a row for each foot."""
    rows: list[list[Panel]] = [
        [("force", (foot, i), f"{side} foot $f_{axis}$ (N)") for i, axis in enumerate("xz")]
        for foot, (side, _) in enumerate(SIDES)
    ]
    return _panels(walks, rows, sharey="col")


@styled
def power_work(walks: Mapping[str, Walk]) -> Figure:
    """Power and cumulative work of the sand on each foot against time; a row for each foot."""
    rows: list[list[Panel]] = [
        [
            ("power", (foot,), f"{side} foot power $P_{side[0]}$ (W)"),
            ("work", (foot,), f"{side} foot work $W_{side[0]}$ (J)"),
        ]
        for foot, (side, _) in enumerate(SIDES)
    ]
    return _panels(walks, rows, sharey="col")


def _panels(walks: Mapping[str, Walk], rows: Sequence[Sequence[Panel]], sharey: Any) -> Figure:
    """Traces of walks by label, a panel for each quantity."""
    figure = new_figure(PAGE, 3.6)
    grid = figure.subplots(len(rows), len(rows[0]), sharex=True, sharey=sharey)
    for axes, (name, index, label) in zip(grid.flat, chain(*rows), strict=True):
        draw_traces(axes, walks, name, *index)
        axes.set(ylabel=label, xlim=(0.0, max((w.scene.duration for w in walks.values()), default=1.0)))
    for axes in grid[-1]:
        axes.set_xlabel("time $t$ (s)")
    figure.align_ylabels()
    handles, labels = grid.flat[0].get_legend_handles_labels()
    if any(len(walk.scene.gait.heel_strikes(walk.scene.duration)) for walk in walks.values()):
        handles, labels = [*handles, Line2D([], [], color=GREY, lw=0.5)], [*labels, "heel strike"]
    legend_above(figure, handles, labels)
    return figure


class Trace(NamedTuple):
    """One line of a plot against time: its label, the walk, the values (T,), and how it looks."""

    label: str
    walk: Walk
    values: Array
    looks: dict[str, Any]


def draw_traces(axes: Axes, walks: Mapping[str, Walk], name: str, *index: int) -> None:
    """One quantity of each walk against time, with thin lines at heel strikes.

    A walk that failed ends in a cross; one that failed at once leaves only its label.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    walks : Mapping
        Walks by label.
    name : str
        Of the trace: com, velocity, force, power or work.
    index : int
        Of the component.
    """
    _draw_lines(
        axes,
        [
            Trace(walk_label(label, walk), walk, getattr(walk, name)[(slice(None), *index)], line(i))
            for i, (label, walk) in enumerate(walks.items())
        ],
    )


#: What `draw_components` shows of a walk: the label of the axis, and each line's label, component and looks.
_AXES = (("forward $x$", (0,), {"color": BLUE}), ("up $z$", (1,), {"color": VERMILLION, "ls": "--"}))
_FEET = tuple((f"{side} foot", (i,), {"color": c, "ls": ("-", "--")[i]}) for i, (side, c) in enumerate(SIDES))
_FORCES = tuple(
    (f"{side} $f_{axis}$", (foot, "xz".index(axis)), {"color": colour, "ls": dashes})
    for axis, dashes in (("z", "-"), ("x", ":"))
    for foot, (side, colour) in enumerate(SIDES)
)
COMPONENTS: dict[str, tuple[str, tuple[tuple[str, tuple[int, ...], dict[str, Any]], ...]]] = {
    "com": ("COM (m)", _AXES),
    "velocity": ("velocity of the COM (m/s)", _AXES),
    "force": ("force of the sand (N)", _FORCES),
    "power": ("power of the sand (W)", _FEET),
    "work": ("work of the sand (J)", _FEET),
}


def draw_components(axes: Axes, walk: Walk, name: str) -> None:
    """All components of one quantity of `COMPONENTS` of a walk against time."""
    label, parts = COMPONENTS[name]
    axes.set(xlabel="time $t$ (s)", ylabel=label, xlim=(0.0, walk.scene.duration))
    axes.yaxis.set_major_locator(MaxNLocator(5))
    values = getattr(walk, name)
    _draw_lines(axes, [Trace(part, walk, values[(slice(None), *i)], looks) for part, i, looks in parts])


def _draw_lines(axes: Axes, traces: Sequence[Trace]) -> None:
    scenes = [trace.walk.scene for trace in traces]
    for strike in sorted({float(h) for s in scenes for h in s.gait.heel_strikes(s.duration)}):
        axes.axvline(strike, color=GREY, lw=0.5, zorder=0)
    for label, walk, values, looks in traces:
        axes.plot(walk.t, values, **looks, label=label)
        if not walk.feasible and len(walk.t):
            axes.plot(walk.t[-1], values[-1], "x", color=looks["color"], ms=6, mew=1.5)
    if not any(len(trace.walk.t) for trace in traces):
        message(axes, "no samples: " + ", ".join(sorted({trace.walk.reason for trace in traces})))


def walk_label(label: str, walk: Walk) -> str:
    """A walk's label, with the reason if it failed."""
    return as_text(label) if walk.feasible else f"{as_text(label)} (failed: {walk.reason})"
