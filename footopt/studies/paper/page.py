"""claims.json and its page claims.md: what was found, as plain data, and the same data as tables of words."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any, NamedTuple

from rich.table import Table as RichTable

from footopt.files.run import plain
from footopt.report import terminal
from footopt.report.terminal import number
from footopt.studies.paper.claims import CLAIMS, Claim
from footopt.studies.paper.evidence import SANDS, Evidence
from footopt.studies.paper.factors import Plan, shown
from footopt.studies.paper.judge import Judgement, chance, summary
from footopt.studies.paper.quantities import inward_turn, rms_curvature
from footopt.walk import Walk
from footopt.walk.objectives import FIVE, OBJECTIVES
from footopt.walk.validity import diagnose

Entry = Mapping[str, Any]


class Table(NamedTuple):
    """A table of words."""

    head: tuple[str, ...]
    rows: list[list[str]]
    title: str = ""

    def markdown(self) -> str:
        """Return the table in Markdown, without its title."""
        lines = [self.head, ["---"] * len(self.head), *self.rows]
        return "\n".join(
            "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
        )

    def rich(self, words: Sequence[str]) -> RichTable:
        """Return the table for the terminal; columns of `words` wrap, numbers never."""
        table = terminal.table(self.head, words=words, title=self.title)
        for row in self.rows:
            table.add_row(*row)
        return table


# --- claims.json ----------------------------------------------------------------------------------


def content(evidence: Evidence, plan: Plan, judged: Mapping[str, Judgement]) -> dict[str, Any]:
    """Return what claims.json holds, in JSON's own types."""
    found = {
        "sweep": {
            "samples": len(plan.levels),
            "search": {"pop_size": plan.config.solver.pop_size, "n_gen": plan.config.solver.n_gen},
            "factors": [dataclasses.asdict(factor) for factor in plan.chosen],
        },
        "claims": [
            {"id": name, **_words(CLAIMS[name]), **dataclasses.asdict(judgement)}
            for name, judgement in judged.items()
        ],
        "feet": {sand: _foot_entry(evidence, evidence.optima[sand]) for sand in SANDS},
        "shapes": {name: _walk_entry(evidence, walk) for name, walk in evidence.shapes.items()},
    }
    return dict(plain(found))


def _words(claim: Claim) -> dict[str, str]:
    return {"place": claim.place, "says": claim.says, "decided": claim.decided, "unit": claim.unit}


def _foot_entry(evidence: Evidence, walk: Walk) -> dict[str, Any]:
    return {
        "k": walk.foot.k,
        "hollow_mm": 1e3 * walk.foot.hollow,
        "turns_inwards_deg": inward_turn(walk.foot),
        "rms_curvature_per_m": rms_curvature(walk.foot),
        **_walk_entry(evidence, walk),
        "warnings": [terminal.describe_outside(d) for d in diagnose(walk) if d.outside],
    }


def _walk_entry(evidence: Evidence, walk: Walk) -> dict[str, Any]:
    objectives = {name: evidence.value(walk, name) for name in (*FIVE, "efficiency")}
    return {"reason": walk.reason, "objectives": objectives}


# --- tables ---------------------------------------------------------------------------------------


def claims_table(found: Entry) -> Table:
    """Return the claims with their margins, shares and verdicts."""
    rows = []
    for c in found["claims"]:
        share = "-"
        if c["share_of_sweep"] is not None:
            undecided = f" ({c['undecided']} undecided)" if c["undecided"] else ""
            share = f"{100 * c['share_of_sweep']:.0f} %{undecided}"
        verdict = f"{c['verdict']} {c['condition']}".rstrip()
        rows.append([c["place"], c["says"], _margin(c["margin"], c["unit"]), share, verdict])
    head = ("figure", "claim", "margin", "share", "verdict")
    return Table(head, rows, "What the paper says, and what comes out")


def _margin(value: float | None, unit: str) -> str:
    """A margin of three digits with its sign and unit."""
    if value is None:
        return "-"
    sign = "+" if value > 0 else "-" if value < 0 else ""
    return f"{sign}{number(abs(float(f'{value:.3g}')))} {unit}".rstrip()


def sensitivity_table(found: Entry) -> Table:
    """Return the three settings that explain most of each claim whose outcome changes."""
    rows = []
    for c in found["claims"]:
        if c["turned_by"] or 0.0 < (c["share_of_sweep"] or 0.0) < 1.0:
            ranked = sorted(c["sensitivity"].items(), key=lambda item: -item[1])[:3]
            three = [f"{setting} {value:.2f}" if value >= 0.005 else "-" for setting, value in ranked]
            rows.append([c["says"], *three, ", ".join(c["turned_by"]) or "none"])
    head = ("claim", "first", "second", "third", "single changes that turn it")
    return Table(head, rows, "Which setting decides")


# --- claims.md ------------------------------------------------------------------------------------

OBJECTIVE_TITLES = (*(f"{name.replace('_', ' ')} ({OBJECTIVES[name].unit})" for name in FIVE), "J_W")


def markdown(found: Entry) -> str:
    """Return the page claims.md: all of claims.json in words, and the errata.

    Parameters
    ----------
    found : dict
        What `content` returned, or claims.json as it was read.
    """
    feet = [
        [
            sand,
            " ".join(map(str, foot["k"])),
            f"{foot['hollow_mm']:.1f}",
            f"{foot['turns_inwards_deg']:.0f}",
            f"{foot['rms_curvature_per_m']:.1f}",
            *_objective_cells(foot),
        ]
        for sand, foot in found["feet"].items()
    ]
    factors = [
        [f["setting"], ", ".join(map(shown, f["levels"])), f["why"]] for f in found["sweep"]["factors"]
    ]
    tables = {
        "claims": claims_table(found),
        "feet": Table(
            ("sand", "k", "hollow (mm)", "turns inwards (deg)", "rms curvature (1/m)", *OBJECTIVE_TITLES),
            feet,
        ),
        "shapes": Table(
            ("shape", *OBJECTIVE_TITLES),
            [[name, *_objective_cells(shape)] for name, shape in found["shapes"].items()],
        ),
        "decided": Table(
            ("claim", "margin is", "unit"), [[c["says"], c["decided"], c["unit"]] for c in found["claims"]]
        ),
        "factors": Table(
            ("setting", "levels (the first is the default)", "what the paper does not say"), factors
        ),
        "decides": sensitivity_table(found),
    }
    samples, search = found["sweep"]["samples"], found["sweep"]["search"]
    swept = (
        f"The share is that of {samples} random combinations of what the paper leaves open in which the "
        "claim holds; for each of them feet were searched again on every sand by a GA of "
        f"{search['pop_size']} x {search['n_gen']}. Combinations in which a walk failed are undecided."
    )
    warnings = [
        f"- {sand} sand: {warning}" for sand, foot in found["feet"].items() for warning in foot["warnings"]
    ]
    return (
        _text("page.md").format(
            summary=summary([claim["verdict"] for claim in found["claims"]]),
            swept=swept if samples else "Nothing was swept (`study.samples=0`).",
            warnings="\n".join(warnings or ["- nothing"]),
            chance=chance(samples, 3),
            **{name: table.markdown() for name, table in tables.items()},
        )
        + errata()
    )


def _objective_cells(entry: Entry) -> list[str]:
    if entry["reason"]:
        return [entry["reason"], *["-"] * len(FIVE)]
    return [number(value) for value in entry["objectives"].values()]


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def errata() -> str:
    """Return the slips found in the paper, as a section of a Markdown page."""
    return "#" + _text("errata.md")  # one level lower
