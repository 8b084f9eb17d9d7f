"""Which feet are there? The best sole of every cell of a map, from all walks that a search has left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table as RichTable

from footopt.design import FootProblem, Store
from footopt.design.atlas import Atlas, atlas
from footopt.errors import SettingError, check
from footopt.foot import Foot
from footopt.foot.waypoints import written
from footopt.report import terminal
from footopt.report.figures.atlas import atlas as figure
from footopt.studies.base import Study, flat_efficiency
from footopt.studies.build import make_problem
from footopt.studies.load import read
from footopt.studies.record import accuracy_entry, scene_entry
from footopt.studies.validation.model import model_error
from footopt.walk import MEASURES, simulate
from footopt.walk.objectives import Objective

TRY = "Try footopt study=atlas run=outputs/optimize/..."


def run(study: Study) -> None:
    """Draw the map of the run `study.run`, from its store."""
    options = study.options
    if options.run is None:
        raise SettingError("run", None, "the folder of a search", TRY)
    searched = read(options.run, "run")
    name = searched.config.study.name
    check(name == "optimize", "run", options.run, "the folder of a study=optimize", TRY)
    problem = make_problem(searched.config, searched.scene)
    problem.threads = study.threads
    path = Path(searched.config.study.store or searched.folder / "designs.sqlite")
    check(path.is_file(), "run", options.run, f"the folder of a run whose {path.name} is there", TRY)
    with Store(path, problem, options.reuse) as store:
        found = atlas(problem, store, options.descriptors, options.cells)
    quality, guide = quality_of(problem, found), problem.guide
    base = flat_efficiency(problem)
    heights = [f"k{i + 1}" for i in range(problem.space.n)]
    rows = zip(*(part.tolist() for part in (found.cells, found.values, found.counts, found.k)), strict=True)
    study.write_csv(
        "atlas.csv",
        ["cell_1", "cell_2", guide, *found.names, "designs", *heights],
        ([*cell, *values, count, *k] for cell, values, count, k in rows),
    )
    drawn = figure(
        found.edges,
        found.cells,
        list(problem.space.contour(found.k)),
        quality if base is None else found.values[:, 0] / base,
        [MEASURES[n].label for n in found.names],
        f"{MEASURES[guide].label}, relative to the best" if base is None else "$J_W$ (× of flat)",
    )
    caption = f"In every cell the sole with the best {guide.replace('_', ' ')}; its heights are enlarged."
    if base is not None:
        caption += f" The flat sole's J_W is {terminal.number(base)}."
    study.save("atlas", drawn, caption)
    filled, good = f"{len(found.cells)} of {options.cells**2}", int(found.counts.sum())
    going_by = " and ".join(name.replace("_", " ") for name in found.names)
    best = Foot.from_waypoints(found.k[quality.argmax()].tolist(), problem.space)
    walk = simulate(best, problem.scene, problem.accuracy)
    model = model_error(walk, spread=searched.config.study.spread.zeta)
    study.conclude(
        "An atlas of feet",
        [table(problem, found, base)],
        {
            "run": options.run,
            "atlas": {
                "descriptors": found.names,
                "edges": found.edges,
                "cells": found.cells,
                "k": found.k,
                "values": found.values,
                "columns": (guide, *found.names),
                "counts": found.counts,
            },
            **scene_entry(problem.scene, problem.accuracy, problem.record),
            "accuracy": accuracy_entry(problem.accuracy, problem.scene, problem.space),
            "designs": found.walks,
            "model_error": model,
        },
        said=[
            f"{found.walks} designs of {options.run}, {good} of them feasible, fill {filled} cells of "
            f"{going_by}: atlas.csv has all",
            *terminal.describe_model([model]),
        ],
    )


def quality_of(problem: FootProblem, found: Atlas) -> Any:
    """How good each cell is, (filled,): 1 is the best of all, half as good is 0.5."""
    values = found.values[:, 0]
    if MEASURES[problem.guide].maximise or (values < 0.0).all():
        best = values[np.abs(values).argmax()]
        return values / best if best else np.ones(len(values))
    return values.min() / np.where(values > 0.0, values, 1.0)


def table(problem: FootProblem, found: Atlas, base: float | None) -> RichTable:
    """The best of each column of the map."""
    along, across = (MEASURES[name] for name in found.names)
    guide = MEASURES[problem.guide]
    against = [] if base is None else ["J_W, x of flat"]
    columns = (_head(along), *against, _head(guide), _head(across), "designs")
    title = f"The best sole for every {along.name.replace('_', ' ')}"
    shown = terminal.table((*columns, "k"), words=("k",), title=title)
    for column in np.unique(found.cells[:, 0]):
        rows = np.flatnonzero(found.cells[:, 0] == column)
        best = rows[(guide.sign * found.values[rows, 0]).argmin()]
        value, first, second = map(terminal.number, found.values[best].tolist())
        count = str(int(found.counts[rows].sum()))
        multiple = [] if base is None else [f"{found.values[best, 0] / base:.2f}"]
        shown.add_row(first, *multiple, value, second, count, written(found.k[best]))
    return shown


def _head(measure: Objective) -> str:
    return measure.name.replace("_", " ") + (f" ({measure.unit})" if measure.unit else "")
