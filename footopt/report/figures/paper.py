"""The paper's figures: gait, shapes, waypoints, walks by shape and by sand, and the claims.

Sands are always given in the order soft, hard, regular, shapes in that of `footopt.foot.SHAPES`, so
that a sand or a shape has the same colour and dashes in every figure.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from footopt.files.drawings import MM
from footopt.gait import Gait
from footopt.report.figures.foot import contour, contours
from footopt.report.figures.gait import draw_angles, draw_path
from footopt.report.figures.step import steps
from footopt.report.figures.traces import com, forces, power_work
from footopt.report.labels import label_all
from footopt.report.numbers import title
from footopt.report.style import PAGE, SANDS, VERDICTS, new_figure, styled
from footopt.walk import Walk, Walker


@styled
def gait(shown: Gait, walker: Walker) -> Figure:
    """Fig. 2b: the joint angles over a stride, and the ankle's path around the hip."""
    figure = new_figure(PAGE, 2.5)
    angles, path = figure.subplots(1, 2)
    draw_angles(angles, shown)
    draw_path(path, shown, walker)
    label_all(angles)
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
    "claims": "Every claim: whether it holds at the settings, and in which share of the combinations.",
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
    """Every claim with the share of the sweep in which it holds, and the setting that decides it.

    Parameters
    ----------
    entries : sequence of dict
        The claims as in result.json, by `says`, `holds_at_the_settings`, `share_of_sweep` (None: not swept)
        and `decides`.
    """
    figure = new_figure(PAGE, 0.6 + 0.17 * len(entries))
    axes = figure.subplots()
    shares = [entry["share_of_sweep"] for entry in entries]
    axes.barh(range(len(entries)), [share or 0.0 for share in shares], color="0.8")
    for i, (entry, share) in enumerate(zip(entries, shares, strict=True)):
        text = "not swept" if share is None else f"{100 * share:.0f} %"
        decides = entry["decides"] if 0.0 < (share or 0.0) < 1.0 else ""
        axes.text((share or 0.0) + 0.01, i, f"{text}  {decides}".rstrip(), va="center", fontsize=7)
    for holds, name, (colour, mark) in zip((True, False), ("holds", "does not hold"), VERDICTS, strict=False):
        mine = [i for i, entry in enumerate(entries) if entry["holds_at_the_settings"] is holds]
        look: dict[str, Any] = {"color": colour, "marker": mark, "mew": 0, "ls": "", "clip_on": False}
        axes.plot([-0.03] * len(mine), mine, **look, label=f"{name} at the settings")
    axes.set_yticks(range(len(entries)), [entry["says"] for entry in entries], fontsize=7)
    axes.set(ylim=(len(entries) - 0.4, -0.6), xlim=(-0.06, 1.4))
    axes.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0 %", "25 %", "50 %", "75 %", "100 %"])
    settings = "at the settings: ● holds, ✖ does not"
    axes.set_xlabel(f"share of the sweep in which it holds, and the setting that decides\n{settings}", x=0.4)
    axes.tick_params(axis="y", length=0)
    axes.spines["bottom"].set_bounds(0.0, 1.0)
    axes.spines["left"].set_visible(False)
    return figure
