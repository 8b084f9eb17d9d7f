"""The walker on sand: scene, compiled loops, steppers, and what a walk is judged by."""

from footopt.walker.objectives import FIVE, OBJECTIVES, gain_shares
from footopt.walker.scenarios import Scenario, Spread, draw
from footopt.walker.scene import PRESETS, Accuracy, Scene, Walker
from footopt.walker.simulate import Table, Walk, estimate_error, evaluate, simulate
from footopt.walker.steppers import STEPPERS

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
