"""The look of every figure: colours by role, fonts, widths, and how a figure is made and saved.

No pyplot and so no global figure state. Widths are a journal's column and page; colours of roles are told
apart by the colour-blind, and line styles differ, too.
"""

import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.resources import files as resources
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib import rc_params_from_file
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import LayoutEngine
from matplotlib.transforms import ScaledTranslation

from footopt.errors import check
from footopt.files.io import write_whole
from footopt.walk import Walk

Axes = Any  # matplotlib.axes.Axes

COLUMN, PAGE = 3.4, 7.0  # widths, inches
LEFT, BOTTOM, RIGHT = 0.7, 0.42, 0.14  # margins, inches: on the left for a label and seven digits
HIGHEST = 3.0  # times its width: of a figure whose axes have equal scales
DPI = 200
SLIGHTLY = {"compress_level": 2}  # pictures are 12 % larger than usual, and compressed in 0.7 of the time
DATES = {"png": "Software", "pdf": "CreationDate", "svg": "Date"}  # metadata that would differ each time

GREY, PALE = "0.55", "0.92"
#: Of lines and points that have no role: none of these is a role's colour.
COLOURS = ("#332288", "#CC6677", "#999933", "#000000", "#7F6BD1", "#B3003C", "#4B5320")
DASHES: tuple[Any, ...] = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)))
MARKERS = "osD^vP*"

#: Sands in the paper's order.
SANDS = ("soft", "hard", "regular")
#: Name and colour of the left and the right leg.
SIDES = (("left", "#0072B2"), ("right", "#D55E00"))
#: Designs (the best foot, the chosen one, all), and the flat sole that they are compared with.
BEST, FLAT, CHOSEN, DESIGNS = "#009E73", "#707070", "#882255", "#56B4E9"
SAND, SURFACE, STRONG_SAND = "#F3E9D2", "#E69F00", "#7A5230"
#: Lines that look the same in every figure, by what they are; a stronger sand is darker.
ROLES: dict[str, dict[str, Any]] = {
    "best": {"color": BEST},
    "chosen": {"color": BEST},
    "robust": {"color": BEST},
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

STYLE = rc_params_from_file(str(resources("footopt.report") / "footopt.mplstyle"), use_default_template=False)


@contextmanager
def styled() -> Iterator[None]:
    """Run a function, as its decorator, or a block under the shared style."""
    with matplotlib.rc_context(STYLE):
        yield


class Margins(LayoutEngine):
    """The same margins in every figure: frames line up, and no text but a legend's is measured.

    The `top` is for a power of ten or a title, `across` and `down` are gaps between axes; all in inches.
    """

    _adjust_compatible = _colorbar_gridspec = True

    def __init__(self, top: float = 0.18, across: float = 0.0, down: float = 0.0) -> None:
        super().__init__()
        self.top, self.across, self.down = top, across, down

    def execute(self, fig: Any) -> None:
        """Place the axes of a figure below its legends."""
        size, gaps = fig.get_size_inches(), np.array([self.across, self.down])
        top = self.top + sum(legend.get_window_extent().height for legend in fig.legends) / fig.dpi
        (left, bottom), (right, high) = np.array([LEFT, BOTTOM]) / size, 1.0 - np.array([RIGHT, top]) / size
        counts = np.array(fig.axes[0].get_gridspec().get_geometry()[::-1])  # of columns and of rows
        frame = size * (right - left, high - bottom)
        spaces = counts * gaps / (frame - (counts - 1) * gaps)  # matplotlib measures gaps in axes
        fig.subplots_adjust(left, bottom, right, high, *spaces)


def new_figure(width: float, height: float, layout: LayoutEngine | None = None) -> Figure:
    """An empty figure (inches), laid out at its picture's resolution: formulas are parsed once for both."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout=layout or "constrained")
    FigureCanvasAgg(figure)  # with another canvas its picture would have a renderer of its own
    return figure


def lay_out(figure: Figure) -> None:
    """Have a figure's layout place its axes, without the time of a drawing."""
    if (engine := figure.get_layout_engine()) is not None:
        engine.execute(figure)


def fit_height(figure: Figure, column: Sequence[Axes]) -> None:
    """Make a figure as high as the axes of its first column need at equal scales, and lay it out."""
    equal = [axes for axes in figure.axes if axes.get_aspect() == 1.0]
    for axes in equal:
        axes.set_aspect("auto")  # the layout leaves no room for the labels of axes that shrink
    lay_out(figure)
    more = 0.0
    for axes in (axes for axes in column if axes in equal):
        box, (left, right), (low, high) = axes.get_window_extent(), axes.get_xlim(), axes.get_ylim()
        more += box.width * (high - low) / (right - left) - box.height
    figure.set_figheight(min(figure.get_figheight() + more / figure.dpi, HIGHEST * figure.get_figwidth()))
    lay_out(figure)
    for axes in equal:
        axes.set_aspect("equal")
    figure.set_layout_engine("none")


@styled()
def save(
    figure: Figure, folder: str | Path, name: str, formats: Sequence[str] = ("png", "pdf")
) -> tuple[Path, ...]:
    """Write a figure as NAME.png (200 dpi), NAME.pdf or NAME.svg into a folder: the paths of its `formats`.

    The same figure gives the same bytes. Raises `FileError` where a file cannot be written.
    """
    lay_out(figure)
    figure.set_layout_engine(None)  # all files have the same layout
    paths = tuple(Path(folder, f"{name}.{ending}") for ending in formats)
    for path, ending in zip(paths, formats, strict=True):
        options: dict[str, Any] = {"pil_kwargs": SLIGHTLY} if ending == "png" else {}
        with write_whole(path) as new:
            figure.savefig(new, format=ending, metadata={DATES[ending]: None}, **options)
    return paths


def line_up_labels(axes: Axes) -> None:
    """Put the labels of both axes at the places for which `Margins` have room, whatever the ticks are."""
    frame, inches = axes.transAxes, axes.figure.dpi_scale_trans
    axes.xaxis.set_label_coords(0.5, 0.0, frame + ScaledTranslation(0.0, 0.16 - BOTTOM, inches))
    axes.yaxis.set_label_coords(0.0, 0.5, frame + ScaledTranslation(0.17 - LEFT, 0.0, inches))


def legend_above(figure: Figure) -> None:
    """One legend above all axes: a name for each thing, with as many columns as fit beside each other."""
    handles: dict[str, Any] = {}
    for axes in figure.axes:
        handles |= dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    if not handles:
        return
    labels = [textwrap.fill(label, 50) for label in handles]
    longest = max(len(part) for label in labels for part in label.split("\n"))
    # an 8 pt letter is about 0.062 inches wide, a line and the gaps beside it 0.45
    columns = min(max(int(figure.get_figwidth() / (0.45 + 0.062 * longest)), 1), len(labels))
    figure.set_figheight(figure.get_figheight() + 0.17 * -(-len(labels) // columns))  # taken from no axes
    figure.legend([*handles.values()], labels, loc="outside upper center", ncols=columns)


def look(name: str, i: int) -> dict[str, Any]:
    """Colour and dashes of a line by its role, with which its name begins, or by its number."""
    line = {"color": COLOURS[i % len(COLOURS)], "ls": DASHES[i % len(DASHES)]}  # 35 before a pair returns
    return ROLES.get(name.split(" (")[0], line)


def marker(i: int) -> dict[str, Any]:
    """Colour and shape of the i-th kind of points."""
    return {"color": COLOURS[i % len(COLOURS)], "marker": MARKERS[i % len(MARKERS)], "ls": "", "mew": 0}


def message(axes: Axes, text: str) -> None:
    """A plain statement where there is nothing to draw; ticks would be those of no data."""
    axes.tick_params(left=False, labelleft=False)
    axes.text(0.5, 0.5, textwrap.fill(text, 60), transform=axes.transAxes, ha="center", va="center")


def as_text(name: str) -> str:
    """A user's name as a label: no formula between dollars, and no "_" before it, which would hide it."""
    plain = name.replace("$", r"\$")
    return f" {plain}" if plain.startswith("_") else plain


def sides(walk: Walk) -> list[tuple[str, str]]:
    """Name and colour of each of a walk's feet, of which pictures have one or two."""
    check(len(walk.sides) <= len(SIDES), "robot.feet", len(walk.sides), "one or two, for pictures")
    return [(side, colour) for side, (_, colour) in zip(walk.sides, SIDES, strict=False)]


def walk_label(label: str, walk: Walk) -> str:
    """A walk's label, with the reason if it failed."""
    return as_text(label) if walk.feasible else f"{as_text(label)} (failed: {walk.reason})"
