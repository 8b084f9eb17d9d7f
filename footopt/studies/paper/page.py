"""Claims, sensitivities and errata as tables: for the terminal, as Markdown, and for claims.json."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.terminal import number
from footopt.studies.paper.claims import CLAIMS, SANDS, Claim, Evidence, inward_turn, rms_curvature
from footopt.studies.paper.errata import ERRATA
from footopt.studies.paper.sweep import Factor, Judgement, chance, shown
from footopt.walk.objectives import FIVE, OBJECTIVES
from footopt.walk.results import Walk
from footopt.walk.validity import diagnose

Array = NDArray[np.float64]


def margin(claim: Claim, value: float) -> str:
    """A margin with its sign and unit."""
    if not math.isfinite(value):
        return "-"
    sign = "+" if value > 0 else "-" if value < 0 else ""
    return f"{sign}{number(abs(float(f'{value:.3g}')))} {claim.unit}".rstrip()


def share(j: Judgement) -> str:
    """The share of the sweep in percent, and how many combinations were undecided, if any."""
    if math.isnan(j.share):
        return "-"
    return f"{j.share:.0%}" + (f" ({j.undecided} undecided)" if j.undecided else "")


def summary(judged: Mapping[str, Judgement]) -> str:
    """How many claims hold, in one line."""
    kinds = ("holds", "holds only if", "does not hold")
    counts = [sum(kind(j) == k for j in judged.values()) for k in kinds]
    return f"{len(judged)} claims: {counts[0]} hold, {counts[1]} hold only if, {counts[2]} do not hold"


def kind(judged: Judgement) -> str:
    """The verdict without its condition."""
    return "holds only if" if judged.verdict.startswith("holds only if") else judged.verdict


def table(judged: Mapping[str, Judgement]) -> Table:
    """The claims for the terminal."""
    shown = terminal.table(
        ("figure", "claim", "margin", "share", "verdict"),
        words=("figure", "claim", "verdict"),
        title="What the paper says, and what comes out",
    )
    for name, j in judged.items():
        c = CLAIMS[name]
        shown.add_row(c.place, c.says, margin(c, j.margin), share(j), j.verdict)
    return shown


def sensitivity_table(judged: Mapping[str, Judgement], chosen: Sequence[Factor]) -> Table:
    """For each claim the three settings that explain most of its outcome."""
    titles = ("claim", "first", "second", "third", "single changes that turn it")
    table = terminal.table(
        titles, words=titles, title="Which setting decides: share of the outcome's variance that it explains"
    )
    for name, j in judged.items():
        if 0.0 < j.share < 1.0:
            table.add_row(name, *_first_three(j), ", ".join(j.flips))
    return table


def _first_three(j: Judgement) -> list[str]:
    ranked = sorted(j.sensitivities.items(), key=lambda item: -item[1])[:3]
    return [f"{setting} {value:.2f}" if value >= 0.005 else "-" for setting, value in ranked]


def claim_entries(
    judged: Mapping[str, Judgement], changes: Sequence[str], alone: Array
) -> list[dict[str, Any]]:
    """The claims in claims.json; `alone` (changes, claims) are the margins of single changes."""
    return [
        {
            "id": name,
            "place": CLAIMS[name].place,
            "says": CLAIMS[name].says,
            "decided": CLAIMS[name].decided,
            "unit": CLAIMS[name].unit,
            "margin": j.margin,
            "holds_at_the_settings": j.holds,
            "verdict": kind(j),
            "condition": j.verdict.removeprefix("holds only if ") if kind(j) == "holds only if" else "",
            "share_of_sweep": j.share,
            "undecided": j.undecided,
            "decides": j.decides,
            "share_by_level": j.rates,
            "sensitivity": j.sensitivities,
            "single_changes": dict(zip(changes, alone[:, i], strict=True)),
            "turned_by": list(j.flips),
        }
        for i, (name, j) in enumerate(judged.items())
    ]


def erratum_entries() -> list[dict[str, str]]:
    """The errata in claims.json."""
    return [erratum._asdict() for erratum in ERRATA]


def markdown(
    evidence: Evidence,
    judged: Mapping[str, Judgement],
    chosen: Sequence[Factor],
    samples: int,
    budget: tuple[int, int],
) -> str:
    """Everything that was found, as one page."""
    swept = (
        f"Share: of {samples} random combinations of what the paper leaves open (below), each with feet "
        f"searched again on every sand by a GA of {budget[0]} x {budget[1]}, the part in which the claim "
        "holds; undecided are those in which a walk failed."
        if samples
        else "Nothing was swept (study.samples=0)."
    )
    rows = ((CLAIMS[name], j) for name, j in judged.items())
    parts = [
        "# The paper, claim by claim",
        f"{summary(judged)}. Margins are positive where a claim holds at the settings. {swept}",
        grid(
            ("figure", "claim", "margin", "share", "verdict"),
            ((c.place, c.says, margin(c, j.margin), share(j), j.verdict) for c, j in rows),
        ),
        "## The feet",
        grid(
            ("sand", "k", "hollow (mm)", "turns inwards (deg)", "rms curvature (1/m)", *_titles()),
            (
                (sand, *_shape_of(evidence.optima[sand].foot), *_values(evidence, evidence.optima[sand]))
                for sand in SANDS
            ),
        ),
        *_outside(evidence),
        "## The five shapes",
        grid(("shape", *_titles()), ((n, *_values(evidence, w)) for n, w in evidence.shapes.items())),
        "## How each claim is decided",
        grid(("claim", "margin is", "unit"), ((c.says, c.decided, c.unit) for c in CLAIMS.values())),
    ]
    if samples:
        parts += [
            "## What the paper leaves open",
            grid(
                ("setting", "levels (the first is the default)", "why"),
                ((f.setting, ", ".join(map(shown, f.levels)), f.why) for f in chosen),
            ),
            "## Which setting decides",
            "Share of the variance of a claim's outcome that a setting explains by itself (epsilon squared); "
            "and single changes from the settings that turn the outcome, with feet searched again by the "
            "smaller GA: where the settings' own seed turns it, the smaller search does. A setting of three "
            f"levels without influence reaches {chance(samples, 3):.2f} in one of twenty sweeps like this.",
            grid(
                ("claim", "first", "second", "third", "turned by"),
                (
                    (CLAIMS[name].says, *_first_three(j), ", ".join(j.flips) or "none")
                    for name, j in judged.items()
                ),
            ),
        ]
    parts += ["## Errata", grid(("where", "the paper", "why not", "footopt"), ERRATA)]
    return "\n\n".join(parts) + "\n"


def _outside(evidence: Evidence) -> list[str]:
    """For each sand what of its best foot's walk is outside the range that RFT has been tested for."""
    lines = []
    for sand in SANDS:
        outside = [d for d in diagnose(evidence.optima[sand]) if d.outside]
        if outside:
            numbers = (f"{d.name} {number(d.value)} {d.unit}".rstrip() + f" ({d.why})" for d in outside)
            lines.append(f"Outside what RFT has been tested for, on {sand} sand: {'; '.join(numbers)}.")
    return lines


def grid(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def _titles() -> list[str]:
    return [*(f"{name.replace('_', ' ')} ({OBJECTIVES[name].unit})" for name in FIVE), "J_W"]


def _values(evidence: Evidence, walk: Walk) -> list[str]:
    if not walk.feasible:
        return [walk.reason, *["-"] * len(FIVE)]
    return [number(evidence.value(walk, name)) for name in (*FIVE, "efficiency")]


def _shape_of(foot: Foot) -> list[str]:
    k = " ".join(map(str, foot.k or ()))
    return [k, f"{1e3 * foot.hollow:.1f}", f"{inward_turn(foot):.0f}", f"{rms_curvature(foot):.1f}"]
