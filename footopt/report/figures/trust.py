"""The figure of study=trust: how soon solvers find the exact answer, one column a sand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from footopt.report.labels import label_all
from footopt.report.style import GRID, PAGE, line, new_figure, styled


@styled
def trust(attempts: Mapping[str, Sequence[Any]], solvers: Sequence[str], walks: int) -> Figure:
    """Runs that have found the optimum (one objective), and share of the exact front (several).

    Parameters
    ----------
    attempts : mapping of str to sequence of footopt.design.truth.Attempt
        By what a panel is called.
    solvers : sequence of str
        Names, in the order of their colours.
    walks : int
        That each attempt had.
    """
    several = {a.solver for rows in attempts.values() for a in rows if a.checkpoints}
    rows = [
        ("runs within 0.1 %\nof the best $J_W$ (%)", [name for name in solvers if name not in several]),
        ("share of the exact\nhypervolume (%)", [name for name in solvers if name in several]),
    ]
    rows = [(title, names) for title, names in rows if names]
    figure = new_figure(PAGE, 0.5 + 1.9 * len(rows))
    axes = figure.subplots(len(rows), len(attempts), sharex=True, sharey="row", squeeze=False)
    for row, (title, names) in zip(axes, rows, strict=True):
        for ax, found in zip(row, attempts.values(), strict=True):
            for i, name in enumerate(names):
                own = [a for a in found if a.solver == name]
                if name in several:
                    ax.plot(*_shares(own), **line(i), label=name)
                else:
                    ax.plot(*_hits(own, walks), **line(i), label=name, drawstyle="steps-post")
            ax.grid(color=GRID, lw=0.6)
        row[0].set_ylabel(title)
    for ax, title in zip(axes[0], attempts, strict=True):
        ax.set_title(title)
    lines = [drawn.get_xydata() for ax in axes.flat for drawn in ax.lines]
    settled = max(*(x[np.flatnonzero(np.diff(x[:, 1], prepend=np.nan))[-1], 0] for x in lines), 1.0)
    for ax in axes[-1]:
        ax.set_xlabel("walks")
        ax.set_xlim(0, min(1.08 * walks, 1.3 * settled))
    for row in axes:
        label_all(row)
    return figure


def _hits(own: Sequence[Any], walks: int) -> tuple[list[float], list[float]]:
    """Share of attempts that have come within 0.1 % of the optimum from each hit on, against walks."""
    at = sorted(a.within_at for a in own if a.hit)
    shares = [100.0 * i / len(own) for i in range(len(at) + 1)]
    return [0.0, *at, float(walks)], [*shares, shares[-1]]


def _shares(own: Sequence[Any]) -> tuple[list[float], list[float]]:
    """Median share of the exact hypervolume at the checkpoints."""
    count = min(len(a.checkpoints) for a in own)
    points = np.array([a.checkpoints[:count] for a in own])
    x, y = np.median(points, axis=0).T
    return x.tolist(), (100.0 * y).tolist()
