"""`plot`: one drawing of an object on matplotlib Axes, and pictures of several drawings.

Drawings are found by the class's name, so that a sand is drawn without loading the optimiser.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from matplotlib.axes import Axes as PlainAxes
from matplotlib.figure import Figure

from footopt.errors import SettingError
from footopt.report.figures.foot import draw_contour, foot_height
from footopt.report.figures.gait import draw_angles, draw_path
from footopt.report.figures.sand import draw_stress
from footopt.report.figures.search import FRONT, draw_convergence, draw_parallel, history_label
from footopt.report.figures.traces import COMPONENTS, draw_components
from footopt.report.figures.walker import draw_scene, draw_walk, walk_height
from footopt.report.style import COLUMN, PAGE, Axes, new_figure, png, styled

RESOLUTION = 160  # dots per inch of a picture in a notebook


def plot(thing: object, what: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw an object on matplotlib Axes.

    Parameters
    ----------
    thing : Walk, Foot, Scene, Sand, Gait, Table or SearchResult
        What to draw.
    what : str, optional
        Of a walk: walk, com, velocity, force, power or work. Of a sand: alpha_z or alpha_x. Of a gait:
        angles or path. Of a search: front or convergence. By default the first of them.
    ax : matplotlib.axes.Axes, optional
        Where to draw. By default Axes of a new figure, which a notebook shows.

    Returns
    -------
    matplotlib.axes.Axes
        ``.figure.savefig("walk.png")`` keeps the picture.

    Raises
    ------
    SettingError
        There is no such drawing of the object, or no drawing at all.
    """
    found = drawings(thing)
    name = next(iter(found)) if what is None else what
    if name not in found:
        raise SettingError("what", what, f"one of {', '.join(found)} for a {type(thing).__name__}")
    if ax is None:
        return picture(thing, [[name]]).axes[0]
    found[name].draw(ax, thing)
    if ax.get_legend_handles_labels()[0] and ax.get_legend() is None:
        ax.legend(loc="best")
    return ax


class Drawing(NamedTuple):
    """One way to draw an object on Axes, and the size that suits it, inches."""

    draw: Callable[[Axes, Any], object]
    width: float = COLUMN
    height: float | Callable[[Any], float] = 2.5

    def size(self, thing: object) -> tuple[float, float]:
        """Width and height for this object, inches."""
        return self.width, self.height(thing) if callable(self.height) else self.height


def drawings(thing: object) -> dict[str, Drawing]:
    """How an object can be drawn, by name, the default first: by its class, or one that it inherits from.

    Raises
    ------
    SettingError
        It cannot be drawn.
    """
    for kind in type(thing).__mro__:
        if kind.__name__ in DRAWINGS:
            found = DRAWINGS[kind.__name__]
            if "front" in found and thing.problem.n_obj == 1:  # type: ignore[attr-defined]  # a search
                return {"convergence": found["convergence"]}
            return found
    raise SettingError("thing", thing, f"one of these: {', '.join(DRAWINGS)}")


def _draw_front(axes: Axes, result: Any) -> None:
    """The designs of the front, an axis for each objective; the chosen one stands out."""
    columns = [result.problem.record.index(name) for name in result.problem.names]
    values = result.values[:, columns]
    draw_parallel(axes, values[result.shown], result.problem.names, {"chosen": values[result.best]}, FRONT)


DRAWINGS: dict[str, dict[str, Drawing]] = {
    "Walk": {
        "walk": Drawing(draw_walk, PAGE, walk_height),
        **{name: Drawing(partial(draw_components, name=name)) for name in COMPONENTS},
    },
    "Foot": {"foot": Drawing(draw_contour, COLUMN, foot_height)},
    "Scene": {"scene": Drawing(draw_scene, 4.5, 2.8)},
    "Sand": {
        name: Drawing(partial(draw_stress, component=name), COLUMN, 2.8) for name in ("alpha_z", "alpha_x")
    },
    "Gait": {"angles": Drawing(draw_angles), "path": Drawing(draw_path)},
    "Table": {"table": Drawing(lambda axes, t: draw_parallel(axes, t.values, t.names), PAGE, 2.6)},
    "SearchResult": {
        "front": Drawing(_draw_front, PAGE, 2.6),
        "convergence": Drawing(
            lambda axes, r: draw_convergence(axes, r.history, history_label(r.problem.names))
        ),
    },
}


class Panel(PlainAxes):
    """Axes that a notebook shows with their figure, which pyplot does not know of."""

    def _repr_png_(self) -> bytes:
        return png(self.get_figure(), RESOLUTION)  # type: ignore[arg-type]  # no subfigures here


@styled
def picture(thing: object, rows: Sequence[Sequence[str]]) -> Figure:
    """A figure of an object's drawings by name, row by row."""
    found = drawings(thing)
    sizes = [[found[name].size(thing) for name in row] for row in rows]
    heights = [max(height for _, height in row) for row in sizes]
    figure = new_figure(max(sum(width for width, _ in row) for row in sizes), sum(heights))
    grid, made = figure.add_gridspec(len(rows), 1, height_ratios=heights), []
    for i, row in enumerate(rows):
        parts = grid[i].subgridspec(1, len(row), width_ratios=[width for width, _ in sizes[i]])
        for j, name in enumerate(row):
            axes = figure.add_subplot(parts[j], axes_class=Panel)
            found[name].draw(axes, thing)
            made.append(axes)
    for axes in made:
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="best")
    figure.draw_without_rendering()  # a second pass of the layout, after which nothing moves
    return figure
