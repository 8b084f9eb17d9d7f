"""The paper's figures that no other study draws: gait, shapes, states, waypoints, and the claims.

Sands are always given in the order soft, hard, regular, shapes in that of `footopt.foot.SHAPES`, so
that a sand or a shape has the same colour and dashes in every figure: soft sand blue, hard sand red
and dashed, regular sand green, as in the paper.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from footopt.errors import SettingError
from footopt.files.drawings import MM
from footopt.foot import Foot
from footopt.gait import LEFT
from footopt.report.body import legs
from footopt.report.figures.foot import ANKLE, contours
from footopt.report.figures.step import steps
from footopt.report.figures.traces import draw_traces, forces, power_work, walk_label
from footopt.report.style import (
    BLUE,
    COLUMN,
    GREY,
    PAGE,
    PALE,
    SANDS,
    SIDES,
    VERMILLION,
    Axes,
    legend_above,
    line,
    new_figure,
    styled,
)
from footopt.walk import Scene, Walk

Array = NDArray[np.float64]

STICKS = 12  # of a leg over one stride
HALF_FOOT = 0.13  # of a stick figure, m
PLATE = 0.08  # thickness of the drawn L, as a share of its contact length; only the line is simulated


def labelled(walks: Mapping[str, Walk]) -> dict[str, Walk]:
    """Walks of shapes by the names that a reader sees."""
    return {title(name): walk for name, walk in walks.items()}


def title(shape: str) -> str:
    """A shape's name as a reader sees it."""
    return "reversed L" if shape == "reversed_l" else shape.replace("_", " ")


@styled
def gait(scene: Scene) -> Figure:
    """Fig. 2b: the leg over a stride, and both ankles relative to the hip from standing to walking."""
    figure = new_figure(PAGE, 2.5)
    leg, path, time = figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.4))
    walker, t_f = scene.walker, scene.duration
    begin = scene.gait.heel_strike + scene.gait.period / 2.0  # the left foot's heel strike
    draw_leg(leg, scene, begin + scene.gait.period * np.arange(STICKS) / STICKS)
    t = np.linspace(0.0, t_f, 1200)
    pose = scene.gait.pose(t, walker.l1, walker.l2)
    for foot, (label, colour) in enumerate(SIDES):
        path.plot(pose.x[:, foot], pose.z[:, foot], **line(foot), label=label)
        path.plot(pose.x[0, foot], pose.z[0, foot], "o", color=colour)
        time.plot(t, pose.x[:, foot], **line(foot))
        time.plot(t, pose.z[:, foot] + walker.l1 + walker.l2, **line(foot), alpha=0.6, lw=0.8)
    for h in scene.gait.heel_strikes(t_f):
        time.axvline(h, color=GREY, lw=0.5, zorder=0)
    leg.set(xlabel="$x$ (m)", ylabel="$z$ (m), from the hip", aspect="equal", title="left leg, one stride")
    path.set(xlabel="$x$ (m)", ylabel="$z$ (m)", title="ankles from the hip (dots: standing)")
    time.set(xlabel="time $t$ (s)", ylabel="(m)", xlim=(0, t_f), title="thick: $x$; thin: $z + l_1 + l_2$")
    for axes in (leg, path, time):
        axes.xaxis.set_major_locator(MaxNLocator(4))
    legend_above(figure, *path.get_legend_handles_labels())
    return figure


def draw_leg(axes: Axes, scene: Scene, t: Array) -> None:
    """Stick figures of the left leg at times t (T,): hip, knee, ankle, and a foot of 2L."""
    joints = legs(scene, t, np.zeros((len(t), 2)))[:, LEFT]
    pitch, ankle = scene.gait.angles(t)[2][0][:, LEFT], joints[:, 2]
    along = HALF_FOOT * np.stack([np.cos(pitch), np.sin(pitch)], axis=1)
    axes.plot(*joints.transpose(2, 1, 0), color=GREY, lw=0.8)
    axes.plot(*np.stack([ankle - along, ankle + along]).transpose(2, 0, 1), color=BLUE, lw=1.0)
    axes.plot(*ankle.T, "o", color="black", ms=2.5, zorder=3)
    axes.plot(0.0, 0.0, "o", color="black", ms=5)


@styled
def shapes(feet: Mapping[str, Foot]) -> Figure:
    """Fig. 3: the five shapes with their contact lines, all of one length, and the ankle of each."""
    figure = new_figure(PAGE, 1.6)
    panels = figure.subplots(1, len(feet), sharex=True, sharey=True)
    for i, (axes, (name, foot)) in enumerate(zip(panels, feet.items(), strict=True)):
        outline = MM * _outline(name, foot.contour)
        axes.add_patch(Polygon(outline, closed=True, fc=PALE, ec=GREY, lw=0.6))
        axes.plot(*(MM * foot.contour).T, color=VERMILLION, lw=2, label="contact line")
        axes.plot(*(MM * np.array(foot.ankle)), **ANKLE, label="ankle")
        axes.set_title(f"{i + 1}: {title(name)}")
        axes.set(aspect="equal", xlabel="$x_p$ (mm)")
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.margins(0.06)
    panels[0].set_ylabel("$z_p$ (mm)")
    legend_above(figure, *panels[0].get_legend_handles_labels())
    return figure


def _outline(name: str, line: Array) -> Array:
    """The whole shape around its contact line; the L's thickness is for the eye only."""
    (left, low), (right, high) = line.min(axis=0), line.max(axis=0)
    if name in ("ellipse", "circle"):
        return np.concatenate([line, line[::-1] * [1.0, -1.0]])
    if name == "rectangle":
        return np.array([[left, low], [right, low], [right, -low], [left, -low]])
    if name == "reversed_triangle":
        return line
    thick = PLATE * np.hypot(*np.diff(line, axis=0).T).sum()
    corners = np.array([[left, low], [right, low], [right, high], [right - thick, high]])
    corners = np.concatenate([corners, [[right - thick, low + thick], [left, low + thick]]])
    upright_at_heel = line[0, 1] > line[-1, 1]
    return corners * [-1.0, 1.0] if upright_at_heel else corners


@styled
def states(walks: Mapping[str, Walk]) -> Figure:
    """Figs. 4a, 8a: the path of the COM, its forward and its vertical velocity, a row each."""
    figure = new_figure(COLUMN, 4.6)
    path, forward, upward = figure.subplots(3, 1)
    upward.sharex(forward)
    for i, (label, walk) in enumerate(walks.items()):
        path.plot(walk.com[:, 0], walk.com[:, 1], **line(i), label=walk_label(label, walk))
    draw_traces(forward, walks, "velocity", 0)
    draw_traces(upward, walks, "velocity", 1)
    end = max(walk.scene.duration for walk in walks.values())
    path.set(xlabel=r"$x_{\mathrm{COM}}$ (m)", ylabel=r"$z_{\mathrm{COM}}$ (m)")
    forward.set(ylabel="$V_x$ (m/s)", xlim=(0.0, end))
    forward.tick_params(labelbottom=False)
    upward.set(ylabel="$V_z$ (m/s)", xlabel="time $t$ (s)")
    figure.align_ylabels()
    handles, labels = path.get_legend_handles_labels()
    strike = Line2D([], [], color=GREY, lw=0.5)
    legend_above(figure, [*handles, strike], [*labels, "heel strike"])
    return figure


@styled
def waypoints(foot: Foot) -> Figure:
    """Fig. 5: the box, its levels, the waypoints and the spline through them.

    Parameters
    ----------
    foot : Foot
        A sole with a space of waypoints.

    Raises
    ------
    SettingError
        The sole has no waypoints.
    """
    space = foot.space
    if space is None or foot.k is None:
        raise SettingError("foot", foot.name, "a sole through waypoints: others have no scheme to draw")
    figure = new_figure(COLUMN, 1.55)
    axes = figure.subplots()
    length, height = MM * space.L, MM * space.H
    axes.add_patch(Rectangle((-length, -height), 2 * length, 2 * height, color=PALE, lw=0))
    levels = -height * np.arange(1, space.K + 1) / space.K
    axes.hlines(levels, -length, length, color="white", lw=0.5, zorder=1)
    x, z = MM * space.x, MM * space.heights(foot.k)[0]
    axes.plot(*(MM * foot.contour).T, color=BLUE, zorder=3, label="spline")
    axes.plot(x, z, "o", color=BLUE, mfc="white", zorder=4, label="waypoint $p_i$")
    for i in (0, 2, space.n - 1):
        name = {0: "1", space.n - 1: "n"}.get(i, "i")
        axes.annotate(rf"$p_{{{name}}}$", (x[i], z[i]), (0, 5), textcoords="offset points", ha="center")
    for place, where in (((1.25 * length, 0.0), "$x_p$"), ((0.0, 1.6 * height), "$z_p$")):
        arrow = {"arrowstyle": "->", "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", place, (0.0, 0.0), arrowprops=arrow, zorder=5)
        axes.annotate(where, place, (3, 3), textcoords="offset points")
    span = {"arrowstyle": "<->", "lw": 0.6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (-length, -1.3 * height), (length, -1.3 * height), arrowprops=span)
    axes.text(0.0, -1.35 * height, f"$2L$ = {2 * length:g} mm", ha="center", va="top")
    axes.annotate("", (-1.08 * length, -height), (-1.08 * length, height), arrowprops=span)
    axes.text(-1.1 * length, 0.0, f"$2H$ = {2 * height:g} mm", ha="right", va="center", rotation=90)
    axes.text(
        0.6 * length, 0.45 * height, f"{space.K} levels of\n$H/K$ = {height / space.K:g} mm", ha="center"
    )
    axes.set(xlim=(-1.35 * length, 1.4 * length), ylim=(-2.2 * height, 2.1 * height), aspect="equal")
    axes.set_axis_off()
    legend_above(figure, *axes.get_legend_handles_labels())
    return figure


#: What each figure shows; "claims" is the one of `claims`.
CAPTIONS = {
    "fig2b_gait": "The gait that drives the legs: thigh, knee and shank over time (the paper's figure 2b).",
    "fig3_shapes": "The five shapes with their contact lines and the ankle (figure 3).",
    "fig4a_shapes_states": "Position, height and speed of the COM over time, for each shape (figure 4a).",
    "fig4b_shapes_power_work": "Power and work of the sand over time, for each shape (figure 4b).",
    "fig5_waypoints": "The waypoints of a sole, their box, and the spline through them (figure 5).",
    "fig6_contours": "The best soles for soft, regular and hard sand (figure 6).",
    "fig7_steps": "A step on hard sand with force arrows along the sole: with its own best foot, and "
    "with that for regular sand (figure 7).",
    "fig8a_sands_states": "Position, height and speed of the COM on each sand, best foot (figure 8a).",
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
    by_shape = labelled(of_shapes)
    by_sand = {sand: optima[sand] for sand in SANDS}
    feet = {f"{sand} (hollow {MM * w.foot.hollow:.1f} mm)": w.foot for sand, w in by_sand.items()}
    on_hard_sand = {
        "hard sand, its own foot": optima["hard"],
        "hard sand, the foot for regular sand": crossed,
    }
    return {
        "fig2b_gait": gait(crossed.scene),
        "fig3_shapes": shapes({name: walk.foot for name, walk in of_shapes.items()}),
        "fig4a_shapes_states": states(by_shape),
        "fig4b_shapes_power_work": power_work(by_shape),
        "fig5_waypoints": waypoints(optima["hard"].foot),
        "fig6_contours": contours(feet),
        "fig7_steps": steps(on_hard_sand),
        "fig8a_sands_states": states(by_sand),
        "fig8b_sands_forces": forces(by_sand),
        "fig8c_sands_power_work": power_work(by_sand),
    }


@styled
def claims(entries: Sequence[Mapping[str, Any]]) -> Figure:
    """Every claim with the share of the sweep in which it holds, and the setting that decides it.

    Parameters
    ----------
    entries : sequence of dict
        The claims as in claims.json, by `says`, `holds_at_the_settings`, `share_of_sweep` (None: not swept)
        and `decides`.
    """
    figure = new_figure(PAGE, 0.6 + 0.17 * len(entries))
    axes = figure.subplots()
    for holds, colour, name in ((True, BLUE, "holds"), (False, VERMILLION, "does not hold")):
        mine = [i for i, entry in enumerate(entries) if entry["holds_at_the_settings"] is holds]
        shares = [entries[i]["share_of_sweep"] or 0.0 for i in mine]
        hatch = None if holds else "////"
        axes.barh(mine, shares, color=(colour, 0.35), ec=colour, lw=0.6, hatch=hatch)
        axes.plot([], [], "s", color=colour, mfc=(colour, 0.35), label=f"{name} at the settings")
    for i, entry in enumerate(entries):
        share = entry["share_of_sweep"]
        text = "not swept" if share is None else f"{100 * share:.0f} %"
        decides = entry["decides"] if 0.0 < (share or 0.0) < 1.0 else ""
        axes.text((share or 0.0) + 0.01, i, f"{text}  {decides}".rstrip(), va="center", fontsize=6.5)
    axes.set_yticks(range(len(entries)), [entry["says"] for entry in entries], fontsize=6.5)
    axes.set(ylim=(len(entries) - 0.4, -0.6), xlim=(0.0, 1.45), xlabel="share of the sweep in which it holds")
    axes.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0])
    axes.tick_params(axis="y", length=0)
    legend_above(figure, *axes.get_legend_handles_labels())
    return figure
