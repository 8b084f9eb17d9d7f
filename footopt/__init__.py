"""footopt: design feet for bipeds that walk on sand.

    import footopt as fo

    scene = fo.Scene(sand=fo.Sand.named("hard"))
    walk = fo.simulate(fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4]), scene)
    walk.objectives

Public names are imported when first used, so that importing footopt is cheap.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "Accuracy": "footopt.walk",
    "Foot": "footopt.foot",
    "FootProblem": "footopt.design",
    "FootoptError": "footopt.errors",
    "Gait": "footopt.gait",
    "Inertia": "footopt.effects.base",
    "LeadingEdge": "footopt.effects.base",
    "Layers": "footopt.effects.base",
    "Patches": "footopt.effects.base",
    "Slope": "footopt.effects.base",
    "RobustProblem": "footopt.design",
    "Sand": "footopt.sand",
    "Scenario": "footopt.walk",
    "Scene": "footopt.walk",
    "Spread": "footopt.walk",
    "StressMap": "footopt.sand",
    "Table": "footopt.walk",
    "Walk": "footopt.walk",
    "Walker": "footopt.walk",
    "Waypoints": "footopt.foot",
    "draw": "footopt.walk",
    "estimate_error": "footopt.walk",
    "evaluate": "footopt.walk",
    "search": "footopt.design",
    "simulate": "footopt.walk",
    "stress": "footopt.sand",
}

__all__ = [
    "Accuracy",
    "Foot",
    "FootProblem",
    "FootoptError",
    "Gait",
    "RobustProblem",
    "Sand",
    "Scenario",
    "Scene",
    "Spread",
    "StressMap",
    "Table",
    "Walk",
    "Walker",
    "Waypoints",
    "__version__",
    "draw",
    "estimate_error",
    "evaluate",
    "search",
    "simulate",
    "stress",
]

if TYPE_CHECKING:
    from footopt.design import FootProblem, RobustProblem
    from footopt.design.search import search
    from footopt.errors import FootoptError
    from footopt.foot import Foot, Waypoints
    from footopt.gait import Gait
    from footopt.sand import Sand, StressMap, stress
    from footopt.walk import (
        Accuracy,
        Scenario,
        Scene,
        Spread,
        Table,
        Walk,
        Walker,
        draw,
        estimate_error,
        evaluate,
        simulate,
    )


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'footopt' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
