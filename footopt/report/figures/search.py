"""Figures of searches: convergence, and the objectives of many designs in pairs or side by side."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from footopt.errors import check
from footopt.report.style import (
    BEST,
    COLUMN,
    DARK,
    DESIGNS,
    FLAT,
    PAGE,
    Axes,
    as_text,
    formula,
    legend_above,
    marker,
    message,
    new_figure,
    styled,
)
from footopt.walk.objectives import Objective, lookup

Array = NDArray[np.float64]

FRONT = "designs on the front"
LINES = 1000  # parallel ones at most: more are a solid block, or too faint to be seen
POINTS = 5000  # of a group in a panel at most
#: Designs that stand out among the others.
MARKS: dict[str, dict[str, Any]] = {
    "chosen": {"marker": "*", "ms": 11, "mfc": BEST, "color": BEST, "mec": "black", "zorder": 6},
    "flat sole": {"marker": "s", "ms": 6, "mfc": FLAT, "color": FLAT, "mec": "black", "zorder": 5},
}


def history_label(names: Sequence[str]) -> str:
    """What a search for these objectives makes better (`footopt.design.Generation`)."""
    return lookup(names)[0].label if len(names) == 1 else "hypervolume (1: box of the first generation)"


@styled
def convergence(history: Sequence[Any], label: str, base: float | None = None) -> Figure:
    """The best value, or the hypervolume, and the population's median against the number of evaluations.

    Parameters
    ----------
    history : sequence of footopt.design.Generation
        Of a search.
    label : str
        Of the value, with its unit if it has one.
    base : float, optional
        Of the flat foot: values are then multiples of it.
    """
    figure = new_figure(COLUMN, 2.4)
    draw_convergence(figure.subplots(), history, label, base)
    return figure


def draw_convergence(axes: Axes, history: Sequence[Any], label: str, base: float | None = None) -> None:
    """Best and median on one axes; see `convergence`."""
    evaluations, best, median, volume = (
        np.array([getattr(row, name) for row in history], float)
        for name in ("evaluations", "best", "median", "hypervolume")
    )
    best = best if np.isfinite(best).any() else volume
    upright = label if base is None else f"{label} (× of flat)"
    axes.set(xlabel="evaluations", ylabel=textwrap.fill(upright, 32))
    if not np.isfinite(best).any():
        message(axes, "no feasible design was found")
        axes.tick_params(bottom=False, labelbottom=False)
        return
    last, scale = np.flatnonzero(np.isfinite(best))[-1], base or 1.0
    # a best value holds until a better one is found
    axes.plot(evaluations, best / scale, color=BEST, drawstyle="steps-post", zorder=3, label="best")
    axes.plot(evaluations[last], best[last] / scale, "o", color=BEST, zorder=3)
    if np.isfinite(median).any():
        axes.plot(evaluations, median / scale, color=FLAT, ls="--", label="median of the generation")
    axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    times = "" if base is None else f"× {best[last] / scale:.2f} of flat, "
    axes.set_title(f"best {times}{formula(best[last])}", loc="right")
    if len(history) > 1:
        axes.legend(loc="best")


@styled
def scatter_matrix(
    groups: Mapping[str, ArrayLike], names: Sequence[str], marks: Mapping[str, ArrayLike] | None = None
) -> Figure:
    """Every pair of objectives of many designs.

    Parameters
    ----------
    groups : mapping of str to (designs, objectives)
        By label, each in its own colour; rows with a NaN failed and are not drawn. Of more than 5,000 an
        even selection is drawn.
    names : sequence of str
        Of the objectives, two or more (`footopt.walk.objectives.OBJECTIVES`).
    marks : mapping of str to (objectives,), optional
        Designs to point out, by name in `MARKS`.

    Raises
    ------
    SettingError
        The values do not fit the names.
    """
    tables = dict(_drawn(label, _table(values, names)) for label, values in groups.items())
    check(len(names) > 1, "names", names, "two objectives or more")
    found, n = _marks(marks), len(names)
    size = min(PAGE, 1.6 * n + 1.0)
    figure = new_figure(size, size if n > 2 else 0.75 * size)
    grid = figure.subplots(n - 1, n - 1, squeeze=False)
    labels = list(map(_axis_label, lookup(names)))
    for (row, column), axes in np.ndenumerate(grid):
        if column > row:
            axes.set_axis_off()
            continue
        for i, (label, table) in enumerate(tables.items()):
            looks = _points(i, len(tables)) | {
                "ms": 2.5,
                "alpha": 0.6,
                "label": as_text(label) if len(tables) > 1 else None,
            }
            axes.plot(*table[:, [column, row + 1]].T, **looks)
        for name, values in found.items():
            looks = MARKS[name] | {"clip_on": False, "mew": 0.6, "ls": "", "label": name}
            axes.plot(*values[[column, row + 1]], **looks)
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.yaxis.set_major_locator(MaxNLocator(3))
        axes.tick_params(labelbottom=row == n - 2, labelleft=column == 0)
        if row == n - 2:
            axes.set_xlabel(labels[column])
        if column == 0:
            axes.set_ylabel(labels[row + 1])
    figure.align_labels()
    if len(tables) == 1:  # a cloud leaves no room beside it
        grid[0, 0].set_title(as_text(next(iter(tables))), color=DARK)
    legend_above(figure)
    return figure


@styled
def parallel(
    values: ArrayLike,
    names: Sequence[str],
    marks: Mapping[str, ArrayLike] | None = None,
    what: str = "designs",
) -> Figure:
    """Parallel coordinates of many designs: better is up on every axis.

    Parameters
    ----------
    values : (designs, objectives)
        In natural signs; rows with a NaN failed and are not drawn.
    names, marks
        As for `scatter_matrix`.
    what : str
        What the designs are.

    Raises
    ------
    SettingError
        The values do not fit the names.
    """
    figure = new_figure(PAGE, 2.8)
    axes = figure.subplots()
    draw_parallel(axes, values, names, marks, what)
    return figure


def draw_parallel(
    axes: Axes,
    values: ArrayLike,
    names: Sequence[str],
    marks: Mapping[str, ArrayLike] | None = None,
    what: str = "designs",
) -> None:
    """Parallel coordinates on one axes, see `parallel`."""
    table, objectives, found = _table(values, names), lookup(names), _marks(marks)
    failed = len(np.atleast_2d(values)) - len(table)
    axes.set_axis_off()
    n = len(objectives)
    axes.set(xlim=(-0.55, n - 0.4), ylim=(-0.44, 1.16))
    if len(table) == 0:
        message(axes, f"no design to show: {failed} failed, not drawn")
        return
    sign = np.array([-o.sign for o in objectives])
    ends = sign * np.vstack([table, *found.values()])
    low, high = ends.min(axis=0), ends.max(axis=0)
    span = np.where(high > low, high - low, 1.0)

    def place(rows: Array) -> Array:
        return np.where(high > low, (sign * rows - low) / span, 0.5)

    x = np.arange(n)
    every = -(-len(table) // LINES)
    curves = [np.stack([x, row], axis=1) for row in place(table[::every])]
    alpha = max(0.03, min(0.8, 20.0 / len(curves)))
    axes.add_collection(LineCollection(curves, colors=DESIGNS, linewidths=0.6, alpha=alpha), autolim=False)
    for i, o in enumerate(objectives):
        axes.plot([i, i], [0, 1], color="black", lw=0.8, zorder=3)
        axes.text(i, 1.07, formula(sign[i] * high[i]), ha="center", va="bottom")
        axes.text(i, -0.07, formula(sign[i] * low[i]), ha="center", va="top")
        axes.text(i, -0.2, _two_lines(o), ha="center", va="top")
    highest = max((place(row)[0] for row in found.values()), default=0.0)
    for name, row in found.items():
        y = place(row)
        more = {"lw": 2, "mew": 0.6, "clip_on": False, "ls": "--" if name == "flat sole" else "-"}
        axes.plot(x, y, **MARKS[name] | more, label=f"_{name}")
        level = y[0] + 0.04 * (len(found) - 1) * (1 if y[0] == highest else -1)  # off the other's name
        axes.text(-0.07, level, name, ha="right", va="center", color=MARKS[name]["color"], zorder=7)
        if name == "chosen":
            box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": BEST, "lw": 0.5}
            for i in range(n):
                axes.text(i + 0.06, y[i], formula(row[i]), va="center", bbox=box, zorder=7)
    axes.annotate("", (-0.43, 0.2), (-0.43, 0.8), arrowprops={"arrowstyle": "<-", "lw": 0.8})
    axes.text(-0.46, 0.5, "better", rotation=90, ha="right", va="center")
    left_out = [f"{failed} failed, not drawn"] * (failed > 0) + [f"1 of {every} is drawn"] * (every > 1)
    said = f" ({'; '.join(left_out)})" if left_out else ""
    axes.set_title(f"{len(table)} {what}{said}", color=DARK)


def _drawn(label: str, table: Array) -> tuple[str, Array]:
    """A group's label and rows, or an even selection of them."""
    every = -(-len(table) // POINTS)
    return (f"{label} (1 of {every} is drawn)", table[::every]) if every > 1 else (label, table)


def _points(i: int, groups: int) -> dict[str, Any]:
    """Of the i-th group of designs; a single one has the designs' own colour."""
    return marker(i) | ({"color": DESIGNS} if groups == 1 else {})


def _table(values: ArrayLike, names: Sequence[str]) -> Array:
    """The rows of a table that have all values; raises `SettingError` if it does not fit its names."""
    table = np.atleast_2d(np.asarray(values, float))
    check(table.shape[1] == len(names), "values", table.shape, f"an array with {len(names)} columns")
    return np.asarray(table[np.isfinite(table).all(axis=1)])


def _marks(marks: Mapping[str, ArrayLike] | None) -> dict[str, Array]:
    """The designs to point out that have all values."""
    rows = {name: np.asarray(row, float) for name, row in (marks or {}).items()}
    check(set(rows) <= set(MARKS), "marks", sorted(rows), f"of {', '.join(MARKS)}")
    return {name: row for name, row in rows.items() if np.isfinite(row).all()}


def _axis_label(o: Objective) -> str:
    """Axis label in lines that fit a small panel, with the direction that is better."""
    arrow = "better \N{RIGHTWARDS ARROW}" if o.maximise else "\N{LEFTWARDS ARROW} better"
    return f"{_two_lines(o)}\n{arrow}"


def _two_lines(o: Objective) -> str:
    """An objective's label with its symbol and unit on a second line."""
    title = o.name.replace("_", " ")
    return f"{title}\n{o.label.removeprefix(title).strip()}"
