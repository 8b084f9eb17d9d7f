"""An object as one drawing on matplotlib Axes (`plot`), or as its numbers beside its picture (`card`).

Kinds of objects are found by their class's name, so that a sand is drawn without loading the optimiser.
"""

from __future__ import annotations

import base64
import html
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from matplotlib.axes import Axes as PlainAxes
from matplotlib.figure import Figure

from footopt.errors import SettingError
from footopt.foot import Foot
from footopt.gait import Gait
from footopt.report.figures.foot import draw_contour, foot_height
from footopt.report.figures.gait import draw_angles, draw_path
from footopt.report.figures.sand import draw_stress
from footopt.report.figures.search import FRONT, draw_convergence, draw_parallel, history_label
from footopt.report.figures.traces import COMPONENTS, draw_components
from footopt.report.figures.walker import draw_scene, draw_walk, walk_height
from footopt.report.numbers import number, objective_quantity, percent, sand_title, title
from footopt.report.style import COLUMN, PAGE, Axes, new_figure, png, styled
from footopt.report.terminal import describe_foot, describe_outside, describe_scene, describe_search
from footopt.sand import Sand
from footopt.walk import FIVE, Scene, Table, Walk
from footopt.walk.validity import diagnose

RESOLUTION = 160  # dots per inch of a picture in a notebook

Facts = dict[str, str]  # numbers with units, by name


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


def card(thing: object) -> str:
    """HTML: an object's numbers beside its picture.

    Parameters
    ----------
    thing : Walk, Foot, Scene, Sand, Gait, Table or SearchResult
        What to show.

    Raises
    ------
    SettingError
        It cannot be drawn.
    """
    kind = _kind(thing)
    headline = html.escape(kind.title(thing))
    cell = 'style="text-align:left;padding:1px 8px 1px 0;vertical-align:top'
    facts = "".join(
        f'<tr><th {cell};font-weight:normal;white-space:nowrap">{html.escape(name)}</th>'
        f'<td {cell}">{html.escape(text)}</td></tr>'
        for name, text in kind.facts(thing).items()
    )
    figure = picture(thing, kind.rows or [list(drawings(thing))[:1]])
    image = base64.b64encode(png(figure, RESOLUTION)).decode("ascii")
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em 2em;align-items:flex-start">'
        f'<table style="font-size:90%;max-width:26em"><caption {cell};caption-side:top;font-weight:bold">'
        f"{headline}</caption>{facts}</table>"
        f'<img alt="{headline}" width="{round(96 * figure.get_figwidth())}" '
        'style="max-width:100%;height:auto;background:white" '
        f'src="data:image/png;base64,{image}"></div>'
    )


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


class Drawing(NamedTuple):
    """One way to draw an object on Axes, and the size that suits it, inches."""

    draw: Callable[[Axes, Any], object]
    width: float = COLUMN
    height: float | Callable[[Any], float] = 2.5

    def size(self, thing: object) -> tuple[float, float]:
        """Width and height for this object, inches."""
        return self.width, self.height(thing) if callable(self.height) else self.height


class Kind(NamedTuple):
    """Headline and facts of an object, its drawings by name, and their rows on a card."""

    title: Callable[[Any], str]
    facts: Callable[[Any], Facts]
    drawings: dict[str, Drawing]
    rows: Sequence[Sequence[str]] | None = None  # the first of them


def _kind(thing: object) -> Kind:
    """What is known of an object's class, or of one that it inherits from.

    Raises
    ------
    SettingError
        It cannot be drawn.
    """
    for kind in type(thing).__mro__:
        if kind.__name__ in KINDS:
            return KINDS[kind.__name__]
    raise SettingError("thing", thing, f"one of these: {', '.join(KINDS)}")


def drawings(thing: object) -> dict[str, Drawing]:
    """How an object can be drawn, by name, the default first; a `SettingError` if it cannot."""
    found = _kind(thing).drawings
    if "front" in found and thing.problem.n_obj == 1:  # type: ignore[attr-defined]  # a search
        return {"convergence": found["convergence"]}
    return found


def _sand_facts(sand: Sand) -> Facts:
    """Its scale, and how well it fits the table that it is from."""
    fit = {} if sand.fit_error is None else {"misfit (x, z)": ", ".join(map(percent, sand.fit_error))}
    return {"zeta": number(sand.zeta)} | fit


def _gait_facts(gait: Gait) -> Facts:
    """Its timing, how well it fits its file, and where it comes from."""
    found = {"stride": f"{gait.period:g} s", "begins to move at": f"{gait.start:g} s"}
    found |= {f"misfit of the {joint} (rms)": f"{value:.2g}°" for joint, value in gait.residual}
    return found | ({"source": gait.source} if gait.source else {})


def _scene_facts(scene: Scene) -> Facts:
    """What is walked through."""
    w = scene.walker
    return {
        "sand": describe_scene(scene),
        "gait": f"{scene.gait.name}, {scene.duration:g} s",
        "walker": f"{w.mass:g} kg, legs {w.l1:g} + {w.l2:g} m",
    }


def _walk_facts(walk: Walk) -> Facts:
    """Its objectives, and what is to be thought of them."""
    values = walk.objectives
    found = {title(name): objective_quantity(name, values[name]) for name in (*FIVE, "efficiency")}
    if not walk.feasible:
        found = {"failed": f"{walk.reason}, after {len(walk.t)} steps of time"}
    found |= {"sand": describe_scene(walk.scene), "accuracy": walk.accuracy.name}
    outside = "; ".join(describe_outside(d) for d in diagnose(walk) if d.outside)
    return found | ({"warning": outside} if outside else {})


def _table_facts(table: Table) -> Facts:
    """How many walked, and the range of each objective."""
    failed = Counter(map(str, table.reasons[~table.feasible]))
    found = {"walked": f"{int(table.feasible.sum())} of {len(table)}"}
    found |= {f"failed: {reason}": str(count) for reason, count in failed.most_common()}
    for name, column in zip(table.names, table.values[table.feasible].T, strict=True):
        if len(column):
            found[title(name)] = f"{number(column.min())} to {objective_quantity(name, column.max())}"
    return found | {"sand": describe_scene(table.scene)}


def _search_facts(result: Any) -> Facts:
    """What was searched, and what was found."""
    problem = result.problem
    found = {"sand": describe_scene(problem.scene), "search": describe_search(result)}
    if hasattr(problem, "scenarios"):
        found["judged by"] = f"{problem.measure} of {len(problem.scenarios)} scenarios"
    found["best" if problem.n_obj == 1 else problem.choice.by] = describe_foot(result.foot)
    best = zip(problem.record, result.values[result.best], strict=True)
    return found | {title(name): objective_quantity(name, value) for name, value in best}


def _foot_facts(foot: Foot) -> Facts:
    """Its shape and its width."""
    return {"sole": describe_foot(foot), "width": f"{1e3 * foot.width:g} mm"}


def _draw_front(axes: Axes, result: Any) -> None:
    """The designs of the front, an axis for each objective; the chosen one stands out."""
    columns = [result.problem.record.index(name) for name in result.problem.names]
    values = result.values[:, columns]
    draw_parallel(axes, values[result.shown], result.problem.names, {"chosen": values[result.best]}, FRONT)


KINDS: dict[str, Kind] = {
    "Foot": Kind(lambda foot: foot.name, _foot_facts, {"foot": Drawing(draw_contour, COLUMN, foot_height)}),
    "Gait": Kind(
        lambda gait: f"{gait.name} gait",
        _gait_facts,
        {"angles": Drawing(draw_angles), "path": Drawing(draw_path)},
        [["angles", "path"]],
    ),
    "Sand": Kind(
        lambda sand: f"{sand.name} sand",
        _sand_facts,
        {name: Drawing(partial(draw_stress, component=name), COLUMN, 2.8) for name in ("alpha_z", "alpha_x")},
        [["alpha_x", "alpha_z"]],
    ),
    "Scene": Kind(
        lambda scene: f"a walk on {scene.sand.name} sand",
        _scene_facts,
        {"scene": Drawing(draw_scene, 4.5, 2.8)},
    ),
    "SearchResult": Kind(
        lambda result: f"search on {result.problem.scene.sand.name} sand",
        _search_facts,
        {
            "front": Drawing(_draw_front, PAGE, 2.6),
            "convergence": Drawing(
                lambda axes, r: draw_convergence(axes, r.history, history_label(r.problem.names))
            ),
        },
    ),
    "Table": Kind(
        lambda table: f"{len(table)} feet",
        _table_facts,
        {"table": Drawing(lambda axes, t: draw_parallel(axes, t.values, t.names), PAGE, 2.6)},
    ),
    "Walk": Kind(
        lambda walk: f"{title(walk.foot.name)} on {sand_title(walk.scene.sand)}",
        _walk_facts,
        {
            "walk": Drawing(draw_walk, PAGE, walk_height),
            **{name: Drawing(partial(draw_components, name=name)) for name in COMPONENTS},
        },
        [["walk"], ["force", "power"]],
    ),
}
