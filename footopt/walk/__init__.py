"""The walker on sand: scene, compiled loops, steppers, and objectives."""

from footopt.walk.accuracy import PRESETS, Accuracy, Tolerance
from footopt.walk.checks import Diagnostic, diagnose
from footopt.walk.objectives import FIVE, MEASURES, OBJECTIVES, gain_shares
from footopt.walk.resolution import estimate_error
from footopt.walk.results import Table, Walk
from footopt.walk.scene import Scene, Walker
from footopt.walk.simulate import evaluate, simulate
from footopt.walk.simulator import FunctionSimulator, Simulator
from footopt.walk.steppers import STEPPERS

__all__ = [
    "FIVE", "MEASURES", "OBJECTIVES", "PRESETS", "STEPPERS", "Accuracy", "Diagnostic", "FunctionSimulator",
    "Scene", "Simulator", "Table", "Tolerance", "Walk", "Walker", "diagnose", "estimate_error", "evaluate",
    "gain_shares", "simulate",
]  # fmt: skip
