"""Several runs side by side, of a multirun or any: a table, summary.csv, seeds.csv, fronts, report.html."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from footopt.design.fronts import hypervolume_shares
from footopt.errors import ERROR_FILE, FileError, flat, one_line
from footopt.files import identity
from footopt.files.drawings import MM
from footopt.files.io import read_json_file, write_csv
from footopt.foot.waypoints import written
from footopt.report import page
from footopt.report.figures.fronts import Fronts
from footopt.report.figures.fronts import fronts as draw_fronts
from footopt.report.numbers import number
from footopt.report.style import save
from footopt.report.terminal import console, describe_model, table

if TYPE_CHECKING:
    import pandas

Array = NDArray[np.float64]

SHOWN = 60  # runs of the table on the terminal
ROOM, COLUMN = 26, 10  # letters of its first and last column, and of each between
SEED = "solver.seed"
#: Settings that do not change which problem is searched.
HOW = ("solver.", "engine.", "study.", "choose.", "report", "plugins", "accuracy.")


@dataclass(frozen=True, eq=False)
class Run:
    """What a run, or a job of a multirun, left in its folder.

    `name` is what tables call it ("job 3"), `key` what summary.csv does; `result` is its result.json, if that
    is about one foot, and `note` says why there is none, or no better one.
    """

    name: str
    key: str
    folder: Path
    place: str = ""
    overrides: tuple[str, ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)  # by their full names, as text
    result: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""
    failed: bool = False  # it ended in an error, or died

    @cached_property
    def objectives(self) -> dict[str, float]:
        """Its objectives by name, NaN for those that it could not tell; empty if it left none."""
        found = self.result.get("objectives", {})
        return {name: math.nan if value is None else value for name, value in found.items()}

    @cached_property
    def contour(self) -> Array:
        """Its sole, (m, 2), m."""
        points: Array = np.loadtxt(self.folder / "contour.csv", delimiter=",", skiprows=1, ndmin=2) / MM
        if points.shape[1:] != (2,) or not np.isfinite(points).all():
            raise ValueError("contour.csv holds no points")
        return points

    @cached_property
    def traces(self) -> dict[str, Array] | None:
        """Height, speed, power and work of both feet against time `t`, (T,) each; None if it left no walk."""
        from scipy.io import netcdf_file

        if not (self.folder / "walk.nc").is_file():  # a study of many scenarios
            return None
        with netcdf_file(self.folder / "walk.nc", mmap=False) as file:
            names = ("t", "com", "velocity", "power", "work")
            t, com, velocity, power, work = (np.array(file.variables[name][:]) for name in names)
        totals = {"power": power.sum(axis=1), "work": work.sum(axis=1)}
        return {"t": t, "height": com[:, 1], "speed": velocity[:, 0], **totals}


def read_run(folder: Path, name: str, key: str, place: str = "") -> Run:
    """Read what a run left: its result.json, or an `ERROR_FILE` if it failed; one that has neither died.

    What is damaged is said in its note, and it has no result then.
    """
    try:
        found = identity.read(folder)
        settings, words = found.settings, found.words
    except FileError:  # it has not said what it is
        settings, words = {}, ()
    own = (name, key, folder, place, words, {n: _text(v) for n, v in flat(settings).items()})
    if (folder / ERROR_FILE).is_file():
        return Run(*own, note=(folder / ERROR_FILE).read_text(encoding="utf-8").strip(), failed=True)
    if not (folder / "result.json").is_file():
        return Run(*own, note="no result", failed=True)
    try:
        result = read_json_file(folder / "result.json", "study.runs")
        if not (isinstance(result.get("objectives"), dict) and (folder / "contour.csv").is_file()):
            # a study of many feet or of none
            return Run(*own, note=f"study={result['study']}: see its own folder")
        note = result.get("reason", "") or ("interrupted" if result.get("interrupted") else "")
        run = Run(*own, result, note)
        # read, to be sound
        _ = run.contour, run.traces, sum(run.objectives.values()), _more(run), result["versions"]
        _ = result["settings"]["foot"]["top"], result["settings"]["foot"]["width"]
    except Exception as error:  # whatever can be wrong with files that have been damaged
        return Run(*own, note=f"damaged: {one_line(f'{type(error).__name__}: {error}')}", failed=True)
    return run


def _text(value: Any) -> str:
    return "" if value is None else f"{value:.12g}" if isinstance(value, float) else str(value)


def of_multirun(folder: Path) -> int:
    """Print and write what the jobs below a folder found; returns how many failed, or whose foot failed."""
    names = [str(job.relative_to(folder)) for job in identity.jobs(folder)]
    runs = [read_run(folder / name, f"job {name}", name) for name in names]
    _compare(folder, runs, f"{len(runs)} jobs in {folder}")
    sunk = [run.result.get("study") == "simulate" and bool(run.result.get("reason")) for run in runs]
    return sum(run.failed or fell for run, fell in zip(runs, sunk, strict=True))


def of_runs(folder: Path, folders: Sequence[Path]) -> None:
    """The same of runs anywhere, into `folder`.

    Raises
    ------
    FileError
        None of them has a foot.
    """
    runs = [read_run(path, f"run {i}", str(path), str(path)) for i, path in enumerate(folders, start=1)]
    if not any(run.result for run in runs):
        raise FileError(
            f"study.runs: none of the {len(runs)} folders has a foot to compare. "
            "Give runs of study=optimize, simulate or robust."
        )
    _compare(folder, runs, f"{len(runs)} runs")


def _varied(runs: Sequence[Run]) -> pandas.DataFrame:
    """A row for each run, and a column of text for each setting that differs; "" where it is not known."""
    import pandas

    settings = pandas.DataFrame([dict(run.settings) for run in runs]).fillna("")
    known = settings[[bool(run.settings) for run in runs]]
    return settings[[name for name in settings if known[name].nunique() > 1]]


def _more(run: Run) -> dict[str, float]:
    """What else a row of summary.csv has of a run."""
    result = run.result
    return {
        "hollow_mm": float(result["design"]["hollow_mm"]) if result else math.nan,
        "seconds": float(result.get("wall_time_s", math.nan)),
        "evaluations": float(result.get("evaluations", math.nan)),
        "warnings": float(len(result["warnings"])) if "warnings" in result else math.nan,
    }


def fronts(runs: Sequence[Run]) -> list[Fronts]:
    """The fronts of all runs that found one, those of each problem together."""
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, run in enumerate(runs):
        names = tuple(run.result.get("objective_names", ()))
        if len(names) > 1 and run.result.get("front_values"):
            problem = (item for item in run.settings.items() if not item[0].startswith(HOW))
            groups.setdefault((names, *problem), []).append(i)
    own = _varied(runs).drop(columns=SEED, errors="ignore").to_numpy().tolist()
    found = []
    for (names, *_), places in groups.items():
        results = [runs[i].result for i in places]
        maximise = tuple(bool(results[0]["maximise"][name]) for name in names)
        columns = [[r["front_columns"].index(name) for name in names] for r in results]
        values = [np.array(r["front_values"], float)[:, c] for r, c in zip(results, columns, strict=True)]
        shares = hypervolume_shares([v * np.where(maximise, -1.0, 1.0) for v in values])
        labels = [" ".join(filter(None, own[i])) or runs[i].name for i in places]
        found.append(Fronts(names, places, labels, values, shares))
    return found


def _compare(folder: Path, runs: Sequence[Run], headline: str) -> None:
    """The table, on the terminal and as summary.csv and report.html in `folder`."""
    import pandas

    what, out = runs[0].name.split()[0], console()
    common = set.intersection(*(set(run.overrides) for run in runs)) if len(runs) > 1 else set()
    objectives = pandas.DataFrame([run.objectives for run in runs], range(len(runs)), dtype=float)
    units = {name: unit for run in runs for name, unit in run.result.get("units", {}).items()}
    titles = [f"{name.replace('_', ' ')} ({units.get(name, '')})".removesuffix(" ()") for name in objectives]
    first = f"{what} and settings"
    fit = max((out.width - ROOM) // COLUMN, 1)  # numbers that were cut would tell nothing
    shown = table((first, *titles[:fit], "hollow (mm)"), words=(first,))
    values = objectives.assign(**pandas.DataFrame([_more(run) for run in runs]))
    for run, (_, row) in zip(runs[:SHOWN], values.iterrows(), strict=False):
        own = [override for override in run.overrides if override not in common] or ["by default"]
        label = "\n  ".join([f"{run.name.partition(' ')[2]}: {own[0]}", *own[1:]])
        shown.add_row(label, *(number(v) for v in row.iloc[: min(fit, len(titles))]), number(row.hollow_mm))
    out.print(headline, soft_wrap=True)
    out.print(shown)
    if left := titles[fit:]:
        out.print(f"In {folder / 'summary.csv'}, too: {', '.join(left)}", soft_wrap=True)
    if len(runs) > SHOWN:
        out.print(f"... and {len(runs) - SHOWN} more in {folder / 'summary.csv'}", soft_wrap=True)
    for run in runs:
        if said := "; ".join(filter(None, [run.place, run.note])):
            out.print(f"{run.name}: {said}", soft_wrap=True)
    for words in describe_model(run.result.get("model_error") for run in runs):
        out.print(words)
    found = fronts(runs)
    if share := {i: s for one in found for i, s in zip(one.places, one.shares, strict=True)}:
        values["front"] = [float(len(run.result.get("front") or ())) or math.nan for run in runs]
        values["hypervolume_share"] = [share.get(i, math.nan) for i in range(len(runs))]
    settings = _varied(runs)
    notes = {
        "k": [written(k) if (k := run.result.get("design", {}).get("k")) else "" for run in runs],
        "note": [run.note for run in runs],
        "overrides": [" ".join(run.overrides) for run in runs],
    }
    keys = pandas.DataFrame({what: [run.key for run in runs]})
    whole = pandas.concat([keys, settings, values, pandas.DataFrame(notes)], axis=1)
    write_csv(folder / "summary.csv", [*whole], whole.to_numpy(object).tolist())
    spread = _over_seeds(settings, values)
    if spread is not None:
        write_csv(folder / "seeds.csv", [*spread], spread.to_numpy(object).tolist())
        out.print(f"Median and quartiles over seeds: {folder / 'seeds.csv'}", soft_wrap=True)
    for i, one in enumerate(found):
        if len(one.places) > 1:
            name = "fronts" if len(found) == 1 else f"fronts_{i + 1}"
            save(draw_fronts(one), folder / "figures", name)
            out.print(f"Fronts side by side: {folder / 'figures' / name}.png", soft_wrap=True)
    page.write(folder / "report.html", page.jobs_content(folder, runs, sorted(common)))


def _over_seeds(settings: pandas.DataFrame, values: pandas.DataFrame) -> pandas.DataFrame | None:
    """Runs that differ by their seeds only, a row each: median and quartiles; None if no two of them do."""
    import pandas

    own = [name for name in settings if name != SEED]
    groups = values.groupby([settings[name] for name in own] or [0] * len(values), sort=False)
    if SEED not in settings or groups.size().max() < 2:
        return None
    parts = {"median": 0.5, "q1": 0.25, "q3": 0.75}
    found = pandas.concat([groups.quantile(q).add_suffix(f"_{part}") for part, q in parts.items()], axis=1)
    found = found[[f"{name}_{part}" for name in values for part in parts]]
    found.insert(0, "seeds", groups.size())
    return found.reset_index(names=own) if own else found
