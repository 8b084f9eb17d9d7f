"""Feet, scenes and the validity of walks as entries of result.json."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

from footopt.effects import name_of
from footopt.foot import Foot, Waypoints
from footopt.report import terminal
from footopt.walk import MEASURES, Accuracy, Scene
from footopt.walk.adapt import adapted
from footopt.walk.audit import parameters
from footopt.walk.objectives import lookup
from footopt.walk.validity import Diagnostic

Answer = float | tuple[float, ...]


def answer(names: Sequence[str], values: Mapping[str, float]) -> Answer:
    """What a job returns to a sweeper and to callbacks: its objective, or a tuple of several.

    Signs are natural. Where there is no value, because a walk or the job failed, it is the objective's worst:
    a sweeper then goes on.
    """
    found = [values.get(name, math.nan) for name in names]
    worst = [objective.worst for objective in lookup(names)]
    told = tuple(v if math.isfinite(v) else w for v, w in zip(found, worst, strict=True))
    return told[0] if len(told) == 1 else told


def foot_entry(foot: Foot) -> dict[str, Any]:
    """A foot in result.json."""
    return {
        "name": foot.name,
        "k": foot.k,
        "hollow_mm": 1e3 * foot.hollow,
        "box_violation_mm": None if foot.box_violation is None else 1e3 * foot.box_violation,
        "width_m": foot.width,
        "ankle_m": foot.ankle,
    }


def validity_entry(diagnostics: Sequence[Diagnostic]) -> dict[str, Any]:
    """The validity of a walk in result.json."""
    return {
        "validity": {d.name: d.value for d in diagnostics},
        "validity_units": {d.name: d.unit for d in diagnostics},
        "warnings": [terminal.describe_outside(d) for d in diagnostics if d.outside],
    }


def accuracy_entry(accuracy: Accuracy, scene: Scene, sole: Foot | Waypoints) -> dict[str, Any]:
    """An accuracy in result.json as a sole, or all soles of a space, walk through a scene."""
    return dataclasses.asdict(adapted(accuracy, scene, sole))


def scene_entry(scene: Scene, accuracy: Accuracy, names: Sequence[str]) -> dict[str, Any]:
    """A scene, its accuracy and the units and senses of the objectives in result.json."""
    return {
        "units": {name: MEASURES[name].unit for name in names},
        "maximise": {name: MEASURES[name].maximise for name in names},
        "scene": {
            "sand": {
                "name": scene.sand.name,
                "zeta": scene.sand.zeta,
                "coefficients_N_cm3": dataclasses.asdict(scene.sand.stress_map),
                "fit_error": scene.sand.fit_error,
            },
            "gait": {
                "name": scene.gait.name,
                "period_s": scene.gait.period,
                "pitch": scene.gait.pitch,
                "source": scene.gait.source,
                "fit_residual_deg": dict(scene.gait.residual),
            },
            "walker": dataclasses.asdict(scene.walker),
            "t_f_s": scene.duration,
            "effects": {name_of(e): parameters(e) for e in scene.effects},
        },
        "accuracy": dataclasses.asdict(accuracy),
    }
