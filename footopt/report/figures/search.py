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
)  # fmt: skip
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
    """The label of what a search for these objectives improves (`footopt.design.Generation`)."""
    return lookup(names)[0].label if len(names) == 1 else "hypervolume (1: box of the first generation)"


@styled
def convergence(history: Sequence[Any], label: str, base: float | None = None) -> Figure:
    """The best value, or the hypervolume, and the population's median against the number of evaluations.

    `history` is that of a search (`footopt.design.Generation`), `label` the value's with its unit. With the
    flat foot's value as `base`, values are multiples of it.
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
    """Every pair of two or more objectives of designs, in groups (designs, objectives) by label.

    Rows with a NaN failed and are not drawn; of more than `POINTS` an even selection is. `marks` are designs
    to point out, by name in `MARKS`.
    """
    tables = dict(_drawn(label, _table(values)) for label, values in groups.items())
    found, n = _known(marks), len(names)
    size = min(PAGE, 1.6 * n + 1.0)
    figure = new_figure(size, size if n > 2 else 0.75 * size)
    grid = figure.subplots(n - 1, n - 1, squeeze=False)
    labels = list(map(_axis_label, lookup(names)))
    for (row, column), axes in np.ndenumerate(grid):
        if column > row:
            axes.set_axis_off()
            continue
        for i, (label, table) in enumerate(tables.items()):
            # a single group has the designs' own colour and a title
            looks = marker(i) | ({"label": as_text(label)} if len(tables) > 1 else {"color": DESIGNS})
            axes.plot(*table[:, [column, row + 1]].T, **looks, ms=2.5, alpha=0.6)
        for name, values in found.items():
            axes.plot(*values[[column, row + 1]], **MARKS[name], clip_on=False, mew=0.6, ls="", label=name)
        axes.locator_params(nbins=3)
        axes.label_outer()
        axes.set(xlabel=labels[column] if row == n - 2 else "", ylabel="" if column else labels[row + 1])
    figure.align_labels()
    if len(tables) == 1:
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
    """Parallel coordinates of many designs: better is up on every axis; see `draw_parallel`."""
    figure = new_figure(PAGE, 2.8)
    draw_parallel(figure.subplots(), values, names, marks, what)
    return figure


def draw_parallel(
    axes: Axes,
    values: ArrayLike,
    names: Sequence[str],
    marks: Mapping[str, ArrayLike] | None = None,
    what: str = "designs",
) -> None:
    """Parallel coordinates of designs (designs, objectives), natural signs, called `what`.

    Rows with a NaN failed and are not drawn; `marks` are designs to point out, by name in `MARKS`.
    """
    table, objectives, found = _table(values), lookup(names), _known(marks)
    failed, n = len(np.atleast_2d(values)) - len(table), len(objectives)
    axes.set_axis_off()
    axes.set(xlim=(-0.35, n - 0.4), ylim=(-0.44, 1.16))
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
    for name, row in found.items():
        dashes = "--" if name == "flat sole" else "-"
        axes.plot(x, place(row), **MARKS[name], lw=2, mew=0.6, clip_on=False, ls=dashes, label=name)
    if "chosen" in found:
        box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": BEST, "lw": 0.5}
        for i, (y, value) in enumerate(zip(place(found["chosen"]), found["chosen"], strict=True)):
            axes.text(i + 0.06, y, formula(value), va="center", bbox=box, zorder=7)
    axes.annotate("", (-0.2, 0.2), (-0.2, 0.8), arrowprops={"arrowstyle": "<-", "lw": 0.8})
    axes.text(-0.23, 0.5, "better", rotation=90, ha="right", va="center")
    if found:
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.0)
    left_out = [f"{failed} failed, not drawn"] * (failed > 0) + [f"1 of {every} is drawn"] * (every > 1)
    said = f" ({'; '.join(left_out)})" if left_out else ""
    axes.set_title(f"{len(table)} {what}{said}", color=DARK)


def _drawn(label: str, table: Array) -> tuple[str, Array]:
    """A group's label and rows, or an even selection of them."""
    every = -(-len(table) // POINTS)
    return (f"{label} (1 of {every} is drawn)", table[::every]) if every > 1 else (label, table)


def _table(values: ArrayLike) -> Array:
    """The rows of a table that have all values."""
    table = np.atleast_2d(np.asarray(values, float))
    return np.asarray(table[np.isfinite(table).all(axis=1)])


def _known(marks: Mapping[str, ArrayLike] | None) -> dict[str, Array]:
    """The designs to point out that have all values."""
    rows = {name: np.asarray(row, float) for name, row in (marks or {}).items()}
    return {name: row for name, row in rows.items() if np.isfinite(row).all()}


def _axis_label(o: Objective) -> str:
    """Axis label in lines that fit a small panel, with the direction that is better."""
    arrow = "better \N{RIGHTWARDS ARROW}" if o.maximise else "\N{LEFTWARDS ARROW} better"
    return f"{_two_lines(o)}\n{arrow}"


def _two_lines(o: Objective) -> str:
    """An objective's label with its symbol and unit on a second line."""
    title = o.name.replace("_", " ")
    return f"{title}\n{o.label.removeprefix(title).strip()}"
