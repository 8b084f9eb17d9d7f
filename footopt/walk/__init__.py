"""The walker on sand: scene, compiled loops, steppers, and what a walk is judged by."""

from footopt.walk.objectives import FIVE, OBJECTIVES, gain_shares
from footopt.walk.scenarios import Scenario, Spread, draw
from footopt.walk.scene import PRESETS, Accuracy, Scene, Walker
from footopt.walk.simulate import Table, Walk, estimate_error, evaluate, simulate
from footopt.walk.steppers import STEPPERS

__all__ = [
    "FIVE",
    "OBJECTIVES",
    "PRESETS",
    "STEPPERS",
    "Accuracy",
    "Scenario",
    "Scene",
    "Spread",
    "Table",
    "Walk",
    "Walker",
    "draw",
    "estimate_error",
    "evaluate",
    "gain_shares",
    "simulate",
]
