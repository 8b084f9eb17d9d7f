"""Several runs side by side, of a multirun or any: a table, summary.csv, seeds.csv, fronts, report.html."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas
from matplotlib.figure import Figure
from numpy.typing import NDArray

from footopt.design.fronts import hypervolume_shares
from footopt.errors import ERROR_FILE, FileError, flat, one_line
from footopt.files import identity
from footopt.files.drawings import MM
from footopt.files.io import read_json_file, write_csv
from footopt.foot.waypoints import written
from footopt.report import page
from footopt.report.figures.search import scatter_matrix
from footopt.report.numbers import number, percent
from footopt.report.style import save
from footopt.report.terminal import console, describe_model, table

Array = NDArray[np.float64]

SHOWN = 60  # runs of the table on the terminal
ROOM, COLUMN = 26, 10  # letters of its first and last column, and of each between
SEED = "solver.seed"
#: Settings that do not change which problem is searched.
OUTSIDE_PROBLEM = ("solver.", "engine.", "study.", "choose.", "report", "plugins", "accuracy.")
QUANTILES = {"median": 0.5, "q1": 0.25, "q3": 0.75}


@dataclass
class Run:
    """A run, or a job of a multirun, as its folder has it.

    Tables call it by its `name` ("job 3"), summary.csv by its `key`. `result` is its result.json, if that
    is about one foot, and `note` says why there is none, or no better one.
    """

    name: str
    key: str
    folder: Path
    place: str = ""
    overrides: tuple[str, ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)  # by their full names, as text
    result: Mapping[str, Any] = field(default_factory=dict)
    objectives: Mapping[str, float] = field(default_factory=dict)  # NaN without a value
    more: Mapping[str, float] = field(default_factory=dict)  # other numbers of a row of summary.csv
    contour: Array | None = None  # (m, 2), m
    traces: Mapping[str, Array] | None = None  # None for a study of many walks
    note: str = ""
    failed: bool = False  # it ended in an error, or died


def read_run(folder: Path, name: str, key: str, place: str = "") -> Run:
    """Read what a run left; the note says what is damaged, and that it died where it left nothing."""
    run = Run(name, key, folder, place)
    with suppress(FileError):  # it may have failed before it wrote its settings
        found = identity.read(folder)
        run.overrides = found.words
        run.settings = {setting: _text(value) for setting, value in flat(found.settings).items()}
    error = folder / ERROR_FILE
    if error.is_file() or not (folder / "result.json").is_file():
        run.note = error.read_text(encoding="utf-8").strip() if error.is_file() else "no result"
        run.failed = True
        return run
    try:
        result = read_json_file(folder / "result.json", "study.runs")
        if isinstance(result.get("objectives"), dict) and (folder / "contour.csv").is_file():
            _add_foot(run, result)
        else:  # a study of many feet or of none
            run.note = f"study={result['study']}: see its own folder"
    except Exception as problem:  # whatever can be wrong with files that have been damaged
        run.result, run.objectives, run.more, run.failed = {}, {}, {}, True
        run.note = f"damaged: {one_line(f'{type(problem).__name__}: {problem}')}"
    return run


def _add_foot(run: Run, result: Mapping[str, Any]) -> None:
    """Add what a run found for its foot, and check all that tables and pages read of it."""
    values, foot = result["objectives"], result["settings"]["foot"]
    run.objectives = {name: math.nan if value is None else float(value) for name, value in values.items()}
    run.more = {
        "hollow_mm": float(result["design"]["hollow_mm"]),
        "seconds": float(result.get("wall_time_s", math.nan)),
        "evaluations": float(result.get("evaluations", math.nan)),
        "warnings": float(len(result["warnings"])) if "warnings" in result else math.nan,
    }
    contour = np.loadtxt(run.folder / "contour.csv", delimiter=",", skiprows=1, ndmin=2) / MM
    if contour.shape[1:] != (2,) or not np.isfinite([*contour.flat, foot["top"]]).all():
        raise ValueError("contour.csv holds no points")
    run.contour, run.traces = contour, _traces(run.folder / "walk.nc")
    run.note = result.get("reason", "") or ("interrupted" if result.get("interrupted") else "")
    run.result = {"versions": result["versions"], **result}


def _traces(path: Path) -> dict[str, Array] | None:
    """Height, speed, power and work of both feet against time `t`, (T,) each; None if there is no walk."""
    from scipy.io import netcdf_file

    if not path.is_file():
        return None
    with netcdf_file(path, mmap=False) as file:
        t, com, velocity, power, work = (
            np.array(file.variables[name][:]) for name in ("t", "com", "velocity", "power", "work")
        )
    both = {"power": power.sum(axis=1), "work": work.sum(axis=1)}
    return {"t": t, "height": com[:, 1], "speed": velocity[:, 0], **both}


def _text(value: Any) -> str:
    return "" if value is None else f"{value:.12g}" if isinstance(value, float) else str(value)


def of_multirun(folder: Path) -> int:
    """Print and write what the jobs below a folder found; returns how many failed, or whose foot failed."""
    names = [str(job.relative_to(folder)) for job in identity.jobs(folder)]
    runs = [read_run(folder / name, f"job {name}", name) for name in names]
    _compare(folder, runs, f"{len(runs)} jobs in {folder}")
    return sum(
        run.failed or (run.result.get("study") == "simulate" and bool(run.result.get("reason")))
        for run in runs
    )


def of_runs(folder: Path, folders: Sequence[Path]) -> None:
    """The same of runs anywhere, into `folder`; a `FileError` if none of them has a foot."""
    runs = [read_run(path, f"run {i}", str(path), str(path)) for i, path in enumerate(folders, start=1)]
    if not any(run.result for run in runs):
        raise FileError(
            f"study.runs: none of the {len(runs)} folders has a foot to compare. "
            "Give runs of study=optimize, simulate or robust."
        )
    _compare(folder, runs, f"{len(runs)} runs")


def _compare(folder: Path, runs: Sequence[Run], headline: str) -> None:
    """Print the table of runs, and write summary.csv, seeds.csv, the fronts and report.html into a folder."""
    what, out = runs[0].name.split()[0], console()
    names = [*dict.fromkeys(name for run in runs for name in run.objectives)]
    more = dict.fromkeys(name for run in runs for name in run.more)
    values = pandas.DataFrame([{**run.objectives, **run.more} for run in runs], columns=[*names, *more])
    settings, found = _varied(runs), fronts(runs)
    common = set.intersection(*(set(run.overrides) for run in runs)) if len(runs) > 1 else set()
    out.print(headline, soft_wrap=True)
    _print_table(folder, runs, values[names], what, common)
    for run in runs:
        if said := "; ".join(filter(None, [run.place, run.note])):
            out.print(f"{run.name}: {said}", soft_wrap=True)
    out.print(*describe_model(run.result.get("model_error") for run in runs))
    if found:
        sizes = pandas.Series([len(run.result.get("front") or ()) for run in runs], dtype=float)
        values["front"] = sizes.where(sizes > 0)
        values["hypervolume_share"] = pandas.concat([pandas.Series(f.shares, f.places) for f in found])
    whole = pandas.concat([pandas.Series([run.key for run in runs], name=what), settings, values], axis=1)
    whole["k"] = [written(k) if (k := run.result.get("design", {}).get("k")) else "" for run in runs]
    whole["note"] = [run.note for run in runs]
    whole["overrides"] = [" ".join(run.overrides) for run in runs]
    write_csv(folder / "summary.csv", [*whole], whole.to_numpy(object).tolist())
    if (spread := _over_seeds(settings, values)) is not None:
        write_csv(folder / "seeds.csv", [*spread], spread.to_numpy(object).tolist())
        out.print(f"Median and quartiles over seeds: {folder / 'seeds.csv'}", soft_wrap=True)
    for i, one in enumerate(found):
        if len(one.places) > 1:
            name = "fronts" if len(found) == 1 else f"fronts_{i + 1}"
            save(one.figure(), folder / "figures", name)
            out.print(f"Fronts side by side: {folder / 'figures' / name}.png", soft_wrap=True)
    page.write(folder / "report.html", page.jobs_content(folder, runs, sorted(common)))


def _print_table(
    folder: Path, runs: Sequence[Run], values: pandas.DataFrame, what: str, common: set[str]
) -> None:
    """Print a row for each run with as many objectives as fit: numbers that were cut would tell nothing."""
    out, units = console(), {name: unit for run in runs for name, unit in run.result.get("units", {}).items()}
    titles = [f"{name.replace('_', ' ')} ({units.get(name, '')})".removesuffix(" ()") for name in values]
    fit, first = max((out.width - ROOM) // COLUMN, 1), f"{what} and settings"
    shown = table((first, *titles[:fit], "hollow (mm)"), words=(first,))
    for run, row in zip(runs[:SHOWN], values.to_numpy(), strict=False):
        own = [override for override in run.overrides if override not in common] or ["by default"]
        label = "\n  ".join([f"{run.name.partition(' ')[2]}: {own[0]}", *own[1:]])
        shown.add_row(label, *map(number, row[:fit]), number(run.more.get("hollow_mm", math.nan)))
    out.print(shown)
    if left := titles[fit:]:
        out.print(f"In {folder / 'summary.csv'}, too: {', '.join(left)}", soft_wrap=True)
    if len(runs) > SHOWN:
        out.print(f"... and {len(runs) - SHOWN} more in {folder / 'summary.csv'}", soft_wrap=True)


def _varied(runs: Sequence[Run]) -> pandas.DataFrame:
    """A row for each run, and a column of text for each setting that differs; "" where it is not known."""
    settings = pandas.DataFrame([dict(run.settings) for run in runs]).fillna("")
    known = settings[[bool(run.settings) for run in runs]]
    return settings[[name for name in settings if known[name].nunique() > 1]]


class Fronts(NamedTuple):
    """Fronts of one problem that several solvers or seeds have found."""

    names: tuple[str, ...]  # of the objectives
    places: list[int]  # which of the runs they are of
    labels: list[str]  # what each run is called without its seed
    values: list[Array]  # (designs, objectives) each, natural signs
    shares: list[float]  # hypervolume of each, over that of all of them merged

    def figure(self) -> Figure:
        """Every pair of objectives; runs that differ by seeds only share a colour and a hypervolume."""
        groups = {}
        for label in dict.fromkeys(self.labels):
            own = [i for i, name in enumerate(self.labels) if name == label]
            seeds = f"{len(own)} seeds, " if len(own) > 1 else ""
            share = percent(float(np.median([self.shares[i] for i in own])))
            groups[f"{label}: {seeds}hypervolume {share}"] = np.concatenate([self.values[i] for i in own])
        return scatter_matrix(groups, self.names)


def fronts(runs: Sequence[Run]) -> list[Fronts]:
    """The fronts of all runs that found one, those of each problem together."""
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, run in enumerate(runs):
        names = tuple(run.result.get("objective_names", ()))
        if len(names) > 1 and run.result.get("front_values"):
            problem = (item for item in run.settings.items() if not item[0].startswith(OUTSIDE_PROBLEM))
            groups.setdefault((names, *problem), []).append(i)
    own = _varied(runs).drop(columns=SEED, errors="ignore").to_numpy().tolist()
    found = []
    for (names, *_), places in groups.items():
        results = [runs[i].result for i in places]
        frames = [pandas.DataFrame(r["front_values"], columns=r["front_columns"]) for r in results]
        values = [frame[list(names)].to_numpy(float) for frame in frames]
        signs = np.where([results[0]["maximise"][name] for name in names], -1.0, 1.0)
        shares = hypervolume_shares([v * signs for v in values])
        labels = [" ".join(filter(None, own[i])) or runs[i].name for i in places]
        found.append(Fronts(names, places, labels, values, shares))
    return found


def _over_seeds(settings: pandas.DataFrame, values: pandas.DataFrame) -> pandas.DataFrame | None:
    """Median and quartiles of runs that differ by their seeds only, a row each; None if no two of them do."""
    own = [name for name in settings if name != SEED]
    groups = values.groupby([settings[name] for name in own] or [0] * len(values), sort=False)
    if SEED not in settings or groups.size().max() < 2:
        return None
    parts = [groups.quantile(q).add_suffix(f"_{part}") for part, q in QUANTILES.items()]
    found = pandas.concat(parts, axis=1)
    found = found[[f"{name}_{part}" for name in values for part in QUANTILES]]
    found.insert(0, "seeds", groups.size())
    return found.reset_index(names=own) if own else found
