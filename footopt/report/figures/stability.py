"""The figure of study=stability: cases as rows, methods as columns, the deciding number in each cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from footopt.report.style import BLUE, PAGE, VERMILLION, new_figure, no_frame, styled

ROW, HEAD = 0.19, 0.75  # heights of a row and of titles and key, inches
FONT = 7.0  # pt, of the cells
WORDS = ("sunk", "backward", "diverged", "no failure", "refused", "accepted")  # say it without a number
CHECK, CROSS = "✓", "✗"
STABLE: dict[str, Any] = {"facecolor": (BLUE, 0.14)}
UNSTABLE: dict[str, Any] = {"facecolor": (VERMILLION, 0.30), "hatch": "///", "edgecolor": (VERMILLION, 0.25)}


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
        return f"{self.measure} {value}"


@styled
def verdicts(cases: Sequence[str], methods: Sequence[str], cells: Mapping[tuple[str, str], Cell]) -> Figure:
    """Stable (tick, blue) or not (cross, hatched, vermillion), for each case and method."""
    figure = new_figure(PAGE, HEAD + ROW * len(cases))
    axes = figure.subplots()
    for row, case in enumerate(cases):
        for column, method in enumerate(methods):
            cell = cells[case, method]
            axes.add_patch(Rectangle((column, row), 1, 1, lw=0, **(STABLE if cell.stable else UNSTABLE)))
            axes.text(
                column + 0.5, row + 0.5, f"{CHECK if cell.stable else CROSS} {cell.text}", ha="center",
                va="center_baseline", fontsize=FONT if cell.stable else 0.9 * FONT,
                fontweight="normal" if cell.stable else "bold",
            )  # fmt: skip
    axes.hlines(range(1, len(cases)), 0, len(methods), color="white", lw=1.0)
    axes.vlines(range(1, len(methods)), 0, len(cases), color="white", lw=1.0)
    axes.set(xlim=(0, len(methods)), ylim=(len(cases), 0))
    names = ["\n".join(method.rsplit("_", 1)).replace("_", " ") for method in methods]
    axes.set_xticks([i + 0.5 for i in range(len(methods))], names)
    axes.set_yticks([i + 0.5 for i in range(len(cases))], list(cases))
    axes.xaxis.tick_top()
    no_frame(axes)
    key = [
        Patch(**STABLE, label=f"{CHECK} stable"),
        Patch(**UNSTABLE, label=f"{CROSS} not"),
        Patch(alpha=0.0, label="in each cell: the measure nearest to its limit, or furthest beyond"),
    ]
    figure.legend(handles=key, loc="outside lower right", ncols=3)
    return figure
