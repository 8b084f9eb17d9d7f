"""`effects=auto`: let the effect audit decide which effects a run simulates, and record why."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rich.console import Console

from footopt.effects import Inertia, LeadingEdge
from footopt.errors import check
from footopt.foot import Foot
from footopt.report import terminal
from footopt.studies import build
from footopt.studies.settings import Config
from footopt.walk import FIVE, Scene
from footopt.walk.accuracy import TOLERANCES
from footopt.walk.audit import Audit, audit, parameters

#: Effects with parameters from the literature: those that `effects=auto` decides on. The others say
#: what the ground is like, which only the user knows.
DECIDABLE: tuple[type[Any], ...] = (LeadingEdge, Inertia)

TOLERANCE = 0.01  # where neither the effects nor the accuracy state one
AUTO_FEET = 40  # random soles that decide for a search
COMPILING = "Compiling a walk for each effect; this is done once and kept on disk ..."


def tolerance(config: Config) -> float:
    """The relative change that matters: the effects' own, the accuracy's, or `TOLERANCE`."""
    given = config.effects.tolerance
    if given is not None:
        check(0 < given < 1, "effects.tolerance", given, "a relative change between 0 and 1")
        return given
    return config.accuracy.tolerance or TOLERANCES.get(config.accuracy.name, TOLERANCE)


def settle(config: Config, foot: Foot | None, out: Console) -> tuple[Scene, list[dict[str, Any]]]:
    """The scene of a configuration, with the effects that `effects=auto` decides for.

    Parameters
    ----------
    foot : the one that walks; None: random soles of the design space decide.

    Returns
    -------
    scene. audits : for result.json; empty unless `effects.auto`.
    """
    scene = build.make_scene(replace(config, effects=replace(config.effects, auto=False)))
    if not config.effects.auto:
        return scene, []
    space = build.make_space(config.foot)
    feet: Any = [foot] if foot else space.random(AUTO_FEET, seed=config.solver.seed, inside=True)
    accuracy, limit = build.make_accuracy(config.accuracy), tolerance(config)
    open_ = [kind() for kind in DECIDABLE if not any(isinstance(e, kind) for e in scene.effects)]
    with terminal.told_if_slow(out, COMPILING):
        found = [audit(effect, scene, feet, accuracy, limit, space) for effect in open_]
    for a in found:
        out.print(f"effects=auto: {a.name.replace('_', ' ')} {a.verdict}")
    kept = tuple(a.effect for a in found if a.matters)
    return replace(scene, effects=(*scene.effects, *kept)), [entry(a) for a in found]


def entry(a: Audit) -> dict[str, Any]:
    """An audit in result.json."""
    return {
        "effect": a.name,
        "parameters": parameters(a.effect),
        "sand": a.scene.sand.name,
        "changes": dict(zip(FIVE, a.changes.tolist(), strict=True)),
        "shifts": dict(zip(FIVE, a.shifts.tolist(), strict=True)),
        "kendall_tau": a.tau,
        "walks_lost": a.lost,
        "feet": a.feet,
        "time_ratio": a.cost,
        "tolerance": a.tolerance,
        "matters": a.matters,
        "verdict": a.verdict,
    }
