"""The figure of study=stability: cases as rows, methods as columns, the deciding number in each cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from footopt.report.figures import BLUE, PAGE, VERMILLION, styled

ROW, HEAD = 0.19, 0.75  # heights of a row and of titles and key, inches
LABELS = 1.75  # width of the cases' names, inches
FONT = 7.0  # pt, of the cells
WORDS = ("sunk", "backward", "diverged", "no failure", "refused", "accepted")  # say it without a number
CHECK, CROSS = "✓", "✗"


class Cell(NamedTuple):
    """A verdict: stable or not, by which measure and what value."""

    stable: bool
    measure: str
    value: float

    @property
    def text(self) -> str:
        """What decides, and its value to two digits; one where it takes an exponent."""
        if self.measure in WORDS:
            return self.measure
        value = f"{self.value:.0e}" if not 1e-2 <= self.value < 1e3 else f"{self.value:.2g}"
        value = "0" if self.value == 0.0 else value.replace("e-0", "e-").replace("e+0", "e")
        return f"{self.measure} {value.removeprefix('0') if value.startswith('0.') else value}"


@styled
def verdicts(cases: Sequence[str], methods: Sequence[str], cells: Mapping[tuple[str, str], Cell]) -> Figure:
    """Stable (tick, blue) or not (cross, hatched, vermillion), for each case and method."""
    height = HEAD + ROW * len(cases)
    figure = Figure(figsize=(PAGE, height))
    FigureCanvasAgg(figure)
    left, top = LABELS / PAGE, 1.0 - 0.42 / height
    bottom = (HEAD - 0.42) / height
    axes = figure.add_axes((left, bottom, 0.995 - left, top - bottom))
    for row, case in enumerate(cases):
        for column, method in enumerate(methods):
            cell = cells[case, method]
            face = (BLUE, 0.14) if cell.stable else (VERMILLION, 0.30)
            box = Rectangle((column, row), 1, 1, facecolor=face, edgecolor="white", linewidth=1.0)
            axes.add_patch(box)
            if not cell.stable:
                axes.add_patch(
                    Rectangle(
                        (column, row), 1, 1, fill=False, hatch="///", edgecolor=(VERMILLION, 0.25), lw=0
                    )
                )
            axes.text(
                column + 0.5,
                row + 0.5,
                f"{CHECK if cell.stable else CROSS} {cell.text}",
                ha="center",
                va="center_baseline",
                fontsize=FONT,
                fontweight="normal" if cell.stable else "bold",
            )
    axes.set_xlim(0, len(methods))
    axes.set_ylim(len(cases), 0)
    axes.set_xticks(
        [i + 0.5 for i in range(len(methods))],
        ["\n".join(s.rsplit("_", 1)).replace("_", " ") for s in methods],
    )
    axes.set_yticks([i + 0.5 for i in range(len(cases))], list(cases))
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)
    key = [
        Patch(facecolor=(BLUE, 0.14), label=f"{CHECK} stable"),
        Patch(facecolor=(VERMILLION, 0.30), hatch="///", edgecolor=(VERMILLION, 0.25), label=f"{CROSS} not"),
    ]
    figure.legend(handles=key, loc="lower left", bbox_to_anchor=(left, 0.0), ncols=2, borderaxespad=0.2)
    figure.text(
        0.995,
        0.08 / height,
        "in each cell: the measure nearest to its limit, or furthest beyond",
        ha="right",
        fontsize=FONT,
    )
    return figure
