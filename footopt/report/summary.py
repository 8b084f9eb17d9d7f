"""The table over the jobs of a multirun."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from footopt.report import page
from footopt.report.files import write_csv
from footopt.report.terminal import console, number, table


def report(folder: Path, error_file: str) -> int:
    """Print and write (summary.csv, report.html) what the jobs below `folder` found; the number that failed.

    Each job is a folder with its result.json, or with `error_file` if it failed; one that has
    neither died.
    """
    jobs = sorted((p for p in folder.iterdir() if p.name.isdigit()), key=lambda p: int(p.name))
    rows = [_read(job, error_file) for job in jobs]
    common = set.intersection(*(set(row["overrides"]) for row in rows)) if len(rows) > 1 else set()
    names = list(dict.fromkeys(name for row in rows for name in row["objectives"]))
    out = console()
    titles = (*(name.replace("_", " ") for name in names), "hollow (mm)")
    shown = table(("job and settings", *titles), words=("job and settings",))
    for row in rows:
        found = [row["objectives"].get(name) for name in names]
        values = [number(math.nan if value is None else value) for value in found]
        own = [override for override in row["overrides"] if override not in common]
        shown.add_row("\n  ".join([f"{row['job']}: {''.join(own[:1])}", *own[1:]]), *values, row["hollow"])
    out.print(f"{len(jobs)} jobs in {folder}", soft_wrap=True)
    out.print(shown)
    for row in rows:
        if row["note"]:
            out.print(f"job {row['job']}: {row['note']}")
    write_csv(
        folder / "summary.csv",
        ["job", "overrides", *names, "hollow_mm", "k", "note"],
        (
            [
                row["job"],
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
    page.write(folder / "report.html", page.jobs_content(rows_shown, sorted(common)))
    return sum(bool(row["failed"]) for row in rows)


def _read(job: Path, error_file: str) -> dict[str, Any]:
    overrides = job / ".hydra" / "overrides.yaml"
    row: dict[str, Any] = {
        "job": job.name,
        "folder": job,
        "result": None,
        "overrides": _overrides(overrides),
        "objectives": {},
        "hollow": "-",
        "k": None,
        "note": "",
        "failed": False,
    }
    if (job / error_file).is_file():
        row |= {"note": (job / error_file).read_text(encoding="utf-8").strip(), "failed": True}
    elif not (job / "result.json").is_file():
        row |= {"note": "no result", "failed": True}
    else:
        result = json.loads((job / "result.json").read_text(encoding="utf-8"))
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
