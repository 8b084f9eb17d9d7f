"""Several runs side by side, on the terminal and as summary.csv and report.html: a multirun, or any runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from footopt.errors import FileError
from footopt.files.run import write_csv
from footopt.report import page
from footopt.report.numbers import number
from footopt.report.runs import Run, read_run
from footopt.report.terminal import console, table


def of_multirun(folder: Path) -> int:
    """Print and write what the jobs below a folder found.

    Each job is a folder with its result.json, or with an `ERROR_FILE` if it failed.

    Returns
    -------
    int
        How many jobs failed.
    """
    jobs = sorted((p for p in folder.iterdir() if p.name.isdigit()), key=lambda p: int(p.name))
    runs = [read_run(job, f"job {job.name}", job.name) for job in jobs]
    _compare(folder, runs, f"{len(jobs)} jobs in {folder}")
    return sum(run.failed for run in runs)


def of_runs(folder: Path, folders: Sequence[Path]) -> None:
    """The same of runs anywhere, into `folder`.

    Raises
    ------
    FileError
        None of them has a foot.
    """
    runs = [read_run(path, f"run {i}", str(path), str(path)) for i, path in enumerate(folders, start=1)]
    if all(run.result is None for run in runs):
        raise FileError(
            f"study.runs: none of the {len(runs)} folders has a foot to compare. "
            "Give runs of study=optimize, simulate or robust."
        )
    _compare(folder, runs, f"{len(runs)} runs")


def _compare(folder: Path, runs: Sequence[Run], headline: str) -> None:
    """The table, on the terminal and as summary.csv and report.html in `folder`."""
    what = runs[0].name.split()[0]
    common = set.intersection(*(set(run.overrides) for run in runs)) if len(runs) > 1 else set()
    names = list(dict.fromkeys(name for run in runs for name in run.objectives))
    units = {name: unit for run in runs for name, unit in (run.result or {}).get("units", {}).items()}
    titles = [f"{name.replace('_', ' ')} ({units.get(name, '')})".removesuffix(" ()") for name in names]
    first = f"{what} and settings"
    shown = table((first, *titles, "hollow (mm)"), words=(first,))
    for run in runs:
        own = [override for override in run.overrides if override not in common]
        label = "\n  ".join([f"{run.name.split()[1]}: {''.join(own[:1])}", *own[1:]])
        values = [number(run.objectives.get(name, math.nan)) for name in names]
        shown.add_row(label, *values, number(run.hollow))
    out = console()
    out.print(headline, soft_wrap=True)
    out.print(shown)
    for run in runs:
        if said := "; ".join(filter(None, [run.place, run.note])):
            out.print(f"{run.name}: {said}", soft_wrap=True)
    rows = (
        [
            run.key,
            " ".join(run.overrides),
            *(run.objectives.get(name) for name in names),
            number(run.hollow),
            " ".join(map(str, run.k)),
            run.note,
        ]
        for run in runs
    )
    write_csv(folder / "summary.csv", [what, "overrides", *names, "hollow_mm", "k", "note"], rows)
    page.write(folder / "report.html", page.jobs_content(folder, runs, sorted(common)))
