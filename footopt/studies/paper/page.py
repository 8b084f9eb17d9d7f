"""What the paper's study found: plain data for result.json, and tables of words for the page claims.md."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

from footopt.files.run import plain
from footopt.foot.waypoints import written
from footopt.report import terminal
from footopt.report.numbers import number
from footopt.studies.paper.claims import CLAIMS, SANDS, Evidence
from footopt.studies.paper.judge import Judgement, chance, summary
from footopt.studies.paper.quantities import inward_turn, rms_curvature
from footopt.studies.paper.sweep import Plan, shown
from footopt.walk import Walk
from footopt.walk.objectives import FIVE
from footopt.walk.validity import diagnose

Entry = Mapping[str, Any]


# --- result.json ----------------------------------------------------------------------------------


def content(
    evidence: Evidence, plan: Plan, judged: Mapping[str, Judgement], seeds: Mapping[str, Sequence[Walk]]
) -> dict[str, Any]:
    """Return what result.json holds, in JSON's own types; `seeds`: each sand's walks, best first."""
    found = {
        "sweep": {
            "samples": len(plan.levels),
            "search": {"pop_size": plan.config.solver.pop_size, "n_gen": plan.config.solver.n_gen},
            "factors": [dataclasses.asdict(factor) for factor in plan.chosen],
        },
        "claims": [
            {"id": name, **CLAIMS[name]._asdict(), **dataclasses.asdict(judgement)}
            for name, judgement in judged.items()
        ],
        "optima": {
            sand: _foot_entry(evidence, evidence.optima[sand])
            | {"all_seeds_best_first": [_seed_entry(evidence, walk) for walk in seeds[sand]]}
            for sand in SANDS
        },
        "shapes": {name: _walk_entry(evidence, walk) for name, walk in evidence.shapes.items()},
    }
    return dict(plain(found))


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


def _seed_entry(evidence: Evidence, walk: Walk) -> dict[str, Any]:
    efficiency = evidence.value(walk, "efficiency")
    return {"k": walk.foot.k, "hollow_mm": 1e3 * walk.foot.hollow, "efficiency": efficiency}


# --- tables ---------------------------------------------------------------------------------------


def claim_rows(found: Entry) -> list[list[str]]:
    """Return a row for each claim: its figure, its words, its margin, its share and the verdict."""
    rows = []
    for c in found["claims"]:
        share = "-"
        if c["share_of_sweep"] is not None:
            undecided = f" ({c['undecided']} undecided)" if c["undecided"] else ""
            share = f"{100 * c['share_of_sweep']:.0f} %{undecided}"
        verdict = f"{c['verdict']} {c['condition']}".rstrip()
        rows.append([c["place"], c["says"], _margin(c["margin"], c["unit"]), share, verdict])
    return rows


def _margin(value: float | None, unit: str) -> str:
    """A margin of three digits with its sign and unit."""
    if value is None:
        return "-"
    sign = "+" if value > 0 else "-" if value < 0 else ""
    return f"{sign}{number(abs(float(f'{value:.3g}')))} {unit}".rstrip()


def decision_rows(found: Entry) -> list[list[str]]:
    """Return a row for each claim whose outcome changes: three settings that explain most, what turns it."""
    rows = []
    for c in found["claims"]:
        if c["turned_by"] or 0.0 < (c["share_of_sweep"] or 0.0) < 1.0:
            ranked = sorted(c["sensitivity"].items(), key=lambda item: -item[1])[:3]
            three = [f"{setting} {value:.2f}" if value >= 0.005 else "-" for setting, value in ranked]
            rows.append([c["says"], *three, ", ".join(c["turned_by"]) or "none"])
    return rows


def _foot_cells(foot: Entry) -> list[str]:
    numbers = f"{foot['hollow_mm']:.1f} {foot['turns_inwards_deg']:.0f} {foot['rms_curvature_per_m']:.1f}"
    return [written(foot["k"]), *numbers.split(), *_walk_cells(foot)]


def _walk_cells(walk: Entry) -> list[str]:
    cells = ["-" if value is None else number(value) for value in walk["objectives"].values()]
    return [walk["reason"], *cells[1:]] if walk["reason"] else cells


# --- claims.md ------------------------------------------------------------------------------------


def markdown(found: Entry) -> str:
    """Return the page claims.md: `content`, as result.json has it, in words, and the errata."""
    swept, claims = found["sweep"], found["claims"]
    share = (
        "The share is that of {samples} random combinations of what the paper leaves open in which the claim "
        "holds; for each of them feet were searched again on every sand by a GA of {search[pop_size]} x "
        "{search[n_gen]}. Combinations in which a walk failed are undecided."
    )
    warnings = [
        f"- {sand} sand: {says}" for sand, foot in found["optima"].items() for says in foot["warnings"]
    ]
    page = _text("page.md").format(
        summary=summary([claim["verdict"] for claim in claims]),
        swept=share.format(**swept) if swept["samples"] else "Nothing was swept (`study.samples=0`).",
        claims=terminal.markdown_rows(claim_rows(found)),
        feet=terminal.markdown_rows([sand, *_foot_cells(foot)] for sand, foot in found["optima"].items()),
        warnings="\n".join(warnings or ["- nothing"]),
        shapes=terminal.markdown_rows([name, *_walk_cells(shape)] for name, shape in found["shapes"].items()),
        decided=terminal.markdown_rows([c["says"], c["decided"], c["unit"]] for c in claims),
        factors=terminal.markdown_rows(
            [f["setting"], ", ".join(map(shown, f["levels"])), f["why"]] for f in swept["factors"]
        ),
        chance=chance(swept["samples"], 3),
        decides=terminal.markdown_rows(decision_rows(found)),
    )
    return page + errata()


def errata() -> str:
    """Return the slips found in the paper, as a section of a Markdown page."""
    return "#" + _text("errata.md")  # one level lower


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
