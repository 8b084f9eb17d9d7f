"""Is the law right? Experiments by other people, repeated without tuning: error, uncertainty, verdict."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rich.table import Table
from rich.text import Text

from footopt.errors import SettingError
from footopt.files.run import write_text
from footopt.report import terminal
from footopt.report.figures.validation import experiment, law_name, overview
from footopt.report.numbers import number
from footopt.studies.base import Study
from footopt.studies.validation.compare import AGREES, DIFFERS, OPEN, Comparison, Experiment, experiments

HEADER = ("experiment", "quantity", "unit", "law", "point", "S", "D", "E", "u", "u_num", "u_input", "u_exp")


def run(study: Study) -> None:
    """Repeat every experiment under its laws."""
    chosen = cases(study.options.cases)
    found: dict[str, list[Comparison]] = {}
    with study.compiling(), study.progress(sum(len(e.laws) for e in chosen), "law") as step:
        for e in chosen:
            found[e.name] = []
            for law in e.laws:
                found[e.name] += e.compare(law)
                step(news=f"{e.title}, {law_name(law)}")
    every = [c for own in found.values() for c in own]
    study.write_csv("validation.csv", HEADER, [row for c in every for row in rows(c)])
    titles = {e.name: e.title for e in chosen}
    study.save(
        "overview", overview(every, titles), "Error of every comparison, and what it could have resolved."
    )
    for e in chosen:
        about, reading, source = words(e, "about", "reading", "source")
        caption = f"{e.title}. {about} {reading} Source: {source}."
        study.save(e.name, experiment(found[e.name], e.content.get("x", "")), caption)
    write_text(study.folder / "validation.md", markdown(chosen, found))
    study.conclude(
        "The law against experiments",
        [table(every, titles)],
        {"counts": counts(every), "comparisons": [entry(c) for c in every]},
        said=[summary(every)],
    )


def cases(names: Sequence[str] | None) -> list[Experiment]:
    """The experiments that the settings name; null is all."""
    known = {e.name: e for e in experiments()}
    if names is not None and (unknown := [name for name in names or [""] if name not in known]):
        raise SettingError("study.cases", unknown[0], f"one of {', '.join(known)}")
    return [e for e in known.values() if names is None or e.name in names]


def rows(c: Comparison) -> list[list[object]]:
    """A comparison for validation.csv, a row a point."""
    numbers = (c.simulated, c.measured, c.error, c.uncertainty, c.numerical, c.inputs, c.experimental)
    what = [c.experiment, c.quantity, c.unit, law_name(c.law)]
    return [[*what, point, *values] for point, *values in zip(c.points, *numbers, strict=True)]


def entry(c: Comparison) -> dict[str, Any]:
    """A comparison in result.json."""
    return {
        "experiment": c.experiment,
        "quantity": c.quantity,
        "unit": c.unit,
        "law": list(c.law),
        "error_rms": c.size,
        "error_mean": c.bias,
        "band": c.band,
        "scale": c.scale,
        "verdict": c.verdict,
    }


def counts(found: Sequence[Comparison]) -> dict[str, int]:
    """How many comparisons have each verdict."""
    number_of = Counter(c.verdict for c in found)
    return {verdict: number_of[verdict] for verdict in (AGREES, DIFFERS, OPEN)}


def summary(found: Sequence[Comparison]) -> str:
    """All verdicts, and what they owe to the uncertainty of the data, which is often assumed."""
    halved, doubled = (
        counts([replace(c, experimental=share * c.experimental) for c in found])[DIFFERS]
        for share in (0.5, 2.0)
    )
    said = summary_of(*counts(found).values())
    return f"{said} With half the uncertainty of the data {halved} would differ, with twice of it {doubled}."


def summary_of(agree: int, differ: int, open_: int) -> str:
    """Counts of verdicts in a sentence."""
    both = agree + differ + open_
    return f"Of {both} comparisons {agree} agree, {differ} differ, and {open_} cannot be told."


def cells(c: Comparison) -> list[str]:
    """A comparison's numbers in tables: rms and mean of E, 2 u, as parts of the scale."""
    size, bias, band = (100.0 * value / c.scale for value in (c.size, c.bias, c.band))
    return [number(c.scale), f"{size:.0f} %", f"{bias:+.0f} %", f"{band:.0f} %"]


def table(found: Sequence[Comparison], titles: dict[str, str]) -> Table:
    """All comparisons for the terminal; what differs is bold."""
    words = ("experiment", "quantity", "law", "verdict")
    shown = terminal.table(
        ("experiment", "quantity", "law", "scale", "E rms", "E mean", "2 u", "verdict"), words
    )
    shown.title = "E, simulated less measured, and its uncertainty 2 u (ASME V&V 20), as parts of the scale"
    for c in found:
        what = f"{c.quantity} ({c.unit})" if c.unit != "1" else c.quantity
        verdict = Text(c.says, style="bold" if c.verdict == DIFFERS else "")
        shown.add_row(titles[c.experiment], what, law_name(c.law), *cells(c), verdict)
    return shown


def words(e: Experiment, *parts: str) -> list[str]:
    """Texts of an experiment's file, each in one line."""
    return [" ".join(e.content[part].split()) for part in parts]


def markdown(chosen: Sequence[Experiment], found: dict[str, list[Comparison]]) -> str:
    """The page validation.md: the table, then what was done and found in each experiment, and its source."""
    head = ["experiment", "quantity", "law", "scale", "E rms", "E mean", "2 u", "verdict"]
    lines = ["# The law against experiments", "", summary([c for own in found.values() for c in own]), ""]
    lines += [terminal.markdown_rows([head, ["---"] * len(head)])]
    for e in chosen:
        lines += [markdown_rows(e, found[e.name])]
    for e in chosen:
        about, reading, source = words(e, "about", "reading", "source")
        lines += ["", f"## {e.title}", "", about, "", f"![{e.title}](figures/{e.name}.png)", "", reading, ""]
        for name, part in e.content.get("inputs", {}).items():
            lines.append(f"- {name}: {part['value']} ({part['low']} to {part['high']}): {part['why']}")
        for q in e.content["quantities"]:
            size = (
                f"{100 * q['uncertainty']:g} %" if q.get("relative") else f"{q['uncertainty']:g} {q['unit']}"
            )
            lines.append(f"- uncertainty of the measured {q['name']}: {size.removesuffix(' 1')}; {q['why']}")
        lines.append(f"- source: {source}")
    return "\n".join(lines) + "\n"


def markdown_rows(e: Experiment, found: Sequence[Comparison]) -> str:
    """An experiment's comparisons as rows of a Markdown table."""
    rows = []
    for c in found:
        scale, *parts = cells(c)
        unit = "" if c.unit == "1" else f" {c.unit}"
        rows.append([e.title, c.quantity, law_name(c.law), scale + unit, *parts, c.says])
    return terminal.markdown_rows(rows)
