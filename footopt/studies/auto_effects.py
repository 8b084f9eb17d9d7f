"""`effects=auto`: the effect audit decides which effects a run simulates, and result.json says why."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from footopt.effects import Inertia, LeadingEdge, Shadowing
from footopt.errors import check
from footopt.foot import Foot
from footopt.studies.base import Study
from footopt.studies.build import make_scene
from footopt.studies.settings import Config
from footopt.walk import FIVE, Scene
from footopt.walk.accuracy import TOLERANCES
from footopt.walk.audit import Audit, audit, parameters

#: Effects with parameters from the literature, which `effects=auto` decides on. The others say what the
#: ground is like, which only the user knows.
DECIDABLE: tuple[type[Any], ...] = (LeadingEdge, Inertia, Shadowing)

TOLERANCE = 0.01  # where neither the effects nor the accuracy state one
RANDOM_FEET = 40  # that decide for a search


def tolerance(config: Config) -> float:
    """The relative change that matters: the effects' own, the accuracy's, or `TOLERANCE`."""
    given = config.effects.tolerance
    if given is not None:
        check(0 < given < 1, "effects.tolerance", given, "a relative change between 0 and 1")
        return given
    return config.accuracy.tolerance or TOLERANCES.get(config.accuracy.name, TOLERANCE)


def choose_effects(study: Study, foot: Foot | None = None) -> tuple[Scene, list[dict[str, Any]]]:
    """The scene of a study, with the effects that `effects=auto` decides for.

    Parameters
    ----------
    study : Study
        Its settings name the scene.
    foot : Foot, optional
        The one that walks; without it random soles of the design space decide.

    Returns
    -------
    scene : Scene
        What is simulated.
    audits : list of dict
        For result.json; empty unless `effects.auto`.
    """
    config = study.config
    if not config.effects.auto:
        return study.scene, []
    scene = make_scene(replace(config, effects=replace(config.effects, auto=False)))
    feet: Any = [foot] if foot else study.space.random(RANDOM_FEET, seed=study.seed, inside=True)
    limit = tolerance(config)
    undecided = [kind() for kind in DECIDABLE if not any(isinstance(e, kind) for e in scene.effects)]
    found: list[Audit] = []
    with study.compiling("a walk for each effect"):
        for effect in undecided:  # each where those that matter are on: inertia acts on faces that lead
            found.append(audit(effect, scene, feet, study.accuracy, limit, study.space))
            if found[-1].matters:
                scene = replace(scene, effects=(*scene.effects, effect))
    for a in found:
        study.say(f"effects=auto: {a.name.replace('_', ' ')} {a.verdict}")
    return scene, [audit_entry(a) for a in found]


def audit_entry(a: Audit) -> dict[str, Any]:
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
