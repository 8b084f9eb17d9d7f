"""Runs side by side: read from their folders into a table, with fronts and a page."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np
import pandas
from matplotlib.figure import Figure
from scipy.io import netcdf_file

from footopt.arrays import Array
from footopt.design.fronts import hypervolume_shares
from footopt.errors import ERROR_FILE, FileError
from footopt.files import identity
from footopt.files.feet import MM
from footopt.files.io import read_json_file, relative, write_csv
from footopt.foot.waypoints import heights_text
from footopt.report import page
from footopt.report.figures.walks import scatter_matrix
from footopt.report.numbers import number, percent
from footopt.report.page.file import column, packed
from footopt.report.style import save
from footopt.report.terminal import console, doubtful, span, table
from footopt.walk.objectives import MEASURES, Objective

ROOM, COLUMN, RANGE = 26, 10, 16  # letters: first and last column together, one objective, the other laws
SEED = "solver.seed"
#: Settings that do not change which problem is searched.
OUTSIDE_PROBLEM = ("solver.", "engine.", "study.", "choose.", "report", "plugins", "accuracy.")
NUMBERS = ("evaluations", "hypervolume", "wall_time_s", "search_time_s")  # of result.json


@dataclass(frozen=True)
class Row:
    """A run in a table; `note` is the reason why there is no result, or no better one."""

    folder: Path
    overrides: tuple[str, ...] = ()  # of its command line
    settings: Mapping[str, Any] = field(default_factory=dict)  # by their full names
    result: Mapping[str, Any] = field(default_factory=dict)  # its result.json; empty if it failed
    note: str = ""

    @property
    def objectives(self) -> dict[str, float]:
        """Of its foot, by name, natural signs: NaN without a value, none at all without a foot."""
        found = self.result.get("objectives", {})
        return {name: math.nan if value is None else float(value) for name, value in found.items()}

    @property
    def flat(self) -> float:
        """J_W of the flat foot in its place, NaN where it is not known."""
        return (self.result.get("flat") or {}).get("efficiency") or math.nan

    @property
    def gains(self) -> list[float]:
        """Relative changes of J_W from the flat foot's under each law of sand, the scene's own first."""
        found = [law["change"].get("efficiency") for law in self.result.get("laws", [])]
        return [math.nan if gain is None else float(gain) for gain in found]

    @property
    def under_laws(self) -> str:
        """J_W under the other laws, as multiples of the flat foot's; "" where none was evaluated."""
        return span("efficiency", self.gains[1:]) if self.gains[1:] else ""

    @property
    def doubt(self) -> str:
        """A remark if another law changes the sign of the gain, or ""."""
        return doubtful(self.gains[0], self.gains[1:]) if self.gains else ""


def read(folder: Path) -> Row:
    """Read the run in a folder; `note` says what is damaged."""
    error, file = folder / ERROR_FILE, folder / "result.json"
    left: dict[str, Any] = {"note": "no result"}
    try:
        found = identity.read(folder, "folder")
        left |= {"overrides": found.overrides, "settings": _by_full_name(found.settings)}
        if file.exists() and not error.exists():
            left["result"] = result = dict(read_json_file(file, "folder"))
            left["note"] = result.get("reason") or ("interrupted" if result.get("interrupted") else "")
    except (FileError, TypeError, ValueError) as problem:
        left["note"] = str(problem)
    if error.is_file():
        left["note"] = error.read_text(encoding="utf-8").strip()
    return Row(folder, **left)


def _by_full_name(content: Any, name: str = "") -> dict[str, Any]:
    """Nested settings by their full names."""
    if not (isinstance(content, Mapping) and content):
        return {name: content}
    parts = (_by_full_name(value, f"{name}.{key}".lstrip(".")) for key, value in content.items())
    return {full: value for part in parts for full, value in part.items()}


def as_frame(runs: Sequence[Row]) -> pandas.DataFrame:
    """A row for each run: folder, overrides, settings by full names, objectives, other numbers, note."""
    rows = []
    for run in runs:
        result, design = run.result, run.result.get("design", {})
        row: dict[str, Any] = {"folder": str(run.folder), "overrides": " ".join(run.overrides)}
        row |= {**run.settings, **run.objectives}
        row["efficiency_over_flat"] = run.objectives.get("efficiency", math.nan) / run.flat
        row["hollow_mm"] = design.get("hollow_mm", math.nan)
        row["k"] = heights_text(design["k"]) if design.get("k") else ""
        row |= {name: result.get(name, math.nan) for name in NUMBERS}
        row |= {f"validity.{name}": value for name, value in (result.get("validity") or {}).items()}
        rows.append(row | {"warnings": len(result.get("warnings", [])), "note": run.note})
    return pandas.DataFrame(rows).dropna(axis="columns", how="all")


def load_all(pattern: str | Path) -> pandas.DataFrame:
    """All runs below folders, a row for each.

    Columns are `folder`, `overrides`, each setting by its full name, each objective, `efficiency_over_flat`,
    `hollow_mm`, `k`, the other numbers of result.json, `warnings` (how many), and `note`: why there is no
    better result. A column that would be empty is left out.

    Parameters
    ----------
    pattern : str or Path
        Of folders, as in a shell, such as ``"outputs/**"``; a folder stands for all runs below it.

    Raises
    ------
    FileError
        There are no runs.
    """
    if not (found := [read(folder) for folder in identity.runs(pattern)]):
        raise FileError(f"pattern = {str(pattern)!r}: no run is there. Try 'outputs/**'.")
    return as_frame(found)


def varied(runs: Sequence[Row]) -> pandas.DataFrame:
    """A row for each run, and a column of text for each setting that differs; "" where it is not known."""
    text = [{name: "" if v is None else str(v) for name, v in run.settings.items()} for run in runs]
    settings = pandas.DataFrame(text).fillna("")
    known = settings[[bool(run.settings) for run in runs]]
    return settings[[name for name in settings if known[name].nunique() > 1]]


def compare(folder: Path, folders: Sequence[Path]) -> int:
    """Print a table of runs, and write all about them into a folder; returns how many of them failed."""
    runs, out = [read(path) for path in folders], console()
    parents = [path.absolute().parent for path in folders]
    base = os.path.commonpath(parents if len({path.drive for path in parents}) == 1 else parents[:1])
    names = [relative(path, base) for path in folders]
    known = [set(run.overrides) for run in runs if run.settings]  # not of a job that was refused before
    common = set.intersection(*known) if len(known) > 1 else set()
    own = [[word for word in run.overrides if word not in common] for run in runs]
    about = [f"{len(runs)} runs in {base}" + (f", all with {' '.join(sorted(common))}" if common else "")]
    out.print("\n".join(about), soft_wrap=True)
    told = (
        " ".join(words) or ("by default" if run.settings else "refused")
        for run, words in zip(runs, own, strict=True)
    )
    _print_table(folder, runs, [f"{name}: {words}" for name, words in zip(names, told, strict=True)])
    for name, run in zip(names, runs, strict=True):
        if run.note:
            out.print(f"{name}: {run.note}", soft_wrap=True)
    whole = as_frame(runs)
    for i, found in enumerate(fronts(runs)):
        whole.loc[found.rows, "hypervolume_share"] = found.shares
        if len(found.rows) > 1:
            figure, name = found.draw(runs, own), f"fronts_{i + 1}" if i else "fronts"
            (picture,) = save(figure, folder / "figures", name, ["png"])
            out.print(f"Fronts side by side: {picture}", soft_wrap=True)
    values = whole.drop(columns=["folder", *{n for run in runs for n in run.settings}], errors="ignore")
    labels = pandas.Series(names, name="run")
    write_csv(folder / "summary.csv", pandas.concat([labels, varied(runs), values], axis=1))
    page.write(folder / "report.html", runs_content(folder, runs, names, list(map(" ".join, own)), about))
    results = [run.result for run in runs]
    return sum(not r or (r.get("study") == "simulate" and bool(r.get("reason"))) for r in results)


def compared(runs: Sequence[Row]) -> tuple[list[dict[str, Any]], Array]:
    """The objectives that half of the runs have, those sought first, as columns of the page, and values.

    J_W is a multiple of the flat foot's where all know it.
    """
    results = [run.result for run in runs]
    sought = dict.fromkeys(name for r in results for name in r.get("objective_names", []))
    known = dict.fromkeys((*sought, *(name for r in results for name in r["objectives"])))
    having = {n: [r for r in results if n in r["objectives"] and n in r.get("units", {})] for n in known}
    names = [name for name, those in having.items() if len(those) >= max(0.5 * len(results), 1)]
    first = {name: having[name][0] for name in names}
    columns = [column(name, r["units"][name], r["maximise"][name]) for name, r in first.items()]
    values = np.array([[run.objectives.get(name, math.nan) for name in names] for run in runs], float)
    flat = [run.flat for run in runs]
    if "efficiency" in names and np.isfinite(flat).all():
        values[:, names.index("efficiency")] /= flat
        columns[names.index("efficiency")] |= {"unit": "x of flat", "maximise": True}
    return columns, values


def _print_table(folder: Path, runs: Sequence[Row], labels: Sequence[str]) -> None:
    """Print a row for each run with as many objectives as fit, and the best run of one objective."""
    out, done = console(), [i for i, run in enumerate(runs) if run.objectives]
    columns, values = compared([runs[i] for i in done])
    titles = [f"{c['title']} ({c['unit']})".removesuffix(" ()") for c in columns]
    laws = ["J_W by other laws"] * any(run.under_laws for run in runs)
    fit = max((out.width - ROOM - RANGE * len(laws)) // COLUMN, 1)
    shown = table(("run and settings", *titles[:fit], *laws, "hollow (mm)"), words=("run and settings",))
    for i, (label, run) in enumerate(zip(labels, runs, strict=True)):
        row = values[done.index(i)][:fit] if i in done else [math.nan] * len(titles[:fit])
        hollow = run.result.get("design", {}).get("hollow_mm", math.nan)
        shown.add_row(label, *map(number, row), *[run.under_laws or "-" for _ in laws], number(hollow))
    out.print(shown)
    if doubted := [label for label, run in zip(labels, runs, strict=True) if run.doubt]:
        out.print(f"J_W against the flat foot, sign not certain: {'; '.join(doubted)}", soft_wrap=True)
    sought = {name for i in done for name in runs[i].result.get("objective_names", [])}
    if len(done) > 1 and columns and sought == {columns[0]["name"]} and np.isfinite(values[:, 0]).any():
        best = int(np.nanargmax(values[:, 0] if columns[0]["maximise"] else -values[:, 0]))
        out.print(f"Best {titles[0]}: {number(values[best, 0])}, {labels[done[best]]}", soft_wrap=True)
    if left := titles[fit:]:
        out.print(f"In {folder / 'summary.csv'}, too: {', '.join(left)}", soft_wrap=True)


class Fronts(NamedTuple):
    """The fronts that runs found in one problem."""

    rows: list[int]  # which runs
    objectives: list[Objective]
    values: list[Array]  # of each run, (designs, objectives), natural signs
    shares: list[float]  # the hypervolume of each over that of all

    def draw(self, runs: Sequence[Row], own: Sequence[Sequence[str]]) -> Figure:
        """Side by side; runs whose `own` overrides differ by seeds only share a colour and the median."""
        words = ([word for word in own[i] if not word.startswith(SEED)] for i in self.rows)
        labels = pandas.Series(
            [" ".join(w) or runs[i].folder.name for i, w in zip(self.rows, words, strict=True)]
        )
        drawn = {}
        for label, ours in labels.groupby(labels, sort=False).groups.items():
            seeds = f"{len(ours)} seeds, " if len(ours) > 1 else ""
            share = percent(float(np.median([self.shares[i] for i in ours])))
            drawn[f"{label}: {seeds}hypervolume {share}"] = np.concatenate([self.values[i] for i in ours])
        return scatter_matrix(drawn, self.objectives)


def fronts(runs: Sequence[Row]) -> list[Fronts]:
    """The fronts that runs found, by problem."""
    groups: dict[str, list[int]] = {}
    for i, run in enumerate(runs):
        if run.result.get("front_values"):
            problem = [item for item in run.settings.items() if not item[0].startswith(OUTSIDE_PROBLEM)]
            groups.setdefault(str((_sought(run), problem)), []).append(i)
    found = []
    for rows in groups.values():
        results, objectives = [runs[i].result for i in rows], _sought(runs[rows[0]])
        names, signs = zip(*((o.name, o.sign) for o in objectives), strict=True)
        frames = (pandas.DataFrame(r["front_values"], columns=r["front_columns"])[[*names]] for r in results)
        values = [frame.to_numpy(float) for frame in frames]
        found.append(Fronts(rows, objectives, values, hypervolume_shares([f * signs for f in values])))
    return found


def _sought(run: Row) -> list[Objective]:
    """The objectives of a search as its run describes them: those of a plugin may not be known here."""
    names, units, most = (run.result.get(of, {}) for of in ("objective_names", "units", "maximise"))
    symbols = {name: MEASURES[name].symbol if name in MEASURES else "" for name in names}
    return [Objective(n, symbols[n], units.get(n, ""), most.get(n, False), math.nan, float) for n in names]


def runs_content(
    folder: Path, runs: Sequence[Row], names: Sequence[str], overrides: Sequence[str], about: Sequence[str]
) -> dict[str, Any]:
    """The page in a folder over runs: soles, values and traces, with the overrides of each run and of all."""
    # a study of one's own may leave objectives and no sole
    done = [i for i, run in enumerate(runs) if run.objectives and (run.folder / "contour.csv").is_file()]
    results = [runs[i].result for i in done]
    columns, values = compared([runs[i] for i in done])
    return {
        "title": f"{len(runs)} runs",
        "headline": about,
        "columns": columns,
        "runs": [
            {
                "name": name,
                "settings": overrides[i],
                "note": run.note,
                "laws": ", ".join(filter(None, [run.under_laws, run.doubt])),
                "design": done.index(i) if i in done else None,
                "link": quote(Path(relative(run.folder, folder), "report.html").as_posix())
                if (run.folder / "report.html").is_file()
                else None,
            }
            for i, (name, run) in enumerate(zip(names, runs, strict=True))
        ],
        "designs": {
            "values": packed(values),
            "labels": [names[i] for i in done],
            # a walk that failed has no values to place it by
            "feasible": [int(not result.get("reason")) for result in results],
            "reasons": [result.get("reason", "") for result in results],
            "soles": [
                packed(np.loadtxt(runs[i].folder / "contour.csv", delimiter=",", skiprows=1) / MM)
                for i in done
            ],
        },
        "top": [result["settings"]["foot"]["top"] for result in results],
        "best": 0,
        "entry": {"versions": results[0]["versions"] if results else None},
        "traces": [
            {"design": design, **_traces(runs[i].folder / "walk.nc")}
            for design, i in enumerate(done)
            if (runs[i].folder / "walk.nc").is_file()
        ],
    }


def _traces(path: Path) -> dict[str, Any]:
    """Height and speed of the COM, power and work of both feet, against time."""
    with netcdf_file(path, mmap=False) as file:
        v = {name: np.array(variable[:]) for name, variable in file.variables.items()}
    both = {name: v[name].sum(axis=1) for name in ("power", "work")}
    kept = {"t": v["t"], "height": v["com"][:, 1], "speed": v["velocity"][:, 0], **both}
    return {name: packed(values) for name, values in kept.items()}
