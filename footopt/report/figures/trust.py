"""The figure of study=trust: how soon solvers find the exact answer, one column a sand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from footopt.report.style import GRID, PAGE, line, new_figure, styled


@styled
def trust(attempts: Mapping[str, Sequence[Any]], solvers: Sequence[str], evaluations: int) -> Figure:
    """Runs that have found the optimum (one objective), and share of the exact front (several).

    Parameters
    ----------
    attempts : mapping of str to sequence of footopt.design.truth.Attempt
        By sand.
    solvers : sequence of str
        Names, in the legend's order.
    evaluations : int
        That each attempt had.
    """
    several = {a.solver for rows in attempts.values() for a in rows if a.checkpoints}
    rows = [
        ("runs that found\nthe optimum (%)", [name for name in solvers if name not in several]),
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
                    ax.plot(*_hits(own, evaluations), **line(i), label=name, drawstyle="steps-post")
            ax.grid(color=GRID, lw=0.6)
        row[0].set_ylabel(title)
        row[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5), borderaxespad=0.4)
    for ax, sand in zip(axes[0], attempts, strict=True):
        ax.set_title(f"{sand} sand")
    for ax in axes[-1]:
        ax.set_xlabel("evaluations")
        ax.set_xlim(0, 1.08 * evaluations)
    return figure


def _hits(own: Sequence[Any], evaluations: int) -> tuple[list[float], list[float]]:
    """Share of attempts that have found the optimum from each hit on, against evaluations."""
    at = sorted(a.found_at for a in own if np.isfinite(a.found_at))
    shares = [100.0 * i / len(own) for i in range(len(at) + 1)]
    return [0.0, *at, float(evaluations)], [*shares, shares[-1]]


def _shares(own: Sequence[Any]) -> tuple[list[float], list[float]]:
    """Median share of the exact hypervolume at the checkpoints."""
    points = np.array([a.checkpoints for a in own])
    x, y = np.median(points, axis=0).T
    return x.tolist(), (100.0 * y).tolist()
