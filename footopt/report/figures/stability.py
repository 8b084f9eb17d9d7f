"""The figure of study=stability: cases as rows, methods as columns, the deciding number in each cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from footopt.report.figures.heat_map import ROW, draw_heat_map
from footopt.report.style import PAGE, new_figure, styled

WORDS = ("sunk", "backward", "diverged", "no failure", "refused", "accepted")  # say it without a number
CHECK = "✓"
VERDICTS = ListedColormap(["#F7C6A3", "#DBEAF3"])  # not stable, stable


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
    """Stable (a tick) or not (what decides, and its value), for each case and method."""
    figure = new_figure(PAGE, 0.75 + ROW * len(cases))
    rows = [[cells[case, method] for method in methods] for case in cases]
    stable = np.array([[cell.stable for cell in row] for row in rows], float)
    texts = [[CHECK if cell.stable else cell.text for cell in row] for row in rows]
    names = ["\n".join(method.rsplit("_", 1)).replace("_", " ") for method in methods]
    draw_heat_map(figure.subplots(), stable, cases, names, texts, Normalize(0.0, 1.0), VERDICTS)
    figure.supxlabel(f"{CHECK} stable; where it is not: the measure that is furthest beyond its limit")
    return figure
