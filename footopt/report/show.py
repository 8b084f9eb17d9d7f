"""`plot`, a drawing of an object on one Axes; and the card with numbers and a picture that a notebook shows.

Views are found by the class's name, so that a sand is drawn without loading the optimiser.
"""

from __future__ import annotations

import base64
import html
import io
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes as PlainAxes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from footopt.effects import Layers, Patches, Slope, name_of
from footopt.errors import SettingError
from footopt.foot import Foot
from footopt.gait import Gait
from footopt.gait.gait import ankle
from footopt.report.body import Body, body, forces, legs
from footopt.report.figures import (
    BLUE,
    COLUMN,
    GREY,
    ORANGE,
    PAGE,
    PALE,
    PURPLE,
    SAND,
    VERMILLION,
    Axes,
    _columns,
    _entry_of,
    _figure,
    _foot_height,
    _legend_above,
    _round_down,
    _say,
    draw_contour,
    draw_convergence,
    draw_parallel,
    draw_sand,
    styled,
)
from footopt.sand import Sand
from footopt.sand.law import PER_CM3, alpha
from footopt.walk import FIVE, OBJECTIVES, Scene, Table, Walk, Walker
from footopt.walk.audit import parameters
from footopt.walk.phases import STANDS
from footopt.walk.validity import diagnose

Array = NDArray[np.float64]

SIDES = (("left", BLUE), ("right", VERMILLION))
RESOLUTION = 160  # of a card's picture, dots per inch
POSES = 9  # of the walker in the picture of a walk
ARROW = 0.2  # of the picture's height: an arrow of `round_newtons`


class Drawing(NamedTuple):
    """One way to draw an object, and the size that suits it, inches."""

    draw: Callable[[Axes, Any], None]
    width: float = COLUMN
    height: float | Callable[[Any], float] = 2.5

    def size(self, shown: Any) -> tuple[float, float]:
        """Width and height for this object, inches."""
        return self.width, self.height(shown) if callable(self.height) else self.height


class View(NamedTuple):
    """How objects of a class are shown.

    drawings : by name, the default first. rows : of the card's picture, by names of drawings.
    title, facts : words for a card.
    """

    title: Callable[[Any], str]
    facts: Callable[[Any], dict[str, str]]
    drawings: Callable[[Any], dict[str, Drawing]]
    rows: Callable[[Any], list[list[str]]]


class Panel(PlainAxes):
    """Axes that a notebook shows with their figure, which pyplot does not know of."""

    def _repr_png_(self) -> bytes:
        return _png(self.get_figure())


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
    drawings = view(thing).drawings(thing)
    name = next(iter(drawings)) if what is None else what
    if name not in drawings:
        raise SettingError("what", what, f"one of {', '.join(drawings)} for a {type(thing).__name__}")
    if ax is None:
        return picture(thing, [[name]]).axes[0]
    drawings[name].draw(ax, thing)
    if ax.get_legend_handles_labels()[0] and ax.get_legend() is None:
        ax.legend(loc="best")
    return ax


@styled
def picture(shown: Any, rows: Sequence[Sequence[str]]) -> Figure:
    """A figure of an object's drawings by name, row by row."""
    drawings = view(shown).drawings(shown)
    sizes = [[drawings[name].size(shown) for name in row] for row in rows]
    width = max(sum(w for w, _ in row) for row in sizes)
    heights = [max(h for _, h in row) for row in sizes]
    figure = _figure(width, sum(heights))
    grid = figure.add_gridspec(len(rows), 1, height_ratios=heights)
    for i, row in enumerate(rows):
        parts = grid[i].subgridspec(1, len(row), width_ratios=[w for w, _ in sizes[i]])
        for j, name in enumerate(row):
            axes = figure.add_subplot(parts[j], axes_class=Panel)
            drawings[name].draw(axes, shown)
            handles, labels = axes.get_legend_handles_labels()
            if axes.get_legend() is None and handles:
                if len(rows) == len(row) == 1:
                    _legend_above(figure, handles, labels)
                else:
                    above = ScaledTranslation(0.0, 0.2 if axes.get_title() else 0.0, figure.dpi_scale_trans)
                    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2,
                                bbox_transform=axes.transAxes + above,
                                ncols=_columns(labels, sizes[i][j][0] - 0.5))  # fmt: skip
    figure.draw_without_rendering()  # a second pass of the layout settles it
    return figure


def words(shown: Any) -> tuple[str, dict[str, str]]:
    """What an object is called, and its numbers, with units, by name."""
    seen = view(shown)
    return seen.title(shown), seen.facts(shown)


def card(shown: Any) -> str:
    """HTML: an object's numbers beside its picture."""
    name, numbers = words(shown)
    title = html.escape(name)
    cell = 'style="text-align:left;padding:1px 8px 1px 0;vertical-align:top'
    facts = "".join(
        f'<tr><th {cell};font-weight:normal;white-space:nowrap">{html.escape(name)}</th>'
        f'<td {cell}">{html.escape(text)}</td></tr>'
        for name, text in numbers.items()
    )
    figure = picture(shown, view(shown).rows(shown))
    image = base64.b64encode(_png(figure)).decode("ascii")
    wide = round(96 * figure.get_figwidth())
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em 2em;align-items:flex-start">'
        f'<table style="font-size:90%;max-width:26em"><caption {cell};caption-side:top;font-weight:bold">'
        f"{title}</caption>{facts}</table>"
        f'<img alt="{title}" width="{wide}" style="max-width:100%;height:auto;background:white" '
        f'src="data:image/png;base64,{image}"></div>'
    )


def view(shown: Any) -> View:
    """How an object is shown: by its class, or one that it inherits from."""
    for kind in type(shown).__mro__:
        if kind.__name__ in VIEWS:
            return VIEWS[kind.__name__]
    raise SettingError("thing", shown, f"one of these: {', '.join(VIEWS)}")


@styled
def _png(figure: Any) -> bytes:
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=RESOLUTION)
    return file.getvalue()


# --- sand -----------------------------------------------------------------------------------------


def draw_stress(axes: Axes, sand: Sand, component: str = "alpha_z") -> None:
    """The stress per depth, N/cm^3, that a plate feels, by its angle beta and its motion's, gamma.

    Parameters
    ----------
    component : "alpha_x" or "alpha_z"; the sand's zeta is in it.
    """
    angle = np.linspace(-90.0, 90.0, 181)
    gamma, beta = np.meshgrid(np.radians(angle), np.radians(angle))
    found = alpha(beta, gamma, sand.stress_map)
    values = sand.zeta * found[("alpha_x", "alpha_z").index(component)] / PER_CM3
    most = float(np.abs(values).max()) or 1.0
    shades = axes.contourf(angle, angle, values, levels=np.linspace(-most, most, 42), cmap="RdBu_r")
    lines = axes.contour(angle, angle, values, levels=8, colors="black", linewidths=0.5)
    axes.clabel(lines, fontsize="small")
    axes.set(xlabel=r"$\gamma$ (deg): motion, + down", ylabel=r"$\beta$ (deg): plate, + toe up")
    axes.set_aspect("equal")
    axes.set_xticks([-90, -45, 0, 45, 90])
    axes.set_yticks([-90, -45, 0, 45, 90])
    name = rf"\alpha_{component[-1]}"
    axes.set_title(rf"$\zeta{name}$ (N/cm³), {sand.name} sand")
    axes.figure.colorbar(shades, ax=axes, shrink=0.9, ticks=MaxNLocator(6))


def sand_facts(sand: Sand) -> dict[str, str]:
    """Its scale, and the stresses that one would measure with a plate."""
    beta, gamma = np.radians([0.0, 0.0, 90.0]), np.radians([90.0, -90.0, 0.0])
    x, z = (sand.zeta * part / PER_CM3 for part in alpha(beta, gamma, sand.stress_map))
    found = {
        "zeta": _short(sand.zeta),
        "level plate pushed down": f"{_short(z[0])} N/cm³",
        "level plate lifted": f"{_short(z[1])} N/cm³",
        "upright plate pushed ahead": f"{_short(x[2])} N/cm³",
    }
    if sand.fit_error is not None:
        found["misfit of the table (x, z)"] = ", ".join(f"{100 * e:.2g} %" for e in sand.fit_error)
    return found


# --- gait -----------------------------------------------------------------------------------------


def draw_angles(axes: Axes, gait: Gait) -> None:
    """Joint angles of the steady walk over a stride, deg."""
    phase = np.linspace(0.0, 1.0, 201)
    shown = {"thigh, + forward": gait.thigh, "knee, + flexed": gait.knee, "foot, + toe up": gait.foot}
    looks = ((BLUE, "-"), (VERMILLION, "--"), (PURPLE, "-."))
    for (label, series), (colour, dashes) in zip(shown.items(), looks, strict=True):
        if series is not None:
            axes.plot(100.0 * phase, np.degrees(series.at(phase)[0]), color=colour, ls=dashes, label=label)
    axes.axhline(0.0, color=GREY, lw=0.5, zorder=0)
    axes.set(xlabel="stride (%), from heel strike", ylabel="angle (deg)", xlim=(0, 100))


def draw_path(axes: Axes, gait: Gait, walker: Walker | None = None) -> None:
    """The ankle's path around the hip over a stride, for a walker's legs."""
    walker = walker or Walker()
    (thigh, a), (shank, b), _ = gait.cycle(np.linspace(0.0, 1.0, 201))
    x, z, *_ = ankle(thigh, a, shank, b, walker.l1, walker.l2)
    axes.plot(x, z, color=BLUE)
    for i in (40, 140):  # where it goes
        step = {"xy": (x[i + 3], z[i + 3]), "xytext": (x[i], z[i])}
        axes.annotate("", **step, arrowprops={"arrowstyle": "-|>", "color": BLUE, "lw": 1.2})
    axes.plot(x[0], z[0], "o", color=BLUE)
    axes.annotate(
        "heel strike", (x[0], z[0]), xytext=(-5, 5), textcoords="offset points", ha="right", va="bottom"
    )
    axes.set(xlabel="$x$ from the hip (m)", ylabel="$z$ from the hip (m)")
    axes.set_title(f"ankle, legs of {walker.l1:g} + {walker.l2:g} m")
    axes.margins(0.08, 0.12)


def gait_facts(gait: Gait) -> dict[str, str]:
    """Its timing and where it comes from."""
    found = {
        "stride": f"{gait.period:g} s",
        "begins to move at": f"{gait.start:g} s",
        "foot turns": "with the shank" if gait.pitch == "shank" else "as measured",
    }
    found |= {f"misfit of the {joint} (rms)": f"{value:.2g}°" for joint, value in gait.residual}
    return found | ({"source": gait.source} if gait.source else {})


# --- foot -----------------------------------------------------------------------------------------


def foot_height(foot: Foot) -> float:
    """Of a figure with a foot, inches."""
    boxes = [] if foot.space is None else [[[foot.space.L, foot.space.H], [-foot.space.L, -foot.space.H]]]
    return _foot_height(np.concatenate([foot.contour, [foot.ankle], *boxes]))


def foot_facts(foot: Foot) -> dict[str, str]:
    """Its measures."""
    long, high = 1e3 * np.ptp(foot.contour, axis=0)
    found = {} if foot.k is None else {"heights k": ", ".join(map(str, foot.k))}
    found |= {
        "length x height": f"{long:.1f} x {high:.1f} mm",
        "width": f"{1e3 * foot.width:g} mm",
        "ankle (x, z)": ", ".join(f"{1e3 * v:g}" for v in foot.ankle) + " mm",
        "hollow": f"{1e3 * foot.hollow:.1f} mm",
    }
    if foot.box_violation is not None:
        found["outside its box by"] = f"{1e3 * foot.box_violation:.2f} mm"
    return found | ({"feels the sand": "with its sides and top too"} if foot.closed else {})


# --- scene ----------------------------------------------------------------------------------------


def draw_ground(axes: Axes, scene: Scene, left: float, right: float, low: float, high: float) -> None:
    """The sand of a scene from x = left to right and down to z = low, with its layers and patches.

    Darker is stronger; numbers are strengths over the scene's sand. On a slope the axes are along the
    plane and normal to it, and an arrow below z = high shows where gravity pulls.
    """
    draw_sand(axes, left, right, low)
    for effect in scene.effects:
        if isinstance(effect, Layers):
            ends = [-d for d in effect.depths] + [min(low, -2.0 * effect.depths[-1])]
            for top, bottom, factor in zip(ends, ends[1:], effect.factors, strict=False):
                _strip(axes, (left, max(bottom, low)), (right, top), factor)
                axes.plot([left, right], [top, top], color=ORANGE, lw=0.5, ls="--", zorder=1)
        if isinstance(effect, Patches):
            for begin, end, factor in zip(effect.begins, effect.ends, effect.factors, strict=True):
                a, b = max(begin, left), min(end, right)
                if a < b:
                    _strip(axes, (a, low), (b, 0.0), factor)
        if isinstance(effect, Slope):
            pull = np.array(scene.gravity) / scene.walker.g  # a unit vector, up to the sign of z
            size, x = 0.22 * high, right - 0.12 * (right - left)
            foot = x + size * float(pull[0] or 0.0), high - size * float(pull[1] or 0.0)
            axes.annotate("", foot, (x, high), arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.0})
            way = "uphill" if effect.angle > 0 else "downhill"
            axes.text(x, high, f"g, {abs(effect.angle):g}° {way}", ha="center", va="bottom")


def _strip(axes: Axes, corner: tuple[float, float], other: tuple[float, float], factor: float) -> None:
    """Sand of another strength in a rectangle, with the factor written in its lower left corner."""
    weight = float(np.clip(0.35 * np.log10(factor), -0.7, 0.45))
    goal = np.array(to_rgb("white" if weight < 0 else "#7A5230"))
    colour = (1.0 - abs(weight)) * np.array(to_rgb(SAND)) + abs(weight) * goal
    (x0, z0), (x1, z1) = corner, other
    axes.add_patch(Rectangle(corner, x1 - x0, z1 - z0, fc=colour, ec=ORANGE, lw=0.4, zorder=0.5))
    note = {"xytext": (3, 2), "textcoords": "offset points", "va": "bottom", "ha": "left"}
    axes.annotate(f"× {factor:g}", corner, **note, fontsize="small", zorder=1.5)


def draw_scene(axes: Axes, scene: Scene) -> None:
    """The walker as it stands before the first step, and the ground that it will walk on."""
    walker = scene.walker
    joints = legs(scene, [0.0], np.zeros((1, 2)))[0]
    joints = joints - [0.0, joints[..., 1].min()]
    height = float(joints[..., 1].max())
    deep = [effect.depths[-1] for effect in scene.effects if isinstance(effect, Layers)]
    far = [end for effect in scene.effects if isinstance(effect, Patches) for end in effect.ends]
    left, right = -0.5 * height, max([1.7 * height, *(end + 0.15 for end in far)])
    low = -max([0.2 * height, *(2.0 * d for d in deep)])
    draw_ground(axes, scene, left, right, low, 0.9 * height)
    for (side, colour), leg in zip(SIDES, joints, strict=True):
        axes.plot(*leg.T, color=colour, lw=3, solid_capstyle="round", marker="o", mfc="black", mec="black",
                  ms=3, label=f"{side} leg", zorder=3)  # fmt: skip
    axes.plot(*joints[0, 0], "o", color="black", ms=8, zorder=4, label=f"COM, {walker.mass:g} kg")
    axes.set(xlim=(left, right), ylim=(low, 1.12 * height), aspect="equal")
    axes.set(xlabel="$x$ (m)", ylabel="$z$ (m)")
    axes.set_title(f"{scene.sand.name} sand ($\\zeta$ = {scene.sand.zeta:g})")


def scene_facts(scene: Scene) -> dict[str, str]:
    """What is walked through."""
    w = scene.walker
    found = {
        "sand": f"{scene.sand.name} (zeta {_short(scene.sand.zeta)})",
        "gait": f"{scene.gait.name}, a stride in {scene.gait.period:g} s",
        "walker": f"{w.mass:g} kg, legs {w.l1:g} + {w.l2:g} m",
        "gravity": f"{w.g:g} m/s²",
        "lasts": f"{scene.duration:g} s",
    }
    for effect in scene.effects:
        values = ", ".join(f"{name} {value}" for name, value in parameters(effect).items())
        found[name_of(effect).replace("_", " ")] = values or "on"
    return found if scene.effects else found | {"effects": "none beyond the plain law"}


# --- walk -----------------------------------------------------------------------------------------


def draw_body(axes: Axes, placed: Body, i: int, fade: float = 1.0) -> list[Any]:
    """The walker at the i-th instant, the right leg behind the left; returns what it is drawn with."""
    drawn = []
    for foot, order in ((1, 2.0), (0, 3.0)):
        colour = SIDES[foot][1]
        drawn += axes.fill(*placed.outline[i, foot].T, fc=PALE, ec=GREY, lw=0.4, alpha=fade, zorder=order)
        drawn += axes.plot(*placed.legs[i, foot].T, color=colour, lw=2, alpha=0.75 * fade, marker="o", ms=2.5,
                           mfc="black", mec="black", mew=0, solid_capstyle="round", zorder=order)  # fmt: skip
        drawn += axes.plot(*placed.sole[i, foot].T, color=colour, lw=1.4, alpha=fade, zorder=order)
    drawn += axes.plot(*placed.hip[i], "o", color="black", ms=6, alpha=fade, zorder=4)
    return drawn


def draw_walk(axes: Axes, walk: Walk) -> None:
    """The walker at equal times, the path of the COM, and the force of the sand on each foot."""
    axes.set(xlabel="$x$ (m)", ylabel="$z$ (m)")
    if len(walk.t) == 0:
        axes.tick_params(bottom=False, labelbottom=False)
        _say(axes, f"the walk failed: {walk.reason}, before its first step of time")
        return
    begin = min(max(walk.scene.gait.start, walk.t[0]), walk.t[-1])
    index = np.unique(np.searchsorted(walk.t, np.linspace(begin, walk.t[-1], POSES)))
    placed = body(walk, walk.t[index])
    left, right, low, high = bounds(placed)
    draw_ground(axes, walk.scene, left, right, low, 0.9 * high)
    axes.plot(*walk.com.T, color="black", lw=0.8, label="COM", zorder=3.5)
    for i in range(len(index)):
        draw_body(axes, placed, i)
    at, force = (part.reshape(-1, 2) for part in forces(walk, index).resultant())
    seen = np.linalg.norm(force, axis=-1) > STANDS
    newtons = round_newtons(walk)
    draw_arrows(axes, at[seen], force[seen], ARROW * high / newtons)
    _entry_of(axes, f"force, {ARROW * high:.2g} m for {newtons:g} N", color="black", ls="",
              marker=r"$\uparrow$", ms=8)  # fmt: skip
    for side, colour in SIDES:
        _entry_of(axes, f"{side} leg", color=colour, lw=2)
    axes.set(xlim=(left, right), ylim=(low, high), aspect="equal")
    step = f", every {walk.t[index[1]] - walk.t[index[0]]:.2g} s" if len(index) > 1 else ""
    verdict = "" if walk.feasible else f" (failed: {walk.reason})"
    axes.set_title(f"{walk.foot.name} on {walk.scene.sand.name} sand{step}{verdict}")


def draw_arrows(axes: Axes, at: Array, force: Array, metres: float, **looks: Any) -> Any:
    """Arrows (m, 2) that begin at places (m, 2), in m; so many metres per newton."""
    return axes.quiver(
        *at.T, *force.T, angles="xy", scale_units="xy", scale=1.0 / metres, units="inches", width=0.012,
        headwidth=3.6, headlength=4.5, headaxislength=4, minlength=0, color="black", zorder=5, **looks,
    )  # fmt: skip


def round_newtons(walk: Walk) -> float:
    """The force, N, that is drawn `ARROW` of the picture's height long: half of the walk's largest."""
    return _round_down(max(0.5 * float(np.abs(walk.force).max()), 1e-9))


def bounds(placed: Body) -> tuple[float, float, float, float]:
    """Left, right, low and high around all that is drawn, m."""
    points = np.concatenate([placed.legs.reshape(-1, 2), placed.outline.reshape(-1, 2)])
    (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
    tall = high - min(low, 0.0)
    return left - 0.1 * tall, right + 0.1 * tall, min(low, 0.0) - 0.08 * tall, high + 0.08 * tall


def _traces(name: str, label: str) -> Callable[[Axes, Walk], None]:
    """How to draw a walk's trace with its two or four components against time."""

    def draw(axes: Axes, walk: Walk) -> None:
        axes.set(xlabel="time $t$ (s)", ylabel=label, xlim=(0.0, walk.scene.duration))
        if len(walk.t) == 0:
            _say(axes, f"no samples: {walk.reason}")
            return
        for strike in walk.scene.gait.heel_strikes(walk.scene.duration):
            axes.axvline(strike, color=GREY, lw=0.5, zorder=0)
        values = getattr(walk, name)
        if name in ("com", "velocity"):
            lines = {"forward $x$": (values[:, 0], BLUE, "-"), "up $z$": (values[:, 1], VERMILLION, "--")}
        elif name == "force":
            lines = {
                f"{side} $f_{axis}$": (values[:, foot, "xz".index(axis)], colour, dashes)
                for axis, dashes in (("z", "-"), ("x", ":"))
                for foot, (side, colour) in enumerate(SIDES)
            }
        else:
            lines = {f"{side} foot": (values[:, foot], colour, ("-", "--")[foot])
                     for foot, (side, colour) in enumerate(SIDES)}  # fmt: skip
        for text, (trace, colour, dashes) in lines.items():
            axes.plot(walk.t, trace, color=colour, ls=dashes, label=text)
            if not walk.feasible:
                axes.plot(walk.t[-1], trace[-1], "x", color=colour, ms=6, mew=1.5)
        axes.yaxis.set_major_locator(MaxNLocator(5))

    return draw


def walk_height(walk: Walk) -> float:
    """Of a page-wide figure with a walk at equal scales, inches."""
    if len(walk.t) == 0:
        return 1.0
    left, right, low, high = bounds(body(walk, walk.t[[0, -1]]))
    return float(np.clip((PAGE - 0.6) * (high - low) / (right - left), 1.5, 4.5) + 0.9)


def walk_facts(walk: Walk) -> dict[str, str]:
    """Its objectives, and what is to be thought of them."""
    found = {} if walk.feasible else {"failed": f"{walk.reason}, after {len(walk.t)} steps of time"}
    if walk.feasible:
        values = walk.objectives
        found |= {_title(name): _with_unit(values[name], name) for name in (*FIVE, "efficiency")}
    found |= {"foot": walk.foot.name, "sand": f"{walk.scene.sand.name} (zeta {_short(walk.scene.sand.zeta)})"}
    named = ", ".join(name_of(effect).replace("_", " ") for effect in walk.scene.effects)
    found |= {"effects": named} if named else {}
    found["accuracy"] = walk.accuracy.name
    outside = [d for d in diagnose(walk) if d.outside]
    return found | {
        f"warning: {d.name}": f"{_short(d.value)}{' ' + d.unit if d.unit else ''}: {d.why}" for d in outside
    }


# --- many feet ------------------------------------------------------------------------------------


def draw_table(axes: Axes, table: Table) -> None:
    """Objectives of all feet, an axis each; better is up."""
    draw_parallel(axes, table.values, table.names)


def table_facts(table: Table) -> dict[str, str]:
    """How many walked, and the range of each objective."""
    failed = Counter(map(str, table.reasons[~table.feasible]))
    found = {"feet": str(len(table)), "walked": str(int(table.feasible.sum()))}
    found |= {f"failed: {reason}": str(count) for reason, count in failed.most_common()}
    for name, column in zip(table.names, table.values[table.feasible].T, strict=True):
        if len(column):
            low, middle, high = (_short(v) for v in (column.min(), np.median(column), column.max()))
            unit = OBJECTIVES[name].unit
            found[_title(name)] = f"{low} to {high}{' ' + unit if unit else ''}, median {middle}"
    return found | {"sand": table.scene.sand.name}


def draw_front(axes: Axes, result: Any) -> None:
    """The designs of the front, an axis for each objective; the best in J_W stands out."""
    columns = [result.problem.record.index(name) for name in result.problem.names]
    marked = int(np.argmax(result.front == result.best))
    draw_parallel(axes, result.values[result.front][:, columns], result.problem.names, marked)


def draw_history(axes: Axes, result: Any) -> None:
    """The best value and the population's median against evaluations."""
    draw_convergence(axes, result.history, OBJECTIVES[result.problem.guide].label)


def search_drawings(result: Any) -> dict[str, Drawing]:
    """The front only where there is one, first."""
    history = {"convergence": Drawing(draw_history)}
    return history if result.problem.n_obj == 1 else {"front": Drawing(draw_front, PAGE, 2.6)} | history


def search_facts(result: Any) -> dict[str, str]:
    """What was searched, and what was found."""
    problem = result.problem
    found = {
        "searched": f"{problem.space.K}^{problem.space.n} soles for {', '.join(map(_title, problem.names))}",
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
    found["best k" if problem.n_obj == 1 else "best k in J_W"] = ", ".join(map(str, result.k[result.best]))
    best = zip(problem.record, result.values[result.best], strict=True)
    return found | {_title(name): _with_unit(value, name) for name, value in best}


# --- words ----------------------------------------------------------------------------------------


def _short(value: float) -> str:
    return f"{value:.4g}"


def _title(name: str) -> str:
    return "J_W" if name == "efficiency" else name.replace("_", " ")


def _with_unit(value: float, name: str) -> str:
    unit = OBJECTIVES[name].unit if name in OBJECTIVES else ""
    return f"{_short(value)}{' ' + unit if unit else ''}"


def _fixed(**drawings: Drawing) -> Callable[[Any], dict[str, Drawing]]:
    return lambda shown: drawings


def _always(*rows: list[str]) -> Callable[[Any], list[list[str]]]:
    return lambda shown: list(rows)


#: Views by the name of a class.
VIEWS: dict[str, View] = {
    "Sand": View(
        lambda sand: f"{sand.name} sand",
        sand_facts,
        _fixed(
            alpha_z=Drawing(draw_stress, COLUMN, 2.8),
            alpha_x=Drawing(lambda axes, sand: draw_stress(axes, sand, "alpha_x"), COLUMN, 2.8),
        ),
        _always(["alpha_x", "alpha_z"]),
    ),
    "Gait": View(
        lambda gait: f"{gait.name} gait",
        gait_facts,
        _fixed(angles=Drawing(draw_angles), path=Drawing(draw_path)),
        _always(["angles", "path"]),
    ),
    "Foot": View(
        lambda foot: foot.name,
        foot_facts,
        _fixed(foot=Drawing(draw_contour, COLUMN, foot_height)),
        _always(["foot"]),
    ),
    "Scene": View(
        lambda scene: f"a walk on {scene.sand.name} sand",
        scene_facts,
        _fixed(scene=Drawing(draw_scene, 4.5, 2.8)),
        _always(["scene"]),
    ),
    "Walk": View(
        lambda walk: f"{walk.foot.name} on {walk.scene.sand.name} sand",
        walk_facts,
        _fixed(
            walk=Drawing(draw_walk, PAGE, walk_height),
            com=Drawing(_traces("com", "COM (m)")),
            velocity=Drawing(_traces("velocity", "velocity of the COM (m/s)")),
            force=Drawing(_traces("force", "force of the sand (N)")),
            power=Drawing(_traces("power", "power of the sand (W)")),
            work=Drawing(_traces("work", "work of the sand (J)")),
        ),
        _always(["walk"], ["force", "power"]),
    ),
    "Table": View(
        lambda table: f"{len(table)} feet",
        table_facts,
        _fixed(table=Drawing(draw_table, PAGE, 2.6)),
        _always(["table"]),
    ),
    "SearchResult": View(
        lambda result: f"search on {result.problem.scene.sand.name} sand",
        search_facts,
        search_drawings,
        lambda result: [[next(iter(search_drawings(result)))]],
    ),
}
