"""The page over the jobs of a multirun, or other runs: soles, values and traces side by side."""

from __future__ import annotations

import os
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from footopt.report.numbers import number
from footopt.report.page.file import column, packed
from footopt.report.terminal import describe_model
from footopt.walk import MEASURES


def jobs_content(folder: Path, runs: Sequence[Any], common: Collection[str]) -> dict[str, Any]:
    """The page in a folder over several runs (`footopt.report.summary.Run`) that share some overrides."""
    done = [run for run in runs if run.result]
    results = [run.result for run in done]
    known = {name: (objective.unit, objective.maximise) for name, objective in MEASURES.items()}
    for result in results:  # those of plugins are in their own results
        known |= {name: (result["units"][name], most) for name, most in result.get("maximise", {}).items()}
    # what not all have could not be compared
    names = [name for name in known if done and all(name in run.objectives for run in done)]
    values = np.array([[run.objectives[name] for name in names] for run in done], float)
    columns = [column(name, *known[name]) for name in names]
    flat = np.array([(result.get("flat") or {}).get("efficiency", np.nan) for result in results], float)
    if "efficiency" in names and np.isfinite(flat).all():
        values[:, names.index("efficiency")] /= flat
        columns[names.index("efficiency")] |= {"title": "J_W", "unit": "x of flat", "maximise": True}
    return {
        "title": f"{len(runs)} {runs[0].name.split()[0]}s",
        "headline": [
            *([f"All with {' '.join(common)}"] if common else []),
            *describe_model(result.get("model_error") for result in results),
        ],
        "columns": columns,
        "jobs": [
            {
                "name": run.name,
                "place": run.place,
                "settings": " ".join(o for o in run.overrides if o not in common),
                "hollow": number(run.more.get("hollow_mm", np.nan)),
                "efficiency": run.objectives.get("efficiency"),
                "note": run.note,
                "seed": run.result.get("seed"),
                "seconds": run.result.get("wall_time_s"),
                "design": done.index(run) if run in done else None,
                "link": _link(run.folder / "report.html", folder),
            }
            for run in runs
        ],
        "designs": {
            "values": packed(values),
            "labels": [run.name for run in done],
            # a walk that failed has no values to place it by
            "feasible": [int(not result.get("reason")) for result in results],
            "reasons": [result.get("reason", "") for result in results],
            "soles": [packed(run.contour) for run in done],
        },
        "top": [result["settings"]["foot"]["top"] for result in results],
        "best": 0,
        "entry": {"versions": results[0]["versions"]} if done else None,
        "traces": [
            {"design": i} | {name: packed(trace) for name, trace in run.traces.items()}
            for i, run in enumerate(done)
            if run.traces
        ],
    }


def _link(path: Path, folder: Path) -> str | None:
    """The address of a file, from a page in a folder; None if there is no such file."""
    return quote(Path(os.path.relpath(path, folder)).as_posix()) if path.is_file() else None
