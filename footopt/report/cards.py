"""Cards: HTML with an object's numbers beside its picture, as notebooks show it."""

from __future__ import annotations

import base64
import html
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from footopt.effects import name_of
from footopt.foot import Foot
from footopt.foot.waypoints import written
from footopt.gait import Gait
from footopt.report.numbers import number, objective_quantity, percent, quantity, title
from footopt.report.plot import RESOLUTION, drawings, picture
from footopt.report.style import png
from footopt.sand import Sand
from footopt.sand.law import PER_CM3, alpha
from footopt.walk import FIVE, MEASURES, Scene, Table, Walk
from footopt.walk.audit import parameters
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
    """Its scale, and the stresses that one would measure with a plate."""
    beta, gamma = np.radians([0.0, 0.0, 90.0]), np.radians([90.0, -90.0, 0.0])
    x, z = (sand.zeta * part / PER_CM3 for part in alpha(beta, gamma, sand.stress_map))
    found = {
        "zeta": number(sand.zeta),
        "level plate pushed down": quantity(z[0], "N/cm³"),
        "level plate lifted": quantity(z[1], "N/cm³"),
        "upright plate pushed ahead": quantity(x[2], "N/cm³"),
    }
    if sand.fit_error is not None:
        found["misfit of the table (x, z)"] = ", ".join(map(percent, sand.fit_error))
    return found


def gait_facts(gait: Gait) -> Facts:
    """Its timing and where it comes from."""
    found = {
        "stride": f"{gait.period:g} s",
        "begins to move at": f"{gait.start:g} s",
        "foot turns": "with the shank" if gait.pitch == "shank" else "as measured",
    }
    found |= {f"misfit of the {joint} (rms)": f"{value:.2g}°" for joint, value in gait.residual}
    return found | ({"source": gait.source} if gait.source else {})


def foot_facts(foot: Foot) -> Facts:
    """Its measures."""
    long, high = 1e3 * np.ptp(foot.contour, axis=0)
    found = {} if foot.k is None else {"heights k": written(foot.k)}
    found |= {
        "length x height": f"{long:.1f} x {high:.1f} mm",
        "width": f"{1e3 * foot.width:g} mm",
        "ankle (x, z)": ", ".join(f"{1e3 * v:g}" for v in foot.ankle) + " mm",
        "hollow": f"{1e3 * foot.hollow:.1f} mm",
    }
    if foot.box_violation is not None:
        found["outside its box by"] = f"{1e3 * foot.box_violation:.2f} mm"
    return found | ({"feels the sand": "with its sides and top too"} if foot.closed else {})


def scene_facts(scene: Scene) -> Facts:
    """What is walked through."""
    w = scene.walker
    found = {
        "sand": f"{scene.sand.name} (zeta {number(scene.sand.zeta)})",
        "gait": f"{scene.gait.name}, a stride in {scene.gait.period:g} s",
        "walker": f"{w.mass:g} kg, legs {w.l1:g} + {w.l2:g} m",
        "gravity": f"{w.g:g} m/s²",
        "lasts": f"{scene.duration:g} s",
    }
    for effect in scene.effects:
        values = ", ".join(f"{name} {value}" for name, value in parameters(effect).items())
        found[name_of(effect).replace("_", " ")] = values or "on"
    return found if scene.effects else found | {"effects": "none beyond the plain law"}


def walk_facts(walk: Walk) -> Facts:
    """Its objectives, and what is to be thought of them."""
    if walk.feasible:
        values = walk.objectives
        found = {title(name): objective_quantity(name, values[name]) for name in (*FIVE, "efficiency")}
    else:
        found = {"failed": f"{walk.reason}, after {len(walk.t)} steps of time"}
    sand = walk.scene.sand
    found |= {"foot": walk.foot.name, "sand": f"{sand.name} (zeta {number(sand.zeta)})"}
    if walk.scene.effects:
        found["effects"] = ", ".join(name_of(effect).replace("_", " ") for effect in walk.scene.effects)
    found["accuracy"] = walk.accuracy.name
    outside = (d for d in diagnose(walk) if d.outside)
    return found | {f"warning: {d.name}": f"{quantity(d.value, d.unit)}: {d.why}" for d in outside}


def table_facts(table: Table) -> Facts:
    """How many walked, and the range of each objective."""
    failed = Counter(map(str, table.reasons[~table.feasible]))
    found = {"feet": str(len(table)), "walked": str(int(table.feasible.sum()))}
    found |= {f"failed: {reason}": str(count) for reason, count in failed.most_common()}
    for name, column in zip(table.names, table.values[table.feasible].T, strict=True):
        if len(column):
            low, middle, high = (number(v) for v in (column.min(), np.median(column), column.max()))
            found[title(name)] = f"{low} to {high} {MEASURES[name].unit}".rstrip() + f", median {middle}"
    return found | {"sand": table.scene.sand.name}


def search_facts(result: Any) -> Facts:
    """What was searched, and what was found."""
    problem = result.problem
    found = {
        "searched": f"{problem.space.K}^{problem.space.n} soles for {', '.join(map(title, problem.names))}",
        "sand": problem.scene.sand.name,
        "solver": f"{result.solver.name}, seed {result.solver.seed}",
        "evaluations": f"{result.evaluations} of {result.designs} designs in {result.seconds:.1f} s",
    }
    if hasattr(problem, "scenarios"):
        found["judged by"] = f"{problem.measure} of {len(problem.scenarios)} scenarios"
    if result.infeasible:
        reasons = ", ".join(f"{count} {reason}" for reason, count in result.failures.items())
        found["infeasible"] = f"{result.infeasible} ({reasons})"
    if problem.n_obj > 1:
        found["on the front"] = str(len(result.front))
    which = "best k" if problem.n_obj == 1 else f"chosen k ({problem.choice.by})"
    found[which] = written(result.k[result.best])
    best = zip(problem.record, result.values[result.best], strict=True)
    return found | {title(name): objective_quantity(name, value) for name, value in best}


class Card(NamedTuple):
    """Headline and facts of an object, and the drawings of its picture, row by row; by default the first."""

    title: Callable[[Any], str]
    facts: Callable[[Any], Facts]
    rows: list[list[str]] | None = None


#: Cards by the name of a class.
CARDS: dict[str, Card] = {
    "Foot": Card(lambda foot: foot.name, foot_facts),
    "Gait": Card(lambda gait: f"{gait.name} gait", gait_facts, [["angles", "path"]]),
    "Sand": Card(lambda sand: f"{sand.name} sand", sand_facts, [["alpha_x", "alpha_z"]]),
    "Scene": Card(lambda scene: f"a walk on {scene.sand.name} sand", scene_facts),
    "SearchResult": Card(lambda result: f"search on {result.problem.scene.sand.name} sand", search_facts),
    "Table": Card(lambda table: f"{len(table)} feet", table_facts),
    "Walk": Card(
        lambda walk: f"{walk.foot.name} on {walk.scene.sand.name} sand",
        walk_facts,
        [["walk"], ["force", "power"]],
    ),
}
