"""report.html: one self-contained file a run, to look at its walks and designs in a browser.

This module gathers what the page shows; what it looks like and how it moves is in the folder
``page`` beside it: plain HTML, CSS and JavaScript without a library. Arrays travel as base64 of
16-bit whole numbers or 32-bit floats, so that ten thousand designs and two hundred walks stay small.
"""

from __future__ import annotations

import base64
import html
import json
import os
from collections.abc import Collection, Mapping, Sequence
from importlib.resources import files as resources
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from numpy.typing import ArrayLike, NDArray
from rich.table import Table as RichTable
from rich.text import Text

from footopt.design import Confirmation, SearchResult
from footopt.design.exhaustive import Enumeration
from footopt.files.drawings import MM
from footopt.files.run import plain, write_text
from footopt.foot import Foot, Waypoints
from footopt.report.body import groups
from footopt.report.terminal import describe_confirmation, describe_foot, describe_scene, describe_search
from footopt.walk import OBJECTIVES, Scene, Walk, simulate

Array = NDArray[np.float64]

STYLES = ("page.css",)
SCRIPTS = ("tools.js", "walk.js", "explore.js", "main.js")  # in this order: each uses those before it

DESIGNS = 20_000  # besides the front that are on the page
LEADERS = 20  # best designs of an enumerated space whose walks are on the page
WALKS = 200  # designs of a front whose walks are on the page
FRAMES = 90  # samples of each of their walks
FINE_FRAMES = 500  # of the walk that the page is about
ARROWS = 10  # force arrows along a sole
POSE_STEP = 0.01  # s, between the poses of the gait


def write(path: Path, content: dict[str, Any]) -> Path:
    """Write a page.

    Parameters
    ----------
    content : of `search_content`, `walk_content` or `jobs_content`; `write_study` makes its own.

    Raises
    ------
    FileError : the file cannot be written.
    """
    parts = resources("footopt.report") / "page"

    def read(name: str) -> str:
        return (parts / name).read_text(encoding="utf-8")

    data = json.dumps(plain(content), separators=(",", ":"), allow_nan=False)
    filled = {
        "TITLE": html.escape(content["title"]),
        "STYLE": "\n".join(map(read, STYLES)),
        # "</script>" in a name would end the element
        "DATA": data.replace("<", "\\u003c"),
        "SCRIPT": "\n".join(map(read, SCRIPTS)),
    }
    text = read("template.html")
    for name, value in filled.items():
        text = text.replace(f"<!--{name}-->", value)
    write_text(path, text)
    return path


# --- what a page is about -------------------------------------------------------------------------


def walk_content(walk: Walk, entry: dict[str, Any]) -> dict[str, Any]:
    """The page of one walk.

    Parameters
    ----------
    entry : what result.json says of the run.
    """
    foot = walk.foot
    if foot.space is not None and foot.k is not None:
        shape: dict[str, Any] = {"k": packed(np.array(foot.k))}
    else:
        shape = {"soles": [packed(foot.contour, exact=True)]}
    return {
        **_common(entry, walk.scene, tuple(OBJECTIVES)),
        "title": f"{foot.name} on {walk.scene.sand.name} sand",
        "headline": [f"{describe_scene(walk.scene)}; {describe_foot(foot)}"],
        "space": _splines(foot.space) if "k" in shape and foot.space else None,
        "top": foot.top,
        "width": foot.width,
        "designs": {
            "values": packed(np.array([list(walk.objectives.values())]), exact=True),
            "labels": [foot.name],
            "feasible": [int(walk.feasible)],
            "reasons": [walk.reason],
            **shape,
        },
        "best": 0,
        "walks": [{"design": 0, "label": foot.name, **_traces(walk, FINE_FRAMES)}],
    }


def search_content(
    result: SearchResult, confirmed: Confirmation, best: Walk, flat: Walk, entry: dict[str, Any]
) -> dict[str, Any]:
    """The page of a search.

    Designs beyond `DESIGNS` are thinned out evenly, the front and the lineage never.
    Walks are those of the front, evenly spread over its ranks where it is larger than `WALKS`, or of
    the designs that were the best so far, at the search's accuracy; the best one and the flat sole
    come as they are given.

    Parameters
    ----------
    best, flat : walks of the best design and of the flat sole. entry : what result.json says.
    """
    problem = result.problem
    record, chosen = problem.record, int(confirmed.designs[0])
    several, exact = problem.n_obj > 1, isinstance(result, Enumeration)
    front = result.front.tolist() if several else []
    # of a space that was enumerated the best are kept, best first: no search came to them
    lineage = [] if several or exact else successive_bests(result)
    shown = _spread(front, WALKS) if several else lineage or list(range(min(LEADERS, len(result.k))))
    rows = np.unique([*front, *lineage, chosen, *_spread(list(range(len(result.k))), DESIGNS)])
    place = {row: i for i, row in enumerate(rows.tolist())}
    walks = [
        {"design": place[chosen], "label": "best", **_traces(best, FINE_FRAMES)},
        {"design": None, "label": "flat", **_traces(flat, FINE_FRAMES), "sole": packed(flat.foot.contour)},
    ]
    for i in shown:
        if i != chosen:
            foot = Foot.from_waypoints(result.k[i], problem.space)
            walk = simulate(foot, problem.scene, problem.accuracy)
            walks.append({"design": place[i], "label": f"design {i}", **_traces(walk, FRAMES)})
    reasons = [*dict.fromkeys(map(str, result.reasons))]
    codes = np.array([reasons.index(str(r)) for r in result.reasons])
    generations = [] if exact else result.history
    return {
        **_common(entry, problem.scene, record),
        "title": f"{result.solver.name} on {problem.scene.sand.name} sand",
        "headline": [
            f"Soles for {', '.join(problem.names)} on {describe_scene(problem.scene)}",
            describe_search(result),
            describe_confirmation(confirmed),
            *([f"{len(rows)} of the designs are on this page"] if len(rows) < result.designs else []),
        ],
        "guide": problem.guide,
        "objectives": list(problem.names),
        "designs": {
            "rows": packed(rows, exact=True),
            "values": packed(result.values[rows], exact=True),
            "k": packed(result.k[rows]),
            "generation": None if exact else packed(result.generation[rows]),
            "feasible": packed(result.feasible[rows].astype(int)),
            "reasons": reasons,
            "reason": packed(codes[rows]),
        },
        "space": _splines(problem.space),
        "top": problem.space.top,
        "width": problem.space.width,
        "best": place[chosen],
        "bestValues": confirmed.values[0],
        "front": [place[i] for i in front],
        "walks": walks,
        "lineage": [place[i] for i in lineage],
        "history": [
            {"evaluations": g.evaluations, "best": g.best, "median": g.median, "front": g.front}
            for g in generations
        ],
    }


SCALE = 0.75  # of a figure's pixels: a wide one then fills the page

#: What the foot of a page says of a study, of all that is in its result.json.
FOOTER = (
    "seed", "wall_time_s", "accuracy", "evaluations", "designs", "versions", "error_estimate", "settings",
    "scene",
)  # fmt: skip


def write_study(
    folder: Path,
    title: str,
    headline: Sequence[str],
    figures: Mapping[str, str],
    tables: Sequence[RichTable],
    entry: Mapping[str, Any],
    warnings: Sequence[str] = (),
) -> Path:
    """Write the page of a study of many walks: its figures and tables as they are.

    A cell of a table that is the name of a file in the folder is a link to it.

    Parameters
    ----------
    folder : of the run; its folder "figures" holds the figures as PNG.
    headline : what was found, a paragraph each.
    figures : what each shows, in words, by its name. tables : as the terminal shows them.
    entry : what result.json says of the run. warnings : a marked paragraph each.
    """
    files = {path.name for path in folder.iterdir() if path.is_file()}
    content = {
        "title": title,
        "headline": list(headline),
        "warnings": list(warnings),
        "figures": [
            {"says": says, **_inline(folder / "figures" / f"{name}.png")} for name, says in figures.items()
        ],
        "tables": [_plain_table(table, files) for table in tables],
        "columns": [],
        "designs": {"values": packed(np.empty((0, 0)), exact=True), "feasible": [], "reasons": []},
        "entry": {name: entry[name] for name in FOOTER if name in entry},
    }
    return write(folder / "report.html", content)


def _inline(path: Path) -> dict[str, Any]:
    """A PNG as the address of itself, and the width that gives the letters of all figures one size."""
    picture = path.read_bytes()
    width = int.from_bytes(picture[16:20], "big")
    data = base64.b64encode(picture).decode("ascii")
    return {"source": f"data:image/png;base64,{data}", "width": round(width * SCALE)}


def _plain_table(table: RichTable, files: Collection[str]) -> dict[str, Any]:
    """A terminal's table as plain text; `bad`: which cells are bold there, `links`: which name a file."""
    rows = list(zip(*(column.cells for column in table.columns), strict=True))
    return {
        "title": table.title,
        "head": [str(column.header).replace("\n", " ") for column in table.columns],
        "words": [column.justify != "right" for column in table.columns],
        "rows": [[str(cell) for cell in row] for row in rows],
        "bad": [[isinstance(cell, Text) and "bold" in str(cell.style) for cell in row] for row in rows],
        "links": [[str(cell) in files for cell in row] for row in rows],
        "caption": table.caption,
    }


def jobs_content(folder: Path, jobs: Sequence[dict[str, Any]], common: Sequence[str]) -> dict[str, Any]:
    """The page over the jobs of a multirun, or other runs: soles, values and traces side by side.

    Parameters
    ----------
    folder : that the page is for.
    jobs : one a job: its `name` ("job 3"), `folder`, `place` (where it is, in words), `settings`,
        `hollow` and `note`, and its `result` (what its result.json says; None if it left none).
    common : settings that all jobs share.
    """
    done = [job for job in jobs if job["result"] is not None]
    known = {name: (objective.unit, objective.maximise) for name, objective in OBJECTIVES.items()}
    for result in (job["result"] for job in done):  # those of plugins are in their own results
        known |= {name: (result["units"][name], most) for name, most in result.get("maximise", {}).items()}
    # what not all have could not be compared
    names = [name for name in known if done and all(name in job["result"]["objectives"] for job in done)]
    values = [[job["result"]["objectives"].get(name) for name in names] for job in done]
    feet = [job["result"]["settings"]["foot"] for job in done]
    return {
        "title": f"{len(jobs)} {jobs[0]['name'].split()[0]}s",
        "headline": [f"All with {' '.join(common)}"] if common else [],
        "columns": [_column(name, *known[name]) for name in names],
        "jobs": [
            {
                "name": job["name"],
                "place": job["place"],
                "settings": job["settings"],
                "hollow": job["hollow"],
                "note": job["note"],
                "seed": (job["result"] or {}).get("seed"),
                "seconds": (job["result"] or {}).get("wall_time_s"),
                "design": done.index(job) if job in done else None,
                "link": _link(job["folder"] / "report.html", folder),
            }
            for job in jobs
        ],
        "designs": {
            "values": packed(np.array(values, float).reshape(len(done), len(names)), exact=True),
            "labels": [job["name"] for job in done],
            # a walk that failed has no values to place it by
            "feasible": [int(not job["result"].get("reason")) for job in done],
            "reasons": [job["result"].get("reason", "") for job in done],
            "soles": [packed(_read_contour(job["folder"] / "contour.csv"), exact=True) for job in done],
        },
        "top": [foot["top"] for foot in feet],
        "width": [foot["width"] for foot in feet],
        "best": 0,
        "entry": {"versions": done[0]["result"]["versions"]} if done else None,
        "traces": [  # a study of many scenarios leaves no walk
            {"design": i} | _read_traces(job["folder"] / "walk.nc")
            for i, job in enumerate(done)
            if (job["folder"] / "walk.nc").is_file()
        ],
    }


def _link(path: Path, folder: Path) -> str | None:
    """The address of a file, from a page in a folder; None if there is no such file."""
    return quote(Path(os.path.relpath(path, folder)).as_posix()) if path.is_file() else None


def _read_contour(path: Path) -> Array:
    """A sole as `foot.export.write_csv` left it, (m, 2), m."""
    points: Array = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2) / MM
    return points


def _read_traces(path: Path) -> dict[str, Any]:
    """Traces of a walk as `files.write_walk` left it, both feet together."""
    from scipy.io import netcdf_file

    with netcdf_file(path, mmap=False) as file:
        t, com, velocity, power, work = (
            np.array(file.variables[name][:]) for name in ("t", "com", "velocity", "power", "work")
        )
    return {
        "t": packed(t, exact=True),
        "height": packed(com[:, 1], exact=True),
        "speed": packed(velocity[:, 0], exact=True),
        "power": packed(power.sum(axis=1), exact=True),
        "work": packed(work.sum(axis=1), exact=True),
    }


def _common(entry: dict[str, Any], scene: Scene, names: Sequence[str]) -> dict[str, Any]:
    """What every page of walks holds: the columns of values, the scene's gait, the run's own facts."""
    t = np.linspace(0.0, scene.duration, int(np.ceil(scene.duration / POSE_STEP)) + 1)
    thigh, shank, pitch = (angle for angle, _ in scene.gait.angles(t))
    return {
        "columns": [_column(name, OBJECTIVES[name].unit, OBJECTIVES[name].maximise) for name in names],
        # the designs are on the page anyway
        "entry": {name: value for name, value in entry.items() if name not in ("front", "confirmed")},
        "gait": {
            "end": scene.duration,
            "angles": packed(np.stack([thigh, shank, pitch], axis=-1)),
            "strikes": scene.gait.heel_strikes(scene.duration),
            "l1": scene.walker.l1,
            "l2": scene.walker.l2,
        },
    }


def _column(name: str, unit: str, maximise: bool) -> dict[str, Any]:
    title = "efficiency J_W" if name == "efficiency" else name.replace("_", " ")
    return {"name": name, "title": title, "unit": unit, "maximise": maximise}


def successive_bests(result: SearchResult) -> list[int]:
    """The designs that were the best so far at the end of a generation, in order; the last is the best."""
    f = np.where(result.feasible, result.problem.minimised(result.values)[:, 0], np.inf)
    before = np.concatenate([[np.inf], np.minimum.accumulate(f)[:-1]])
    better = np.flatnonzero(f < before)
    last = np.append(result.generation[better][1:] != result.generation[better][:-1], True)
    return [int(i) for i in better[last]]


def _spread(ranked: list[int], most: int) -> list[int]:
    """At most so many of a ranking, evenly spread, the first and the last among them."""
    picks = np.unique(np.linspace(0, len(ranked) - 1, min(most, len(ranked))).round().astype(int))
    return [ranked[i] for i in picks]


def _splines(space: Waypoints) -> dict[str, Any]:
    """Every sole of a space at once: a spline is linear in its heights.

    contour(k) = base + sum_i (k_i - 1) columns_i, in z; x is the same for all.
    """
    one = np.ones((1, space.n), int)
    base = space.contour(one)[0]
    raised = one + np.eye(space.n, dtype=int) if space.K > 1 else np.tile(one, (space.n, 1))
    columns = space.contour(raised)[:, :, 1] - base[:, 1]
    return {
        "n": space.n,
        "x": packed(base[:, 0], exact=True),
        "base": packed(base[:, 1], exact=True),
        "columns": packed(columns, exact=True),
        "waypoints": packed(space.x, exact=True),
        "step": space.H / space.K,
        "L": space.L,
        "H": space.H,
    }


def _traces(walk: Walk, frames: int) -> dict[str, Any]:
    """A walk at some of its samples, its peaks among them, and the forces along its sole."""
    foot = walk.foot
    shared = {"ankle": foot.ankle, "top": foot.top, "reason": walk.reason}
    if len(walk.t) == 0:
        return {**shared, "t": packed(walk.t)}
    peaks = [np.abs(walk.power).argmax(axis=0), np.abs(walk.force).reshape(len(walk.t), -1).argmax(axis=0)]
    even = np.searchsorted(walk.t, np.linspace(walk.t[0], walk.t[-1], frames))
    index = np.unique(np.concatenate([even, *peaks]))
    sole = foot.plates(walk.accuracy.plates, walk.accuracy.rule)
    begin, size = groups(sole.x.shape[1], ARROWS)
    # relative to the ankle, as plates are; the page turns and carries them
    at = [np.add.reduceat(part[0], begin) / size for part in (sole.x, sole.z)]
    force = np.add.reduceat(walk.plates(index).force, begin, axis=2)
    return {
        **shared,
        "t": packed(walk.t[index], exact=True),
        **{
            name: packed(getattr(walk, name)[index]) for name in ("com", "velocity", "force", "power", "work")
        },
        "at": packed(np.stack(at, axis=-1)),
        "arrows": packed(force),
    }


# --- numbers --------------------------------------------------------------------------------------


def packed(values: ArrayLike, exact: bool = False) -> dict[str, Any]:
    """An array as the page reads it.

    Whole numbers stay exact up to 2^24; other values are rounded to 1/65535 of their range, or, with
    `exact`, to 32-bit floats (which keep a NaN).
    """
    array = np.asarray(values)
    large = array.size and np.issubdtype(array.dtype, np.integer) and np.ptp(array) > 65535
    if exact or large:
        whole, low, step = array.astype("<f4"), 0.0, 0.0
    else:
        low, high = (float(array.min()), float(array.max())) if array.size else (0.0, 0.0)
        fits = np.issubdtype(array.dtype, np.integer) or high == low
        step = 1.0 if fits else (high - low) / 65535
        whole = np.round((array - low) / step).astype("<u2")
    data = base64.b64encode(whole.tobytes()).decode("ascii")
    return {"shape": array.shape, "low": low, "step": step, "data": data}
