"""Figures for a paper: one function a figure, from plain data to a matplotlib Figure.

No pyplot and so no global figure state: figures can be drawn from any thread. Helpers named
``draw_*`` draw on Axes of the caller's. Widths are a journal's column and page, fonts 8 pt; colours
are Okabe & Ito's, which the colour-blind can tell apart, and line styles differ too.
"""

from __future__ import annotations

import textwrap
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, TypeVar

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from footopt.errors import FileError, check
from footopt.files.drawings import MM
from footopt.foot import Foot, lower_hull
from footopt.gait.gait import LEFT, RIGHT
from footopt.report.body import body
from footopt.report.body import forces as forces_along
from footopt.walk.objectives import lookup
from footopt.walk.phases import stance
from footopt.walk.results import Walk

Array = NDArray[np.float64]
Axes = Any  # matplotlib.axes.Axes

COLUMN, PAGE = 3.4, 7.0  # widths, inches
DPI = 200

BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"
)  # fmt: skip
COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, "black")
DASHES: tuple[Any, ...] = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)))
GREY, PALE, SAND = "0.55", "0.92", "#F3E9D2"

STYLE: dict[str, Any] = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 8,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "legend.handletextpad": 0.6,
    "legend.columnspacing": 1.2,
    "pdf.fonttype": 42,  # text stays text, as journals ask
}

SHANK = 0.14  # of the shank is drawn, m

P = ParamSpec("P")
R = TypeVar("R")
_lock = threading.RLock()


def styled(make: Callable[P, R]) -> Callable[P, R]:
    """Run a function under the shared style.

    `matplotlib.rc_context` changes settings of the whole process, so threads take turns.
    """

    @wraps(make)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        with _lock, matplotlib.rc_context(STYLE):
            return make(*args, **kwargs)

    return run


@styled
def save(figure: Figure, folder: str | Path, name: str) -> tuple[Path, Path]:
    """Write a figure as PNG (200 dpi) and PDF; the same figure gives the same bytes.

    Parameters
    ----------
    folder : made if it is not there. name : of the files, without an ending.

    Returns
    -------
    png, pdf : the files.

    Raises
    ------
    FileError : the folder or a file cannot be written.
    """
    folder = Path(folder)
    png, pdf = folder / f"{name}.png", folder / f"{name}.pdf"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # each pass of the layout moves things a little: settle it once for all files
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        figure.savefig(png, dpi=DPI)
        figure.savefig(pdf, metadata={"CreationDate": None})
    except OSError as error:
        raise FileError(
            f"{folder}: the figure {name} cannot be written ({error.strerror or error}). "
            "Choose a folder that may be written to."
        ) from error
    return png, pdf


# --- feet -----------------------------------------------------------------------------------------


@styled
def contour(foot: Foot) -> Figure:
    """The sole in its box with its waypoints, its lower convex hull and the depth of its hollow."""
    boxes = [] if foot.space is None else [[[foot.space.L, foot.space.H], [-foot.space.L, -foot.space.H]]]
    figure = _figure(COLUMN, _foot_height(np.concatenate([foot.contour, [foot.ankle], *boxes])))
    axes = figure.subplots()
    draw_contour(axes, foot)
    _legend_above(figure, *axes.get_legend_handles_labels())
    return figure


@styled
def contours(feet: Mapping[str, Foot]) -> Figure:
    """Several soles in one frame, by label."""
    figure = _figure(COLUMN, _foot_height(np.concatenate([foot.contour for foot in feet.values()])))
    axes = figure.subplots()
    for i, (label, foot) in enumerate(feet.items()):
        axes.plot(*(MM * foot.contour).T, **_line(i), label=as_text(label))
    _foot_axes(axes)
    _legend_above(figure, *axes.get_legend_handles_labels())
    return figure


@styled
def drawing(foot: Foot, block: Sequence[float] | None = None) -> Figure:
    """The outline that a workshop makes, with its dimensions in mm.

    Parameters
    ----------
    block : length and height of a mounting block, m (see `Foot.body_outline`).
    """
    outline = MM * foot.body_outline(block)
    (left, low), (right, high) = outline.min(axis=0), outline.max(axis=0)
    gap = 0.03 * (right - left)
    x, z = (left - 4 * gap, right + 4 * gap), (low - 2 * gap, high + (3 * gap if block is not None else gap))
    figure = _figure(PAGE, min(0.8 + 6.3 * (z[1] - z[0]) / (x[1] - x[0]), 6.0))
    axes = figure.subplots()
    axes.add_patch(Polygon(outline, closed=True, fc=PALE, ec="black", lw=0.8))
    axes.plot(*(MM * foot.contour).T, color=BLUE, zorder=3)
    axes.plot(*(MM * np.array(foot.ankle)), "+", color="black", ms=6, mew=1, zorder=4)
    _dimension(axes, (left, low - gap), (right, low - gap))
    _dimension(axes, (right + gap, low), (right + gap, high))
    if block is not None:
        (length, height), middle = MM * np.array(block), MM * foot.ankle[0]
        ends = middle - length / 2, middle + length / 2
        _dimension(axes, (ends[0], high + gap), (ends[1], high + gap))
        _dimension(axes, (ends[0] - 3 * gap, high - height), (ends[0] - 3 * gap, high))
    axes.set_title(f"{MM * foot.width:.4g} mm wide", loc="left")
    _foot_axes(axes)
    axes.set(xlim=x, ylim=z)
    return figure


def _dimension(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """An arrow between two points, mm, along x or upwards, and its length."""
    along = start[1] == end[1]
    looks = {"arrowstyle": "<->", "color": GREY, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=looks)
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    axes.annotate(
        f"{max(end[0] - start[0], end[1] - start[1]):.4g}",
        middle,
        (0, 1) if along else (3, 0),
        textcoords="offset points",
        ha="center" if along else "left",
        va="bottom" if along else "center",
    )


def draw_contour(axes: Axes, foot: Foot) -> None:
    """A sole in the foot frame, mm; see `contour`."""
    sole = MM * foot.contour
    if foot.space is not None:
        length, height = MM * foot.space.L, MM * foot.space.H
        box = Rectangle((-length, -height), 2 * length, 2 * height, color=PALE, lw=0, label="box")
        axes.add_patch(box)
    axes.plot(*sole.T, color=BLUE, label="sole", zorder=3)
    if foot.space is not None and foot.k is not None:
        points = foot.space.x, foot.space.heights(foot.k)[0]
        axes.plot(*(MM * np.array(points)), "o", color=BLUE, mfc="white", label="waypoint", zorder=4)
    axes.plot(*(MM * np.array(foot.ankle)), "+", color="black", ms=6, mew=1, label="ankle", zorder=5)
    hull, x, low, high = lower_hull(foot.contour)
    depth = MM * foot.hollow
    if depth >= 0.05:
        axes.plot(*(MM * hull).T, ":", color=VERMILLION, label="lower hull", zorder=2)
        ends = {"xy": (MM * x, MM * low), "xytext": (MM * x, MM * high)}
        arrow = {"arrowstyle": "<->", "color": VERMILLION, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", **ends, arrowprops=arrow, zorder=4)
        # under the hull, where there is never a sole nor an ankle
        below = {"xytext": (0, -4), "textcoords": "offset points", "ha": "center", "va": "top"}
        axes.annotate(f"hollow {depth:.1f} mm", (MM * x, MM * low), **below, color=VERMILLION)
    else:
        axes.set_title("no hollow", loc="right", color=VERMILLION)
    _foot_axes(axes)


def _foot_axes(axes: Axes) -> None:
    axes.set(xlabel="$x_p$ (mm), to the toe", ylabel="$z_p$ (mm)", aspect="equal")
    axes.margins(0.05, 0.2)


def _foot_height(points: Array) -> float:
    """Height of a column-wide figure whose axes, at equal scales, hold some points, inches."""
    wide, high = np.ptp(points, axis=0)
    return float(min(0.52 + 3.6 * max(high, 0.12 * wide) / wide, 6.0))


# --- a search -------------------------------------------------------------------------------------


@styled
def convergence(history: Iterable[Any], label: str) -> Figure:
    """The best value and the population's median against the number of evaluations.

    Parameters
    ----------
    history : one entry a generation, objects or dicts with `evaluations`, `best` and, where they
        are known, `median`, `low` and `high` (the edges of a band to shade, e.g. quartiles).
    label : of the value, with its unit if it has one.
    """
    figure = _figure(COLUMN, 2.4)
    axes = figure.subplots()
    draw_convergence(axes, history, label)
    return figure


def draw_convergence(axes: Axes, history: Iterable[Any], label: str) -> None:
    """Best and median on one axes; see `convergence`."""
    rows = list(history)
    evaluations, best, median, low, high = (
        np.array([_entry(row, name) for row in rows], float)
        for name in ("evaluations", "best", "median", "low", "high")
    )
    axes.set(xlabel="evaluations", ylabel=label)
    if not np.isfinite(best).any():
        _say(axes, "no feasible design was found")
        axes.tick_params(bottom=False, labelbottom=False)
        return
    if (np.isfinite(low) & np.isfinite(high)).any():
        axes.fill_between(evaluations, low, high, color=SKY, alpha=0.3, lw=0, label="spread")
    if np.isfinite(median).any():
        axes.plot(evaluations, median, color=VERMILLION, ls="--", label="median")
    # a best value holds until a better one is found
    axes.plot(evaluations, best, color=BLUE, drawstyle="steps-post", label="best")
    last = np.flatnonzero(np.isfinite(best))[-1]
    axes.plot(evaluations[last], best[last], "o", color=BLUE)
    axes.legend(loc="best", title=f"best {_number(best[last])}")
    axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))


def _entry(row: Any, name: str) -> float:
    value = row.get(name) if isinstance(row, Mapping) else getattr(row, name, None)
    return float("nan") if value is None else float(value)


# --- walks ----------------------------------------------------------------------------------------


@styled
def com(walks: Mapping[str, Walk]) -> Figure:
    """Position and velocity of the centre of mass against time, of walks by label."""
    figure = _figure(PAGE, 3.6)
    axes = figure.subplots(2, 2, sharex=True)
    for column, name in enumerate("xz"):
        axes[0, column].set_ylabel(rf"${name}_{{\mathrm{{COM}}}}$ (m)")
        axes[1, column].set_ylabel(f"$V_{name}$ (m/s)")
        draw_traces(axes[0, column], walks, _trace("com", column))
        draw_traces(axes[1, column], walks, _trace("velocity", column))
    _finish_walks(figure, axes, walks)
    return figure


@styled
def forces(walks: Mapping[str, Walk]) -> Figure:
    """Force of the sand on each foot against time: f_x left, f_z right; a row for each foot."""
    figure = _figure(PAGE, 3.6)
    axes = figure.subplots(2, 2, sharex=True, sharey="col")
    for foot, name in ((LEFT, "left"), (RIGHT, "right")):
        for column, symbol in enumerate("xz"):
            axes[foot, column].set_ylabel(f"{name} foot $f_{symbol}$ (N)")
            draw_traces(axes[foot, column], walks, _trace("force", foot, column))
    _finish_walks(figure, axes, walks)
    return figure


@styled
def power_work(walks: Mapping[str, Walk]) -> Figure:
    """Power and cumulative work of the sand on each foot against time; a row for each foot."""
    figure = _figure(PAGE, 3.6)
    axes = figure.subplots(2, 2, sharex=True, sharey="col")
    for foot, name in ((LEFT, "left"), (RIGHT, "right")):
        short = name[0]
        axes[foot, 0].set_ylabel(f"{name} foot power $P_{short}$ (W)")
        axes[foot, 1].set_ylabel(f"{name} foot work $W_{short}$ (J)")
        draw_traces(axes[foot, 0], walks, _trace("power", foot))
        draw_traces(axes[foot, 1], walks, _trace("work", foot))
    _finish_walks(figure, axes, walks)
    return figure


def draw_traces(axes: Axes, walks: Mapping[str, Walk], get: Callable[[Walk], Array]) -> None:
    """One quantity of each walk against time, with thin lines at heel strikes.

    A walk that failed ends in a cross; one that failed at once leaves only its label.

    Parameters
    ----------
    get : from a walk to (T,) values.
    """
    strikes = {float(h) for w in walks.values() for h in w.scene.gait.heel_strikes(w.scene.duration)}
    for h in sorted(strikes):
        axes.axvline(h, color=GREY, lw=0.5, zorder=0)
    for i, (label, walk) in enumerate(walks.items()):
        values = get(walk)
        axes.plot(walk.t, values, **_line(i), label=walk_label(label, walk))
        if not walk.feasible and len(walk.t):
            axes.plot(walk.t[-1], values[-1], "x", color=_line(i)["color"], ms=6, mew=1.5)
    if not any(len(walk.t) for walk in walks.values()):
        _say(axes, "no samples: " + ", ".join(sorted({w.reason for w in walks.values()})))


def as_text(name: str) -> str:
    """A user's name as a label: no formula between dollars, and no "_" before it, which would hide it."""
    plain = name.replace("$", r"\$")
    return f" {plain}" if plain.startswith("_") else plain


def walk_label(label: str, walk: Walk) -> str:
    """A walk's label, with the reason if it failed."""
    label = as_text(label)
    return label if walk.feasible else f"{label} (failed: {walk.reason})"


def _trace(name: str, *index: int) -> Callable[[Walk], Array]:
    """How to read one component of a walk's trace, (T,)."""

    def get(walk: Walk) -> Array:
        values: Array = getattr(walk, name)[(slice(None), *index)]
        return values

    return get


def _finish_walks(figure: Figure, axes: Any, walks: Mapping[str, Walk]) -> None:
    end = max((walk.scene.duration for walk in walks.values()), default=1.0)
    for a in axes.flat:
        a.set_xlim(0.0, end)
    for a in axes[-1]:
        a.set_xlabel("time $t$ (s)")
    figure.align_ylabels()
    handles, labels = axes.flat[0].get_legend_handles_labels()
    if any(len(walk.scene.gait.heel_strikes(walk.scene.duration)) for walk in walks.values()):
        handles, labels = [*handles, Line2D([], [], color=GREY, lw=0.5)], [*labels, "heel strike"]
    _legend_above(figure, handles, labels)


# --- one step -------------------------------------------------------------------------------------


def step(walk: Walk, frames: int = 6) -> Figure:
    """One step of the right foot from touch-down to push-off; see `steps`."""
    return steps({"right foot": walk}, frames)


@styled
def steps(walks: Mapping[str, Walk], frames: int = 6) -> Figure:
    """The right foot's first step in walks by label, a row each: the sole in the sand and its forces.

    Snapshots at equal intervals, those of a row all in the same place, and all in the same scale.
    Each arrow is the force on one of `body.ARROWS` parts of the sole and ends there; titles are times
    since touch-down (see `stance`).
    """
    check(frames >= 1, "frames", frames, "a whole number >= 1")
    rows = [row for label, walk in walks.items() if (row := _frames(label, walk, frames))]
    if not rows:
        walk = next(iter(walks.values()))
        figure = _figure(PAGE, 1.6)
        axes = figure.subplots()
        axes.set_axis_off()
        why = f"the walk failed: {walk.reason}" if walk.reason else "its foot never touched the sand"
        _say(axes, f"no step of the right foot to show: {why}")
        return figure
    metres = 0.08 / max(row.size.max() for row in rows)  # of arrow per newton
    reference = _round_down(0.08 * 0.8 / metres)
    drawn = [row.points(metres) for row in rows]
    span = max(float(np.ptp(points[:, 0])) for points in drawn) + 0.02
    low = min(*(points[:, 1].min() - 0.01 for points in drawn), -0.06) - 0.2 * span  # room for the key
    high = max(*(points[:, 1].max() for points in drawn), 0.02) + 0.01
    width = (PAGE - 0.55) / frames - 0.08
    height = min(width * (high - low) / span + 0.85, 8.0 / len(rows))
    figure = _figure(PAGE, height * len(rows))
    for i, (row, points) in enumerate(zip(rows, drawn, strict=True)):
        left = 0.5 * float(points[:, 0].min() + points[:, 0].max() - span)
        part = figure if len(rows) == 1 else figure.add_subfigure(figure.add_gridspec(len(rows), 1)[i])
        panels = part.subplots(1, frames, sharex=True, sharey=True, squeeze=False)[0]
        for j, axes in enumerate(panels):
            draw_sand(axes, left, left + span, low)
            draw_foot(axes, row.soles.outline[j], row.soles.sole[j], row.soles.shank[j])
            arrows = row.draw_arrows(axes, j, metres)
            if i == j == 0:
                key = {"labelpos": "E", "coordinates": "data", "labelsep": 0.05, "zorder": 5}
                tip = left + 0.05 * span + metres * reference
                axes.quiverkey(arrows, tip, low + 0.08 * span, reference, f"{reference:g} N", **key)
            axes.set(xlim=(left, left + span), ylim=(low, high), aspect="equal", xlabel="$x$ (m)")
            axes.set_title(f"{row.since[j]:.2f} s")
            axes.xaxis.set_major_locator(MaxNLocator(2))
            axes.yaxis.set_major_locator(MaxNLocator(4))
        panels[0].set_ylabel("$z$ (m)")
        part.suptitle(textwrap.fill(row.title, 125), fontsize=8)
    return figure


class _Frames(NamedTuple):
    """One walk's snapshots of a step: feet, arrows (M, arrows, 2), times since it began."""

    soles: _Placed
    at: Array
    force: Array
    since: Array
    title: str

    @property
    def size(self) -> Array:
        return np.hypot(self.force[..., 0], self.force[..., 1])

    def points(self, metres: float) -> Array:
        """Everything that is drawn, (m, 2), with arrows of so many metres per newton."""
        tails = self.at - metres * self.force
        shown = self.soles.outline, tails, self.soles.shank
        return np.concatenate([part.reshape(-1, 2) for part in shown])

    def draw_arrows(self, axes: Axes, j: int, metres: float) -> Any:
        """The forces of one snapshot."""
        seen = self.size[j] > 0.02 * self.size.max()  # shorter arrows are heads without a shaft
        return axes.quiver(
            *self.at[j, seen].T, *self.force[j, seen].T, pivot="tip", angles="xy", scale_units="xy",
            scale=1.0 / metres, units="inches", width=0.008, headwidth=3.6, headlength=4.5,
            headaxislength=4, minlength=0, color=VERMILLION, zorder=4,
        )  # fmt: skip


def _frames(label: str, walk: Walk, frames: int) -> _Frames | None:
    """Snapshots of the right foot's first step; None if it never stood."""
    contact = stance(walk)
    if contact is None:
        return None
    # at its very ends a contact carries no force
    share = np.linspace(0.05, 0.95, frames) if frames > 1 else np.array([0.5])
    begin, end = walk.t[contact.first], walk.t[contact.last]
    index = np.searchsorted(walk.t, begin + share * (end - begin))  # steps of time are not equally long
    at, force = (part[:, RIGHT] for part in forces_along(walk, index))
    began = f"t = {walk.t[contact.first]:.2f} s"
    since = f"heel strike ({began}; dragged through the sand until then)"
    since = since if contact.dragged else f"touch-down ({began})"
    title = f"{walk_label(label, walk)}, time since {since}; arrows: force on 1/{at.shape[1]} of the sole"
    return _Frames(_placed(walk, index), at, force, walk.t[index] - walk.t[contact.first], title)


class _Placed(NamedTuple):
    outline: Array  # (M, m, 2), m: sole and top
    sole: Array  # (M, s, 2), m
    shank: Array  # (M, 2, 2), m: ankle, and a point on the shank


def _placed(walk: Walk, index: NDArray[np.int64]) -> _Placed:
    """The right foot in the world at some samples."""
    placed = body(walk, walk.t[index])
    knee, ankle = placed.legs[:, RIGHT, 1], placed.legs[:, RIGHT, 2]
    point = ankle + SHANK / walk.scene.walker.l2 * (knee - ankle)
    return _Placed(placed.outline[:, RIGHT], placed.sole[:, RIGHT], np.stack([ankle, point], axis=1))


def draw_sand(axes: Axes, left: float, right: float, low: float) -> None:
    """Sand below z = 0, m."""
    axes.add_patch(Rectangle((left, low), right - left, -low, color=SAND, lw=0, zorder=0))
    axes.axhline(0.0, color=ORANGE, lw=0.8, zorder=1)


def draw_foot(axes: Axes, outline: Array, sole: Array, shank: Array) -> None:
    """A foot in the world: its closed outline (m, 2), its sole (s, 2) and its shank (2, 2), m."""
    axes.add_patch(Polygon(outline, closed=True, fc=PALE, ec=GREY, lw=0.5, zorder=2))
    axes.plot(*shank.T, color=GREY, lw=4, solid_capstyle="round", zorder=2.5)
    axes.plot(*shank[0], "o", color="black", ms=3, zorder=3.5)
    axes.plot(*sole.T, color=BLUE, zorder=3)


def _round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(m for m in (1, 2, 5) if m * power <= value * (1 + 1e-12)))


# --- many designs ---------------------------------------------------------------------------------


@styled
def scatter_matrix(values: ArrayLike, names: Sequence[str], marked: int | None = None) -> Figure:
    """Every pair of objectives of many designs, and the spread of each.

    Parameters
    ----------
    values : (designs, objectives), natural signs; rows with a NaN failed and are not drawn.
    names : of the objectives (`footopt.walk.objectives.OBJECTIVES`).
    marked : row of the design to point out, the best in J_W.
    """
    chosen, good, star, note = _designs(values, names, marked)
    n = len(chosen)
    size = min(PAGE, 1.4 * n + 1.0)
    figure = _figure(size, size)
    grid = figure.subplots(n, n, squeeze=False)
    scales = np.array([_scale(column) for column in good.T])
    good, star = good / scales, None if star is None else star / scales
    labels = [_better(o, scale) for o, scale in zip(chosen, scales, strict=True)]
    for row in range(n):
        for column in range(n):
            axes = grid[row, column]
            if column > row:
                axes.set_axis_off()
                continue
            if column == row:
                draw_spread(axes, good[:, column], None if star is None else star[column])
            else:
                draw_pair(
                    axes, good[:, [column, row]], None if star is None else star[[column, row]]
                )  # fmt: skip
            axes.xaxis.set_major_locator(MaxNLocator(3 if n <= 5 else 2))
            axes.yaxis.set_major_locator(MaxNLocator(3))
            if row == n - 1:
                axes.set_xlabel(labels[column])
            else:
                axes.tick_params(labelbottom=False)
            if column == 0 and row > 0:
                axes.set_ylabel(labels[row])
            elif column != row:
                axes.tick_params(labelleft=False)
    figure.align_labels()
    handles = [Line2D([], [], color=BLUE, ls="", marker="o", ms=3, alpha=0.6, label="design")]
    if star is not None:
        handles.append(Line2D([], [], **_STAR, label="best in $J_W$"))
    text = f"{len(good)} designs" + (f"\n{note}" if note else "")
    if n > 1:
        grid[0, -1].legend(handles=handles, loc="upper right", title=text)
    else:
        figure.suptitle(text.replace("\n", ", "), fontsize=8)
    return figure


_STAR: dict[str, Any] = {
    "marker": "*", "ms": 11, "mfc": VERMILLION, "mec": "black", "mew": 0.6, "ls": "", "zorder": 5,
    "clip_on": False,
}  # fmt: skip


def draw_pair(axes: Axes, points: Array, star: Array | None) -> None:
    """Two objectives of many designs, (designs, 2), and the one to point out, (2,)."""
    axes.plot(*points.T, "o", color=BLUE, ms=2.5, mew=0, alpha=0.5)
    if star is not None:
        axes.plot(*star, **_STAR)


def draw_spread(axes: Axes, values: Array, star: float | None) -> None:
    """How many designs have which value of one objective, (designs,)."""
    if len(values):
        axes.hist(values, bins=min(20, max(1, round(len(values) ** 0.5))), color=SKY, ec="white", lw=0.3)
    if star is not None:
        axes.axvline(star, color=VERMILLION, ls="--")
    axes.spines["left"].set_visible(False)
    axes.tick_params(left=False, labelleft=False)


@styled
def parallel(values: ArrayLike, names: Sequence[str], marked: int | None = None) -> Figure:
    """Parallel coordinates of many designs: better is up on every axis.

    Parameters
    ----------
    values, names, marked : as for `scatter_matrix`.
    """
    figure = _figure(PAGE, 2.8)
    axes = figure.subplots()
    title = draw_parallel(axes, values, names, marked)
    _legend_above(figure, *axes.get_legend_handles_labels(), title=title)
    return figure


def draw_parallel(
    axes: Axes, values: ArrayLike, names: Sequence[str], marked: int | None = None
) -> str | None:
    """Parallel coordinates on one axes, see `parallel`; returns how many designs, None if there are none."""
    chosen, good, star, note = _designs(values, names, marked)
    axes.set_axis_off()
    n = len(chosen)
    axes.set(xlim=(-0.35, n - 0.4), ylim=(-0.44, 1.16))
    if len(good) == 0:
        _say(axes, f"no design to show: {note}")
        return None
    sign = np.array([1.0 if o.maximise else -1.0 for o in chosen])
    low, high = (sign * good).min(axis=0), (sign * good).max(axis=0)
    span = np.where(high > low, high - low, 1.0)

    def place(rows: Array) -> Array:
        return np.where(high > low, (sign * rows - low) / span, 0.5)

    x = np.arange(n)
    axes.plot(x, place(good).T, color=BLUE, lw=0.6, alpha=max(0.08, min(0.6, 20.0 / len(good))))
    for i, o in enumerate(chosen):
        axes.plot([i, i], [0, 1], color="black", lw=0.8, zorder=3)
        axes.text(i, 1.07, _number(sign[i] * high[i]), ha="center", va="bottom")
        axes.text(i, -0.07, _number(sign[i] * low[i]), ha="center", va="top")
        axes.text(i, -0.2, _two_lines(o), ha="center", va="top")
    _entry_of(axes, "design", color=BLUE, lw=0.6)
    if star is not None:
        y = place(star)
        axes.plot(x, y, **_STAR | {"color": VERMILLION, "lw": 2, "ls": "-"}, label="best in $J_W$")
        box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": VERMILLION, "lw": 0.5}
        for i in range(n):
            axes.text(i + 0.06, y[i], _number(star[i]), va="center", bbox=box, zorder=6)
    up = {"arrowstyle": "<-", "lw": 0.8}
    axes.annotate("", (-0.25, 0.2), (-0.25, 0.8), arrowprops=up)
    axes.text(-0.29, 0.5, "better", rotation=90, ha="right", va="center")
    return f"{len(good)} designs" + (f" ({note})" if note else "")


def _entry_of(axes: Axes, label: str, **looks: Any) -> None:
    """An entry of the legend that is not drawn."""
    axes.plot([], [], label=label, **looks)[0].set_in_layout(False)


def _designs(
    values: ArrayLike, names: Sequence[str], marked: int | None
) -> tuple[list[Any], Array, Array | None, str]:
    """Objectives, the rows to draw, the one to point out, and a note on what is left out."""
    table = np.atleast_2d(np.asarray(values, float))
    chosen = lookup(names)
    check(
        table.shape[1] == len(names), "values", table.shape, f"an array with {len(names)} columns"
    )  # fmt: skip
    check(
        marked is None or 0 <= marked < len(table), "marked", marked, f"a row, 0 to {len(table) - 1}"
    )  # fmt: skip
    fine = np.isfinite(table).all(axis=1)
    left_out = int((~fine).sum())
    note = f"{left_out} failed, not drawn" if left_out else ""
    star = None if marked is None or not fine[marked] else table[marked]
    return chosen, table[fine], star, note


def _better(o: Any, scale: float) -> str:
    """Axis label in lines that fit a small panel, with the power of ten and the direction that is better."""
    label = _two_lines(o)
    if scale != 1.0:
        power = f"$10^{{{round(np.log10(scale))}}}$"
        label = label.removesuffix(f" ({o.unit})") + f" ({power} {o.unit}".rstrip() + ")"
    arrow = "better \N{RIGHTWARDS ARROW}" if o.maximise else "\N{LEFTWARDS ARROW} better"
    return f"{label}\n{arrow}"


def _two_lines(o: Any) -> str:
    """An objective's label with its symbol and unit on a second line."""
    title = o.name.replace("_", " ")
    return f"{title}\n{o.label.removeprefix(title).strip()}"


def _scale(values: Array) -> float:
    """The power of ten to divide by, so that tick labels stay short; 1 for ordinary numbers."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest == 0.0 or 1e-3 <= largest < 1e5:
        return 1.0
    return float(10.0 ** np.floor(np.log10(largest)))


# --- shared ---------------------------------------------------------------------------------------


def _figure(width: float, height: float) -> Figure:
    """An empty figure (inches) with a canvas of its own."""
    # laid out at the resolution of its picture: formulas are parsed once for both
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _line(i: int) -> dict[str, Any]:
    """Colour and dashes of the i-th line: 35 before a pair returns."""
    return {"color": COLOURS[i % len(COLOURS)], "ls": DASHES[i % len(DASHES)]}


def _legend_above(
    figure: Figure, handles: Sequence[Any], labels: Sequence[str], title: str | None = None
) -> None:
    """One legend above all axes, with as many columns as fit beside each other."""
    short = [textwrap.fill(label, 40) for label in labels]
    columns = _columns(short, figure.get_figwidth())
    rows = -(-len(short) // columns) + (title is not None)
    figure.set_figheight(figure.get_figheight() + 0.17 * rows)  # the legend takes nothing from the axes
    figure.legend(handles, short, loc="outside upper center", ncols=columns, title=title)


def _columns(labels: Sequence[str], width: float) -> int:
    """How many columns of a legend with these labels fit into a width, inches."""
    longest = max((len(line) for label in labels for line in label.split("\n")), default=0)
    # an 8 pt letter is about 0.062 inches wide, a line and the gaps beside it 0.45
    return min(max(int(width / (0.45 + 0.062 * longest)), 1), max(len(labels), 1))


def _number(value: float) -> str:
    """Four figures, as a person writes them."""
    if value and not 1e-3 <= abs(value) < 1e5:
        mantissa, power = f"{value:.3e}".split("e")
        return rf"${mantissa}\times10^{{{int(power)}}}$"
    return f"{value:#.4g}".rstrip(".").replace("-", "\N{MINUS SIGN}")


def _say(axes: Axes, text: str) -> None:
    """A plain statement where there is nothing to draw; ticks would be those of no data."""
    axes.tick_params(left=False, labelleft=False)
    axes.text(0.5, 0.5, textwrap.fill(text, 60), transform=axes.transAxes, ha="center", va="center")
