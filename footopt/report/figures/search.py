"""Figures of searches: convergence, and designs by pairs of their objectives."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from footopt.report import style
from footopt.report.style import Axes
from footopt.walk.objectives import Objective, lookup

FRONT = "designs on the front"
#: Designs that stand out among the others.
MARKS: dict[str, dict[str, Any]] = {
    "chosen": {"marker": "*", "ms": 11, "mfc": style.BEST, "color": style.BEST, "zorder": 6},
    "flat sole": {"marker": "s", "ms": 6, "mfc": style.FLAT, "color": style.FLAT, "zorder": 5},
}


@style.styled()
def convergence(result: Any, base: float | None = None) -> Figure:
    """The best value, or the hypervolume, and the population's median against the number of evaluations.

    They are those of a `footopt.design.SearchResult`, with the flat foot's value as `base` multiples of it.
    """
    figure = style.new_figure(style.COLUMN, 2.4)
    draw_convergence(figure.subplots(), result, base)
    style.legend_above(figure)
    return figure


def draw_convergence(axes: Axes, result: Any, base: float | None = None) -> None:
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
    groups: Mapping[str, ArrayLike], names: Sequence[str], marks: Mapping[str, ArrayLike] | None = None
) -> Figure:
    """Every pair of two or more objectives of designs; see `draw_pair`."""
    n = len(names)
    size = min(style.PAGE, 1.6 * n + 1.0)
    figure = style.new_figure(size, size if n > 2 else 0.75 * size)
    grid = figure.subplots(n - 1, n - 1, squeeze=False)
    for (row, column), axes in np.ndenumerate(grid):
        if column > row:
            axes.set_axis_off()
            continue
        draw_pair(axes, groups, names, marks, column, row + 1)
        axes.locator_params(nbins=3)
        axes.label_outer()
    figure.align_labels()
    style.legend_above(figure)
    return figure


def draw_pair(
    axes: Axes,
    groups: Mapping[str, ArrayLike],
    names: Sequence[str],
    marks: Mapping[str, ArrayLike] | None = None,
    x: int = 0,
    y: int = 1,
) -> None:
    """Two objectives, by column, of designs in groups (designs, objectives) by label.

    Designs that failed have NaN and are not drawn. `marks` are designs to point out, by name in `MARKS`.
    """
    objectives = lookup(names)
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
