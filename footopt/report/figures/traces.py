"""Figures of walks against time: centre of mass, forces, power and work."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from footopt.report.style import (
    COLOURS,
    GREY,
    PAGE,
    SIDES,
    Axes,
    legend_above,
    look,
    message,
    new_figure,
    styled,
    walk_label,
)
from footopt.walk import Walk

Array = NDArray[np.float64]

ROUNDING = 12  # digits behind the point: what is smaller is no motion, force or power
STRIKE: dict[str, Any] = {"color": GREY, "lw": 0.5, "zorder": 0}

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
        for i, (who, walk) in enumerate(walks.items()):
            looks = look(who, i) | {"label": walk_label(who, walk)}
            _draw(axes, walk, name, index, looks)
        strikes = _finish(axes, walks.values())
        axes.set(ylabel=label)
    for axes in grid[-1]:
        axes.set_xlabel("time $t$ (s)")
    figure.align_ylabels()
    if strikes:
        top = grid.flat[0].get_xaxis_transform()
        grid.flat[0].text(strikes[0], 1.0, "heel strike", color=GREY, ha="center", va="bottom", transform=top)
    legend_above(figure)
    return figure


#: What `draw_components` shows of a walk: the label of the axis, and each line's label, component and looks.
_AXES = (("forward $x$", (0,), {"color": COLOURS[0]}), ("up $z$", (1,), {"color": COLOURS[1], "ls": "--"}))
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
    for part, index, looks in parts:
        _draw(axes, walk, name, index, looks | {"label": part})
    _finish(axes, [walk])
    axes.set(xlabel="time $t$ (s)", ylabel=label)
    axes.yaxis.set_major_locator(MaxNLocator(5))


def _draw(axes: Axes, walk: Walk, name: str, index: tuple[int, ...], looks: dict[str, Any]) -> None:
    """One component of a trace; that of a walk which failed ends in a cross."""
    values = np.round(getattr(walk, name)[(slice(None), *index)], ROUNDING)
    axes.plot(walk.t, values, **looks)
    if not walk.feasible and len(walk.t):
        axes.plot(walk.t[-1], values[-1], "x", color=looks["color"], ms=6, mew=1.5)


def _finish(axes: Axes, walks: Iterable[Walk]) -> list[float]:
    """Thin lines at the heel strikes, which are returned, and words where no walk has a sample."""
    shown = list(walks)
    scenes = [walk.scene for walk in shown]
    strikes = sorted({float(h) for s in scenes for h in s.gait.heel_strikes(s.duration)})
    for strike in strikes:
        axes.axvline(strike, **STRIKE)
    axes.set_xlim(0.0, max((s.duration for s in scenes), default=1.0))
    if not any(len(walk.t) for walk in shown):
        message(axes, "no samples: " + ", ".join(sorted({walk.reason for walk in shown})))
    return strikes
