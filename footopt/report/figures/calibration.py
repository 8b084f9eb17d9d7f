"""The figure of study=calibrate: zeta by depth, and by repeat."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from footopt.report.style import (
    GREEN,
    GRID,
    PAGE,
    PALE,
    as_text,
    legend_above,
    marker,
    new_figure,
    styled,
)
from footopt.sand.calibration import Calibration

HIGHEST = 2.5  # of the mean: what is shown of shallow measurements, whose zeta is noise
NAMED = 12  # repeats that have room for their names


@styled
def calibration(found: Calibration) -> Figure:
    """Force over the map's force at zeta 1 of every measurement; zeta and exponent of every repeat."""
    figure = new_figure(PAGE, 2.5)
    deep, zetas, exponents = figure.subplots(1, 3, width_ratios=(2.0, 1.0, 1.0))
    mm = 1e3 * found.depth
    deep.axhspan(found.zeta.low, found.zeta.high, color=PALE, lw=0, label="95 % interval of zeta")
    deep.axhline(found.zeta.value, color="black", lw=0.8, label="linear in depth, as footopt has it")
    for i, s in enumerate(found.set_ups):
        own = found.which == i
        look = marker(i) | {"ms": 3, "alpha": 0.7}
        deep.plot(mm[own], found.local[own], **look, label=s.name if len(found.set_ups) > 1 else "measured")
    depth = np.geomspace(found.depth.min(), found.depth.max(), 200)
    power = f"depth to the power {found.exponent.value:.2f}"
    deep.plot(1e3 * depth, found.zeta_at(depth), color=GREEN, ls="--", label=power)
    deep.set(xlabel="depth (mm)", ylabel=r"local $\zeta$: force over the map's")
    deep.set_xlim(0.0, None)
    top = HIGHEST * max(found.zeta.value, float(found.zeta_at(depth).max()) / 1.5)
    deep.set_ylim(0.0, min(top, 1.1 * float(np.max(found.local))))

    rows, names = np.arange(len(found.repeats)), [as_text(name or "the one") for name in found.repeats]
    each = np.array(list(found.repeats.values()))
    parts = ((zetas, found.zeta, r"$\zeta$"), (exponents, found.exponent, "exponent of depth"))
    for ax, estimate, label in parts:
        column = each[:, 0 if ax is zetas else 1]
        ax.axvspan(estimate.low, estimate.high, color=PALE, lw=0)
        ax.axvline(estimate.value, color="black", lw=0.8)
        ax.plot(column, rows, "o", color="black", ms=3.5)
        ax.set_ylim(len(rows) - 0.5, -0.5)
        ax.set_xlabel(label)
        ax.set_yticks(rows if len(rows) <= NAMED else [])
        ax.tick_params(axis="y", length=0)
        ax.margins(x=0.15)
    zetas.set_yticklabels(names if len(rows) <= NAMED else [])
    exponents.set_yticklabels([])
    zetas.set_ylabel("repeat")
    exponents.axvline(1.0, color="black", lw=0.8, ls=":")
    for ax in (deep, zetas, exponents):
        ax.grid(color=GRID, lw=0.6)
    legend_above(figure, *deep.get_legend_handles_labels())
    return figure
