"""`effects=auto`: the effect audit decides which effects a run simulates, and result.json says why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from footopt.effects.base import EFFECTS, parameters
from footopt.errors import check
from footopt.foot import Foot, Waypoints
from footopt.report import terminal
from footopt.studies.audit import QUANTILE, Audit, audit
from footopt.studies.base import Study
from footopt.studies.build import make_scene
from footopt.studies.screening import Criterion, screening
from footopt.studies.settings import Config
from footopt.walk import FIVE, Scene, evaluate
from footopt.walk.accuracy import TOLERANCES

TOLERANCE = 0.01  # where neither the effects nor the accuracy state one
RANDOM_FEET = 40  # that decide for a search


def tolerance(config: Config) -> float:
    """The relative change that matters: the effects' own, the accuracy's, or `TOLERANCE`."""
    given = config.effects.tolerance
    if given is not None:
        check(0 < given < 1, "effects.tolerance", given, "a relative change between 0 and 1")
        return given
    return config.accuracy.tolerance or TOLERANCES.get(config.accuracy.name, TOLERANCE)


@dataclass(frozen=True)
class Chosen:
    """What `effects=auto` decided.

    Parameters
    ----------
    scene : Scene
        What is simulated.
    audits, screening : list of dict
        For result.json; empty unless `effects.auto`.
    left_out : dict of float
        Relative change of each objective by the effects that are left out, all together.
    """

    scene: Scene
    audits: list[dict[str, Any]] = field(default_factory=list)
    screening: list[dict[str, Any]] = field(default_factory=list)
    left_out: dict[str, float] = field(default_factory=dict)

    @property
    def entry(self) -> dict[str, Any]:
        """In result.json."""
        return {"effects_audit": self.audits, "screening": self.screening, "left_out": self.left_out}


def choose_effects(study: Study, foot: Foot | None = None) -> Chosen:
    """The scene of a study, with the effects that `effects=auto` decides for.

    The table of the scene's numbers is shown first, with a warning for each outside of what was tested.

    Parameters
    ----------
    study : Study
        Its settings name the scene.
    foot : Foot, optional
        The one that walks; without it random soles of the design space decide.

    Returns
    -------
    Chosen
        The scene, and why.
    """
    config = study.config
    if not config.effects.auto:
        return Chosen(study.scene)
    scene = make_scene(replace(config, effects=replace(config.effects, auto=False)))
    feet: Any = [foot] if foot else study.space.random(RANDOM_FEET, seed=study.seed, inside=True)
    limit = tolerance(config)
    screened = screening(scene, soles(feet, study.space), limit)
    study.say(screening_table(screened))
    known = [kind for kind in EFFECTS.values() if kind.literature]
    undecided = [kind() for kind in known if not any(isinstance(e, kind) for e in scene.effects)]
    found: list[Audit] = []
    with study.compiling("a walk for each effect, minutes in all"):
        for effect in undecided:  # each where those that matter are on: inertia acts on faces that lead
            found.append(audit(effect, scene, feet, study.accuracy, limit, study.space))
            if found[-1].matters:
                scene = replace(scene, effects=(*scene.effects, effect))
        left = tuple(a.effect for a in found if not a.matters)
        whole = replace(scene, effects=(*scene.effects, *left))
        own, more = (evaluate(feet, s, study.accuracy, space=study.space).values for s in (scene, whole))
    for a in found:
        study.say(f"effects=auto: {a.name.replace('_', ' ')} {a.verdict}")
    for words in (c.warning for c in screened if c.warning):
        terminal.warn(study.console, f"effects=auto: outside of what was tested: {words}.")
    change = np.abs(more / own - 1.0)
    change = change[np.isfinite(change).all(axis=1)]
    sizes = np.percentile(change, QUANTILE, axis=0) if len(change) else np.zeros(len(FIVE))
    left_out = dict(zip(FIVE, sizes.tolist(), strict=True))
    return Chosen(scene, [audit_entry(a) for a in found], [screening_entry(c) for c in screened], left_out)


def soles(feet: Any, space: Waypoints) -> list[Foot]:
    """Feet as objects: they are, or are heights in a space."""
    return [foot if isinstance(foot, Foot) else Foot.from_waypoints(foot, space) for foot in feet]


def screening_table(found: Sequence[Criterion]) -> Table:
    """The numbers of a scene for the terminal."""
    words = ("effect", "number", "source", "verdict")
    shown = terminal.table(("effect", "number", "value", "limit", "source", "verdict"), words)
    shown.title = (
        "What the scene calls for, estimated before it is walked: numbers, and above which limit they matter"
    )
    for c in found:
        values = (f"{c.value:.2g}", f"{c.threshold:g}")
        style = "yellow" if c.above and not c.on else ""
        shown.add_row(c.name, c.number, *values, c.source, Text(f"{c.kind}: {c.verdict}", style=style))
    return shown


def screening_entry(c: Criterion) -> dict[str, Any]:
    """A number of a scene in result.json."""
    return {**asdict(c), "verdict": c.verdict}


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
