"""`plot`: an object drawn on matplotlib Axes.

Kinds of objects are found by their class's name, so that a sand is drawn without loading the optimiser.
"""

import io
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes as PlainAxes

from footopt.errors import SettingError, check
from footopt.report.figures.scenes import draw_angles, draw_contour, draw_path, draw_stress
from footopt.report.figures.walks import QUANTITIES, draw_convergence, draw_pair, draw_quantity
from footopt.report.stage import draw_walk
from footopt.report.style import COLUMN, PAGE, Axes, fit_height, new_figure, styled
from footopt.walk.objectives import lookup

HEIGHT = 2.6  # of a picture, inches


def plot(thing: object, what: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw an object on matplotlib Axes.

    Parameters
    ----------
    thing : Walk, Foot, Scene, Sand, Gait, Table or SearchResult
        The object.
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
    check(name in found, "what", what, f"one of {', '.join(found)} for a {type(thing).__name__}")
    if ax is not None:
        _draw(ax, found[name], thing)
        return ax
    with styled():
        figure = new_figure(PAGE if name == "walk" else COLUMN, HEIGHT)
        ax = figure.add_subplot(axes_class=Panel)
        _draw(ax, found[name], thing)
        fit_height(figure, [ax])
        figure.set_layout_engine("constrained")  # for what the caller adds
    return ax


class Panel(PlainAxes):
    """Axes that a notebook shows with their figure, which pyplot does not know of."""

    @styled()
    def _repr_png_(self) -> bytes:
        figure: Any = self.get_figure(root=True)
        file = io.BytesIO()
        figure.savefig(file, format="png")
        return file.getvalue()


def _draw(axes: Axes, draw: Callable[[Axes, Any], object], thing: object) -> None:
    """Draw an object, with a legend above the axes if anything has a name."""
    draw(axes, thing)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)


Drawings = dict[str, Callable[[Axes, Any], object]]


def drawings(thing: Any) -> Drawings:
    """The drawings of an object by name, the default first; a `SettingError` if there are none."""
    for kind in type(thing).__mro__:
        if found := DRAWINGS.get(kind.__name__):
            several = kind.__name__ != "SearchResult" or thing.problem.n_obj > 1
            return {name: draw for name, draw in found.items() if several or name != "front"}
    raise SettingError("thing", thing, f"one of these: {', '.join(DRAWINGS)}")


def _draw_front(axes: Axes, result: Any) -> None:
    """The designs of the front by the first two objectives; the chosen one stands out."""
    values = np.stack([result.column(name) for name in result.problem.names], axis=1)
    front, chosen = {"designs on the front": values[result.shown]}, {"chosen": values[result.best]}
    draw_pair(axes, front, result.problem.objectives, chosen)


def _draw_table(axes: Axes, table: Any) -> None:
    """The designs of a table by its first two objectives."""
    check(len(table.names) > 1, "thing", table, "a Table of two objectives or more")
    draw_pair(axes, {"designs": table.values}, lookup(table.names))


DRAWINGS: dict[str, Drawings] = {
    "Foot": {"foot": draw_contour},
    "Gait": {"angles": draw_angles, "path": draw_path},
    "Sand": {name: partial(draw_stress, component=name) for name in ("alpha_z", "alpha_x")},
    "Scene": {"sand": lambda axes, scene: draw_stress(axes, scene.sand)},
    "SearchResult": {"front": _draw_front, "convergence": draw_convergence},
    "Table": {"table": _draw_table},
    "Walk": {"walk": draw_walk, **{name: partial(draw_quantity, name=name) for name in QUANTITIES}},
}
