"""study=validate: experiments by other people, repeated without tuning: error, uncertainty, verdict."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from footopt.errors import check
from footopt.report import terminal
from footopt.report.figures.validation import experiment, law_name, overview
from footopt.report.numbers import number
from footopt.studies.base import Study
from footopt.studies.validation.compare import AGREES, DIFFERS, OPEN, Comparison, experiments

HEAD = ("experiment", "quantity", "law", "scale", "E rms", "E mean", "2 u", "verdict")
WORDS = ("experiment", "quantity", "law", "verdict")


def run(study: Study) -> None:
    """Repeat every experiment under its laws."""
    known, cases = experiments(), study.options.cases
    names = list(known) if cases is None else cases
    check(bool(names), "study.cases", cases, f"null, or some of {', '.join(known)}")
    for name in names:
        check(name in known, "study.cases", name, f"one of {', '.join(known)}")
    chosen = [e for e in known.values() if e.name in names]
    found: list[Comparison] = []
    with study.progress(sum(len(e.content["laws"]) for e in chosen), "law") as step:
        for e in chosen:
            for law in e.content["laws"]:
                found += e.compare(law)
                step(news=f"{e.content['title']}, {law_name(law)}")
    titles = {e.name: e.content["title"] for e in chosen}
    caption = "Error of every comparison, and the least error that it resolves."
    study.save("overview", overview(found, titles), caption)
    for e in chosen:
        caption = f"{titles[e.name]}. {e.text('about')} {e.text('reading')} Source: {e.text('source')}."
        own = [c for c in found if c.experiment == e.name]
        study.save(e.name, experiment(own, e.content.get("x", "")), caption)
    table = terminal.table(HEAD, WORDS)
    table.title = "E, simulated less measured, and its uncertainty 2 u (ASME V&V 20), as parts of the scale"
    for c in found:
        table.add_row(*cells(c, titles), style="bold" if c.verdict == DIFFERS else "")
    study.conclude(
        "The law against experiments",
        [table],
        {
            "counts": counts(found),
            "comparisons": [{**vars(c), "error": c.size, "verdict": c.verdict} for c in found],
        },
        summary=[summary(found)],
    )


def counts(found: Sequence[Comparison]) -> dict[str, int]:
    """How many comparisons have each verdict."""
    number_of = Counter(c.verdict for c in found)
    return {verdict: number_of[verdict] for verdict in (AGREES, DIFFERS, OPEN)}


def summary(found: Sequence[Comparison]) -> str:
    """All verdicts, and how they depend on the uncertainty of the data, which is often assumed."""
    halved, doubled = (
        counts([replace(c, experimental=share * c.experimental) for c in found])[DIFFERS]
        for share in (0.5, 2.0)
    )
    agree, differ, open_ = counts(found).values()
    return (
        f"Of {len(found)} comparisons {agree} agree, {differ} differ, and {open_} cannot be told. "
        f"With half the uncertainty of the data {halved} would differ, with twice of it {doubled}."
    )


def cells(c: Comparison, titles: Mapping[str, str]) -> list[str]:
    """A comparison in tables: rms and mean of E, and 2 u, as parts of the scale."""
    size, bias, band = (100.0 * value / c.scale for value in (c.size, c.bias, c.band))
    scale = f"{number(c.scale)} {c.unit}".removesuffix(" 1")
    shares = [f"{size:.0f} %", f"{bias:+.0f} %", f"{band:.0f} %"]
    return [titles[c.experiment], c.quantity, law_name(c.law), scale, *shares, c.verdict]
