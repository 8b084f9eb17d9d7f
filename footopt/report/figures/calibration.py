"""The figure of study=calibrate: zeta by depth."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from footopt.report.style import (
    COLUMN,
    GRID,
    PALE,
    legend_above,
    marker,
    new_figure,
    styled,
)

HIGHEST = 2.5  # of the mean: what is shown of shallow measurements, whose zeta is noise


@styled
def calibration(found: Any) -> Figure:
    """Draw every measurement's force over that of the map at zeta 1 (`footopt.studies.calibration`)."""
    figure = new_figure(COLUMN, 2.5)
    deep = figure.subplots()
    mm = 1e3 * found.depth
    deep.axhspan(found.zeta.low, found.zeta.high, color=PALE, lw=0, label="95 % interval of $\\zeta$")
    deep.axhline(found.zeta.value, color="black", lw=0.8, label="linear in depth, as footopt has it")
    for i, s in enumerate(found.set_ups):
        own = found.which == i
        look = marker(i) | {"ms": 3, "alpha": 0.7}
        deep.plot(mm[own], found.local[own], **look, label=s.name if len(found.set_ups) > 1 else "measured")
    depth = np.geomspace(found.depth.min(), found.depth.max(), 200)
    power = f"depth to the power {found.exponent.value:.2f}"
    deep.plot(1e3 * depth, found.zeta_at(depth), color="black", ls="--", label=power)
    deep.set(xlabel="depth (mm)", ylabel=r"local $\zeta$: force over the map's")
    deep.set_xlim(0.0, None)
    top = HIGHEST * max(found.zeta.value, float(found.zeta_at(depth).max()) / 1.5)
    deep.set_ylim(0.0, min(top, 1.1 * float(np.max(found.local))))
    deep.grid(color=GRID, lw=0.6)
    legend_above(figure)
    return figure
