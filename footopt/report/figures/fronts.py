"""Fronts of several solvers and seeds over each other, with the hypervolume of each and what half attain."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from footopt.report.figures.search import scatter_matrix
from footopt.report.numbers import percent
from footopt.report.style import styled

Array = NDArray[np.float64]


class Fronts(NamedTuple):
    """Fronts of one problem that several solvers or seeds have found."""

    names: tuple[str, ...]  # of the objectives
    places: list[int]  # which of the runs they are of
    labels: list[str]  # what each run is called without its seed
    values: list[Array]  # (designs, objectives) each, natural signs
    shares: list[float]  # hypervolume of each, over that of all of them merged


@styled
def fronts(found: Fronts) -> Figure:
    """Every pair of objectives of several fronts; a colour for all runs that differ by their seeds only.

    The legend has the median of each colour's hypervolume, in that of all fronts merged.
    """
    groups, labels = {}, list(dict.fromkeys(found.labels))
    for label in labels:
        own = [i for i, name in enumerate(found.labels) if name == label]
        runs = f"{len(own)} seeds, " if len(own) > 1 else ""
        share = percent(float(np.median([found.shares[i] for i in own])))
        groups[f"{label}: {runs}hypervolume {share}"] = np.concatenate([found.values[i] for i in own])
    return scatter_matrix(groups, found.names)
