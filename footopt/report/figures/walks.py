"""Figures of walks and searches: traces, a step in the sand; convergence, designs by pairs of objectives."""

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from footopt.errors import SettingError
from footopt.gait import RIGHT
from footopt.report import style
from footopt.report.stage import ARROWS, Stage, draw_ground, draw_key
from footopt.walk import Walk
from footopt.walk.objectives import Objective, lookup
from footopt.walk.results import stance

ROWS, COLUMNS = 2, 3  # of snapshots
LONGEST = 0.27  # arrow, of the length of a sole
MARGIN = 0.077  # around the soles and below the arrows, of that length

#: Designs that stand out among the others.
MARKS: dict[str, dict[str, Any]] = {
    "chosen": {"marker": "*", "ms": 11, "mfc": style.BEST, "color": style.BEST, "zorder": 6},
    "flat sole": {"marker": "s", "ms": 6, "mfc": style.FLAT, "color": style.FLAT, "zorder": 5},
}

ROUNDING = 12  # digits behind the point: what is smaller is no motion, force or power

#: Quantities of a walk: the label of an axis, and symbols of the components, of each foot where it is named.
QUANTITIES: dict[str, tuple[str, list[str]]] = {
    "com": ("position (m)", [r"$x_{\mathrm{COM}}$", r"$z_{\mathrm{COM}}$"]),
    "velocity": ("velocity (m/s)", ["$V_x$", "$V_z$"]),
    "force": ("force of the sand (N)", ["{side} foot $f_x$", "{side} foot $f_z$"]),
    "power": ("power of the sand (W)", ["{side} foot $P_{letter}$"]),
    "work": ("work of the sand (J)", ["{side} foot $W_{letter}$"]),
}


def components(walk: Walk, name: str) -> dict[str, tuple[int, ...]]:
    """The symbol of each component of one of `QUANTITIES` of a walk, with its index."""
    symbols, found = QUANTITIES[name][1], {}
    if not symbols[0].startswith("{side}"):
        return {symbol: (i,) for i, symbol in enumerate(symbols)}
    for foot, (side, _) in enumerate(style.sides(walk)):
        for i, symbol in enumerate(symbols):
            found[symbol.format(side=side, letter=side[0])] = (foot, i)[: len(symbols)]
    return found


@style.styled()
def _panels(walks: Mapping[str, Walk], names: Sequence[str], sharey: Any = False) -> Figure:
    """Traces of walks by label, in two rows of two panels, or in one row for one foot."""
    figure = style.new_figure(style.PAGE, 3.6, style.Margins(across=0.76, down=0.16))
    walk = next(iter(walks.values()))
    panels = [(name, *part) for name in names for part in components(walk, name).items()]
    rows = 2 if len(walk.sides) > 1 or "com" in names else 1
    grid = figure.subplots(rows, len(panels) // rows, sharex=True, sharey=sharey, squeeze=False)
    for axes, (name, symbol, index) in zip(grid.flat, panels, strict=True):
        for i, (label, walk) in enumerate(walks.items()):
            _draw(axes, walk, name, index, style.look(label, i) | {"label": style.walk_label(label, walk)})
        _finish(axes, walks.values())
        unit = QUANTITIES[name][0].rpartition(" ")[2]
        axes.set_ylabel(f"{symbol} {unit}")
        style.line_up_labels(axes)
    for axes in grid[-1]:
        axes.set_xlabel("time $t$ (s)")
    style.legend_above(figure)
    return figure


#: Of walks by label, against time: position and velocity of the centre of mass; the force of the sand on each
#: foot, a row for each; its power and cumulative work, a column for each.
com = partial(_panels, names=["com", "velocity"])
forces = partial(_panels, names=["force"], sharey="col")
power_work = partial(_panels, names=["power", "work"], sharey="row")


def draw_quantity(axes: style.Axes, walk: Walk, name: str) -> None:
    """All components of one of `QUANTITIES` of a walk against time."""
    for symbol, index in components(walk, name).items():
        colour = style.SIDES[index[0]][1] if "foot" in symbol else style.COLOURS[index[0]]
        _draw(axes, walk, name, index, {"color": colour, "ls": "--" if index[-1] else "-", "label": symbol})
    _finish(axes, [walk])
    axes.set(xlabel="time $t$ (s)", ylabel=QUANTITIES[name][0])


def _draw(axes: style.Axes, walk: Walk, name: str, index: tuple[int, ...], looks: dict[str, Any]) -> None:
    """One component of a trace; that of a walk which failed ends in a cross."""
    values = np.round(getattr(walk, name)[(slice(None), *index)], ROUNDING)
    axes.plot(walk.t, values, **looks)
    if not walk.feasible and len(walk.t):
        axes.plot(walk.t[-1], values[-1], "x", color=looks["color"], ms=6, mew=1.5)


def _finish(axes: style.Axes, walks: Iterable[Walk]) -> None:
    """Thin lines at the heel strikes, and words where no walk has a sample."""
    shown = list(walks)
    for i, strike in enumerate(sorted({float(h) for w in shown for h in w.scene.strikes})):
        axes.axvline(strike, color=style.GREY, lw=0.5, zorder=0, label="_" if i else "heel strike")
    axes.set_xlim(0.0, max(walk.scene.duration for walk in shown))
    if not any(len(walk.t) for walk in shown):
        style.message(axes, "no samples: " + ", ".join(sorted({walk.reason for walk in shown})))


@style.styled()
def step(walk: Walk) -> Figure:
    """The right foot's first step: the sole and its forces.

    Snapshots are at equal intervals of time. Each arrow is the force on one of `stage.ARROWS` parts of the
    sole and ends there. Raises `SettingError` for a walk without a `footopt.walk.results.stance`.
    """
    contact = stance(walk)
    if contact is None:
        raise SettingError("t_f", walk.scene.duration, "a walk in which the right foot has stood")
    foot, begin, end = RIGHT, walk.t[contact.first], walk.t[contact.last]
    times = np.linspace(begin, end, 2 * ROWS * COLUMNS + 1)[1::2]  # at its ends a contact carries no force
    longest, margin = np.multiply((LONGEST, MARGIN), np.ptp(walk.foot.contour[:, 0]))
    stage = Stage(walk, walk.t[np.searchsorted(walk.t, times)])
    largest = float(np.linalg.norm(stage.force[:, foot], axis=-1).max())
    sole = stage.outline[:, foot].reshape(-1, 2)
    (left, low), (right, high) = sole.min(axis=0), sole.max(axis=0)
    figure = style.new_figure(style.PAGE, 6.0, style.Margins(0.22, 0.12, 0.16))
    grid = figure.subplots(ROWS, COLUMNS, sharex=True, sharey=True)
    digits = max(2, 1 - math.floor(math.log10(stage.t[-1] - begin)))
    for i, axes in enumerate(grid.flat):
        axes.set(xlim=(left - margin, right + margin), aspect="equal")
        axes.set(ylim=(low - longest - margin, max(high, 0.0) + 2 * margin))
        draw_ground(axes, stage.ground, words=axes is grid[0, -1])
        arrows = stage.draw_feet(axes, i, largest / longest, foot, close=True)
        if i == 0:
            draw_key(axes, arrows, 0.8 * largest)
        passed = stage.t[i] - begin
        axes.text(0.02, 0.98, f"{passed:.{digits}f} s", va="top", transform=axes.transAxes)
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.yaxis.set_major_locator(MaxNLocator(4))
    since = f"{'heel strike' if contact.dragged else 'touch-down'} at t = {begin:.2f} s"
    title = f"{style.walk_label(f'{walk.sides[foot]} foot', walk)}, time since {since}"
    grid[0, COLUMNS // 2].set_title(f"{title}; arrows: force on 1/{ARROWS} of the sole")
    figure.supxlabel("$x$ (m)")
    figure.supylabel("$z$ (m)", x=0.005)
    style.fit_height(figure, grid[:, 0].tolist())
    return figure


@style.styled()
def convergence(result: Any, base: float | None = None) -> Figure:
    """The best value, or the hypervolume, and the population's median against the number of evaluations.

    They are those of a `footopt.design.SearchResult`, with the flat foot's value as `base` multiples of it.
    """
    figure = style.new_figure(style.COLUMN, 2.4, style.Margins())
    draw_convergence(figure.subplots(), result, base)
    style.legend_above(figure)
    return figure


def draw_convergence(axes: style.Axes, result: Any, base: float | None = None) -> None:
    """Best and median on one axes; see `convergence`."""
    names, scale = result.problem.names, base or 1.0
    evaluations, best, median, volume = (
        np.array([getattr(row, name) for row in result.history], float)
        for name in ("evaluations", "best", "median", "hypervolume")
    )
    label = f"{lookup(names)[0].label}{' (× of flat)' if base else ''}"
    if len(names) > 1:
        best, label = volume, "hypervolume (1: box of the first generation)"
    # a best value holds until a better one is found
    axes.plot(evaluations, best / scale, color=style.BEST, ds="steps-post", zorder=3, label="best so far")
    if np.isfinite(median).any():
        restarts = ", low after a restart" * (result.solver.name == "memetic")
        name = f"median of a generation{restarts}"
        axes.plot(evaluations, median / scale, color=style.FLAT, ls="--", label=name)
    accuracy = result.problem.accuracy.name
    axes.set(xlabel=f"evaluations, at accuracy {accuracy}", ylabel=textwrap.fill(label, 32))
    axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))


@style.styled()
def scatter_matrix(
    groups: Mapping[str, ArrayLike],
    objectives: Sequence[Objective],
    marks: Mapping[str, ArrayLike] | None = None,
) -> Figure:
    """Every pair of two or more objectives of designs; see `draw_pair`."""
    n = len(objectives)
    size = min(style.PAGE, 1.6 * n + 1.0)
    figure = style.new_figure(size, size if n > 2 else 0.75 * size)
    grid = figure.subplots(n - 1, n - 1, squeeze=False)
    for (row, column), axes in np.ndenumerate(grid):
        if column > row:
            axes.set_axis_off()
            continue
        draw_pair(axes, groups, objectives, marks, column, row + 1)
        axes.locator_params(nbins=3)
        axes.label_outer()
    figure.align_labels()
    style.legend_above(figure)
    return figure


def draw_pair(
    axes: style.Axes,
    groups: Mapping[str, ArrayLike],
    objectives: Sequence[Objective],
    marks: Mapping[str, ArrayLike] | None = None,
    x: int = 0,
    y: int = 1,
) -> None:
    """Two objectives, by column, of designs in groups (designs, objectives) by label.

    Designs that failed have NaN and are not drawn. `marks` are designs to point out, by name in `MARKS`.
    """
    for i, (label, values) in enumerate(groups.items()):
        looks = style.marker(i) | ({"color": style.DESIGNS} if len(groups) == 1 else {})
        points = np.asarray(values, float)[:, [x, y]].T
        axes.plot(*points, **looks, ms=2.5, alpha=0.6, rasterized=True)
        axes.plot([], [], **looks, label=style.as_text(label))  # larger, to be seen in a legend
    for name, row in (marks or {}).items():
        if np.isfinite(values := np.asarray(row, float)).all():
            axes.plot(*values[[x, y]], **MARKS[name], clip_on=False, mec="black", mew=0.6, ls="", label=name)
    axes.set(xlabel=_axis_label(objectives[x]), ylabel=_axis_label(objectives[y]))


def _axis_label(o: Objective) -> str:
    """An objective with its symbol and unit, and the direction that is better, in lines for a small panel."""
    title = o.name.replace("_", " ")
    arrow = "better \N{RIGHTWARDS ARROW}" if o.maximise else "\N{LEFTWARDS ARROW} better"
    return f"{title}\n{o.label.removeprefix(title).strip()}\n{arrow}"
