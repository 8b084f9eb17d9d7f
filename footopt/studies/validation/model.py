"""The model error of a walk: the error that validation found for the nearest quantity, and that of zeta."""

import json
import math
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from footopt.design.scenarios import Spread, harder_and_softer
from footopt.effects import name_of
from footopt.walk import FIVE, Scene, Walk, evaluate
from footopt.walk.objectives import relative_change

#: The measured quantity that is nearest to each objective: experiment and quantity.
NEAREST = {
    "distance": ("people", "speed ratio"),
    "mean_height": ("wheel_braked", "sinkage"),
    "work": ("people", "work ratio"),
    "peak_power": ("people", "peak force"),
    "speed_loss": ("wheel_braked", "drawbar"),
}
JUDGED = (*FIVE, "efficiency")


@cache
def found() -> dict[tuple[str, str, tuple[str, ...]], dict[str, Any]]:
    """Return the error over the scale and the verdict of each comparison by experiment, quantity and law.

    They are those of the last study=validate, kept beside this file; a test holds them to the experiments.
    """
    entries = json.loads(files(__package__).joinpath("results.json").read_text(encoding="utf-8"))
    return {(e["experiment"], e["quantity"], tuple(e["law"])): e for e in entries}


def model_error(walk: Walk, spread: float = Spread.zeta) -> dict[str, float]:
    """Relative errors of a walk's objectives by its law and its sand.

    Empty for a walk that failed, and for robots, with which no experiment was compared.

    Two parts, which add as squares:

    - The error of the law in experiments. An effect that was compared with walks and wheels has errors of its
      own. The height of the hip errs by the error of the sinkage, related to it by the walk's own numbers;
      J_W by the root sum of squares of its factors.
    - The larger change by sand that is softer and harder by the spread of zeta; all of an objective where
      such a walk fails.

    `spread` is one standard deviation of the logarithm of zeta.
    """
    if not walk.feasible or not isinstance(walk.scene, Scene):
        return {}
    known = {name for *key, law in found() if tuple(key) in NEAREST.values() for name in law}
    law = tuple(name for name in map(name_of, walk.scene.effects) if name in known)
    errors = {name: found()[(*nearest, law)]["error"] for name, nearest in NEAREST.items()}
    sinkage, height = (walk.objectives[name] for name in ("maximum_sinkage", "mean_height"))
    errors["mean_height"] *= sinkage / height
    errors["efficiency"] = math.sqrt(sum(error**2 for error in errors.values()))
    own = np.array([walk.objectives[name] for name in JUDGED])
    changes = np.zeros(len(JUDGED))
    compared = len(walk.scene.strikes) > 0  # a walker that stands cannot be
    for other in harder_and_softer(walk.scene, spread) if compared else ():
        values = evaluate([walk.foot], other.scene, walk.accuracy, JUDGED, threads=1).values[0]
        change = np.nan_to_num(np.abs(relative_change(values, own)), nan=1.0, posinf=1.0)
        changes = np.maximum(changes, change)
    return {
        name: math.hypot(errors[name], change) for name, change in zip(JUDGED, changes.tolist(), strict=True)
    }
