"""The paper's figures: gait, shapes, waypoints, walks by shape and by sand, and the claims.

Sands are always given in the order soft, hard, regular, shapes in that of `footopt.foot.SHAPES`, so
that a sand or a shape has the same colour and dashes in every figure.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from footopt.files.drawings import MM
from footopt.gait import Gait
from footopt.report.figures.foot import contour, contours
from footopt.report.figures.gait import draw_angles, draw_path
from footopt.report.figures.heat_map import draw_heat_map
from footopt.report.figures.stability import VERDICTS
from footopt.report.figures.step import steps
from footopt.report.figures.traces import com, forces, power_work
from footopt.report.numbers import title
from footopt.report.style import (
    PAGE,
    SANDS,
    legend_above,
    new_figure,
    styled,
)
from footopt.walk import Walk, Walker


@styled
def gait(shown: Gait, walker: Walker) -> Figure:
    """Fig. 2b: the joint angles over a stride, and the ankle's path around the hip."""
    figure = new_figure(PAGE, 2.5)
    angles, path = figure.subplots(1, 2)
    draw_angles(angles, shown)
    draw_path(path, shown, walker)
    legend_above(figure)
    return figure


#: What each figure shows; "claims" is the one of `claims`.
CAPTIONS = {
    "fig2b_gait": "The gait that drives the legs: thigh and knee over a stride, and the ankle's path around "
    "the hip (the paper's figure 2b).",
    "fig3_shapes": "The contact lines of the five shapes, all of one length (figure 3).",
    "fig4a_shapes_states": "Position and velocity of the COM over time, for each shape (figure 4a).",
    "fig4b_shapes_power_work": "Power and work of the sand over time, for each shape (figure 4b).",
    "fig5_waypoints": "The waypoints of a sole, their box, and the spline through them (figure 5).",
    "fig6_contours": "The best soles for soft, regular and hard sand (figure 6).",
    "fig7_steps": "A step on hard sand with force arrows along the sole: with its own best foot, and "
    "with that for regular sand (figure 7).",
    "fig8a_sands_states": "Position and velocity of the COM on each sand, best foot (figure 8a).",
    "fig8b_sands_forces": "Vertical and forward force of each foot on each sand (figure 8b).",
    "fig8c_sands_power_work": "Power and work on each sand, best foot (figure 8c).",
    "claims": "Every claim: whether it holds at the settings, and with each open choice made otherwise.",
}


def all_figures(
    of_shapes: Mapping[str, Walk], optima: Mapping[str, Walk], crossed: Walk
) -> dict[str, Figure]:
    """The paper's figures by file name.

    Parameters
    ----------
    of_shapes : dict of Walk
        Walks of the five shapes, by name.
    optima : dict of Walk
        Walks of the best foot of each sand, by sand.
    crossed : Walk
        The best foot for regular sand, on hard sand.
    """
    by_shape = {title(name): walk for name, walk in of_shapes.items()}
    by_sand = {sand: optima[sand] for sand in SANDS}
    feet = {f"{sand} (hollow {MM * w.foot.hollow:.1f} mm)": w.foot for sand, w in by_sand.items()}
    on_hard_sand = {
        "hard sand, its own foot": optima["hard"],
        "hard sand, the foot for regular sand": crossed,
    }
    return {
        "fig2b_gait": gait(crossed.scene.gait, crossed.scene.walker),
        "fig3_shapes": contours({name: walk.foot for name, walk in by_shape.items()}),
        "fig4a_shapes_states": com(by_shape),
        "fig4b_shapes_power_work": power_work(by_shape),
        "fig5_waypoints": contour(optima["hard"].foot),
        "fig6_contours": contours(feet),
        "fig7_steps": steps(on_hard_sand),
        "fig8a_sands_states": com(by_sand),
        "fig8b_sands_forces": forces(by_sand),
        "fig8c_sands_power_work": power_work(by_sand),
    }


@styled
def claims(entries: Sequence[Mapping[str, Any]]) -> Figure:
    """Every claim, and whether it holds at the settings and with each open choice made otherwise.

    Parameters
    ----------
    entries : sequence of dict
        The claims as in result.json, by `says`, `margin` and `changed`; a margin that is None is white.
    """
    figure = new_figure(PAGE, 1.6 + 0.17 * len(entries))
    axes = figure.subplots()
    columns = ["the settings", *entries[0]["changed"]]
    margins = np.array([[e["margin"], *e["changed"].values()] for e in entries], float)
    holds = np.where(np.isfinite(margins), margins > 0.0, np.nan)
    blank = [[""] * len(columns)] * len(entries)
    names = [entry["says"] for entry in entries]
    draw_heat_map(axes, holds, names, columns, blank, Normalize(0.0, 1.0), VERDICTS)
    axes.tick_params(axis="x", rotation=90)
    axes.tick_params(axis="y", labelsize=7)
    figure.supxlabel("blue: the claim holds; orange: it does not")
    return figure
