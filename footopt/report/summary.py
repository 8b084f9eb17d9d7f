"""The end of a study of many walks, of a multirun, and of runs that are compared: printed and written."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from footopt.errors import ERROR_FILE, FileError
from footopt.files.reading import read_json_file
from footopt.files.run import write_csv, write_json
from footopt.report import page
from footopt.report.terminal import console, everything_is_in, number, table


def conclude(
    folder: Path,
    title: str,
    said: Sequence[str],
    figures: Mapping[str, str],
    tables: Sequence[Table],
    record: dict[str, Any],
    about: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> None:
    """Write result.json and report.html, print the tables and what is said of them, and where all is.

    Parameters
    ----------
    figures : what each shows, in words, by its name in the folder "figures".
    record : all of result.json, its `wall_time_s` among it.
    about, warnings : for the page alone: what the terminal has shown before, or shows as an error.

    Raises
    ------
    FileError : a file cannot be written; nothing is printed then.
    """
    write_json(folder / "result.json", record)
    page.write_study(folder, title, [*about, *said], figures, tables, record, warnings)
    out = console()
    for part in (*tables, *said):
        out.print(part)
    everything_is_in(out, folder, record["wall_time_s"])


def report(folder: Path) -> int:
    """Print and write (summary.csv, report.html) what the jobs below `folder` found; the number that failed.

    Each job is a folder with its result.json, or with an `ERROR_FILE` if it failed; one that has
    neither died.
    """
    jobs = sorted((p for p in folder.iterdir() if p.name.isdigit()), key=lambda p: int(p.name))
    rows = [{"name": f"job {job.name}", "key": job.name, "place": ""} | _read(job) for job in jobs]
    compare(folder, rows, f"{len(jobs)} jobs in {folder}")
    return sum(row["failed"] for row in rows)


def of_runs(folder: Path, runs: Sequence[Path]) -> None:
    """The same of runs anywhere, into `folder`.

    Raises
    ------
    FileError : none of them has a foot.
    """
    rows = [
        {"name": f"run {i}", "key": str(run), "place": str(run)} | _read(run)
        for i, run in enumerate(runs, start=1)
    ]
    if all(row["result"] is None for row in rows):
        raise FileError(
            f"study.runs: none of the {len(rows)} folders has a foot to compare. "
            "Give runs of study=optimize, simulate or robust."
        )
    compare(folder, rows, f"{len(runs)} runs")


def compare(folder: Path, rows: Sequence[dict[str, Any]], headline: str) -> None:
    """The table, on the terminal and as summary.csv and report.html in `folder`."""
    what = rows[0]["name"].split()[0]
    common = set.intersection(*(set(row["overrides"]) for row in rows)) if len(rows) > 1 else set()
    names = list(dict.fromkeys(name for row in rows for name in row["objectives"]))
    out = console()
    units = {name: unit for row in rows for name, unit in (row["result"] or {}).get("units", {}).items()}
    parts = [(name.replace("_", " "), units.get(name)) for name in names]
    titles = (*(f"{title} ({unit})" if unit else title for title, unit in parts), "hollow (mm)")
    first = f"{what} and settings"
    shown = table((first, *titles), words=(first,))
    for row in rows:
        found = [row["objectives"].get(name) for name in names]
        values = [number(math.nan if value is None else value) for value in found]
        own = [override for override in row["overrides"] if override not in common]
        number_ = row["name"].split()[1]
        shown.add_row("\n  ".join([f"{number_}: {''.join(own[:1])}", *own[1:]]), *values, row["hollow"])
    out.print(headline, soft_wrap=True)
    out.print(shown)
    for row in rows:
        if said := "; ".join(filter(None, [row["place"], row["note"]])):
            out.print(f"{row['name']}: {said}", soft_wrap=True)
    write_csv(
        folder / "summary.csv",
        [what, "overrides", *names, "hollow_mm", "k", "note"],
        (
            [
                row["key"],
                " ".join(row["overrides"]),
                *(row["objectives"].get(name) for name in names),
                row["hollow"],
                " ".join(map(str, row["k"] or [])),
                row["note"],
            ]
            for row in rows
        ),
    )
    rows_shown = [
        row | {"settings": " ".join(o for o in row["overrides"] if o not in common)} for row in rows
    ]
    page.write(folder / "report.html", page.jobs_content(folder, rows_shown, sorted(common)))


def _read(job: Path) -> dict[str, Any]:
    overrides = job / ".hydra" / "overrides.yaml"
    row: dict[str, Any] = {
        "folder": job,
        "result": None,
        "overrides": _overrides(overrides),
        "objectives": {},
        "hollow": "-",
        "k": None,
        "note": "",
        "failed": False,
    }
    if (job / ERROR_FILE).is_file():
        row |= {"note": (job / ERROR_FILE).read_text(encoding="utf-8").strip(), "failed": True}
    elif not (job / "result.json").is_file():
        row |= {"note": "no result", "failed": True}
    else:
        result = read_json_file(job / "result.json", "run", "study.runs")
        if not (isinstance(result.get("objectives"), dict) and (job / "contour.csv").is_file()):
            # a study of many feet or of none
            return row | {"note": f"study={result['study']}: see its own folder"}
        row |= {
            "result": result,
            "objectives": result["objectives"],
            "hollow": number(result["design"]["hollow_mm"]),
            "k": result["design"]["k"],
            "note": result.get("reason", "") or ("interrupted" if result.get("interrupted") else ""),
        }
    return row


def _overrides(path: Path) -> list[str]:
    """What a job was given on the command line, as Hydra writes it down: a list in YAML."""
    import yaml

    return list(map(str, yaml.safe_load(path.read_bytes()) or [])) if path.is_file() else []
