"""Figures of searches: convergence, and the objectives of many designs in pairs or side by side."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from footopt.errors import check
from footopt.report.style import (
    BLUE,
    COLUMN,
    PAGE,
    SKY,
    VERMILLION,
    Axes,
    formula,
    legend_above,
    legend_entry,
    message,
    new_figure,
    styled,
)
from footopt.walk.objectives import Objective, lookup

Array = NDArray[np.float64]

CHOSEN = "chosen"
STAR: dict[str, Any] = {
    "marker": "*", "ms": 11, "mfc": VERMILLION, "mec": "black", "mew": 0.6, "ls": "", "zorder": 5,
    "clip_on": False,
}  # fmt: skip


# --- convergence ----------------------------------------------------------------------------------


def history_label(names: Sequence[str]) -> str:
    """What a search for these objectives makes better (`footopt.design.Generation`)."""
    return lookup(names)[0].label if len(names) == 1 else "hypervolume (1: box of the first generation)"


@styled
def convergence(history: Iterable[Any], label: str) -> Figure:
    """The best value and the population's median against the number of evaluations.

    Parameters
    ----------
    history : iterable
        One entry a generation, objects or dicts with `evaluations`, `best` and, where they are
        known, `median`, `low` and `high` (the edges of a band to shade, e.g. quartiles).
    label : str
        Of the value, with its unit if it has one.
    """
    figure = new_figure(COLUMN, 2.4)
    draw_convergence(figure.subplots(), history, label)
    return figure


def draw_convergence(axes: Axes, history: Iterable[Any], label: str) -> None:
    """Best and median on one axes; see `convergence`."""
    rows = list(history)
    evaluations, best, median, low, high = (
        np.array([_entry(row, name) for row in rows], float)
        for name in ("evaluations", "best", "median", "low", "high")
    )
    axes.set(xlabel="evaluations", ylabel=label)
    if not np.isfinite(best).any():  # of a front
        best = np.array([_entry(row, "hypervolume") for row in rows], float)
    if not np.isfinite(best).any():
        message(axes, "no feasible design was found")
        axes.tick_params(bottom=False, labelbottom=False)
        return
    if (np.isfinite(low) & np.isfinite(high)).any():
        axes.fill_between(evaluations, low, high, color=SKY, alpha=0.3, lw=0, label="spread")
    if np.isfinite(median).any():
        axes.plot(evaluations, median, color=VERMILLION, ls="--", label="median")
    # a best value holds until a better one is found
    axes.plot(evaluations, best, color=BLUE, drawstyle="steps-post", label="best")
    last = np.flatnonzero(np.isfinite(best))[-1]
    axes.plot(evaluations[last], best[last], "o", color=BLUE)
    axes.legend(loc="best", title=f"best {formula(best[last])}")
    axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))


def _entry(row: Any, name: str) -> float:
    value = row.get(name) if isinstance(row, Mapping) else getattr(row, name, None)
    return float("nan") if value is None else float(value)


# --- many designs ---------------------------------------------------------------------------------


class _Designs(NamedTuple):
    """Objectives of the designs to draw, the one to point out, and how many are there and left out."""

    objectives: list[Objective]
    values: Array  # (designs, objectives)
    star: Array | None  # (objectives,)
    total: str
    failed: str


def _designs(values: ArrayLike, names: Sequence[str], marked: int | None) -> _Designs:
    """The designs that walked.

    Raises
    ------
    SettingError
        The table does not fit its names, or has no such row.
    """
    table = np.atleast_2d(np.asarray(values, float))
    objectives = lookup(names)
    rows, columns = table.shape
    check(columns == len(names), "values", table.shape, f"an array with {len(names)} columns")
    check(marked is None or 0 <= marked < rows, "marked", marked, f"a row, 0 to {rows - 1}")
    fine = np.isfinite(table).all(axis=1)
    star = None if marked is None or not fine[marked] else table[marked]
    failed = f"{np.sum(~fine)} failed, not drawn" if not fine.all() else ""
    return _Designs(objectives, table[fine], star, f"{np.sum(fine)} designs", failed)


@styled
def scatter_matrix(values: ArrayLike, names: Sequence[str], marked: int | None = None) -> Figure:
    """Every pair of objectives of many designs, and the spread of each.

    Parameters
    ----------
    values : (designs, objectives)
        In natural signs; rows with a NaN failed and are not drawn.
    names : sequence of str
        Of the objectives (`footopt.walk.objectives.OBJECTIVES`).
    marked : int, optional
        Row of the design to point out, the chosen one.

    Raises
    ------
    SettingError
        The values do not fit the names, or there is no such row.
    """
    objectives, good, star, total, failed = _designs(values, names, marked)
    n = len(objectives)
    size = min(PAGE, 1.4 * n + 1.0)
    figure = new_figure(size, size)
    grid = figure.subplots(n, n, squeeze=False)
    scales = np.array([_scale(column) for column in good.T])
    good, star = good / scales, None if star is None else star / scales
    labels = [_axis_label(o, scale) for o, scale in zip(objectives, scales, strict=True)]
    for (row, column), axes in np.ndenumerate(grid):
        if column > row:
            axes.set_axis_off()
            continue
        if column == row:
            _draw_spread(axes, good[:, column], None if star is None else star[column])
        else:
            axes.plot(*good[:, [column, row]].T, "o", color=BLUE, ms=2.5, mew=0, alpha=0.5)
            if star is not None:
                axes.plot(*star[[column, row]], **STAR)
        axes.xaxis.set_major_locator(MaxNLocator(3 if n <= 5 else 2))
        axes.yaxis.set_major_locator(MaxNLocator(3))
        axes.tick_params(labelbottom=row == n - 1, labelleft=column == 0 and row > 0)
        if row == n - 1:
            axes.set_xlabel(labels[column])
        if column == 0 and row > 0:
            axes.set_ylabel(labels[row])
    figure.align_labels()
    handles = [Line2D([], [], color=BLUE, ls="", marker="o", ms=3, alpha=0.6, label="design")]
    if star is not None:
        handles.append(Line2D([], [], **STAR, label=CHOSEN))
    if n > 1:
        title = "\n".join(filter(None, [total, failed]))
        grid[0, -1].legend(handles=handles, loc="upper right", title=title)
    else:
        figure.suptitle(", ".join(filter(None, [total, failed])))
    return figure


def _draw_spread(axes: Axes, values: Array, star: float | None) -> None:
    """How many designs have which value of one objective, (designs,)."""
    if len(values):
        axes.hist(values, bins=min(20, max(1, round(len(values) ** 0.5))), color=SKY, ec="white", lw=0.3)
    if star is not None:
        axes.axvline(star, color=VERMILLION, ls="--")
    axes.spines["left"].set_visible(False)
    axes.tick_params(left=False)


@styled
def parallel(values: ArrayLike, names: Sequence[str], marked: int | None = None) -> Figure:
    """Parallel coordinates of many designs: better is up on every axis.

    Parameters
    ----------
    values : (designs, objectives)
        As for `scatter_matrix`.
    names : sequence of str
        Of the objectives.
    marked : int, optional
        Row of the design to point out, the chosen one.

    Raises
    ------
    SettingError
        The values do not fit the names, or there is no such row.
    """
    figure = new_figure(PAGE, 2.8)
    axes = figure.subplots()
    title = draw_parallel(axes, values, names, marked)
    legend_above(figure, *axes.get_legend_handles_labels(), title=title)
    return figure


def draw_parallel(
    axes: Axes, values: ArrayLike, names: Sequence[str], marked: int | None = None
) -> str | None:
    """Parallel coordinates on one axes, see `parallel`; returns how many designs, None if there are none."""
    objectives, good, star, total, failed = _designs(values, names, marked)
    axes.set_axis_off()
    n = len(objectives)
    axes.set(xlim=(-0.35, n - 0.4), ylim=(-0.44, 1.16))
    if len(good) == 0:
        message(axes, f"no design to show: {failed}")
        return None
    sign = np.array([-o.sign for o in objectives])
    low, high = (sign * good).min(axis=0), (sign * good).max(axis=0)
    span = np.where(high > low, high - low, 1.0)

    def place(rows: Array) -> Array:
        return np.where(high > low, (sign * rows - low) / span, 0.5)

    x = np.arange(n)
    axes.plot(x, place(good).T, color=BLUE, lw=0.6, alpha=max(0.08, min(0.6, 20.0 / len(good))))
    for i, o in enumerate(objectives):
        axes.plot([i, i], [0, 1], color="black", lw=0.8, zorder=3)
        axes.text(i, 1.07, formula(sign[i] * high[i]), ha="center", va="bottom")
        axes.text(i, -0.07, formula(sign[i] * low[i]), ha="center", va="top")
        axes.text(i, -0.2, _two_lines(o), ha="center", va="top")
    legend_entry(axes, "design", color=BLUE, lw=0.6)
    if star is not None:
        y = place(star)
        axes.plot(x, y, **STAR | {"color": VERMILLION, "lw": 2, "ls": "-"}, label=CHOSEN)
        box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": VERMILLION, "lw": 0.5}
        for i in range(n):
            axes.text(i + 0.06, y[i], formula(star[i]), va="center", bbox=box, zorder=6)
    axes.annotate("", (-0.25, 0.2), (-0.25, 0.8), arrowprops={"arrowstyle": "<-", "lw": 0.8})
    axes.text(-0.29, 0.5, "better", rotation=90, ha="right", va="center")
    return f"{total} ({failed})" if failed else total


def _axis_label(o: Objective, scale: float) -> str:
    """Axis label in lines that fit a small panel, with the power of ten and the direction that is better."""
    label = _two_lines(o)
    if scale != 1.0:
        power = f"$10^{{{round(np.log10(scale))}}}$"
        label = label.removesuffix(f" ({o.unit})") + f" ({power} {o.unit}".rstrip() + ")"
    arrow = "better \N{RIGHTWARDS ARROW}" if o.maximise else "\N{LEFTWARDS ARROW} better"
    return f"{label}\n{arrow}"


def _two_lines(o: Objective) -> str:
    """An objective's label with its symbol and unit on a second line."""
    title = o.name.replace("_", " ")
    return f"{title}\n{o.label.removeprefix(title).strip()}"


def _scale(values: Array) -> float:
    """The power of ten to divide by, so that tick labels stay short; 1 for ordinary numbers."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest == 0.0 or 1e-3 <= largest < 1e5:
        return 1.0
    return float(10.0 ** np.floor(np.log10(largest)))
