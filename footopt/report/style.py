"""The look of every figure: colours by role, fonts, widths, legends, and how a figure is made and saved.

No pyplot and so no global figure state: figures can be drawn from any thread. Widths are a journal's
column and page, fonts 8 pt; colours of roles are told apart by the
colour-blind, and line styles differ too.
"""

from __future__ import annotations

import io
import textwrap
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import matplotlib
import numpy as np
from fontTools import subset
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import ScalarFormatter
from numpy.typing import ArrayLike, NDArray

from footopt.files.run import write_bytes
from footopt.report.numbers import number

Array = NDArray[np.float64]
Axes = Any  # matplotlib.axes.Axes

COLUMN, PAGE = 3.4, 7.0  # widths, inches
DPI = 200

GREY, PALE, GRID = "0.55", "0.92", "0.92"
#: Of lines and points that have no role: none of these is a role's colour.
COLOURS = ("#332288", "#CC6677", "#999933", "#000000", "#7F6BD1", "#B3003C", "#4B5320")
DASHES: tuple[Any, ...] = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)))
MARKERS = "osD^vP*"

#: Sands in the paper's order.
SANDS = ("soft", "hard", "regular")
#: Name and colour of the left and the right leg.
SIDES = (("left", "#0072B2"), ("right", "#D55E00"))
#: What is designed (the best foot, the chosen one), and the flat sole that it is compared with.
BEST, FLAT, CHOSEN, DESIGNS = "#009E73", "#707070", "#882255", "#56B4E9"
SAND, SURFACE, STRONG_SAND = "#F3E9D2", "#E69F00", "#7A5230"
#: A verdict that is good, bad, or none; its marks differ in shape, too.
VERDICTS = ((BEST, "o"), ("#000000", "X"), (FLAT, "s"))
#: Lines that look the same in every figure, by what they are; a stronger sand is darker.
ROLES: dict[str, dict[str, Any]] = {
    "best": {"color": BEST},
    "robust": {"color": BEST},
    "median scene": {"color": CHOSEN, "ls": "-."},
    "flat": {"color": FLAT, "ls": "--"},
    "soft": {"color": SURFACE},
    "hard": {"color": "#4A2C12", "ls": "--"},
    "regular": {"color": "#A8601C", "ls": "-."},
}
#: Colours of roles, which the page takes from here as CSS variables.
PALETTE = {
    **dict(SIDES), "best": BEST, "flat": FLAT, "chosen": CHOSEN, "designs": DESIGNS,
    "surface": SURFACE, "sand": SAND, "ink": "#1a1a1a", "paper": "#ffffff",
    **{f"line-{i}": colour for i, colour in enumerate(COLOURS)},
}  # fmt: skip

STYLE: dict[str, Any] = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 8,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "figure.labelsize": 8,
    "figure.titlesize": 8,
    "axes.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-3, 5),
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
    "figure.autolayout": False,  # whatever the user's matplotlibrc says
    "figure.constrained_layout.use": False,
    "pdf.fonttype": 42,  # text stays text, as journals ask
    "svg.hashsalt": "footopt",
}

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


def new_figure(width: float, height: float) -> Figure:
    """An empty figure (inches) with a canvas of its own."""
    # laid out at the resolution of its picture: formulas are parsed once for both
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    figure.add_axobserver(_plain_ticks)
    return figure


class PlainTicks(ScalarFormatter):
    """Numbers of ticks as text: as formulas they take a third of a figure's time. A power of ten is one."""

    def get_offset(self) -> str:
        """What all numbers are multiplied with."""
        self.set_useMathText(True)
        try:
            return str(super().get_offset())
        finally:
            self.set_useMathText(False)


def _plain_ticks(figure: Figure) -> None:
    """Give new axes their format of numbers; axes that share ticks share it."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(PlainTicks(useMathText=False))


@styled
def save(figure: Figure, folder: str | Path, name: str, svg: bool = False) -> tuple[Path, Path]:
    """Write a figure as PNG (200 dpi) and PDF, and as SVG for a page; the same figure gives the same bytes.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What to write.
    folder : str or Path
        Where; made if it is not there.
    name : str
        Of the files, without an ending.
    svg : bool
        Whether to write the SVG, too.

    Returns
    -------
    png, pdf : Path
        The files.

    Raises
    ------
    FileError
        A file cannot be written.
    """
    folder = Path(folder)
    picture, page = folder / f"{name}.png", folder / f"{name}.pdf"
    # each pass of the layout moves things a little: all files have the same one
    if (layout := figure.get_layout_engine()) is not None:
        layout.execute(figure)
        figure.set_layout_engine(None)  # with "none" it would be drawn once more before each file
    dates = {"pdf": "CreationDate"} | ({"svg": "Date"} if svg else {})
    made = {}
    with _without_layout_tables():
        for ending, date in dates.items():
            file = io.BytesIO()  # matplotlib's errors on a full disk are of many kinds
            figure.savefig(file, format=ending, metadata={date: None})
            made[ending] = file.getvalue()
    with suppress(OSError):  # `write_bytes` says where it cannot write
        folder.mkdir(parents=True, exist_ok=True)
    write_bytes(picture, png(figure, DPI))
    for ending, content in made.items():
        write_bytes(folder / f"{name}.{ending}", content)
    return picture, page


@contextmanager
def _without_layout_tables() -> Iterator[None]:
    """Leave out of fonts what places letters that are placed already: reading it is half of a PDF's time."""
    load = subset.load_font

    def bare(*given: Any, **options: Any) -> Any:
        font = load(*given, **options)
        for table in {"GDEF", "GPOS", "GSUB"} & set(font.keys()):
            del font[table]
        return font

    subset.load_font = bare
    try:
        yield
    finally:
        subset.load_font = load


@styled
def png(figure: Figure, dpi: int) -> bytes:
    """A figure as a picture in memory."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=dpi)
    return file.getvalue()


def line(i: int) -> dict[str, Any]:
    """Colour and dashes of the i-th line: 35 before a pair returns."""
    return {"color": COLOURS[i % len(COLOURS)], "ls": DASHES[i % len(DASHES)]}


def look(name: str, i: int) -> dict[str, Any]:
    """Colour and dashes of a line by its role, that of the first word of its name, or by its number.

    A line of "soft, changed somehow" is that of "soft", thicker.
    """
    head, _, changed = name.partition(", ")
    role = ROLES.get(head.split(" (")[0])
    return role | ({"lw": 2.2} if changed else {}) if role else line(i)


def marker(i: int) -> dict[str, Any]:
    """Colour and shape of the i-th kind of points."""
    return {"color": COLOURS[i % len(COLOURS)], "marker": MARKERS[i % len(MARKERS)], "ls": "", "mew": 0}


def legend_above(
    figure: Figure, handles: Sequence[Any], labels: Sequence[str], title: str | None = None
) -> None:
    """One legend above all axes, with as many columns as fit beside each other."""
    short = wrapped(labels)
    columns = legend_columns(short, figure.get_figwidth())
    rows = -(-len(short) // columns) + (title is not None)
    figure.set_figheight(figure.get_figheight() + 0.17 * rows)  # the legend takes nothing from the axes
    figure.legend(handles, short, loc="outside upper center", ncols=columns, title=title)


def wrapped(labels: Iterable[str]) -> list[str]:
    """Labels of a legend, long ones in several lines."""
    return [textwrap.fill(label, 40) for label in labels]


def legend_width(labels: Sequence[str]) -> float:
    """How wide a column of a legend with these labels is, inches."""
    longest = max((len(part) for label in labels for part in label.split("\n")), default=0)
    # an 8 pt letter is about 0.062 inches wide, a line and the gaps beside it 0.45
    return 0.45 + 0.062 * longest


def legend_columns(labels: Sequence[str], width: float) -> int:
    """How many columns of a legend with these labels fit into a width, inches."""
    return min(max(int(width / legend_width(labels)), 1), max(len(labels), 1))


def legend_entry(axes: Axes, label: str, **looks: Any) -> None:
    """An entry of the legend that is not drawn."""
    axes.plot([], [], label=label, **looks)[0].set_in_layout(False)


def label_lines(axes: Axes, lines: Mapping[str, ArrayLike], looks: Mapping[str, Mapping[str, Any]]) -> None:
    """Name lines where each is farthest from the others, in its colour.

    Parameters
    ----------
    axes : Axes
        That the lines are drawn on, with limits that stay.
    lines : mapping of str to (m, 2)
        Points of each, by its name.
    looks : mapping of str to dict
        Of each, with its "color".
    """
    axes.figure.draw_without_rendering()  # places in pixels hold only in a laid-out figure
    frame, point = axes.get_window_extent(), axes.figure.dpi / 72
    at = {name: _dense(axes.transData.transform(np.asarray(points, float))) for name, points in lines.items()}
    none, taken = np.full((1, 2), 1e6), [np.full((1, 2), 1e6)]
    for name, own in at.items():
        half = point * np.array([0.5 * 4.8 * len(name), 5.0])  # of the name's box
        away = (half[1] + 2 * point) * np.array([1, -1, 2, -2, 4, -4, 6, -6])  # above the line, or below it
        boxes = np.concatenate([np.add(own, [0.0, step]) for step in away])
        far_off = np.repeat(abs(away), len(own))
        low, high = np.array([[frame.x0, frame.y0], [frame.x1, frame.y1]])
        inside = ((boxes - half >= low) & (boxes + half <= high)).all(axis=1)
        if inside.any():
            boxes, far_off = boxes[inside], far_off[inside]
        rest = [none, *(points for other, points in at.items() if other != name)]
        names, near, far = (
            _apart(boxes, half, points).min(axis=1) for points in map(np.concatenate, (taken, [own], rest))
        )
        # off all names and its own line, far from all others, as near to the middle as that lets it
        aside = abs(boxes[:, 0] - frame.x0 - frame.width / 2) / frame.width
        score = 999 * names.clip(max=2 * point) + 99 * np.minimum(near, far).clip(max=1.5 * point)
        score += far.clip(max=40 * point) - 8 * point * aside - 2 * far_off
        place = boxes[int(score.argmax())]
        taken.append(place + half * np.mgrid[-1:1:15j, -1:1:3j].reshape(2, -1).T)
        axes.annotate(
            as_text(name), axes.transData.inverted().transform(place), ha="center", va="center",
            color=looks[name]["color"], zorder=8,
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
        )  # fmt: skip


def _apart(boxes: Array, half: Array, points: Array) -> Array:
    """How far points are from boxes about places, (boxes, points)."""
    away: Array = np.linalg.norm(np.maximum(abs(points - boxes[:, None]) - half, 0.0), axis=-1)
    return away


def _dense(points: Array) -> Array:
    """Two hundred points at equal steps along a line, without those that are not finite."""
    points = points[np.isfinite(points).all(axis=1)]
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    at = np.linspace(0.0, along[-1], 200)
    return np.stack([np.interp(at, along, part) for part in points.T], axis=-1)


def message(axes: Axes, text: str) -> None:
    """A plain statement where there is nothing to draw; ticks would be those of no data."""
    axes.tick_params(left=False, labelleft=False)
    axes.text(0.5, 0.5, textwrap.fill(text, 60), transform=axes.transAxes, ha="center", va="center")


def no_frame(axes: Axes) -> None:
    """Take away ticks and frame of a table that is drawn as cells."""
    axes.tick_params(which="both", length=0)
    for side in axes.spines.values():
        side.set_visible(False)


def formula(value: float) -> str:
    """A number as `numbers.number` writes it, with a true minus sign and its power of ten raised."""
    mantissa, _, power = number(value).partition("e")
    return rf"${mantissa}\times10^{{{power}}}$" if power else mantissa.replace("-", "\N{MINUS SIGN}")


def as_text(name: str) -> str:
    """A user's name as a label: no formula between dollars, and no "_" before it, which would hide it."""
    plain = name.replace("$", r"\$")
    return f" {plain}" if plain.startswith("_") else plain
