"""Cards: HTML with an object's numbers beside its picture, as notebooks show it."""

from __future__ import annotations

import base64
import html
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from footopt.foot import Foot
from footopt.gait import Gait
from footopt.report.numbers import number, objective_quantity, percent, sand_title, title
from footopt.report.plot import RESOLUTION, drawings, picture
from footopt.report.style import png
from footopt.report.terminal import describe_foot, describe_outside, describe_scene, describe_search
from footopt.sand import Sand
from footopt.walk import FIVE, Scene, Table, Walk
from footopt.walk.validity import diagnose

Facts = dict[str, str]  # numbers with units, by name


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
    names = list(drawings(thing))
    content = next(CARDS[kind.__name__] for kind in type(thing).__mro__ if kind.__name__ in CARDS)
    headline = html.escape(content.title(thing))
    cell = 'style="text-align:left;padding:1px 8px 1px 0;vertical-align:top'
    facts = "".join(
        f'<tr><th {cell};font-weight:normal;white-space:nowrap">{html.escape(name)}</th>'
        f'<td {cell}">{html.escape(text)}</td></tr>'
        for name, text in content.facts(thing).items()
    )
    figure = picture(thing, content.rows or [names[:1]])
    image = base64.b64encode(png(figure, RESOLUTION)).decode("ascii")
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em 2em;align-items:flex-start">'
        f'<table style="font-size:90%;max-width:26em"><caption {cell};caption-side:top;font-weight:bold">'
        f"{headline}</caption>{facts}</table>"
        f'<img alt="{headline}" width="{round(96 * figure.get_figwidth())}" '
        'style="max-width:100%;height:auto;background:white" '
        f'src="data:image/png;base64,{image}"></div>'
    )


def sand_facts(sand: Sand) -> Facts:
    """Its scale, and how well it fits the table that it is from."""
    fit = {} if sand.fit_error is None else {"misfit (x, z)": ", ".join(map(percent, sand.fit_error))}
    return {"zeta": number(sand.zeta)} | fit


def gait_facts(gait: Gait) -> Facts:
    """Its timing, how well it fits its file, and where it comes from."""
    found = {"stride": f"{gait.period:g} s", "begins to move at": f"{gait.start:g} s"}
    found |= {f"misfit of the {joint} (rms)": f"{value:.2g}°" for joint, value in gait.residual}
    return found | ({"source": gait.source} if gait.source else {})


def scene_facts(scene: Scene) -> Facts:
    """What is walked through."""
    w = scene.walker
    return {
        "sand": describe_scene(scene),
        "gait": f"{scene.gait.name}, {scene.duration:g} s",
        "walker": f"{w.mass:g} kg, legs {w.l1:g} + {w.l2:g} m",
    }


def walk_facts(walk: Walk) -> Facts:
    """Its objectives, and what is to be thought of them."""
    values = walk.objectives
    found = {title(name): objective_quantity(name, values[name]) for name in (*FIVE, "efficiency")}
    if not walk.feasible:
        found = {"failed": f"{walk.reason}, after {len(walk.t)} steps of time"}
    found |= {"sand": describe_scene(walk.scene), "accuracy": walk.accuracy.name}
    outside = "; ".join(describe_outside(d) for d in diagnose(walk) if d.outside)
    return found | ({"warning": outside} if outside else {})


def table_facts(table: Table) -> Facts:
    """How many walked, and the range of each objective."""
    failed = Counter(map(str, table.reasons[~table.feasible]))
    found = {"walked": f"{int(table.feasible.sum())} of {len(table)}"}
    found |= {f"failed: {reason}": str(count) for reason, count in failed.most_common()}
    for name, column in zip(table.names, table.values[table.feasible].T, strict=True):
        if len(column):
            found[title(name)] = f"{number(column.min())} to {objective_quantity(name, column.max())}"
    return found | {"sand": describe_scene(table.scene)}


def search_facts(result: Any) -> Facts:
    """What was searched, and what was found."""
    problem = result.problem
    found = {"sand": describe_scene(problem.scene), "search": describe_search(result)}
    if hasattr(problem, "scenarios"):
        found["judged by"] = f"{problem.measure} of {len(problem.scenarios)} scenarios"
    found["best" if problem.n_obj == 1 else problem.choice.by] = describe_foot(result.foot)
    best = zip(problem.record, result.values[result.best], strict=True)
    return found | {title(name): objective_quantity(name, value) for name, value in best}


def foot_facts(foot: Foot) -> Facts:
    """Its shape and its width."""
    return {"sole": describe_foot(foot), "width": f"{1e3 * foot.width:g} mm"}


class Card(NamedTuple):
    """Headline and facts of an object, and the drawings of its picture, row by row; by default the first."""

    title: Callable[[Any], str]
    facts: Callable[[Any], Facts]
    rows: Sequence[Sequence[str]] | None = None


#: Cards by the name of a class.
CARDS: dict[str, Card] = {
    "Foot": Card(lambda foot: foot.name, foot_facts),
    "Gait": Card(lambda gait: f"{gait.name} gait", gait_facts, [["angles", "path"]]),
    "Sand": Card(lambda sand: f"{sand.name} sand", sand_facts, [["alpha_x", "alpha_z"]]),
    "Scene": Card(lambda scene: f"a walk on {scene.sand.name} sand", scene_facts),
    "SearchResult": Card(lambda result: f"search on {result.problem.scene.sand.name} sand", search_facts),
    "Table": Card(lambda table: f"{len(table)} feet", table_facts),
    "Walk": Card(
        lambda walk: f"{title(walk.foot.name)} on {sand_title(walk.scene.sand)}",
        walk_facts,
        [["walk"], ["force", "power"]],
    ),
}
