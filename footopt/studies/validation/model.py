"""The error of the model beside the error of the numbers: what validation found for the nearest quantity."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from footopt.effects import LeadingEdge, name_of
from footopt.report.numbers import percent
from footopt.walk import OBJECTIVES, Walk

#: What was measured that is nearest to each objective: experiment and quantity.
NEAREST = {
    "distance": ("people", "speed ratio"),
    "mean_height": ("wheel", "sinkage"),
    "work": ("people", "work ratio"),
    "peak_power": ("people", "peak force"),
    "speed_loss": ("wheel", "drawbar"),
}


@cache
def kept() -> list[dict[str, Any]]:
    """Errors and verdicts of all comparisons, as the last study=validate found them.

    They are kept beside this file, and a test holds them to the experiments.
    """
    text = files(__package__).joinpath("results.json").read_text(encoding="utf-8")
    return list(json.loads(text))


def found() -> dict[tuple[str, str, tuple[str, ...]], float]:
    """Errors over the scale by experiment, quantity and law."""
    return {(e["experiment"], e["quantity"], tuple(e["law"])): e["error"] for e in kept()}


def verdicts() -> list[str]:
    """Verdict of every comparison."""
    return [e["verdict"] for e in kept()]


def model_error(walk: Walk, left_out: Mapping[str, float] | None = None) -> dict[str, float]:
    """Relative errors that the law had in experiments, by objective; empty for a walk that failed.

    The leading edge has errors of its own; other effects were not held against walks or wheels. The height
    of the hip errs by the error of the sinkage, which is related to it by the walk's own numbers; J_W by
    the root sum of squares of its factors. To each is added what the effects that `effects=auto` left out
    would change.
    """
    if not walk.feasible:
        return {}
    edge = name_of(LeadingEdge())
    law = (edge,) if any(isinstance(effect, LeadingEdge) for effect in walk.scene.effects) else ()
    known = found()
    errors = {name: known[(*nearest, law)] for name, nearest in NEAREST.items()}
    sinkage, height = (walk.objectives[name] for name in ("maximum_sinkage", "mean_height"))
    errors["mean_height"] *= sinkage / height
    errors = {name: error + (left_out or {}).get(name, 0.0) for name, error in errors.items()}
    return errors | {"efficiency": math.sqrt(sum(error**2 for error in errors.values()))}


def describe(errors: dict[str, float]) -> list[str]:
    """The errors in a line; none for none."""
    if not errors:
        return []
    each = ", ".join(
        f"{name.replace('_', ' ')} {percent(errors[name])}" for name in OBJECTIVES if name in errors
    )
    return [f"Model error, from experiments on sand (study=validate): {each}"]
