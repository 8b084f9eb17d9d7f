"""study=validate: experiments by other people, repeated without tuning: error, uncertainty, verdict."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from footopt.report import terminal
from footopt.report.figures.validation import experiment, law_name, overview
from footopt.studies.runs import Study
from footopt.studies.validation.compare import AGREES, DIFFERS, Comparison, experiments

HEAD = ("experiment", "quantity", "law", "E", "mean", "2 u", "verdict")
WORDS = ("experiment", "quantity", "law", "verdict")
#: How an experiment is predicted by the law that meets most of its quantities.
MET = ("in all quantities", "in some", "in none")


def run(study: Study) -> None:
    """Repeat every experiment under its laws."""
    known = experiments()
    chosen = [known[name] for name in study.some_of(known)]
    found: list[Comparison] = []
    with study.progress(sum(len(e.content["laws"]) for e in chosen), "law") as step:
        for e in chosen:
            for law in e.content["laws"]:
                found += e.compare(law)
                step(news=f"{e.content['title']}, {law_name(law)}")
    titles = {e.name: e.content["title"] for e in chosen}
    judged = [c for c in found if not c.apart]
    caption = "Error of every comparison with a verdict, and the least error that it resolves."
    if judged:
        study.save("overview", overview(judged, titles), caption)
    for e in chosen:
        caption = f"{titles[e.name]}. {e.text('about')} {e.text('reading')} Source: {e.text('source')}."
        own = [c for c in found if c.experiment == e.name]
        study.save(e.name, experiment(own, e.content.get("x", "")), caption)
    table = terminal.table(HEAD, WORDS)
    table.title = "E, simulation less data, and its uncertainty 2 u (ASME V&V 20), over the scale"
    for c in sorted(found, key=lambda c: bool(c.apart)):
        table.add_row(*cells(c), style="bold" if c.verdict == DIFFERS else "")
    study.conclude(
        "The law against experiments",
        [table],
        {
            "counts": counts(found),
            "comparisons": [{**vars(c), "error": c.size, "verdict": c.verdict} for c in found],
        },
        summary=[summary(found)],
    )


def counts(found: Sequence[Comparison], share: float = 1.0) -> dict[str, int]:
    """Experiments by what their best law predicts; `share` multiplies the uncertainty of the data."""
    agree: dict[str, dict[tuple[str, ...], list[bool]]] = {}
    for c in found:
        if not c.apart:
            verdict = replace(c, experimental=share * c.experimental).verdict
            agree.setdefault(c.experiment, {}).setdefault(c.law, []).append(verdict == AGREES)
    best = [max(sum(own) / len(own) for own in laws.values()) for laws in agree.values()]
    number_of = Counter(MET[0] if part == 1.0 else MET[1] if part else MET[2] for part in best)
    return {met: number_of[met] for met in MET}


def summary(found: Sequence[Comparison]) -> str:
    """The count of experiments, and how it depends on the uncertainty of the data, which is often assumed."""
    own, halved, doubled = (counts(found, share) for share in (1.0, 0.5, 2.0))
    told = ", ".join(f"{number} {met}" for met, number in own.items())
    return (
        f"Of {sum(own.values())} experiments with measured data the best of the laws predicts {told}; with "
        f"half the uncertainty of the data {halved[MET[2]]} {MET[2]}, with twice of it {doubled[MET[2]]}."
    )


def cells(c: Comparison) -> list[str]:
    """A comparison in tables: rms and mean of E, and 2 u, as parts of the scale."""
    size, bias, band = (100.0 * value / c.scale for value in (c.size, c.bias, c.band))
    shares = [f"{size:.0f} %", f"{round(bias):+d} %", f"{band:.0f} %"]
    return [c.experiment, c.quantity, law_name(c.law), *shares, c.verdict]
