"""Figures of walks against time: centre of mass, forces, power and work."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

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
)  # fmt: skip
from footopt.walk import Walk

ROUNDING = 12  # digits behind the point: what is smaller is no motion, force or power

#: A panel of a figure of walks: the trace's name, which of its components, and the label of its axis.
Panel = tuple[str, tuple[int, ...], str]


@styled
def com(walks: Mapping[str, Walk]) -> Figure:
    """Position and velocity of the centre of mass against time, of walks by label."""
    panels: list[Panel] = [("com", (i,), rf"${axis}_{{\mathrm{{COM}}}}$ (m)") for i, axis in enumerate("xz")]
    panels += [("velocity", (i,), f"$V_{axis}$ (m/s)") for i, axis in enumerate("xz")]
    return _panels(walks, panels)


@styled
def forces(walks: Mapping[str, Walk]) -> Figure:
    """Force of the sand on each foot against time: f_x left, f_z right; a row for each foot."""
    feet = enumerate(side for side, _ in SIDES)
    panels = [("force", (foot, i), f"{side} foot $f_{'xz'[i]}$ (N)") for foot, side in feet for i in range(2)]
    return _panels(walks, panels, sharey="col")


@styled
def power_work(walks: Mapping[str, Walk]) -> Figure:
    """Power and cumulative work of the sand on each foot against time; a row for each foot."""
    panels: list[Panel] = []
    for foot, (side, _) in enumerate(SIDES):
        panels.append(("power", (foot,), f"{side} foot power $P_{side[0]}$ (W)"))
        panels.append(("work", (foot,), f"{side} foot work $W_{side[0]}$ (J)"))
    return _panels(walks, panels, sharey="col")


def _panels(walks: Mapping[str, Walk], panels: Iterable[Panel], sharey: Any = False) -> Figure:
    """Traces of walks by label, in two rows of two panels."""
    figure = new_figure(PAGE, 3.6)
    grid = figure.subplots(2, 2, sharex=True, sharey=sharey)
    for axes, (name, index, label) in zip(grid.flat, panels, strict=True):
        for i, (key, walk) in enumerate(walks.items()):
            _draw(axes, walk, name, index, look(key, i) | {"label": walk_label(key, walk)})
        strikes = _finish(axes, walks.values())
        axes.set_ylabel(label)
    for axes in grid[-1]:
        axes.set_xlabel("time $t$ (s)")
    figure.align_ylabels()
    if strikes:
        top = grid.flat[0].get_xaxis_transform()
        grid.flat[0].text(strikes[0], 1.0, "heel strike", color=GREY, ha="center", va="bottom", transform=top)
    legend_above(figure)
    return figure


#: The components of a quantity of a walk: the label of the axis, and each line's label, component and looks.
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
        axes.axvline(strike, color=GREY, lw=0.5, zorder=0)
    axes.set_xlim(0.0, max((s.duration for s in scenes), default=1.0))
    if not any(len(walk.t) for walk in shown):
        message(axes, "no samples: " + ", ".join(sorted({walk.reason for walk in shown})))
    return strikes
