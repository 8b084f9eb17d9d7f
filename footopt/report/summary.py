"""Several runs side by side, on the terminal and as summary.csv and report.html: a multirun, or any runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from footopt.errors import FileError
from footopt.files import identity
from footopt.files.io import write_csv
from footopt.foot.waypoints import written
from footopt.report import page, sweeps
from footopt.report.figures.fronts import fronts as draw_fronts
from footopt.report.numbers import number
from footopt.report.runs import Run, read_run
from footopt.report.style import save
from footopt.report.terminal import console, describe_model, table

SHOWN = 60  # runs of the table on the terminal
ROOM, COLUMN, SPREAD = 26, 10, 12  # letters of its first and last column, and of each between


def of_multirun(folder: Path) -> int:
    """Print and write what the jobs below a folder found.

    Each job is a folder with its result.json, or with an `ERROR_FILE` if it failed.

    Returns
    -------
    int
        How many jobs failed, or walked with a foot that failed.
    """
    names = [str(job.relative_to(folder)) for job in identity.jobs(folder)]
    runs = [read_run(folder / name, f"job {name}", name) for name in names]
    _compare(folder, runs, f"{len(runs)} jobs in {folder}")
    return sum(run.failed or run.walk_failed for run in runs)


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


def _more_columns(runs: Sequence[Run], found: Sequence[sweeps.Fronts]) -> dict[str, list[float]]:
    """What else a row of summary.csv has of each run."""
    share = {i: s for fronts in found for i, s in zip(fronts.places, fronts.shares, strict=True)}
    results = [run.result or {} for run in runs]
    more = {
        "hollow_mm": [run.hollow for run in runs],
        "seconds": [float(r.get("wall_time_s", math.nan)) for r in results],
        "evaluations": [float(r.get("evaluations", math.nan)) for r in results],
        "warnings": [float(len(r["warnings"])) if "warnings" in r else math.nan for r in results],
    }
    if share:
        more["front"] = [float(len(r["front"])) if r.get("front") else math.nan for r in results]
        more["hypervolume_share"] = [share.get(i, math.nan) for i in range(len(runs))]
    return more


def _say_seeds(
    out: Console,
    folder: Path,
    groups: Sequence[tuple[dict[str, str], int, dict[str, sweeps.Spread]]],
    names: Sequence[str],
) -> None:
    """Median and quartiles over seeds, on the terminal and as seeds.csv; nothing without seeds."""
    if not groups:
        return
    settings, values = list(groups[0][0]), list(groups[0][2])
    shown = [*(["hypervolume_share"] if "hypervolume_share" in values else []), *names]
    shown = shown[: max((out.width - ROOM) // SPREAD, 1)]
    made = table(("settings", "seeds", *(n.replace("_", " ") for n in shown)), words=("settings",),
                 title="Median over seeds, and from the first to the third quartile")  # fmt: skip
    for own, count, spreads in groups:
        cells = [
            f"{number(s.median)}\n{number(s.low)} ..\n{number(s.high)}" for s in (spreads[n] for n in shown)
        ]
        made.add_row(" ".join(filter(None, own.values())) or "all", str(count), *cells)
    out.print(made)
    if left := [name.replace("_", " ") for name in names if name not in shown]:
        out.print(f"In {folder / 'seeds.csv'}, too: {', '.join(left)}", soft_wrap=True)
    header = [f"{name}_{part}" for name in values for part in ("median", "q1", "q3")]
    rows = [
        [*own.values(), count, *(v for s in spreads.values() for v in (s.median, s.low, s.high))]
        for own, count, spreads in groups
    ]
    write_csv(folder / "seeds.csv", [*settings, "seeds", *header], rows)


def _compare(folder: Path, runs: Sequence[Run], headline: str) -> None:
    """The table, on the terminal and as summary.csv and report.html in `folder`."""
    what = runs[0].name.split()[0]
    common = set.intersection(*(set(run.overrides) for run in runs)) if len(runs) > 1 else set()
    names = list(dict.fromkeys(name for run in runs for name in run.objectives))
    units = {name: unit for run in runs for name, unit in (run.result or {}).get("units", {}).items()}
    titles = [f"{name.replace('_', ' ')} ({units.get(name, '')})".removesuffix(" ()") for name in names]
    first = f"{what} and settings"
    out = console()
    fit = max((out.width - ROOM) // COLUMN, 1)  # numbers that were cut would tell nothing
    shown = table((first, *titles[:fit], "hollow (mm)"), words=(first,))
    for run in runs[:SHOWN]:
        own = [override for override in run.overrides if override not in common] or ["by default"]
        label = "\n  ".join([f"{run.name.partition(' ')[2]}: {''.join(own[:1])}", *own[1:]])
        values = [number(run.objectives.get(name, math.nan)) for name in names[:fit]]
        shown.add_row(label, *values, number(run.hollow))
    out.print(headline, soft_wrap=True)
    out.print(shown)
    if left := titles[fit:]:
        out.print(f"In {folder / 'summary.csv'}, too: {', '.join(left)}", soft_wrap=True)
    if len(runs) > SHOWN:
        out.print(f"... and {len(runs) - SHOWN} more in {folder / 'summary.csv'}", soft_wrap=True)
    for run in runs:
        if said := "; ".join(filter(None, [run.place, run.note])):
            out.print(f"{run.name}: {said}", soft_wrap=True)
    for words in describe_model((run.result or {}).get("model_error") for run in runs):
        out.print(words)
    settings, found = sweeps.varied(runs), sweeps.fronts(runs)
    columns = {name: [run.objectives.get(name, math.nan) for run in runs] for name in names}
    columns |= _more_columns(runs, found)
    rows = (
        [
            run.key,
            *(values[i] for values in settings.values()),
            *(values[i] for values in columns.values()),
            written(run.k) if run.k else "",
            run.note,
            " ".join(run.overrides),
        ]
        for i, run in enumerate(runs)
    )
    write_csv(folder / "summary.csv", [what, *settings, *columns, "k", "note", "overrides"], rows)
    _say_seeds(out, folder, sweeps.over_seeds(runs, columns), names)
    for i, fronts in enumerate(found):
        if len(fronts.places) > 1:
            name = "fronts" if len(found) == 1 else f"fronts_{i + 1}"
            save(draw_fronts(fronts), folder / "figures", name)
            out.print(f"Fronts side by side: {folder / 'figures' / name}.png", soft_wrap=True)
    page.write(folder / "report.html", page.jobs_content(folder, runs, sorted(common)))
